//! Commands that bring a robot to a target.

use whipcord::{
    Cancel, Case, Model, ModelKind, Robot, Shortening, Solution, SolveError, Stations, Vec3,
};

use crate::actuator::{
    Actuator, Actuators, CommandedBy, commanded_shortening, knows_tensions, write_commands,
};
use crate::atlas::{Atlas, AtlasRows, Survey};
use crate::certificate::NoProof;
use crate::descent::{Control, Ending, Workspace};
use crate::error::{InverseError, TargetProblem};
use crate::forward::{Evaluation, Forward, on_few_steps};
use crate::limit::{Clearance, Constraints, Limit};
use crate::limits::{CableLimits, Limits};
use crate::options::{Preference, ReachOptions, ReachStatus};
use crate::redundancy::{self, Redundancy};
use crate::search::{Candidate, Search};
use crate::target::{Miss, Target, Tolerance};

/// The answer to an inverse problem.
#[derive(Clone, Debug)]
pub struct Reached {
    /// What became of the target.
    pub status: ReachStatus,
    /// The command of each actuator: N, m or rad.
    pub commands: Vec<f64>,
    /// The case with these commands.
    pub case: Case,
    /// The shape under these commands, from a solve from rest.
    pub solution: Solution,
    /// How far it is from the target.
    pub miss: Miss,
    /// No command within the limits brings the tip nearer to the target than this, in m, where that is proven.
    pub lower_bound: Option<f64>,
    /// Why there is no proof, where one was asked for.
    pub no_proof: Option<NoProof>,
    /// The limits that the answer meets.
    pub active_limits: Vec<Limit>,
    /// Orthonormal directions of the commands, in units of a change that bends the robot by half a turn, that do not move what the target is for: each by actuators, in N, m or rad.
    pub null_space: Vec<Vec<f64>>,
    /// Starts of the iteration.
    pub starts: usize,
    /// Solves of the model.
    pub solves: usize,
}

impl Reached {
    /// The case with these commands, and with tensions and shortenings that agree with them where another case of the robot has both: it
    /// is then one for all models, as the other case was.
    #[must_use]
    pub fn case_beside(&self, robot: &Robot, other: &Case) -> Case {
        let mut case = self.case.clone();
        let states = self.solution.cables.iter().enumerate();
        for ((cable, state), (command, old)) in
            states.zip(case.commands.iter_mut().zip(&other.commands))
        {
            if command.tension.is_none() && old.tension.is_some() {
                command.tension = state.tension;
            }
            if let (None, Some(old)) = (command.shortening, old.shortening) {
                let shortening = commanded_shortening(robot, cable, state);
                command.shortening = Some(match old {
                    Shortening::Fraction(_) => {
                        Shortening::Fraction(shortening / state.initial_length)
                    }
                    Shortening::Length(_) => Shortening::Length(shortening),
                });
            }
        }
        case
    }
}

/// Solves inverse problems of one robot. It keeps the model, and the shapes that it starts from.
pub struct InverseSolver {
    model: Model,
    /// Where shapes are compared with obstacles.
    stations: Stations,
    case: Case,
    limits: Limits,
    forward: Forward,
    ranges: Ranges,
    /// Whether each bound of an unknown was not given: least, greatest.
    assumed: Vec<[bool; 2]>,
    knows_tensions: bool,
    atlas: Option<Atlas>,
    workspace: Workspace,
}

/// A range that is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchRange {
    /// What varies.
    pub actuator: Actuator,
    /// Least and greatest, in N, m or rad.
    pub range: [f64; 2],
    /// Whether each of the two was assumed because no limit is given.
    pub assumed: [bool; 2],
}

/// Least and greatest of the unknowns, and of the values of the actuators.
#[derive(Clone, Debug)]
pub(crate) struct Ranges {
    pub unknowns: Vec<[f64; 2]>,
    pub values: Vec<[f64; 2]>,
}

