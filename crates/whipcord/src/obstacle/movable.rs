//! Movable objects: obstacles with a mass that contacts and other forces hold in equilibrium.

use core::f64::consts::PI;

use whipcord_numerics::Vec3;

use super::form::Form;
use super::mesh::Mesh;
use crate::robot::{Problem, RobotError, limits};

/// What makes an obstacle a movable object: a rigid body whose pose is unknown. The contacts with the robot, with fixed
/// obstacles and with other objects balance its weight and what else acts on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovableBody {
    /// In kg.
    pub mass: f64,
    /// Centre of mass in m, in the frame of the obstacle.
    pub center_of_mass: Vec3,
    /// Dead force at the centre of mass in N, in the frame of the loads ([`crate::Loads::frame`]).
    pub force: Vec3,
    /// Dead moment in N·m, in the same frame.
    pub moment: Vec3,
}

impl MovableBody {
    /// A homogeneous body of this form and mass in kg; `None` for a half-space and a pipe, which have no end and cannot move.
    #[must_use]
    pub fn with_mass(form: &Form, mass: f64) -> Option<Self> {
        form.centroid().map(|center_of_mass| Self { mass, center_of_mass, ..Self::default() })
    }

    pub(super) fn check(&self, form: &Form) -> Result<(), RobotError> {
        if form.volume().is_none() {
            let form = form.name();
            return Err(RobotError::new("mass", Problem::CannotMove { form }));
        }
        limits::MASS.check("mass", self.mass)?;
        limits::COORDINATE.check_vector("center_of_mass", self.center_of_mass)?;
        limits::FORCE.check_vector("force", self.force)?;
        limits::MOMENT.check_vector("moment", self.moment)
    }
}

impl Form {
    /// Volume in m³; `None` of a half-space and of what surrounds a pipe.
    #[must_use]
    pub fn volume(&self) -> Option<f64> {
        match self {
            Self::HalfSpace | Self::Pipe(_) => None,
            Self::Sphere { radius } => Some(4.0 / 3.0 * PI * radius.powi(3)),
            Self::Capsule { radius, length } => {
                Some(PI * radius * radius * (length + 4.0 / 3.0 * radius))
            }
            Self::Box { size } => Some(size.x * size.y * size.z),
            Self::Cylinder { radius, length } => Some(PI * radius * radius * length),
            Self::Superellipsoid(body) => {
                let (axes, [along, across]) = (body.semi_axes(), body.exponents());
                // A. Jaklič, A. Leonardis, F. Solina: Segmentation and Recovery of Superquadrics, 2000, eq. (2.60).
                let shape = along
                    * across
                    * beta(0.5 * along + 1.0, along)
                    * beta(0.5 * across, 0.5 * across);
                Some(2.0 * axes.x * axes.y * axes.z * shape)
            }
            Self::Mesh(mesh) => Some(volume_and_centroid(mesh).0),
        }
    }

    /// Centroid of the volume in m, in the frame of the obstacle; `None` of a half-space and of a pipe.
    #[must_use]
    pub fn centroid(&self) -> Option<Vec3> {
        match self {
            Self::HalfSpace | Self::Pipe(_) => None,
            Self::Mesh(mesh) => Some(volume_and_centroid(mesh).1),
            _ => Some(Vec3::ZERO),
        }
    }

    /// Radius in m of a ball about a point that the form fits in; infinite for a half-space and a pipe.
    pub(crate) fn reach_about(&self, point: Vec3) -> f64 {
        let of_box = |size: Vec3| {
            let farthest = [0, 1, 2].map(|i| point[i].abs() + 0.5 * size[i]);
            Vec3::from(farthest).norm()
        };
        match self {
            Self::HalfSpace | Self::Pipe(_) => f64::INFINITY,
            Self::Sphere { radius } => point.norm() + radius,
            Self::Capsule { radius, length } => point.norm() + radius + 0.5 * length,
            Self::Box { size } => of_box(*size),
            Self::Cylinder { radius, length } => {
                (point.x.hypot(point.y) + radius).hypot(point.z.abs() + 0.5 * length)
            }
            Self::Superellipsoid(body) => of_box(body.semi_axes() * 2.0),
            Self::Mesh(mesh) => {
                mesh.vertices().iter().map(|&v| (v - point).norm()).fold(0.0, f64::max)
            }
        }
    }
}

/// By the tetrahedra between the triangles and a vertex.
fn volume_and_centroid(mesh: &Mesh) -> (f64, Vec3) {
    let vertices = mesh.vertices();
    let origin = vertices[0];
    let (mut volume, mut moment) = (0.0, Vec3::ZERO);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|k| vertices[k as usize] - origin);
        let part = a.dot(b.cross(c)) / 6.0;
        volume += part;
        moment += (a + b + c) * (0.25 * part);
    }
    (volume, origin + moment / volume)
}

/// B(x, y) = Γ(x) Γ(y)/Γ(x + y).
fn beta(x: f64, y: f64) -> f64 {
    (ln_gamma(x) + ln_gamma(y) - ln_gamma(x + y)).exp()
}

/// Stirling's series, after the recurrence has led to an argument of at least 10.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0);
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series =
        (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * PI).ln() + series - product.ln()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::superellipsoid::Superellipsoid;
    use super::*;

    #[test]
    fn volumes_and_centroids_are_those_of_the_forms() {
        let axes = Vec3::new(0.02, 0.03, 0.05);
        let body = |exponents| Form::Superellipsoid(Superellipsoid::new(axes, exponents).unwrap());
        let ellipsoid = 4.0 / 3.0 * PI * axes.x * axes.y * axes.z;
        assert!((body([1.0, 1.0]).volume().unwrap() / ellipsoid - 1.0).abs() < 1e-12);
        // Summed over thin slices.
        let exponents: [f64; 2] = [0.6, 1.4];
        let slices = 4000;
        let area = |p: f64| {
            let strip = |k: i32| {
                let x = (f64::from(k) + 0.5) / f64::from(slices);
                (1.0 - x.powf(p)).powf(1.0 / p) / f64::from(slices)
            };
            (0..slices).map(strip).sum::<f64>()
        };
        let of_section = area(2.0 / exponents[1]);
        let height = |k: i32| {
            let z = (f64::from(k) + 0.5) / f64::from(slices);
            (1.0 - z.powf(2.0 / exponents[0])).powf(exponents[0]) / f64::from(slices)
        };
        let sum =
            8.0 * axes.x * axes.y * axes.z * of_section * (0..slices).map(height).sum::<f64>();
        assert!((body(exponents).volume().unwrap() / sum - 1.0).abs() < 1e-4);
        // A wedge, far from the origin.
        let far = Vec3::new(1.0, -2.0, 3.0);
        let corners = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]];
        let vertices = corners.map(|corner| Vec3::from(corner) + far);
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let wedge = Form::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap()));
        assert!((wedge.volume().unwrap() / (0.3 * 0.2 * 0.1 / 6.0) - 1.0).abs() < 1e-9);
        let centre = far + Vec3::new(0.3, 0.2, 0.1) / 4.0;
        assert!((wedge.centroid().unwrap() - centre).norm() < 1e-9);
        assert!((wedge.reach_about(far) - 0.3).abs() < 1e-12);
        assert_eq!(Form::HalfSpace.volume(), None);
    }
}
