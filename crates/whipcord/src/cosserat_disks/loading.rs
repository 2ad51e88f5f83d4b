//! The robot under loads: from a neighbour, from the robot without load, or with the load raised from
//! nothing in steps that adapt.
//!
//! Where the way from there ends, or at an equilibrium that the robot leaves, the load is raised from
//! one stable equilibrium to the next, then load and commands together from the robot at rest, and at
//! last all of it acts on shapes bent every way.

use whipcord_numerics::Vec3;

use super::chain::{Chain, Node, Scales, Task};
use super::statics::{Problem, Rod, Scratch, Start, copy_out};
use super::{stays, unloaded};
use crate::cosserat::command::Command;
use crate::cosserat::continuation::{FIRST_LOAD_STEP, LEAST_LOAD_STEP, PATH_ENDS, SHORT_ITERATION};
use crate::cosserat::lengths::Effort;
use crate::cosserat::outcome::{Failure, Found, Open};
use crate::cosserat::section::SectionFault;
use crate::cosserat::trace::Stage;
use crate::cosserat::unloaded::Fault;

/// Shapes that are tried where the load leads to none that is stable: bent by so much in all, in rad,
/// in so many directions.
const FAR_BENDS: [f64; 3] = [1.0, 2.5, 5.0];
const FAR_WAYS: usize = 8;

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
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    let commands = if problem.by_length() { problem.commands } else { &[] };
    let raise = Raise { problem, commands, derivatives: false };
    let near = match start {
        Start::Coarser => Some(true),
        Start::From { disks, base: Some(base), .. } if disks.len() == problem.disks() => {
            let Scratch { chain, groups, tensions, applied, .. } = &mut *scratch;
            chain.pull(groups, tensions);
            chain.start_from(&raise.task(groups, applied, 1.0), disks, *base);
            Some(false)
        }
        _ => None,
    };
    scratch.chain.trace.stage = Stage::Warm;
    if let Some(linearised) = near
        && let Ok(effort) = raise.close(scratch, 1.0, linearised)
    {
        return Ok(finish(problem, scratch, effort));
    }
    let without = start_without_load(problem, scratch);
    let rest = Place::of(&scratch.chain);
    let mut ended = None;
    let mut unstable = None;
    match raise.load(scratch) {
        Ok(effort) if raise.stays(scratch) => return Ok(finish(problem, scratch, effort)),
        Ok(effort) => unstable = Some((Place::of(&scratch.chain), effort)),
        Err(end) => ended = Some(end),
    }
    let (mut lost_at, mut parts) = (None, false);
    if unstable.is_some() {
        rest.restore(scratch);
        match raise.steadily(scratch) {
            Ok(effort) => return Ok(finish(problem, scratch, effort)),
            Err(end) => {
                lost_at = Some(end.load);
                // The path goes on past the place, as that of a straight column does: it is the answer,
                // and which way the robot leaves it nothing says.
                parts = end.residual <= problem.tolerance;
            }
        }
    }
    let with = |found: Found| Found { lost_at, ..found };
    if let Some(first) = unstable.as_ref().filter(|_| parts)
        && let Ok(effort) = raise.back_to(scratch, first)
    {
        return Ok(with(finish(problem, scratch, effort)));
    }
    match raise.all(scratch) {
        Ok(effort) if raise.stays(scratch) => return Ok(with(finish(problem, scratch, effort))),
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
        return Ok(with(finish(problem, scratch, effort)));
    }
    without?;
    Err(ended.map_or_else(|| raise.not_found(), |end| end.failure(scratch)))
}

/// The chain at the equilibrium without load; where there is none, with the cables slack that are
/// driven by their length.
fn start_without_load(problem: &Problem<'_>, scratch: &mut Scratch) -> Result<(), Failure> {
    let mut tensions = scratch.tensions.clone();
    let mut settled = Rod::without_load(problem, scratch).settle(&mut tensions);
    if settled.is_err() {
        for (tension, command) in tensions.iter_mut().zip(problem.commands) {
            *tension = match *command {
                Command::Tension(given) => given,
                Command::Length { .. } => 0.0,
            };
        }
        let slack = Problem { commands: &[], ..*problem };
        if let Err(failure) = Rod::without_load(&slack, scratch).settle(&mut tensions) {
            settled = settled.and(Err(failure));
        }
    }
    let Scratch { chain, groups, unloaded, .. } = &mut *scratch;
    chain.pull(groups, &tensions);
    chain.start(problem.frame, problem.mesh, &unloaded.wrenches, &unloaded.poses);
    settled.map(|_| ())
}

fn finish(problem: &Problem<'_>, scratch: &mut Scratch, effort: Effort) -> Found {
    scratch.tensions.clone_from(&scratch.chain.tensions);
    scratch.lengths.clone_from(&scratch.chain.lengths);
    scratch.pulled.clone_from(&scratch.chain.pulled);
    copy_out(problem, scratch);
    Found::with(effort)
}

