use std::borrow::Cow;

use whipcord_numerics::Pose;

use super::derivatives::{Derivatives, NoDerivatives, Solved};
use super::grid::{Grid, Layout};
use super::lanes::OneCableLanes;
use super::lengths::Command;
use super::loads;
use super::statics::{self, Found, Scratch, Start};
use super::without_load::section_failure;
use crate::case::{Case, Drive, Loads};
use crate::error::SolveError;
use crate::model::{ModelKind, Stations};
use crate::parameter::Parameter;
use crate::robot::{Cable, Problem, Robot, RobotError};
use crate::shape::{CableState, Diagnostics, Shape, Solution};

/// How the model is discretised and driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the tension.
    pub drive: Drive,
    /// How finely it integrates.
    pub accuracy: Accuracy,
    /// Whether the stability of the answer is computed.
    pub stability: bool,
    /// Residual, relative to the scales of moment (EI/L and the base moment) and length, at which
    /// equilibrium under load counts as met. It is about the relative error of the shape that the
    /// iteration leaves.
    pub residual: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            stations: Stations::default(),
            drive: Drive::default(),
            accuracy: Accuracy::default(),
            stability: true,
            residual: 2e-11,
        }
    }
}

/// How finely the rod is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// The steps are halved until the estimated error of every position and of every cable's length
    /// is below this fraction of the length; where lengths are given, at the tensions found.
    Tolerance(f64),
    /// At least this many steps from base to tip. Disks, stations, cable ends, kinks of a routing
    /// and places of loads always end a step.
    Steps(usize),
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::Tolerance(1e-9)
    }
}

/// Steps from base to tip on the grid that [`Accuracy::Tolerance`] starts with.
const COARSE_STEPS: usize = 8;
/// Grids that are made beforehand: with three of them most robots are done.
const READY_GRIDS: usize = 3;
/// A failure to converge is believed only with steps halved this often.
const GIVE_UP_LEVEL: usize = 3;
/// Where the load path loses its stability or ends, it is followed on with steps halved this often:
/// coarser ones may lose it too early.
pub(super) const FOLLOW_LEVEL: usize = 2;
/// How far a cable can be shortened is said with steps halved this often.
const FOLD_LEVEL: usize = 5;
/// How often the steps may be halved.
pub(super) const MAX_REFINEMENTS: usize = 9;
/// A step of order 5 that is halved loses all but 1/32 of its error; less is relied on.
pub(super) const ERROR_RATIO: f64 = 15.0;
/// Where lengths are given they do not change with the steps; the tensions do. The steps are those
/// that suffice for the tensions found, so that the lengths of an answer return its tensions and not
/// those of another grid. The positions may be off by this much more than the tolerance, where they
/// hang more on the lengths than on the tensions.
const LENGTHS_SLACK: f64 = 100.0;

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
    /// The only grid, or the first of a sequence in which the steps are halved.
    grids: Vec<Grid>,
}

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) commands: Vec<Command>,
    coarse: Scratch,
    tensions: Vec<Command>,
    coarse_poses: Vec<Pose>,
    coarse_lengths: Vec<f64>,
}

impl Workspace {
    /// Keeps what the answer on a coarse grid is compared by.
    pub(super) fn keep_coarse(&mut self, grid: &Grid) {
        keep(&self.scratch, grid, &mut self.coarse_poses, &mut self.coarse_lengths);
    }

    /// Largest change of a position or a cable's length since then, in m.
    pub(super) fn change(&self, grid: &Grid) -> f64 {
        let kept = grid.disks.iter().chain(&grid.stations).zip(&self.coarse_poses);
        let moved =
            kept.map(|(&k, coarse)| (self.scratch.poses[k].position - coarse.position).norm());
        let lengths = self.scratch.lengths.iter().zip(&self.coarse_lengths);
        moved.chain(lengths.map(|(fine, coarse)| (fine - coarse).abs())).fold(0.0, f64::max)
    }
}

/// Copies what answers on different grids are compared by.
fn keep(answer: &Scratch, grid: &Grid, poses: &mut Vec<Pose>, lengths: &mut Vec<f64>) {
    let kept = grid.disks.iter().chain(&grid.stations);
    poses.clear();
    poses.extend(kept.map(|&k| answer.poses[k]));
    lengths.clone_from(&answer.lengths);
}

