//! What the models have in common that divide the backbone between two disks into an arc or a few rigid bodies:
//! a chain of sections, each with few coordinates, that cables cross in straight lines.
//!
//! `docs/theory/piecewise-constant-curvature.md` derives the equations whose numbers stand in the
//! code. From the inside out: `swing` bends, `motion` is a section, divided as `division` says; `layout` cuts the
//! robot into sections, `loads` gathers what acts on it; `chain` is the equilibrium of all sections and
//! the linear system of a step, for a `task`, with the signs of its `pivots`; `statics` finds it, `stability` judges it, `stable_branch` finds another where it is not stable, `derivatives` differentiates it, `local` at one place, `tip_rates` at the tip in memory that is kept;
//! `places` are cross-sections that wrenches act on, `contact` is the chain among obstacles; `friction` gives every
//! passage of a cable a tension of its own, for `actuation_steps` with friction at the holes; `plastic_derivatives` carries along what friction against bending keeps.

mod actuation_steps;
mod bending_friction;
mod chain;
mod contact;
mod contact_adapter;
mod contact_response;
mod derivatives;
pub(crate) mod division;
mod energy;
mod friction;
mod friction_derivatives;
mod held;
mod holes_in_contact;
mod layout;
mod loads;
mod local;
mod motion;
mod path;
mod pivots;
mod place_wrench;
mod places;
mod plastic_derivatives;
mod stability;
mod stable_branch;
mod statics;
mod swing;
mod task;
mod tip_rates;

use whipcord_numerics::Pose;

use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::{Actuation, Case};
use crate::derivatives::TensionRatesMemory;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::solution::{CableState, Diagnostics, NoStability, Solution, Verdict};
use crate::statics::command::Command;
use crate::statics::lengths::{self, Given, LengthScratch};
use crate::statics::loads::check as check_loads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::Failure;
use crate::stations::Stations;
use crate::warm_start::{Status, WarmStart};

use division::Division;
use friction::Rubbing;
use held::{HeldCable, HoldScratch};
use layout::Section;
use loads::AppliedLoads;
use motion::Coordinates;
use statics::{Effort, Responder, Scratch};
use task::{DeadMoments, Task};

/// How a model is driven, and what it computes.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the tension.
    pub actuation: Actuation,
    /// What is computed of the stability of the answer.
    pub stability: StabilityAnalysis,
    /// Residual at which equilibrium counts as met, relative to EI/L and the moments in play.
    pub residual: f64,
    /// What a solve may spend.
    pub budget: Budget,
    /// Ends a solve from outside.
    pub cancel: Cancel,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            stations: Stations::default(),
            actuation: Actuation::default(),
            stability: StabilityAnalysis::default(),
            residual: 1e-11,
            budget: Budget::default(),
            cancel: Cancel::default(),
        }
    }
}

/// The chain of one robot: what [`crate::piecewise_constant_curvature::build`] and
/// [`crate::pseudo_rigid_body::build`] make of it.
#[derive(Clone, Debug)]
pub struct Linkage {
    robot: Robot,
    kind: ModelKind,
    division: Division,
    options: Options,
    sections: Vec<Section>,
    rest_lengths: Vec<f64>,
    /// Where a cable rubs in its holes.
    friction: Option<Rubbing>,
    stations: Vec<f64>,
    /// Whether the stiffness is that of the robot, and so the forces of an answer are.
    knows_forces: bool,
}

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    scratch: Scratch,
    loads: AppliedLoads,
    commands: Vec<Command>,
    tensions: Vec<f64>,
    search: LengthScratch,
    held: Vec<HeldCable>,
    hold: HoldScratch,
    meter: Meter,
    friction: friction::Memory,
    tip_rates: TensionRatesMemory,
}

impl Workspace {
    /// The answer of the last solve; where its budget is spent that it is.
    pub(crate) fn answered(
        &self,
        status: Status,
        solution: Solution,
    ) -> Result<Solution, SolveError> {
        self.meter.answered((status, solution))
    }
}

impl Linkage {
    /// Which of the models of sections it is.
    #[must_use]
    pub const fn kind(&self) -> ModelKind {
        self.kind
    }

    /// The chain of a robot whose sections are divided like this.
    pub(crate) fn new(
        robot: &Robot,
        kind: ModelKind,
        division: Division,
        options: Options,
    ) -> Result<Self, SolveError> {
        options.stations.check(robot)?;
        let (sections, rest_lengths) = layout::sections(robot, kind, &division)?;
        let friction = Rubbing::new(robot, &division, &sections);
        let stations = options.stations.arc_lengths(robot);
        Ok(Self {
            robot: robot.clone(),
            kind,
            division,
            options,
            sections,
            rest_lengths,
            friction,
            stations,
            knows_forces: true,
        })
    }

    /// The same of a robot whose stiffness is assumed: its answers tell no forces.
    pub(crate) fn without_forces(self) -> Self {
        Self { knows_forces: false, ..self }
    }

