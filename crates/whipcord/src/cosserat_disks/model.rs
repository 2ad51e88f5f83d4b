use std::sync::{Arc, OnceLock};

use super::layout::{Frame, Mesh};
use super::levels::{FINER_MESHES, Refined, STABILITY_STEPS};
use super::problem::{Problem, Start};
use super::statics;
use super::workspace::{Progress, Workspace};
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::{Case, Loads};
use crate::contact::{RodSolves as _, WatchedPlaces};
use crate::derivatives::{Cables, Derivatives, NoDerivatives, RestChanges, Solved, StraightCables};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::refusal;
use crate::robot::{Cable, Problem as Mistake, Robot, RobotError};
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::friction::Holes;
use crate::statics::grid::steps_for_twist;
use crate::statics::loads;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::outcome::Failure;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::statics::trace::Trace;
use crate::statics::trace::TraceEvent;
use crate::warm_start::{Status, WarmStart};

/// Of a shape that is only looked at, on the first mesh.
const COARSE_RESIDUAL: f64 = 1e-6;

/// The Cosserat rod with cables that run straight from hole to hole, built for one robot.
///
/// ```
/// use whipcord::cosserat_disks::{CosseratDisks, Options, Workspace};
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
/// let model = CosseratDisks::new(&robot, &Loads::default(), &Options::default())?;
/// let mut workspace = Workspace::default();
/// let solution = model.solve(&Case::with_tensions(&[3.0]), None, &mut workspace)?;
/// // From hole to hole the cable takes a shortcut, farther from the bent backbone than its holes
/// // are: it bends the rod more than a continuous one would, here by three per cent.
/// let bend = 0.18 * 3.0 * 0.008 / (1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0);
/// let ratio = solution.disks.tip().rotation.log().norm() / bend;
/// assert!((0.9..1.1).contains(&ratio) && ratio != 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CosseratDisks {
    pub(super) robot: Robot,
    pub(super) frame: Frame,
    /// With hole friction.
    pub(super) holes: Option<Holes>,
    pub(super) options: Options,
    /// The only mesh, or the first of a sequence in which the steps are halved.
    pub(super) mesh: Mesh,
    /// The next of them, made when the first case needs them and shared by all copies of the model.
    pub(super) finer: Arc<[OnceLock<Mesh>; FINER_MESHES]>,
    /// Where it is watched for obstacles, kept when the first case with some needs it and shared by all copies of the model.
    pub(super) watched: Arc<OnceLock<WatchedPlaces>>,
    /// How the lengths of the cables before actuation change with parameters, as far as they were asked for.
    pub(super) rest_changes: Arc<RestChanges>,
    /// For the stability of spans near their own buckling load, where no mesh of the sequence serves; made as those.
    pub(super) fine: Arc<OnceLock<Mesh>>,
    /// With so many steps stability is computed.
    pub(super) stability_steps: usize,
    /// What earlier steps of actuation left in a backbone with friction against bending.
    pub(super) plastic: Option<PlasticCurvature>,
}

