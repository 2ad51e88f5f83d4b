use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use whipcord_numerics::Pose;

use super::friction::{History, Holes};
use super::layout::{Frame, Mesh};
use super::stability_check::{self, Sampled};
use super::statics::{self, Problem, Scratch, Start};
use super::unloaded::Unloaded;
use crate::cancel::Cancel;
use crate::case::{CableCommand, Case, Loads};
use crate::derivatives::{Cables, Derivatives, NoDerivatives, Solved, StraightCables};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::refusal;
use crate::robot::{Cable, Problem as Mistake, Robot, RobotError};
use crate::shape::{CableState, Diagnostics, NoStability, Shape, Solution, Wrench};
use crate::statics::command::Command;
use crate::statics::grid::steps_for_twist;
use crate::statics::loads::{self, AppliedLoads};
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::outcome::{Failure, Found};
use crate::statics::refinement::{Coarse, ERROR_RATIO};
use crate::statics::strength::Strength;
use crate::statics::trace::Trace;
use crate::statics::trace::TraceEvent;

/// Finer meshes that are kept once they were needed.
const FINER_MESHES: usize = 5;
/// Of them the finest on which stability is computed where it has steps enough.
pub(super) const STABILITY_LEVEL: usize = 2;
/// How often the steps may be halved.
pub(super) const MAX_REFINEMENTS: usize = 8;
/// A failure to converge is believed only with steps halved this often.
const GIVE_UP_LEVEL: usize = 4;
/// What an unstable equilibrium could be left for is looked for with steps halved this often.
const LEAVE_LEVEL: usize = 3;
/// Of a shape that is only looked at, on the first mesh.
const COARSE_RESIDUAL: f64 = 1e-6;
/// With so many, the least eigenvalue of a column is known to better than 1e-6.
const STABILITY_STEPS: usize = 16;

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
    robot: Robot,
    frame: Frame,
    /// With hole friction.
    holes: Option<Holes>,
    options: Options,
    /// The only mesh, or the first of a sequence in which the steps are halved.
    mesh: Mesh,
    /// The next of them, made when the first case needs them and shared by all copies of the model.
    finer: Arc<[OnceLock<Mesh>; FINER_MESHES]>,
    /// For the stability of spans near their own buckling load, where no mesh of the sequence serves; made as those.
    fine: Arc<OnceLock<Mesh>>,
    /// With so many steps stability is computed.
    stability_steps: usize,
}

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) commands: Vec<Command>,
    coarse: Coarse,
    coarse_tensions: Vec<f64>,
    histories: Vec<StepHistory>,
}

/// How far the steps of actuation have been walked on a mesh, and what the holes remember there.
#[derive(Clone, Debug, Default)]
struct StepHistory {
    taken: usize,
    history: History,
}

impl Workspace {
    /// What drives each cable, of the case that was accepted last.
    pub(super) fn commands(&self) -> &[Command] {
        &self.commands
    }

    /// Loads of that case.
    pub(super) const fn loads(&self) -> &AppliedLoads {
        &self.scratch.applied
    }

    /// The robot without load.
    pub(super) const fn unloaded_mut(&mut self) -> &mut Unloaded {
        &mut self.scratch.unloaded
    }

    /// Frames at the ends of all steps, the base first.
    pub(super) fn poses(&self) -> &[Pose] {
        &self.scratch.poses
    }

    /// Takes a state for the answer.
    pub(super) fn adopt(
        &mut self,
        poses: &[Pose],
        tensions: &[f64],
        lengths: &[f64],
        base_wrench: Wrench,
    ) {
        let scratch = &mut self.scratch;
        scratch.poses.clear();
        scratch.poses.extend_from_slice(poses);
        scratch.tensions.clear();
        scratch.tensions.extend_from_slice(tensions);
        scratch.lengths.clear();
        scratch.lengths.extend_from_slice(lengths);
        scratch.base_wrench = base_wrench;
    }

    /// Keeps what the answer on a coarse mesh is compared by.
    pub(super) fn keep(&mut self, mesh: &Mesh) {
        self.coarse.keep(&mesh.grid, &self.scratch.poses, &self.scratch.lengths);
        self.coarse_tensions.clone_from(&self.scratch.tensions);
    }

