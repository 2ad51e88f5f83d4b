//! Following the equilibrium path by its arc length, past limit points.
//!
//! Where a robot snaps through, the load cannot be raised: the path turns back. Here the load is an
//! unknown, too. From a point on the path a step goes along the tangent, and Newton's method returns
//! to the path at right angles to it (Riks, Int. J. Solids Struct. 15 (1979) 529–551).

use whipcord_numerics::Vec3;

use super::chain::{Chain, Step, Task};
use super::continuation::close;
use super::kink;
use super::newton::Scales;
use super::shooting::finish_chain;
use super::state::{Direction, State};
use super::statics::{Problem, Scratch};
use crate::statics::lengths::Effort;
use crate::statics::outcome::Found;
use crate::statics::trace::Stage;

/// A point of the path and the way on from it.
#[derive(Clone, Debug)]
pub(super) struct Mark {
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
    Limit(Mark),
    /// Stability changes, and the load does not turn.
    Branching(Mark),
    /// Stability changes because a cable goes slack or taut.
    Kink(Mark),
    /// All of the load acts.
    FullLoad(Box<Mark>),
}

/// The walk along one branch.
pub(super) struct Walk {
    pub here: Mark,
    step: f64,
    pub iterations: usize,
}

const FIRST_STEP: f64 = 0.05;
const LONGEST_STEP: f64 = 1.0;
const SHORTEST_STEP: f64 = 1e-6;
/// Least cosine of the angle between two tangents, and that from which on steps get longer.
const LEAST_COSINE: f64 = 0.9;
const STRAIGHT: f64 = 0.98;
/// A step this short may cross a kink of the path, where a cable goes slack or taut.
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

impl Mark {
    /// Whether a cable is slack here and pulls there.
    fn changes_cables(&self, other: &Self) -> bool {
        let tensions = self.state.tensions.iter().zip(&other.state.tensions);
        tensions.into_iter().any(|(&a, &b)| (a > 0.0) != (b > 0.0))
    }
}

impl Walk {
    /// From an equilibrium, in the direction that goes along with `along`.
    pub fn start(
        problem: &Problem<'_>,
        scratch: &mut Scratch,
        state: &State,
        along: &Direction,
    ) -> Option<Self> {
        scratch.trace.stage = Stage::ArcLength;
        scratch.chain.state.clone_from(state);
        scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
        let here = mark(problem, scratch, along)?;
        Some(Self { here, step: FIRST_STEP, iterations: 0 })
    }

