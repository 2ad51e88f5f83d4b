use thiserror::Error;

use crate::error::SolveError;
use crate::jobs::NoThreads;

/// Why there is no batch. A row that has no answer is no such error.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BatchError {
    /// The model cannot take the robot.
    #[error(transparent)]
    Model(#[from] SolveError),

    /// The commands are no whole number of rows.
    #[error(
        "{given} commands are no whole number of rows for {count} {}s: give one command for each {} of each row",
        driven.name(), driven.name()
    )]
    Width {
        /// How many were given.
        given: usize,
        /// Cables or motors of the robot.
        count: usize,
        /// What they command.
        driven: Driven,
    },

    /// A robot without cables or motors has no commands of them that could say how many rows there are.
    #[error("a robot without {}s has no rows of their commands: give the cases themselves", driven.name())]
    NoCommands {
        /// What they command.
        driven: Driven,
    },

    /// An array to write to has the wrong size.
    #[error(
        "the array of {name} holds {given} numbers where {needed} will be written: make it so long"
    )]
    Size {
        /// Which array.
        name: &'static str,
        /// How long it is.
        given: usize,
        /// How long it must be.
        needed: usize,
    },

    /// A sensitivity is no finite number.
    #[error("the sensitivities to {name} are {value} in row {row}: give finite numbers")]
    NotFinite {
        /// To what.
        name: &'static str,
        /// Row, from 0.
        row: usize,
        /// What is there: an infinity, or no number at all.
        value: f64,
    },

    /// The progress callback stopped the batch.
    #[error("the batch was stopped after {done} of {rows} rows")]
    Stopped {
        /// Rows that had been solved.
        done: usize,
        /// All rows.
        rows: usize,
    },

    /// The threads could not be started.
    #[error(transparent)]
    Threads(#[from] NoThreads),
}

/// What the commands of a batch are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// The cables.
    Cables,
    /// The motors.
    Motors,
}

impl Driven {
    /// One of them in words.
    const fn name(self) -> &'static str {
        match self {
            Self::Cables => "cable",
            Self::Motors => "motor",
        }
    }
}
