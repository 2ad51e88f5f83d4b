//! Equilibrium under tensions and loads by Newton's method, and along the load where that does not get there.

use whipcord_numerics::{
    ContinuationSteps, Ended, Equations, Missed, NewtonOptions, Solved, Unsolved, continuation,
    newton,
};

use super::chain::Chain;
use super::layout::Section;
use super::motion::{Coordinates, bend};
use super::task::{Asked, Elimination, Task};
use crate::section::Fault;
use crate::section::SectionFault;
use crate::shape::Wrench;
use crate::statics::lengths::{Note, Stage, TensionResponse};
use crate::statics::outcome::Failure;

const NEWTON: NewtonOptions = NewtonOptions {
    tolerance: 0.0,
    iterations: 40,
    least_fraction: 1e-3,
    decrease: 0.0,
    rounding: 0.0,
    reuse: None,
    trusted: 0,
};
/// Newton iterations from a neighbouring equilibrium in a search for lengths, which takes a shorter step otherwise.
pub(super) const FEW_ITERATIONS: usize = 12;
/// How many steps of that search in a row may end before a fold.
const PATIENCE: usize = 8;
/// A coordinate changes by no more than this in one step, in rad.
const LONGEST_STEP: f64 = 0.8;
/// What rounding may leave, in units of the tolerance, where no step improves any more.
const ROUNDING: f64 = 1e3;
/// A section bent by more than this in rad is what keeps the load from being raised.
const NEARLY_FOLDED: f64 = 2.0;
const LOAD_STEPS: ContinuationSteps =
    ContinuationSteps { first: 0.25, least: LEAST_STEP, growth: 1.5, after_miss: f64::INFINITY };
/// Shortest step along the load, as a fraction of it.
const LEAST_STEP: f64 = 1e-4;
/// The same under tensions that a search for lengths tries: where they have no equilibrium it tries others.
const LEAST_TRIED_STEP: f64 = 0.02;
/// How many tensions its first stage brings on from rest where no equilibrium is found near the last one.
const RESCUES: usize = 3;
/// Newton iterations for each stage of that search.
const fn allowance(stage: Stage) -> usize {
    match stage {
        Stage::Tensions => 600,
        Stage::Contradiction => 600,
        Stage::Part => 150,
    }
}

/// Memory of a solve.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub chain: Chain,
    /// Where the last step began.
    before: Vec<Coordinates>,
    /// The last equilibrium along the load.
    reached: Vec<Coordinates>,
    pub length_by_tension: Vec<f64>,
    /// Newton iterations since the memory was made, those in vain among them.
    spent: usize,
    /// The iterate at which the budget was spent, and what it leaves open.
    pub open: Option<(Vec<Coordinates>, Effort)>,
    /// Where the last search for tensions began, and the last tensions that had an answer: searches begin there again.
    began: Known,
    last: Known,
    /// Where a search may have to go back to.
    start: Vec<Coordinates>,
    pub pivots: Vec<f64>,
    pub work: Vec<f64>,
}

/// An equilibrium and its tensions.
#[derive(Clone, Debug, Default)]
struct Known {
    is_set: bool,
    tensions: Vec<f64>,
    q: Vec<Coordinates>,
}

impl Known {
    fn is_of(&self, tensions: &[f64]) -> bool {
        self.is_set && self.tensions == tensions
    }

    fn set(&mut self, tensions: &[f64], q: &Vec<Coordinates>) {
        self.is_set = true;
        self.tensions.clear();
        self.tensions.extend_from_slice(tensions);
        self.q.clone_from(q);
    }
}

/// How a solve went.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    pub iterations: usize,
    pub residual: f64,
    /// The fraction of loads and tensions at which the way from rest lost its stability.
    pub lost_at: Option<f64>,
}

/// A chain that is brought into equilibrium.
struct Balance<'a> {
    chain: &'a mut Chain,
    /// Where the last step began.
    before: &'a mut Vec<Coordinates>,
    task: &'a Task<'a>,
    strict: bool,
    spent: &'a mut usize,
    /// Whether a tangent gave no step.
    is_refused: bool,
}