impl Raise<'_> {
    fn task<'a>(
        &'a self,
        groups: &'a [usize],
        loads: &'a crate::cosserat::loads::AppliedLoads,
        load: f64,
    ) -> Task<'a> {
        let Problem { frame, mesh, tolerance, .. } = *self.problem;
        let Self { commands, derivatives, .. } = *self;
        Task { frame, mesh, loads, load, groups, commands, derivatives, tolerance }
    }

    /// Closes the chain from where it stands, at a fraction of the load.
    pub fn close(
        &self,
        scratch: &mut Scratch,
        load: f64,
        linearised: bool,
    ) -> Result<Effort, Open> {
        let Scratch { chain, groups, applied, .. } = &mut *scratch;
        chain.trace.steps = self.problem.mesh.grid.len();
        let task = self.task(groups, applied, load);
        let (iterations, residual) = chain.close(&task, linearised)?;
        Ok(Effort { iterations, residual })
    }

    /// Raises the load to all of it from a chain that is closed without any.
    pub fn load(&self, scratch: &mut Scratch) -> Result<Effort, Ended> {
        self.path(scratch, |scratch, load| self.close(scratch, load, false))
    }

    /// Raises the load and the commands to all of them from the robot at rest; `None` where that is
    /// not to be had.
    pub fn all(&self, scratch: &mut Scratch) -> Result<Effort, Option<Ended>> {
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
            Raise { commands: held, ..*self }.close(scratch, load, false)
        });
        raised.map_err(Some)
    }

    /// Raises the load from one stable equilibrium to the next.
    fn steadily(&self, scratch: &mut Scratch) -> Result<Effort, Ended> {
        self.path(scratch, |scratch, load| {
            let effort = self.close(scratch, load, false)?;
            if self.stays(scratch) {
                Ok(effort)
            } else {
                let Effort { iterations, residual: gap } = effort;
                Err(Open { iterations, gap, fault: None })
            }
        })
    }

    /// Under all of the load from shapes bent every way: an equilibrium that the robot stays in.
    fn afar(&self, scratch: &mut Scratch, tensions: &[f64]) -> Option<Effort> {
        let Problem { frame, mesh, .. } = *self.problem;
        let unit = Scales::of(frame, mesh).moment;
        for size in FAR_BENDS {
            for way in 0..FAR_WAYS {
                let angle = core::f64::consts::TAU * way as f64 / FAR_WAYS as f64;
                let bend = size * Vec3::new(angle.cos(), angle.sin(), 0.0);
                let Scratch { chain, groups, .. } = &mut *scratch;
                chain.pull(groups, tensions);
                chain.start_bent(frame, bend, unit);
                if let Ok(effort) = self.close(scratch, 1.0, false)
                    && self.stays(scratch)
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
        let last = self.close(scratch, 1.0, false)?;
        Ok(Effort { iterations: effort.iterations + last.iterations, ..last })
    }

    /// Whether the robot stays in the equilibrium that the chain holds; loads that follow it have no
    /// energy to tell.
    fn stays(&self, scratch: &mut Scratch) -> bool {
        scratch.applied.any_follower() || stays::is_stable(self.problem, scratch).unwrap_or(true)
    }

    fn not_found(&self) -> Failure {
        Failure::NotConverged { iterations: 0, residual: 1.0, last_load: 0.0, advice: PATH_ENDS }
    }

    /// Goes from nothing to all in steps that adapt, at first at once.
    fn path(
        &self,
        scratch: &mut Scratch,
        mut close: impl FnMut(&mut Scratch, f64) -> Result<Effort, Open>,
    ) -> Result<Effort, Ended> {
        scratch.chain.trace.stage = Stage::Cold;
        let mut here = Place::of(&scratch.chain);
        let (mut load, mut step, mut iterations) = (0.0, 1.0, 0);
        loop {
            let next = f64::min(load + step, 1.0);
            match close(scratch, next) {
                Ok(effort) => {
                    iterations += effort.iterations;
                    if next >= 1.0 {
                        return Ok(Effort { iterations, ..effort });
                    }
                    here = Place::of(&scratch.chain);
                    load = next;
                    if effort.iterations <= SHORT_ITERATION {
                        step *= 2.0;
                    }
                }
                Err(open) => {
                    iterations += open.iterations;
                    scratch.chain.trace.stage = Stage::LoadSteps;
                    step = f64::min(0.5 * step, FIRST_LOAD_STEP);
                    if step < LEAST_LOAD_STEP {
                        let none = Fault { kind: SectionFault::Diverged, arc_length: 0.0 };
                        let residual = if open.gap.is_finite() { open.gap } else { 1.0 };
                        let fault = open.fault.unwrap_or(none);
                        return Err(Ended { load, residual, iterations, fault });
                    }
                    here.restore(scratch);
                }
            }
        }
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
