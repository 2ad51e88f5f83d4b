//! The load on its way up, in steps that adapt, at once or together with the commands.

use whipcord_numerics::{ContinuationSteps, Missed, Vec3, continuation};

use super::chain::Chain;
use super::node::Node;
use super::problem::Problem;
use super::scratch::{Scratch, finish};
use super::task::Task;
use super::{stability_check, unloaded};
use crate::section::{Fault, SectionFault};
use crate::statics::command::Command;
use crate::statics::continuation::{
    FIRST_LOAD_STEP, LEAST_LOAD_STEP, PATH_ENDS, SHORT_ITERATION, load_steps,
};
use crate::statics::lengths::Effort;
use crate::statics::loads::AppliedLoads;
use crate::statics::outcome::{Failure, Open};
use crate::statics::path;
use crate::statics::perturbation::{self, Perturbation, Perturbed};
use crate::statics::trace::Stage;

/// Shapes that are tried where the load leads to none that is stable: bent by so much in all, in rad,
/// in so many directions.
const FAR_BENDS: [f64; 3] = [1.0, 2.5, 5.0];

const FAR_WAYS: usize = 8;

/// Beside dead moments the load is raised by at least this part of it: they turn the corner where a branch leaves its
/// path into a bend, over more than that.
const LEAST_PERTURBED_STEP: f64 = 1.0 / 256.0;

/// Halvings that locate the loss of stability.
pub(super) const LOSS_HALVINGS: usize = 12;

/// The load on its way up, from a chain that is closed without it.
pub(super) struct Raise<'a> {
    pub problem: &'a Problem<'a>,
    /// What drives the cables, where any is driven by its length; else empty.
    pub commands: &'a [Command],
    pub derivatives: bool,
    /// The load is raised by at least this part of it, or the path is given up.
    pub least_step: f64,
}

/// Where it could not be raised any more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub load: f64,
    pub residual: f64,
    pub iterations: usize,
    pub fault: Fault,
}

impl<'a> Raise<'a> {
    /// At tensions that are held.
    pub const fn at_tensions(problem: &'a Problem<'a>) -> Self {
        Self { problem, commands: &[], derivatives: false, least_step: LEAST_LOAD_STEP }
    }
}

