//! What the motors of a robot give in an answer.

use crate::robot::{Motor, Robot};
use crate::solution::Solution;

/// A motor in an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorState {
    /// Its command: the angle in rad, or the travel in m; `None` where its cables were driven in another way.
    pub command: Option<f64>,
    /// Torque of the motor in N·m, or force of a linear drive in N: what holds the tensions of its cables, without losses in the
    /// gear. `None` from a model that knows no tensions.
    pub effort: Option<f64>,
    /// How much of its limit that is; above 1 the motor cannot hold the answer. `None` without a limit.
    pub utilization: Option<f64>,
}

impl MotorState {
    /// Of each motor of a robot in an answer to these commands ([`crate::Case::motors`]).
    #[must_use]
    pub fn all(robot: &Robot, commands: &[Option<f64>], solution: &Solution) -> Vec<Self> {
        let tension = |cable: usize| solution.cables.get(cable).and_then(|cable| cable.tension);
        let of_motor = |(number, motor): (usize, &Motor)| {
            let effort = motor.effort(tension);
            let limit = motor.limits.effort.filter(|limit| *limit > 0.0);
            Self {
                command: commands.get(number).copied().flatten(),
                effort,
                utilization: limit.zip(effort).map(|(limit, effort)| effort.abs() / limit),
            }
        };
        robot.motors().iter().enumerate().map(of_motor).collect()
    }

    /// Whether it is beyond the limit of its motor.
    #[must_use]
    pub fn is_overloaded(&self) -> bool {
        self.utilization.is_some_and(|part| part > 1.0)
    }
}
