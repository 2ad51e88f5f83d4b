//! Why a robot is not exported.

use thiserror::Error;
use whipcord::SolveError;

/// Why a robot is not exported.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExportError {
    /// The shape that is exported was not found, or the model refuses the robot.
    #[error("{error}")]
    Solve {
        /// The step, from 0.
        step: usize,
        /// What the model says.
        error: SolveError,
    },

    /// Something that the format cannot hold.
    #[error("{format} cannot hold {what} ({path}): {advice}")]
    Unsupported {
        /// The format.
        format: &'static str,
        /// What it is.
        what: &'static str,
        /// Where it stands, in the terms of the robot file.
        path: String,
        /// What to do.
        advice: &'static str,
    },

    /// A model without tensions.
    #[error(
        "{format} needs the tension of each cable, and {model} gives none: choose a model with forces, such as --model cosserat-disks"
    )]
    NoTensions {
        /// The format.
        format: &'static str,
        /// The model.
        model: &'static str,
    },

    /// More bodies than a program reads.
    #[error(
        "there would be {given} bodies, and {format} takes at most {most}: give a smaller --per-span (it is {per_span}), or fewer disks"
    )]
    TooManyBodies {
        /// The format.
        format: &'static str,
        /// How many there would be.
        given: usize,
        /// The most.
        most: usize,
        /// Elements for each span.
        per_span: usize,
    },

    /// A name that cannot be written.
    #[error(
        "the name {name:?} is empty or has control characters, which XML cannot hold: rename it"
    )]
    Name {
        /// The name.
        name: String,
    },

    /// A pose of the answer that no joint angles of the chain have.
    #[error(
        "between two bodies at arc length {arc_length} m the shape bends by {angle} rad, more than the joints of the chain can: give a greater --per-span"
    )]
    BentTooFar {
        /// In m.
        arc_length: f64,
        /// In rad.
        angle: f64,
    },

    /// The file could not be put together.
    #[error("the file cannot be put together: {reason}")]
    Unwritten {
        /// Why.
        reason: String,
    },
}