    /// Whether its answers tell forces.
    pub(crate) const fn knows_forces(&self) -> bool {
        self.knows_forces
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
        &self.stations
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
    ///
    /// # Errors
    /// [`SolveError::Missing`] for a
    /// command or a mass that is not given, [`SolveError::NotConverged`] with the part of the load
    /// up to which there was an equilibrium, what the rods say of cable lengths that cannot be had, and
    /// [`SolveError::ObstacleInTheWay`] and [`SolveError::Obstructed`] among obstacles.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(self.kind);
        let status = self.solve_into(case, warm_start.into(), workspace, &mut solution)?;
        workspace.answered(status, solution)
    }

    /// [`Self::solve`] into memory that is at hand: after the first call nothing is allocated where tensions drive the cables
    /// without friction.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_into(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        workspace.forget();
        if self.keeps_history() {
            let steps = self.bend_in_steps(case, workspace, |answer| *solution = answer);
            return steps.map(|()| Status::Converged).map_err(|(_, error)| error);
        }
        self.solve_from_here(case, from, workspace, solution)
    }

    /// The same, with the steps of actuation behind it that the workspace has taken with friction.
    pub(super) fn solve_from_here(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        workspace.meter.start(&self.options.cancel, self.options.budget);
        case.check(&self.robot)?;
        check_loads(&self.robot, &case.loads).map_err(|error| error.of(self.kind))?;
        if !case.obstacles.is_empty() {
            let outcome = self.solve_among_obstacles(case, from.given(solution), workspace);
            *solution = workspace.meter.checked(outcome)?;
            return Ok(Status::Converged);
        }
        let found = self.find_stable(case, from.given(solution), workspace);
        match workspace.meter.checked(found) {
            Ok((effort, verdict)) => {
                self.write(case, effort, verdict, workspace, solution);
                Ok(Status::Converged)
            }
            Err(error @ SolveError::BudgetSpent { .. }) => {
                let Some(effort) = workspace.scratch.restore_open() else { return Err(error) };
                let verdict = Err(NoStability::NotAsked);
                self.write(case, effort, verdict, workspace, solution);
                Ok(Status::BudgetSpent)
            }
            Err(error) => Err(error),
        }
    }

    /// The shape under a checked case without obstacles.
    fn solve_alone(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let (effort, verdict) = self.find_stable(case, warm_start, workspace)?;
        Ok(self.solution(case, effort, verdict, workspace))
    }

    /// The equilibrium under a checked case without obstacles; it is left in the workspace.
    fn find(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Effort, SolveError> {
        if let Some(rubbing) = &self.friction {
            return self.find_with_friction(rubbing, case, workspace);
        }
        self.accept(case, workspace)?;
        let Workspace { scratch, commands, tensions, .. } = &mut *workspace;
        scratch.open = None;
        tensions.clear();
        tensions.resize(commands.len(), 0.0);
        if let Some(solution) = warm_start {
            self.start_from(solution, scratch);
            for (tension, cable) in tensions.iter_mut().zip(&solution.cables) {
                *tension = cable.tension.unwrap_or(0.0).max(0.0);
            }
        }
        self.converge(1.0, warm_start.is_some(), workspace)
            .map_err(|failure| self.explain(failure, &workspace.commands))
    }

    /// The least bending stiffness of a section over the length of the robot, in N·m: the unit of moments.
    fn bending_scale(&self) -> f64 {
        let bending = |a: usize| self.sections.iter().map(move |s| s.stiffness[a] * s.length);
        let least = bending(1).chain(bending(2)).fold(f64::INFINITY, f64::min);
        least / self.robot.backbone().length
    }

    /// Gathers the loads and commands of a checked case.
    fn accept(&self, case: &Case, workspace: &mut Workspace) -> Result<(), SolveError> {
        let Workspace { loads, commands, .. } = workspace;
        loads.gather(&self.robot, &self.division, &case.loads, case.base.rotation);
        commands.clear();
        for (i, &initial) in self.rest_lengths.iter().enumerate() {
            let actuation = self.options.actuation;
            commands.push(Command::of(self.kind, &self.robot, i, case, actuation, initial)?);
        }
        Ok(())
    }

    fn explain(&self, failure: Failure, commands: &[Command]) -> SolveError {
        let name = |i: usize| self.robot.cables()[i].name.clone();
        failure.explain(commands, &self.rest_lengths, name)
    }

    /// The section of an arc length and the fraction of it that lies behind: a disk is the end of the section before it.
    fn locate(&self, arc_length: f64) -> (usize, f64) {
        match self.robot.disks().locate(arc_length) {
            (k, 0.0) if k > 0 => (k - 1, 1.0),
            at => at,
        }
    }

    /// The disks of a chain with these coordinates, in the frame of the base.
    fn disks(&self, q: &[Coordinates]) -> impl Iterator<Item = Pose> {
        let mut pose = Pose::IDENTITY;
        let ends = self.sections.iter().zip(q).map(move |(section, q)| {
            pose = pose * motion::pose_at(&self.division, section.length, q, 1.0);
            pose
        });
        core::iter::once(Pose::IDENTITY).chain(ends)
    }

    /// The cross-section at an arc length of a chain with these coordinates and disks, in the frame of the base.
    fn pose_at(&self, q: &[Coordinates], disks: &[Pose], arc_length: f64) -> Pose {
        let (k, t) = self.locate(arc_length);
        if t == 1.0 {
            return disks[k + 1];
        }
        disks[k] * motion::pose_at(&self.division, self.sections[k].length, &q[k], t)
    }

    /// The coordinates nearest to a neighbouring answer's.
    fn start_from(&self, solution: &Solution, scratch: &mut Scratch) {
        scratch.chain.rest(&self.sections);
        let disks = &solution.disks.poses;
        if disks.len() == self.sections.len() + 1 {
            for (q, pair) in scratch.chain.q.iter_mut().zip(disks.windows(2)) {
                let turn = pair[0].rotation.conjugate() * pair[1].rotation;
                *q = motion::coordinates_of(&self.division, turn);
            }
        }
    }

    fn task<'a>(
        &'a self,
        loads: &'a AppliedLoads,
        tensions: &'a [f64],
        meter: &'a Meter,
    ) -> Task<'a> {
        Task {
            division: &self.division,
            sections: &self.sections,
            loads,
            load: 1.0,
            pull: 1.0,
            tensions,
            moments: DeadMoments::Exact,
            meter,
        }
    }

    /// Equilibrium under the commands and this part of the loads.
    fn converge(
        &self,
        load: f64,
        is_warm: bool,
        workspace: &mut Workspace,
    ) -> Result<Effort, Failure> {
        let Workspace { scratch, loads, commands, tensions, search, meter, .. } = workspace;
        let tolerance = self.options.residual;
        for (tension, command) in tensions.iter_mut().zip(&*commands) {
            if let Command::Tension(given) = command {
                *tension = *given;
            }
        }
        if !commands.iter().any(Command::is_length) {
            let task = Task { load, ..self.task(loads, tensions, meter) };
            return if is_warm {
                scratch.converge_near(&task, tolerance, true)
            } else {
                scratch.converge(&task, tolerance)
            };
        }
        let given = Given { length: self.robot.backbone().length, commands, bracket: true, meter };
        let task = Task { load, ..self.task(loads, &[], meter) };
        let mut rod = Responder::new(task, tolerance, scratch);
        let solved = lengths::solve(&given, tensions, &mut rod, search);
        let Responder { effort, failure, .. } = rod;
        solved.map_err(|fault| {
            let of_section = |_| failure.clone().unwrap_or(Failure::TensionsNotFound);
            fault.failure(of_section)
        })?;
        Ok(effort)
    }

    /// The answer that the workspace is at.
    fn solution(
        &self,
        case: &Case,
        effort: Effort,
        verdict: Result<Verdict, NoStability>,
        workspace: &Workspace,
    ) -> Solution {
        let mut solution = Solution::empty(self.kind);
        self.write(case, effort, verdict, workspace, &mut solution);
        solution
    }

    /// Writes what the workspace holds.
    fn write(
        &self,
        case: &Case,
        effort: Effort,
        verdict: Result<Verdict, NoStability>,
        workspace: &Workspace,
        solution: &mut Solution,
    ) {
        let Workspace { scratch, commands, tensions, .. } = workspace;
        let chain = &scratch.chain;
        let at = &self.robot.disks().arc_lengths;
        // Relative to the base until the stations between them are known.
        solution.disks.set(at, self.disks(&chain.q), Pose::IDENTITY);
        let disks = &solution.disks.poses;
        let between = |&s: &f64| self.pose_at(&chain.q, disks, s);
        match self.options.stations {
            Stations::Disks => solution.shape.set(at, disks.iter().copied(), case.base),
            Stations::Equal(_) | Stations::At(_) => {
                solution.shape.set(&self.stations, self.stations.iter().map(between), case.base);
            }
        }
        solution.disks.turn(case.base);
        let cables = self.robot.cables();
        solution.cables.resize_with(cables.len(), CableState::default);
        for (i, state) in solution.cables.iter_mut().enumerate() {
            let (name, length) = (&cables[i].name, [chain.lengths[i], self.rest_lengths[i]]);
            commands[i].answer(name, tensions[i], length, self.robot.backbone().length, state);
            state.tension = state.tension.filter(|_| self.knows_forces);
        }
        if let Some(rubbing) = &self.friction {
            self.write_holes(rubbing, workspace, solution);
        }
        solution.model = self.kind;
        solution.contacts.clear();
        solution.internal.clear();
        solution.objects.clear();
        solution.base_wrench = self.knows_forces.then_some(chain.base);
        solution.diagnostics = Diagnostics {
            iterations: effort.iterations,
            residual: effort.residual,
            steps: self.sections.len(),
            stability_lost_at: effort.lost_at,
            ..Diagnostics::default()
        }
        .with_stability(verdict);
    }
}
