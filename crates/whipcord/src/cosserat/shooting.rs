//! Single shooting under loads: Newton's method on eq. (7) of [`super::statics`].

use super::chain::Task;
use super::loaded::Trajectory;
use super::newton::{Point, residual};
use super::problem::Problem;
use super::scratch::Scratch;
use super::target::Target;
use crate::section::{Fault, step_tolerance};
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::Found;
use crate::statics::runge_kutta::SAMPLED_STAGES;
use crate::statics::scales::Scales;

const MAX_ITERATIONS: usize = 40;
/// Steps smaller than this, relative to the scales, are made with the derivatives at hand.
const KEEP_BELOW: f64 = 0.05;
/// Derivatives at the answer on a coarser grid serve up to this residual, and are expected to leave so much of it.
const KEPT_RESIDUAL: f64 = 1e-4;
const EXPECTED_RATIO: f64 = 1e-3;
/// Derivatives are made anew when a step leaves more of the residual than this.
const KEEP_RATIO: f64 = 0.1;
/// The line search gives up here.
const LEAST_FRACTION: f64 = 1.0 / 256.0;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e-9;

/// A Newton iteration that ended without an answer.
pub(super) struct Failed {
    pub effort: Effort,
}

/// Newton's method on eq. (7) from `scratch.newton.point`, where it also ends. The derivatives are
/// kept as long as each step with them takes most of the residual away; those at the answer on a coarser grid serve
/// as well.
pub(super) fn shoot(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    load: f64,
) -> Result<Effort, Failed> {
    let commands = problem.commands;
    let lengths_driven = commands.iter().any(|c| matches!(c, Command::Length { .. }));
    let tensions = if lengths_driven { commands.len() } else { 0 };
    let scales = Scales::of(problem.grid, problem.length);
    let corrected = if load == 1.0 { scratch.corrected } else { 0.0 };
    let is_corrected = corrected > 0.0;
    let Scratch { trajectory, applied, newton, trace, differentiated, .. } = scratch;
    // Where the stability of the answer is asked for, its last shot is sampled.
    let is_checked = problem.is_checked(applied, &newton.point.tensions);
    let enough = problem.tolerance.max(corrected);
    let mut effort = Effort { iterations: 0, residual: f64::INFINITY };
    let shoot = |trajectory: &mut Trajectory, point: &Point, sample| -> Result<(), Fault> {
        problem.meter.integrate(problem.grid.len());
        let Point { base_moment, follower_force, ref tensions } = *point;
        let step_tolerance = step_tolerance(problem.tolerance);
        let per_node = 0;
        let target = Target {
            tensions,
            per_node,
            base_moment,
            follower_force,
            load,
            sample,
            step_tolerance,
        };
        trajectory.shoot(problem.grid, applied, &target)?;
        if lengths_driven {
            trajectory.measure(problem.grid);
        }
        Ok(())
    };
    let mut known =
        core::mem::take(differentiated) && newton.sensitivity.lengths.is_empty() != lengths_driven;
    let mut fresh = !known;
    if shoot(trajectory, &newton.point, fresh).is_err() {
        return Err(Failed { effort });
    }
    effort.residual = residual(commands, &newton.point, trajectory, &scales);
    if !fresh && effort.residual > KEPT_RESIDUAL {
        fresh = true;
        if shoot(trajectory, &newton.point, true).is_err() {
            return Err(Failed { effort });
        }
    }
    while effort.iterations < MAX_ITERATIONS {
        if effort.residual <= enough {
            *differentiated = known;
            return Ok(effort);
        }
        if trajectory.steps_left == 0 {
            break;
        }
        if problem.meter.has_ended() {
            if load == 1.0 && scratch.open.is_none() {
                finish(problem, scratch, effort);
                scratch.open = Some(effort);
            }
            return Err(Failed { effort });
        }
        effort.iterations += 1;
        problem.meter.iterate();
        if fresh {
            known = true;
            newton.sensitivity.compute(
                problem.grid,
                applied,
                load,
                &trajectory.samples,
                &trajectory.poses,
                tensions,
            );
        }
        if !newton.solve_step(commands, trajectory, &scales) {
            return Err(Failed { effort });
        }
        let small = newton.relative_step(&scales) < KEEP_BELOW;
        let expected = effort.residual * if fresh { effort.residual } else { EXPECTED_RATIO };
        let sampled = !small || (is_checked || is_corrected) && expected <= enough;
        let mut fraction = 1.0;
        loop {
            newton.set_trial(fraction);
            if shoot(trajectory, &newton.trial, sampled).is_ok() {
                let now = residual(commands, &newton.trial, trajectory, &scales);
                if now < (1.0 - 1e-4 * fraction) * effort.residual {
                    core::mem::swap(&mut newton.point, &mut newton.trial);
                    fresh = !small;
                    if small && now > KEEP_RATIO * effort.residual && now > enough {
                        // The kept derivatives no longer serve.
                        fresh = true;
                        if !sampled && shoot(trajectory, &newton.point, true).is_err() {
                            return Err(Failed { effort });
                        }
                    }
                    effort.residual = now;
                    let tensions = &newton.point.tensions;
                    trace.iteration(effort.iterations, load, now, fraction, tensions);
                    break;
                }
                if fraction == 1.0 && effort.residual <= ROUNDING {
                    // Both are as good as rounding lets them be: stay with the better one.
                    if shoot(trajectory, &newton.point, false).is_err() {
                        return Err(Failed { effort });
                    }
                    return Ok(effort);
                }
            }
            trajectory.forget();
            if !fresh {
                fresh = true;
                if shoot(trajectory, &newton.point, true).is_err() {
                    return Err(Failed { effort });
                }
                break;
            }
            fraction *= 0.5;
            if fraction < LEAST_FRACTION {
                return Err(Failed { effort });
            }
        }
    }
    if effort.residual <= ROUNDING { Ok(effort) } else { Err(Failed { effort }) }
}