impl CosseratDisks {
    /// The model of a robot that may carry loads at the places where `loads` has them.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the robot's stiffness or its disks are not given.
    pub fn new(robot: &Robot, loads: &Loads, options: &Options) -> Result<Self, SolveError> {
        refusal::without_disks(ModelKind::CosseratDisks, robot)?;
        options.check(robot)?;
        let frame = Frame::new(robot, options.stations.arc_lengths(robot), loads)?;
        let steps = match options.accuracy {
            Accuracy::Steps(steps) => steps,
            Accuracy::Tolerance(_) => 1,
        };
        let mesh = frame.mesh(steps, 0)?;
        let has_friction = robot.cables().iter().any(Cable::has_friction);
        let holes = has_friction.then(|| frame.holes(robot, &mesh));
        let stability_steps = STABILITY_STEPS.max(steps_for_twist(robot));
        let (robot, options) = (robot.clone(), options.clone());
        let (finer, fine) = (Arc::default(), Arc::default());
        let plastic = None;
        Ok(Self {
            robot,
            frame,
            holes,
            options,
            mesh,
            finer,
            watched: Arc::default(),
            rest_changes: Arc::default(),
            fine,
            stability_steps,
            plastic,
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
        self.frame.layout.stations()
    }

    /// Whether these loads have their points where the model was built for them.
    #[must_use]
    pub fn takes_places_of(&self, loads: &Loads) -> bool {
        self.frame.layout.has_loads_of(loads)
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
    ///
    /// Hole friction, and friction against bending of the backbone, depends on the history, so that pulling and releasing differ:
    /// the steps [`Case::before`] are taken first, from the robot at rest, whatever solution is given.
    ///
    /// # Errors
    /// [`SolveError`] with the reason why there is no answer.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::CosseratDisks);
        let status = self.solve_into(case, warm_start.into(), workspace, &mut solution)?;
        workspace.meter.answered((status, solution))
    }

    /// [`Self::solve`] into memory that is at hand: without obstacles and hole friction and after the first call nothing is
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
        let outcome = if self.holes.is_none() {
            self.solve_from(core::slice::from_ref(case), from, workspace, solution)
        } else {
            case.check(&self.robot)?;
            workspace.histories.clear();
            workspace.courses.clear();
            let steps = one_by_one(case);
            let leading = if case.independent { steps.len() - 1 } else { 0 };
            solution.plastic_curvature.clear();
            self.solve_from(&steps[leading..], from, workspace, solution)
        };
        match workspace.meter.checked(outcome) {
            Ok(_) => Ok(Status::Converged),
            Err(error @ SolveError::BudgetSpent { .. }) => {
                let written = self.write_best(case, workspace, solution)?;
                if written { Ok(Status::BudgetSpent) } else { Err(error) }
            }
            Err(error) => Err(error),
        }
    }

    /// The answer to the last of several steps, and how often the steps of its mesh are halved.
    pub(super) fn solve_from(
        &self,
        cases: &[Case],
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<usize, SolveError> {
        self.check_steps(cases, workspace)?;
        let mut neighbour = core::mem::take(&mut workspace.neighbour);
        let start = match from.given(solution) {
            Some(answer) => {
                neighbour.set(answer);
                Start::Near(&neighbour)
            }
            None => Start::Cold,
        };
        let solved = self.solve_last(cases, start, workspace, solution);
        workspace.neighbour = neighbour;
        solved
    }

    /// [`CosseratDisks::solve`], with a record of the iterations, whether they lead to an answer or not. Without
    /// load, and with the tensions given, every span stands for itself and there is nothing to record.
    pub fn solve_traced(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> (Result<Solution, SolveError>, Vec<TraceEvent>) {
        let trace = &mut workspace.scratch.chain.trace;
        *trace = Trace { is_on: true, ..Trace::default() };
        let outcome = self.solve(case, warm_start, workspace);
        let mut events = core::mem::take(&mut workspace.scratch.chain.trace).events;
        if let Some(holes) = &self.holes {
            // Of the tensions of all passages those next to the base.
            for event in &mut events {
                let first = |passages: &Vec<usize>| event.tensions[passages[0]];
                event.tensions = holes.of_cable.iter().map(first).collect();
            }
        }
        (outcome, events)
    }

    /// The answers to all steps of a case in order, each from where the one before left the robot:
    /// those of [`CosseratDisks::solve`] to each of [`Case::steps`], in time that grows with their
    /// number, not with its square. `each` gets them as they come.
    ///
    /// # Errors
    /// The number of the first step without an answer, from 0, and why it has none.
    pub fn solve_steps(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        if case.independent {
            for (n, step) in case.single_steps().enumerate() {
                each(self.solve(&step, None, workspace).map_err(|error| (n, error))?);
            }
            return Ok(());
        }
        if self.bends_in_steps() {
            return self.solve_steps_with_bending_friction(case, workspace, each);
        }
        if !case.obstacles.is_empty() {
            if self.holes.is_some() && !case.independent {
                workspace.meter.start(&self.options.cancel, self.options.budget);
                return self.rub_among_obstacles(case, workspace, each);
            }
            let mut last = None;
            for (n, step) in case.single_steps().enumerate() {
                let solution =
                    self.solve(&step, last.as_ref(), workspace).map_err(|error| (n, error))?;
                each(last.insert(solution).clone());
            }
            return Ok(());
        }
        let steps = one_by_one(case);
        workspace.histories.clear();
        workspace.courses.clear();
        let mut last: Option<Solution> = None;
        for n in 0..steps.len() {
            let first = if self.holes.is_some() { 0 } else { n };
            workspace.meter.start(&self.options.cancel, self.options.budget);
            let mut solution = Solution::empty(ModelKind::CosseratDisks);
            // What holes remember is that of the steps before, which are not walked again.
            let from = last.as_ref().filter(|_| self.holes.is_none()).into();
            let solved = self
                .check_steps(&steps[n..=n], workspace)
                .and_then(|()| self.solve_from(&steps[first..=n], from, workspace, &mut solution));
            workspace.meter.checked(solved).map_err(|error| (n, error))?;
            each(last.insert(solution).clone());
        }
        Ok(())
    }

    /// Refuses steps that the model cannot take.
    fn check_steps(&self, cases: &[Case], workspace: &mut Workspace) -> Result<(), SolveError> {
        for case in cases {
            case.check(&self.robot)?;
            loads::check(&self.robot, &case.loads)
                .map_err(|error| error.of(ModelKind::CosseratDisks))?;
            if !self.takes_places_of(&case.loads) {
                let problem = Mistake::LoadPlaces;
                return Err(RobotError { path: "loads".to_owned(), problem }.into());
            }
            self.commands(case, &mut workspace.commands)?;
        }
        Ok(())
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
        if let Some(holes) = self.holes.as_ref().filter(|_| case.obstacles.is_empty()) {
            return self.solve_sliding_with_derivatives(holes, case, parameters, workspace);
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
        let (solution, level) = self.solve_keeping_level(case, warm_start, workspace)?;
        let mesh = self.mesh(level)?;
        let derivatives = self.derivatives(case, &mesh, &[], parameters, workspace)?;
        Ok((solution, derivatives))
    }

    /// The derivatives of the answer that the workspace holds; `history` is how the plastic curvature before it changes with each
    /// parameter.
    pub(super) fn derivatives(
        &self,
        case: &Case,
        mesh: &Mesh,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
        workspace: &Workspace,
    ) -> Result<Derivatives, SolveError> {
        // Lengths before actuation hang on parameters alone.
        let is_known = self.rest_changes.know(parameters);
        let rest = (!is_known).then(|| self.frame.rest_mesh()).transpose()?;
        let of =
            |solved: &Solved<'_>| Derivatives::of(solved, parameters).map(Derivatives::settled);
        match self.with_answer(case, mesh, (rest.as_ref(), history), workspace, of) {
            Ok(derivatives) => Ok(derivatives),
            Err(NoDerivatives::Parameter(error)) => Err(error.into()),
            // The sections of a rod without cables have no equilibrium to miss.
            Err(NoDerivatives::Critical | NoDerivatives::Fault(_)) => {
                Err(SolveError::NoDerivatives)
            }
        }
    }

    /// The answer that the workspace holds, as it is gone over once more; with the mesh on which the rod at rest is known where
    /// lengths before actuation are asked for.
    pub(super) fn with_answer<T>(
        &self,
        case: &Case,
        mesh: &Mesh,
        (rest, history): (Option<&Mesh>, &[PlasticCurvature]),
        workspace: &Workspace,
        act: impl FnOnce(&Solved<'_>) -> T,
    ) -> T {
        let Workspace { scratch, commands, .. } = workspace;
        let spans = |mesh| self.frame.straight_spans(mesh).collect::<Vec<_>>();
        let rest = rest.map(|mesh| (&mesh.grid, spans(mesh)));
        let mut of_answer = spans(mesh);
        if self.holes.is_some() {
            for (straight, span) in of_answer.iter_mut().zip(&self.frame.spans) {
                straight.tensions = Some(&scratch.pulled[span.first..][..span.passages.len()]);
            }
        }
        let straight = StraightCables {
            spans: &of_answer,
            rest: rest.as_ref().map(|(grid, spans)| (*grid, &spans[..])),
        };
        // Friction against bending keeps its history at all nodes.
        let all: Vec<usize> = (0..=mesh.grid.len()).collect();
        let order: Vec<usize> = (0..scratch.tensions.len()).collect();
        let mut starts = Vec::new();
        scratch.starts_into(&self.frame, mesh, &mut starts);
        let taut: Vec<bool> = scratch.tensions.iter().map(|&tension| tension > 0.0).collect();
        act(&Solved {
            robot: &self.robot,
            case,
            cables: Cables {
                order: &order,
                rest_lengths: &self.frame.rest_lengths,
                straight: Some(straight),
                rest_changes: Some(&*self.rest_changes),
            },
            grid: &mesh.grid,
            loads: &scratch.applied,
            commands,
            tensions: &scratch.tensions,
            taut: &taut,
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts: &starts,
            strains: &[],
            are_strains_met: false,
            history,
            nodes: if self.robot.has_bending_friction() { &all } else { &mesh.grid.stations },
            sliding: None,
            open: None,
        })
    }

    /// The answer to a case without obstacles and hole friction, and how often the steps of its mesh are halved.
    pub(super) fn solve_keeping_level(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, usize), SolveError> {
        let mut solution = Solution::empty(ModelKind::CosseratDisks);
        let cases = core::slice::from_ref(case);
        let solved = self.solve_from(cases, warm_start.into(), workspace, &mut solution);
        let level = workspace.meter.checked(solved)?;
        Ok((solution, level))
    }

    /// The shape on the first mesh, whether it is stable or not; it is left in the workspace.
    pub(super) fn solve_coarsely(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        self.accept(case, &self.mesh, workspace)?;
        let Workspace { scratch, commands, meter, .. } = workspace;
        let meter = &*meter;
        let problem = Problem {
            stability: StabilityAnalysis::Off,
            tolerance: COARSE_RESIDUAL,
            ..self.problem(&self.mesh, (commands, meter), case)?
        };
        let found = statics::solve(&problem, Start::Cold, scratch);
        let solved = found.map(|_| ()).map_err(|failure| self.explain(failure, commands));
        workspace.meter.checked(solved)
    }

    /// Checks a case, and gathers its commands and loads on a mesh.
    pub(super) fn accept(
        &self,
        case: &Case,
        mesh: &Mesh,
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        self.check_steps(core::slice::from_ref(case), workspace)?;
        workspace.scratch.applied.gather(&mesh.grid, &case.loads, case.base.rotation);
        Ok(())
    }

    pub(super) const fn frame(&self) -> &Frame {
        &self.frame
    }

    pub(super) const fn options(&self) -> &Options {
        &self.options
    }

    /// The answer to the last of several checked steps; those before it that were walked on a mesh already are
    /// not walked again. How often the steps of its mesh are halved.
    fn solve_last(
        &self,
        cases: &[Case],
        start: Start<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<usize, SolveError> {
        workspace.progress = Progress::default();
        workspace.scratch.open = None;
        let Refined { found, level, error } = match self.options.accuracy {
            Accuracy::Steps(_) => {
                let found = self.solve_on(0, &self.mesh, cases, start, workspace)?;
                Refined { found, level: 0, error: None }
            }
            Accuracy::Tolerance(tolerance) => self.solve_to(tolerance, cases, start, workspace)?,
        };
        let walked = workspace.histories.get(level).filter(|_| self.holes.is_some());
        let plastic = walked.map_or_else(Vec::new, |walked| walked.plastic.clone());
        match &plastic[..] {
            [] | [_] => self.write(&*self.mesh(level)?, cases, workspace, (found, error), solution),
            [.., before, _] => {
                // Its stability is that of the last step.
                let mut bent = self.clone();
                bent.set_plastic(before.clone());
                bent.write(&*bent.mesh(level)?, cases, workspace, (found, error), solution);
            }
        }
        let left = plastic.last().map(|left| left.at_stations(self.stations()));
        solution.plastic_curvature = left.unwrap_or_default();
        Ok(level)
    }

    pub(super) fn problem<'a>(
        &'a self,
        mesh: &'a Mesh,
        (commands, meter): (&'a [Command], &'a Meter),
        case: &'a Case,
    ) -> Result<Problem<'a>, SolveError> {
        Ok(Problem {
            frame: &self.frame,
            mesh,
            commands,
            tolerance: self.options.greatest_residual(),
            meter,
            holes: self.holes.as_ref(),
            case,
            sampled: self.sampled()?,
            stability: self.options.stability,
        })
    }

    /// What drives each cable.
    pub(super) fn commands(
        &self,
        case: &Case,
        commands: &mut Vec<Command>,
    ) -> Result<(), SolveError> {
        commands.clear();
        for (cable, &initial) in self.frame.rest_lengths.iter().enumerate() {
            let actuation = self.options.actuation;
            let kind = ModelKind::CosseratDisks;
            commands.push(Command::of(kind, &self.robot, cable, case, actuation, initial)?);
        }
        Ok(())
    }

    pub(super) fn explain(&self, failure: Failure, commands: &[Command]) -> SolveError {
        let name = |cable: usize| self.robot.cables()[cable].name.clone();
        failure.explain(commands, &self.frame.rest_lengths, name)
    }
}

/// The steps of a case, each without those before it.
fn one_by_one(case: &Case) -> Vec<Case> {
    let bare = |step: Case| Case { motors: Vec::new(), obstacles: Vec::new(), ..step };
    case.single_steps().map(bare).collect()
}
