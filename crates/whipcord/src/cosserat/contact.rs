//! Contact of the rod with obstacles: its response to contact forces.

use whipcord_numerics::Vec3;

use super::contact_response::ContactResponse;
use super::prepared::{Cosserat, Workspace};
use crate::budget::Meter;
use crate::case::Case;
use crate::contact::{self, FreeWay, RodAdapter, RodSolves, Unobstructed, WatchedPlaces};
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::solution::Solution;
use crate::statics::options::Accuracy;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::warm_start::WarmStart;

impl RodSolves for Cosserat {
    type Rod = ContactResponse;

    /// The tension of a cable that rubs is constant in each.
    const RUBBING_STEPS: Option<usize> = Some(32);

    fn accuracy(&self) -> Accuracy {
        self.options.accuracy
    }

    fn needed_steps(&self, case: &Case, workspace: &mut Workspace) -> usize {
        self.strength(case, workspace).steps()
    }

    fn adapter<'a>(
        &'a self,
        steps: usize,
        meter: &'a Meter,
    ) -> Result<RodAdapter<'a, ContactResponse>, SolveError> {
        let at_base = self.grid.shooting.at(0, 0, 0).0.section.bending_stiffness();
        let (initial, stiffness) = (self.initial_lengths(), at_base.column(0).x);
        let watched = &self.watched_places().places;
        Ok(RodAdapter::new(&self.robot, (&self.options, meter), watched, initial, stiffness, steps))
    }

    fn find_clear(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<FreeWay, SolveError> {
        let watched = self.watched_places();
        let initial_lengths = self.initial_lengths();
        let mut free = FreeRod { model: self, workspace, watched, initial_lengths };
        contact::solve_free(&mut free, &self.robot, case, warm_start)
    }

    fn solve_alone(&self, case: &Case, workspace: &mut Workspace) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let from = WarmStart::None;
        let solved = self.solve_keeping_grid(case, from, workspace, &mut solution);
        workspace.meter.checked(solved).map(|_| solution)
    }

    fn solve_steps_alone(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        each: &mut dyn FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        self.solve_steps(case, workspace, each)
    }

    fn differentiate_steps_alone(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        asks: &dyn Fn(usize) -> bool,
        workspace: &mut Workspace,
        each: &mut dyn FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        self.slide_with_derivatives(case, parameters, asks, workspace, each)
    }

    fn plastic(&self) -> Option<&PlasticCurvature> {
        self.plastic.as_ref()
    }

    fn differentiate_alone(
        &self,
        case: &Case,
        near: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        self.solve_with_derivatives(case, near, parameters, workspace)
    }
}

impl Cosserat {
    fn watched_places(&self) -> &WatchedPlaces {
        self.watched.get_or_init(|| WatchedPlaces::of(&self.robot))
    }

    /// Lengths of the cables before actuation in m.
    fn initial_lengths(&self) -> Vec<f64> {
        let mut initial_lengths = vec![0.0; self.layout.order.len()];
        for (&cable, &initial) in self.layout.order.iter().zip(&self.layout.rest_lengths) {
            initial_lengths[cable] = initial;
        }
        initial_lengths
    }
}

/// The rod without obstacles.
struct FreeRod<'a> {
    model: &'a Cosserat,
    workspace: &'a mut Workspace,
    watched: &'a WatchedPlaces,
    initial_lengths: Vec<f64>,
}

impl Unobstructed for FreeRod<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched.places
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.initial_lengths
    }

    fn meter(&mut self) -> &mut Meter {
        &mut self.workspace.meter
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
        contact::centres(&grid, &self.workspace.scratch.poses, &self.watched.places, centres);
        Ok(solution)
    }

    fn look_at_rest(&mut self, rest: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        // Plastic curvature bends it at rest.
        if self.model.plastic.is_some() {
            return self.look(rest, centres);
        }
        self.watched.at_rest(centres, |centres| self.look(rest, centres))
    }

    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.model.solve_coarsely(case, self.workspace)?;
        contact::centres(
            &self.model.grid,
            &self.workspace.scratch.poses,
            &self.watched.places,
            centres,
        );
        Ok(())
    }
}
