//! The search for one target: from a start to an answer that a solve from rest confirms.

use whipcord::derivatives::Place;
use whipcord::{Solution, SolveError};

use crate::descent::{Control, Descent, Ending, Problem, Start, Workspace, descend};
use crate::evaluation::Evaluation;
use crate::forward::Forward;
use crate::limit::Constraints;
use crate::linear::Linear;
use crate::options::ReachOptions;
use crate::predicted::Predicted;
use crate::rate_changes::Foretold;
use crate::target::{Miss, Target, Tolerance};

/// A point that an iteration ended at, with the answer of a solve from rest.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub unknowns: Vec<f64>,
    /// With the solution of the solve from rest.
    pub evaluation: Evaluation,
    pub miss: Miss,
    pub is_reached: bool,
    /// Whether its rates are those of its unknowns, and not of a point near them.
    pub has_own_rates: bool,
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
    /// As in [`Control::curvature`], of the last iteration.
    curvature: Option<f64>,
}

/// What a search learns on its way.
#[derive(Clone, Debug)]
pub(crate) struct Learned {
    correction: Correction,
    curvature: Option<f64>,
}

impl Problem for Search<'_> {
    type State = Evaluation;

    fn evaluate(
        &mut self,
        unknowns: &[f64],
        from: Option<(&[f64], &Evaluation)>,
    ) -> Result<Evaluation, SolveError> {
        let near = from.map(|(before, evaluation)| {
            let changes = unknowns.iter().zip(before).map(|(x, before)| x - before);
            evaluation.extrapolated(changes, self.forward.is_on_few_steps())
        });
        self.forward.evaluate(unknowns, &self.places, near.as_ref())
    }

    fn evaluate_without_rates(
        &mut self,
        unknowns: &[f64],
        (before, evaluation): (&[f64], &Evaluation),
    ) -> Result<Evaluation, SolveError> {
        let changes = unknowns.iter().zip(before).map(|(x, before)| x - before);
        let near = evaluation.extrapolated(changes, self.forward.is_on_few_steps());
        let solution = self.forward.trial(unknowns, &near)?;
        Ok(self.forward.with_rates_of(solution, evaluation))
    }

    /// Under loads what they take is regained where they take away what the iteration of the model leaves.
    fn has_cheap_rates(&self) -> bool {
        self.forward.has_approximate_rates()
    }

    fn linearize(&self, evaluation: &Evaluation) -> Linear {
        let mut linear = Linear::default();
        let poses = &evaluation.solution.disks.poses;
        self.target.linearize(poses, &evaluation.rates.motions, self.lever, &mut linear);
        let first = self.target.places().len();
        self.constraints.linearize(self.forward.robot(), evaluation, first, &mut linear);
        self.correction.add_to(&mut linear.residual);
        linear.slack.iter_mut().zip(&self.correction.slack).for_each(|(s, more)| *s += more);
        linear
    }

    fn tolerance(&self) -> f64 {
        self.tolerance.position
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
            curvature: None,
        }
    }
}

/// How often the difference of the model on few steps from the model of the answers is measured for one start.
const CORRECTIONS: usize = 4;
/// A point of a path is not tried but solved at once where it is foretold to be within this part of the tolerance.
const FORETOLD: f64 = 0.5;
/// A difference that changes by less than this part of the tolerance is known.
const KNOWN: f64 = 0.1;

