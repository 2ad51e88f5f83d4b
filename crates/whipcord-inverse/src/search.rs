//! The search for one target: from a start to an answer that a solve from rest confirms.

use whipcord::derivatives::Place;
use whipcord::{Solution, SolveError};

use crate::descent::{Control, Descent, Linear, Problem, Workspace, descend};
use crate::forward::{Evaluation, Forward};
use crate::limit::Constraints;
use crate::options::ReachOptions;
use crate::target::{Miss, Target, Tolerance};

/// A point that an iteration ended at, with the answer of a solve from rest.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub unknowns: Vec<f64>,
    pub evaluation: Evaluation,
    pub solution: Solution,
    pub miss: Miss,
    pub is_reached: bool,
    /// No step lowers the distance.
    pub is_minimum: bool,
    /// Whether all limits are kept and it is stable.
    is_allowed: bool,
    distance: f64,
}

impl Candidate {
    /// What is compared: the distance, behind all that keep the limits.
    pub fn rank(&self) -> f64 {
        if self.is_allowed { self.distance } else { self.distance + 1e6 }
    }
}

/// The search for one target.
pub(crate) struct Search<'a> {
    pub target: &'a Target,
    pub tolerance: Tolerance,
    pub lever: f64,
    /// Those of the target, then those of the constraints.
    pub places: Vec<Place>,
    pub constraints: Constraints,
    pub forward: &'a mut Forward,
}

impl Problem for Search<'_> {
    type State = Evaluation;

    fn at(
        &mut self,
        unknowns: &[f64],
        from: Option<&Evaluation>,
    ) -> Result<(Linear, Evaluation), SolveError> {
        let from = from.map(|evaluation| &evaluation.solution);
        let evaluation = self.forward.evaluate(unknowns, &self.places, from)?;
        let mut linear = Linear::default();
        self.target.linearize(&evaluation.solution, &evaluation.motions, self.lever, &mut linear);
        let first = self.target.places().len();
        self.constraints.linearize(self.forward.robot(), &evaluation, first, &mut linear);
        Ok((linear, evaluation))
    }

    /// Far within the tolerance, because the answer is solved again from rest.
    fn is_done(&self, linear: &Linear) -> bool {
        linear.violation() == 0.0 && (2.0 * linear.cost()).sqrt() <= 0.02 * self.tolerance.position
    }
}

impl Search<'_> {
    /// Goes down from a start and solves what is found from rest.
    pub fn attempt(
        &mut self,
        start: &[f64],
        from: Option<&Solution>,
        control: &Control<'_>,
        workspace: &mut Workspace,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let from = match from {
            Some(solution) => Some(self.forward.evaluate(start, &self.places, Some(solution))?),
            None => None,
        };
        let found = descend(self, start, from.as_ref(), control, workspace)?;
        self.verified(found, options)
    }

    /// What an iteration has found, as a solve from rest has it.
    pub fn verified(
        &mut self,
        found: Descent<Evaluation>,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let solution = self.forward.verify(&found.unknowns, &found.state.solution)?;
        let miss = self.target.miss(&solution);
        let mut evaluation = found.state;
        evaluation.solution = solution.clone();
        evaluation.tensions = solution.cables.iter().map(|cable| cable.tension).collect();
        evaluation.shortenings = self.forward.shortenings(&solution);
        let (_, is_exceeded) = self.constraints.active(self.forward.robot(), &evaluation);
        let touches = options.clearance.is_some() && !solution.contacts.is_empty();
        let is_unstable = solution.diagnostics.is_unstable() && !options.allows_unstable;
        let is_allowed = !is_exceeded && !touches && !is_unstable;
        let mut residual = Vec::new();
        self.target.residual(&solution, self.lever, &mut residual);
        Ok(Candidate {
            unknowns: found.unknowns,
            evaluation,
            solution,
            is_reached: is_allowed && miss.is_within(self.tolerance),
            is_minimum: found.is_stationary && is_allowed,
            miss,
            is_allowed,
            distance: residual.iter().map(|r| r * r).sum::<f64>().sqrt(),
        })
    }
}
