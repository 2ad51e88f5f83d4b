//! Why there is no answer.

use thiserror::Error;

use crate::model::ModelKind;
use crate::robot::RobotError;

/// Why a model gives no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SolveError {
    /// A quantity of the case cannot be, or does not fit the robot.
    #[error(transparent)]
    Invalid(#[from] RobotError),

    /// The model needs a quantity that the robot or the case does not give.
    #[error("the {model} model needs {path}: {advice}")]
    Missing {
        /// The model.
        model: ModelKind,
        /// Which quantity, in the terms of the robot file.
        path: String,
        /// What to do.
        advice: &'static str,
    },

    /// The model cannot take a part of the robot or of the case.
    #[error("the {model} model cannot take {path} ({what}): {advice}")]
    Unsupported {
        /// The model.
        model: ModelKind,
        /// Which part, in the terms of the robot file.
        path: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },

    /// The cables wind the section up so far that one of them has no length left in it.
    #[error(
        "the section at arc length {arc_length:.6} m folds: under {tension:.6} N cable `{cable}` has no length left there; pull it less, or stiffen the backbone"
    )]
    SectionFolds {
        /// Name of the cable.
        cable: String,
        /// Where, in m.
        arc_length: f64,
        /// Tension of that cable in N.
        tension: f64,
    },

    /// A prescribed cable length that no tension reaches.
    #[error(
        "cable `{cable}` cannot be shortened by {requested:.6e} m: {reachable:.6e} m is as far as it goes here; prescribe at most that"
    )]
    UnreachableLength {
        /// Name of the cable.
        cable: String,
        /// Shortening asked for in m.
        requested: f64,
        /// Greatest shortening that can be reached in m, with the other cables as they are.
        reachable: f64,
    },

    /// The iteration stopped before the equations were met.
    #[error(
        "no equilibrium was found: residual {residual:.3e} after {iterations} iterations; the last load that converged is {last_load:.4} of the given one; {advice}"
    )]
    NotConverged {
        /// Newton iterations spent.
        iterations: usize,
        /// What is left of the equations, relative to their scale.
        residual: f64,
        /// Fraction of the given load up to which equilibrium was found, from 0 to 1.
        last_load: f64,
        /// What to do.
        advice: &'static str,
    },

    /// The estimated error does not fall below the tolerance.
    #[error(
        "the discretisation error is still {error:.3e} m with {steps} steps, above the tolerance of {tolerance:.3e} m: relax the tolerance, or smooth the routing"
    )]
    StepsTooCoarse {
        /// Estimated error of a position in m.
        error: f64,
        /// Tolerance in m.
        tolerance: f64,
        /// Steps used.
        steps: usize,
    },
}
