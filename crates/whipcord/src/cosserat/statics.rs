//! Static equilibrium on one grid.
//!
//! Without load the sections stand for themselves ([`super::unloaded`], [`crate::statics::lengths`]). Under
//! loads the unknowns are the base moment, the share of follower forces in the base force, and the
//! tensions of the cables whose lengths are prescribed; Newton's method shoots at
//!
//! ```text
//! M(L) = M_tip,   F_follower(L) = F_tip,   min(τᵢ, gᵢ) = 0        g: slackness, eq. (6)        (7)
//! ```
//!
//! from the shape without load, or from a neighbouring answer, whose nodes multiple shooting goes on from; where that fails the load is raised
//! by multiple shooting, and past the points where it cannot be, by [`crate::statics::path`].

use whipcord_numerics::{UnitQuaternion, Vec3};

use super::chain::Task;
use super::continuation::{Ended, newton, raise_load, raise_load_at_tensions, refine_chain};
use super::guess::guess;
use super::newton::Point;
use super::path::RodPath;
use super::perturbed;
use super::problem::{Problem, StabilityCheck};
use super::scratch::{Scratch, Start};
use super::search;
use super::shooting::{Failed, finish, finish_chain, shoot};
use super::state::State;
use super::verdict::is_accepted;
use super::without_load::{set_tensions, start_without_load, without_load};
use crate::section::Strain;
use crate::statics::command::Command;
use crate::statics::lengths::{self, Effort};
use crate::statics::outcome::{Failure, Found, Open};
use crate::statics::path::next_stable::next_stable;
use crate::statics::runge_kutta::{SAMPLED_STAGES, STAGES};
use crate::statics::scales::Scales;
use crate::statics::trace::Stage;

/// Solves the problem, whose loads are gathered, for cables of which each pulls to an effect of its own.
pub(super) fn solve_independent(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    (scratch.trace.stage, scratch.trace.steps) = (Stage::Warm, problem.grid.len());
    (scratch.on_chain, scratch.sampled, scratch.stable) = (false, false, true);
    scratch.side_by_side = false;
    scratch.differentiated = false;
    start_tensions(problem, start, scratch);
    if !scratch.applied.any() {
        return without_load(problem, scratch);
    }
    let Start { base_wrench: Some(wrench), stable, on_chain, chain, .. } = start else {
        return from_no_load(problem, scratch, None);
    };
    // Without its nodes an answer under other tensions tells less than the guess does; the wrench of one under the same, and of an iterate that a budget
    // ended, is gone on from.
    let is_moved =
        scratch.tensions.iter().zip(problem.commands).any(
            |(&before, command)| matches!(*command, Command::Tension(given) if given != before),
        );
    set_tensions(problem.commands, &mut scratch.tensions);
    if (start.side_by_side || is_moved && !start.is_iterate)
        && let Some(found) = side_by_side(problem, start, scratch)
    {
        return Ok(found);
    }
    // A chain has none of the derivatives by which an answer is corrected.
    let goes_on_by_chain =
        start.internal.takes_multiple_shooting && *stable && scratch.corrected == 0.0;
    let closed = if goes_on_by_chain && start_from_nodes(problem, start, scratch) {
        match newton(problem, scratch) {
            Ok((iterations, residual)) => {
                Some(finish_chain(problem, scratch, Effort { iterations, residual }))
            }
            Err(open) if keep_iterate(problem, scratch, &open) => {
                return Err(ended(Effort { iterations: open.iterations, residual: open.gap }));
            }
            Err(_) => None,
        }
    } else if *on_chain {
        refine_chain(problem, scratch, chain)
    } else {
        None
    };
    if let Some(found) = closed {
        if !stable || is_accepted(problem, scratch) {
            scratch.stable = *stable;
            return Ok(found);
        }
        // Those of an answer that is not taken are no start.
        start_tensions(problem, start, scratch);
        set_tensions(problem.commands, &mut scratch.tensions);
    }
    (scratch.on_chain, scratch.sampled) = (false, false);
    scratch.newton.point.base_moment = wrench.moment;
    scratch.newton.point.follower_force = scratch.applied.follower_share(wrench.force);
    scratch.newton.point.tensions.clone_from(&scratch.tensions);
    scratch.differentiated = start.remembered;
    if start.remembered {
        scratch.trajectory.refine(problem.grid);
    } else {
        scratch.trajectory.forget();
    }
    let mut near = None;
    match shoot(problem, scratch, 1.0) {
        Ok(effort) => {
            let found = finish(problem, scratch, effort);
            scratch.stable = *stable;
            if !stable || is_accepted(problem, scratch) {
                return Ok(found);
            }
            near = Some(scratch.newton.point.clone());
        }
        Err(Failed { effort }) if problem.meter.has_ended() => return Err(ended(effort)),
        Err(_) => {}
    }
    from_no_load(problem, scratch, near)
}

