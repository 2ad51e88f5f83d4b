//! The robot under loads: from a neighbour, from the robot without load, or with the load raised from
//! nothing in steps that adapt.
//!
//! Where the way from there ends, or at an equilibrium that the robot leaves, the load is raised from
//! one stable equilibrium to the next, then load and commands together from the robot at rest, and at
//! last all of it acts on shapes bent every way.

use whipcord_numerics::{ContinuationSteps, Missed, Vec3, continuation};

use super::chain::{Chain, Node, Task};
use super::statics::{Neighbour, Problem, Rod, Scratch, Start, copy_out};
use super::{stability_check, unloaded};
use crate::section::Fault;
use crate::section::SectionFault;
use crate::shape::Diagnostics;
use crate::statics::command::Command;
use crate::statics::continuation::{
    FIRST_LOAD_STEP, LEAST_LOAD_STEP, PATH_ENDS, SHORT_ITERATION, load_steps,
};
use crate::statics::lengths::Effort;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found, Open};
use crate::statics::path;
use crate::statics::trace::Stage;

/// Shapes that are tried where the load leads to none that is stable: bent by so much in all, in rad,
/// in so many directions.
const FAR_BENDS: [f64; 3] = [1.0, 2.5, 5.0];
const FAR_WAYS: usize = 8;

/// Dead moments that lead a robot off a path that is not stable, in all in units of EI/L, and the parts of them
/// that are left as they are taken away.
const PERTURBATIONS: [f64; 2] = [0.05, 0.4];
const TAKEN_AWAY: [f64; 7] = [0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4, 0.0];
/// Their direction: none that a robot is built along.
const SIDEWAYS: Vec3 = Vec3::new(0.48, 0.64, 0.6);
/// Multiples of it are spread evenly over the unit interval.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Halvings that locate the loss of stability.
const LOSS_HALVINGS: usize = 12;

/// The load on its way up, from a chain that is closed without it.
pub(super) struct Raise<'a> {
    pub problem: &'a Problem<'a>,
    /// What drives the cables, where any is driven by its length; else empty.
    pub commands: &'a [Command],
    pub derivatives: bool,
}

/// Where it could not be raised any more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub load: f64,
    pub residual: f64,
    pub iterations: usize,
    pub fault: Fault,
}

/// Finds the equilibrium under the loads that `scratch.applied` has gathered; the answer is left in
/// `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: Start<'_>,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    let commands = if problem.by_length() { problem.commands } else { &[] };
    let raise = Raise { problem, commands, derivatives: false };
    let near = match start {
        Start::Coarser => Some((true, false)),
        Start::Near(&Neighbour { ref disks, base: Some(base), stable, .. })
            if disks.len() == problem.disks() =>
        {
            let Scratch { chain, groups, tensions, applied, .. } = &mut *scratch;
            chain.pull(groups, tensions);
            chain.start_from(&raise.task(groups, applied, 1.0), disks, base);
            Some((false, stable && problem.stability != StabilityAnalysis::Off))
        }
        _ => None,
    };
    scratch.chain.trace.stage = Stage::Warm;
    if let Some((linearised, stable)) = near
        && let Ok(effort) = raise.newton(scratch, 1.0, linearised)
        && (!stable || raise.is_stable(scratch, 1.0))
    {
        return Ok(finish(problem, scratch, effort));
    }
    let without = start_without_load(problem, scratch);
    let rest = Place::of(&scratch.chain);
    let mut ended = None;
    let mut unstable = None;
    match raise.load(scratch) {
        Ok(effort) if raise.is_stable(scratch, 1.0) => return Ok(finish(problem, scratch, effort)),
        Ok(effort) => unstable = Some((Place::of(&scratch.chain), effort)),
        Err(end) => ended = Some(end),
    }
    let mut lost_at = None;
    if unstable.is_some() {
        rest.restore(scratch);
        match raise.steadily(scratch) {
            Ok(effort) => return Ok(finish(problem, scratch, effort)),
            Err(end) => lost_at = raise.lost_at(scratch, end.load),
        }
    }
    let with = |found: Found| Found { lost_at, ..found };
    if unstable.is_some()
        && problem.stability != StabilityAnalysis::Off
        && let Some(effort) = raise.perturbed(scratch, &rest)
    {
        return Ok(with(finish(problem, scratch, effort)));
    }
    match raise.all(scratch, false) {
        Ok(effort) if raise.is_stable(scratch, 1.0) => {
            return Ok(with(finish(problem, scratch, effort)));
        }
        Ok(effort) => unstable = unstable.or_else(|| Some((Place::of(&scratch.chain), effort))),
        Err(Some(end)) if ended.is_none_or(|before| end.load > before.load) => ended = Some(end),
        Err(_) => {}
    }
    if let Some(effort) = raise.afar(scratch, &rest.tensions) {
        return Ok(with(finish(problem, scratch, effort)));
    }
    if let Some(first) = &unstable
        && let Ok(effort) = raise.back_to(scratch, first)
    {
        scratch.unstable = true;
        return Ok(with(finish(problem, scratch, effort)));
    }
    without?;
    Err(ended.map_or_else(|| raise.not_found(), |end| end.failure(scratch)))
}

