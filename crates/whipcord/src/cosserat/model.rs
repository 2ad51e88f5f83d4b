//! The interface of the model: robot, loads and options to solutions.

use std::borrow::Cow;
use std::sync::Arc;

use super::lanes::{RodLanes, Setting};
use super::prepared::{
    COARSE_STEPS, Cosserat, FOLD_LEVEL, MAX_REFINEMENTS, Progress, Refined, Workspace,
};
use super::problem::{self, StabilityCheck};
use super::redundant_cables;
use super::refinement::Attempt;
use super::scratch::Start;
use super::without_load::set_tensions;
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::{Actuation, Case, Loads};
use crate::contact::RodSolves as _;
use crate::derivatives::{AnswerLists, Cables, Derivatives, NoDerivatives, Solved};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::{Problem, Robot, RobotError};
use crate::section::Fault;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::convexity;
use crate::statics::grid::steps_for_twist;
use crate::statics::grid::{Grid, Layout};
use crate::statics::loads;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::outcome::Failure;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::statics::strength::Strength;
use crate::warm_start::{Status, WarmStart};

impl Cosserat {
    /// The model of a robot whose loads sit, begin and end at the places where `loads` has them.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the robot's stiffness is not given.
    pub fn new(robot: &Robot, loads: &Loads, options: &Options) -> Result<Self, SolveError> {
        options.check(robot)?;
        let stations = options.stations.arc_lengths(robot);
        let layout = Layout::new(robot, stations, loads);
        let steps = match options.accuracy {
            Accuracy::Steps(steps) => steps,
            Accuracy::Tolerance(_) => COARSE_STEPS,
        };
        let grid = Grid::new(robot, &layout, steps)?;
        Ok(Self {
            robot: robot.clone(),
            options: options.clone(),
            twist_level: (0..MAX_REFINEMENTS)
                .find(|&level| steps_for_twist(robot) <= COARSE_STEPS << level)
                .unwrap_or(MAX_REFINEMENTS),
            redundant_cables: redundant_cables::any(robot, &grid, &layout.order),
            layout,
            grid,
            finer: Arc::default(),
            watched: Arc::default(),
            rest_changes: Arc::default(),
            plastic: None,
        })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    pub(crate) const fn set_budget(&mut self, budget: Budget) {
        self.options.budget = budget;
    }

    pub(crate) const fn stability_mut(&mut self) -> &mut StabilityAnalysis {
        &mut self.options.stability
    }

    pub(crate) fn set_cancel(&mut self, cancel: &Cancel) {
        self.options.cancel.clone_from(cancel);
    }

    /// Arc lengths of the stations in m.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        self.layout.stations()
    }

    /// Whether these loads have their points where the model was built for them.
    #[must_use]
    pub fn takes_places_of(&self, loads: &Loads) -> bool {
        self.layout.has_loads_of(loads)
    }