/// The tensions of the start, none of them negative.
fn start_tensions(problem: &Problem<'_>, start: &Start, scratch: &mut Scratch) {
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    for (tension, &given) in scratch.tensions.iter_mut().zip(&start.tensions) {
        *tension = given.max(0.0);
    }
}

/// Puts the iterate at which the budget was spent in the place of the answer; `false` where it was not spent, or there is a best shape.
fn keep_iterate(problem: &Problem<'_>, scratch: &mut Scratch, open: &Open) -> bool {
    let is_kept = problem.meter.has_ended() && open.gap.is_finite() && scratch.open.is_none();
    if is_kept {
        let effort = Effort { iterations: open.iterations, residual: open.gap };
        finish_chain(problem, scratch, effort);
        scratch.open = Some(effort);
    }
    is_kept
}

/// A solve that was ended from outside, with the best shape so far in the place of the answer.
fn ended(Effort { iterations, residual }: Effort) -> Failure {
    Failure::NotConverged { iterations, residual, last_load: 0.0, advice: "the solve was ended" }
}

/// The rod without load as the start of a path, with the loads gathered; `None` where there is no
/// load.
pub(super) fn start_of_path(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<Option<State>, Failure> {
    scratch.applied.gather(problem.grid, problem.loads, problem.base);
    scratch.trace.steps = problem.grid.len();
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    start_without_load(problem, scratch)?;
    let state = State::unloaded(&scratch.poses, &scratch.tensions);
    Ok(scratch.applied.any().then_some(state))
}

/// All of the load at a point near equilibrium; the answer is left in `scratch`.
pub(super) fn converge(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    near: State,
) -> Result<Found, Failure> {
    start_of_path(problem, scratch)?;
    scratch.chain.state = near;
    scratch.chain.state.load = 1.0;
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    match newton(problem, scratch) {
        Ok((iterations, residual)) => {
            Ok(finish_chain(problem, scratch, Effort { iterations, residual }))
        }
        Err(open) => Err(Failure::NotConverged {
            iterations: open.iterations,
            residual: open.gap,
            last_load: 1.0,
            advice: "an equilibrium on coarse steps is lost on finer ones: give more steps",
        }),
    }
}

/// From the rod without load: at once, or raising the load step by step.
/// `near` is an equilibrium that is known but not stable, for where no stable one is found.
fn from_no_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    near: Option<Point>,
) -> Result<Found, Failure> {
    if let Err(failure) = start_without_load(problem, scratch) {
        return from_loose_cables(problem, scratch).ok_or(failure);
    }
    scratch.trace.stage = Stage::Cold;
    guess(problem, scratch, 1.0);
    if steps_are_faster(problem, scratch) {
        if let Some(found) = close_steps(problem, scratch) {
            return Ok(found);
        }
        if problem.meter.has_ended() {
            return Err(ended(scratch.open.unwrap_or_default()));
        }
    }
    let strong_followers = scratch.applied.any_follower()
        && scratch.newton.point.is_strong(&Scales::of(problem.grid, problem.length));
    // No energy tells which of several equilibria under followers is meant: it is the one the load
    // leads to.
    let (spent, direct) = if strong_followers {
        (0, near)
    } else {
        match shoot(problem, scratch, 1.0) {
            Ok(effort) => {
                let found = finish(problem, scratch, effort);
                scratch.stable = is_accepted(problem, scratch);
                if scratch.stable {
                    return Ok(found);
                }
                // An unstable equilibrium: the load path may lead to another.
                (effort.iterations, near.or_else(|| Some(scratch.newton.point.clone())))
            }
            Err(Failed { effort }) if problem.meter.has_ended() => return Err(ended(effort)),
            Err(failed) => (failed.effort.iterations, near),
        }
    };
    let ended = match raise_load(problem, scratch, spent) {
        Ok(found) => {
            scratch.stable = true;
            return Ok(found);
        }
        Err(ended) => ended,
    };
    let Ended { failure, state, iterations } = ended;
    let Some(state) = state.filter(|_| problem.follow) else { return Err(failure) };
    let stays_on_path = scratch.stays_on_path;
    let last_stable = state.load;
    let mut path = RodPath::new(problem, scratch);
    let beyond = next_stable(&mut path, &state, stays_on_path, iterations);
    let lost_at = beyond.lost_at;
    scratch.stable = beyond.stable.is_some();
    if let Some(state) = beyond.stable {
        scratch.chain.state = state;
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        if let Ok((taken, residual)) = newton(problem, scratch) {
            let effort = Effort { iterations: beyond.iterations + taken, residual };
            return Ok(Found { lost_at, ..finish_chain(problem, scratch, effort) });
        }
    }
    if problem.commands.iter().any(|c| matches!(c, Command::Length { .. }))
        && let Some(found) = raise_load_at_tensions(problem, scratch, beyond.iterations)
    {
        scratch.stable = true;
        return Ok(Found { lost_at, ..found });
    }
    if problem.stability != StabilityCheck::Off
        && !scratch.applied.any_follower()
        && !stays_on_path
        && let Some(found) = perturbed::stable_equilibrium(problem, scratch)
    {
        scratch.stable = true;
        let iterations = beyond.iterations + found.iterations;
        return Ok(Found { iterations, lost_at: lost_at.or(Some(last_stable)), ..found });
    }
    if let Some(state) = beyond.unstable
        && let Ok(found) = converge(problem, scratch, state)
    {
        (scratch.stable, scratch.on_chain) = (false, true);
        return Ok(Found { iterations: beyond.iterations + found.iterations, lost_at, ..found });
    }
    if let Some(point) = direct {
        scratch.newton.point = point;
        scratch.trajectory.forget();
        if let Ok(effort) = shoot(problem, scratch, 1.0) {
            scratch.stable = false;
            return Ok(Found { lost_at, ..finish(problem, scratch, effort) });
        }
    }
    if let Some(found) = search::stable_equilibrium(problem, scratch) {
        scratch.stable = true;
        let iterations = beyond.iterations + found.iterations;
        return Ok(Found { iterations, lost_at, ..found });
    }
    Err(match lost_at {
        Some(lost_at) => Failure::Buckled { lost_at, iterations: beyond.iterations },
        None => failure,
    })
}

