//! Following the equilibrium path by its arc length, past limit points.
//!
//! Where a robot snaps through, the load cannot be raised: the path turns back. Here the load is an
//! unknown, too. From a point on the path a step goes along the tangent, and Newton's method returns
//! to the path at right angles to it (Riks, Int. J. Solids Struct. 15 (1979) 529–551).

use whipcord_numerics::Vec3;

use super::active_set_change;
use super::chain::{Chain, Step, Task};
use super::continuation::newton;
use super::shooting::finish_chain;
use super::state::{Direction, State};
use super::statics::{Problem, Scratch};
use crate::statics::lengths::Effort;
use crate::statics::outcome::Found;
use crate::statics::scales::Scales;
use crate::statics::trace::Stage;

/// A point of the path and the way on from it.
#[derive(Clone, Debug)]
pub(super) struct PathPoint {
    pub state: State,
    /// Of length 1.
    pub tangent: Direction,
    /// The number of directions in which the equilibrium is unstable; under followers, whether it
    /// is odd.
    pub unstable: usize,
}

/// What lies between two marks.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// The load reaches a maximum or a minimum.
    Limit(PathPoint),
    /// Stability changes, and the load does not turn.
    Branching(PathPoint),
    /// Stability changes because a cable goes slack or taut.
    ActiveSetChange(PathPoint),
    /// All of the load acts.
    FullLoad(Box<PathPoint>),
}

/// Continuation along one branch.
pub(super) struct PathTracker {
    pub here: PathPoint,
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
const KINK_STEP: f64 = 1e-3;
/// Points of the path are known this well; answers are closed to what is asked for.
const TOLERANCE: f64 = 1e-9;
/// Halvings that locate a limit point or a branching point.
const HALVINGS: usize = 24;
/// How far along the null vector another branch is looked for.
const SWITCH: [f64; 3] = [0.1, 0.02, 0.3];
/// Steps after which [`next_stable`] gives up.
const MOST_STEPS: usize = 100;
/// How far beyond the given load it looks for where the path turns back to it.
const BEYOND: f64 = 1.5;

impl PathPoint {
    /// Whether a cable is slack here and pulls there.
    fn changes_cables(&self, other: &Self) -> bool {
        let tensions = self.state.tensions.iter().zip(&other.state.tensions);
        tensions.into_iter().any(|(&a, &b)| (a > 0.0) != (b > 0.0))
    }
}

impl PathTracker {
    /// From an equilibrium, in the direction that goes along with `along`.
    pub fn start(
        problem: &Problem<'_>,
        scratch: &mut Scratch,
        state: &State,
        along: &Direction,
    ) -> Option<Self> {
        scratch.trace.stage = Stage::ArcLength;
        scratch.chain.state.clone_from(state);
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        let here = path_point(problem, scratch, along)?;
        Some(Self { here, step: FIRST_STEP, iterations: 0 })
    }

    /// One step; the mark that it left, and how long it was. `None` where the path is lost.
    pub fn advance(
        &mut self,
        problem: &Problem<'_>,
        scratch: &mut Scratch,
    ) -> Option<(PathPoint, f64)> {
        let scales = Scales::of(problem.grid, problem.length);
        loop {
            if problem.meter.has_ended() {
                return None;
            }
            let taken = self.step;
            if let Some((mut next, iterations)) = step(problem, scratch, &self.here, taken) {
                self.iterations += iterations;
                active_set_change::face_on(problem, scratch, &self.here, &mut next);
                let cosine = next.tangent.dot(&self.here.tangent, problem.grid, &scales);
                let active_set_change = taken <= KINK_STEP && next.changes_cables(&self.here);
                if cosine > LEAST_COSINE || active_set_change {
                    if cosine > STRAIGHT {
                        self.step = (1.5 * taken).min(LONGEST_STEP);
                    }
                    return Some((core::mem::replace(&mut self.here, next), taken));
                }
            }
            self.step *= 0.5;
            if self.step < KINK_STEP
                && let Some((next, taken)) =
                    active_set_change::turn(problem, scratch, &self.here, KINK_STEP)
            {
                self.step = KINK_STEP;
                return Some((core::mem::replace(&mut self.here, next), taken));
            }
            if self.step < SHORTEST_STEP {
                return None;
            }
        }
    }

