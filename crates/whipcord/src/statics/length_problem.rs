//! What it takes to find tensions that give prescribed cable lengths, and how that may end.

use super::command::Command;
use super::outcome::Failure;
use crate::budget::Meter;
use crate::section::Fault;

/// A rod that answers tensions with the lengths of its cables.
pub(crate) trait TensionResponse {
    /// Finds its shape under these tensions in N, starting from the last one when `warm`.
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault>;
    /// `ℓᵢ` in m.
    fn lengths(&self) -> &[f64];
    /// `∂ℓᵢ/∂τⱼ` by rows in m/N.
    fn length_by_tension(&self) -> &[f64];
    /// Allows as much effort from now on as this stage of a search deserves.
    fn allow(&mut self, _stage: Stage) {}
    /// Whether the effort that was allowed last is used up: the search then ends with what it has found.
    fn is_spent(&self) -> bool {
        false
    }
    /// How many steps in a row may end before a fold until it is taken for the limit.
    fn patience(&self) -> usize {
        20
    }
    /// Is told of each iteration that led to these tensions.
    fn note(&mut self, note: &Note, tensions: &[f64]);
}

/// The stages of a search for tensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Tensions that give the lengths.
    Tensions,
    /// Whether the lengths contradict one another.
    Contradiction,
    /// Whether the cables get as short as a part of the lengths says, from a neighbouring part.
    Part,
}

/// An iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Note {
    /// Its number, from 1 on.
    pub iteration: usize,
    /// Largest length left over, relative to the backbone's length.
    pub residual: f64,
    /// Fraction of the step that was taken.
    pub step: f64,
}

/// Why no tensions were found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LengthFault {
    /// A section fault that no tension brought about.
    Section(Fault),
    /// This cable cannot get as short as it should: `length` is the least it reaches.
    Unreachable { cable: usize, length: f64 },
    /// These lengths cannot be had together: what each cable is too long by in m at the best compromise,
    /// 0 where it takes no part.
    Contradictory { misses: Vec<f64> },
    /// The iteration limit, or no step that improves anything.
    Stalled,
}

impl LengthFault {
    /// As the failure of a solve; `of_section` says what a fault of a section is.
    pub fn failure(self, of_section: impl FnOnce(Fault) -> Failure) -> Failure {
        match self {
            Self::Section(fault) => of_section(fault),
            Self::Unreachable { cable, length } => Failure::Unreachable { cable, length },
            Self::Contradictory { misses } => Failure::Contradictory { misses },
            Self::Stalled => Failure::TensionsNotFound,
        }
    }
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// Length of the backbone in m.
    pub length: f64,
    pub commands: &'a [Command],
    /// Whether it is worth finding out how far cables go that do not go as far as they should.
    pub bracket: bool,
    pub meter: &'a Meter,
}

/// Takes the tension off the cables that are driven by length.
pub(crate) fn release(commands: &[Command], tensions: &mut [f64]) {
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if matches!(command, Command::Length { .. }) {
            *tension = 0.0;
        }
    }
}
