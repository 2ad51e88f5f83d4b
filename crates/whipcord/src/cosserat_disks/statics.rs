//! Static equilibrium on one mesh: of the robot without load, under loads, for tensions or lengths.

use super::chain::Chain;
use super::friction;
use super::load_continuation;
use super::node::State;
use super::problem::Problem;
use super::problem::Start;
use super::scratch::Scratch;
use super::stability_check;
use super::tensions::Rod;
use super::unloaded;
use crate::solution::Diagnostics;
use crate::statics::command::Command;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found};

/// Solves the problem under the loads that `scratch.applied` has gathered; the answer is left in
/// `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: Start<'_>,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    (scratch.unstable, scratch.found_without_load) = (false, false);
    if let Some(holes) = problem.holes {
        return friction::solve(problem, holes, scratch);
    }
    let cables = problem.commands.len();
    if !matches!(start, Start::Coarser) {
        scratch.tensions.clear();
        scratch.tensions.resize(cables, 0.0);
    }
    group(problem, scratch);
    if let Start::Near(neighbour) = start {
        for (tension, &given) in scratch.tensions.iter_mut().zip(&neighbour.tensions) {
            *tension = given.max(0.0);
        }
    }
    set_tensions(problem, scratch);
    if scratch.applied.any() {
        return load_continuation::solve(problem, start, scratch);
    }
    let mut rod = Rod::new(problem, scratch);
    if matches!(start, Start::Coarser) {
        rod.from = unloaded::From::Coarser;
    }
    let mut tensions = core::mem::take(&mut rod.scratch.tensions);
    let effort = rod.converge(&mut tensions)?;
    let found = rod.finish(tensions, Found::with(effort));
    if matches!(start, Start::Coarser) || problem.stability == StabilityAnalysis::Off {
        return Ok(found);
    }
    let bound = -Diagnostics::NEUTRAL;
    if stability_check::is_above_without_load(problem, bound, scratch) != Some(false) {
        return Ok(found);
    }
    // What is left of an attempt says nothing of where the way to a stable one ends.
    problem.meter.end_attempt();
    if problem.by_length()
        && let Some(found) = load_continuation::bring_lengths(problem, scratch)
    {
        return Ok(found);
    }
    match load_continuation::raise_tensions(problem, scratch) {
        Ok(()) if !problem.by_length() => {
            let mut rod = Rod::new(problem, scratch);
            rod.from = unloaded::From::Neighbour;
            let mut tensions = rod.scratch.tensions.clone();
            let effort = rod.converge(&mut tensions)?;
            Ok(rod.finish(tensions, Found::with(effort)))
        }
        Ok(()) => Ok(found),
        Err(lost_at) => Ok(Found { lost_at, ..found }),
    }
}

/// Each passage has the tension of its cable.
fn group(problem: &Problem<'_>, scratch: &mut Scratch) {
    scratch.groups.clear();
    let passages = problem.frame.spans.iter().flat_map(|span| &span.passages);
    scratch.groups.extend(passages.map(|passage| passage.cable));
}

/// Puts the given tensions in their place.
fn set_tensions(problem: &Problem<'_>, scratch: &mut Scratch) {
    for (tension, command) in scratch.tensions.iter_mut().zip(problem.commands) {
        if let Command::Tension(given) = *command {
            *tension = given;
        }
    }
}

/// The robot without load as the start of a path under the loads that `scratch.applied` has gathered; `None` where
/// there is no load. Without friction.
pub(super) fn start_of_path(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<Option<State>, Failure> {
    scratch.unstable = false;
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    group(problem, scratch);
    set_tensions(problem, scratch);
    load_continuation::start_without_load(problem, scratch)?;
    let Chain { nodes, tensions, .. } = &scratch.chain;
    let state = State { nodes: nodes.clone(), tensions: tensions.clone(), load: 0.0 };
    Ok(scratch.applied.any().then_some(state))
}