    /// What lies on the step that was taken from `before`, in the order of the path.
    pub fn events(
        &self,
        problem: &Problem<'_>,
        scratch: &mut Scratch,
        before: &PathPoint,
        taken: f64,
    ) -> Vec<Event> {
        let here = &self.here;
        let mut events = Vec::new();
        if before.tangent.load * here.tangent.load < 0.0 {
            let rises = before.tangent.load > 0.0;
            let turned = |path_point: &PathPoint| (path_point.tangent.load > 0.0) != rises;
            if let Some(found) = locate(problem, scratch, before, taken, turned) {
                // Where the limit lies above all of the load, that is crossed twice.
                let top = found.0.state.load - 1.0;
                let (from, to) = (before.state.load - 1.0, here.state.load - 1.0);
                if top * from < 0.0 {
                    events.extend(full_load(problem, scratch, before, &found.0));
                }
                events.push(Event::Limit(found.0.clone()));
                if top * to < 0.0 {
                    events.extend(full_load(problem, scratch, &found.0, here));
                }
            }
            return events;
        }
        if before.unstable != here.unstable {
            let changed = |path_point: &PathPoint| path_point.unstable != before.unstable;
            if let Some(found) = locate(problem, scratch, before, taken, changed) {
                events.push(if here.changes_cables(before) {
                    Event::ActiveSetChange(found.0)
                } else {
                    Event::Branching(found.0)
                });
            }
        }
        if (before.state.load - 1.0) * (here.state.load - 1.0) <= 0.0 && before.state.load != 1.0 {
            let full = full_load(problem, scratch, before, here);
            let first = match (events.first(), &full) {
                (
                    Some(Event::Branching(path_point) | Event::ActiveSetChange(path_point)),
                    Some(_),
                ) => (path_point.state.load - 1.0) * (before.state.load - 1.0) < 0.0,
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

/// The equilibrium under all of the load between two marks.
fn full_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    before: &PathPoint,
    after: &PathPoint,
) -> Option<Event> {
    let fraction = (1.0 - before.state.load) / (after.state.load - before.state.load);
    // Steps are counted along the tangent: that is where the chord between the marks falls on it.
    let nearer = if fraction <= 0.5 { before } else { after };
    let reach = (1.0 - nearer.state.load) / nearer.tangent.load;
    let mut reaches = vec![reach];
    if !reach.is_finite() || reach.abs() > 1.0 {
        reaches.clear();
    }
    reaches.push(0.0);
    for reach in reaches {
        scratch.chain.state.step_from(&nearer.state, reach, &nearer.tangent);
        scratch.chain.state.load = 1.0;
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        if newton(problem, scratch).is_ok() {
            return path_point(problem, scratch, &nearer.tangent)
                .map(|m| Event::FullLoad(Box::new(m)));
        }
    }
    None
}

/// Bisection on the length of a step from a mark: the first place at which `is_beyond` holds, and how
/// far it is.
fn locate(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &PathPoint,
    taken: f64,
    is_beyond: impl Fn(&PathPoint) -> bool,
) -> Option<(PathPoint, f64)> {
    let (mut low, mut high) = (0.0, taken);
    let mut found = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let (path_point, _) = step(problem, scratch, from, middle)?;
        if is_beyond(&path_point) {
            high = middle;
            found = Some((path_point, middle));
        } else {
            low = middle;
        }
    }
    match found {
        Some(found) => Some(found),
        None => step(problem, scratch, from, high).map(|(path_point, _)| (path_point, high)),
    }
}

/// The mark a step ahead of another, and the iterations it took.
fn step(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &PathPoint,
    length: f64,
) -> Option<(PathPoint, usize)> {
    scratch.chain.state.step_from(&from.state, length, &from.tangent);
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, trajectory, applied, trace, .. } = scratch;
    let mut task = Task::of(problem, applied);
    task.tolerance = task.tolerance.max(TOLERANCE);
    let (iterations, _) =
        Chain::newton(chain, &task, Some(&from.tangent), trajectory, trace).ok()?;
    Some((path_point(problem, scratch, &from.tangent)?, iterations))
}

/// The mark at the closed chain.
pub(super) fn path_point(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    along: &Direction,
) -> Option<PathPoint> {
    let Scratch { chain, trajectory, applied, stability, .. } = scratch;
    let task = Task::of(problem, applied);
    let scales = Scales::of(problem.grid, problem.length);
    let mut tangent = chain.direction(&task, Step::Along(along), trajectory)?;
    if !tangent.normalize(problem.grid, &scales) {
        return None;
    }
    let unstable = if applied.any_follower() {
        usize::from(chain.is_determinant_negative(&task, trajectory)?)
    } else {
        let State { tensions, load, .. } = &chain.state;
        let lengths = &trajectory.lengths;
        stability.unstable_directions(&problem.equilibrium(
            &trajectory.samples,
            tensions,
            lengths,
            applied,
            *load,
        ))
    };
    Some(PathPoint { state: chain.state.clone(), tangent, unstable })
}

/// A way on from a branching point along another branch.
pub(super) struct BranchStart {
    /// On that branch, some way from the point.
    pub state: State,
    /// The direction in which it lies.
    pub along: Direction,
    /// Whether all of the load lies on the way there,
    pub passes_full_load: bool,
    /// and the equilibrium under it, where it was found.
    pub full_load: Option<PathPoint>,
}

/// The ways on from a branching point along the other branch: both, where they are found. Near it
/// the linear step is all but along the null vector, whatever the gaps.
pub(super) fn other_branch(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
) -> Vec<BranchStart> {
    let scales = Scales::of(problem.grid, problem.length);
    // Not aligned with anything.
    let pattern: Vec<Vec3> = (0..problem.grid.len())
        .map(|k| Vec3::new(1.0 + 0.1 * k as f64, 0.3 - 0.05 * k as f64, 0.01))
        .collect();
    scratch.chain.state.clone_from(&at.state);
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, trajectory, applied, .. } = &mut *scratch;
    let task = Task::of(problem, applied);
    let Some(mut null) = chain.direction(&task, Step::Probe(&pattern), trajectory) else {
        return Vec::new();
    };
    if !null.normalize(problem.grid, &scales) {
        return Vec::new();
    }
    let along = null.dot(&at.tangent, problem.grid, &scales);
    null.add(-along, &at.tangent);
    if !null.normalize(problem.grid, &scales) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        let mut direction = null.clone();
        direction.scale(sign);
        let reached = SWITCH
            .into_iter()
            .find_map(|reach| Some((reach, aside(problem, scratch, at, &direction, reach)?)));
        let Some((reach, state)) = reached else { continue };
        let passes_full_load = (state.load - 1.0) * (at.state.load - 1.0) < 0.0;
        let full_load = passes_full_load
            .then(|| full_load_aside(problem, scratch, at, &direction, reach))
            .flatten();
        found.push(BranchStart { state, along: direction, passes_full_load, full_load });
    }
    found
}

