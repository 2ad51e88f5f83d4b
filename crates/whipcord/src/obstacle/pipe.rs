//! A bore with open ends.

use std::sync::Arc;

use whipcord_numerics::Vec3;

use super::centreline::{Bends, Centreline, Foot, Where};
use super::surface::Surface;
use crate::robot::{Problem, RobotError, limits};

/// A bore of circular section through a body that surrounds it on all sides and ends where it ends:
/// inside it and beyond its ends, nothing is in the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Pipe {
    radius: f64,
    points: Arc<[Vec3]>,
    centreline: Arc<Centreline>,
}

impl Pipe {
    /// The bore of this radius in m about a line through points, which bends as told.
    ///
    /// # Errors
    /// [`RobotError`] with the path `radius` or `points` where a number cannot be, where two points
    /// that follow each other coincide, and where a smooth line bends more sharply than the bore
    /// can follow.
    pub fn new(radius: f64, points: &[Vec3], bends: Bends) -> Result<Self, RobotError> {
        limits::LENGTH.check("radius", radius)?;
        let centreline = Centreline::new(points, bends)?;
        let sharpest = centreline.sharpest();
        if sharpest * radius >= 1.0 {
            let problem = Problem::BendsTooSharply { radius, sharpest: 1.0 / sharpest };
            return Err(RobotError::new("points", problem));
        }
        Ok(Self { radius, points: points.into(), centreline: Arc::new(centreline) })
    }

    /// In m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The points its middle goes through.
    #[must_use]
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// How its middle goes from point to point.
    #[must_use]
    pub fn bends(&self) -> Bends {
        self.centreline.bends()
    }

    /// Points of its middle, close enough for a picture, and the unit tangents there.
    #[must_use]
    pub fn middle(&self) -> (&[Vec3], &[Vec3]) {
        self.centreline.samples()
    }

    /// The signed distance of the body around the bore. With d the distance from the line, R the
    /// radius, and for a point beside an end its distances a beyond the end's plane and ρ from the
    /// end's tangent:
    ///
    /// - in the bore R − d,
    /// - beyond an end, facing the bore √(a² + (R − ρ)²), the distance from the mouth's rim,
    /// - beyond an end, facing the body a,
    /// - in the body R − d, or −a where the way out through the end is shorter.
    pub(super) fn surface(&self, point: Vec3) -> Surface {
        let Foot { foot, tangent, place } = self.centreline.nearest(point);
        let away = point - foot;
        let distance = away.norm();
        // The way to the line, by which the bore's wall is left; on the line all are as long.
        let inwards = if distance > 0.0 { -(away / distance) } else { across(tangent) };
        match place {
            Where::Along => self.wall(point, distance, inwards),
            Where::Beyond { outwards } => {
                let beyond = away.dot(outwards).max(0.0);
                let radial = away - beyond * outwards;
                let rho = radial.norm();
                if rho >= self.radius {
                    return Surface { distance: beyond, normal: outwards };
                }
                let inwards = if rho > 0.0 { -(radial / rho) } else { across(tangent) };
                let (a, b) = (beyond, self.radius - rho);
                let distance = a.hypot(b);
                let normal = (a / distance) * outwards + (b / distance) * inwards;
                Surface { distance, normal }
            }
        }
    }

    /// At a point whose nearest point of the line is not an end.
    fn wall(&self, point: Vec3, from_line: f64, inwards: Vec3) -> Surface {
        let wall = Surface { distance: self.radius - from_line, normal: inwards };
        if wall.distance >= 0.0 {
            return wall;
        }
        let through_ends = self.centreline.ends().map(|(end, outwards)| Surface {
            distance: (point - end).dot(outwards),
            normal: outwards,
        });
        let shorter = |best: Surface, end: Surface| {
            if end.distance > 0.0 || end.distance <= best.distance {
                return best;
            }
            // Behind a bend, the plane of an end is none of the body's surface. It is where the
            // point just beyond it is beyond the end.
            let just_beyond = point + (1e-6 * self.radius - end.distance) * end.normal;
            let way_out = self.centreline.nearest(just_beyond);
            match way_out.place {
                Where::Beyond { outwards } if outwards == end.normal => end,
                _ => best,
            }
        };
        through_ends.into_iter().fold(wall, shorter)
    }
}

/// A unit vector at right angles to a unit vector.
fn across(t: Vec3) -> Vec3 {
    let least = if t.x.abs() <= t.y.abs() && t.x.abs() <= t.z.abs() {
        Vec3::X
    } else if t.y.abs() <= t.z.abs() {
        Vec3::Y
    } else {
        Vec3::Z
    };
    let v = t.cross(least);
    v / v.norm()
}
