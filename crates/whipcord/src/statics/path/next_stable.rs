//! The next stable equilibrium past the point where the load could be raised no more.

use super::arc_length::{Event, PathPoint, PathTracker};
use super::state::State;
use super::switch::other_branch;
use super::{EquilibriumPath, StateOf};

/// Steps after which the search gives up.
const MOST_STEPS: usize = 100;
/// How far beyond the given load it looks for where the path turns back to it.
const BEYOND: f64 = 1.5;

/// What lies beyond the point where the load could be raised no more.
pub(crate) struct Beyond<N> {
    /// The next stable equilibrium under all of the load.
    pub stable: Option<State<N>>,
    /// The first unstable one on the path.
    pub unstable: Option<State<N>>,
    /// Where on the load path stability was lost.
    pub lost_at: Option<f64>,
    pub iterations: usize,
}

/// Follows the path from a stable equilibrium to the next one under all of the load, off the path where it bifurcates unless
/// branches are left alone.
pub(crate) fn next_stable<P: EquilibriumPath>(
    path: &mut P,
    from: &StateOf<P>,
    stays_on_path: bool,
    spent: usize,
) -> Beyond<P::Part> {
    let mut beyond = Beyond { stable: None, unstable: None, lost_at: None, iterations: spent };
    let Some(mut tracker) = PathTracker::start(path, from, &from.along_load()) else {
        return beyond;
    };
    for _ in 0..MOST_STEPS {
        let Some((before, taken)) = tracker.advance(path) else { break };
        for event in tracker.events(path, &before, taken) {
            let was_stable = before.unstable == 0;
            match event {
                Event::Branching(point) if was_stable => {
                    beyond.lost_at.get_or_insert(point.state.load);
                    if beyond.stable.is_none() && !stays_on_path {
                        beyond.stable = stable_off_path(path, &point, &mut beyond.iterations);
                    }
                }
                Event::Limit(point) | Event::ActiveSetChange(point) if was_stable => {
                    beyond.lost_at.get_or_insert(point.state.load);
                }
                Event::Limit(_) | Event::Branching(_) | Event::ActiveSetChange(_) => {}
                Event::FullLoad(point) if point.unstable == 0 => {
                    beyond.stable.get_or_insert(point.state);
                }
                Event::FullLoad(point) => {
                    beyond.unstable.get_or_insert(point.state);
                }
            }
        }
        let load = tracker.here.state.load;
        if beyond.stable.is_some() || load.abs() > BEYOND {
            break;
        }
    }
    beyond.iterations += tracker.iterations;
    beyond
}

/// The stable equilibrium under all of the load on a branch that parts at a point: on the side that the null vector
/// points to, or else on the other.
fn stable_off_path<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
    iterations: &mut usize,
) -> Option<StateOf<P>> {
    for way in other_branch(path, at) {
        if let Some(point) = way.full_load {
            if point.unstable == 0 {
                return Some(point.state);
            }
            continue;
        }
        let Some(mut tracker) = PathTracker::start(path, &way.state, &way.along) else {
            continue;
        };
        for _ in 0..MOST_STEPS {
            let Some((before, taken)) = tracker.advance(path) else { break };
            for event in tracker.events(path, &before, taken) {
                if let Event::FullLoad(point) = event
                    && point.unstable == 0
                {
                    *iterations += tracker.iterations;
                    return Some(point.state);
                }
            }
            if tracker.here.state.load.abs() > BEYOND {
                break;
            }
        }
        *iterations += tracker.iterations;
    }
    None
}
