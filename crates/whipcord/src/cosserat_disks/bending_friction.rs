//! Friction against bending: what a step of actuation starts from, and what it leaves ([`crate::statics::plastic_steps`]).

use std::sync::{Arc, OnceLock};

use super::model::CosseratDisks;
use super::workspace::Workspace;
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::Case;
use crate::contact::RodSolves as _;
use crate::derivatives::{Derivatives, plastic_left};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::{Differentiated, PlasticRod};

impl CosseratDisks {
    /// Whether steps of actuation are taken one by one, each from the plastic curvature that the one before left. Beside friction of
    /// cables, whose memory belongs to a grid, all of them are taken on each grid instead.
    pub(crate) fn bends_in_steps(&self) -> bool {
        self.robot.has_bending_friction() && !self.has_friction()
    }

    /// The answer to a step without obstacles as a solve of its own, from the plastic curvature that was set where there is one.
    pub(super) fn solve_step(
        &self,
        step: &Case,
        near: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        if !self.bends_in_steps() {
            return self.solve(step, near, workspace);
        }
        self.start_meter(workspace);
        let mut solution = Solution::empty(ModelKind::CosseratDisks);
        let taken = self.take_step(step, near, workspace, &mut solution);
        workspace.meter.checked(taken)?;
        Ok(solution)
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
        if !step.obstacles.is_empty() {
            let (answer, left) = self.take_step_among_obstacles(step, from, workspace)?;
            *solution = answer;
            solution.plastic_curvature = left.at_stations(self.stations());
            return Ok(left);
        }
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
        if !step.obstacles.is_empty() {
            let asked = (history, parameters);
            let (answer, found) =
                self.differentiate_step_among_obstacles((step, from), asked, workspace)?;
            *solution = answer;
            solution.plastic_curvature = found.1.at_stations(self.stations());
            return Ok(found);
        }
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
