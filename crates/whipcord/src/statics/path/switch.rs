//! The other branch at a bifurcation.

use super::arc_length::HALVINGS;
use super::point::{PathPoint, path_point};
use super::state::State;
use super::{DirectionOf, EquilibriumPath, StateOf, Step};

/// How far along the null vector another branch is looked for.
const SWITCH: [f64; 3] = [0.1, 0.02, 0.3];

/// A way on from a bifurcation along another branch.
pub(super) struct BranchStart<P: EquilibriumPath + ?Sized> {
    /// On that branch, some way from the point.
    pub state: StateOf<P>,
    /// The direction in which it lies.
    pub along: DirectionOf<P>,
    /// Whether all of the load lies on the way there,
    pub passes_full_load: bool,
    /// and the equilibrium under it, where it was found.
    pub full_load: Option<PathPoint<P::Part>>,
}

/// The ways on from a bifurcation along the other branch: both, where they are found. Near it
/// the linear step is all but along the null vector, whatever the residuals.
pub(super) fn other_branch<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
) -> Vec<BranchStart<P>> {
    let mut found = Vec::new();
    let Some(null) = null_vector(path, at) else { return found };
    for sign in [1.0, -1.0] {
        let mut direction = null.clone();
        direction.scale(sign);
        let reached =
            SWITCH.into_iter().find_map(|reach| Some((reach, aside(path, at, &direction, reach)?)));
        let Some((reach, state)) = reached else { continue };
        let passes_full_load = (state.load - 1.0) * (at.state.load - 1.0) < 0.0;
        let full_load =
            passes_full_load.then(|| full_load_aside(path, at, &direction, reach)).flatten();
        found.push(BranchStart { state, along: direction, passes_full_load, full_load });
    }
    found
}

/// The null vector at a bifurcation, without the tangent of the path.
fn null_vector<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
) -> Option<DirectionOf<P>> {
    path.set_state(at.state.clone());
    let mut null = path.direction(Step::Probe)?;
    if !path.normalize(&mut null) {
        return None;
    }
    let along = path.dot(&null, &at.tangent);
    null.add(-along, &at.tangent);
    path.normalize(&mut null).then_some(null)
}

/// The equilibrium this far from a point along a direction, under whatever load it has there.
fn aside<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
    direction: &DirectionOf<P>,
    reach: f64,
) -> Option<State<P::Part>> {
    path.step_from(&at.state, reach, direction);
    path.converge(Some(direction), 0.0)?;
    Some(path.state())
}

/// The equilibrium under all of the load on a branch that parts at a point and passes that load within
/// this reach: by bisection, because close to the point the branch runs all but across the load.
fn full_load_aside<P: EquilibriumPath>(
    path: &mut P,
    at: &PathPoint<P::Part>,
    direction: &DirectionOf<P>,
    reach: f64,
) -> Option<PathPoint<P::Part>> {
    let (mut low, mut high) = (0.0, reach);
    let mut beyond = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let state = aside(path, at, direction, middle);
        match state.filter(|s| (s.load - 1.0) * (at.state.load - 1.0) <= 0.0) {
            Some(state) => {
                beyond = Some(state);
                high = middle;
            }
            None => low = middle,
        }
    }
    path.set_state(State { load: 1.0, ..beyond? });
    path.converge(None, 0.0)?;
    path_point(path, direction)
}
