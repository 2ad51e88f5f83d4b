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
    /// With the solution of the solve from rest.
    pub evaluation: Evaluation,
    pub miss: Miss,
    pub is_reached: bool,
    /// No step lowers the distance.
    pub is_minimum: bool,
    /// Whether all limits are kept and it is stable.
    pub is_allowed: bool,
    pub distance: f64,
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
    tolerance: Tolerance,
    pub lever: f64,
    /// Those of the target, then those of the constraints.
    places: Vec<Place>,
    pub constraints: &'a Constraints,
    pub forward: &'a mut Forward,
    correction: Correction,
}

impl Problem for Search<'_> {
    type State = Evaluation;

    fn at(
        &mut self,
        unknowns: &[f64],
        from: Option<(&[f64], &Evaluation)>,
    ) -> Result<(Linear, Evaluation), SolveError> {
        let near = from.map(|(before, evaluation)| {
            evaluation.extrapolated(unknowns.iter().zip(before).map(|(x, before)| x - before))
        });
        let evaluation = self.forward.evaluate(unknowns, &self.places, near.as_ref())?;
        let mut linear = Linear::default();
        self.target.linearize(&evaluation.solution, &evaluation.motions, self.lever, &mut linear);
        let first = self.target.places().len();
        self.constraints.linearize(self.forward.robot(), &evaluation, first, &mut linear);
        linear.residual.iter_mut().zip(&self.correction.residual).for_each(|(r, more)| *r += more);
        linear.slack.iter_mut().zip(&self.correction.slack).for_each(|(s, more)| *s += more);
        Ok((linear, evaluation))
    }

    fn is_done(&self, linear: &Linear, part: f64) -> bool {
        let distance = (2.0 * linear.cost()).sqrt();
        linear.violation() == 0.0 && distance <= part * self.tolerance.position
    }
}

impl<'a> Search<'a> {
    pub fn new(
        target: &'a Target,
        tolerance: Tolerance,
        constraints: &'a Constraints,
        forward: &'a mut Forward,
    ) -> Self {
        Self {
            target,
            tolerance,
            lever: tolerance.position / tolerance.angle,
            places: target.places().into_iter().chain(constraints.places()).collect(),
            constraints,
            forward,
            correction: Correction::default(),
        }
    }
}

/// How often the difference of the model on few steps from the model of the answers is measured for one start.
const CORRECTIONS: usize = 4;
/// A difference that changes by less than this part of the tolerance is known.
const KNOWN: f64 = 0.1;

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
        let from = from.map(|solution| self.forward.without_rates(solution.clone()));
        let from = from.as_ref().map(|evaluation| (start, evaluation));
        self.descend(start, from, control, workspace, options)
    }

    /// Goes down on few steps, at first from other unknowns and their evaluation where there are, and again with what the answer of the model itself differs by, until that is known.
    pub fn descend(
        &mut self,
        start: &[f64],
        from: Option<(&[f64], &Evaluation)>,
        control: &Control<'_>,
        workspace: &mut Workspace,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let mut found = descend(self, start, from, control, workspace)?;
        let mut round = 0;
        loop {
            round += 1;
            let (candidate, difference) = self.verified(&found, options)?;
            let Some(change) = difference else { return Ok(candidate) };
            let near = 10.0 * self.tolerance.position.max(change);
            if candidate.is_reached
                || round >= CORRECTIONS
                || change <= KNOWN * self.tolerance.position
                || candidate.distance > near
            {
                return Ok(candidate);
            }
            let from = (found.unknowns.as_slice(), &found.state);
            found = descend(self, &found.unknowns, Some(from), control, workspace)?;
        }
    }

    /// What an iteration has found, as a solve from rest has it, and by how much the difference of the two models has
    /// changed in m, where they are two.
    fn verified(
        &mut self,
        found: &Descent<Evaluation>,
        options: &ReachOptions,
    ) -> Result<(Candidate, Option<f64>), SolveError> {
        let solution = self.forward.verify(&found.unknowns, &found.state.solution)?;
        let miss = self.target.miss(&solution);
        let mut evaluation = found.state.clone();
        evaluation.tensions = solution.cables.iter().map(|cable| cable.tension).collect();
        evaluation.shortenings = self.forward.shortenings(&solution);
        evaluation.solution = solution;
        let solution = &evaluation.solution;
        let change =
            self.forward.is_on_few_steps().then(|| self.correct(&evaluation, &found.state));
        let (_, is_exceeded) = self.constraints.active(self.forward.robot(), &evaluation);
        let touches = options.clearance.is_some() && !solution.contacts.is_empty();
        let is_unstable = solution.diagnostics.is_unstable() && !options.allows_unstable;
        let is_allowed = !is_exceeded && !touches && !is_unstable;
        let mut residual = Vec::new();
        self.target.residual(solution, self.lever, &mut residual);
        let candidate = Candidate {
            unknowns: found.unknowns.clone(),
            evaluation,
            is_reached: is_allowed && miss.is_within(self.tolerance),
            is_minimum: found.is_stationary && is_allowed,
            miss,
            is_allowed,
            distance: residual.iter().map(|r| r * r).sum::<f64>().sqrt(),
        };
        Ok((candidate, change))
    }

    /// Measures by how much the model on few steps differs, and says by how much that has changed in m.
    fn correct(&mut self, answer: &Evaluation, on_few_steps: &Evaluation) -> f64 {
        let of = |evaluation: &Evaluation| {
            let mut linear = Linear::default();
            self.target.residual(&evaluation.solution, self.lever, &mut linear.residual);
            let first = self.target.places().len();
            self.constraints.linearize(self.forward.robot(), evaluation, first, &mut linear);
            linear
        };
        let (answer, few) = (of(answer), of(on_few_steps));
        let difference =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let residual = difference(&answer.residual, &few.residual);
        let before = self.correction.residual.iter().chain(core::iter::repeat(&0.0));
        let change =
            residual.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        self.correction = Correction { residual, slack: difference(&answer.slack, &few.slack) };
        change
    }
}

/// What the residuals and the slacks of the answers have beyond those of the model on few steps.
#[derive(Clone, Debug, Default)]
struct Correction {
    residual: Vec<f64>,
    slack: Vec<f64>,
}
