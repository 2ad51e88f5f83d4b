//! Straight pieces of cable between two disks.

use whipcord_numerics::{Pose, Vec3};

use crate::section::BodyWrench;
use crate::statics::passages::Passage;

/// A straight piece of cable, in the frame of the disk nearer the base.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chord {
    /// `t`.
    pub along: Vec3,
    /// `ℓ` in m.
    pub length: f64,
}

impl Chord {
    /// Of a passage whose end stands on a cross-section at `pose`, as seen from the near disk.
    #[inline(always)]
    pub fn between(passage: &Passage, pose: &Pose) -> Self {
        let way = pose.transform(passage.far) - passage.near;
        let length = way.norm();
        Self { along: way * (1.0 / length), length }
    }
}

/// What a unit tension exerts at the near disk.
#[inline(always)]
pub(super) fn unit_pull(near: Vec3, chord: &Chord) -> BodyWrench {
    along_cable(near, chord.along)
}

/// The wrench of a force that acts at a hole.
#[inline(always)]
pub(super) fn along_cable(near: Vec3, force: Vec3) -> BodyWrench {
    BodyWrench { linear: force, angular: near.cross(force) }
}
