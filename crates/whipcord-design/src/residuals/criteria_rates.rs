//! Derivatives of criteria as residuals.

use super::{Moved, Problem};
use crate::error::DesignError;
use crate::unknown::{Unknown, Varied};

impl Problem<'_> {
    /// Derivatives of the residuals of criteria: those of the core, and differences where it has none.
    pub(super) fn criteria_jacobian(
        &mut self,
        moved: &Moved,
        unknowns: &[f64],
        into: &mut [f64],
    ) -> Result<(), DesignError> {
        let columns = unknowns.len();
        let Some(criteria) = self.criteria else { return Ok(()) };
        let varied = Varied {
            robot: &moved.robot,
            cases: &moved.cases,
            unknowns: &self.unknowns,
            parameters: &self.parameters,
        };
        // An answer whose derivatives do not exist, as where it buckles, may have differences.
        let rates = match self.stopped.as_ref().unwrap_or(criteria).rates(varied) {
            _ if self.budget.stop().is_cancelled() => return Err(DesignError::Ended),
            Err(error) if error.is_cancelled() => return Err(error),
            rates => rates.unwrap_or_default(),
        };
        if let Some(rates) = &rates {
            let terms = self.terms(unknowns)?;
            let root = self.penalty.sqrt();
            let violated = terms.violations.iter().zip(&self.shifts).zip(&rates.violations);
            let violated = violated
                .map(|((of, shift), rates)| (rates, if of + shift > 0.0 { root } else { 0.0 }));
            let rows = rates.objectives.iter().map(|rates| (rates, 1.0)).chain(violated);
            for (row, (rates, factor)) in into.chunks_exact_mut(columns).zip(rows) {
                row.iter_mut().zip(rates).for_each(|(into, rate)| *into = factor * rate);
            }
        }
        let is_of_commands = criteria.are_of_commands(&self.cases);
        for column in 0..columns {
            if rates.is_some() && self.unknowns[column].has_derivative() {
                continue;
            }
            if is_of_commands && !matches!(self.unknowns[column], Unknown::Tension { .. }) {
                continue;
            }
            if self.budget.is_over() {
                return Err(DesignError::Ended);
            }
            let step = self.steps[column];
            let mut side = |by: f64| -> Result<Vec<f64>, DesignError> {
                let mut moved = unknowns.to_vec();
                moved[column] += by;
                let terms = self.terms(&moved)?;
                Ok(self.of_criteria(&terms))
            };
            // At a bound that is one of physics, such as no tension, there is but one side.
            let (from, to, width) = match (side(-step), side(step)) {
                (Ok(from), Ok(to)) => (from, to, 2.0 * step),
                (Err(_), Ok(to)) => (side(0.0)?, to, step),
                (Ok(from), Err(_)) => (from, side(0.0)?, step),
                (Err(error), Err(_)) => return Err(error),
            };
            for (row, (from, to)) in from.iter().zip(&to).enumerate() {
                into[row * columns + column] = (to - from) / width;
            }
        }
        Ok(())
    }
}
