//! From space onto paper.

use whipcord::Vec3;

use crate::svg::{Ellipse, Point};

/// A parallel projection: which way is right, up, and towards the viewer, and how many px are a
/// metre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projection {
    right: Vec3,
    up: Vec3,
    towards: Vec3,
    scale: f64,
    origin: Point,
}

impl Projection {
    /// Seen from this azimuth (rad, from x to y) and elevation above the x–y plane.
    pub fn axonometric(azimuth: f64, elevation: f64) -> Self {
        let (sin_a, cos_a) = azimuth.sin_cos();
        let (sin_e, cos_e) = elevation.sin_cos();
        Self::new(Vec3::new(-sin_a, cos_a, 0.0), Vec3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e))
    }

    /// One axis to the right and one up, both at right angles.
    pub fn new(right: Vec3, up: Vec3) -> Self {
        Self { right, up, towards: right.cross(up), scale: 1.0, origin: [0.0; 2] }
    }

    /// The same at this many px to the metre, with the origin of the base frame at this place.
    pub fn placed(self, scale: f64, origin: Point) -> Self {
        Self { scale, origin, ..self }
    }

    /// Px to the metre.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Direction to the viewer.
    pub fn towards(&self) -> Vec3 {
        self.towards
    }

    /// Right and up coordinates in m.
    pub fn plane(&self, point: Vec3) -> Point {
        [self.right.dot(point), self.up.dot(point)]
    }

    /// The place on paper.
    pub fn place(&self, point: Vec3) -> Point {
        let [x, y] = self.plane(point);
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    /// How near to the viewer a point is, in m.
    pub fn depth(&self, point: Vec3) -> f64 {
        self.towards.dot(point)
    }

    /// The image of a circle in the plane of two unit vectors.
    pub fn circle(&self, centre: Vec3, radius: f64, u: Vec3, v: Vec3) -> Ellipse {
        let axis = |a: Vec3| {
            let [x, y] = self.plane(a * radius);
            [self.scale * x, -self.scale * y]
        };
        Ellipse::image(self.place(centre), axis(u), axis(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_right_handed() {
        let p = Projection::axonometric(-1.0, 0.4);
        assert!((p.right.dot(p.up)).abs() < 1e-15);
        assert!((p.towards.norm() - 1.0).abs() < 1e-15);
        assert!(p.up.z > 0.0 && p.towards.z > 0.0);
        // Seen from above the base, y is up when x is right.
        assert_eq!(Projection::new(Vec3::X, Vec3::Y).towards, Vec3::Z);
        // From the front, the viewer stands at negative y.
        assert_eq!(Projection::new(Vec3::X, Vec3::Z).towards, -Vec3::Y);
    }

    #[test]
    fn a_circle_along_the_view_is_a_line() {
        let p = Projection::new(Vec3::X, Vec3::Z).placed(1000.0, [50.0, 60.0]);
        let e = p.circle(Vec3::new(0.01, 0.0, 0.02), 0.005, Vec3::X, Vec3::Y);
        assert!((e.centre[0] - 60.0).abs() < 1e-9 && (e.centre[1] - 40.0).abs() < 1e-9);
        assert!((e.radii[0] - 5.0).abs() < 1e-9 && e.radii[1].abs() < 1e-9);
        assert!(e.angle.sin().abs() < 1e-9);
    }
}