impl Search<'_> {
    /// What this search has learned of both models and of curvature, for another target of the same kind.
    pub fn learned(&self) -> Learned {
        Learned { correction: self.correction.clone(), curvature: self.curvature }
    }

    /// Takes over what another search has learned.
    pub fn take(&mut self, Learned { correction, curvature }: Learned) {
        (self.correction, self.curvature) = (correction, curvature);
    }

    /// Writes residuals and Jacobian of the target where an evaluation foretells them.
    pub fn foretell(&self, foretold: &Foretold, into: &mut Linear) {
        self.target.linearize(&foretold.poses, &foretold.motions, self.lever, into);
        self.correction.add_to(&mut into.residual);
    }

    /// Takes the curvature that is known at the start, as in [`Control::curvature`].
    pub const fn expect_curvature(&mut self, curvature: f64) {
        self.curvature = Some(curvature);
    }

    /// Of a start elsewhere nothing is known.
    pub const fn forget_curvature(&mut self) {
        self.curvature = None;
    }

    /// Whether answers depend on their commands alone, and smoothly.
    pub fn is_smooth(&self) -> bool {
        self.forward.has_no_memory() && self.forward.case.obstacles.is_empty()
    }

    /// The places whose motions an evaluation must have.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The sum of the squares of the residuals of a solution, or what it is at least once it has got beyond `most`.
    pub fn squares(&self, solution: &Solution, most: f64) -> f64 {
        self.target.squares(solution, self.lever, most)
    }

    /// Goes down from a start on few steps and solves what is found from rest; and again with what the answer of the model itself differs by, until that is known.
    pub fn attempt(
        &mut self,
        start: Start<'_, Evaluation>,
        control: &Control<'_>,
        workspace: &mut Workspace,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let control = &Control { curvature: self.curvature, ..*control };
        let mut found = descend(self, start, control, workspace)?;
        let mut round = 0;
        loop {
            round += 1;
            self.curvature = found.curvature;
            let candidate = self.verified(&found, options)?;
            let foretold_from = found.foretold_from.take();
            let was_foretold = foretold_from.is_some();
            if let Some(before) = foretold_from {
                if candidate.is_reached || round >= CORRECTIONS {
                    return Ok(candidate);
                }
                found.state = self.evaluate(&found.unknowns, Some((&before, &found.state)))?;
                found.has_own_rates = true;
            } else if !self.forward.is_on_few_steps() {
                return Ok(candidate);
            }
            if self.forward.is_on_few_steps() {
                let change = self.correct(&candidate.evaluation, &found.state);
                let near = 10.0 * self.tolerance.position.max(change);
                let is_final = candidate.is_reached
                    || round >= CORRECTIONS
                    || change <= KNOWN * self.tolerance.position
                    || candidate.distance > near;
                if is_final && !was_foretold {
                    return Ok(candidate);
                }
            }
            if !found.has_own_rates {
                let from = Some((found.unknowns.as_slice(), &found.state));
                found.state = self.evaluate(&found.unknowns, from)?;
            }
            found = descend(self, Start::Known(&found.unknowns, &found.state), control, workspace)?;
        }
    }

    /// The answer where the derivatives at the point before of a path lead, without a trial, where their curvature foretells that it reaches the target; `None` where
    /// it does not.
    pub fn foretold(
        &mut self,
        predicted: &Predicted,
        (before, evaluation): (&[f64], &Evaluation),
        options: &ReachOptions,
    ) -> Result<Option<Candidate>, SolveError> {
        if !predicted.is_within(self.curvature, FORETOLD * self.tolerance.position) {
            return Ok(None);
        }
        let found = Descent {
            unknowns: predicted.unknowns.clone(),
            state: evaluation.clone(),
            foretold_from: Some(before.to_vec()),
            has_own_rates: false,
            curvature: self.curvature,
            is_stationary: false,
        };
        let candidate = match self.verified(&found, options) {
            Ok(candidate) => candidate,
            Err(error @ SolveError::Cancelled { .. }) => return Err(error),
            Err(_) => return Ok(None),
        };
        self.curvature = predicted.curvature(self.curvature, candidate.distance);
        Ok(Some(candidate).filter(|candidate| candidate.is_reached))
    }

    /// Goes down from a start on few steps; what is found there is not solved from rest.
    pub fn restored(
        &mut self,
        start: Start<'_, Evaluation>,
        control: &Control<'_>,
        workspace: &mut Workspace,
    ) -> Result<Candidate, SolveError> {
        let control = Control { ending: Ending::RESTORED, curvature: None, ..*control };
        let found = descend(self, start, &control, workspace)?;
        let linear = self.linearize(&found.state);
        let (distance, is_allowed) = (linear.distance(), linear.violation() == 0.0);
        Ok(Candidate {
            unknowns: found.unknowns,
            miss: self.target.miss(&found.state.solution),
            evaluation: found.state,
            is_reached: is_allowed && distance <= self.tolerance.position,
            has_own_rates: true,
            is_minimum: false,
            is_allowed,
            distance,
        })
    }

    /// What an iteration has found, as a solve from rest has it.
    fn verified(
        &mut self,
        found: &Descent<Evaluation>,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let Descent { unknowns, state, foretold_from, .. } = found;
        let solution = match foretold_from {
            Some(before) => {
                let changes = || unknowns.iter().zip(before).map(|(x, before)| x - before);
                let near = state.extrapolated(changes(), self.forward.is_on_few_steps());
                self.forward.verify(unknowns, &state.shortenings_after(changes()), &near)?
            }
            None => self.forward.verify(unknowns, &state.shortenings, &state.solution)?,
        };
        let miss = self.target.miss(&solution);
        let evaluation = self.forward.with_rates_of(solution, &found.state);
        let solution = &evaluation.solution;
        let (_, is_exceeded) = self.constraints.active(self.forward.robot(), &evaluation);
        let touches = options.clearance.is_some() && !solution.contacts.is_empty();
        let is_unstable = solution.diagnostics.is_unstable() && !options.allows_unstable;
        let is_allowed = !is_exceeded && !touches && !is_unstable;
        let distance = self.squares(solution, f64::INFINITY).sqrt();
        Ok(Candidate {
            unknowns: found.unknowns.clone(),
            evaluation,
            is_reached: is_allowed && miss.is_within(self.tolerance),
            has_own_rates: found.has_own_rates,
            is_minimum: found.is_stationary && is_allowed,
            miss,
            is_allowed,
            distance,
        })
    }

    /// Measures by how much the model on few steps differs, and says by how much that has changed in m.
    pub fn correct(&mut self, answer: &Evaluation, on_few_steps: &Evaluation) -> f64 {
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

impl Correction {
    fn add_to(&self, residual: &mut [f64]) {
        residual.iter_mut().zip(&self.residual).for_each(|(r, more)| *r += more);
    }
}
