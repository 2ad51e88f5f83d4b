use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::lanes::{Setting, UnloadedLanes};
use super::redundant_cables;
use super::refinement::{COARSE_STEPS, FINER_GRIDS, FOLD_LEVEL, MAX_REFINEMENTS, Refined};
use super::statics::{self, Scratch, StabilityCheck, Start};
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::{Actuation, Case, Loads};
use crate::derivatives::{Cables, Derivatives, NoDerivatives, Solved};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::refusal;
use crate::robot::{Problem, Robot, RobotError};
use crate::shape::{CableState, Diagnostics, NoStability, Solution};
use crate::statics::command::Command;
use crate::statics::grid::steps_for_twist;
use crate::statics::grid::{Grid, Layout};
use crate::statics::loads;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::outcome::{Failure, Found};
use crate::statics::refinement::Coarse;
use crate::statics::strength::Strength;
use crate::warm_start::{Status, WarmStart};

/// The Cosserat model of one robot: all that does not change from case to case.
///
/// ```
/// use whipcord::cosserat::{Cosserat, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Loads, Material, Robot, Routing, Section};
///
/// let backbone = Backbone {
///     section: Some(Section::circle(0.003)),
///     material: Material {
///         young_modulus: Some(1.1e9),
///         poisson_ratio: Some(0.3),
///         ..Default::default()
///     },
///     ..Backbone::new(0.18)
/// };
/// let disks = Disks::equally_spaced(0.18, 10, 0.008);
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, disks, vec![cable])?;
///
/// let model = Cosserat::new(&robot, &Loads::default(), &Options::default())?;
/// let mut workspace = Workspace::default();
/// let solution = model.solve(&Case::with_tensions(&[3.0]), None, &mut workspace)?;
/// // A straight cable bends the rod to a circle of curvature τ r/EI.
/// let bend = 0.18 * 3.0 * 0.008 / (1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0);
/// assert!((solution.disks.tip().rotation.log().norm() - bend).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Cosserat {
    pub(super) robot: Robot,
    pub(super) layout: Layout,
    pub(super) options: Options,
    /// Whether some of its cables pull against one another to no effect.
    redundant_cables: bool,
    /// How often the steps of the first grid are halved to follow the twist of the unloaded rod.
    pub(super) twist_level: usize,
    /// The only grid, or the first of a sequence in which the steps are halved.
    pub(super) grid: Grid,
    /// The next of them, made when the first case needs them and shared by all copies of the model.
    pub(super) finer: Arc<[OnceLock<Grid>; FINER_GRIDS]>,
}

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) commands: Vec<Command>,
    pub(super) meter: Meter,
    /// Where the solve starts, and the answer on the coarser grid as the start on a finer one.
    start: Start,
    pub(super) from_coarser: Start,
    /// How far the solve came: the best shape where its budget is spent.
    pub(super) progress: Progress,
    /// What the answer on the coarser grid was.
    pub(super) coarse: Coarse,
    /// The coarser grid at the tensions that the finer one found.
    pub(super) at_tensions: Scratch,
    pub(super) tensions: Vec<Command>,
}

/// What a solve has found so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// How often the steps of the grid are halved that it is on.
    pub level: usize,
    /// Whether there is an answer on coarser steps, in [`Workspace::coarse`] and [`Workspace::from_coarser`].
    pub coarser: Option<Found>,
}

