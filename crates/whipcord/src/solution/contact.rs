//! Where the robot and movable objects touch.

use whipcord_numerics::{Pose, Vec3};

use crate::shape::Wrench;

/// A point at which the robot touches an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The obstacle, by its number in [`crate::Case::obstacles`].
    pub obstacle: usize,
    /// What of the robot touches it.
    pub part: Part,
    /// Arc length in m of the cross-section that touches.
    pub arc_length: f64,
    /// The point, in the frame that the pose of the base is given in.
    pub point: Vec3,
    /// Unit normal out of the obstacle, in the same frame.
    pub normal: Vec3,
    /// With how much the obstacle pushes the robot along the normal, in N; `None` from a model that
    /// knows no forces.
    pub force: Option<f64>,
    /// The force along the surface with which friction holds the robot back, in N and the same frame; zero
    /// where the obstacle does not rub, and `None` from a model that knows no forces.
    pub friction: Option<Vec3>,
    /// Whether friction keeps it from sliding.
    pub sticks: bool,
    /// Distance between robot and obstacle in m; negative where they overlap by a remainder of the
    /// iteration.
    pub gap: f64,
}

/// A movable object in equilibrium: the contacts with the robot ([`crate::Solution::contacts`]) and with obstacles balance its load.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectState {
    /// The obstacle that it is, by its number in [`crate::Case::obstacles`].
    pub obstacle: usize,
    /// Pose of the obstacle's frame, in the frame that the pose of the base is given in.
    pub pose: Pose,
    /// Centre of mass, in the same frame.
    pub center_of_mass: Vec3,
    /// Its weight and its own load at its centre of mass, in the same frame.
    pub load: Wrench,
    /// The sum of its load and of all contact forces, about its centre of mass: a remainder of the iteration.
    pub imbalance: Wrench,
    /// `1 − ‖t‖/(μλ)` of the contact that is nearest to sliding, of those with the robot and of its own; `None` without friction.
    pub slip_margin: Option<f64>,
    /// Where it touches other obstacles than the robot.
    pub contacts: Vec<ObjectContact>,
}

/// A point at which a movable object touches an obstacle, or another object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectContact {
    /// What it touches, by its number in [`crate::Case::obstacles`].
    pub obstacle: usize,
    /// The point, in the frame that the pose of the base is given in.
    pub point: Vec3,
    /// Unit normal towards the object, in the same frame.
    pub normal: Vec3,
    /// With how much the object is pushed along the normal, in N.
    pub force: f64,
    /// The force along the surface on the object, in N and the same frame.
    pub friction: Vec3,
    /// Whether friction keeps it from sliding.
    pub sticks: bool,
    /// Distance in m; negative where they overlap by a remainder of the iteration.
    pub gap: f64,
}

/// A part of the robot that can touch an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The backbone.
    Backbone,
    /// This disk, from 0 at the base.
    Disk(usize),
}

impl Part {
    /// The name in outputs: `backbone` or `disk`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Backbone => "backbone",
            Self::Disk(_) => "disk",
        }
    }

    /// The disk that it is.
    #[must_use]
    pub fn disk(self) -> Option<usize> {
        match self {
            Self::Backbone => None,
            Self::Disk(disk) => Some(disk),
        }
    }
}