/// Whether the loads are so weak that the rod has one equilibrium under the given tensions, and lanes take its steps: all of them together take less time than one
/// after the other.
fn steps_are_faster(problem: &Problem<'_>, scratch: &Scratch) -> bool {
    let Scratch { applied, tensions, corrected, .. } = scratch;
    *corrected == 0.0
        && !problem.commands.iter().any(Command::is_length)
        && !applied.any_line()
        && problem.is_clearly_stable(applied, tensions)
        && problem.grid.step_table().is_some()
}

/// With the steps of the rod side by side, from its nodes on a grid with half as many steps, from those of a neighbouring answer, or from the rod without load at the
/// tensions at hand; `None` where that is not faster or does not lead to an answer.
fn side_by_side(problem: &Problem<'_>, start: &Start, scratch: &mut Scratch) -> Option<Found> {
    if !steps_are_faster(problem, scratch) {
        return None;
    }
    if start.side_by_side && start.chain.nodes.len() == problem.grid.len() + 1 {
        scratch.chain.state.copy_from(&start.chain);
        scratch.chain.state.tensions.clone_from(&scratch.tensions);
        scratch.trajectory.refine(problem.grid);
        if scratch.trajectory.strains().len() == STAGES * problem.grid.len() {
            return close_steps(problem, scratch);
        }
    }
    if start_from_nodes(problem, start, scratch) {
        let found = close_steps(problem, scratch);
        // The iterate of a spent budget is in the place of the answer.
        if found.is_some() || problem.meter.has_ended() {
            return found;
        }
    }
    let Scratch { unloaded, tensions, poses, .. } = &mut *scratch;
    unloaded.sweep(problem.grid, tensions, problem.sweep_options()).ok()?;
    unloaded.integrate(problem.grid, poses);
    guess(problem, scratch, 1.0);
    close_steps(problem, scratch)
}

