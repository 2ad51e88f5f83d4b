//! Why there is no motion.

use thiserror::Error;
use whipcord::{RobotError, SolveError};

/// Why a robot is not simulated, or why a step has no result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MotionError {
    /// A quantity of the case or of the loads cannot be, or does not fit the robot.
    #[error(transparent)]
    Invalid(#[from] RobotError),

    /// There is no equilibrium to start from.
    #[error(
        "no equilibrium to start the motion from: {0}; start from rest instead, or change the first commands"
    )]
    NoEquilibrium(#[from] SolveError),

    /// The equilibrium of the model with elements was not reached from that of the statics.
    #[error(
        "the equilibrium to start from was not reached: after {iterations} iterations the strains still change by {change:.1e}; use more elements, or start from rest"
    )]
    Unbalanced {
        /// Iterations.
        iterations: usize,
        /// The last change of the strains, times the length of the backbone where it is one of curvature.
        change: f64,
    },

    /// The motion would start inside of an obstacle.
    #[error(
        "the robot would start {:.2} mm deep in obstacles[{obstacle}]: move the obstacle or the base, or start from the equilibrium", depth * 1e3
    )]
    Overlap {
        /// Which obstacle.
        obstacle: usize,
        /// How deep in m.
        depth: f64,
    },

    /// A motor cannot hold the equilibrium to start from.
    #[error(
        "the motor `{name}` would need {needed:.3e} N·m or N to hold the equilibrium to start from, but its limit is {limit:.3e}; increase the limit, change the first commands or start from rest"
    )]
    MotorOverload {
        /// Name of the motor.
        name: String,
        /// What it would need.
        needed: f64,
        /// Its limit.
        limit: f64,
    },

    /// Motion needs a quantity that the robot does not give.
    #[error("the motion needs `{path}`: {advice}")]
    Missing {
        /// Which quantity, in the terms of the robot file.
        path: String,
        /// What to do.
        advice: &'static str,
    },

    /// A part of the robot or of the case that has no dynamics here.
    #[error("the motion cannot take `{path}` ({what}): {advice}")]
    Unsupported {
        /// Which part, in the terms of the robot file.
        path: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },

    /// A number that cannot be.
    #[error("{what} is {value}: {need}")]
    Option {
        /// The option or argument.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        need: &'static str,
    },

    /// A table over time that cannot be.
    #[error("row {row} of a course over time {problem}")]
    Course {
        /// The row, from 0.
        row: usize,
        /// What is wrong.
        problem: &'static str,
    },

    /// Lists whose lengths do not fit.
    #[error("{given} {what} were given, but there are {expected}")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many there must be.
        expected: usize,
    },

    /// A step whose equations were not solved, nor those of its parts.
    #[error(
        "the step at {time:.6} s was not solved, even in parts of {part:.1e} s: the last change of the strains is {change:.1e}; use a shorter step or the method `robust`, or ramp the command"
    )]
    NotConverged {
        /// Time at the beginning of the part in s.
        time: f64,
        /// Length in s of the last part that was tried.
        part: f64,
        /// The last change of the strains in an iteration; infinite where the equations had no values.
        change: f64,
    },

    /// Parts of a step that would have to be shorter than makes sense to reach the tolerance.
    #[error(
        "the tolerance of {tolerance:.1e} m is not reached at {time:.6} s: parts of {part:.1e} s still have the error {error:.1e} m; increase the tolerance, or ramp the command"
    )]
    Tolerance {
        /// Time in s.
        time: f64,
        /// Length in s of the last part that was tried.
        part: f64,
        /// Its estimated error in m.
        error: f64,
        /// The tolerance in m for the whole step.
        tolerance: f64,
    },

    /// The linearisation of a step, or of the equilibrium to start from, is singular.
    #[error(
        "no gradient: the linearisation of the step at {time:.6} s is singular, or its dead loads are too large for it; use a shorter step or other commands"
    )]
    NoGradient {
        /// Time at the beginning of the step in s.
        time: f64,
    },

    /// A motion that grazes an obstacle: how soon it hits has no derivative.
    #[error(
        "no gradient: the robot grazes an obstacle at {time:.6} s, so that it may as well miss it, and when it hits has no derivative; move the obstacle, or change the commands or the length of the steps a little"
    )]
    NotSmooth {
        /// Time in s at which it touches.
        time: f64,
    },

    /// A cable with friction that slides in a hole or is about to: what it does to small motions differs from side to side.
    #[error(
        "no {what}: a cable slides in a hole or is about to, so that what it does depends on the direction of the motion; let the robot come to rest after a disturbance, or leave the friction out"
    )]
    Sliding {
        /// What was asked for.
        what: String,
    },

    /// No natural vibrations were found.
    #[error(
        "no natural vibrations: the stiffness of the robot in this state is singular; use another state or give the cables other tensions"
    )]
    NoModes,
}

/// Refuses a list of another length than is expected.
pub(crate) const fn count(
    what: &'static str,
    given: usize,
    expected: usize,
) -> Result<(), MotionError> {
    if given == expected { Ok(()) } else { Err(MotionError::Count { what, given, expected }) }
}