impl Equations for Balance<'_> {
    type Fault = ();

    fn residual(&mut self) -> Result<f64, ()> {
        Some(self.chain.evaluate(self.task)).filter(|residual| residual.is_finite()).ok_or(())
    }

    fn step(&mut self, _fresh: bool) -> Option<f64> {
        let Self { chain, task, .. } = self;
        chain.linearise(task);
        match chain.eliminate(task, Elimination { shift: 0.0, asked: Asked::Step }) {
            Some(negative) if !self.strict || negative == 0 => {}
            _ => {
                self.is_refused = true;
                return None;
            }
        }
        task.meter.iterate();
        task.meter.integrate(task.sections.len());
        *self.spent += 1;
        self.before.clone_from(&chain.q);
        let longest = chain.steps.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        Some((LONGEST_STEP / longest).min(1.0))
    }

    fn go(&mut self, fraction: f64) {
        let Chain { q, steps, .. } = &mut *self.chain;
        for ((q, start), step) in q.iter_mut().zip(&*self.before).zip(steps) {
            for ((q, start), step) in q.iter_mut().zip(start).zip(step) {
                *q = start + fraction * *step;
            }
        }
    }

    fn has_ended(&self) -> bool {
        self.task.meter.has_ended()
    }
}

impl Scratch {
    /// Newton's method from where the chain is; in vain, where it is `strict`, as soon as the tangent has negative
    /// eigenvalues: there it may lead away from the equilibrium that grows out of rest.
    fn newton(
        &mut self,
        task: &Task<'_>,
        tolerance: f64,
        strict: bool,
        effort: &mut Effort,
    ) -> bool {
        self.close_within(NEWTON.iterations, task, tolerance, strict, effort)
    }

    /// The same in so many iterations.
    pub fn close_within(
        &mut self,
        iterations: usize,
        task: &Task<'_>,
        tolerance: f64,
        strict: bool,
        effort: &mut Effort,
    ) -> bool {
        let Self { chain, before, spent, open, .. } = self;
        let mut balance = Balance { chain, before, task, strict, spent, is_refused: false };
        let options =
            NewtonOptions { tolerance, iterations, rounding: ROUNDING * tolerance, ..NEWTON };
        match newton(&mut balance, &options) {
            Ok(Solved { iterations, residual }) => {
                effort.iterations += iterations;
                effort.residual = residual;
                true
            }
            Err(Unsolved { iterations, residual, .. }) => {
                let is_refused = balance.is_refused;
                effort.iterations += iterations;
                effort.residual = residual;
                let has_ended = task.meter.has_ended();
                if has_ended && task.load == 1.0 && task.pull == 1.0 && open.is_none() {
                    *open = Some((chain.q.clone(), *effort));
                }
                // Nothing is better than where the last step began.
                let is_rounding = residual <= ROUNDING * tolerance && !is_refused && !has_ended;
                is_rounding && chain.evaluate(task).is_finite()
            }
        }
    }

    /// Goes to the iterate at which the budget was spent, where there is one.
    pub fn restore_open(&mut self) -> Option<Effort> {
        let (q, effort) = self.open.take()?;
        self.chain.q = q;
        Some(effort)
    }

    /// Equilibrium from where the chain is, which is near it; where it is `strict` the way there is one of
    /// stable tangents.
    pub fn converge_near(
        &mut self,
        task: &Task<'_>,
        tolerance: f64,
        strict: bool,
    ) -> Result<Effort, Failure> {
        let mut effort = Effort::default();
        if self.newton(task, tolerance, strict, &mut effort) {
            return Ok(effort);
        }
        self.converge(task, tolerance)
    }

    /// Equilibrium from where the chain is, and where none is found there, from rest if it is `thorough`. Where
    /// there is none the chain stays as it was.
    fn converge_beside(
        &mut self,
        task: &Task<'_>,
        tolerance: f64,
        thorough: bool,
    ) -> Result<Effort, Failure> {
        let mut effort = Effort::default();
        self.start.clone_from(&self.chain.q);
        if self.close_within(FEW_ITERATIONS, task, tolerance, false, &mut effort) {
            return Ok(effort);
        }
        let found = match thorough {
            true => self.converge_in_steps(task, tolerance, LEAST_TRIED_STEP),
            false => Err(self.failure(task, 0.0, effort)),
        };
        if found.is_err() {
            self.chain.q.clone_from(&self.start);
        }
        found
    }