    /// Largest change of a position or a cable's length since then, in m. Where lengths are given
    /// it is the tensions that change, which counts as a fraction of the length.
    pub(super) fn change(&self, mesh: &Mesh, length: f64) -> f64 {
        let moved = self.coarse.change(&mesh.grid, &self.scratch.poses, &self.scratch.lengths);
        let tensions = self.scratch.tensions.iter().zip(&self.coarse_tensions);
        let relative = |(fine, coarse): (&f64, &f64)| {
            length * (fine - coarse).abs() / fine.max(f64::MIN_POSITIVE)
        };
        tensions.filter(|(fine, coarse)| fine != coarse).map(relative).fold(moved, f64::max)
    }
}

impl CosseratDisks {
    /// The model of a robot that may carry loads at the places where `loads` has them.
    ///
    /// # Errors
    /// [`SolveError::Missing`] when the robot's stiffness is not given, and
    /// [`SolveError::Unsupported`] when a cable is anchored between two disks.
    pub fn new(robot: &Robot, loads: &Loads, options: &Options) -> Result<Self, SolveError> {
        refusal::without_disks(ModelKind::CosseratDisks, robot)?;
        let frame = Frame::new(robot, options.stations.arc_lengths(robot), loads)?;
        let steps = match options.accuracy {
            Accuracy::Steps(steps) => steps,
            Accuracy::Tolerance(_) => 1,
        };
        let mesh = frame.mesh(steps, 0)?;
        let has_friction = robot.cables().iter().any(Cable::has_friction);
        let holes = has_friction.then(|| frame.holes(robot));
        let stability_steps = STABILITY_STEPS.max(steps_for_twist(robot));
        let (robot, options) = (robot.clone(), options.clone());
        let (finer, fine) = (Arc::default(), Arc::default());
        Ok(Self { robot, frame, holes, options, mesh, finer, fine, stability_steps })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    pub(crate) fn cancel_mut(&mut self) -> &mut Cancel {
        &mut self.options.cancel
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
    /// Hole friction depends on the history, so that pulling and releasing differ: the steps
    /// [`Case::before`] are taken first, from the robot at rest.
    ///
    /// # Errors
    /// [`SolveError`] with the reason why there is no answer.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        if !case.obstacles.is_empty() {
            let outcome = self.solve_among_obstacles(case, warm_start, workspace);
            return self.options.cancel.checked(outcome);
        }
        let start = warm_start.map_or(Start::Cold, start_from);
        if self.holes.is_none() {
            let case = core::slice::from_ref(case);
            self.check_steps(case, workspace)?;
            return self.solve_last(case, start, workspace);
        }
        case.check(&self.robot)?;
        let steps = one_by_one(case);
        workspace.histories.clear();
        self.check_steps(&steps, workspace)?;
        self.solve_last(&steps, start, workspace)
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
        if !case.obstacles.is_empty() {
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
        let mut start = Start::Cold;
        for n in 0..steps.len() {
            let first = if self.holes.is_some() { 0 } else { n };
            let solution = self
                .check_steps(&steps[n..=n], workspace)
                .and_then(|()| self.solve_last(&steps[first..=n], start, workspace))
                .map_err(|error| (n, error))?;
            start = if self.holes.is_some() { Start::Cold } else { start_from(&solution) };
            each(solution);
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
    /// [`SolveError::Unsupported`] where a cable rubs: pulling and releasing it then give different derivatives; and
    /// [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_with_derivatives(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        refusal::hole_friction(
            ModelKind::CosseratDisks,
            &self.robot,
            "friction at the holes, for compliance and derivatives",
            "with friction the compliance differs between pulling and releasing a cable: set the friction to 0",
        )?;
        refusal::among_obstacles("derivatives", ModelKind::CosseratDisks, case)?;
        let (solution, level) = self.solve_keeping_level(case, warm_start, workspace)?;
        let mesh = self.mesh(level)?;
        let Workspace { scratch, commands, .. } = workspace;
        // Lengths before actuation hang on parameters alone.
        let rest = (!parameters.is_empty()).then(|| self.frame.rest_mesh()).transpose()?;
        let rest = rest.as_ref().map(|mesh| (&mesh.grid, self.frame.straight_spans(mesh)));
        let straight = StraightCables {
            spans: &self.frame.straight_spans(&mesh),
            rest: rest.as_ref().map(|(grid, spans)| (*grid, &spans[..])),
        };
        let order: Vec<usize> = (0..scratch.tensions.len()).collect();
        let taut: Vec<bool> = scratch.tensions.iter().map(|&tension| tension > 0.0).collect();
        let solved = Solved {
            robot: &self.robot,
            case,
            cables: Cables {
                order: &order,
                rest_lengths: &self.frame.rest_lengths,
                straight: Some(straight),
            },
            grid: &mesh.grid,
            loads: &scratch.applied,
            commands,
            tensions: &scratch.tensions,
            taut: &taut,
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts: &scratch.starts(&mesh),
            strains: &[],
            nodes: &mesh.grid.stations,
        };
        match Derivatives::of(&solved, parameters) {
            Ok(derivatives) => Ok((solution, derivatives)),
            Err(NoDerivatives::Parameter(error)) => Err(error.into()),
            // The sections of a rod without cables have no equilibrium to miss.
            Err(NoDerivatives::Critical | NoDerivatives::Fault(_)) => {
                Err(SolveError::NoDerivatives)
            }
        }
    }

    /// The answer to a case without obstacles and hole friction, and how often the steps of its mesh are halved.
    pub(super) fn solve_keeping_level(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, usize), SolveError> {
        let cases = core::slice::from_ref(case);
        self.check_steps(cases, workspace)?;
        let start = warm_start.map_or(Start::Cold, start_from);
        let solved = self.solve_keeping_mesh(cases, start, workspace);
        self.options.cancel.checked(solved)
    }

    /// The shape on the first mesh, whether it is stable or not; it is left in the workspace.
    pub(super) fn solve_coarsely(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        self.accept(case, &self.mesh, workspace)?;
        let Workspace { scratch, commands, .. } = workspace;
        let problem = Problem {
            stability: StabilityAnalysis::Off,
            tolerance: COARSE_RESIDUAL,
            ..self.problem(&self.mesh, commands, case)?
        };
        let found = statics::solve(&problem, &Start::Cold, scratch);
        let solved = found.map(|_| ()).map_err(|failure| self.explain(failure, commands));
        self.options.cancel.checked(solved)
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
    /// not walked again.
    fn solve_last(
        &self,
        cases: &[Case],
        start: Start,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let outcome = self.solve_keeping_mesh(cases, start, workspace);
        self.options.cancel.checked(outcome.map(|(solution, _)| solution))
    }

    /// The answer, and how often the steps of its mesh are halved.
    fn solve_keeping_mesh(
        &self,
        cases: &[Case],
        start: Start,
        workspace: &mut Workspace,
    ) -> Result<(Solution, usize), SolveError> {
        match self.options.accuracy {
            Accuracy::Steps(_) => {
                let mesh = &self.mesh;
                let found = self.solve_on(0, mesh, cases, &start, workspace)?;
                Ok((self.solution(mesh, cases, workspace, found, None), 0))
            }
            Accuracy::Tolerance(tolerance) => self.solve_to(tolerance, cases, start, workspace),
        }
    }

    /// Halves the steps until the answer changes no more.
    fn solve_to(
        &self,
        tolerance: f64,
        cases: &[Case],
        mut start: Start,
        workspace: &mut Workspace,
    ) -> Result<(Solution, usize), SolveError> {
        let length = self.robot.backbone().length;
        let tolerance = tolerance * length;
        let (mut error, mut steps, mut iterations) = (f64::INFINITY, 0, 0);
        let mut lost_at = None;
        let mut coarser = false;
        for level in self.first_level(cases, workspace)..=MAX_REFINEMENTS {
            let mesh = self.mesh(level)?;
            let found = match self.solve_on(level, &mesh, cases, &start, workspace) {
                // Steps that are too coarse for a strong bend can keep Newton's method away.
                Err(
                    SolveError::NotConverged { .. }
                    | SolveError::TensionsNotFound
                    | SolveError::SectionFolds { .. }
                    | SolveError::UnreachableLength { .. },
                ) if !coarser && level < GIVE_UP_LEVEL && !self.options.cancel.is_cancelled() => {
                    continue;
                }
                other => other?,
            };
            iterations += found.iterations;
            // A stable branch may not be there on coarse steps, or in another place.
            if workspace.scratch.unstable
                && self.options.stability != StabilityAnalysis::Off
                && level < LEAVE_LEVEL
            {
                continue;
            }
            lost_at = lost_at.or(found.lost_at);
            if coarser {
                error = workspace.change(&mesh, length) / ERROR_RATIO;
                if error <= tolerance {
                    let found = Found { iterations, lost_at, ..found };
                    let solution = self.solution(&mesh, cases, workspace, found, Some(error));
                    return Ok((solution, level));
                }
            }
            workspace.keep(&mesh);
            start = Start::Coarser;
            (steps, coarser) = (mesh.grid.len(), true);
        }
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }

    /// The mesh whose steps are halved so often; where the steps are prescribed, the only one.
    pub(super) fn mesh(&self, level: usize) -> Result<Cow<'_, Mesh>, SolveError> {
        if let Some(mesh) = self.kept_mesh(level)? {
            return Ok(Cow::Borrowed(mesh));
        }
        Ok(Cow::Owned(self.frame.mesh(1, level)?))
    }

    /// The same, made and kept; `None` for one that is too fine to be kept.
    fn kept_mesh(&self, level: usize) -> Result<Option<&Mesh>, SolveError> {
        let Some(place) = level.checked_sub(1) else { return Ok(Some(&self.mesh)) };
        let Some(slot) = self.finer.get(place) else { return Ok(None) };
        made(slot, || self.frame.mesh(1, level)).map(Some)
    }

    /// The meshes on which stability is computed: for the usual case the first of the sequence with steps enough.
    fn sampled(&self) -> Result<Sampled<'_>, SolveError> {
        let is_sequence = matches!(self.options.accuracy, Accuracy::Tolerance(_));
        let finest = if is_sequence { STABILITY_LEVEL } else { 0 };
        let has_enough = |level: &usize| self.mesh.grid.len() << level >= self.stability_steps;
        let of_sequence = |level| self.kept_mesh(level).map(|mesh| mesh.unwrap_or(&self.mesh));
        let fine = if is_sequence && has_enough(&finest) {
            of_sequence(finest)?
        } else {
            made(&self.fine, || self.frame.mesh(self.stability_steps.div_ceil(4), 2))?
        };
        let usual = (0..=finest).find(has_enough).map(of_sequence).transpose()?;
        Ok(Sampled { usual: usual.unwrap_or(fine), fine })
    }

