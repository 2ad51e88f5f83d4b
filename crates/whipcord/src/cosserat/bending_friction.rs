//! Steps of actuation of the rod whose backbone has friction against bending.
//!
//! In every step the plastic curvature that the steps before left is given, and the rod is a nonlinear elastic one
//! ([`crate::section`]); what it leaves itself is the start of the next step.

use std::sync::{Arc, OnceLock};

use super::prepared::{Cosserat, Workspace};
use crate::case::Case;
use crate::derivatives::{Derivatives, plastic_left};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::shape::Solution;
use crate::statics::plastic_curvature::PlasticCurvature;

impl Cosserat {
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
        for step in case.leading_steps() {
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

    /// Whether the answer to a step depends on the steps before it by friction against bending.
    pub(crate) const fn keeps_history(&self, case: &Case) -> bool {
        self.robot.has_bending_friction() && case.obstacles.is_empty()
    }

    /// [`Self::differentiate_with_bending_friction`] as a solve of its own.
    pub(crate) fn differentiate_steps(
        &self,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Workspace,
        each: impl FnMut(Solution, Derivatives),
    ) -> Result<(), (usize, SolveError)> {
        workspace.meter.start(&self.options.cancel, self.options.budget);
        self.differentiate_with_bending_friction(case, parameters, workspace, each)
    }

    /// The answers to all steps of a case in order, with their derivatives by these parameters through all steps before.
    ///
    /// # Errors
    /// The number of the first step without them, from 0, and why.
    pub(crate) fn differentiate_with_bending_friction(
        &self,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution, Derivatives),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        let mut rod = self.clone();
        let mut history: Vec<PlasticCurvature> = Vec::new();
        let mut last: Option<Solution> = None;
        for (n, step) in case.leading_steps().enumerate() {
            let mut solution = Solution::empty(ModelKind::Cosserat);
            let taken = rod.differentiate_step(
                &step,
                (last.as_ref(), &history),
                parameters,
                workspace,
                &mut solution,
            );
            let (derivatives, left, changes) = taken.map_err(|error| (n, error))?;
            history = changes;
            rod.set_plastic(left);
            each(last.insert(solution).clone(), derivatives);
        }
        Ok(())
    }

    /// One step of actuation: its derivatives, the plastic curvature that it leaves, and how this changes with each parameter.
    fn differentiate_step(
        &self,
        step: &Case,
        (from, history): (Option<&Solution>, &[PlasticCurvature]),
        parameters: &[Parameter],
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<(Derivatives, PlasticCurvature, Vec<PlasticCurvature>), SolveError> {
        let grid = self.solve_keeping_grid(step, from.into(), workspace, solution)?;
        let derivatives = self.derivatives(step, &grid, history, parameters, workspace)?;
        let (left, changes) = derivatives.plastic_left(&self.robot, &grid);
        solution.plastic_curvature = left.at_stations(self.layout.stations());
        Ok((derivatives, left, changes))
    }

    /// One step of actuation from the plastic curvature that the grids have: its answer and the plastic curvature that it leaves.
    fn take_step(
        &self,
        step: &Case,
        from: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, PlasticCurvature), SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let grid = self.solve_keeping_grid(step, from.into(), workspace, &mut solution)?;
        let left = self.with_answer(step, &grid, &[], workspace, plastic_left);
        let left = left.map_err(|fault| self.fault(fault, workspace))?;
        solution.plastic_curvature = left.at_stations(self.layout.stations());
        Ok((solution, left))
    }

    /// Gives all grids the plastic curvature that a step of actuation left.
    fn set_plastic(&mut self, left: PlasticCurvature) {
        self.grid.set_plastic(&left);
        for grid in Arc::make_mut(&mut self.finer).iter_mut().filter_map(OnceLock::get_mut) {
            grid.set_plastic(&left);
        }
        self.plastic = Some(left);
    }
}
