//! All equilibria of the robot under a load that lie on the path from no load and on the branches off it.

use super::levels::{MAX_REFINEMENTS, STABILITY_LEVEL};
use super::model::CosseratDisks;
use super::node::State;
use super::path::ChainPath;
use super::statics;
use super::workspace::Workspace;
use crate::budget::Budget;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::solution::Solution;
use crate::statics::options::Accuracy;
use crate::statics::outcome::{Failure, Found};
use crate::statics::path::EquilibriumPath as _;
use crate::statics::path::branches::{BranchOptions, Branches, follow};
use crate::statics::refinement::ERROR_RATIO;

impl CosseratDisks {
    /// All equilibria under the load of a case that lie on the path from no load, past its limit
    /// points, and on the branches off it. Cables keep their commands on the way.
    ///
    /// # Errors
    /// [`SolveError`] when there is no shape without load to start from, or when an equilibrium is
    /// lost on finer steps; [`SolveError::Unsupported`] among obstacles, and with hole friction.
    pub fn branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        refusal::branches_among_obstacles(ModelKind::CosseratDisks, case)?;
        refusal::friction_with_branches(ModelKind::CosseratDisks, self.robot())?;
        refusal::bending_friction_with_branches(ModelKind::CosseratDisks, self.robot())?;
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
        let level = match self.options().accuracy {
            Accuracy::Steps(_) => 0,
            Accuracy::Tolerance(_) => {
                self.first_level(core::slice::from_ref(case), workspace).max(STABILITY_LEVEL)
            }
        };
        let mesh = self.mesh(level)?;
        self.accept(case, &mesh, workspace)?;
        // The options say how far to go.
        workspace.meter.start(&self.options.cancel, Budget::UNLIMITED);
        let Workspace { scratch, commands, meter, .. } = workspace;
        let problem = self.problem(&mesh, (commands, meter), case)?;
        let start = statics::start_of_path(&problem, scratch)
            .map_err(|failure| self.explain(failure, commands))?;
        let Some(start) = start else { return Ok(Branches::only(answer)) };
        let followed = follow(&mut ChainPath::new(&problem, scratch), start, case.base, options);
        followed.solutions(answer, case.loads.has_follower(), |state| {
            self.refine(level, state, case, workspace)
        })
    }

    /// The equilibrium near a point on the mesh of this level, on finer meshes until it changes no
    /// more.
    fn refine(
        &self,
        level: usize,
        mut near: State,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let backbone = self.robot().backbone().length;
        let tolerance = match self.options().accuracy {
            Accuracy::Tolerance(tolerance) => tolerance * backbone,
            Accuracy::Steps(_) => f64::INFINITY,
        };
        let mut coarser: Option<Found> = None;
        let (mut error, mut steps) = (f64::INFINITY, 0);
        for level in level..=MAX_REFINEMENTS {
            let mesh = self.mesh(level)?;
            self.accept(case, &mesh, workspace)?;
            let Workspace { scratch, commands, meter, .. } = &mut *workspace;
            let problem = self.problem(&mesh, (commands, meter), case)?;
            let mut path = ChainPath::new(&problem, scratch);
            path.set_state(State { load: 1.0, ..near.clone() });
            let mut found = path.finish().map_err(|open| {
                let advice =
                    "an equilibrium on coarse steps is lost on finer ones: give more steps";
                let (iterations, residual) = (open.iterations, open.gap);
                let lost = Failure::NotConverged { iterations, residual, last_load: 1.0, advice };
                self.explain(lost, commands)
            })?;
            if let Some(earlier) = coarser {
                found = found.after(&earlier);
                error = workspace.change(&mesh, backbone) / ERROR_RATIO;
            }
            let is_only = tolerance == f64::INFINITY;
            if is_only || error <= tolerance {
                let cases = core::slice::from_ref(case);
                let error = (!is_only).then_some(error);
                return Ok(self.solution(&mesh, cases, workspace, found, error));
            }
            workspace.keep(&mesh);
            (steps, coarser) = (mesh.grid.len(), Some(found));
            near.nodes.clone_from(&workspace.scratch.chain.nodes);
            near.tensions.clone_from(&workspace.scratch.tensions);
        }
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }
}