impl Raise<'_> {
    pub fn task<'a>(&'a self, groups: &'a [usize], loads: &'a AppliedLoads, load: f64) -> Task<'a> {
        let Problem { frame, mesh, tolerance, meter, .. } = *self.problem;
        let Self { commands, derivatives, .. } = *self;
        let step = path::Step::Close;
        Task { frame, mesh, loads, load, step, groups, commands, derivatives, tolerance, meter }
    }

    /// Closes the chain from where it stands, at a fraction of the load.
    pub fn newton(
        &self,
        scratch: &mut Scratch,
        load: f64,
        linearised: bool,
    ) -> Result<Effort, Open> {
        let Scratch { chain, groups, applied, .. } = &mut *scratch;
        chain.trace.steps = self.problem.mesh.grid.len();
        let task = self.task(groups, applied, load);
        let closed = chain.newton(&task, linearised);
        if let Err(Open { iterations, gap: residual, .. }) = closed
            && load == 1.0
            && self.problem.meter.has_ended()
            && scratch.open.is_none()
            && residual.is_finite()
        {
            let effort = Effort { iterations, residual };
            finish(self.problem, scratch, effort);
            scratch.open = Some(effort);
        }
        let (iterations, residual) = closed?;
        Ok(Effort { iterations, residual })
    }

    /// Raises the load to all of it from a chain that is closed without any.
    pub fn load(&self, scratch: &mut Scratch) -> Result<Effort, Ended> {
        self.path(scratch, |scratch, load| self.newton(scratch, load, false))
    }

    /// Raises the load and the commands to all of them from the robot at rest, through stable equilibria only
    /// or through any; `None` where the robot has no shape at rest.
    pub fn all(&self, scratch: &mut Scratch, steadily: bool) -> Result<Effort, Option<Ended>> {
        let Problem { frame, mesh, commands, .. } = *self.problem;
        let Scratch { chain, groups, unloaded, .. } = &mut *scratch;
        chain.pull(groups, &vec![0.0; commands.len()]);
        unloaded
            .sweep(frame, mesh, &chain.pulled, unloaded::From::Nothing, false)
            .map_err(|_| None)?;
        chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
        let raised = self.path(scratch, |scratch, load| {
            let commands = self.problem.commands_at(load);
            let Scratch { chain, groups, .. } = &mut *scratch;
            let mut tensions = chain.tensions.clone();
            for (tension, command) in tensions.iter_mut().zip(&commands) {
                if let Command::Tension(given) = *command {
                    *tension = given;
                }
            }
            chain.pull(groups, &tensions);
            let held = if self.commands.is_empty() { &[][..] } else { &commands };
            let raise = Raise { commands: held, ..*self };
            let effort = raise.newton(scratch, load, false)?;
            if steadily { raise.if_stable(scratch, load, effort) } else { Ok(effort) }
        });
        raised.map_err(Some)
    }

    /// Raises the load from one stable equilibrium to the next. Where it ends the chain holds the last one.
    pub fn steadily(&self, scratch: &mut Scratch) -> Result<Effort, Ended> {
        self.path(scratch, |scratch, load| {
            let effort = self.newton(scratch, load, false)?;
            self.if_stable(scratch, load, effort)
        })
    }

    pub fn if_stable(
        &self,
        scratch: &mut Scratch,
        load: f64,
        effort: Effort,
    ) -> Result<Effort, Open> {
        if self.is_stable(scratch, load) {
            return Ok(effort);
        }
        let Effort { iterations, residual: gap } = effort;
        Err(Open { iterations, gap, fault: None })
    }

    /// Where on the way up stability is lost, from the last stable equilibrium that was found on it, which the
    /// chain holds: by bisection. `None` where the robot was not stable without load.
    pub fn lost_at(&self, scratch: &mut Scratch, from: f64) -> Option<f64> {
        let mut here = Place::of(&scratch.chain);
        let (mut low, mut high) = (from, f64::min(from + LEAST_LOAD_STEP, 1.0));
        for _ in 0..LOSS_HALVINGS {
            let middle = 0.5 * (low + high);
            here.restore(scratch);
            if self.newton(scratch, middle, false).is_ok() && self.is_stable(scratch, middle) {
                here = Place::of(&scratch.chain);
                low = middle;
            } else {
                high = middle;
            }
        }
        (low > 0.0).then_some(low)
    }

    /// A stable equilibrium on a branch off the path, by dead moments on the disks.
    pub fn perturbed(&self, scratch: &mut Scratch, rest: &Place) -> Option<Effort> {
        let loads = scratch.applied.clone();
        let kept = Place::of(&scratch.chain);
        let raise = &Raise { least_step: LEAST_PERTURBED_STEP, ..*self };
        let mut perturbed = PerturbedChain { raise, scratch, loads: &loads, rest, kept };
        let found = perturbation::stable_equilibrium(&mut perturbed);
        scratch.applied.clone_from(&loads);
        found
    }

    /// Under all of the load from shapes bent every way: a stable equilibrium.
    pub fn afar(&self, scratch: &mut Scratch, tensions: &[f64]) -> Option<Effort> {
        let Problem { frame, mesh, .. } = *self.problem;
        let unit = frame.scales(mesh).moment;
        for size in FAR_BENDS {
            for way in 0..FAR_WAYS {
                if self.problem.meter.has_ended() {
                    return None;
                }
                let angle = core::f64::consts::TAU * way as f64 / FAR_WAYS as f64;
                let bend = size * Vec3::new(angle.cos(), angle.sin(), 0.0);
                let Scratch { chain, groups, .. } = &mut *scratch;
                chain.pull(groups, tensions);
                chain.start_bent(frame, bend, unit);
                if let Ok(effort) = self.newton(scratch, 1.0, false)
                    && self.is_stable(scratch, 1.0)
                {
                    return Some(effort);
                }
            }
        }
        None
    }

    /// Back to an equilibrium under all of the load that was left.
    pub fn back_to(
        &self,
        scratch: &mut Scratch,
        (place, effort): &(Place, Effort),
    ) -> Result<Effort, Open> {
        place.restore(scratch);
        let last = self.newton(scratch, 1.0, false)?;
        Ok(Effort { iterations: effort.iterations + last.iterations, ..last })
    }

    /// Whether the equilibrium is stable that the chain holds under this part of the load; loads that
    /// follow it have no energy to tell, and dead moments alone leave a rod without cables but one shape.
    pub fn is_stable(&self, scratch: &mut Scratch, load: f64) -> bool {
        let Scratch { applied, chain, .. } = &*scratch;
        let only_moments = applied.any() && applied.only_dead_moments();
        applied.any_follower()
            || (only_moments && chain.pulled.iter().all(|&tension| tension == 0.0))
            || stability_check::is_stable(self.problem, load, scratch).unwrap_or(true)
    }

    pub fn not_found(&self) -> Failure {
        Failure::NotConverged { iterations: 0, residual: 1.0, last_load: 0.0, advice: PATH_ENDS }
    }

    /// Goes from nothing to all in steps that adapt, at first at once.
    pub fn path(
        &self,
        scratch: &mut Scratch,
        mut newton: impl FnMut(&mut Scratch, f64) -> Result<Effort, Open>,
    ) -> Result<Effort, Ended> {
        scratch.chain.trace.stage = Stage::Cold;
        let mut here = Place::of(&scratch.chain);
        let mut effort = Effort::default();
        let steps = ContinuationSteps {
            first: 1.0,
            after_miss: FIRST_LOAD_STEP,
            least: self.least_step,
            ..load_steps(FIRST_LOAD_STEP)
        };
        let raised = continuation(&steps, |load| match newton(scratch, load) {
            Ok(Effort { iterations, residual }) => {
                effort = Effort { iterations: effort.iterations + iterations, residual };
                if load < 1.0 {
                    here = Place::of(&scratch.chain);
                }
                Ok(iterations <= SHORT_ITERATION)
            }
            Err(reason) => {
                effort.iterations += reason.iterations;
                scratch.chain.trace.stage = Stage::LoadSteps;
                here.restore(scratch);
                Err(Missed { reason, is_last: self.problem.meter.has_ended() })
            }
        });
        raised.map(|()| effort).map_err(|whipcord_numerics::Ended { reached: load, reason }| {
            let residual = if reason.gap.is_finite() { reason.gap } else { 1.0 };
            let none = Fault { kind: SectionFault::Diverged, arc_length: 0.0 };
            let fault = reason.fault.unwrap_or(none);
            Ended { load, residual, iterations: effort.iterations, fault }
        })
    }
}