/// The equilibrium this far from a mark along a direction, under whatever load it has there.
fn aside(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
    direction: &Direction,
    reach: f64,
) -> Option<State> {
    scratch.chain.state.step_from(&at.state, reach, direction);
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, trajectory, applied, trace, .. } = &mut *scratch;
    let task = Task::of(problem, applied);
    Chain::newton(chain, &task, Some(direction), trajectory, trace).ok()?;
    Some(scratch.chain.state.clone())
}

/// The equilibrium under all of the load on a branch that parts at a mark and passes that load within
/// this reach: by bisection, because close to the mark the branch runs all but across the load.
fn full_load_aside(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
    direction: &Direction,
    reach: f64,
) -> Option<PathPoint> {
    let (mut low, mut high) = (0.0, reach);
    let mut beyond = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let state = aside(problem, scratch, at, direction, middle);
        match state.filter(|s| (s.load - 1.0) * (at.state.load - 1.0) <= 0.0) {
            Some(state) => {
                beyond = Some(state);
                high = middle;
            }
            None => low = middle,
        }
    }
    let mut near = beyond?;
    near.load = 1.0;
    scratch.chain.state = near;
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    newton(problem, scratch).ok()?;
    path_point(problem, scratch, direction)
}

/// What lies beyond the point where the load could be raised no more.
pub(super) struct Beyond {
    /// The next stable equilibrium under all of the load.
    pub found: Option<Found>,
    /// The first unstable one on the path.
    pub unstable: Option<State>,
    /// Where on the load path stability was lost.
    pub lost_at: Option<f64>,
    pub iterations: usize,
}

