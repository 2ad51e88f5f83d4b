//! Contact of the rod with cables from hole to hole: backbone and disks among obstacles.

use whipcord_numerics::Vec3;

use super::contact_response::ContactResponse;
use super::model::CosseratDisks;
use super::workspace::Workspace;
use crate::budget::Meter;
use crate::case::Case;
use crate::contact::{self, FreeWay, RodAdapter, RodSolves, Unobstructed, WatchedPlaces};
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::solution::Solution;
use crate::statics::options::Accuracy;
use crate::statics::plastic_curvature::PlasticCurvature;

impl RodSolves for CosseratDisks {
    type Rod = ContactResponse;

    const RUBBING_STEPS: Option<usize> = None;

    fn accuracy(&self) -> Accuracy {
        self.options().accuracy
    }

    fn needed_steps(&self, case: &Case, workspace: &mut Workspace) -> usize {
        self.strength(case, workspace).steps()
    }

    fn adapter<'a>(
        &'a self,
        steps: usize,
        meter: &'a Meter,
    ) -> Result<RodAdapter<'a, ContactResponse>, SolveError> {
        let at_base = self.mesh(0)?.grid.shooting.at(0, 0, 0).0.section.bending_stiffness();
        let initial = self.frame().rest_lengths.clone();
        let stiffness = at_base.column(0).x;
        let watched = &self.watched_places().places;
        Ok(RodAdapter::new(
            self.robot(),
            (self.options(), meter),
            watched,
            initial,
            stiffness,
            steps,
        ))
    }

    fn find_clear(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<FreeWay, SolveError> {
        let watched = self.watched_places();
        let mut free = FreeRod { model: self, workspace, watched };
        contact::solve_free(&mut free, self.robot(), case, warm_start)
    }

    fn solve_alone(&self, case: &Case, workspace: &mut Workspace) -> Result<Solution, SolveError> {
        self.solve_keeping_level(case, None, workspace).map(|(solution, _)| solution)
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
        self.solve_steps_with_derivatives(case, parameters, asks, workspace, each)
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

impl CosseratDisks {
    fn watched_places(&self) -> &WatchedPlaces {
        self.watched.get_or_init(|| WatchedPlaces::of(self.robot()))
    }
}

/// The rod without obstacles.
struct FreeRod<'a> {
    model: &'a CosseratDisks,
    workspace: &'a mut Workspace,
    watched: &'a WatchedPlaces,
}

impl Unobstructed for FreeRod<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched.places
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.model.frame().rest_lengths
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
        let (solution, level) = self.model.solve_keeping_level(case, from, self.workspace)?;
        let mesh = self.model.mesh(level)?;
        contact::centres(&mesh.grid, self.workspace.poses(), &self.watched.places, centres);
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
        let mesh = self.model.mesh(0)?;
        contact::centres(&mesh.grid, self.workspace.poses(), &self.watched.places, centres);
        Ok(())
    }
}
