//! Obstacles as surfaces and lines in space.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use whipcord::obstacle::{Bends, Mesh, Pipe, Superellipsoid};
use whipcord::{Form, Pose, Vec3};

use crate::hull::plane_in_box;

/// Points on a circle.
const CIRCLE: u32 = 64;
/// Sections of a pipe that are drawn at most.
const SECTIONS: usize = 160;
/// Cosine of the angle between two triangles from which on the edge between them is a line.
const EDGE: f64 = 0.866;

/// What of an obstacle other programs draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObstacleSurface {
    /// In m, in the frame that the pose is given in.
    pub points: Vec<Vec3>,
    /// Counter-clockwise as seen from where the robot can be: from outside, and from inside of a pipe.
    pub triangles: Vec<[usize; 3]>,
    /// Edges and sections, each a line through its points.
    pub lines: Vec<Vec<Vec3>>,
}

/// The surface of an obstacle in this pose; of a half-space the part of its plane that is in a box with these corners.
#[must_use]
pub fn obstacle_surface(form: &Form, pose: &Pose, room: [Vec3; 2]) -> ObstacleSurface {
    let mut surface = ObstacleSurface::default();
    match form {
        Form::HalfSpace => {
            let normal = pose.rotation.rotate(Vec3::Z);
            surface.points = plane_in_box(pose.position, normal, room);
            surface.triangles = (2..surface.points.len()).map(|k| [0, k - 1, k]).collect();
            surface.lines = closed(&surface.points).into_iter().collect();
            return surface;
        }
        Form::Sphere { .. } | Form::Capsule { .. } | Form::Superellipsoid(_) => {
            let rings = globe_rings(form);
            let middle = rings.len() / 2;
            // A capsule has two of them.
            let apart = if matches!(form, Form::Capsule { .. }) { 1 } else { 0 };
            surface.span(&rings);
            surface.draw(&rings, &[middle - apart, middle]);
        }
        Form::Cylinder { radius, length } => surface.solid(cylinder_rings(*radius, *length)),
        Form::Box { size } => surface.solid(box_rings(*size)),
        Form::Pipe(pipe) => {
            for rings in bore(pipe, &Pose::IDENTITY) {
                surface.span(&rings);
                surface.draw(&rings, &[0, rings.len() - 1]);
            }
            surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Form::Mesh(mesh) => {
            surface.points = mesh.vertices().to_vec();
            let triangles = mesh.triangles().iter();
            surface.triangles = triangles.map(|corners| corners.map(|k| k as usize)).collect();
            surface.lines = edges(mesh);
        }
    }
    let lines = surface.lines.iter_mut().flatten();
    surface.points.iter_mut().chain(lines).for_each(|point| *point = pose.transform(*point));
    surface
}

impl ObstacleSurface {
    /// Between rings of as many points, each counter-clockwise as seen from the next.
    fn span(&mut self, rings: &[Vec<Vec3>]) {
        let first = self.points.len();
        self.points.extend(rings.iter().flatten());
        let count = rings.first().map_or(0, Vec::len);
        for ring in 0..rings.len().saturating_sub(1) {
            for k in 0..count {
                let [a, b] = [k, (k + 1) % count].map(|k| first + ring * count + k);
                self.add([a, b, b + count]);
                self.add([a, b + count, a + count]);
            }
        }
    }

    /// Between two rings, closed at both.
    fn solid(&mut self, [low, high]: [Vec<Vec3>; 2]) {
        let rings = [low, high];
        self.span(&rings);
        let count = rings[0].len();
        for k in 2..count {
            self.add([0, k, k - 1]);
            self.add([count, count + k - 1, count + k]);
        }
        self.draw(&rings, &[0, 1]);
    }

    /// A triangle, unless two of its corners are one point.
    fn add(&mut self, corners: [usize; 3]) {
        let [a, b, c] = corners.map(|k| self.points[k]);
        if a != b && b != c && c != a {
            self.triangles.push(corners);
        }
    }

    /// These rings, and four lines along all of them.
    fn draw(&mut self, rings: &[Vec<Vec3>], drawn: &[usize]) {
        let mut drawn = drawn.to_vec();
        drawn.dedup();
        self.lines.extend(drawn.iter().filter_map(|k| closed(&rings[*k])));
        let count = rings.first().map_or(0, Vec::len);
        for k in (0..count).step_by((count / 4).max(1)) {
            self.lines.push(rings.iter().map(|ring| ring[k]).collect());
        }
    }
}

/// A line through all points and back to the first.
fn closed(points: &[Vec3]) -> Option<Vec<Vec3>> {
    let first = points.first()?;
    Some(points.iter().chain([first]).copied().collect())
}

/// The edges of a mesh at which its surface bends.
fn edges(mesh: &Mesh) -> Vec<Vec<Vec3>> {
    let corner = |k: u32| mesh.vertices()[k as usize];
    let normal = |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a));
    // An edge is of two triangles that run along it in opposite directions.
    let mut first: BTreeMap<[u32; 2], Vec3> = BTreeMap::new();
    let mut lines = Vec::new();
    for triangle in mesh.triangles() {
        let own = normal(triangle);
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            match first.remove(&[b, a]) {
                None => drop(first.insert([a, b], own)),
                Some(other) if own.dot(other) < EDGE * own.norm() * other.norm() => {
                    lines.push(vec![corner(a), corner(b)]);
                }
                Some(_) => {}
            }
        }
    }
    lines
}

