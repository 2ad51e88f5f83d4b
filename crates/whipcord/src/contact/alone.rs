//! Answers without obstacles that several attempts at a case among obstacles ask for.

use core::cell::RefCell;

use whipcord_numerics::Pose;

use crate::case::{CableCommand, Case, Loads};
use crate::error::SolveError;
use crate::solution::Solution;

/// What a model without history makes an answer of.
#[derive(Debug, PartialEq)]
struct Asked {
    commands: Vec<CableCommand>,
    loads: Loads,
    base: Pose,
}

impl Asked {
    fn of(Case { commands, loads, base, .. }: &Case) -> Self {
        Self { commands: commands.clone(), loads: loads.clone(), base: *base }
    }
}

/// What came of cases without obstacles of a robot without history. Each is solved from rest, once, though the ways on few steps and on more, those from
/// the other side and the reason why there is no answer may all ask for it.
#[derive(Debug, Default)]
pub(crate) struct AloneAnswers(RefCell<Vec<(Asked, Result<Solution, SolveError>)>>);

impl AloneAnswers {
    /// With what is known of one case.
    pub fn knowing(case: &Case, found: Option<Result<Solution, SolveError>>) -> Self {
        let answers = Self::default();
        if let Some(found) = found {
            answers.keep(Asked::of(case), &found);
        }
        answers
    }

    /// The answer to a case, solved where it is not known.
    pub fn answer(
        &self,
        case: &Case,
        solve: impl FnOnce() -> Result<Solution, SolveError>,
    ) -> Result<Solution, SolveError> {
        let asked = Asked::of(case);
        let known = self.0.borrow().iter().find(|(of, _)| *of == asked).map(|(_, it)| it.clone());
        known.unwrap_or_else(|| {
            let found = solve();
            self.keep(asked, &found);
            found
        })
    }

    fn keep(&self, asked: Asked, found: &Result<Solution, SolveError>) {
        // One that spent what there was would have no more.
        if !matches!(found, Err(SolveError::Cancelled { .. })) {
            self.0.borrow_mut().push((asked, found.clone()));
        }
    }
}