    /// One step; the mark that it left, and how long it was. `None` where the path is lost.
    pub fn advance(&mut self, problem: &Problem<'_>, scratch: &mut Scratch) -> Option<(Mark, f64)> {
        let scales = Scales::of(problem.grid, problem.length);
        loop {
            if problem.cancel.is_cancelled() {
                return None;
            }
            let taken = self.step;
            if let Some((mut next, iterations)) = step(problem, scratch, &self.here, taken) {
                self.iterations += iterations;
                kink::face_on(problem, scratch, &self.here, &mut next);
                let cosine = next.tangent.dot(&self.here.tangent, problem.grid, &scales);
                let kink = taken <= KINK_STEP && next.changes_cables(&self.here);
                if cosine > LEAST_COSINE || kink {
                    if cosine > STRAIGHT {
                        self.step = (1.5 * taken).min(LONGEST_STEP);
                    }
                    return Some((core::mem::replace(&mut self.here, next), taken));
                }
            }
            self.step *= 0.5;
            if self.step < KINK_STEP
                && let Some((next, taken)) = kink::turn(problem, scratch, &self.here, KINK_STEP)
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
        before: &Mark,
        taken: f64,
    ) -> Vec<Event> {
        let here = &self.here;
        let mut events = Vec::new();
        if before.tangent.load * here.tangent.load < 0.0 {
            let rises = before.tangent.load > 0.0;
            let turned = |mark: &Mark| (mark.tangent.load > 0.0) != rises;
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
            let changed = |mark: &Mark| mark.unstable != before.unstable;
            if let Some(found) = locate(problem, scratch, before, taken, changed) {
                events.push(if here.changes_cables(before) {
                    Event::Kink(found.0)
                } else {
                    Event::Branching(found.0)
                });
            }
        }
        if (before.state.load - 1.0) * (here.state.load - 1.0) <= 0.0 && before.state.load != 1.0 {
            let full = full_load(problem, scratch, before, here);
            let first = match (events.first(), &full) {
                (Some(Event::Branching(mark) | Event::Kink(mark)), Some(_)) => {
                    (mark.state.load - 1.0) * (before.state.load - 1.0) < 0.0
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

/// The equilibrium under all of the load between two marks.
fn full_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    before: &Mark,
    after: &Mark,
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
        scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
        if close(problem, scratch).is_ok() {
            return mark(problem, scratch, &nearer.tangent).map(|m| Event::FullLoad(Box::new(m)));
        }
    }
    None
}

/// Bisection on the length of a step from a mark: the first place at which `is_beyond` holds, and how
/// far it is.
fn locate(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &Mark,
    taken: f64,
    is_beyond: impl Fn(&Mark) -> bool,
) -> Option<(Mark, f64)> {
    let (mut low, mut high) = (0.0, taken);
    let mut found = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let (mark, _) = step(problem, scratch, from, middle)?;
        if is_beyond(&mark) {
            high = middle;
            found = Some((mark, middle));
        } else {
            low = middle;
        }
    }
    match found {
        Some(found) => Some(found),
        None => step(problem, scratch, from, high).map(|(mark, _)| (mark, high)),
    }
}

/// The mark a step ahead of another, and the iterations it took.
fn step(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    from: &Mark,
    length: f64,
) -> Option<(Mark, usize)> {
    scratch.chain.state.step_from(&from.state, length, &from.tangent);
    scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, shot, applied, trace, .. } = scratch;
    let mut task = Task::of(problem, applied);
    task.tolerance = task.tolerance.max(TOLERANCE);
    let (iterations, _) = Chain::close(chain, &task, Some(&from.tangent), shot, trace).ok()?;
    Some((mark(problem, scratch, &from.tangent)?, iterations))
}

/// The mark at the closed chain.
pub(super) fn mark(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    along: &Direction,
) -> Option<Mark> {
    let Scratch { chain, shot, applied, stability, .. } = scratch;
    let task = Task::of(problem, applied);
    let scales = Scales::of(problem.grid, problem.length);
    let mut tangent = chain.direction(&task, Step::Along(along), shot)?;
    if !tangent.normalize(problem.grid, &scales) {
        return None;
    }
    let unstable = if applied.any_follower() {
        usize::from(chain.is_determinant_negative(&task, shot)?)
    } else {
        let State { tensions, load, .. } = &chain.state;
        let lengths = &shot.lengths;
        stability.unstable_directions(&problem.equilibrium(
            &shot.samples,
            tensions,
            lengths,
            applied,
            *load,
        ))
    };
    Some(Mark { state: chain.state.clone(), tangent, unstable })
}

/// A way on from a branching point along another branch.
pub(super) struct Way {
    /// On that branch, some way from the point.
    pub state: State,
    /// The direction in which it lies.
    pub along: Direction,
    /// Whether all of the load lies on the way there,
    pub passes_full_load: bool,
    /// and the equilibrium under it, where it was found.
    pub full_load: Option<Mark>,
}

/// The ways on from a branching point along the other branch: both, where they are found. Near it
/// the linear step is all but along the null vector, whatever the gaps.
pub(super) fn other_branch(problem: &Problem<'_>, scratch: &mut Scratch, at: &Mark) -> Vec<Way> {
    let scales = Scales::of(problem.grid, problem.length);
    // Not aligned with anything.
    let pattern: Vec<Vec3> = (0..problem.grid.len())
        .map(|k| Vec3::new(1.0 + 0.1 * k as f64, 0.3 - 0.05 * k as f64, 0.01))
        .collect();
    scratch.chain.state.clone_from(&at.state);
    scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, shot, applied, .. } = &mut *scratch;
    let task = Task::of(problem, applied);
    let Some(mut null) = chain.direction(&task, Step::Probe(&pattern), shot) else {
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
        found.push(Way { state, along: direction, passes_full_load, full_load });
    }
    found
}

/// The equilibrium this far from a mark along a direction, under whatever load it has there.
fn aside(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &Mark,
    direction: &Direction,
    reach: f64,
) -> Option<State> {
    scratch.chain.state.step_from(&at.state, reach, direction);
    scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
    let Scratch { chain, shot, applied, trace, .. } = &mut *scratch;
    let task = Task::of(problem, applied);
    Chain::close(chain, &task, Some(direction), shot, trace).ok()?;
    Some(scratch.chain.state.clone())
}

/// The equilibrium under all of the load on a branch that parts at a mark and passes that load within
/// this reach: by bisection, because close to the mark the branch runs all but across the load.
fn full_load_aside(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    at: &Mark,
    direction: &Direction,
    reach: f64,
) -> Option<Mark> {
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
    scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
    close(problem, scratch).ok()?;
    mark(problem, scratch, direction)
}

/// What lies beyond the point where the load could be raised no more.
pub(super) struct Beyond {
    /// The next equilibrium under all of the load that the robot stays in.
    pub found: Option<Found>,
    /// The first one on the path that it does not stay in.
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
    let Some(mut walk) = Walk::start(problem, scratch, from, &upwards) else { return beyond };
    let mut stable: Option<State> = None;
    for _ in 0..MOST_STEPS {
        let Some((before, taken)) = walk.advance(problem, scratch) else { break };
        for event in walk.events(problem, scratch, &before, taken) {
            let was_stable = before.unstable == 0;
            match event {
                Event::Branching(mark) if was_stable => {
                    beyond.lost_at.get_or_insert(mark.state.load);
                    if stable.is_none() && !scratch.stays_on_path {
                        stable = stable_off_path(problem, scratch, &mark, &mut beyond.iterations);
                    }
                }
                Event::Limit(mark) | Event::Kink(mark) if was_stable => {
                    beyond.lost_at.get_or_insert(mark.state.load);
                }
                Event::Limit(_) | Event::Branching(_) | Event::Kink(_) => {}
                Event::FullLoad(mark) => {
                    if mark.unstable == 0 {
                        stable.get_or_insert(mark.state);
                    } else {
                        beyond.unstable.get_or_insert(mark.state);
                    }
                }
            }
        }
        let load = walk.here.state.load;
        if stable.is_some() || load.abs() > BEYOND {
            break;
        }
    }
    beyond.iterations += walk.iterations;
    scratch.stable = stable.is_some();
    if let Some(state) = stable {
        scratch.chain.state = state;
        scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
        if let Ok((taken, residual)) = close(problem, scratch) {
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
    at: &Mark,
    iterations: &mut usize,
) -> Option<State> {
    for way in other_branch(problem, scratch, at) {
        if let Some(mark) = way.full_load {
            if mark.unstable == 0 {
                return Some(mark.state);
            }
            continue;
        }
        let Some(mut walk) = Walk::start(problem, scratch, &way.state, &way.along) else {
            continue;
        };
        for _ in 0..MOST_STEPS {
            let Some((before, taken)) = walk.advance(problem, scratch) else { break };
            for event in walk.events(problem, scratch, &before, taken) {
                if let Event::FullLoad(mark) = event
                    && mark.unstable == 0
                {
                    *iterations += walk.iterations;
                    return Some(mark.state);
                }
            }
            if walk.here.state.load.abs() > BEYOND {
                break;
            }
        }
        *iterations += walk.iterations;
    }
    None
}