/// A circle about the origin in the plane of two unit vectors.
fn ring(radius: f64, u: Vec3, v: Vec3) -> impl Iterator<Item = Vec3> {
    (0..CIRCLE).map(move |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(CIRCLE)).sin_cos();
        radius * (cos * u + sin * v)
    })
}

/// Rings of a sphere, a capsule or a superellipsoid from its lowest point to its highest; none of other forms.
pub(crate) fn globe_rings(form: &Form) -> Vec<Vec<Vec3>> {
    let point = |n: Vec3, half: f64| match form {
        Form::Sphere { radius } => *radius * n,
        Form::Capsule { radius, length } => *radius * n + Vec3::Z * (half * length),
        Form::Superellipsoid(body) => on_superellipsoid(body, n),
        _ => Vec3::ZERO,
    };
    let around = |z: f64, half: f64| -> Vec<Vec3> {
        let across = (1.0 - z * z).sqrt();
        ring(across, Vec3::X, Vec3::Y).map(|p| point(p + Vec3::Z * z, half)).collect()
    };
    let count = CIRCLE / 4;
    let heights = |k: u32| (0.25 * TAU * f64::from(k) / f64::from(count)).sin();
    let mut rings: Vec<Vec<Vec3>> = (1..=count).rev().map(|k| around(-heights(k), -0.5)).collect();
    match form {
        Form::Sphere { .. } | Form::Superellipsoid(_) => rings.push(around(0.0, 0.0)),
        // Both hemispheres of a capsule begin at the equator.
        Form::Capsule { .. } => rings.extend([around(0.0, -0.5), around(0.0, 0.5)]),
        _ => return Vec::new(),
    }
    rings.extend((1..=count).map(|k| around(heights(k), 0.5)));
    rings
}

/// The rims of a cylinder, the lower one first.
pub(crate) fn cylinder_rings(radius: f64, length: f64) -> [Vec<Vec3>; 2] {
    let rim = |z: f64| ring(radius, Vec3::X, Vec3::Y).map(|p| p + Vec3::Z * (z * length)).collect();
    [rim(-0.5), rim(0.5)]
}

/// The lower and the upper side of a box.
pub(crate) fn box_rings(size: Vec3) -> [Vec<Vec3>; 2] {
    let corner = |x: f64, y: f64, z: f64| size.scale(Vec3::new(x, y, z));
    let side = |z: f64| {
        [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| corner(x, y, z)).to_vec()
    };
    [side(-0.5), side(0.5)]
}

/// The point of a superellipsoid whose spherical angles are those of a unit vector.
fn on_superellipsoid(body: &Superellipsoid, n: Vec3) -> Vec3 {
    let [e1, e2] = body.exponents();
    let power = |x: f64, e: f64| x.signum() * x.abs().powf(e);
    let across = n.x.hypot(n.y);
    let (x, y) = if across > 0.0 { (n.x / across, n.y / across) } else { (1.0, 0.0) };
    let ring = power(across, e1);
    body.semi_axes().scale(Vec3::new(ring * power(x, e2), ring * power(y, e2), power(n.z, e1)))
}

