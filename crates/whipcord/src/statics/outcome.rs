//! How a solve on one grid ended.

use whipcord_numerics::Unsolved;

use super::command::Command;
use crate::error::SolveError;
use crate::length_miss::LengthMiss;
use crate::section::{Fault, SectionFault};
use crate::solution::Diagnostics;

/// How an answer was found.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    pub iterations: usize,
    pub residual: f64,
    /// The fraction of the load at which the robot lost its stability on the way from no load.
    pub lost_at: Option<f64>,
}

/// Why there is none.
#[derive(Clone, Debug)]
pub(crate) enum Failure {
    Folds {
        cable: usize,
        arc_length: f64,
        tension: f64,
        last_load: f64,
    },
    Unreachable {
        cable: usize,
        length: f64,
    },
    /// What each cable is too long by at the best compromise, in m; 0 for those that take no part.
    Contradictory {
        misses: Vec<f64>,
    },
    /// That give the prescribed lengths.
    TensionsNotFound,
    Buckled {
        lost_at: f64,
        iterations: usize,
    },
    NotConverged {
        iterations: usize,
        residual: f64,
        last_load: f64,
        advice: &'static str,
    },
}

/// Why multiple shooting did not converge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Open {
    pub iterations: usize,
    pub gap: f64,
    pub fault: Option<Fault>,
}

impl From<Unsolved<Fault>> for Open {
    fn from(unsolved: Unsolved<Fault>) -> Self {
        let Unsolved { iterations, residual: gap, fault } = unsolved;
        Self { iterations, gap, fault }
    }
}

impl Found {
    /// With this effort, and no stability lost on the way.
    pub const fn with(effort: Effort) -> Self {
        Self { iterations: effort.iterations, residual: effort.residual, lost_at: None }
    }

    /// What is told of an answer on so many steps, without its stability.
    pub fn diagnostics(&self, steps: usize, discretization_error: Option<f64>) -> Diagnostics {
        Diagnostics {
            iterations: self.iterations,
            residual: self.residual,
            discretization_error,
            steps,
            stability_lost_at: self.lost_at,
            ..Diagnostics::default()
        }
    }

    /// With the effort of an earlier stage of the same solve added.
    pub fn after(self, earlier: &Self) -> Self {
        let lost_at = self.lost_at.or(earlier.lost_at);
        Self { iterations: self.iterations + earlier.iterations, lost_at, ..self }
    }
}

impl Failure {
    /// A section without equilibrium, under these tensions in N.
    pub fn of_section(fault: Fault, tensions: &[f64], last_load: f64) -> Self {
        match fault.kind {
            SectionFault::Folded { cable } => Self::Folds {
                cable,
                arc_length: fault.arc_length,
                tension: tensions[cable],
                last_load,
            },
            SectionFault::Diverged => Self::NotConverged {
                iterations: 0,
                residual: 1.0,
                last_load,
                advice: "a section finds no equilibrium: tension or load is beyond what it bears",
            },
        }
    }

    /// With the fraction of the step up to which there were answers.
    pub fn reached(self, fraction: f64) -> Self {
        match self {
            Self::Folds { cable, arc_length, tension, .. } => {
                Self::Folds { cable, arc_length, tension, last_load: fraction }
            }
            Self::NotConverged { iterations, residual, advice, .. } => {
                Self::NotConverged { iterations, residual, last_load: fraction, advice }
            }
            other => other,
        }
    }

    /// In the words of the robot: cables by their name and their length in m at rest, in the order
    /// of the commands.
    pub fn explain(
        self,
        commands: &[Command],
        rest_lengths: &[f64],
        name: impl Fn(usize) -> String,
    ) -> SolveError {
        match self {
            Self::Folds { cable, arc_length, tension, last_load } => {
                SolveError::SectionFolds { cable: name(cable), arc_length, tension, last_load }
            }
            Self::Unreachable { cable, length } => {
                let initial = rest_lengths[cable];
                let requested = match commands[cable] {
                    Command::Length { target, .. } => initial - target,
                    Command::Tension(_) => 0.0,
                };
                let reachable = initial - length;
                SolveError::UnreachableLength { cable: name(cable), requested, reachable }
            }
            Self::Contradictory { misses } => {
                let missed = misses.iter().enumerate().filter(|&(_, &excess)| excess > 0.0);
                let misses = missed.map(|(i, &excess)| LengthMiss { cable: name(i), excess });
                SolveError::ContradictoryLengths { misses: misses.collect() }
            }
            Self::TensionsNotFound => SolveError::TensionsNotFound,
            Self::Buckled { lost_at, iterations } => {
                SolveError::Buckled { load: lost_at, iterations }
            }
            Self::NotConverged { iterations, residual, last_load, advice } => {
                // A start from which no section was solved leaves all of the equations.
                let residual = if residual.is_finite() { residual } else { 1.0 };
                SolveError::NotConverged { iterations, residual, last_load, advice }
            }
        }
    }
}

/// Effort and quality of an answer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    pub iterations: usize,
    /// Largest length left over, relative to the backbone's length.
    pub residual: f64,
}
