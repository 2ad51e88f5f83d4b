//! A contact of a movable object with an obstacle, or with another object.

use whipcord_numerics::Vec3;

use super::body::Nearest;
use super::friction::Grip;

/// Pairs are looked at from this distance on, as a part of the robot's length.
pub(super) const NEAR: f64 = 2e-3;
/// A part of one obstacle near another; one of them can move, or both.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectPair {
    /// The obstacle whose part it is.
    pub owner: usize,
    pub other: usize,
    /// Which part of it.
    pub part: usize,
    pub nearest: Nearest,
    pub rounding: f64,
    /// Where they touch, as the base sees it.
    pub point: Vec3,
    /// Force along the normal on the owner in N, not negative.
    pub force: f64,
    /// `None` without friction.
    pub grip: Option<Grip>,
}

impl ObjectPair {
    /// The force on the owner in N.
    pub fn total(&self) -> Vec3 {
        self.nearest.normal * self.force + self.grip.map_or(Vec3::ZERO, |grip| grip.traction)
    }

    /// Takes over what a step found, or a part of it.
    pub fn hold(&mut self, force: f64, sticks: bool, traction: Vec3, part: f64) {
        self.force = (self.force + part * (force - self.force)).max(0.0);
        let touches = self.force > 0.0;
        if let Some(grip) = &mut self.grip {
            grip.take(touches, sticks, traction, part);
        }
    }
}
