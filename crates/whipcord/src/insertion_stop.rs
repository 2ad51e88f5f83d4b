//! Why a robot cannot be inserted into a pipe any farther.

use thiserror::Error;

use crate::format::{Round, millimetres, significant};

/// Why a robot cannot be inserted into a pipe any farther.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InsertionStop {
    /// The model has no answer under the pushes of the pipe.
    #[error("there {reason}")]
    Model {
        /// What the model says.
        reason: String,
    },
    /// No equilibrium inside the pipe was found.
    #[error(
        "farther in, no equilibrium without overlap was found (residual {})",
        significant(*residual, 3, Round::Nearest)
    )]
    NotConverged {
        /// What is left of the conditions of contact, relative to length and forces of the robot.
        residual: f64,
    },
    /// However little it goes on, it leaps to another shape.
    #[error("farther in, it jumps to another shape, and no equilibrium was found there")]
    Leaps,
    /// The search took more iterations than a solve may spend on the way in.
    #[error(
        "there the search was given up after {iterations} iterations, with {contacts} contacts (residual {})",
        significant(*residual, 3, Round::Nearest)
    )]
    BudgetSpent {
        /// Iterations on the way in.
        iterations: usize,
        /// What was left of the conditions of contact, relative to length and forces of the robot.
        residual: f64,
        /// Contacts and parts close to the pipe at the end.
        contacts: usize,
    },
    /// A disk without clearance wedges.
    #[error(
        "disk {} has a clearance of {} around it, and wedges where it tilts: it needs {} at least",
        disk + 1, millimetres(*clearance, Round::Nearest), millimetres(*enough, Round::Up)
    )]
    NoClearance {
        /// Number of the disk, from 0.
        disk: usize,
        /// Radius of the bore less that of the disk, in m.
        clearance: f64,
        /// A clearance in m that is enough.
        enough: f64,
    },
    /// More parts of the robot are close to the pipe than can be solved together.
    #[error(
        "there {contacts} of its parts are close to the pipe, and at most {most} can be solved together"
    )]
    TooManyContacts {
        /// Contacts and parts close to the pipe.
        contacts: usize,
        /// The most of them for this robot.
        most: usize,
    },
}