/// Rows of an atlas where the batch has vectors for them, and elsewhere.
const ROWS_OF_LANES: usize = 20_000;
const ROWS: usize = 2_000;
/// Rows of an atlas, and starts from it, of a robot that remembers the steps before: each solve goes through them.
const ROWS_WITH_HISTORY: usize = 200;
const STARTS_WITH_HISTORY: usize = 6;
/// Rows of a survey of the workspace where the batch has no vectors for them: of a rod, which takes some tens of µs for each, and of other models.
const ROWS_OF_LOADED_RODS: usize = 40_000;
const ROWS_OF_A_SURVEY: usize = 10_000;
/// Stations between which obstacles are not looked for, of each part between two disks.
const STATIONS: usize = 61;
/// Steps along the null space to the preferred commands, and at a point of a path, where the points before have led near to them.
const STEPS: usize = 40;
const STEPS_ON_PATH: usize = 2;
/// Evaluations of one start.
const EVALUATIONS: usize = 80;
/// Starts that end at the same nearest point before it is taken for one.
const AGREEING: usize = 5;

impl InverseSolver {
    /// For a model of a robot, whose loads, base, obstacles and steps before are those of the case.
    ///
    /// # Errors
    /// [`InverseError`] where there is nothing to command, where limits do not fit the robot, and where the model refuses the robot.
    pub fn new(
        model: &Model,
        robot: &Robot,
        case: &Case,
        limits: &Limits,
        by: CommandedBy,
    ) -> Result<Self, InverseError> {
        limits.check(robot.cables().len())?;
        let list = Actuator::of(robot, case, model.kind(), by)?;
        let knows_tensions = knows_tensions(model.kind());
        let actuators = Actuators::new(robot, case, list, knows_tensions);
        let stations = match case.obstacles.is_empty() {
            true => Stations::Disks,
            false => Stations::Equal(STATIONS),
        };
        let model = model.at(stations.clone());
        let forward = Forward::new(&model, robot, case, actuators)?;
        let actuators = &forward.actuators;
        let ranges = Ranges {
            unknowns: actuators.bounds(&actuators.list, robot, limits),
            values: actuators.bounds(&actuators.asked, robot, limits),
        };
        let mut solver = Self {
            ranges,
            assumed: Vec::new(),
            model,
            stations,
            case: case.clone(),
            limits: limits.clone(),
            forward,
            knows_tensions,
            atlas: None,
            workspace: Workspace::default(),
        };
        solver.assume_bounds();
        Ok(solver)
    }

    /// The unknown commands, in the order of [`Reached::commands`].
    #[must_use]
    pub fn actuators(&self) -> &[Actuator] {
        &self.forward.actuators.asked
    }

    /// What is searched: the ranges of the tensions where every actuator moves one cable, else of the commands.
    #[must_use]
    pub fn search_ranges(&self) -> Vec<SearchRange> {
        let robot = self.forward.robot();
        let actuators = &self.forward.actuators;
        let of = |((actuator, bounds), assumed): ((&Actuator, &[f64; 2]), &[bool; 2])| {
            let [a, b] = bounds.map(|bound| actuators.command(robot, *actuator, bound));
            let (range, assumed) =
                if a <= b { ([a, b], *assumed) } else { ([b, a], [assumed[1], assumed[0]]) };
            SearchRange { actuator: *actuator, range, assumed }
        };
        actuators.list.iter().zip(&self.ranges.unknowns).zip(&self.assumed).map(of).collect()
    }

    /// Where no limit is given, commands up to those that alone bend the robot by a whole turn.
    fn assume_bounds(&mut self) {
        for (bounds, scale) in self.ranges.unknowns.iter_mut().zip(&self.forward.scales) {
            let assumed = [!bounds[0].is_finite(), !bounds[1].is_finite()];
            if assumed[0] {
                bounds[0] = (-2.0 * scale).min(bounds[1]);
            }
            if assumed[1] {
                bounds[1] = (2.0 * scale).max(bounds[0]);
            }
            self.assumed.push(assumed);
        }
        if self.forward.actuators.are_direct() {
            self.ranges.values.clone_from(&self.ranges.unknowns);
        }
    }