impl Cosserat {
    /// The model of a robot whose loads sit, begin and end at the places where `loads` has them.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the robot's stiffness is not given, and
    /// [`SolveError::Unsupported`] when its cables rub.
    pub fn new(robot: &Robot, loads: &Loads, options: &Options) -> Result<Self, SolveError> {
        refuse_friction(robot)?;
        options.stations.check(robot)?;
        let stations = options.stations.arc_lengths(robot);
        let layout = Layout::new(robot, stations, loads);
        let grids = match options.accuracy {
            Accuracy::Steps(steps) => vec![Grid::new(robot, &layout, steps)?],
            Accuracy::Tolerance(_) => (0..READY_GRIDS)
                .map(|level| Grid::refined(robot, &layout, COARSE_STEPS, level))
                .collect::<Result<_, _>>()?,
        };
        Ok(Self { robot: robot.clone(), layout, options: options.clone(), grids })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
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

    /// What solves many tensions of its one cable at once where there is no load, when the model takes
    /// that: one cable to the tip on a section that is equally stiff about x and y, driven by its tension,
    /// and no stability asked for.
    pub(crate) fn one_cable_lanes(&self) -> Option<OneCableLanes> {
        let &Options { accuracy, stability, drive, .. } = &self.options;
        if self.robot.cables().len() != 1 || stability || drive == Drive::Shortening {
            return None;
        }
        let tolerance = match accuracy {
            Accuracy::Steps(_) => None,
            Accuracy::Tolerance(share) => Some((share * self.robot.backbone().length, ERROR_RATIO)),
        };
        OneCableLanes::new(&self.grids, tolerance)
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
        self.solve_keeping_grid(case, warm_start, workspace).map(|(solution, _)| solution)
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
        let (solution, grid) = self.solve_keeping_grid(case, warm_start, workspace)?;
        let Workspace { scratch, commands, .. } = workspace;
        let starts = scratch.chain_starts();
        let derivatives = Derivatives::of(
            &Solved {
                robot: &self.robot,
                case,
                layout: &self.layout,
                grid: &grid,
                loads: &scratch.applied,
                commands,
                tensions: &scratch.tensions,
                poses: &scratch.poses,
                base_wrench: scratch.base_wrench,
                starts: starts.as_deref(),
                // Without load no shot has been fired: its strains would be those of another case.
                strains: if scratch.applied.any() { scratch.shot.strains() } else { &[] },
            },
            parameters,
        );
        match derivatives {
            Ok(derivatives) => Ok((solution, derivatives)),
            Err(NoDerivatives::Parameter(error)) => Err(error.into()),
            Err(NoDerivatives::Critical) => Err(SolveError::NoDerivatives),
            Err(NoDerivatives::Fault(fault)) => {
                Err(self.explain(section_failure(fault, &scratch.tensions, 1.0), commands))
            }
        }
    }

    fn solve_keeping_grid(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Cow<'_, Grid>), SolveError> {
        self.accept(case, workspace)?;
        let start = match warm_start {
            Some(solution) => self.start_from(solution),
            None => Start::Cold,
        };
        match self.options.accuracy {
            Accuracy::Steps(_) => {
                let found = self.solve_on(&self.grids[0], case, &start, FOLD_LEVEL, workspace)?;
                let grid = &self.grids[0];
                let solution = self.solution(grid, case, workspace, found, None)?;
                Ok((solution, Cow::Borrowed(grid)))
            }
            Accuracy::Tolerance(tolerance) => self.solve_to(tolerance, case, start, workspace),
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

    /// The grid whose steps are halved so often; where the steps are prescribed, the only one.
    pub(super) fn grid(&self, level: usize) -> Result<Cow<'_, Grid>, SolveError> {
        Ok(match self.grids.get(level) {
            Some(grid) => Cow::Borrowed(grid),
            None => Cow::Owned(Grid::refined(&self.robot, &self.layout, COARSE_STEPS, level)?),
        })
    }

    /// Halves the steps until the answer changes no more.
    fn solve_to(
        &self,
        tolerance: f64,
        case: &Case,
        mut start: Start,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Cow<'_, Grid>), SolveError> {
        let tolerance = tolerance * self.robot.backbone().length;
        let cold = start.clone();
        let mut coarser: Option<(Found, Cow<'_, Grid>)> = None;
        let (mut error, mut steps) = (f64::INFINITY, 0);
        for level in 0..=MAX_REFINEMENTS {
            let grid = self.grid(level)?;
            let mut found = match self.solve_on(&grid, case, &start, level, workspace) {
                // Steps that are too coarse for a strong bend can keep Newton's method away.
                Err(SolveError::NotConverged { .. } | SolveError::Buckled { .. })
                    if coarser.is_none() && level < GIVE_UP_LEVEL =>
                {
                    continue;
                }
                // A section folds between the nodes of a coarse grid before it does at them: only
                // with fine steps is it known how far a cable goes.
                Err(SolveError::UnreachableLength { .. }) if level < FOLD_LEVEL => {
                    coarser = None;
                    start = cold.clone();
                    continue;
                }
                other => other?,
            };
            if let Some((earlier, coarse)) = &coarser {
                found = found.after(earlier);
                error = workspace.change(&grid) / ERROR_RATIO;
                let given_lengths =
                    workspace.commands.iter().any(|c| matches!(c, Command::Length { .. }));
                let mut met = error <= tolerance;
                if given_lengths
                    && error <= LENGTHS_SLACK * tolerance
                    && let Some(other) = self.change_at_tensions(coarse, &grid, case, workspace)
                {
                    met = other <= tolerance;
                    error = error.max(other);
                }
                if met {
                    let solution = self.solution(&grid, case, workspace, found, Some(error))?;
                    return Ok((solution, grid));
                }
            }
            workspace.keep_coarse(&grid);
            start = workspace.scratch.as_start();
            steps = grid.len();
            coarser = Some((found, grid));
        }
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }

    /// The estimated error that the answer in the workspace would have if its tensions had been
    /// given instead of lengths; `None` where they fold the coarse grid.
    fn change_at_tensions(
        &self,
        coarse: &Grid,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Option<f64> {
        workspace.tensions.clear();
        workspace.tensions.extend(workspace.scratch.tensions.iter().map(|&t| Command::Tension(t)));
        let problem = statics::Problem {
            // What is stable at given lengths need not be so at given tensions.
            stability: false,
            ..self.problem(coarse, case, &workspace.tensions)
        };
        let start = workspace.scratch.as_start();
        statics::solve(&problem, &start, &mut workspace.coarse).ok()?;
        let Workspace { coarse: answer, coarse_poses, coarse_lengths, .. } = &mut *workspace;
        keep(answer, coarse, coarse_poses, coarse_lengths);
        Some(workspace.change(grid) / ERROR_RATIO)
    }

    fn solve_on(
        &self,
        grid: &Grid,
        case: &Case,
        start: &Start,
        level: usize,
        workspace: &mut Workspace,
    ) -> Result<Found, SolveError> {
        let problem = statics::Problem {
            follow: level >= FOLLOW_LEVEL,
            bracket: level >= FOLD_LEVEL,
            ..self.problem(grid, case, &workspace.commands)
        };
        statics::solve(&problem, start, &mut workspace.scratch)
            .map_err(|failure| self.explain(failure, &workspace.commands))
    }

    pub(super) fn problem<'a>(
        &self,
        grid: &'a Grid,
        case: &'a Case,
        commands: &'a [Command],
    ) -> statics::Problem<'a> {
        statics::Problem {
            grid,
            length: self.robot.backbone().length,
            commands,
            loads: &case.loads,
            base: case.base.rotation,
            stability: self.options.stability,
            follow: true,
            bracket: true,
            tolerance: self.options.residual,
        }
    }

    /// What drives each cable, in the order of the grid.
    fn commands(&self, case: &Case, commands: &mut Vec<Command>) -> Result<(), SolveError> {
        commands.clear();
        for (place, &i) in self.layout.order.iter().enumerate() {
            let command = &case.commands[i];
            let tension = command.tension.filter(|_| self.options.drive != Drive::Shortening);
            let shortening = command.shortening.filter(|_| self.options.drive != Drive::Tension);
            let initial = self.layout.rest_lengths[place];
            commands.push(match (tension, shortening) {
                (Some(tension), _) => Command::Tension(tension),
                (None, Some(shortening)) => Command::Length {
                    target: initial - shortening.in_metres(initial),
                    compliance: self.robot.cables()[i].axial_stiffness.map_or(0.0, |k| initial / k),
                },
                (None, None) => return Err(self.no_command(i)),
            });
        }
        Ok(())
    }

    fn no_command(&self, cable: usize) -> SolveError {
        let (key, advice) = match self.options.drive {
            Drive::Natural => ("tension", "give this cable a tension, or a shortening"),
            Drive::Tension => ("tension", "give it, or drive the cables by their shortening"),
            Drive::Shortening => ("shortening", "give it, or drive the cables by their tension"),
        };
        SolveError::Missing {
            model: ModelKind::Cosserat,
            path: format!("cables[{cable}].{key}"),
            advice,
        }
    }

    fn start_from(&self, solution: &Solution) -> Start {
        let tension = |&i: &usize| solution.cables.get(i).and_then(|c| c.tension).unwrap_or(0.0);
        Start::From {
            tensions: self.layout.order.iter().map(tension).collect(),
            base_wrench: solution.base_wrench,
            stable: !solution.diagnostics.is_unstable(),
            chain: None,
        }
    }

    pub(super) fn solution(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
        found: Found,
        discretization_error: Option<f64>,
    ) -> Result<Solution, SolveError> {
        let stability = if self.options.stability {
            let problem = self.problem(grid, case, &workspace.commands);
            let least = statics::least_eigenvalue(&problem, &mut workspace.scratch);
            least.map_err(|failure| self.explain(failure, &workspace.commands))?
        } else {
            None
        };
        let scratch = &workspace.scratch;
        let shape = |arc_lengths: &[f64], places: &[usize]| {
            let poses = places.iter().map(|&k| scratch.poses[k]).collect();
            Shape { arc_length: arc_lengths.to_vec(), poses }.moved(case.base)
        };
        let mut cables: Vec<CableState> = Vec::with_capacity(self.layout.order.len());
        for (i, cable) in self.robot.cables().iter().enumerate() {
            // Every cable has its place in the order of the grid.
            let place = self.layout.order.iter().position(|&c| c == i).unwrap_or(i);
            let (tension, length) = (scratch.tensions[place], scratch.lengths[place]);
            let command = workspace.commands[place];
            let loose = command.slackness(tension, length);
            cables.push(CableState {
                name: cable.name.clone(),
                tension: Some(tension),
                length,
                initial_length: self.layout.rest_lengths[place],
                slack: matches!(command, Command::Length { .. })
                    && tension == 0.0
                    && loose > 1e-12 * self.robot.backbone().length,
                span_tensions: Vec::new(),
                contacts: Vec::new(),
            });
        }
        Ok(Solution {
            model: ModelKind::Cosserat,
            shape: shape(self.layout.stations(), &grid.stations),
            disks: shape(&self.robot.disks().arc_lengths, &grid.disks),
            cables,
            base_wrench: Some(scratch.base_wrench),
            diagnostics: Diagnostics {
                iterations: found.iterations,
                residual: found.residual,
                stability,
                discretization_error,
                steps: grid.len(),
                stability_lost_at: found.lost_at,
            },
        })
    }

    pub(super) fn explain(&self, failure: statics::Failure, commands: &[Command]) -> SolveError {
        let name = |place: usize| self.robot.cables()[self.layout.order[place]].name.clone();
        match failure {
            statics::Failure::Folds { cable, arc_length, tension, last_load } => {
                SolveError::SectionFolds { cable: name(cable), arc_length, tension, last_load }
            }
            statics::Failure::Unreachable { cable, length } => {
                let initial = self.layout.rest_lengths[cable];
                let requested = match commands[cable] {
                    Command::Length { target, .. } => initial - target,
                    Command::Tension(_) => 0.0,
                };
                SolveError::UnreachableLength {
                    cable: name(cable),
                    requested,
                    reachable: initial - length,
                }
            }
            statics::Failure::Buckled { lost_at, iterations } => {
                SolveError::Buckled { load: lost_at, iterations }
            }
            statics::Failure::NotConverged { iterations, residual, last_load, advice } => {
                // A start from which no section was solved leaves all of the equations.
                let residual = if residual.is_finite() { residual } else { 1.0 };
                SolveError::NotConverged { iterations, residual, last_load, advice }
            }
        }
    }
}

fn refuse_friction(robot: &Robot) -> Result<(), SolveError> {
    let rubs = |cable: &Cable| cable.friction.is_some_and(|coefficient| coefficient > 0.0);
    match robot.cables().iter().position(rubs) {
        None => Ok(()),
        Some(cable) => Err(SolveError::Unsupported {
            model: ModelKind::Cosserat,
            path: format!("cables[{cable}].friction"),
            what: "friction at the holes",
            advice: "its cables slide freely: use cosserat-disks, or set the friction to 0",
        }),
    }
}