    /// Equilibrium from rest: at once, else along the load. Where that loses its stability on the way, it is
    /// followed on all the same.
    pub fn converge(&mut self, task: &Task<'_>, tolerance: f64) -> Result<Effort, Failure> {
        self.converge_in_steps(task, tolerance, LEAST_STEP)
    }

    /// The same, in steps along the load that are no shorter than `least` of it.
    fn converge_in_steps(
        &mut self,
        task: &Task<'_>,
        tolerance: f64,
        least: f64,
    ) -> Result<Effort, Failure> {
        let mut effort = Effort::default();
        self.chain.rest(task.sections);
        if !self.is_strong(task) && self.newton(task, tolerance, true, &mut effort) {
            return Ok(effort);
        }
        match self.along_the_load(task, tolerance, (true, least), effort) {
            Err(Failure::NotConverged { last_load, .. } | Failure::Folds { last_load, .. }) => {
                effort.lost_at = Some(last_load);
                self.along_the_load(task, tolerance, (false, least), effort)
            }
            other => other,
        }
    }

    /// Whether the loads would bend the robot by more than about a radian.
    fn is_strong(&mut self, task: &Task<'_>) -> bool {
        self.chain.evaluate(task);
        let Wrench { force, moment } = self.chain.base;
        let whole: f64 = task.sections.iter().map(|section| section.length).sum();
        let softest =
            |section: &Section| section.length * section.stiffness[1].min(section.stiffness[2]);
        let bending = task.sections.iter().map(softest).fold(f64::INFINITY, f64::min);
        (moment.norm() + force.norm() * whole) * whole > bending
    }

    /// Raises tensions and loads together from nothing.
    fn along_the_load(
        &mut self,
        task: &Task<'_>,
        tolerance: f64,
        (strict, least): (bool, f64),
        mut effort: Effort,
    ) -> Result<Effort, Failure> {
        self.chain.rest(task.sections);
        self.reached.clone_from(&self.chain.q);
        let steps = ContinuationSteps { least, ..LOAD_STEPS };
        let raised = continuation(&steps, |fraction| {
            let part = Task { load: fraction * task.load, pull: fraction * task.pull, ..*task };
            if self.newton(&part, tolerance, strict, &mut effort) && (strict || self.is_near()) {
                self.reached.clone_from(&self.chain.q);
                return Ok(true);
            }
            self.chain.q.clone_from(&self.reached);
            Err(Missed { reason: (), is_last: task.meter.has_ended() })
        });
        match raised {
            Ok(()) => Ok(effort),
            Err(Ended { reached, .. }) => Err(self.failure(task, reached, effort)),
        }
    }

    /// Whether no coordinate has changed so much since the last equilibrium along the load that it may be
    /// one of another path.
    fn is_near(&self) -> bool {
        const NEAR: f64 = 0.3;
        let mut pairs = self.chain.q.iter().flatten().zip(self.reached.iter().flatten());
        pairs.all(|(now, before)| (now - before).abs() <= NEAR)
    }

    /// Why the load cannot be raised beyond a fraction, at which the chain is.
    pub fn failure(&self, task: &Task<'_>, reached: f64, effort: Effort) -> Failure {
        let mut start = 0.0;
        for (section, q) in task.sections.iter().zip(&self.chain.q) {
            let pulling = section.passages.iter().map(|passage| passage.cable);
            let tension = |cable: &usize| task.tensions[*cable];
            let most = pulling.max_by(|a, b| tension(a).total_cmp(&tension(b)));
            if let Some(cable) = most.filter(|_| bend(q) > NEARLY_FOLDED) {
                let (arc_length, tension) = (start, tension(&cable));
                return Failure::Folds { cable, arc_length, tension, last_load: reached };
            }
            start += section.length;
        }
        Failure::NotConverged {
            iterations: effort.iterations,
            residual: effort.residual.min(1.0),
            last_load: reached,
            advice: "pull or load it less, put more disks on it, or use cosserat-disks",
        }
    }
}

