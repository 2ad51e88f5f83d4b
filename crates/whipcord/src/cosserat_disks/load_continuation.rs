//! The robot under loads: from a neighbour, from the robot without load, or with the load raised from
//! nothing in steps that adapt.
//!
//! Where the way from there ends, or at an equilibrium that the robot leaves, the load is raised from
//! one stable equilibrium to the next, then load and commands together from the robot at rest, and at
//! last all of it acts on shapes bent every way.

use whipcord_numerics::{ContinuationSteps, Ended, Missed, continuation};

use super::problem::{Neighbour, Problem, Start};
use super::raise::Place;
use super::raise::Raise;
use super::scratch::Scratch;
use super::scratch::{copy_out, finish};
use super::tensions::Rod;
use super::{stability_check, unloaded};
use crate::solution::Diagnostics;
use crate::statics::command::Command;
use crate::statics::continuation::SHORT_ITERATION;
use crate::statics::lengths::Effort;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found};
use crate::statics::trace::Stage;

/// What an attempt may spend under load, in shapes of the whole robot.
const SHAPES_UNDER_LOAD: usize = 400;
/// The same from one stable equilibrium to the next.
const SHAPES_TO_STABLE: usize = 100;
/// The same where the robot was not found without load, and its cables are slack at first.
const SHAPES_FROM_SLACK: usize = 40;

/// Of the tensions of a robot without load, as a part of them: the first step from nothing, and the least, which tells where they are lost.
const FIRST_TENSION_STEP: f64 = 1.0 / 16.0;
const LEAST_TENSION_STEP: f64 = 1.0 / 1_048_576.0;

/// Of the lengths of a robot without load, as a part of the way from rest.
const LENGTH_STEPS: ContinuationSteps =
    ContinuationSteps { first: 0.25, least: 1e-3, after_miss: f64::INFINITY, growth: 1.0 };

/// Finds the equilibrium under the loads that `scratch.applied` has gathered; the answer is left in
/// `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: Start<'_>,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    let commands = if problem.by_length() { problem.commands } else { &[] };
    let raise = Raise { commands, ..Raise::at_tensions(problem) };
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
    scratch.found_without_load = without.is_ok();
    let shapes = if without.is_ok() { SHAPES_UNDER_LOAD } else { SHAPES_FROM_SLACK };
    problem.meter.extend_attempt(shapes * problem.mesh.grid.len());
    let rest = Place::of(&scratch.chain);
    let mut ended = None;
    let mut unstable = None;
    match raise.load(scratch) {
        Ok(effort) if raise.is_stable(scratch, 1.0) => return Ok(finish(problem, scratch, effort)),
        Ok(effort) => unstable = Some((Place::of(&scratch.chain), effort)),
        Err(end) => ended = Some(end),
    }
    let mut lost_at = None;
    if let Some((_, effort)) = unstable {
        let is_attempt = problem.meter.is_attempt() && problem.stability != StabilityAnalysis::Off;
        if is_attempt {
            problem.meter.extend_attempt(SHAPES_TO_STABLE * problem.mesh.grid.len());
        } else {
            problem.meter.end_attempt();
        }
        rest.restore(scratch);
        match raise.steadily(scratch) {
            Ok(effort) => return Ok(finish(problem, scratch, effort)),
            Err(_) if is_attempt => {
                // What it is left for is looked for where no finer mesh leads to a stable one.
                scratch.unstable = true;
                return Ok(finish(problem, scratch, effort));
            }
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

/// Raises the tensions of a robot without load, which leaves the equilibrium at all of them that `scratch` holds because its cables
/// buckle spans, from nothing through stable equilibria, each from the one before: at more than its spans buckle under the one that is found
/// from rest need not be the one that the cables lead to. `scratch` then holds the last of them where the tensions are given, else what it held.
///
/// # Errors
/// The fraction of the tensions beyond which there is none near; `scratch` holds what it held.
pub(super) fn raise_tensions(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<(), Option<f64>> {
    let Problem { frame, mesh, .. } = *problem;
    let all = scratch.tensions.clone();
    let kept = (scratch.unloaded.clone(), scratch.pulled.clone());
    let mut here = (unloaded::From::Nothing, scratch.unloaded.clone());
    let steps = ContinuationSteps {
        first: FIRST_TENSION_STEP,
        least: LEAST_TENSION_STEP,
        after_miss: f64::INFINITY,
        growth: 2.0,
    };
    let raised = continuation(&steps, |part| {
        let Scratch { unloaded, pulled, groups, .. } = &mut *scratch;
        pulled.clear();
        pulled.extend(groups.iter().map(|&cable| part * all[cable]));
        let (from, before) = &here;
        unloaded.clone_from(before);
        let swept = unloaded.sweep(frame, mesh, pulled, *from, true);
        let iterations = unloaded.iterations;
        let bound = -Diagnostics::NEUTRAL;
        let is_stable = swept.is_ok()
            && stability_check::is_above_without_load(problem, bound, scratch) == Some(true);
        if !is_stable {
            return Err(Missed { reason: (), is_last: problem.meter.has_ended() });
        }
        here = (unloaded::From::Neighbour, scratch.unloaded.clone());
        Ok(iterations <= SHORT_ITERATION * frame.spans.len())
    });
    // At given lengths other tensions hold that equilibrium.
    if raised.is_err() || problem.by_length() {
        (scratch.unloaded, scratch.pulled) = kept;
    }
    raised.map_err(|Ended { reached, .. }| (reached > 0.0).then_some(reached))
}

/// A stable equilibrium without load at given lengths, instead of the one that `scratch` holds, which is not stable: the lengths are brought there from the robot
/// at rest, each part of the way from the tensions before. `scratch` holds what it held where that does not lead there.
pub(super) fn bring_lengths(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    let Scratch { unloaded, pulled, tensions, lengths, .. } = &*scratch;
    let kept = (unloaded.clone(), pulled.clone(), tensions.clone(), lengths.clone());
    let mut here = vec![0.0; problem.commands.len()];
    let mut effort = Effort::default();
    let brought = continuation(&LENGTH_STEPS, |part| {
        let commands = problem.commands_at(part);
        let at = Problem { commands: &commands, ..*problem };
        let mut tensions = here.clone();
        let converged = Rod::new(&at, scratch).converge(&mut tensions);
        let missed = || Missed { reason: (), is_last: problem.meter.has_ended() };
        let Effort { iterations, residual } = converged.map_err(|_| missed())?;
        let bound = -Diagnostics::NEUTRAL;
        if stability_check::is_above_without_load(&at, bound, scratch) != Some(true) {
            return Err(missed());
        }
        effort = Effort { iterations: effort.iterations + iterations, residual };
        here = tensions;
        Ok(true)
    });
    if brought.is_ok() {
        return Some(Rod::new(problem, scratch).finish(here, Found::with(effort)));
    }
    (scratch.unloaded, scratch.pulled, scratch.tensions, scratch.lengths) = kept;
    copy_out(problem, scratch);
    None
}
