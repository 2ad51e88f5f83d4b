//! Corners of the equilibrium path, where a cable that is driven by its length goes slack or taut.
//!
//! Beyond a corner the path is another one, of the robot without that cable or with it. Which way along it
//! the path goes on the cable tells: once slack it hangs ever looser, once taut it pulls ever more. That
//! may be back to less load, as where a cable goes slack that kept the rod from buckling; then the new way
//! makes a sharp angle with the old one, and no step across the corner finds it.

use super::EquilibriumPath;
use super::point::{PathPoint, path_point};
use crate::statics::command::Command;

/// How far along a tangent slackness is looked at, to see whether it grows.
const LOOK: f64 = 1e-5;
/// How far a cable that gets taut is shortened to count as taut at the corner, relative to the backbone's
/// length.
const BARELY: f64 = 1e-10;

/// Turns the tangent of a point across a corner from `before` the way the path goes on.
pub(super) fn face_on<P: EquilibriumPath>(
    path: &mut P,
    before: &PathPoint<P::Part>,
    next: &mut PathPoint<P::Part>,
) {
    let changed = (0..next.state.tensions.len())
        .find(|&i| (before.state.tensions[i] > 0.0) != (next.state.tensions[i] > 0.0));
    let Some(cable) = changed else { return };
    let backwards = if next.state.tensions[cable] > 0.0 {
        next.tangent.tensions[cable] < 0.0
    } else {
        slackness_rate(path, next, cable).is_some_and(|rate| rate < 0.0)
    };
    if backwards {
        next.tangent.scale(-1.0);
    }
}

/// The corner that lies at most `reach` ahead of a point, with the tangent of the path beyond it, and how far
/// ahead it is.
pub(super) fn turn<P: EquilibriumPath>(
    path: &mut P,
    from: &PathPoint<P::Part>,
    reach: f64,
) -> Option<(PathPoint<P::Part>, f64)> {
    let commands = path.commands().to_vec();
    let mut nearest: Option<(usize, f64)> = None;
    for i in (0..commands.len()).filter(|&i| commands[i].is_length()) {
        let (value, rate) = if from.state.tensions[i] > 0.0 {
            (from.state.tensions[i], from.tangent.tensions[i])
        } else {
            (slackness(path, from, 0.0, i)?.max(0.0), slackness_rate(path, from, i)?)
        };
        let ahead = value / -rate;
        if rate < 0.0 && ahead <= nearest.map_or(reach, |(_, nearest)| nearest) {
            nearest = Some((i, ahead));
        }
    }
    let (cable, ahead) = nearest?;
    let slackens = from.state.tensions[cable] > 0.0;
    let mut state = from.state.clone();
    state.step_from(&from.state, ahead, &from.tangent);
    let mut beyond = commands.clone();
    if slackens {
        // Without the cable, at the load of the corner.
        beyond[cable] = Command::Tension(0.0);
        state.tensions[cable] = 0.0;
    } else if let Command::Length { target, .. } = &mut beyond[cable] {
        *target -= BARELY * path.scales().length;
    }
    path.set_commands(&beyond);
    path.set_state(state);
    let corner =
        path.converge(Some(&from.tangent), 0.0).and_then(|_| path_point(path, &from.tangent));
    path.set_commands(&commands);
    let mut corner = corner?;
    let goes_on = if slackens {
        slackness_rate(path, &corner, cable)?
    } else {
        corner.tangent.tensions[cable]
    };
    if goes_on < 0.0 {
        corner.tangent.scale(-1.0);
    }
    Some((corner, ahead))
}

/// How fast a cable gets looser along the tangent of a point, in m.
fn slackness_rate<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
    cable: usize,
) -> Option<f64> {
    let ahead = slackness(path, at, LOOK, cable)?;
    let behind = slackness(path, at, -LOOK, cable)?;
    Some((ahead - behind) / (2.0 * LOOK))
}

/// Slackness of a cable in m, so far along the tangent of a point.
fn slackness<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
    ahead: f64,
    cable: usize,
) -> Option<f64> {
    path.step_from(&at.state, ahead, &at.tangent);
    let length = *path.lengths()?.get(cable)?;
    Some(path.commands()[cable].slackness(path.state().tensions[cable], length))
}
