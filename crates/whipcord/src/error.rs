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
        "the section at arc length {arc_length:.6} m folds: under {tension:.6} N cable `{cable}` has no length left there; the last load that converged is {last_load:.4} of the given one; pull the cable less, or stiffen the backbone"
    )]
    SectionFolds {
        /// Name of the cable.
        cable: String,
        /// Where, in m.
        arc_length: f64,
        /// Tension of that cable in N.
        tension: f64,
        /// Fraction of what was given up to which equilibrium was found, from 0 to 1: of the
        /// tensions when those alone fold the section, else of the loads.
        last_load: f64,
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

    /// A section that cannot be bent so far that its cable gets as short as prescribed.
    #[error(
        "between disks {disk} and {next_disk} cable `{cable}` cannot be {requested:.6e} m long: that section takes lengths from {shortest:.6e} m to {longest:.6e} m; shorten the cable less",
        next_disk = disk + 1
    )]
    SectionOutOfReach {
        /// Name of the cable.
        cable: String,
        /// Number of the section's lower disk; the base disk is 1.
        disk: usize,
        /// Length prescribed there in m.
        requested: f64,
        /// Least length in m that the section takes, with the other cables as they are.
        shortest: f64,
        /// Length in m in the straight section; a cable prescribed to be longer is slack.
        longest: f64,
    },

    /// Cables whose lengths contradict each other by more than a least-squares answer can hide.
    #[error(
        "between disks {first_disk} and {last_disk} the prescribed cable lengths contradict each other: at the best compromise cable `{cable}` is still {excess:.6e} m too long; shorten its antagonists less"
    )]
    CablesConflict {
        /// Name of the cable that is farthest from its length.
        cable: String,
        /// Number of the disk where the conflict begins; the base disk is 1.
        first_disk: usize,
        /// Number of the disk where it ends.
        last_disk: usize,
        /// Length of that cable beyond the prescribed one in m.
        excess: f64,
    },

    /// A cable that does not decide which way its section bends.
    #[error(
        "between disks {disk} and {next_disk} cable `{cable}` has no lever arm (it runs through or across the centre), so shortening it bends the section no way in particular; move its holes outwards to one side",
        next_disk = disk + 1
    )]
    NoLever {
        /// Name of the cable.
        cable: String,
        /// Number of the section's lower disk; the base disk is 1.
        disk: usize,
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