    /// Lets this flag end the solves.
    pub fn set_cancel(&mut self, cancel: &Cancel) {
        self.model = self.model.cancelled_by(cancel);
        self.forward.set_cancel(cancel);
    }

    /// Takes the commands of this case in place of those of its own: searches start from them. All else stays.
    pub fn start_at(&mut self, case: &Case) {
        self.case.commands.clone_from(&case.commands);
        self.case.motors.clone_from(&case.motors);
    }

    /// The unknowns that the case commands.
    pub(crate) fn commanded(&mut self) -> Vec<f64> {
        self.forward.commanded(&self.case)
    }

    pub(crate) const fn forward(&self) -> &Forward {
        &self.forward
    }

    pub(crate) const fn forward_mut(&mut self) -> &mut Forward {
        &mut self.forward
    }

    pub(crate) const fn limits(&self) -> &Limits {
        &self.limits
    }

    pub(crate) const fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// Commands for a target, first from those of the case.
    ///
    /// # Errors
    /// [`InverseError::Target`] for a target that is none, [`InverseError::NoStart`] where the model has no answer at any start, and [`InverseError::Solve`] where a solve
    /// was cancelled.
    pub fn reach(
        &mut self,
        target: &Target,
        options: &ReachOptions,
    ) -> Result<Reached, InverseError> {
        let start = self.commanded();
        let ranges = self.ranges.clone();
        self.reach_from(&start, None, &ranges, target, options).map(|(answer, _)| answer)
    }

    /// [`Self::reach`] from these unknowns and the shape that they lead to, within these bounds.
    pub(crate) fn reach_from(
        &mut self,
        start: &[f64],
        from: Option<&Solution>,
        ranges: &Ranges,
        target: &Target,
        options: &ReachOptions,
    ) -> Result<(Reached, Vec<f64>), InverseError> {
        target.check(self.forward.robot().disks().count())?;
        let length = self.forward.robot().backbone().length;
        let tolerance = options.tolerance.unwrap_or_else(|| Tolerance::of_length(length));
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        if !is_positive(tolerance.position) || !is_positive(tolerance.angle) {
            return Err(InverseError::Target(TargetProblem::Tolerance));
        }
        let lever = tolerance.position / tolerance.angle;
        let constraints = self.constraints(ranges, options);
        let bounds = &ranges.unknowns;
        let first_solve = self.forward.solves;
        let mut search = Search::new(target, tolerance, &constraints, &mut self.forward);
        let scales = search.forward.scales.clone();
        let mut best: Option<Candidate> = None;
        let mut refusal = None;
        let mut starts = 0;
        let mut agreeing = 0;
        let mut queue: Vec<Vec<f64>> = Vec::new();
        let mut next = Some(start.to_vec());
        let mut has_looked = false;
        let most_starts = match search.forward.robot().has_history() {
            true => options.starts.min(STARTS_WITH_HISTORY),
            false => options.starts,
        };
        while let Some(unknowns) = next.take() {
            let spent = search.forward.solves - first_solve;
            if spent >= options.solves {
                break;
            }
            starts += 1;
            let control = Control {
                bounds,
                scales: &scales,
                evaluations: EVALUATIONS.min(options.solves - spent),
                ending: Ending::ANSWER,
            };
            let from = if starts == 1 { from } else { None };
            match search.attempt(&unknowns, from, &control, &mut self.workspace, options) {
                Ok(found) => {
                    if found.is_reached {
                        best = Some(found);
                        break;
                    }
                    let same = 1e-3 * tolerance.position.max(1e-3 * length);
                    match &best {
                        Some(known) if found.rank() >= known.rank() => {
                            agreeing +=
                                usize::from(found.is_minimum && found.rank() - known.rank() < same);
                        }
                        Some(known) => {
                            agreeing =
                                usize::from(found.is_minimum && known.rank() - found.rank() < same);
                            best = Some(found);
                        }
                        None => best = Some(found),
                    }
                }
                Err(error @ SolveError::Cancelled { .. }) => return Err(error.into()),
                Err(error) => refusal = Some(error),
            }
            if agreeing >= AGREEING {
                break;
            }
            if !has_looked && options.starts > 0 {
                has_looked = true;
                let atlas = match &mut self.atlas {
                    Some(atlas) => atlas,
                    none => {
                        let rows = atlas_rows(&self.model, search.forward.robot(), &self.case);
                        let (limits, ranges) = (&self.limits, &self.ranges);
                        none.insert(on_survey(
                            &self.model,
                            &self.case,
                            limits,
                            ranges,
                            search.forward,
                            rows,
                            Atlas::survey,
                        )?)
                    }
                };
                let rows = atlas.nearest(target, lever, most_starts);
                queue = rows.into_iter().rev().map(<[f64]>::to_vec).collect();
            }
            next = queue.pop();
        }
        let Some(mut best) = best else {
            return Err(match refusal {
                Some(error) => InverseError::NoStart(error),
                None => InverseError::NoSolves,
            });
        };
        if best.is_reached && options.prefer != Preference::First {
            let control = Control {
                bounds,
                scales: &scales,
                evaluations: EVALUATIONS,
                ending: Ending::ANSWER,
            };
            let steps = if from.is_some() { STEPS_ON_PATH } else { STEPS };
            let task = redundancy::Task { prefer: options.prefer, start, control: &control, steps };
            if let Some(better) = search.improve(&best, &task, &mut self.workspace, options)? {
                best = better;
            }
        }
        let unknowns = best.unknowns.clone();
        let null_space = self.exact_null_space(&best, target, lever)?;
        let active_limits =
            constraints.met(&self.forward, &best.evaluation, &unknowns, &ranges.unknowns);
        let spent = [starts, self.forward.solves - first_solve];
        let mut answer = self.answer(best, active_limits, null_space, spent);
        if let Some(boxes) = options.proof
            && answer.status != ReachStatus::Reached
        {
            self.prove(&mut answer, target, tolerance, options, boxes)?;
        }
        Ok((answer, unknowns))
    }

