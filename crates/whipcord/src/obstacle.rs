//! What stands in the robot's way.

use whipcord_numerics::{Pose, Vec3};

use crate::case::{Case, check_pose};
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::robot::{RobotError, limits};

/// A rigid body, fixed in the world, that the robot must not enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What messages and reports call it.
    pub name: String,
    /// Its form, in its own frame.
    pub form: Form,
    /// Where that frame is in the world.
    pub pose: Pose,
}

/// The form of an obstacle, in the obstacle's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// All that lies below the plane z = 0: a floor, or a wall.
    HalfSpace,
    /// A ball around the origin.
    Sphere {
        /// In m.
        radius: f64,
    },
}

/// The surface of an obstacle as a point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Distance of the point from the surface in m, negative inside the obstacle.
    pub distance: f64,
    /// Gradient of the distance: a unit vector out of the obstacle.
    pub normal: Vec3,
}

/// Refuses a case with obstacles on behalf of a model that knows no contact.
pub(crate) fn refuse(model: ModelKind, case: &Case) -> Result<(), SolveError> {
    if case.obstacles.is_empty() {
        return Ok(());
    }
    Err(SolveError::Unsupported {
        model,
        path: "obstacles".to_owned(),
        what: "it knows no contact",
        advice: "use cosserat, or four-bar with the strain-energy objective",
    })
}

impl Obstacle {
    /// The surface as a point in the world sees it.
    #[must_use]
    pub fn surface(&self, point: Vec3) -> Surface {
        let local = self.pose.rotation.conjugate().rotate(point - self.pose.position);
        let Surface { distance, normal } = self.form.surface(local);
        Surface { distance, normal: self.pose.rotation.rotate(normal) }
    }

    pub(crate) fn check(&self) -> Result<(), RobotError> {
        check_pose(&self.pose)?;
        match self.form {
            Form::HalfSpace => Ok(()),
            Form::Sphere { radius } => limits::LENGTH.check("radius", radius),
        }
    }
}

impl Form {
    fn surface(&self, point: Vec3) -> Surface {
        match *self {
            Self::HalfSpace => Surface { distance: point.z, normal: Vec3::Z },
            Self::Sphere { radius } => {
                let away = point.norm();
                let normal = if away > 0.0 { point / away } else { Vec3::Z };
                Surface { distance: away - radius, normal }
            }
        }
    }
}