/// A chain that dead moments lead off its path.
struct PerturbedChain<'a> {
    raise: &'a Raise<'a>,
    scratch: &'a mut Scratch,
    /// Those of the case.
    loads: &'a AppliedLoads,
    /// The chain without load.
    rest: &'a Place,
    kept: Place,
}

impl Perturbed for PerturbedChain<'_> {
    fn perturb(&mut self, by: Perturbation) {
        let Problem { frame, mesh, .. } = *self.raise.problem;
        let unit = frame.scales(mesh).moment;
        let applied = &mut self.scratch.applied;
        applied.clone_from(self.loads);
        for (k, steps) in mesh.spans.iter().enumerate() {
            applied.add_moment(steps.end, by.moment(k, mesh.spans.len(), unit));
        }
    }

    fn raise(&mut self) -> Option<Effort> {
        self.rest.restore(self.scratch);
        let raised = self.raise.steadily(self.scratch).ok();
        raised.or_else(|| self.raise.all(self.scratch, true).ok())
    }

    fn converge(&mut self) -> Option<Effort> {
        self.raise.newton(self.scratch, 1.0, false).ok()
    }

    fn keep(&mut self) {
        self.kept = Place::of(&self.scratch.chain);
    }

    fn restore(&mut self) {
        self.kept.restore(self.scratch);
    }

    fn has_ended(&self) -> bool {
        self.raise.problem.meter.has_ended()
    }

    fn is_stable(&mut self) -> bool {
        stability_check::is_nearly_stable(self.raise.problem, self.scratch) == Some(true)
    }
}

/// A closed chain that a step goes out from.
pub(super) struct Place {
    nodes: Vec<Node>,
    pub tensions: Vec<f64>,
}

impl Place {
    pub fn restore(&self, scratch: &mut Scratch) {
        let Scratch { chain, groups, .. } = scratch;
        chain.nodes.clone_from(&self.nodes);
        chain.pull(groups, &self.tensions);
    }

    pub fn of(chain: &Chain) -> Self {
        Self { nodes: chain.nodes.clone(), tensions: chain.tensions.clone() }
    }
}

impl Ended {
    pub fn failure(&self, scratch: &Scratch) -> Failure {
        let Self { load: last_load, residual, iterations, fault } = *self;
        match fault.kind {
            SectionFault::Folded { cable } => {
                let tension = scratch.chain.tensions.get(cable).copied().unwrap_or(0.0);
                Failure::Folds { cable, arc_length: fault.arc_length, tension, last_load }
            }
            SectionFault::Diverged => {
                Failure::NotConverged { iterations, residual, last_load, advice: PATH_ENDS }
            }
        }
    }
}
