//! Steps along an equilibrium path by its arc length, and what lies between them.

use super::corner;
pub(crate) use super::point::PathPoint;
use super::point::path_point;
use super::state::{Part, State};
use super::{DirectionOf, EquilibriumPath, StateOf};

/// What lies between two points.
#[derive(Clone, Debug)]
pub(crate) enum Event<N: Part> {
    /// The load reaches a maximum or a minimum.
    Limit(PathPoint<N>),
    /// Stability changes, and the load does not turn.
    Branching(PathPoint<N>),
    /// Stability changes because a cable goes slack or taut.
    ActiveSetChange(PathPoint<N>),
    /// All of the load acts.
    FullLoad(Box<PathPoint<N>>),
}

/// Continuation along one branch.
pub(crate) struct PathTracker<N: Part> {
    pub here: PathPoint<N>,
    step: f64,
    pub iterations: usize,
}

const FIRST_STEP: f64 = 0.05;
const LONGEST_STEP: f64 = 1.0;
const SHORTEST_STEP: f64 = 1e-6;
/// Least cosine of the angle between two tangents, and that from which on steps get longer.
const LEAST_COSINE: f64 = 0.9;
const STRAIGHT: f64 = 0.98;
/// A step this short may cross a corner of the path, where a cable goes slack or taut.
const CORNER_STEP: f64 = 1e-3;
/// A step that is longer and behind which stability has changed, though the load goes on alike, may have left the path beside an imperfect
/// bifurcation, where it turns away within less than the step.
const STABILITY_STEP: f64 = 4e-3;
/// Points of the path are known this well; answers are closed to what is asked for.
const RESIDUAL: f64 = 1e-9;
/// Halvings that locate a limit point or a bifurcation.
pub(super) const HALVINGS: usize = 24;

impl<N: Part> PathTracker<N> {
    /// From an equilibrium, in the direction that goes along with `along`.
    pub fn start<P: EquilibriumPath<Part = N>>(
        path: &mut P,
        state: &StateOf<P>,
        along: &DirectionOf<P>,
    ) -> Option<Self> {
        path.set_state(state.clone());
        let here = path_point(path, along)?;
        Some(Self { here, step: FIRST_STEP, iterations: 0 })
    }

    /// One step; the point that it left, and how long it was. `None` where the path is lost. Failed steps are halved
    /// down to [`SHORTEST_STEP`].
    pub fn advance<P: EquilibriumPath<Part = N>>(
        &mut self,
        path: &mut P,
    ) -> Option<(PathPoint<N>, f64)> {
        loop {
            if path.has_ended() {
                return None;
            }
            let taken = self.step;
            if let Some((mut next, iterations)) = step(path, &self.here, taken)
                && !next.is_before_corner()
            {
                self.iterations += iterations;
                corner::face_on(path, &self.here, &mut next);
                let cosine = path.dot(&next.tangent, &self.here.tangent);
                let changes_cables = next.changes_cables(&self.here);
                let active_set_change = taken <= CORNER_STEP && changes_cables;
                let is_beside =
                    taken > STABILITY_STEP && !changes_cables && next.changes_stability(&self.here);
                if (cosine > LEAST_COSINE && !is_beside) || active_set_change {
                    if cosine > STRAIGHT {
                        self.step = (1.5 * taken).min(LONGEST_STEP);
                    }
                    return Some((core::mem::replace(&mut self.here, next), taken));
                }
            }
            self.step *= 0.5;
            if self.step < CORNER_STEP
                && let Some((next, taken)) = corner::turn(path, &self.here, CORNER_STEP)
            {
                self.step = CORNER_STEP;
                return Some((core::mem::replace(&mut self.here, next), taken));
            }
            if self.step < SHORTEST_STEP {
                return None;
            }
        }
    }