    /// How often the steps of the first mesh are halved before anything is tried: until they see the layer in which
    /// the greatest force of the cases bends the rod.
    pub(super) fn first_level(&self, cases: &[Case], workspace: &mut Workspace) -> usize {
        let grid = &self.mesh.grid;
        let applied = &mut workspace.scratch.applied;
        let mut of_case = |case: &Case| {
            applied.gather(grid, &case.loads, case.base.rotation);
            Strength::of(applied, grid, self.robot.backbone().length).first_level()
        };
        let first = cases.iter().filter(|case| !case.loads.is_none()).map(&mut of_case).max();
        first.map_or(0, |level| level.min(GIVE_UP_LEVEL))
    }

    /// The answer to the last step on one mesh. What holes remember depends on the mesh: the whole way
    /// is gone on each.
    fn solve_on(
        &self,
        level: usize,
        mesh: &Mesh,
        cases: &[Case],
        start: &Start,
        workspace: &mut Workspace,
    ) -> Result<Found, SolveError> {
        let Workspace { scratch, commands, histories, .. } = workspace;
        if histories.len() <= level {
            histories.resize(level + 1, StepHistory::default());
        }
        // Where a step fails the way starts anew.
        let StepHistory { taken, history } = core::mem::take(&mut histories[level]);
        let taken = if self.holes.is_some() { taken } else { 0 };
        scratch.history = if taken > 0 { history } else { History::default() };
        let mut found = Found::default();
        for (n, case) in cases.iter().enumerate().skip(taken) {
            scratch.applied.gather(&mesh.grid, &case.loads, case.base.rotation);
            self.commands(case, commands)?;
            let problem = self.problem(mesh, commands, case)?;
            // What a coarser mesh found is that of the last step.
            let start = if n + 1 == cases.len() { start } else { &Start::Cold };
            found = statics::solve(&problem, start, scratch)
                .map_err(|failure| self.explain(failure, commands))?;
        }
        histories[level] = StepHistory { taken: cases.len(), history: scratch.history.clone() };
        Ok(found)
    }

