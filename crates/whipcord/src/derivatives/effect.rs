//! What acts within a step or a stage of it, and how the end of the step moves with it.

use whipcord_numerics::{Mat3, Vec3};

/// How the end of a step moves with something that acts within it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effect {
    pub turn: Vec3,
    pub moment: Vec3,
    pub shift: Vec3,
    pub force: Vec3,
}

impl Effect {
    pub fn plus(self, other: &Self) -> Self {
        Self {
            turn: self.turn + other.turn,
            moment: self.moment + other.moment,
            shift: self.shift + other.shift,
            force: self.force + other.force,
        }
    }

    /// So many times as much.
    pub fn times(&self, f: f64) -> Self {
        Self {
            turn: f * self.turn,
            moment: f * self.moment,
            shift: f * self.shift,
            force: f * self.force,
        }
    }

    /// With what turns with the section there.
    pub fn with_follower(mut self, [by_moment, by_force]: &[Mat3; 2]) -> Self {
        self.moment += *by_moment * self.turn;
        self.force += *by_force * self.turn;
        self
    }

    /// What an effect is worth where the other is a sensitivity.
    pub fn dot(&self, other: &Self) -> f64 {
        self.turn.dot(other.turn)
            + self.moment.dot(other.moment)
            + self.shift.dot(other.shift)
            + self.force.dot(other.force)
    }
}

/// What acts within a stage: the explicit change `e` of the section equations, that of the force, and
/// those of the rates of moment and force, in the base frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Forcing {
    pub force_balance: Vec3,
    pub moment_balance: Vec3,
    pub force: Vec3,
    pub torque: Vec3,
    pub rate: Vec3,
}

impl Forcing {
    /// So many times as much.
    pub fn times(&self, f: f64) -> Self {
        Self {
            force_balance: f * self.force_balance,
            moment_balance: f * self.moment_balance,
            force: f * self.force,
            torque: f * self.torque,
            rate: f * self.rate,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        Self {
            force_balance: self.force_balance + other.force_balance,
            moment_balance: self.moment_balance + other.moment_balance,
            force: self.force + other.force,
            torque: self.torque + other.torque,
            rate: self.rate + other.rate,
        }
    }

    /// What a forcing is worth where the other is a sensitivity.
    pub fn dot(&self, other: &Self) -> f64 {
        self.force_balance.dot(other.force_balance)
            + self.moment_balance.dot(other.moment_balance)
            + self.force.dot(other.force)
            + self.torque.dot(other.torque)
            + self.rate.dot(other.rate)
    }
}
