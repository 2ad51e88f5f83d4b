//! The answers to the steps of a case.

use whipcord::{Case, Solution, Vec3};

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

    /// The steps in which things weigh what they do in the last one, with their numbers from 0: `MuJoCo` has one gravity.
    pub fn under_last_weight<'a>(
        &'a self,
        case: &'a Case,
    ) -> impl Iterator<Item = (usize, &'a Solution)> {
        let last = weight(case);
        let of_steps = self.steps.iter().enumerate().zip(&self.cases);
        of_steps
            .filter(move |(_, step)| weight(step) == last && step.loads.masses == case.loads.masses)
            .map(|(numbered, _)| numbered)
    }
}

/// The acceleration of gravity of a case in m/s², in the world.
pub fn weight(case: &Case) -> Vec3 {
    let gravity = case.loads.gravity.unwrap_or(Vec3::ZERO);
    case.loads.to_world(case.base.rotation).rotate(gravity)
}
