//! Friction against bending: what a step of actuation starts from, and what it leaves ([`crate::statics::plastic_steps`]).

use std::sync::{Arc, OnceLock};

use super::model::CosseratDisks;
use super::workspace::Workspace;
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::Case;
use crate::derivatives::{Derivatives, plastic_left};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::shape::Solution;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::{Differentiated, PlasticRod};

impl CosseratDisks {
    /// Whether the answer to a step depends on the steps before it by friction against bending.
    pub(crate) const fn keeps_history(&self, case: &Case) -> bool {
        self.robot.has_bending_friction() && case.obstacles.is_empty()
    }
}

impl PlasticRod for CosseratDisks {
    const KIND: ModelKind = ModelKind::CosseratDisks;
    type Workspace = Workspace;
    type Derivatives = Derivatives;

    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn limits(&self) -> (&Cancel, Budget) {
        (&self.options.cancel, self.options.budget)
    }

    fn meter(workspace: &mut Workspace) -> &mut Meter {
        &mut workspace.meter
    }

    fn take_step(
        &self,
        step: &Case,
        from: Option<&Solution>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<PlasticCurvature, SolveError> {
        let cases = core::slice::from_ref(step);
        let level = self.solve_from(cases, from.into(), workspace, solution)?;
        let mesh = self.mesh(level)?;
        let left = self.with_answer(step, &mesh, (None, &[]), workspace, plastic_left);
        // The sections of a rod without cables have no equilibrium to miss.
        let left = left.map_err(|_| SolveError::NoDerivatives)?;
        solution.plastic_curvature = left.at_stations(self.stations());
        Ok(left)
    }

    fn differentiate_step(
        &self,
        step: &Case,
        (from, history): (Option<&Solution>, &[PlasticCurvature]),
        parameters: &[Parameter],
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Differentiated<Derivatives>, SolveError> {
        let level =
            self.solve_from(core::slice::from_ref(step), from.into(), workspace, solution)?;
        let mesh = self.mesh(level)?;
        let derivatives = self.derivatives(step, &mesh, history, parameters, workspace)?;
        let (left, changes) = derivatives.plastic_left(&self.robot, &mesh.grid);
        solution.plastic_curvature = left.at_stations(self.stations());
        Ok((derivatives, left, changes))
    }

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
