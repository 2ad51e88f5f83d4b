//! The answers to the steps of a case.

use whipcord::{Case, Solution};

/// The answers to all steps; there is at least one.
#[derive(Clone, Debug)]
pub struct Answers {
    /// In the order of the steps.
    pub steps: Vec<Solution>,
    /// What was asked in each of them.
    pub cases: Vec<Case>,
}

impl Answers {
    /// The last answer.
    pub fn last(&self) -> Option<&Solution> {
        self.steps.last()
    }

    /// The steps under the loads of the last one, with their numbers from 0.
    pub fn under_last_loads<'a>(
        &'a self,
        case: &'a Case,
    ) -> impl Iterator<Item = (usize, &'a Solution)> {
        let of_steps = self.steps.iter().enumerate().zip(&self.cases);
        of_steps.filter(|(_, step)| step.loads == case.loads).map(|(numbered, _)| numbered)
    }
}
