//! All equilibria under a load that lie on the path from no load and on the branches off it.

use whipcord_numerics::{Pose, Vec3};

use super::arc_length::{Event, PathPoint, PathTracker};
use super::state::{Part, State};
use super::switch::{BranchStart, other_branch};
use super::{DirectionOf, EquilibriumPath, StateOf};
use crate::error::SolveError;
use crate::solution::Solution;

/// How far [`Prepared::branches`](crate::Prepared::branches) goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchOptions {
    /// Each branch is followed as long as the load is at most so many times the given one, in either
    /// direction; at least 1.
    pub greatest_load: f64,
    /// Steps along each branch.
    pub most_steps: usize,
    /// Branches that are followed, the path from no load included.
    pub most_branches: usize,
}

impl Default for BranchOptions {
    fn default() -> Self {
        Self { greatest_load: 1.5, most_steps: 200, most_branches: 9 }
    }
}

/// What [`Prepared::branches`](crate::Prepared::branches) found.
#[derive(Clone, Debug, PartialEq)]
pub struct Branches {
    /// The equilibria under all of the load, branch by branch and along each.
    pub equilibria: Vec<Equilibrium>,
    /// Where the load turns back and where branches part, in the same order.
    pub critical_points: Vec<CriticalPoint>,
    /// Whether every branch was followed to the greatest load. Otherwise there may be more equilibria
    /// on what was not followed.
    pub complete: bool,
}

/// An equilibrium under all of the load.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Number of the branch; 0 is the path from no load, `None` for the answer of
    /// [`Prepared::solve`](crate::Prepared::solve) where it lies on none that was followed.
    pub branch: Option<usize>,
    /// The shape.
    pub solution: Solution,
    /// Whether it is stable. Under loads that follow the backbone there is no energy to
    /// tell: `Some(false)` where it diverges, as the sign of a determinant says, else `None`.
    pub stable: Option<bool>,
}

/// A point of the path at which stability changes.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalPoint {
    /// Number of the branch it lies on.
    pub branch: usize,
    /// Fraction of the given load.
    pub load: f64,
    /// What happens there.
    pub kind: CriticalKind,
    /// Where the tip is in m, in the frame that shapes are in.
    pub tip: Vec3,
}

/// What happens at a critical point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CriticalKind {
    /// The load turns back: the robot snaps through.
    Limit,
    /// A cable that is driven by its length goes slack or taut, and with that stability changes.
    CableSlackens,
    /// Other branches part here, as at the buckling load of a straight column: their numbers, without
    /// those that were not followed. Where several directions buckle at one load, as those around a
    /// round rod, one of them is followed, to both sides.
    Bifurcation(Vec<usize>),
}

/// The points of the paths that were followed, before they become solutions.
pub(crate) struct Followed<N: Part> {
    /// Under all of the load, with the number of the branch.
    full_load: Vec<(usize, PathPoint<N>)>,
    critical_points: Vec<CriticalPoint>,
    complete: bool,
    /// Branches that pass all of the load close to where they part.
    close: Vec<usize>,
}

/// A branch to be followed.
struct Start<P: EquilibriumPath> {
    state: StateOf<P>,
    along: DirectionOf<P>,
}