/// The chain at the equilibrium without load; where there is none, with the cables slack that are
/// driven by their length.
pub(super) fn start_without_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<(), Failure> {
    let mut tensions = scratch.tensions.clone();
    let mut converged = Rod::without_load(problem, scratch).converge(&mut tensions);
    if converged.is_err() {
        for (tension, command) in tensions.iter_mut().zip(problem.commands) {
            *tension = match *command {
                Command::Tension(given) => given,
                Command::Length { .. } => 0.0,
            };
        }
        let slack = Problem { commands: &[], ..*problem };
        if let Err(failure) = Rod::without_load(&slack, scratch).converge(&mut tensions) {
            converged = converged.and(Err(failure));
        }
    }
    let Scratch { chain, groups, unloaded, .. } = &mut *scratch;
    chain.pull(groups, &tensions);
    chain.start(problem.frame, problem.mesh, &unloaded.wrenches, &unloaded.poses);
    converged.map(|_| ())
}

/// The fraction of the tensions at which a robot without load loses its stability because its cables buckle
/// spans, by bisection; `None` where it does not. `scratch` holds the answer at all of the tensions.
pub(super) fn tensions_lost_at(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<f64> {
    let Problem { frame, mesh, .. } = *problem;
    if stability_check::is_above_without_load(problem, -Diagnostics::NEUTRAL, scratch)
        != Some(false)
    {
        return None;
    }
    let all = scratch.tensions.clone();
    let kept = (scratch.unloaded.clone(), scratch.pulled.clone());
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..LOSS_HALVINGS + 8 {
        let middle = 0.5 * (low + high);
        let Scratch { unloaded, pulled, groups, .. } = &mut *scratch;
        pulled.clear();
        pulled.extend(groups.iter().map(|&cable| middle * all[cable]));
        let swept = unloaded.sweep(frame, mesh, pulled, unloaded::From::Nothing, false);
        let bound = -Diagnostics::NEUTRAL;
        if swept.is_ok()
            && stability_check::is_above_without_load(problem, bound, scratch) == Some(true)
        {
            low = middle;
        } else {
            high = middle;
        }
    }
    (scratch.unloaded, scratch.pulled) = kept;
    (low > 0.0).then_some(low)
}

/// Copies the answer out of the closed chain.
pub(super) fn finish(problem: &Problem<'_>, scratch: &mut Scratch, effort: Effort) -> Found {
    scratch.tensions.clone_from(&scratch.chain.tensions);
    scratch.lengths.clone_from(&scratch.chain.lengths);
    scratch.pulled.clone_from(&scratch.chain.pulled);
    copy_out(problem, scratch);
    Found::with(effort)
}

impl Raise<'_> {
    pub fn task<'a>(
        &'a self,
        groups: &'a [usize],
        loads: &'a crate::statics::loads::AppliedLoads,
        load: f64,
    ) -> Task<'a> {
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
        let part = |fraction: f64| -> Vec<Command> {
            let of_cable = |(&rest, command): (&f64, &Command)| match *command {
                Command::Tension(tension) => Command::Tension(fraction * tension),
                Command::Length { target, compliance } => {
                    Command::Length { target: rest + fraction * (target - rest), compliance }
                }
            };
            frame.rest_lengths.iter().zip(commands).map(of_cable).collect()
        };
        let raised = self.path(scratch, |scratch, load| {
            let commands = part(load);
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
    fn steadily(&self, scratch: &mut Scratch) -> Result<Effort, Ended> {
        self.path(scratch, |scratch, load| {
            let effort = self.newton(scratch, load, false)?;
            self.if_stable(scratch, load, effort)
        })
    }

    fn if_stable(&self, scratch: &mut Scratch, load: f64, effort: Effort) -> Result<Effort, Open> {
        if self.is_stable(scratch, load) {
            return Ok(effort);
        }
        let Effort { iterations, residual: gap } = effort;
        Err(Open { iterations, gap, fault: None })
    }

    /// Where on the way up stability is lost, from the last stable equilibrium that was found on it, which the
    /// chain holds: by bisection. `None` where the robot was not stable without load.
    fn lost_at(&self, scratch: &mut Scratch, from: f64) -> Option<f64> {
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

    /// A stable equilibrium on a branch off the path: the load is raised once more together with small dead
    /// moments on the disks, which are then taken away. They point in no direction that a robot is built along and
    /// differ from disk to disk, so that they work on every mode.
    fn perturbed(&self, scratch: &mut Scratch, rest: &Place) -> Option<Effort> {
        let Problem { frame, mesh, .. } = *self.problem;
        let kept = scratch.applied.clone();
        let spans = mesh.spans.len() as f64;
        let total = frame.scales(mesh).moment;
        let disturb = |scratch: &mut Scratch, part: f64| {
            scratch.applied.clone_from(&kept);
            for (k, steps) in mesh.spans.iter().enumerate() {
                let share = part * total * (0.5 + (k as f64 * GOLDEN).fract()) / spans;
                scratch.applied.add_moment(steps.end, share * SIDEWAYS);
            }
        };
        let mut found = None;
        for size in PERTURBATIONS {
            disturb(scratch, size);
            rest.restore(scratch);
            let raised = self.steadily(scratch).ok();
            let Some(effort) = raised.or_else(|| self.all(scratch, true).ok()) else { continue };
            let mut iterations = effort.iterations;
            let taken_away = TAKEN_AWAY.into_iter().try_fold(effort, |_, part| {
                disturb(scratch, size * part);
                let effort = self.newton(scratch, 1.0, false).ok()?;
                iterations += effort.iterations;
                Some(Effort { iterations, ..effort })
            });
            scratch.applied.clone_from(&kept);
            found = taken_away
                .filter(|_| stability_check::is_nearly_stable(self.problem, scratch) == Some(true));
            if found.is_some() {
                break;
            }
        }
        scratch.applied.clone_from(&kept);
        found
    }

    /// Under all of the load from shapes bent every way: a stable equilibrium.
    fn afar(&self, scratch: &mut Scratch, tensions: &[f64]) -> Option<Effort> {
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
    fn back_to(
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
    fn is_stable(&self, scratch: &mut Scratch, load: f64) -> bool {
        let Scratch { applied, chain, .. } = &*scratch;
        let only_moments = applied.any() && applied.only_dead_moments();
        applied.any_follower()
            || (only_moments && chain.pulled.iter().all(|&tension| tension == 0.0))
            || stability_check::is_stable(self.problem, load, scratch).unwrap_or(true)
    }

    fn not_found(&self) -> Failure {
        Failure::NotConverged { iterations: 0, residual: 1.0, last_load: 0.0, advice: PATH_ENDS }
    }

    /// Goes from nothing to all in steps that adapt, at first at once.
    fn path(
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

/// A closed chain that a step goes out from.
struct Place {
    nodes: Vec<Node>,
    tensions: Vec<f64>,
}

impl Place {
    fn restore(&self, scratch: &mut Scratch) {
        let Scratch { chain, groups, .. } = scratch;
        chain.nodes.clone_from(&self.nodes);
        chain.pull(groups, &self.tensions);
    }

    fn of(chain: &Chain) -> Self {
        Self { nodes: chain.nodes.clone(), tensions: chain.tensions.clone() }
    }
}

impl Ended {
    fn failure(&self, scratch: &Scratch) -> Failure {
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
