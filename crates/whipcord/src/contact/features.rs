//! What of an obstacle can touch another one: points, edges, plates and convex surfaces, each rounded.
//!
//! The distance of two obstacles is the least distance of one from such parts of the other, less their rounding, as it is for
//! parts of the robot.

use std::collections::HashMap;

use whipcord_numerics::{Pose, Vec3};

use super::body::{Body, Nearest, tangents};
use crate::obstacle::{Form, Mesh, Obstacle, Superellipsoid};

/// A part of an obstacle, in a frame with its axes about its centre.
#[derive(Clone, Debug)]
enum Feature {
    Point(Vec3),
    Segment([Vec3; 2]),
    /// A point of the rim of the plate that follows, which touches where that lies flat.
    RimPoint(Vec3),
    /// A disk in the plane z = 0 of this frame.
    Plate(Pose, Body),
    /// The whole surface of a body whose origin is here.
    Surface(Superellipsoid, Vec3),
}

/// All parts of an obstacle that can touch.
#[derive(Clone, Debug)]
pub(super) struct Features {
    list: Vec<Feature>,
    /// In m.
    pub rounding: f64,
    /// Whether points and segments alone describe it, so that those of the other obstacle are not needed.
    pub is_round: bool,
    /// Whether it is a ball.
    pub is_ball: bool,
}

/// Edges are rounded by this part of the smallest edge or radius.
const ROUNDED: f64 = 0.01;
/// Points on the rim of a cylinder that touch where it lies flat.
const RIM: usize = 6;
/// A rim lies flat where the distances of its points differ by less than this part of its radius.
const FLAT: f64 = 0.02;
/// A rim that is nearer than its fixed points by less than this part of its radius does not touch beside them.
const LEVEL: f64 = 1e-7;
/// Places at which a segment is looked at first.
const PLACES: usize = 9;
/// The most corners of a mesh.
const MOST_CORNERS: usize = 4000;
/// The least angle between a corner of a mesh and a flat place, as the sine of the least slope of its edges.
const POINTED: f64 = 1e-6;

impl Features {
    /// Of a form, about a centre in its frame.
    pub fn new(form: &Form, centre: Vec3) -> Self {
        let sides = [-1.0, 1.0];
        let mut list = Vec::new();
        let mut rounding = 0.0;
        match form {
            Form::HalfSpace | Form::Pipe(_) => {}
            Form::Sphere { radius } => {
                rounding = *radius;
                list.push(Feature::Point(-centre));
            }
            Form::Capsule { radius, length } => {
                rounding = *radius;
                let ends = sides.map(|side| Vec3::Z * (0.5 * side * length) - centre);
                list.extend(ends.map(Feature::Point));
                list.push(Feature::Segment(ends));
            }
            Form::Box { size } => {
                rounding = ROUNDED * size.x.min(size.y).min(size.z);
                let half = [0, 1, 2].map(|i| 0.5 * size[i] - rounding);
                let corner =
                    |signs: [f64; 3]| Vec3::from([0, 1, 2].map(|i| signs[i] * half[i])) - centre;
                for (x, y) in sides.into_iter().flat_map(|x| sides.map(|y| (x, y))) {
                    let along = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
                    for [i, j, k] in along {
                        let ends = sides.map(|z| {
                            let mut signs = [0.0; 3];
                            (signs[i], signs[j], signs[k]) = (z, x, y);
                            corner(signs)
                        });
                        list.push(Feature::Segment(ends));
                    }
                    list.extend(sides.map(|z| Feature::Point(corner([x, y, z]))));
                }
            }
            Form::Cylinder { radius, length } => {
                rounding = ROUNDED * radius.min(0.5 * length);
                let flat = radius - rounding;
                for side in sides {
                    let middle = Vec3::Z * (side * (0.5 * length - rounding)) - centre;
                    let pose = Pose { position: middle, ..Pose::IDENTITY };
                    list.extend((0..RIM).map(|k| {
                        let (sin, cos) = (core::f64::consts::TAU * k as f64 / RIM as f64).sin_cos();
                        Feature::RimPoint(middle + Vec3::new(flat * cos, flat * sin, 0.0))
                    }));
                    list.push(Feature::Plate(pose, Body { flat, rounding }));
                }
            }
            Form::Superellipsoid(body) => list.push(Feature::Surface(body.clone(), -centre)),
            Form::Mesh(mesh) => {
                list.extend(corners(mesh).into_iter().map(|v| Feature::Point(v - centre)));
            }
        }
        let is_ball = matches!(form, Form::Sphere { .. });
        Self { list, rounding, is_round: is_ball || matches!(form, Form::Capsule { .. }), is_ball }
    }

