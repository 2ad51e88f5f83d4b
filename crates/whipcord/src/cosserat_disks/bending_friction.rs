//! Steps of actuation of the rod whose backbone has friction against bending.
//!
//! In every step the plastic curvature that the steps before left is given, and the rod is a nonlinear elastic one
//! ([`crate::section`]); what it leaves itself is the start of the next step.

use std::sync::{Arc, OnceLock};

use super::model::CosseratDisks;
use super::workspace::Workspace;
use crate::case::Case;
use crate::derivatives::strains_at_step_ends;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::shape::Solution;
use crate::statics::plastic_curvature::PlasticCurvature;

impl CosseratDisks {
    /// The answer to the last of the steps of a case, from the robot at rest through all of them.
    pub(super) fn solve_with_bending_friction(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        case.check(&self.robot)?;
        let mut rod = self.clone();
        let mut last: Option<Solution> = None;
        for step in case.single_steps() {
            let (answer, left) = rod.take_step(&step, last.as_ref(), workspace)?;
            rod.set_plastic(left);
            last = Some(answer);
        }
        if let Some(answer) = last {
            *solution = answer;
        }
        Ok(())
    }

    /// The answers to all steps of a case in order.
    pub(super) fn solve_steps_with_bending_friction(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        let mut rod = self.clone();
        let mut last: Option<Solution> = None;
        for (n, step) in case.single_steps().enumerate() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            let taken = rod.take_step(&step, last.as_ref(), workspace);
            let (answer, left) = workspace.meter.checked(taken).map_err(|error| (n, error))?;
            rod.set_plastic(left);
            each(last.insert(answer).clone());
        }
        Ok(())
    }

    /// One step of actuation from the plastic curvature that the meshes have: its answer and the plastic curvature that it leaves.
    fn take_step(
        &self,
        step: &Case,
        from: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, PlasticCurvature), SolveError> {
        let mut solution = Solution::empty(ModelKind::CosseratDisks);
        let cases = core::slice::from_ref(step);
        let level = self.solve_from(cases, from.into(), workspace, &mut solution)?;
        let mesh = self.mesh(level)?;
        let strains = self.with_answer(step, &mesh, None, workspace, strains_at_step_ends);
        // The sections of a rod without cables have no equilibrium to miss.
        let strains = strains.map_err(|_| SolveError::NoDerivatives)?;
        let left = PlasticCurvature::left(&mesh.grid, &strains);
        solution.plastic_curvature = left.at_stations(self.stations());
        Ok((solution, left))
    }

    /// Gives all meshes the plastic curvature that a step of actuation left.
    fn set_plastic(&mut self, left: PlasticCurvature) {
        let Self { frame, mesh, finer, fine, .. } = self;
        frame.set_plastic(mesh, &left);
        let finer = Arc::make_mut(finer).iter_mut().filter_map(OnceLock::get_mut);
        for mesh in finer.chain(Arc::make_mut(fine).get_mut()) {
            frame.set_plastic(mesh, &left);
        }
        self.plastic = Some(left);
    }
}
