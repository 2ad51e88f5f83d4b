//! Contact of the chain of sections with obstacles.

use whipcord_numerics::{Pose, Vec3};

use super::contact_adapter::{ContactAdapter, Watched};
use super::plastic_derivatives::Asked;
use super::{Linkage, Workspace};
use crate::budget::Meter;
use crate::case::Case;
use crate::contact::{self, FreeWay, NotedWay, RubbedAnswer, Unobstructed};
use crate::derivatives::CoordinateDerivatives;
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::refusal;
use crate::solution::Solution;
use crate::statics::friction::Carrying;
use crate::statics::loads::check as check_loads;

impl Linkage {
    /// The shape among the obstacles of a checked case: without them where the robot keeps clear of them.
    pub(super) fn solve_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        if !self.knows_forces {
            refusal::movable_objects(self.kind, case)?;
        }
        if self.has_friction() {
            return contact::last_of(|each| self.rub_among_obstacles(case, workspace, each));
        }
        let watched = Watched::new(self);
        let mut free = FreeChain { model: self, workspace, watched: &watched.places };
        let first_step = match contact::solve_free(&mut free, &self.robot, case, warm_start)? {
            FreeWay::Clear(_) if self.keeps_history() => {
                // Other shapes were looked at since: the joints keep what they hold in this one.
                let alone = Case { obstacles: Vec::new(), ..case.clone() };
                return self.solve_alone(&alone, warm_start, workspace);
            }
            FreeWay::Clear(solution) => return Ok(solution),
            FreeWay::Unclear { first_step, .. } => first_step,
        };
        let mut adapter = ContactAdapter::new(self, watched, workspace);
        let found = contact::solve(&mut adapter, &self.robot, (case, first_step), warm_start);
        contact::or_none_alone(found, case, |alone| {
            workspace.forget();
            self.solve_alone(alone, None, workspace)
        })
    }

    /// With friction at the holes: the answers to all steps of actuation, from rest on.
    pub(super) fn rub_among_obstacles(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        if !self.knows_forces {
            refusal::movable_objects(self.kind, case).map_err(|error| (0, error))?;
        }
        let mut adapter = ContactAdapter::new(self, Watched::new(self), workspace);
        let mut found = Vec::new();
        let each_found = |adapter: &mut ContactAdapter<'_>, answer| {
            let RubbedAnswer { mut solution, has_touched, .. } = answer;
            adapter.keep_plastic(&mut solution);
            found.push((solution, has_touched));
            Ok(())
        };
        let followed = contact::solve_rubbing(&mut adapter, &self.robot, (case, 1.0), each_found);
        contact::rubbing_or_free(
            case,
            (found, followed),
            |of| of,
            each,
            |alone, each| self.solve_steps(alone, workspace, each),
        )
    }

    /// With friction at the holes or of obstacles: the answer to the last step, with its derivatives.
    pub(super) fn rub_and_differentiate(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        case.check(&self.robot)?;
        check_loads(&self.robot, &case.loads).map_err(|error| error.of(self.kind))?;
        contact::last_with_derivatives(case, |asks, each| {
            let of = (case, parameters);
            self.rub_with_derivatives_among_obstacles(of, asks, workspace, each)
        })
    }

    /// The same, those that are asked for by their number from 0 with their derivatives.
    pub(super) fn rub_with_derivatives_among_obstacles(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        asks: &dyn Fn(usize) -> bool,
        workspace: &mut Workspace,
        each: impl FnMut((Solution, Option<CoordinateDerivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        if !self.knows_forces {
            refusal::movable_objects(self.kind, case).map_err(|error| (0, error))?;
        }
        let steps: Vec<Case> = case.leading_steps().collect();
        let watched = Watched::new(self);
        let mut first_step = 1.0;
        if !self.has_friction() && steps.len() == 1 {
            let mut free = FreeChain { model: self, workspace, watched: &watched.places };
            let found = contact::solve_free(&mut free, &self.robot, case, None);
            match found.map_err(|error| (0, error))? {
                FreeWay::Clear(solution) => {
                    return contact::steps_alone(case, asks, each, |step, asked| {
                        let of = (step, Some(&solution));
                        self.alone(of, asked.then_some(parameters), workspace)
                    });
                }
                FreeWay::Unclear { first_step: first, .. } => first_step = first,
            }
        }
        let mut adapter = ContactAdapter::new(self, watched, workspace);
        adapter.notes = Some(NotedWay::default());
        let mut carrying = Carrying::default();
        let mut found = Vec::new();
        // How the plastic angles change that the steps before left; lost where one of them has no derivatives.
        let mut history: Option<Vec<Vec<f64>>> = Some(Vec::new());
        let mut before: Option<(Self, Vec<Vec<f64>>)> = None;
        let followed = contact::solve_rubbing(
            &mut adapter,
            &self.robot,
            (case, first_step),
            |adapter, answer| {
                let RubbedAnswer { mut solution, has_touched, holding } = answer;
                let step = found.len();
                let ContactAdapter { model, notes, workspace, case: pushed, .. } = &mut *adapter;
                let keeps_history = model.keeps_history();
                let mut differentiate = || {
                    let way = notes.as_ref().ok_or(SolveError::NoDerivatives)?;
                    let history = history.as_deref().ok_or(SolveError::NoDerivativesOfRest)?;
                    let asked = Asked { parameters, stations: &self.stations, step, history };
                    let of_way = (&steps[..], asked);
                    let before = before.as_ref();
                    let found =
                        model.differentiate_noted(way, of_way, before, &mut carrying, workspace);
                    if self.has_friction() {
                        return found;
                    }
                    model.accept(pushed, workspace)?;
                    let on = model.differentiate(pushed, &holding, asked, workspace)?;
                    match found {
                        Ok(of_way) => Ok(of_way.moving_on(on)),
                        // What has jumped moves on as if its way had begun there.
                        Err(SolveError::NoDerivativesOfRest) => Ok(on),
                        Err(error) => Err(error),
                    }
                };
                let derivatives = (asks(step) || keeps_history).then(&mut differentiate);
                let derivatives = contact::where_it_counts(derivatives, has_touched)?;
                if keeps_history {
                    let q = &workspace.scratch.chain.q;
                    let behind = |of| model.history_behind(q, parameters, of);
                    let behind = derivatives.as_ref().map(behind);
                    before = core::mem::replace(&mut history, behind)
                        .map(|history| (model.clone().into_owned(), history));
                }
                adapter.keep_plastic(&mut solution);
                let derivatives = derivatives.filter(|_| asks(step));
                found.push(((solution, derivatives), has_touched));
                Ok(())
            },
        );
        contact::rubbing_or_free(
            case,
            (found, followed),
            |(of, _)| of,
            each,
            |alone, each| {
                self.solve_steps_with_derivatives(alone, parameters, asks, workspace, each)
            },
        )
    }
}

impl Linkage {
    /// The answer to a case without obstacles of cables that do not rub, with its derivatives by these parameters where they are asked for.
    pub(super) fn alone(
        &self,
        (case, near): (&Case, Option<&Solution>),
        asked: Option<&[Parameter]>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Option<CoordinateDerivatives>), SolveError> {
        let Some(parameters) = asked else {
            return Ok((self.solve_alone(case, near, workspace)?, None));
        };
        let asked = Asked::new(parameters, &self.stations);
        let (solution, of) = self.differentiate_step(case, near, asked, workspace)?;
        Ok((solution, Some(of)))
    }

    /// The same, with the derivatives of the answer and the contacts that hold it.
    pub(super) fn differentiate_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        asked: Asked<'_>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        case.check(&self.robot)?;
        check_loads(&self.robot, &case.loads).map_err(|error| error.of(self.kind))?;
        if !self.knows_forces {
            refusal::movable_objects(self.kind, case)?;
        }
        let watched = Watched::new(self);
        let mut free = FreeChain { model: self, workspace, watched: &watched.places };
        let first_step = match contact::solve_free(&mut free, &self.robot, case, warm_start)? {
            FreeWay::Clear(solution) => {
                let alone = Case { obstacles: Vec::new(), ..case.clone() };
                // With friction against bending it is found as without derivatives.
                let near = if self.keeps_history() { warm_start } else { Some(&solution) };
                return self.differentiate_step(&alone, near, asked, workspace);
            }
            FreeWay::Unclear { first_step, .. } => first_step,
        };
        let mut adapter = ContactAdapter::new(self, watched, workspace);
        let of = (case, first_step);
        let (solution, holding) =
            contact::solve_holding(&mut adapter, &self.robot, of, warm_start)?;
        let pushed = core::mem::take(&mut adapter.case);
        let derivatives = self.differentiate(&pushed, &holding, asked, workspace)?;
        Ok((solution, derivatives))
    }
}

/// The chain without obstacles.
struct FreeChain<'a> {
    model: &'a Linkage,
    workspace: &'a mut Workspace,
    watched: &'a [f64],
}

impl FreeChain<'_> {
    fn centres(&self, centres: &mut Vec<Vec3>) {
        let q = &self.workspace.scratch.chain.q;
        let disks: Vec<Pose> = self.model.disks(q).collect();
        centres.clear();
        centres.extend(self.watched.iter().map(|&s| self.model.pose_at(q, &disks, s).position));
    }
}

impl Unobstructed for FreeChain<'_> {
    fn watched(&self) -> &[f64] {
        self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.model.rest_lengths
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
        let solution = self.model.solve_alone(case, from, self.workspace)?;
        self.centres(centres);
        Ok(solution)
    }

    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.model.find(case, None, self.workspace)?;
        self.centres(centres);
        Ok(())
    }
}
