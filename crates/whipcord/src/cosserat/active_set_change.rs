//! Corners of the equilibrium path, where a cable that is driven by its length goes slack or taut.
//!
//! Beyond a corner the path is another one, of the rod without that cable or with it. Which way along it
//! the path goes on the cable tells: once slack it hangs ever looser, once taut it pulls ever more. That
//! may be back to less load, as where a cable goes slack that kept the rod from buckling; then the new way
//! makes a sharp angle with the old one, and no step across the corner finds it.

use super::arc_length::{PathPoint, path_point};
use super::chain::{Chain, Task};
use super::statics::{Problem, Scratch};
use crate::statics::command::Command;

/// How far along a tangent slackness is looked at, to see whether it grows.
const LOOK: f64 = 1e-5;
/// How far a cable that gets taut is shortened to count as taut at the corner, relative to the backbone's
/// length.
const BARELY: f64 = 1e-10;

/// Turns the tangent of a mark across a corner from `before` the way the path goes on.
pub(super) fn face_on(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    before: &PathPoint,
    next: &mut PathPoint,
) {
    let changed = (0..next.state.tensions.len())
        .find(|&i| (before.state.tensions[i] > 0.0) != (next.state.tensions[i] > 0.0));
    let Some(cable) = changed else { return };
    let backwards = if next.state.tensions[cable] > 0.0 {
        next.tangent.tensions[cable] < 0.0
    } else {
        slackness_rate(problem, scratch, next, cable).is_some_and(|rate| rate < 0.0)
    };
    if backwards {
        next.tangent.scale(-1.0);
    }
}

/// The corner that lies at most `reach` ahead of a mark, with the tangent of the path beyond it, and how far
/// ahead it is.
pub(super) fn turn(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &PathPoint,
    reach: f64,
) -> Option<(PathPoint, f64)> {
    let mut nearest: Option<(usize, f64)> = None;
    for (i, command) in problem.commands.iter().enumerate() {
        let Command::Length { .. } = command else { continue };
        let (value, rate) = if from.state.tensions[i] > 0.0 {
            (from.state.tensions[i], from.tangent.tensions[i])
        } else {
            (
                slackness(problem, scratch, from, 0.0, i)?.max(0.0),
                slackness_rate(problem, scratch, from, i)?,
            )
        };
        let ahead = value / -rate;
        if rate < 0.0 && ahead <= nearest.map_or(reach, |(_, nearest)| nearest) {
            nearest = Some((i, ahead));
        }
    }
    let (cable, ahead) = nearest?;
    let slackens = from.state.tensions[cable] > 0.0;
    scratch.chain.state.step_from(&from.state, ahead, &from.tangent);
    let mut commands = problem.commands.to_vec();
    if slackens {
        // Without the cable, at the load of the corner.
        commands[cable] = Command::Tension(0.0);
        scratch.chain.state.tensions[cable] = 0.0;
    } else if let Command::Length { target, .. } = &mut commands[cable] {
        *target -= BARELY * problem.length;
    }
    let beyond = Problem { commands: &commands, ..*problem };
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, trajectory, applied, trace, .. } = &mut *scratch;
    Chain::newton(chain, &Task::of(&beyond, applied), Some(&from.tangent), trajectory, trace)
        .ok()?;
    let mut corner = path_point(&beyond, scratch, &from.tangent)?;
    let goes_on = if slackens {
        slackness_rate(problem, scratch, &corner, cable)?
    } else {
        corner.tangent.tensions[cable]
    };
    if goes_on < 0.0 {
        corner.tangent.scale(-1.0);
    }
    Some((corner, ahead))
}

/// How fast a cable gets looser along the tangent of a mark, in m.
fn slackness_rate(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
    cable: usize,
) -> Option<f64> {
    let ahead = slackness(problem, scratch, at, LOOK, cable)?;
    let behind = slackness(problem, scratch, at, -LOOK, cable)?;
    Some((ahead - behind) / (2.0 * LOOK))
}

/// Slackness of a cable in m, so far along the tangent of a mark.
fn slackness(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
    ahead: f64,
    cable: usize,
) -> Option<f64> {
    let Scratch { chain, trajectory, applied, trace, unloaded, .. } = scratch;
    chain.state.step_from(&at.state, ahead, &at.tangent);
    trajectory.seed(problem.grid, &unloaded.strains);
    // One shot of every step.
    let task = Task { tolerance: f64::MAX, ..Task::of(problem, applied) };
    Chain::newton(chain, &task, None, trajectory, trace).ok()?;
    Some(problem.commands[cable].slackness(chain.state.tensions[cable], trajectory.lengths[cable]))
}