/// Copies the answer out of the last shot.
pub(super) fn finish(problem: &Problem<'_>, scratch: &mut Scratch, effort: Effort) -> Found {
    let Scratch { trajectory, applied, newton, .. } = scratch;
    trajectory.measure(problem.grid);
    (scratch.on_chain, scratch.side_by_side) = (false, false);
    scratch.sampled = trajectory.samples.len() == SAMPLED_STAGES.len() * problem.grid.len();
    scratch.poses.clone_from(&trajectory.poses);
    scratch.lengths.clone_from(&trajectory.lengths);
    scratch.tensions.clone_from(&newton.point.tensions);
    scratch.base_wrench = Wrench {
        force: applied.base_force() + newton.point.follower_force,
        moment: newton.point.base_moment,
    };
    Found::with(effort)
}

/// Copies the answer out of the closed chain.
pub(super) fn finish_chain(problem: &Problem<'_>, scratch: &mut Scratch, effort: Effort) -> Found {
    let Scratch { trajectory, applied, chain, .. } = scratch;
    trajectory.measure(problem.grid);
    chain.poses(&mut scratch.poses);
    scratch.lengths.clone_from(&trajectory.lengths);
    scratch.tensions.clone_from(&chain.state.tensions);
    let base = chain.state.nodes[0];
    scratch.base_wrench = Wrench { force: applied.base_force() + base.force, moment: base.moment };
    (scratch.on_chain, scratch.side_by_side) = (true, false);
    scratch.sampled = trajectory.samples.len() == SAMPLED_STAGES.len() * problem.grid.len();
    Found::with(effort)
}

/// Makes the samples of the answer in `scratch`, unless they are there.
pub(super) fn sample(problem: &Problem<'_>, scratch: &mut Scratch) -> Result<(), Fault> {
    if scratch.sampled {
        return Ok(());
    }
    let Scratch { trajectory, applied, chain, tensions, base_wrench, .. } = scratch;
    if scratch.side_by_side {
        chain.sample(&Task::of(problem, applied), trajectory)?;
        scratch.sampled = true;
        return Ok(());
    }
    let target = Target {
        tensions,
        per_node: 0,
        base_moment: base_wrench.moment,
        follower_force: applied.follower_share(base_wrench.force),
        load: 1.0,
        sample: true,
        step_tolerance: step_tolerance(problem.tolerance),
    };
    trajectory.shoot(problem.grid, applied, &target)?;
    scratch.sampled = true;
    Ok(())
}