/// Follows the path from an equilibrium without load, and all branches off it; `base` is the pose of the base.
pub(crate) fn follow<P: EquilibriumPath>(
    path: &mut P,
    from: StateOf<P>,
    base: Pose,
    options: &BranchOptions,
) -> Followed<P::Part> {
    let along = from.along_load();
    let mut starts = vec![Start::<P> { state: from, along }];
    let mut found = Followed {
        full_load: Vec::new(),
        critical_points: Vec::new(),
        complete: true,
        close: Vec::new(),
    };
    let mut branch = 0;
    while branch < starts.len() && !path.has_ended() {
        let Start { state, along } = &starts[branch];
        let Some(mut tracker) = PathTracker::start(path, state, along) else {
            found.complete = false;
            branch += 1;
            continue;
        };
        let mut left = options.most_steps;
        while tracker.here.state.load.abs() <= options.greatest_load.max(1.0) {
            let Some((before, taken)) = (left > 0).then(|| tracker.advance(path)).flatten() else {
                found.complete = false;
                break;
            };
            left -= 1;
            for event in tracker.events(path, &before, taken) {
                let (point, kind) = match event {
                    Event::FullLoad(point) => {
                        found.full_load.push((branch, *point));
                        continue;
                    }
                    Event::Limit(point) => (point, CriticalKind::Limit),
                    Event::ActiveSetChange(point) => (point, CriticalKind::CableSlackens),
                    Event::Branching(point) => {
                        let first = starts.len();
                        let room = options.most_branches.saturating_sub(first);
                        let others = other_branch(path, &point);
                        found.complete &= others.len().min(2) == 2 && room >= 2;
                        for way in others.into_iter().take(room) {
                            let start = found.part(starts.len(), way);
                            starts.push(start);
                        }
                        (point, CriticalKind::Bifurcation((first..starts.len()).collect()))
                    }
                };
                let load = point.state.load;
                path.set_state(point.state);
                let tip = base.transform(path.tip());
                found.critical_points.push(CriticalPoint { branch, load, kind, tip });
            }
        }
        branch += 1;
    }
    // In the order of the branches, where one passes all of the load before it is followed.
    found.full_load.sort_by_key(|&(branch, _)| branch);
    found
}

impl<N: Part> Followed<N> {
    /// Takes note of a branch that parts, to be followed under this number.
    fn part<P: EquilibriumPath<Part = N>>(
        &mut self,
        number: usize,
        way: BranchStart<P>,
    ) -> Start<P> {
        let BranchStart { state, along, passes_full_load, full_load } = way;
        self.complete &= !passes_full_load || full_load.is_some();
        if let Some(point) = full_load {
            self.full_load.push((number, point));
            self.close.push(number);
        }
        Start { state, along }
    }

    /// The branches with their solutions, as `refine` makes them of states under all of the load, and the answer of a solve.
    pub fn solutions(
        self,
        answer: Option<Solution>,
        has_followers: bool,
        mut refine: impl FnMut(State<N>) -> Result<Solution, SolveError>,
    ) -> Result<Branches, SolveError> {
        let Self { full_load, critical_points, complete, close } = self;
        let mut found = Branches { equilibria: Vec::new(), critical_points, complete };
        for (branch, point) in full_load {
            let diverges = has_followers && point.unstable > 0;
            let is_new = found.add(refine(point.state)?, Some(branch), diverges.then_some(false));
            // On finer steps the branch may part above all of the load, or the answer go to the other.
            found.complete &= is_new || !close.contains(&branch);
        }
        if let Some(answer) = answer {
            found.add(answer, None, None);
        }
        Ok(found)
    }
}

impl Branches {
    /// Of a case without load: the only equilibrium that the path has.
    pub(crate) fn only(answer: Option<Solution>) -> Self {
        let mut found =
            Self { equilibria: Vec::new(), critical_points: Vec::new(), complete: true };
        if let Some(answer) = answer {
            found.add(answer, Some(0), None);
        }
        found
    }

    /// Adds an answer, if it is new; `stable` is what is known of one without energy.
    fn add(&mut self, solution: Solution, branch: Option<usize>, stable: Option<bool>) -> bool {
        if self.equilibria.iter().any(|known| is_same(&known.solution, &solution)) {
            return false;
        }
        let stable = solution.diagnostics.stable.or(stable);
        self.equilibria.push(Equilibrium { branch, solution, stable });
        true
    }
}

/// Whether two answers are one: a branch may be met from both of its ends.
fn is_same(a: &Solution, b: &Solution) -> bool {
    const CLOSE: f64 = 1e-5;
    let length = b.disks.arc_length.last().copied().unwrap_or(1.0);
    a.disks.distances(&b.disks).all(|d| d <= CLOSE * length)
}