    /// What lies on the step that was taken from `before`, in the order of the path.
    pub fn events<P: EquilibriumPath<Part = N>>(
        &self,
        path: &mut P,
        before: &PathPoint<N>,
        taken: f64,
    ) -> Vec<Event<N>> {
        let here = &self.here;
        let mut events = Vec::new();
        if before.tangent.load * here.tangent.load < 0.0 {
            let rises = before.tangent.load > 0.0;
            let turned = |point: &PathPoint<N>| (point.tangent.load > 0.0) != rises;
            if let Some(found) = locate(path, before, taken, turned) {
                // Where the limit lies above all of the load, that is crossed twice.
                let top = found.state.load - 1.0;
                let (from, to) = (before.state.load - 1.0, here.state.load - 1.0);
                if top * from < 0.0 {
                    events.extend(full_load(path, before, &found));
                }
                events.push(Event::Limit(found.clone()));
                if top * to < 0.0 {
                    events.extend(full_load(path, &found, here));
                }
            }
            return events;
        }
        if before.unstable != here.unstable {
            let changed = |point: &PathPoint<N>| point.unstable != before.unstable;
            if let Some(found) = locate(path, before, taken, changed) {
                events.push(if here.changes_cables(before) {
                    Event::ActiveSetChange(found)
                } else {
                    Event::Branching(found)
                });
            }
        }
        if (before.state.load - 1.0) * (here.state.load - 1.0) <= 0.0 && before.state.load != 1.0 {
            let full = full_load(path, before, here);
            let first = match (events.first(), &full) {
                (Some(Event::Branching(point) | Event::ActiveSetChange(point)), Some(_)) => {
                    (point.state.load - 1.0) * (before.state.load - 1.0) < 0.0
                }
                _ => false,
            };
            let place = if first { 0 } else { events.len() };
            if let Some(full) = full {
                events.insert(place, full);
            }
        }
        events
    }
}

/// The equilibrium under all of the load between two points.
fn full_load<P: EquilibriumPath>(
    path: &mut P,
    before: &PathPoint<P::Part>,
    after: &PathPoint<P::Part>,
) -> Option<Event<P::Part>> {
    let fraction = (1.0 - before.state.load) / (after.state.load - before.state.load);
    // Steps are counted along the tangent: that is where the chord between the points falls on it.
    let nearer = if fraction <= 0.5 { before } else { after };
    let reach = (1.0 - nearer.state.load) / nearer.tangent.load;
    let mut reaches = vec![reach];
    if !reach.is_finite() || reach.abs() > 1.0 {
        reaches.clear();
    }
    reaches.push(0.0);
    for reach in reaches {
        let mut state = nearer.state.clone();
        state.step_from(&nearer.state, reach, &nearer.tangent);
        path.set_state(State { load: 1.0, ..state });
        if path.converge(None, 0.0).is_some() {
            return path_point(path, &nearer.tangent).map(|p| Event::FullLoad(Box::new(p)));
        }
    }
    None
}

/// Bisection on the length of a step from a point: the first place at which `is_beyond` holds.
fn locate<P: EquilibriumPath>(
    path: &mut P,
    from: &PathPoint<P::Part>,
    taken: f64,
    is_beyond: impl Fn(&PathPoint<P::Part>) -> bool,
) -> Option<PathPoint<P::Part>> {
    let (mut low, mut high) = (0.0, taken);
    let mut found = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let (point, _) = step(path, from, middle)?;
        if is_beyond(&point) {
            high = middle;
            found = Some(point);
        } else {
            low = middle;
        }
    }
    found.or_else(|| step(path, from, high).map(|(point, _)| point))
}

/// The point a step ahead of another, and the iterations it took.
fn step<P: EquilibriumPath>(
    path: &mut P,
    from: &PathPoint<P::Part>,
    length: f64,
) -> Option<(PathPoint<P::Part>, usize)> {
    path.step_from(&from.state, length, &from.tangent);
    let iterations = path.converge(Some(&from.tangent), RESIDUAL)?;
    Some((path_point(path, &from.tangent)?, iterations))
}