    fn answer(
        &self,
        best: Candidate,
        active_limits: Vec<Limit>,
        null_space: Vec<Vec<f64>>,
        [starts, solves]: [usize; 2],
    ) -> Reached {
        let forward = &self.forward;
        let status = match (best.is_reached, best.is_minimum) {
            (true, _) => ReachStatus::Reached,
            (false, true) => ReachStatus::Nearest,
            (false, false) => ReachStatus::Undecided,
        };
        let values = forward.values(&best.unknowns, &best.evaluation.solution);
        let commands = forward.actuators.commands(forward.robot(), &values);
        Reached {
            status,
            case: self.case_with(&commands, &values),
            commands,
            solution: best.evaluation.solution,
            miss: best.miss,
            lower_bound: None,
            no_proof: None,
            active_limits,
            null_space,
            starts,
            solves,
        }
    }

    /// The null space of an answer, from exact rates where the model has them: of the answer's own rates where those cannot be had.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    fn exact_null_space(
        &mut self,
        best: &Candidate,
        target: &Target,
        lever: f64,
    ) -> Result<Vec<Vec<f64>>, SolveError> {
        let scales = &self.forward.scales;
        let Some(redundancy) = Redundancy::of(&best.evaluation, target, lever, scales) else {
            return Ok(Vec::new());
        };
        if !self.forward.has_approximate_rates() {
            return Ok(self.null_space(&redundancy, &best.evaluation));
        }
        let near = Some(&best.evaluation.solution);
        match self.forward.evaluate_with_rates(&best.unknowns, &target.places(), near) {
            Ok((exact, _)) => {
                let exact = best.evaluation.clone().with_rates_of(exact);
                let redundancy = Redundancy::of(&exact, target, lever, &self.forward.scales);
                Ok(redundancy.map(|of| self.null_space(&of, &exact)).unwrap_or_default())
            }
            Err(error @ SolveError::Cancelled { .. }) => Err(error),
            Err(_) => Ok(self.null_space(&redundancy, &best.evaluation)),
        }
    }

    /// The shapes that the iteration starts from, which are computed where they are not yet known: to be kept in a file, for a solver of another run.
    ///
    /// # Errors
    /// [`InverseError::Atlas`] where they cannot be computed, and [`InverseError::NoStart`].
    pub fn atlas(&mut self) -> Result<&AtlasRows, InverseError> {
        let atlas = match self.atlas.take() {
            Some(atlas) => atlas,
            None => {
                let rows = atlas_rows(&self.model, self.forward.robot(), &self.case);
                let Self { model, case, limits, ranges, forward, .. } = &*self;
                on_survey(model, case, limits, ranges, forward, rows, Atlas::survey)?
            }
        };
        Ok(self.atlas.insert(atlas).rows())
    }

    /// What its atlas depends on, as a number: the robot with its loads and base, the model, what is commanded, and the limits. It is the same in every run of one version of
    /// the library.
    #[must_use]
    pub fn atlas_identity(&self) -> u64 {
        let rows = atlas_rows(&self.model, self.forward.robot(), &self.case);
        let Self { model, case, limits, ranges, forward, .. } = self;
        on_survey(model, case, limits, ranges, forward, rows, |survey| survey.identity())
    }

    /// Takes the shapes of another run to start from.
    ///
    /// # Errors
    /// [`InverseError::ForeignAtlas`] where they are of another robot, model, load or limit.
    pub fn set_atlas(&mut self, rows: AtlasRows) -> Result<(), InverseError> {
        let is_own = rows.identity == self.atlas_identity();
        let disks = Stations::Disks.arc_lengths(self.forward.robot()).len();
        let atlas = is_own.then(|| Atlas::of_rows(rows, disks, &self.ranges.unknowns)).flatten();
        self.atlas = Some(atlas.ok_or(InverseError::ForeignAtlas)?);
        Ok(())
    }

    /// Tips and unknowns of as many shapes all over the commands.
    pub(crate) fn shapes(&self, count: usize) -> Result<Vec<(Vec3, Vec<f64>)>, InverseError> {
        let rows = match self.model.kind() {
            ModelKind::Cosserat if self.case.loads.is_none() => count,
            _ if self.forward.robot().has_history() => count.min(ROWS),
            ModelKind::Cosserat => count.min(ROWS_OF_LOADED_RODS),
            _ => count.min(ROWS_OF_A_SURVEY),
        };
        let (limits, ranges) = (&self.limits, &self.ranges);
        let Self { model, case, forward, .. } = self;
        let atlas = on_survey(model, case, limits, ranges, forward, rows, Atlas::survey)?;
        Ok(atlas.each().map(|(tip, unknowns)| (tip, unknowns.to_vec())).collect())
    }

    /// One start for a target with a tolerance far above the error of the model, within the ranges of the solver and constraints that
    /// [`Self::constraints`] gives.
    pub(crate) fn attempt(
        &mut self,
        start: &[f64],
        (target, tolerance): (&Target, Tolerance),
        constraints: &Constraints,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let scales = self.forward.scales.clone();
        let mut search = Search::new(target, tolerance, constraints, &mut self.forward);
        let bounds = &self.ranges.unknowns;
        let control =
            Control { bounds, scales: &scales, evaluations: EVALUATIONS, ending: Ending::COARSE };
        search.attempt(start, None, &control, &mut self.workspace, options)
    }

    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }

    pub(crate) const fn case(&self) -> &Case {
        &self.case
    }

    /// Directions of the commands, in their units.
    fn null_space(&self, redundancy: &Redundancy, evaluation: &Evaluation) -> Vec<Vec<f64>> {
        let robot = self.forward.robot();
        let actuators = &self.forward.actuators;
        let command = |direction: Vec<f64>| {
            let rates: Vec<f64> = (0..robot.cables().len())
                .map(|cable| {
                    let rates = evaluation.shortening_rates.iter().zip(&direction);
                    rates.map(|(rate, change)| rate[cable] * change).sum()
                })
                .collect();
            let values = actuators.values(robot, &direction, &rates);
            let gear = |(actuator, value): (&Actuator, f64)| match *actuator {
                Actuator::Motor(number) => robot.motors()[number].gear_ratio() * value,
                Actuator::Tension(_) | Actuator::Shortening(_) => value,
            };
            actuators.asked.iter().zip(values).map(gear).collect()
        };
        redundancy.null_space(&self.forward.scales).into_iter().map(command).collect()
    }

    /// The case of the solver with these commands in its last step.
    fn case_with(&self, commands: &[f64], values: &[f64]) -> Case {
        let mut forward_case = self.forward.case.clone();
        forward_case.before.clone_from(&self.case.before);
        let robot = self.forward.robot();
        write_commands(self.actuators(), robot, values, &mut forward_case.commands);
        forward_case.motors.clone_from(&self.case.motors);
        let motors = self.forward.robot().motors().len();
        if motors > 0 {
            let steps = forward_case.before.len() + 1;
            while forward_case.motors.len() < steps {
                forward_case.motors.push(vec![None; motors]);
            }
            if let Some(last) = forward_case.motors.last_mut() {
                last.fill(None);
                for (actuator, command) in self.actuators().iter().zip(commands) {
                    if let Actuator::Motor(number) = *actuator {
                        last[number] = Some(*command);
                    }
                }
            }
        }
        forward_case
    }

    /// What is to be kept beside the ranges of the unknowns.
    pub(crate) fn constraints(&self, ranges: &Ranges, options: &ReachOptions) -> Constraints {
        let robot = self.forward.robot();
        let clearance =
            options.clearance.filter(|_| !self.case.obstacles.is_empty()).map(|margin| {
                let (backbone, disks) = (robot.backbone(), robot.disks());
                let arc_lengths = self.stations.arc_lengths(robot);
                let pitch = backbone.length / (STATIONS - 1) as f64;
                let radius = |s: &f64| {
                    let near = |(k, at): (usize, &f64)| {
                        if (at - s).abs() <= pitch { disks.rim_radius(k) } else { 0.0 }
                    };
                    let rims = disks.arc_lengths.iter().enumerate().map(near);
                    rims.fold(backbone.outer_radius_at(disks, *s), f64::max)
                };
                Clearance {
                    obstacles: self.case.obstacles.clone(),
                    margin,
                    radii: arc_lengths.iter().map(radius).collect(),
                    range: 0.01 * backbone.length,
                }
            });
        Constraints::new(
            robot,
            &self.forward.actuators,
            &ranges.values,
            &self.limits,
            self.knows_tensions,
            clearance,
        )
    }
}

