//! Contact of the rod with obstacles: its response to contact forces.

use whipcord_numerics::Vec3;

use super::contact_response::ContactResponse;
use super::prepared::{Cosserat, Workspace};
use crate::case::Case;
use crate::contact::{self, RodAdapter, Unobstructed};
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::shape::Solution;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::{Differentiated, PlasticRod as _};

/// Steps from base to tip at least where cables rub, whose tension is constant in each.
const FRICTION_STEPS: usize = 32;
/// Steps from base to tip at least where friction against bending keeps a history at their ends.
const BENDING_FRICTION_STEPS: usize = 20;

impl Cosserat {
    /// The shape among the obstacles of a case: without them where the robot keeps clear of them.
    pub(super) fn solve_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        if self.has_friction() {
            return contact::last_of(|each| self.rub_among_obstacles(case, workspace, each));
        }
        if let Some(solution) = self.solve_clear(case, warm_start, workspace)? {
            return Ok(solution);
        }
        let needed = self.strength(case, workspace).steps();
        let found = contact::on_few_steps_or_more(self.options.accuracy, needed, |steps| {
            contact::solve(&mut self.adapter(steps), &self.robot, case, warm_start)
        });
        contact::or_none_alone(found, case, |alone| self.solve(alone, None, workspace))
    }

    /// One step of actuation of a backbone with friction against bending, and the plastic curvature that it leaves.
    pub(super) fn take_step_among_obstacles(
        &self,
        case: &Case,
        from: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, PlasticCurvature), SolveError> {
        if self.solve_clear(case, from, workspace)?.is_some() {
            // Other shapes were looked at since: it is found once more, as without obstacles.
            let alone = Case { obstacles: Vec::new(), ..case.clone() };
            let mut solution = Solution::empty(ModelKind::Cosserat);
            let left = self.take_step(&alone, from, workspace, &mut solution)?;
            return Ok((solution, left));
        }
        let needed = self.strength(case, workspace).steps().max(BENDING_FRICTION_STEPS);
        let found = contact::on_few_steps_or_more(self.options.accuracy, needed, |steps| {
            let mut adapter = self.adapter(steps).with_plastic(self.plastic.as_ref());
            let solution = contact::solve(&mut adapter, &self.robot, case, from)?;
            Ok((solution, adapter.plastic_left()?))
        });
        contact::or_none_alone(found, case, |alone| self.solve_step(alone, None, workspace))
    }

    /// The same with its derivatives, where the plastic curvature before changes with each parameter as `history` says, and how that which it
    /// leaves changes.
    pub(super) fn differentiate_step_among_obstacles(
        &self,
        (case, from): (&Case, Option<&Solution>),
        (history, parameters): (&[PlasticCurvature], &[Parameter]),
        workspace: &mut Workspace,
    ) -> Result<(Solution, Differentiated<Derivatives>), SolveError> {
        if self.solve_clear(case, from, workspace)?.is_some() {
            let alone = Case { obstacles: Vec::new(), ..case.clone() };
            let mut solution = Solution::empty(ModelKind::Cosserat);
            let from = (from, history);
            let found =
                self.differentiate_step(&alone, from, parameters, workspace, &mut solution)?;
            return Ok((solution, found));
        }
        let needed = self.strength(case, workspace).steps().max(BENDING_FRICTION_STEPS);
        contact::on_few_steps_or_more(self.options.accuracy, needed, |steps| {
            let mut adapter =
                self.adapter(steps).with_plastic(self.plastic.as_ref()).with_stations();
            let (solution, holding) =
                contact::solve_holding(&mut adapter, &self.robot, case, from)?;
            let derivatives = adapter.differentiate(&holding, history, parameters)?;
            let grid = adapter.grid().ok_or(SolveError::NoDerivatives)?;
            let (left, changes) = derivatives.plastic_left(&self.robot, grid);
            Ok((solution, (derivatives, left, changes)))
        })
    }

    /// With friction of the cables: the answers to all steps of actuation, from rest on.
    pub(super) fn rub_among_obstacles(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        self.check_among_obstacles(case).map_err(|error| (0, error))?;
        let steps = self.strength(case, workspace).steps().max(FRICTION_STEPS);
        let mut found = Vec::new();
        let each_found = |of_step| found.push(of_step);
        let followed = contact::rub(&mut self.adapter(steps), case, each_found);
        contact::rubbing_or_free(case, found, |of| of, |alone| self.solve(alone, None, workspace))
            .try_for_each(|solution| solution.map(&mut each))?;
        followed
    }

    /// The same, those that are asked for by their number from 0 with their derivatives.
    pub(super) fn rub_with_derivatives(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        asks: &dyn Fn(usize) -> bool,
        workspace: &mut Workspace,
        each: impl FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        self.check_among_obstacles(case).map_err(|error| (0, error))?;
        let steps = self.strength(case, workspace).steps().max(FRICTION_STEPS);
        let mut adapter = self.adapter(steps).with_stations().taking_notes();
        let mut found = Vec::new();
        let followed =
            contact::differentiate_rubbing(&mut adapter, (case, parameters), asks, &mut found);
        let asked = (case, asks, parameters);
        contact::with_derivatives_or_free(
            asked,
            found,
            each,
            |alone, parameters| match parameters {
                Some(parameters) => {
                    let (solution, of) =
                        self.solve_with_derivatives(alone, None, parameters, workspace)?;
                    Ok((solution, Some(of)))
                }
                None => Ok((self.solve(alone, None, workspace)?, None)),
            },
        )?;
        followed
    }

    fn check_among_obstacles(&self, case: &Case) -> Result<(), SolveError> {
        case.check(&self.robot)?;
        Ok(())
    }

    /// The same, with the derivatives of the answer and the contacts that hold it.
    pub(super) fn differentiate_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        if self.has_friction() {
            let of = (case, parameters);
            return contact::last_with_derivatives(case, |asks, each| {
                self.rub_with_derivatives(of, asks, workspace, each)
            });
        }
        if let Some(solution) = self.solve_clear(case, warm_start, workspace)? {
            let alone = Case { obstacles: Vec::new(), ..case.clone() };
            return self.solve_with_derivatives(&alone, Some(&solution), parameters, workspace);
        }
        let needed = self.strength(case, workspace).steps();
        contact::on_few_steps_or_more(self.options.accuracy, needed, |steps| {
            let mut adapter = self.adapter(steps).with_stations();
            let (solution, holding) =
                contact::solve_holding(&mut adapter, &self.robot, case, warm_start)?;
            Ok((solution, adapter.differentiate(&holding, &[], parameters)?))
        })
    }

    /// The shape of a robot that keeps clear of the obstacles; `None` where it might not.
    fn solve_clear(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Option<Solution>, SolveError> {
        self.check_among_obstacles(case)?;
        let watched = contact::watched(&self.robot);
        let initial_lengths = self.initial_lengths();
        let mut free = FreeRod { model: self, workspace, watched, initial_lengths };
        contact::solve_free(&mut free, &self.robot, case, warm_start)
    }

    /// Lengths of the cables before actuation in m.
    fn initial_lengths(&self) -> Vec<f64> {
        let mut initial_lengths = vec![0.0; self.layout.order.len()];
        for (&cable, &initial) in self.layout.order.iter().zip(&self.layout.rest_lengths) {
            initial_lengths[cable] = initial;
        }
        initial_lengths
    }

    fn adapter(&self, steps: usize) -> RodAdapter<'_, ContactResponse> {
        let at_base = self.grid.shooting.at(0, 0, 0).0.section.bending_stiffness();
        let stiffness = at_base.column(0).x;
        RodAdapter::new(&self.robot, &self.options, self.initial_lengths(), stiffness, steps)
    }
}

/// The rod without obstacles.
struct FreeRod<'a> {
    model: &'a Cosserat,
    workspace: &'a mut Workspace,
    watched: Vec<f64>,
    initial_lengths: Vec<f64>,
}

impl Unobstructed for FreeRod<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.initial_lengths
    }

    fn solve(
        &mut self,
        case: &Case,
        from: Option<&Solution>,
        centres: &mut Vec<Vec3>,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let from = from.into();
        let solved = self.model.solve_keeping_grid(case, from, self.workspace, &mut solution);
        let grid = self.workspace.meter.checked(solved)?;
        contact::centres(&grid, &self.workspace.scratch.poses, &self.watched, centres);
        Ok(solution)
    }

    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.model.solve_coarsely(case, self.workspace)?;
        contact::centres(&self.model.grid, &self.workspace.scratch.poses, &self.watched, centres);
        Ok(())
    }
}