    /// What solves many rows of tensions under the loads and at the base of a case at once, when the model takes that: cables
    /// driven by their tensions on a section whose stiffness is diagonal, and dead forces.
    pub(crate) fn lanes(&self, case: &Case) -> Option<RodLanes<'_>> {
        let &Options { accuracy, stability, actuation, .. } = &self.options;
        let is_loaded = !case.loads.is_none();
        if self.robot.cables().is_empty()
            || actuation == Actuation::Shortening
            || self.has_friction()
            || is_loaded && stability == StabilityAnalysis::Eigenvalue
        {
            return None;
        }
        let tolerance = match accuracy {
            Accuracy::Steps(_) => None,
            Accuracy::Tolerance(share) => Some(share * self.robot.backbone().length),
        };
        let order = self.layout.order.clone();
        let loads = is_loaded.then(|| (case.loads.clone(), case.base.rotation));
        let residual = self.options.greatest_residual();
        let cancel = self.options.cancel.clone();
        RodLanes::new(self, Setting { tolerance, stability, order, loads, residual, cancel })
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
    ///
    /// Friction of cables, and friction against bending of the backbone, depends on the history, so that pulling and releasing
    /// differ: the steps [`Case::before`] are taken first, from the robot at rest, whatever solution is given.
    ///
    /// # Errors
    /// [`SolveError`] with the reason why there is no answer.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let status = self.solve_into(case, warm_start.into(), workspace, &mut solution)?;
        workspace.meter.answered((status, solution))
    }

    /// [`Self::solve`] into memory that is at hand: without obstacles and friction of cables and after the first call nothing is
    /// allocated.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::BudgetSpent`] where there is no shape yet.
    pub fn solve_into(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        workspace.meter.start(&self.options.cancel, self.options.budget);
        if self.bends_in_steps() {
            let taken = self.solve_with_bending_friction(case, workspace, solution);
            return workspace.meter.checked(taken).map(|()| Status::Converged);
        }
        if !case.obstacles.is_empty() {
            let outcome = self.solve_among_obstacles(case, from.given(solution), workspace);
            *solution = workspace.meter.checked(outcome)?;
            return Ok(Status::Converged);
        }
        let outcome = if self.has_friction() {
            case.check(&self.robot)?;
            let steps: Vec<Case> = case.leading_steps().collect();
            solution.plastic_curvature.clear();
            self.solve_with_friction(&steps, true, workspace, solution)
        } else {
            self.solve_keeping_grid(case, from, workspace, solution).map(|_| ())
        };
        match workspace.meter.checked(outcome) {
            Ok(()) => Ok(Status::Converged),
            Err(error @ SolveError::BudgetSpent { .. }) => {
                let written = self.write_best(case, workspace, solution)?;
                if written { Ok(Status::BudgetSpent) } else { Err(error) }
            }
            Err(error) => Err(error),
        }
    }

    /// [`Self::solve`], with the derivatives of the answer: by tensions or lengths, by loads at any
    /// place, and by these parameters.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Invalid`] for a parameter that robot and case do not have,
    /// and [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_with_derivatives(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        if self.has_friction() && case.obstacles.is_empty() {
            return self.solve_sliding_with_derivatives(case, parameters, workspace);
        }
        workspace.meter.start(&self.options.cancel, self.options.budget);
        if self.bends_in_steps() {
            let mut last = None;
            let each = |solution, derivatives| last = Some((solution, derivatives));
            let taken = self.differentiate_with_bending_friction(case, parameters, workspace, each);
            let taken = taken.map_err(|(_, error)| error);
            workspace.meter.checked(taken)?;
            return last.ok_or(SolveError::NoDerivatives);
        }
        if !case.obstacles.is_empty() {
            let found = self.differentiate_among_obstacles(case, warm_start, parameters, workspace);
            return workspace.meter.checked(found);
        }
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let solved = self.solve_keeping_grid(case, warm_start.into(), workspace, &mut solution);
        let grid = workspace.meter.checked(solved)?;
        let derivatives = self.derivatives(case, &grid, &[], parameters, workspace)?;
        Ok((solution, derivatives))
    }

    /// The derivatives of the answer that the workspace holds; `history` is how the plastic curvature before it changes with each
    /// parameter.
    pub(super) fn derivatives(
        &self,
        case: &Case,
        grid: &Grid,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
        workspace: &Workspace,
    ) -> Result<Derivatives, SolveError> {
        let of =
            |solved: &Solved<'_>| Derivatives::of(solved, parameters).map(Derivatives::settled);
        let found = self.with_answer(case, grid, history, workspace, of);
        found.map_err(|none| self.no_derivatives(none, workspace))
    }

    /// Why the answer that the workspace holds has no derivatives.
    pub(super) fn no_derivatives(&self, why: NoDerivatives, workspace: &Workspace) -> SolveError {
        match why {
            NoDerivatives::Parameter(error) => error.into(),
            NoDerivatives::Critical => SolveError::NoDerivatives,
            NoDerivatives::Fault(fault) => self.fault(fault, workspace),
        }
    }

    /// The answer that the workspace holds, as it is gone over once more.
    pub(super) fn with_answer<T>(
        &self,
        case: &Case,
        grid: &Grid,
        history: &[PlasticCurvature],
        workspace: &Workspace,
        act: impl FnOnce(&Solved<'_>) -> T,
    ) -> T {
        let mut lists = AnswerLists::default();
        self.with_lists_of_answer(case, grid, history, (workspace, &mut lists), act)
    }

    /// The same in memory that is kept.
    pub(super) fn with_lists_of_answer<T>(
        &self,
        case: &Case,
        grid: &Grid,
        history: &[PlasticCurvature],
        (workspace, lists): (&Workspace, &mut AnswerLists),
        act: impl FnOnce(&Solved<'_>) -> T,
    ) -> T {
        let Workspace { scratch, commands, .. } = workspace;
        lists.set_taut(&scratch.tensions);
        let AnswerLists { taut, starts } = lists;
        starts.clear();
        starts.extend(scratch.chain_starts());
        act(&Solved {
            robot: &self.robot,
            case,
            cables: Cables { rest_changes: Some(&*self.rest_changes), ..Cables::of(&self.layout) },
            grid,
            loads: &scratch.applied,
            commands,
            tensions: &scratch.tensions,
            taut,
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts,
            // Without load no shot has been fired: its strains would be those of another case.
            strains: match scratch.applied.any() {
                true => scratch.trajectory.strains(),
                false => &scratch.unloaded.strains,
            },
            // The starts of a chain have been moved since its last shot.
            are_strains_met: starts.is_empty(),
            history,
            nodes: &grid.stations,
            sliding: None,
            open: None,
        })
    }

    /// A section of the answer that the workspace holds without equilibrium.
    pub(super) fn fault(&self, fault: Fault, workspace: &Workspace) -> SolveError {
        let failure = Failure::of_section(fault, &workspace.scratch.tensions, 1.0);
        self.explain(failure, &workspace.commands)
    }

    /// See [`crate::Prepared::has_one_equilibrium`].
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the case.
    pub(crate) fn has_one_equilibrium(
        &self,
        case: &Case,
        greatest: &[f64],
        workspace: &mut Workspace,
    ) -> Result<bool, SolveError> {
        self.accept(case, workspace)?;
        let Workspace { commands, scratch, .. } = workspace;
        let has_history = self.has_friction() || self.robot.has_bending_friction();
        if has_history || !case.obstacles.is_empty() {
            return Ok(false);
        }
        scratch.applied.gather(&self.grid, &case.loads, case.base.rotation);
        let limit = |cable: &usize| greatest.get(*cable).copied().unwrap_or(f64::INFINITY);
        scratch.tensions.clear();
        scratch.tensions.extend(self.layout.order.iter().map(limit));
        set_tensions(commands, &mut scratch.tensions);
        if !scratch.tensions.iter().all(|tension| tension.is_finite()) {
            return Ok(false);
        }
        Ok(convexity::is_shown(&self.grid, &scratch.applied, &scratch.tensions, 0.0))
    }

    pub(super) fn solve_keeping_grid(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Cow<'_, Grid>, SolveError> {
        self.accept(case, workspace)?;
        workspace.progress = Progress::default();
        workspace.scratch.open = None;
        let mut start = core::mem::take(&mut workspace.start);
        start.forget();
        if let Some(answer) = from.given(solution) {
            self.start_from(answer, &mut start);
        }
        let solved = self.solve_from(&start, case, workspace, solution);
        workspace.start = start;
        solved
    }

    fn solve_from(
        &self,
        start: &Start,
        case: &Case,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Cow<'_, Grid>, SolveError> {
        match self.options.accuracy {
            Accuracy::Steps(_) => {
                let grid = &self.grid;
                self.solve_checked(case, workspace, solution, |check, workspace| {
                    let allowance = Strength::default().allowance(grid);
                    workspace.scratch.trajectory.steps_left = allowance;
                    let kind = Attempt { level: FOLD_LEVEL, check, is_final: true };
                    let found = self.solve_on(grid, case, start, kind, workspace)?;
                    Ok(Refined { found, grid: Cow::Borrowed(grid), error: None })
                })
            }
            Accuracy::Tolerance(tolerance) => {
                workspace.scratch.stays_on_path = false;
                let refine = |check, workspace: &mut Workspace| {
                    self.halve_steps(tolerance, case, start, check, workspace)
                };
                match self.solve_checked(case, workspace, solution, refine) {
                    // Close above a critical load the shape on a branch hangs on rounding: that on the path does not.
                    Err(SolveError::StepsTooCoarse { .. }) if !case.loads.is_none() => {
                        workspace.scratch.stays_on_path = true;
                        let on_path = self.solve_checked(case, workspace, solution, refine);
                        workspace.scratch.stays_on_path = false;
                        on_path
                    }
                    answer => answer,
                }
            }
        }
    }

    /// Checks a case and notes what drives its cables.
    pub(super) fn accept(&self, case: &Case, workspace: &mut Workspace) -> Result<(), SolveError> {
        case.check(&self.robot)?;
        loads::check(&self.robot, &case.loads)?;
        if !self.layout.has_loads_of(&case.loads) {
            let problem = Problem::LoadPlaces;
            return Err(RobotError { path: "loads".to_owned(), problem }.into());
        }
        self.commands(case, &mut workspace.commands)
    }

    pub(super) fn problem<'a>(
        &'a self,
        grid: &'a Grid,
        case: &'a Case,
        (commands, meter): (&'a [Command], &'a Meter),
    ) -> problem::Problem<'a> {
        problem::Problem {
            grid,
            length: self.robot.backbone().length,
            commands,
            asked: commands,
            loads: &case.loads,
            base: case.base.rotation,
            stability: match self.options.stability {
                StabilityAnalysis::Off => StabilityCheck::Off,
                _ => StabilityCheck::EveryGrid,
            },
            follow: true,
            bracket: true,
            redundant_cables: self.redundant_cables,
            is_final: true,
            has_eigenvalue: self.options.stability == StabilityAnalysis::Eigenvalue,
            tolerance: self.options.greatest_residual(),
            meter,
        }
    }

    /// What drives each cable, in the order of the grid.
    fn commands(&self, case: &Case, commands: &mut Vec<Command>) -> Result<(), SolveError> {
        commands.clear();
        for (&cable, &initial) in self.layout.order.iter().zip(&self.layout.rest_lengths) {
            let actuation = self.options.actuation;
            let kind = ModelKind::Cosserat;
            commands.push(Command::of(kind, &self.robot, cable, case, actuation, initial)?);
        }
        Ok(())
    }

    fn start_from(&self, solution: &Solution, start: &mut Start) {
        let tension = |&i: &usize| solution.cables.get(i).and_then(|c| c.tension).unwrap_or(0.0);
        start.tensions.extend(self.layout.order.iter().map(tension));
        start.base_wrench = solution.base_wrench;
        start.internal.copy_from(&solution.internal);
        start.stable = !solution.diagnostics.is_unstable();
        start.is_iterate = solution.diagnostics.residual > self.options.greatest_residual();
    }

    pub(super) fn explain(&self, failure: Failure, commands: &[Command]) -> SolveError {
        let name = |place: usize| self.robot.cables()[self.layout.order[place]].name.clone();
        failure.explain(commands, &self.layout.rest_lengths, name)
    }
}
