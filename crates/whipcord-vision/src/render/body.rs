//! The robot as convex pieces in the picture.

use whipcord::{Pose, Robot, Solution, Vec3};
use whipcord_estimation::Place;
use whipcord_estimation::camera::{Camera, Lens, ViewError};

use super::{Marker, RenderError, Scene};
use crate::coverage::convex_hull;

/// Corners of the circles at the ends of a piece.
const CORNERS: usize = 64;
/// Pieces of the backbone between two stations.
const BENDS: usize = 8;
/// How much of its length a piece of backbone reaches into its neighbours, which closes the seams.
const OVERLAP: f64 = 0.3;

/// Convex polygons of one colour each, painted one after the other.
pub(super) struct Piece {
    /// Depth of its middle in m.
    depth: f64,
    pub layers: Vec<(Vec<[f64; 2]>, [f32; 3])>,
}

/// Everything that is seen, from far to near.
pub(super) fn pieces(
    scene: &Scene,
    robot: &Robot,
    solution: &Solution,
    camera: &Camera,
) -> Result<Vec<Piece>, RenderError> {
    let mut pieces = Vec::new();
    backbone(scene, solution, camera, &mut pieces)?;
    cables(scene, robot, solution, camera, &mut pieces)?;
    for pose in &solution.disks.poses {
        pieces.push(disk(scene, *pose, camera)?);
    }
    for marker in &scene.markers {
        let at = centre(marker, solution)?;
        let circle = projected(&ring(at, view(camera, at), marker.radius), camera)?;
        // A ball is seen before what it is stuck on.
        let depth = camera.in_view(at).z - marker.radius;
        pieces.push(Piece { depth, layers: vec![(convex_hull(circle), marker.colour)] });
    }
    pieces.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    Ok(pieces)
}

/// The centre of a marker in the world, in m.
pub(super) fn centre(marker: &Marker, solution: &Solution) -> Result<Vec3, RenderError> {
    let pose = match marker.place {
        Place::Disk(i) => {
            let count = solution.disks.poses.len();
            let missing = RenderError::NoDisk { disk: i + 1, count };
            *solution.disks.poses.get(i).ok_or(missing)?
        }
        Place::ArcLength(s) => {
            let shape = &solution.shape;
            let nearest = (0..shape.poses.len()).min_by(|&a, &b| {
                let away = |i: usize| (shape.arc_length[i] - s).abs();
                away(a).total_cmp(&away(b))
            });
            nearest.map_or(Pose::IDENTITY, |i| shape.poses[i])
        }
    };
    Ok(pose.transform(marker.offset))
}

fn disk(scene: &Scene, pose: Pose, camera: &Camera) -> Result<Piece, ViewError> {
    let axis = pose.rotation.rotate(Vec3::Z);
    let faces = [-0.5, 0.5].map(|side| pose.position + side * scene.disk_thickness * axis);
    let circles = faces.map(|face| ring(face, axis, scene.disk_radius));
    let [first, second] = [projected(&circles[0], camera)?, projected(&circles[1], camera)?];
    // The face that looks at the camera; edge-on neither does.
    let towards = |side: f64, at: Vec3| side * axis.dot(view(camera, at)) < 0.0;
    let face = if towards(1.0, faces[1]) {
        Some(second.clone())
    } else if towards(-1.0, faces[0]) {
        Some(first.clone())
    } else {
        None
    };
    let rim = convex_hull(first.into_iter().chain(second).collect());
    let mut layers = vec![(rim, scene.paint.disks)];
    layers.extend(face.map(|face| (convex_hull(face), lit(scene.paint.disks, 1.5))));
    Ok(Piece { depth: camera.in_view(pose.position).z, layers })
}