    /// The place of a part that is nearest to another obstacle, from the last one on.
    pub fn track(&self, part: usize, other: &Obstacle, pose: &Pose, local: [f64; 2]) -> Nearest {
        match &self.list[part] {
            Feature::Point(point) | Feature::RimPoint(point) => self.at(*point, other, pose, local),
            Feature::Segment(ends) => {
                let along = lowest_along(ends.map(|end| pose.transform(end)), other);
                self.at(ends[0] + (ends[1] - ends[0]) * along, other, pose, [along, 0.0])
            }
            Feature::Plate(plate, body) => {
                let nearest = body.track(other, &(*pose * *plate), local);
                Nearest { arm: nearest.arm + pose.rotation.rotate(plate.position), ..nearest }
            }
            Feature::Surface(body, middle) => {
                let point = lowest_point(body, *middle, other, pose);
                self.at(point, other, pose, local)
            }
        }
    }

    fn at(&self, point: Vec3, other: &Obstacle, pose: &Pose, local: [f64; 2]) -> Nearest {
        let arm = pose.rotation.rotate(point);
        let surface = other.surface(pose.position + arm);
        Nearest { gap: surface.distance - self.rounding, normal: surface.normal, arm, local }
    }

    /// All places that are no farther from another obstacle than this, each with its part.
    pub fn near(
        &self,
        other: &Obstacle,
        pose: &Pose,
        within: f64,
        found: &mut Vec<(usize, Nearest)>,
    ) {
        let mut of_plate = Vec::new();
        for (part, feature) in self.list.iter().enumerate() {
            match feature {
                Feature::Plate(plate, body) => {
                    body.nearest(other, &(*pose * *plate), within, &mut of_plate);
                    let rim = (part - RIM..part)
                        .map(|point| (point, self.track(point, other, pose, [0.0; 2])));
                    let gaps = rim.clone().map(|(_, nearest)| nearest.gap);
                    let (low, high) = gaps
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                    let lies_flat = high - low < FLAT * body.flat;
                    let lowest = if lies_flat { low - LEVEL * body.flat } else { f64::INFINITY };
                    if lies_flat {
                        found.extend(rim.filter(|(_, nearest)| nearest.gap <= within));
                    }
                    let lower = of_plate.iter().filter(|nearest| nearest.gap < lowest);
                    found.extend(lower.map(|nearest| {
                        let arm = nearest.arm + pose.rotation.rotate(plate.position);
                        (part, Nearest { arm, ..*nearest })
                    }));
                }
                Feature::Segment(ends) => {
                    // Nearest at an end, it is the end that touches.
                    let middle = pose.transform((ends[0] + ends[1]) * 0.5);
                    let half = 0.5 * (ends[1] - ends[0]).norm();
                    if other.surface(middle).distance > half + self.rounding + within {
                        continue;
                    }
                    let nearest = self.track(part, other, pose, [0.0; 2]);
                    let lower = ends.iter().all(|&end| {
                        let at_end = other.surface(pose.transform(end)).distance - self.rounding;
                        nearest.gap < at_end - 1e-9 * half
                    });
                    if lower && nearest.gap <= within {
                        found.push((part, nearest));
                    }
                }
                Feature::RimPoint(_) => {}
                Feature::Point(_) | Feature::Surface(..) => {
                    let nearest = self.track(part, other, pose, [0.0; 2]);
                    if nearest.gap <= within {
                        found.push((part, nearest));
                    }
                }
            }
        }
    }
}

