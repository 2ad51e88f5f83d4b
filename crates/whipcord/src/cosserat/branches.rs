//! All equilibria of the rod under a load that lie on the path from no load and on the branches off it.

use super::path::RodPath;
use super::prepared::{Cosserat, FOLLOW_LEVEL, MAX_REFINEMENTS, Workspace};
use super::state::State;
use super::statics;
use crate::budget::Budget;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::solution::Solution;
use crate::statics::options::{Accuracy, Options};
use crate::statics::outcome::Found;
use crate::statics::path::branches::{BranchOptions, Branches, follow};

impl Cosserat {
    /// All equilibria under the load of a case that lie on the path from no load, past its limit
    /// points, and on the branches off it. Cables keep their commands on the way.
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
        refusal::branches_among_obstacles(ModelKind::Cosserat, case)?;
        refusal::friction_with_branches(ModelKind::Cosserat, &self.robot)?;
        refusal::bending_friction_with_branches(ModelKind::Cosserat, &self.robot)?;
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
        let problem = self.problem(&grid, case, (&workspace.commands, &workspace.meter));
        let scratch = &mut workspace.scratch;
        let start = statics::start_of_path(&problem, scratch)
            .map_err(|failure| self.explain(failure, &workspace.commands))?;
        let Some(start) = start else { return Ok(Branches::only(answer)) };
        let followed = follow(&mut RodPath::new(&problem, scratch), start, case.base, options);
        followed.solutions(answer, case.loads.has_follower(), |state| {
            self.refine(level, state, case, workspace)
        })
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