/// Follows the path from a stable equilibrium to the next one under all of the load.
pub(super) fn next_stable(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &State,
    spent: usize,
) -> Beyond {
    let mut beyond = Beyond { found: None, unstable: None, lost_at: None, iterations: spent };
    let upwards = Direction::of_load(from.nodes.len(), from.tensions.len());
    let Some(mut tracker) = PathTracker::start(problem, scratch, from, &upwards) else {
        return beyond;
    };
    let mut stable: Option<State> = None;
    for _ in 0..MOST_STEPS {
        let Some((before, taken)) = tracker.advance(problem, scratch) else { break };
        for event in tracker.events(problem, scratch, &before, taken) {
            let was_stable = before.unstable == 0;
            match event {
                Event::Branching(path_point) if was_stable => {
                    beyond.lost_at.get_or_insert(path_point.state.load);
                    if stable.is_none() && !scratch.stays_on_path {
                        stable =
                            stable_off_path(problem, scratch, &path_point, &mut beyond.iterations);
                    }
                }
                Event::Limit(path_point) | Event::ActiveSetChange(path_point) if was_stable => {
                    beyond.lost_at.get_or_insert(path_point.state.load);
                }
                Event::Limit(_) | Event::Branching(_) | Event::ActiveSetChange(_) => {}
                Event::FullLoad(path_point) => {
                    if path_point.unstable == 0 {
                        stable.get_or_insert(path_point.state);
                    } else {
                        beyond.unstable.get_or_insert(path_point.state);
                    }
                }
            }
        }
        let load = tracker.here.state.load;
        if stable.is_some() || load.abs() > BEYOND {
            break;
        }
    }
    beyond.iterations += tracker.iterations;
    scratch.stable = stable.is_some();
    if let Some(state) = stable {
        scratch.chain.state = state;
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        if let Ok((taken, residual)) = newton(problem, scratch) {
            let effort = Effort { iterations: beyond.iterations + taken, residual };
            let found = finish_chain(problem, scratch, effort);
            beyond.found = Some(Found { lost_at: beyond.lost_at, ..found });
        }
    }
    beyond
}

/// The stable equilibrium under all of the load on a branch that parts at a mark: on the side that the null vector
/// points to, or else on the other.
fn stable_off_path(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &PathPoint,
    iterations: &mut usize,
) -> Option<State> {
    for way in other_branch(problem, scratch, at) {
        if let Some(path_point) = way.full_load {
            if path_point.unstable == 0 {
                return Some(path_point.state);
            }
            continue;
        }
        let Some(mut tracker) = PathTracker::start(problem, scratch, &way.state, &way.along) else {
            continue;
        };
        for _ in 0..MOST_STEPS {
            let Some((before, taken)) = tracker.advance(problem, scratch) else { break };
            for event in tracker.events(problem, scratch, &before, taken) {
                if let Event::FullLoad(path_point) = event
                    && path_point.unstable == 0
                {
                    *iterations += tracker.iterations;
                    return Some(path_point.state);
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
