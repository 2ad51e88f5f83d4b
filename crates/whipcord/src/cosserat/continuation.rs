//! Raising the load from nothing, in steps that adapt, by multiple shooting.

use whipcord_numerics::{Missed, continuation};

use super::chain::{Chain, Task};
use super::problem::{Problem, StabilityCheck};
use super::scratch::Scratch;
use super::shooting::finish_chain;
use super::state::State;
use super::without_load::start_without_load;
use crate::section::Fault;
use crate::section::SectionFault;
use crate::statics::command::Command;
use crate::statics::continuation::{FIRST_LOAD_STEP, PATH_ENDS, SHORT_ITERATION, load_steps};
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Failure, Found, Open};
use crate::statics::strength::Strength;
use crate::statics::trace::Stage;

/// Where the load could not be raised any more, or not without losing stability.
pub(super) struct Ended {
    pub failure: Failure,
    /// The last stable equilibrium.
    pub state: Option<State>,
    pub iterations: usize,
}

/// Raises the load to all of it, from one stable equilibrium to the next.
pub(super) fn raise_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    spent: usize,
) -> Result<Found, Ended> {
    if let Err(failure) = start_without_load(problem, scratch) {
        return Err(Ended { failure, state: None, iterations: spent });
    }
    scratch.trace.stage = Stage::LoadSteps;
    let mut here = State::unloaded(&scratch.poses, &scratch.tensions);
    let first = Strength::of(&scratch.applied, problem.grid, problem.length).first_load_step();
    let mut effort = Effort { iterations: spent, residual: 1.0 };
    let raised = continuation(&load_steps(first), |load| {
        scratch.chain.state.clone_from(&here);
        scratch.chain.state.load = load;
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        let open = match newton(problem, scratch) {
            Ok((iterations, residual)) => {
                effort = Effort { iterations: effort.iterations + iterations, residual };
                if is_stable(problem, scratch) {
                    here.clone_from(&scratch.chain.state);
                    return Ok(iterations <= SHORT_ITERATION);
                }
                // A long step can miss where the stable path turns off.
                Open { iterations, gap: residual, fault: None }
            }
            Err(open) => {
                effort.iterations += open.iterations;
                open
            }
        };
        let is_last = scratch.trajectory.steps_left == 0 || problem.meter.has_ended();
        Err(Missed { reason: open, is_last })
    });
    match raised {
        Ok(()) => Ok(finish_chain(problem, scratch, effort)),
        Err(whipcord_numerics::Ended { reached: last_load, reason: Open { gap, fault, .. } }) => {
            let iterations = effort.iterations;
            let failure = match fault {
                Some(fault @ Fault { kind: SectionFault::Folded { .. }, .. }) => {
                    Failure::of_section(fault, &here.tensions, last_load)
                }
                _ => {
                    let (residual, advice) = (gap, PATH_ENDS);
                    Failure::NotConverged { iterations, residual, last_load, advice }
                }
            };
            Err(Ended { failure, state: Some(here), iterations })
        }
    }
}

/// By another way to given lengths: the load is raised at the tensions that give them without load, and
/// then the cables are led to their lengths. On the way no cable goes slack of a sudden.
pub(super) fn raise_load_at_tensions(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    spent: usize,
) -> Option<Found> {
    start_without_load(problem, scratch).ok()?;
    let held: Vec<Command> = scratch.tensions.iter().map(|&t| Command::Tension(t)).collect();
    let at_tensions = Problem { commands: &held, stability: StabilityCheck::Off, ..*problem };
    let mut effort = Effort {
        residual: 1.0,
        iterations: raise_load(&at_tensions, scratch, spent).ok()?.iterations,
    };
    let lengths = scratch.lengths.clone();
    let mut here = scratch.chain.state.clone();
    let mut commands = problem.commands.to_vec();
    let led = continuation(&load_steps(FIRST_LOAD_STEP), |part| {
        for (i, command) in commands.iter_mut().enumerate() {
            if let Command::Length { target, compliance } = problem.commands[i] {
                // Without the stretch of an elastic cable.
                let present = lengths[i] - compliance * tension_of(&held[i]);
                let target = present + part * (target - present);
                *command = Command::Length { target, compliance };
            }
        }
        let part = Problem { commands: &commands, ..*problem };
        scratch.chain.state.clone_from(&here);
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        match newton(&part, scratch) {
            Ok((iterations, residual)) => {
                effort = Effort { iterations: effort.iterations + iterations, residual };
                here.clone_from(&scratch.chain.state);
                Ok(true)
            }
            Err(open) => {
                effort.iterations += open.iterations;
                let is_last = scratch.trajectory.steps_left == 0 || problem.meter.has_ended();
                Err(Missed { reason: (), is_last })
            }
        }
    });
    (led.is_ok() && is_stable(problem, scratch)).then(|| finish_chain(problem, scratch, effort))
}

fn tension_of(command: &Command) -> f64 {
    match *command {
        Command::Tension(tension) => tension,
        Command::Length { .. } => 0.0,
    }
}

/// All of the load at once, from a chain with half as many steps.
pub(super) fn refine_chain(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    coarse: &State,
) -> Option<Found> {
    if problem.grid.len() != 2 * (coarse.nodes.len() - 1) {
        return None;
    }
    start_without_load(problem, scratch).ok()?;
    scratch.chain.state.halve(coarse, coarse.middles());
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    let (iterations, residual) = newton(problem, scratch).ok()?;
    Some(finish_chain(problem, scratch, Effort { iterations, residual }))
}

/// Closes the chain at its load.
pub(super) fn newton(problem: &Problem<'_>, scratch: &mut Scratch) -> Result<(usize, f64), Open> {
    let Scratch { chain, trajectory, applied, trace, .. } = scratch;
    Chain::newton(chain, &Task::of(problem, applied), None, trajectory, trace)
}

/// Whether the equilibrium of the closed chain is stable, as far as that is asked for and known.
pub(super) fn is_stable(problem: &Problem<'_>, scratch: &mut Scratch) -> bool {
    let Scratch { trajectory, applied, stability, chain, .. } = scratch;
    let State { tensions, load, .. } = &chain.state;
    problem.stability == StabilityCheck::Off
        || applied.any_follower()
        || problem.is_only(applied)
        || stability.is_stable(&problem.equilibrium(
            &trajectory.samples,
            tensions,
            &trajectory.lengths,
            applied,
            *load,
        ))
}
