//! Friction against bending: what a step of actuation starts from, and what it leaves ([`crate::statics::plastic_steps`]).

use std::sync::{Arc, OnceLock};

use super::prepared::{Cosserat, Workspace};
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

impl Cosserat {
    /// Whether the answer to a step depends on the steps before it by friction against bending.
    pub(crate) const fn keeps_history(&self, case: &Case) -> bool {
        self.robot.has_bending_friction() && case.obstacles.is_empty()
    }
}

impl PlasticRod for Cosserat {
    const KIND: ModelKind = ModelKind::Cosserat;
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
        let grid = self.solve_keeping_grid(step, from.into(), workspace, solution)?;
        let left = self.with_answer(step, &grid, &[], workspace, plastic_left);
        let left = left.map_err(|fault| self.fault(fault, workspace))?;
        solution.plastic_curvature = left.at_stations(self.layout.stations());
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
        let grid = self.solve_keeping_grid(step, from.into(), workspace, solution)?;
        let derivatives = self.derivatives(step, &grid, history, parameters, workspace)?;
        let (left, changes) = derivatives.plastic_left(&self.robot, &grid);
        solution.plastic_curvature = left.at_stations(self.layout.stations());
        Ok((derivatives, left, changes))
    }

    fn set_plastic(&mut self, left: PlasticCurvature) {
        self.grid.set_plastic(&left);
        for grid in Arc::make_mut(&mut self.finer).iter_mut().filter_map(OnceLock::get_mut) {
            grid.set_plastic(&left);
        }
        self.plastic = Some(left);
    }
}