/// What is asked of the survey of the shapes.
fn on_survey<T>(
    model: &Model,
    case: &Case,
    limits: &Limits,
    ranges: &Ranges,
    forward: &Forward,
    rows: usize,
    ask: impl FnOnce(&Survey<'_>) -> T,
) -> T {
    let few = on_few_steps(model);
    ask(&Survey {
        model: few.as_ref().unwrap_or(model),
        robot: forward.robot(),
        case,
        actuators: &forward.actuators.list,
        bounds: &ranges.unknowns,
        tensions: &sampled_tensions(limits, &ranges.unknowns, forward),
        rows,
    })
}

/// Tensions of an atlas: within the limits, and no more than what bends the robot by a whole turn.
fn sampled_tensions(limits: &Limits, bounds: &[[f64; 2]], forward: &Forward) -> Vec<[f64; 2]> {
    let of = |(cable, of): (usize, &CableLimits)| {
        let [least, greatest] = of.tension;
        let number = forward.actuators.list.iter().position(|a| *a == Actuator::Tension(cable));
        match number {
            Some(number) => bounds[number],
            None if greatest.is_finite() => [least, greatest],
            None => [least, least + forward.tension_of_half_turn(cable)],
        }
    };
    limits.cables.iter().enumerate().map(of).collect()
}

fn atlas_rows(model: &Model, robot: &Robot, case: &Case) -> usize {
    match model.kind() {
        _ if robot.has_history() => ROWS_WITH_HISTORY,
        ModelKind::Cosserat if case.loads.is_none() => ROWS_OF_LANES,
        _ => ROWS,
    }
}
