//! What stands in the robot's way.
//!
//! Every form says of a point how far from its surface it is, with a sign, and which way leads out.
//! `docs/theory/obstacles.md` has the definitions.

mod centreline;
mod form;
mod mesh;
mod movable;
mod nearest;
mod pipe;
mod solid;
mod superellipsoid;
mod surface;
mod topology;

use whipcord_numerics::{Pose, Vec3};

use crate::robot::limits::check_pose;
use crate::robot::{RobotError, limits};

pub use centreline::Bends;
pub use form::Form;
pub use mesh::{Mesh, MeshFile};
pub use movable::MovableBody;
pub use pipe::Pipe;
pub use superellipsoid::Superellipsoid;
pub use surface::Surface;

/// A rigid body that the robot must not enter: fixed in the world, or a movable object.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What messages and reports call it.
    pub name: String,
    /// Its form, in its own frame.
    pub form: Form,
    /// Where that frame is in the world; of a movable object, where it is while the robot is at rest.
    pub pose: Pose,
    /// Coefficient of Coulomb friction between it and the robot; 0 for none. Between two obstacles the smaller one of theirs counts.
    pub friction: f64,
    /// What makes it a movable object; `None` for a fixed obstacle.
    pub movable: Option<MovableBody>,
}

impl Obstacle {
    /// The surface as a point in the world sees it.
    #[must_use]
    pub fn surface(&self, point: Vec3) -> Surface {
        let local = self.pose.rotation.conjugate().rotate(point - self.pose.position);
        let Surface { distance, normal } = self.form.surface(local);
        Surface { distance, normal: self.pose.rotation.rotate(normal) }
    }

    /// Whether it has friction.
    pub(crate) fn has_friction(&self) -> bool {
        self.friction > 0.0
    }

    /// Whether its pose in an answer follows from the steps before: it rubs, or it can move.
    #[must_use]
    pub fn has_history(&self) -> bool {
        self.has_friction() || self.movable.is_some()
    }

    pub(crate) fn check(&self) -> Result<(), RobotError> {
        check_pose(&self.pose)?;
        limits::FRICTION.check("friction", self.friction)?;
        if let Some(body) = &self.movable {
            body.check(&self.form)?;
        }
        let tube = |radius, length| {
            limits::LENGTH.check("radius", radius)?;
            limits::LENGTH.check("length", length)
        };
        match self.form {
            Form::Sphere { radius } => limits::LENGTH.check("radius", radius),
            Form::Capsule { radius, length } | Form::Cylinder { radius, length } => {
                tube(radius, length)
            }
            Form::Box { size } => limits::LENGTH.check_vector("size", size),
            // Valid by construction.
            Form::HalfSpace | Form::Pipe(_) | Form::Superellipsoid(_) | Form::Mesh(_) => Ok(()),
        }
    }
}