impl Cosserat {
    /// The model of a robot whose loads sit, begin and end at the places where `loads` has them.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the robot's stiffness is not given, and
    /// [`SolveError::Unsupported`] for cables with hole friction.
    pub fn new(robot: &Robot, loads: &Loads, options: &Options) -> Result<Self, SolveError> {
        refusal::hole_friction(
            ModelKind::Cosserat,
            robot,
            "friction at the holes",
            "its cables slide freely: use cosserat-disks, or set the friction to 0",
        )?;
        options.stations.check(robot)?;
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

    /// What solves many rows of tensions at once where there is no load, when the model takes that: cables
    /// driven by their tensions on a section whose stiffness is diagonal.
    pub(crate) fn unloaded_lanes(&self) -> Option<UnloadedLanes<'_>> {
        let &Options { accuracy, stability, actuation, .. } = &self.options;
        let stability = stability != StabilityAnalysis::Off;
        if self.robot.cables().is_empty() || actuation == Actuation::Shortening {
            return None;
        }
        let tolerance = match accuracy {
            Accuracy::Steps(_) => None,
            Accuracy::Tolerance(share) => Some(share * self.robot.backbone().length),
        };
        let order = self.layout.order.clone();
        UnloadedLanes::new(self, Setting { tolerance, stability, order })
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
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

    /// [`Self::solve`] into memory that is at hand: without obstacles and after the first call nothing is allocated.
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
        if !case.obstacles.is_empty() {
            let outcome = self.solve_among_obstacles(case, from.given(solution), workspace);
            *solution = workspace.meter.checked(outcome)?;
            return Ok(Status::Converged);
        }
        let outcome = self.solve_keeping_grid(case, from, workspace, solution);
        match workspace.meter.checked(outcome.map(|_| ())) {
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
        workspace.meter.start(&self.options.cancel, self.options.budget);
        if !case.obstacles.is_empty() {
            let found = self.differentiate_among_obstacles(case, warm_start, parameters, workspace);
            return workspace.meter.checked(found);
        }
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let solved = self.solve_keeping_grid(case, warm_start.into(), workspace, &mut solution);
        let grid = workspace.meter.checked(solved)?;
        let Workspace { scratch, commands, .. } = workspace;
        let starts = scratch.chain_starts();
        let taut: Vec<bool> = scratch.tensions.iter().map(|&tension| tension > 0.0).collect();
        let derivatives = Derivatives::of(
            &Solved {
                robot: &self.robot,
                case,
                cables: Cables::of(&self.layout),
                grid: &grid,
                loads: &scratch.applied,
                commands,
                tensions: &scratch.tensions,
                taut: &taut,
                poses: &scratch.poses,
                base_wrench: scratch.base_wrench,
                starts: &starts,
                // Without load no shot has been fired: its strains would be those of another case.
                strains: match scratch.applied.any() {
                    true => scratch.trajectory.strains(),
                    false => &scratch.unloaded.strains,
                },
                nodes: &grid.stations,
            },
            parameters,
        );
        match derivatives {
            Ok(derivatives) => Ok((solution, derivatives)),
            Err(NoDerivatives::Parameter(error)) => Err(error.into()),
            Err(NoDerivatives::Critical) => Err(SolveError::NoDerivatives),
            Err(NoDerivatives::Fault(fault)) => {
                Err(self.explain(Failure::of_section(fault, &scratch.tensions, 1.0), commands))
            }
        }
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
                    let level = (FOLD_LEVEL, check);
                    let found = self.solve_on(grid, case, start, level, workspace)?;
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
    ) -> statics::Problem<'a> {
        statics::Problem {
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
        start.stable = !solution.diagnostics.is_unstable();
    }

    /// The answer that the workspace holds.
    pub(super) fn solution(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
        found: Found,
        discretization_error: Option<f64>,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        self.write(grid, case, workspace, (found, discretization_error), &mut solution)?;
        Ok(solution)
    }

    /// Writes the answer that the workspace holds.
    pub(super) fn write(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
        (found, discretization_error): (Found, Option<f64>),
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        let problem = self.problem(grid, case, (&workspace.commands, &workspace.meter));
        let verdict = statics::stability(&problem, self.options.stability, &mut workspace.scratch)
            .map_err(|failure| self.explain(failure, &workspace.commands))?;
        let scratch = &workspace.scratch;
        let at = |k: &usize| scratch.poses[*k];
        solution.shape.set(self.layout.stations(), grid.stations.iter().map(at), case.base);
        let disks = &self.robot.disks().arc_lengths;
        solution.disks.set(disks, grid.disks.iter().map(at), case.base);
        let Scratch { tensions, lengths, base_wrench, .. } = scratch;
        self.write_cables(&workspace.commands, tensions, lengths, solution);
        solution.base_wrench = Some(*base_wrench);
        solution.diagnostics = Diagnostics {
            iterations: found.iterations,
            residual: found.residual,
            discretization_error,
            steps: grid.len(),
            stability_lost_at: found.lost_at,
            ..Diagnostics::default()
        }
        .with_stability(verdict);
        Ok(())
    }

    /// Writes what became of the cables, from tensions and lengths in the order of the grid; and that nothing touches.
    fn write_cables(
        &self,
        commands: &[Command],
        tensions: &[f64],
        lengths: &[f64],
        solution: &mut Solution,
    ) {
        solution.model = ModelKind::Cosserat;
        solution.contacts.clear();
        let cables = self.robot.cables();
        solution.cables.resize_with(cables.len(), CableState::default);
        for (place, &cable) in self.layout.order.iter().enumerate() {
            let length = [lengths[place], self.layout.rest_lengths[place]];
            let (name, backbone) = (&cables[cable].name, self.robot.backbone().length);
            let state = &mut solution.cables[cable];
            commands[place].answer(name, tensions[place], length, backbone, state);
        }
    }

    /// Writes the best shape that a solve has found whose budget is spent: the answer on coarser steps, or the last iterate; `false`
    /// where there is none.
    fn write_best(
        &self,
        case: &Case,
        workspace: &Workspace,
        solution: &mut Solution,
    ) -> Result<bool, SolveError> {
        let Workspace { scratch, commands, coarse, from_coarser, progress, .. } = workspace;
        let (stations, disks) = (self.layout.stations(), &self.robot.disks().arc_lengths);
        let (found, steps) = if let Some(found) = progress.coarser {
            let poses = coarse.poses();
            let (at_disks, at_stations) = poses.split_at(disks.len());
            solution.shape.set(stations, at_stations.iter().copied(), case.base);
            solution.disks.set(disks, at_disks.iter().copied(), case.base);
            self.write_cables(commands, &from_coarser.tensions, coarse.lengths(), solution);
            solution.base_wrench = from_coarser.base_wrench;
            (found, self.grid(progress.level.saturating_sub(1))?.len())
        } else if let Some(effort) = scratch.open {
            let grid = self.grid(progress.level)?;
            let at = |k: &usize| scratch.poses[*k];
            solution.shape.set(stations, grid.stations.iter().map(at), case.base);
            solution.disks.set(disks, grid.disks.iter().map(at), case.base);
            self.write_cables(commands, &scratch.tensions, &scratch.lengths, solution);
            solution.base_wrench = Some(scratch.base_wrench);
            (Found::with(effort), grid.len())
        } else {
            return Ok(false);
        };
        solution.diagnostics = Diagnostics {
            iterations: found.iterations,
            residual: found.residual,
            steps,
            stability_lost_at: found.lost_at,
            ..Diagnostics::default()
        }
        .with_stability(Err(NoStability::NotAsked));
        Ok(true)
    }

    pub(super) fn explain(&self, failure: Failure, commands: &[Command]) -> SolveError {
        let name = |place: usize| self.robot.cables()[self.layout.order[place]].name.clone();
        failure.explain(commands, &self.layout.rest_lengths, name)
    }
}