/// Where a segment is nearest to an obstacle, from 0 to 1.
fn lowest_along(ends: [Vec3; 2], other: &Obstacle) -> f64 {
    const HALVINGS: usize = 60;
    let way = ends[1] - ends[0];
    let see = |t: f64| other.surface(ends[0] + way * t);
    let places: [f64; PLACES] =
        core::array::from_fn(|k| see(k as f64 / (PLACES - 1) as f64).distance);
    let lowest = (0..PLACES).min_by(|&a, &b| places[a].total_cmp(&places[b])).unwrap_or(0);
    let at = |k: usize| k as f64 / (PLACES - 1) as f64;
    let (mut low, mut high) = (at(lowest.saturating_sub(1)), at((lowest + 1).min(PLACES - 1)));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let slope = see(middle).normal.dot(way);
        if slope == 0.0 {
            return middle;
        }
        if slope < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The point of a convex surface that is nearest to an obstacle, in the frame of its pose: where its normal is opposite to that
/// of the obstacle, by Newton's method on that normal.
fn lowest_point(body: &Superellipsoid, middle: Vec3, other: &Obstacle, pose: &Pose) -> Vec3 {
    const STEPS: usize = 40;
    const SETTLED: f64 = 1e-13;
    const STEP: f64 = 1e-6;
    let back = pose.rotation.conjugate();
    let point = |direction: Vec3| body.support(direction) + middle;
    let facing = |direction: Vec3| {
        let normal = other.surface(pose.transform(point(direction))).normal;
        -back.rotate(normal)
    };
    let mut direction = -back.rotate(other.surface(pose.transform(middle)).normal);
    for _ in 0..STEPS {
        let axes = tangents(direction);
        let towards = |d: Vec3| d / d.norm();
        let lack = |d: Vec3| {
            let apart = facing(d) - d;
            axes.map(|axis| apart.dot(axis))
        };
        let here = lack(direction);
        let size = here[0].hypot(here[1]);
        if size < SETTLED {
            break;
        }
        let [[a, c], [b, d]] = axes.map(|axis| {
            let ahead = lack(towards(direction + axis * STEP));
            let behind = lack(towards(direction - axis * STEP));
            [0, 1].map(|i| (ahead[i] - behind[i]) / (2.0 * STEP))
        });
        let determinant = a * d - b * c;
        let mut step = if determinant.abs() > 1e-12 {
            [(b * here[1] - d * here[0]) / determinant, (c * here[0] - a * here[1]) / determinant]
        } else {
            here
        };
        let length = step[0].hypot(step[1]);
        if length > 0.5 {
            step = step.map(|x| 0.5 * x / length);
        }
        let next = (0..30).find_map(|halvings| {
            let part = 0.5_f64.powi(halvings);
            let next = towards(direction + (axes[0] * step[0] + axes[1] * step[1]) * part);
            let [x, y] = lack(next);
            (x.hypot(y) < size).then_some(next)
        });
        let Some(next) = next else { break };
        direction = next;
    }
    point(direction)
}

/// The vertices of a mesh that a plane can touch alone: those from which all edges lead down on one side.
fn corners(mesh: &Mesh) -> Vec<Vec3> {
    let vertices = mesh.vertices();
    let mut around: HashMap<u32, Vec<Vec3>> = HashMap::new();
    let mut normals: HashMap<u32, Vec<Vec3>> = HashMap::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|k| vertices[k as usize]);
        let across = (b - a).cross(c - a);
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            let edge = vertices[to as usize] - vertices[from as usize];
            around.entry(from).or_default().push(edge / edge.norm());
            around.entry(to).or_default().push(-edge / edge.norm());
            normals.entry(from).or_default().push(across / across.norm());
        }
    }
    let mut found: Vec<(f64, usize)> = Vec::new();
    for k in 0..vertices.len() {
        let (Some(edges), Some(faces)) = (around.get(&(k as u32)), normals.get(&(k as u32))) else {
            continue;
        };
        // The direction in which the vertex is farthest out, found by turning away from the edge that leads out most.
        let mut out = faces.iter().fold(Vec3::ZERO, |sum, &n| sum + n);
        let slope = |out: Vec3| edges.iter().map(|edge| edge.dot(out)).fold(-1.0, f64::max);
        for step in 0..200 {
            if out.norm() == 0.0 {
                break;
            }
            out = out / out.norm();
            let worst = edges.iter().max_by(|a, b| a.dot(out).total_cmp(&b.dot(out)));
            let Some(worst) = worst.filter(|edge| edge.dot(out) > -POINTED) else { break };
            out -= *worst * (1.0 / f64::from(step + 2));
        }
        let steepest = if out.norm() > 0.0 { slope(out / out.norm()) } else { 1.0 };
        if steepest < -POINTED {
            found.push((steepest, k));
        }
    }
    // The most pointed ones.
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found.truncate(MOST_CORNERS);
    found.into_iter().map(|(_, k)| vertices[k]).collect()
}