/// The backbone, bent between its stations as their tangents ask for.
fn backbone(
    scene: &Scene,
    solution: &Solution,
    camera: &Camera,
    pieces: &mut Vec<Piece>,
) -> Result<(), ViewError> {
    let shape = &solution.shape;
    let radius = 0.5 * scene.backbone_diameter;
    for arc in shape.arc_length.windows(2) {
        let curve = |t: f64| shape.at(arc[0] + t * (arc[1] - arc[0])).position;
        for k in 0..BENDS {
            let place = |k: f64| curve((k / BENDS as f64).clamp(0.0, 1.0));
            let (from, to) = (place(k as f64 - OVERLAP), place(k as f64 + 1.0 + OVERLAP));
            let mut piece = tube(from, to, radius, scene.paint.backbone, true, camera)?;
            // What is inside a disk is hidden by it, from wherever it is seen.
            let reach = 0.5 * (scene.disk_thickness + (to - from).norm());
            for disk in &solution.disks.poses {
                let away = 0.5 * (from + to) - disk.position;
                let along = away.dot(disk.rotation.rotate(Vec3::Z));
                if away.norm() < scene.disk_radius && along.abs() < reach {
                    piece.depth = piece.depth.max(camera.in_view(disk.position).z + radius);
                }
            }
            pieces.push(piece);
        }
    }
    Ok(())
}

/// The cables, straight from hole to hole.
fn cables(
    scene: &Scene,
    robot: &Robot,
    solution: &Solution,
    camera: &Camera,
    pieces: &mut Vec<Piece>,
) -> Result<(), ViewError> {
    let disks = &solution.disks;
    for route in robot.routes() {
        let holes: Vec<Vec3> = disks
            .arc_length
            .iter()
            .zip(&disks.poses)
            .filter(|(s, _)| **s <= route.end())
            .map(|(&s, pose)| pose.transform(route.at(s).offset))
            .collect();
        for span in holes.windows(2) {
            let radius = 0.5 * scene.cable_diameter;
            pieces.push(tube(span[0], span[1], radius, scene.paint.cables, false, camera)?);
        }
    }
    Ok(())
}

/// A round stretch from one point to another; with a lighter line along it where it is thick.
fn tube(
    from: Vec3,
    to: Vec3,
    radius: f64,
    colour: [f32; 3],
    shines: bool,
    camera: &Camera,
) -> Result<Piece, ViewError> {
    let hull = |radius: f64| -> Result<Vec<[f64; 2]>, ViewError> {
        let mut corners = projected(&ring(from, to - from, radius), camera)?;
        corners.extend(projected(&ring(to, to - from, radius), camera)?);
        Ok(convex_hull(corners))
    };
    let mut layers = vec![(hull(radius)?, colour)];
    if shines {
        layers.push((hull(0.4 * radius)?, lit(colour, 1.4)));
    }
    Ok(Piece { depth: camera.in_view(0.5 * (from + to)).z, layers })
}

fn projected(points: &[Vec3], camera: &Camera) -> Result<Vec<[f64; 2]>, ViewError> {
    points.iter().map(|&point| camera.project(point)).collect()
}

/// Points of the circle about `axis`.
fn ring(centre: Vec3, axis: Vec3, radius: f64) -> Vec<Vec3> {
    // Any direction that is far from the axis does.
    let aside = [Vec3::X, Vec3::Y, Vec3::Z]
        .into_iter()
        .min_by(|a, b| a.dot(axis).abs().total_cmp(&b.dot(axis).abs()))
        .unwrap_or(Vec3::X);
    let unit = |v: Vec3| if v.norm() > 0.0 { v / v.norm() } else { Vec3::X };
    let first = unit(axis.cross(aside));
    let second = unit(axis.cross(first));
    (0..CORNERS)
        .map(|i| core::f64::consts::TAU * i as f64 / CORNERS as f64)
        .map(|a| centre + radius * (a.cos() * first + a.sin() * second))
        .collect()
}

/// Direction in which the camera looks at a point.
fn view(camera: &Camera, at: Vec3) -> Vec3 {
    match camera.lens() {
        Lens::Pinhole(_) => at - camera.pose().position,
        Lens::Orthographic(_) => camera.pose().rotation.rotate(Vec3::Z),
    }
}

fn lit(colour: [f32; 3], by: f32) -> [f32; 3] {
    colour.map(|c| (c * by).min(1.0))
}
