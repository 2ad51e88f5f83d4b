//! All equilibria under a load that lie on the path from no load and on the branches off it.

use whipcord_numerics::Vec3;

use super::arc_length::{Event, PathPoint, PathTracker, other_branch};
use super::model::{Cosserat, Workspace};
use super::refinement::{FOLLOW_LEVEL, MAX_REFINEMENTS};
use super::state::{Direction, State};
use super::statics;
use crate::budget::Budget;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::shape::Solution;
use crate::statics::options::{Accuracy, Options};
use crate::statics::outcome::Found;

/// How far [`Cosserat::branches`] goes.
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

/// What [`Cosserat::branches`] found.
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
    /// Number of the branch; 0 is the path from no load, `None` for an answer of
    /// [`Cosserat::solve`] that lies on none that was followed.
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

/// A branch to be followed.
struct Start {
    state: State,
    along: Direction,
}

impl Cosserat {
    /// All equilibria under the load of a case that lie on the path from no load, past its limit
    /// points, and on the branches off it. Cables keep their commands on the way.
    ///
    /// ```
    /// use whipcord::cosserat::{BranchOptions, Cosserat, Options, Workspace};
    /// use whipcord::{Backbone, Case, Disks, Loads, Material, Robot, Section, Vec3};
    ///
    /// let backbone = Backbone {
    ///     section: Some(Section::circle(0.003)),
    ///     material: Material {
    ///         young_modulus: Some(1.1e9),
    ///         poisson_ratio: Some(0.3),
    ///         ..Default::default()
    ///     },
    ///     ..Backbone::new(0.18)
    /// };
    /// let rod = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![])?;
    /// // Half as much again as what buckles the rod.
    /// let loads = Loads { tip_force: Vec3::new(0.0, 0.0, -0.5), ..Loads::default() };
    /// let case = Case { loads, ..Case::default() };
    /// let model = Cosserat::new(&rod, &case.loads, &Options::default())?;
    /// let found = model.branches(&case, &BranchOptions::default(), &mut Workspace::default())?;
    /// let stable: Vec<_> = found.equilibria.iter().map(|e| e.stable).collect();
    /// // Straight, and bent to either side.
    /// assert_eq!(stable, [Some(false), Some(true), Some(true)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SolveError`] when there is no shape without load to start from, or when an equilibrium is
    /// lost on finer steps.
    pub fn branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        refusal::among_obstacles("branches", ModelKind::Cosserat, case)?;
        let found = self.follow_branches(case, options, workspace);
        self.options.cancel.checked(found)
    }

    fn follow_branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        // What has no shape without load, or folds, is told with its reason.
        let answer = match self.solve(case, None, workspace) {
            Err(SolveError::NotConverged { .. } | SolveError::Buckled { .. }) => None,
            other => Some(other?),
        };
        self.accept(case, workspace)?;
        // The options say how far to go.
        workspace.meter.start(&self.options.cancel, Budget::UNLIMITED);
        workspace.scratch.trajectory.steps_left = usize::MAX;
        let level = match self.options.accuracy {
            Accuracy::Steps(_) => 0,
            Accuracy::Tolerance(_) => FOLLOW_LEVEL,
        };
        let grid = self.grid(level)?;
        let mut found =
            Branches { equilibria: Vec::new(), critical_points: Vec::new(), complete: true };
        let problem = self.problem(&grid, case, (&workspace.commands, &workspace.meter));
        let scratch = &mut workspace.scratch;
        let start = statics::start_of_path(&problem, scratch)
            .map_err(|failure| self.explain(failure, &workspace.commands))?;
        let Some(state) = start else {
            found.add(answer, Some(0), None);
            return Ok(found);
        };
        let along = Direction::of_load(state.nodes.len(), state.tensions.len());
        let mut starts = vec![Start { state, along }];
        let mut path_points: Vec<(usize, PathPoint)> = Vec::new();
        // Branches that pass all of the load close to where they part.
        let mut close: Vec<usize> = Vec::new();
        let mut branch = 0;
        while branch < starts.len() && !self.options.cancel.is_cancelled() {
            let Start { state, along } = &starts[branch];
            let Some(mut tracker) = PathTracker::start(&problem, scratch, state, along) else {
                found.complete = false;
                branch += 1;
                continue;
            };
            let mut left = options.most_steps;
            while tracker.here.state.load.abs() <= options.greatest_load.max(1.0) {
                let Some((before, taken)) =
                    (left > 0).then(|| tracker.advance(&problem, scratch)).flatten()
                else {
                    found.complete = false;
                    break;
                };
                left -= 1;
                for event in tracker.events(&problem, scratch, &before, taken) {
                    let (path_point, kind) = match event {
                        Event::FullLoad(path_point) => {
                            path_points.push((branch, *path_point));
                            continue;
                        }
                        Event::Limit(path_point) => (path_point, CriticalKind::Limit),
                        Event::ActiveSetChange(path_point) => {
                            (path_point, CriticalKind::CableSlackens)
                        }
                        Event::Branching(path_point) => {
                            let room = options.most_branches.saturating_sub(starts.len());
                            let others = other_branch(&problem, scratch, &path_point);
                            found.complete &= others.len().min(2) == 2 && room >= 2;
                            let first = starts.len();
                            for way in others.into_iter().take(room) {
                                let number = starts.len();
                                found.complete &= !way.passes_full_load || way.full_load.is_some();
                                if let Some(path_point) = way.full_load {
                                    path_points.push((number, path_point));
                                    close.push(number);
                                }
                                starts.push(Start { state: way.state, along: way.along });
                            }
                            (path_point, CriticalKind::Bifurcation((first..starts.len()).collect()))
                        }
                    };
                    let tip = statics::tip_of(&problem, scratch, &path_point.state);
                    let tip = case.base.transform(tip);
                    let load = path_point.state.load;
                    found.critical_points.push(CriticalPoint { branch, load, kind, tip });
                }
            }
            branch += 1;
        }
        // In the order of the branches, where one passes all of the load before it is followed.
        path_points.sort_by_key(|&(branch, _)| branch);
        let followers = case.loads.has_follower();
        for (branch, path_point) in path_points {
            let diverges = path_point.unstable > 0;
            let unknown = (followers && diverges).then_some(false);
            let solution = self.refine(level, path_point.state, case, workspace)?;
            let is_new = found.add(Some(solution), Some(branch), unknown);
            // On finer steps the branch may part above all of the load, or the answer go to the other.
            found.complete &= is_new || !close.contains(&branch);
        }
        found.add(answer, None, None);
        Ok(found)
    }

    /// The equilibrium near a point on the grid of this level, on finer grids until it changes no
    /// more.
    fn refine(
        &self,
        level: usize,
        mut near: State,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let Options { accuracy, .. } = self.options;
        let mut coarser: Option<Found> = None;
        let (mut error, mut steps) = (f64::INFINITY, 0);
        for level in level..=MAX_REFINEMENTS {
            let grid = self.grid(level)?;
            let problem = self.problem(&grid, case, (&workspace.commands, &workspace.meter));
            let mut found = statics::converge(&problem, &mut workspace.scratch, near)
                .map_err(|failure| self.explain(failure, &workspace.commands))?;
            match (accuracy, coarser) {
                (Accuracy::Steps(_), _) => {
                    return self.solution(&grid, case, workspace, found, None);
                }
                (Accuracy::Tolerance(tolerance), Some(earlier)) => {
                    found = found.after(&earlier);
                    error = workspace.error(&grid);
                    if error <= tolerance * self.robot.backbone().length {
                        return self.solution(&grid, case, workspace, found, Some(error));
                    }
                }
                _ => {}
            }
            workspace.keep_coarse(&grid);
            steps = grid.len();
            near = workspace.scratch.chain.state.halved();
            coarser = Some(found);
        }
        let tolerance = match accuracy {
            Accuracy::Tolerance(tolerance) => tolerance * self.robot.backbone().length,
            Accuracy::Steps(_) => 0.0,
        };
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }
}

impl Branches {
    /// Adds an answer, if it is new; `stable` is what is known of one without energy.
    fn add(
        &mut self,
        solution: Option<Solution>,
        branch: Option<usize>,
        stable: Option<bool>,
    ) -> bool {
        let Some(solution) = solution else { return false };
        if self.equilibria.iter().any(|known| is_same(&known.solution, &solution)) {
            return false;
        }
        let diagnostics = &solution.diagnostics;
        let stable = diagnostics.stable.or(stable);
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
