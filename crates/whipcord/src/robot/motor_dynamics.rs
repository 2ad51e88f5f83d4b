//! Inertia and position loop of a motor.

use super::error::RobotError;
use super::limits;
use super::range::Range;

/// A motor that has inertia, and whose position is controlled: its command is the set-point of the loop.
///
/// Only motions take notice of it, eqs. (22) and (23) of the page on motion; in statics a motor is where its command says. All numbers are those of
/// the motor itself, before its gear: a spool of the moment of inertia `J` behind a gear of the ratio `n` adds `J/n²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorDynamics {
    /// Moment of inertia in kg·m² about the shaft of the motor; of a linear drive the mass in kg.
    pub inertia: f64,
    /// Viscous friction in N·m·s/rad, or N·s/m.
    pub damping: f64,
    /// Torque by the error of the position in N·m/rad, or force in N/m.
    pub proportional: f64,
    /// Torque by the rate of that error in N·m·s/rad, or force in N·s/m.
    pub derivative: f64,
    /// Torque by the integral of that error over time in N·m/(rad·s), or force in N/(m·s).
    pub integral: f64,
}

impl MotorDynamics {
    /// A motor of this inertia without friction, under a proportional loop.
    #[must_use]
    pub const fn new(inertia: f64, proportional: f64) -> Self {
        Self { inertia, damping: 0.0, proportional, derivative: 0.0, integral: 0.0 }
    }

    /// Its numbers by the keys of a robot file.
    #[must_use]
    pub const fn numbers(&self) -> [(&'static str, f64); 5] {
        [
            ("inertia", self.inertia),
            ("damping", self.damping),
            ("proportional_gain", self.proportional),
            ("derivative_gain", self.derivative),
            ("integral_gain", self.integral),
        ]
    }

    /// `inertia` is what the drive admits.
    pub(super) fn check(&self, inertia: Range) -> Result<(), RobotError> {
        let ranges = [inertia, limits::GAIN, limits::PROPORTIONAL_GAIN, limits::GAIN, limits::GAIN];
        for ((key, value), range) in self.numbers().into_iter().zip(ranges) {
            range.check(key, value)?;
        }
        Ok(())
    }
}