/// Rings around the middle of a pipe, those of each straight piece for themselves.
pub(crate) fn bore(pipe: &Pipe, pose: &Pose) -> Vec<Vec<Vec<Vec3>>> {
    let (points, tangents) = pipe.middle();
    let around = |at: Vec3, tangent: Vec3| -> Vec<Vec3> {
        let other = if tangent.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let u = tangent.cross(other);
        let u = u / u.norm();
        let circle = ring(pipe.radius(), u, tangent.cross(u));
        circle.map(|p| pose.transform(at + p)).collect()
    };
    if pipe.bends() == Bends::Corners {
        let chord = |k: usize| [k, k + 1].map(|i| around(points[i], tangents[k])).to_vec();
        return (0..points.len() - 1).map(chord).collect();
    }
    let last = points.len() - 1;
    let count = last.min(SECTIONS);
    vec![(0..=count).map(|k| k * last / count).map(|k| around(points[k], tangents[k])).collect()]
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use whipcord::UnitQuaternion;

    const ROOM: [Vec3; 2] = [Vec3 { x: -1.0, y: -1.0, z: -1.0 }, Vec3 { x: 1.0, y: 1.0, z: 1.0 }];

    fn volume(surface: &ObstacleSurface) -> f64 {
        let of = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|k| surface.points[k]);
            a.dot(b.cross(c)) / 6.0
        };
        surface.triangles.iter().map(of).sum()
    }

    #[test]
    fn surfaces_enclose_the_volumes_of_their_forms() {
        let ellipsoid = Superellipsoid::new(Vec3::new(0.1, 0.2, 0.3), [1.0, 1.0]).unwrap();
        let pose = Pose {
            position: Vec3::new(0.1, -0.2, 0.3),
            rotation: UnitQuaternion::exp(Vec3::new(0.3, 0.4, -0.2)),
        };
        let ball = 4.0 / 3.0 * PI;
        for (form, expected) in [
            (Form::Sphere { radius: 0.2 }, ball * 0.008),
            (Form::Capsule { radius: 0.1, length: 0.5 }, ball * 0.001 + PI * 0.01 * 0.5),
            (Form::Cylinder { radius: 0.1, length: 0.5 }, PI * 0.01 * 0.5),
            (Form::Box { size: Vec3::new(0.1, 0.2, 0.3) }, 0.006),
            (Form::Superellipsoid(ellipsoid), ball * 0.006),
        ] {
            let surface = obstacle_surface(&form, &pose, ROOM);
            let found = volume(&surface);
            assert!((found / expected - 1.0).abs() < 6e-3, "{form:?} {found} {expected}");
            // Each line lies on the surface.
            for point in surface.lines.iter().flatten() {
                let nearest = surface.points.iter().map(|p| (*p - *point).norm());
                assert!(nearest.fold(1.0, f64::min) < 1e-12, "{form:?}");
            }
        }
    }

    #[test]
    fn planes_and_pipes_face_the_robot() {
        let up = obstacle_surface(&Form::HalfSpace, &Pose::IDENTITY, ROOM);
        assert_eq!((up.triangles.len(), up.lines.len()), (2, 1));
        let normal = |surface: &ObstacleSurface, k: usize| {
            let [a, b, c] = surface.triangles[k].map(|k| surface.points[k]);
            (b - a).cross(c - a)
        };
        assert!(normal(&up, 0).z > 0.0);
        let points = [Vec3::ZERO, Vec3::new(0.0, 0.0, 0.3)];
        let pipe = Pipe::new(0.05, &points, Bends::Corners).unwrap();
        let inside = obstacle_surface(&Form::Pipe(pipe), &Pose::IDENTITY, ROOM);
        let [a, _, _] = inside.triangles[0].map(|k| inside.points[k]);
        assert!(normal(&inside, 0).dot(a) < 0.0);
    }
}