/// The chain as what answers tensions with lengths.
pub(super) struct Responder<'a> {
    pub task: Task<'a>,
    pub tolerance: f64,
    pub scratch: &'a mut Scratch,
    pub effort: Effort,
    /// Why the last tensions had no answer.
    pub failure: Option<Failure>,
    /// Newton iterations of the memory at which the effort that is allowed ends.
    allowed: usize,
    /// How many more tensions are brought on from rest.
    rescues: usize,
}

impl<'a> Responder<'a> {
    /// Of a task whose tensions are to be found.
    pub fn new(task: Task<'a>, tolerance: f64, scratch: &'a mut Scratch) -> Self {
        let (effort, failure) = (Effort::default(), None);
        (scratch.began.is_set, scratch.last.is_set) = (false, false);
        Self { task, tolerance, scratch, effort, failure, allowed: usize::MAX, rescues: 0 }
    }

    /// The equilibrium where a search begins: the one that is known at these tensions, else the one that grows from rest.
    fn begin(&mut self, task: &Task<'_>) -> Result<Effort, Failure> {
        let Scratch { chain, began, last, .. } = &mut *self.scratch;
        let (from_last, from_first) = (last.is_of(task.tensions), began.is_of(task.tensions));
        if from_last || from_first {
            chain.q.clone_from(if from_last { &last.q } else { &began.q });
            let mut effort = Effort::default();
            if self.scratch.close_within(FEW_ITERATIONS, task, self.tolerance, false, &mut effort) {
                let Scratch { began, last, .. } = &mut *self.scratch;
                if from_last {
                    began.set(&last.tensions, &last.q);
                }
                return Ok(effort);
            }
        }
        let found = self.scratch.converge(task, self.tolerance);
        if found.is_ok() {
            self.scratch.began.set(task.tensions, &self.scratch.chain.q);
        }
        found
    }
}

impl TensionResponse for Responder<'_> {
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault> {
        let task = Task { tensions, ..self.task };
        let converged = if warm {
            let beside = self.scratch.converge_beside(
                &task,
                self.tolerance,
                self.rescues > 0 && !self.is_spent(),
            );
            self.rescues -= usize::from(beside.is_err() && self.rescues > 0);
            beside
        } else {
            // Where a search starts is not of its own making.
            let spent = self.scratch.spent;
            let converged = self.begin(&task);
            self.allowed = self.allowed.saturating_add(self.scratch.spent - spent);
            converged
        };
        let diverged = Fault { kind: SectionFault::Diverged, arc_length: 0.0 };
        match converged {
            Ok(effort) => {
                self.effort.iterations += effort.iterations;
                self.effort.residual = effort.residual;
                let Scratch { chain, last, .. } = &mut *self.scratch;
                last.set(tensions, &chain.q);
            }
            Err(failure) => {
                self.failure = Some(failure);
                return Err(diverged);
            }
        }
        let Scratch { chain, length_by_tension, .. } = &mut *self.scratch;
        let how = Elimination { shift: 0.0, asked: Asked::Responses };
        chain.linearise(&task);
        chain.eliminate(&task, how).ok_or(diverged)?;
        chain.length_by_tension(&task, length_by_tension);
        Ok(())
    }

    fn lengths(&self) -> &[f64] {
        &self.scratch.chain.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        &self.scratch.length_by_tension
    }

    fn allow(&mut self, stage: Stage) {
        self.allowed = self.scratch.spent + allowance(stage);
        self.rescues = if stage == Stage::Tensions { RESCUES } else { 0 };
    }

    fn patience(&self) -> usize {
        PATIENCE
    }

    fn is_spent(&self) -> bool {
        self.scratch.spent >= self.allowed
    }

    fn note(&mut self, _note: &Note, _tensions: &[f64]) {}
}