    pub(super) fn problem<'a>(
        &'a self,
        mesh: &'a Mesh,
        commands: &'a [Command],
        case: &'a Case,
    ) -> Result<Problem<'a>, SolveError> {
        Ok(Problem {
            frame: &self.frame,
            mesh,
            commands,
            tolerance: self.options.greatest_residual(),
            cancel: &self.options.cancel,
            holes: self.holes.as_ref(),
            case,
            sampled: self.sampled()?,
            stability: self.options.stability,
        })
    }

    /// What drives each cable.
    fn commands(&self, case: &Case, commands: &mut Vec<Command>) -> Result<(), SolveError> {
        commands.clear();
        for (cable, &initial) in self.frame.rest_lengths.iter().enumerate() {
            let actuation = self.options.actuation;
            let kind = ModelKind::CosseratDisks;
            commands.push(Command::of(kind, &self.robot, cable, case, actuation, initial)?);
        }
        Ok(())
    }

    pub(super) fn solution(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        workspace: &mut Workspace,
        found: Found,
        discretization_error: Option<f64>,
    ) -> Solution {
        let case = cases.last();
        let base = case.map_or(Pose::IDENTITY, |case| case.base);
        let verdict = case.map_or(Err(NoStability::NotAsked), |case| {
            // The meshes that it takes were made for the answer.
            let problem = self.problem(mesh, &workspace.commands, case);
            let problem = problem.map_err(|_| NoStability::Undetermined)?;
            stability_check::stability(&problem, &mut workspace.scratch)
        });
        let scratch = &workspace.scratch;
        let shape = |arc_lengths: &[f64], places: &[usize]| {
            let poses = places.iter().map(|&k| scratch.poses[k]).collect();
            Shape { arc_length: arc_lengths.to_vec(), poses }.moved(base)
        };
        let backbone = self.robot.backbone().length;
        let cables = self.robot.cables().iter().enumerate().map(|(i, cable)| {
            let (tension, length) = (scratch.tensions[i], scratch.lengths[i]);
            let initial = self.frame.rest_lengths[i];
            CableState {
                span_tensions: self.at_holes(i, &scratch.history.tensions),
                slip_states: self.at_holes(i, &scratch.history.slip_states),
                ..workspace.commands[i].answer(&cable.name, tension, length, initial, backbone)
            }
        });
        Solution {
            model: ModelKind::CosseratDisks,
            shape: shape(self.frame.layout.stations(), &mesh.grid.stations),
            disks: shape(&self.robot.disks().arc_lengths, &mesh.grid.disks),
            cables: cables.collect(),
            base_wrench: Some(scratch.base_wrench),
            contacts: Vec::new(),
            diagnostics: Diagnostics {
                iterations: found.iterations,
                residual: found.residual,
                discretization_error,
                steps: mesh.grid.len(),
                stability_lost_at: found.lost_at,
                ..Diagnostics::default()
            }
            .with_stability(verdict),
        }
    }

    /// The values that a cable with friction has at its holes in the disks, of those of all passages.
    fn at_holes<T: Copy>(&self, cable: usize, of_passages: &[T]) -> Vec<T> {
        let has_friction = |holes: &&Holes| holes.coefficients[cable] > 0.0;
        let holes = self.holes.as_ref().filter(has_friction);
        holes.map_or_else(Vec::new, |holes| {
            holes.of_cable[cable].iter().map(|&p| of_passages[p]).collect()
        })
    }

    pub(super) fn explain(&self, failure: Failure, commands: &[Command]) -> SolveError {
        let name = |cable: usize| self.robot.cables()[cable].name.clone();
        failure.explain(commands, &self.frame.rest_lengths, name)
    }
}

/// What a slot holds, made where it is empty.
fn made(
    slot: &OnceLock<Mesh>,
    make: impl FnOnce() -> Result<Mesh, SolveError>,
) -> Result<&Mesh, SolveError> {
    if let Some(mesh) = slot.get() {
        return Ok(mesh);
    }
    let mesh = make()?;
    Ok(slot.get_or_init(|| mesh))
}

/// The steps of a case, each without those before it.
fn one_by_one(case: &Case) -> Vec<Case> {
    let step = |commands: &Vec<CableCommand>| Case {
        commands: commands.clone(),
        loads: case.loads.clone(),
        base: case.base,
        before: Vec::new(),
        obstacles: Vec::new(),
    };
    case.before.iter().chain([&case.commands]).map(step).collect()
}

fn start_from(solution: &Solution) -> Start {
    let to_base = solution.disks.poses.first().map_or(Pose::IDENTITY, Pose::inverse);
    Start::From {
        tensions: solution.cables.iter().map(|cable| cable.tension.unwrap_or(0.0)).collect(),
        // As the base sees them.
        disks: solution.disks.poses.iter().map(|pose| to_base * *pose).collect(),
        base: solution.base_wrench,
        stable: !solution.diagnostics.is_unstable(),
    }
}