/// Puts the chain to the nodes of a neighbouring answer; `false` where it does not tell them, or those of a number of steps that these are not halved to.
fn start_from_nodes(problem: &Problem<'_>, start: &Start, scratch: &mut Scratch) -> bool {
    let Problem { grid, .. } = *problem;
    let Start { internal, .. } = start;
    let Some(ratio) = internal.own_steps_per_step(grid.len()) else { return false };
    let needs_strains = scratch.sections_need_a_start(grid);
    if needs_strains && internal.strains.len() != SAMPLED_STAGES.len() * ratio * grid.len() {
        return false;
    }
    let Scratch { chain, trajectory, tensions, applied, .. } = scratch;
    // Tensions that friction left are not those of this solve.
    chain.varying.clear();
    let nodes = &mut chain.state.nodes;
    nodes.clear();
    nodes.extend(internal.nodes.iter().step_by(ratio));
    // The base is clamped, nothing is left to act at the tip, and without followers nothing of theirs.
    if let [first, .., last] = &mut nodes[..] {
        first.rotation = UnitQuaternion::IDENTITY;
        (last.moment, last.force) = (Vec3::ZERO, Vec3::ZERO);
    }
    if !applied.any_follower_force() {
        nodes.iter_mut().for_each(|node| node.force = Vec3::ZERO);
    }
    chain.state.tensions.clone_from(tensions);
    chain.state.load = 1.0;
    match needs_strains {
        true => trajectory.seed_steps(internal.strains_of_steps(ratio)),
        false => trajectory.seed_steps((0..grid.len()).map(|_| [Strain::default(); 3])),
    }
    true
}

/// Closes the chain of steps from the guess; the answer is one of single shooting.
fn close_steps(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    let Scratch { chain, trajectory, applied, trace, .. } = &mut *scratch;
    // Tensions that friction left are not those of this solve.
    chain.varying.clear();
    let task = Task::of(problem, applied);
    let (iterations, residual) = match chain.close_from_base(&task, trajectory, trace) {
        Ok(solved) => solved,
        Err(open) => {
            if keep_iterate(problem, scratch, &open) {
                scratch.on_chain = false;
            }
            return None;
        }
    };
    let Scratch { chain, trajectory, applied, .. } = &mut *scratch;
    let task = Task::of(problem, applied);
    if problem.is_checked(applied, &chain.state.tensions) {
        chain.sample(&task, trajectory).ok()?;
    }
    let found = finish_chain(problem, scratch, Effort { iterations, residual });
    (scratch.on_chain, scratch.side_by_side) = (false, true);
    scratch.stable = is_accepted(problem, scratch);
    scratch.stable.then_some(found)
}

/// Lengths that only the loaded rod can take: from the rod without load whose cables are loose.
fn from_loose_cables(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    lengths::release(problem.commands, &mut scratch.tensions);
    set_tensions(problem.commands, &mut scratch.tensions);
    let Scratch { unloaded, tensions, .. } = scratch;
    unloaded.sweep(problem.grid, tensions, problem.sweep_options()).ok()?;
    scratch.unloaded.integrate(problem.grid, &mut scratch.poses);
    guess(problem, scratch, 1.0);
    let effort = shoot(problem, scratch, 1.0).ok()?;
    let found = finish(problem, scratch, effort);
    scratch.stable = is_accepted(problem, scratch);
    Some(found)
}
