//! Samples and variations of the rod in a span.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use crate::section::{BodyWrench, Strain};

/// The rod at the end of a span, in the frame of the disk the span starts from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct End {
    pub pose: Pose,
    /// Moment in the rod.
    pub moment: Vec3,
    /// Sum of the forces that turn with the rod and act inside the span.
    pub followers: Vec3,
}

/// A section of the span: what eq. (2) needs of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    pub strain: Strain,
    pub wrench: BodyWrench,
    pub rotation: UnitQuaternion,
    /// In the frame of the disk.
    pub position: Vec3,
    /// Dead load between the start of the span and here, in the frame of the disk.
    pub dead: Vec3,
}

/// A variation: rotation, displacement and moment in the body frame, force in that of the disk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variation {
    pub turn: Vec3,
    pub shift: Vec3,
    pub moment: Vec3,
    pub force: Vec3,
}

impl Variation {
    #[inline(always)]
    pub fn plus(&self, f: f64, slope: &Self) -> Self {
        Self {
            turn: self.turn + f * slope.turn,
            shift: self.shift + f * slope.shift,
            moment: self.moment + f * slope.moment,
            force: self.force + f * slope.force,
        }
    }
}
