//! Commands that bring a robot to a target.

use std::f64::consts::PI;
use std::sync::Arc;

use whipcord::derivatives::Place;
use whipcord::{Case, Robot, Shortening, Solution, SolveError};

use crate::actuator::{Actuator, commanded_shortening, write_commands};
use crate::certificate::NoProof;
use crate::descent::{Control, Ending, Start};
use crate::error::{InverseError, TargetProblem};
use crate::evaluation::Evaluation;
use crate::foresight::Passed;
use crate::landmarks::{Landmark, Led};
use crate::limit::{Constraints, Limit};
use crate::options::{Preference, ReachOptions, ReachStatus};
use crate::redundancy::{self, Redundancy};
use crate::search::{Candidate, Search};
use crate::solver::{InverseSolver, Ranges};
use crate::surveying::Surveyed;
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

/// Starts from an atlas of a robot that remembers the steps before.
const STARTS_WITH_HISTORY: usize = 6;
/// Steps along the null space to the preferred commands.
const STEPS: usize = 40;
/// A gain of less than this part of what is to be small is the last; and at a point of a path, whose next one goes on from it.
const LEAST_GAIN: f64 = 1e-8;
const LEAST_GAIN_ON_PATH: f64 = 1e-4;
/// A step between points of a path of less than this, in changes that bend the robot by half a turn, is small.
const NEAR: f64 = 0.02;
/// Evaluations of one start.
const EVALUATIONS: usize = 80;
/// A nearest point within this part of the length, and of half a turn, is taken for one only when no start leads nearer: three of 104,400 targets that can be reached have such a point
/// beside them (`study_of_planted_targets`).
const CLOSE: f64 = 0.01;
/// Starts that end at the same nearest point before it is taken for one, where it is farther.
const AGREEING: usize = 5;

impl InverseSolver {
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

    /// [`Self::reach`] from these unknowns, or from the point before of a path that they are the commands of, within these bounds.
    pub(crate) fn reach_from(
        &mut self,
        start: &[f64],
        from: Option<&Passed>,
        ranges: &Ranges,
        target: &Target,
        options: &ReachOptions,
    ) -> Result<(Reached, Passed), InverseError> {
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
        let prefer = options.prefer;
        let control = |spent: usize| Control {
            bounds,
            scales: &scales,
            evaluations: EVALUATIONS.min(options.solves - spent),
            ending: Ending::ANSWER,
            curvature: None,
        };
        let predicted = from.and_then(|passed| {
            let control = &control(0);
            let task =
                redundancy::Task { prefer, start, control, steps: 1, least_gain: LEAST_GAIN };
            passed.predicted(&mut search, &task, &mut self.workspace)
        });
        let wanted = match options.prefer {
            Preference::LeastChange => None,
            _ => self.spread.as_deref(),
        };
        let known = match from {
            None => {
                let step = (&control(0), &mut self.workspace);
                self.landmarks.start(start, wanted, &mut search, step)?
            }
            Some(_) => None,
        };
        let of_landmark = known.as_ref().map_or(0, |led| led.landmark.solves);
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
            let spent = search.forward.solves - first_solve - of_landmark;
            if spent >= options.solves {
                break;
            }
            starts += 1;
            if starts == 1
                && let Some((from, predicted)) = from.zip(predicted.as_ref())
            {
                let before = (from.at.unknowns.as_slice(), &from.at.evaluation);
                best = search.foretold(predicted, before, options)?;
                if best.is_some() {
                    break;
                }
            }
            let at = match (starts, from, &known) {
                (1, Some(from), _) => {
                    let moved = predicted.as_ref().map_or(&unknowns, |of| &of.unknowns);
                    Start::From(moved, (&unknowns, &from.at.evaluation))
                }
                (2, None, Some(Led { landmark, to: Some(_) })) => {
                    Start::Known(&landmark.unknowns, &landmark.evaluation)
                }
                (1, None, Some(Led { landmark: Landmark { unknowns, evaluation, .. }, to })) => {
                    match to {
                        Some(to) => Start::From(to, (unknowns, evaluation)),
                        None => Start::Known(unknowns, evaluation),
                    }
                }
                _ => Start::At(&unknowns),
            };
            match search.attempt(at, &control(spent), &mut self.workspace, options) {
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
            let is_far = |of: &Candidate| {
                let Miss { position, angle } = of.miss;
                !of.is_allowed || position > CLOSE * length || angle > CLOSE * PI
            };
            if agreeing >= AGREEING && best.as_ref().is_some_and(is_far) {
                break;
            }
            if !has_looked && options.starts > 0 {
                has_looked = true;
                let (model, case, forward) = (&self.model, &self.case, &*search.forward);
                let (limits, ranges) = (&self.limits, &self.ranges);
                let surveyed = Surveyed { model, case, limits, ranges, forward };
                let atlas = surveyed.atlas(&mut self.atlas)?;
                let rows = atlas.nearest(target, lever, most_starts);
                queue = rows.into_iter().rev().map(<[f64]>::to_vec).collect();
                // The shape that was started from is tried anyway.
                let is_known = known.as_ref().is_some_and(|led| led.landmark.unknowns == start);
                if wanted.is_some() && !is_known {
                    queue.push(start.to_vec());
                }
            }
            // What second derivatives lead to may be beside a minimum that the steps from the shape itself come to.
            if let (1, Some(Led { landmark, to: Some(_) })) = (starts, &known)
                && options.starts > 0
            {
                queue.push(landmark.unknowns.clone());
            }
            next = queue.pop();
            search.forget_curvature();
        }
        let Some(mut best) = best else {
            return Err(match refusal {
                Some(error) => InverseError::NoStart(error),
                None => InverseError::NoSolves,
            });
        };
        // Along a path of small steps that along the null space is already made.
        let is_near = predicted.as_ref().is_some_and(|moved| {
            let steps = moved.unknowns.iter().zip(start).zip(&scales);
            starts == 1 && steps.into_iter().all(|((a, b), scale)| (a - b).abs() < NEAR * scale)
        });
        if best.is_reached && options.prefer != Preference::First && !is_near {
            let least_gain = if from.is_some() { LEAST_GAIN_ON_PATH } else { LEAST_GAIN };
            let control = &control(0);
            let task = redundancy::Task { prefer, start, control, steps: STEPS, least_gain };
            if let Some(better) = search.improve(&best, &task, &mut self.workspace, options)? {
                best = better;
            }
        }
        let learned = search.learned();
        let places = search.places().to_vec();
        let null_space = match options.null_space {
            true => self.exact_null_space(&mut best, target, lever, &places)?,
            false => Vec::new(),
        };
        let active_limits =
            constraints.met(&self.forward, &best.evaluation, &best.unknowns, &ranges.unknowns);
        let spent = [starts, self.forward.solves - first_solve];
        let mut answer = self.answer(&best, active_limits, null_space, spent);
        if let Some(boxes) = options.proof
            && answer.status != ReachStatus::Reached
        {
            self.prove(&mut answer, target, tolerance, options, boxes)?;
        }
        Ok((answer, Passed::new(best, target, learned)))
    }

    fn answer(
        &self,
        best: &Candidate,
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
            solution: best.evaluation.solution.clone(),
            miss: best.miss,
            lower_bound: None,
            no_proof: None,
            active_limits,
            null_space,
            starts,
            solves,
        }
    }

    /// The null space of an answer, from exact rates where the model has them: of the answer's own rates where those cannot be had. The answer has
    /// the exact ones from then on.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    fn exact_null_space(
        &mut self,
        best: &mut Candidate,
        target: &Target,
        lever: f64,
        places: &[Place],
    ) -> Result<Vec<Vec<f64>>, SolveError> {
        let scales = &self.forward.scales;
        let Some(redundancy) = Redundancy::of(&best.evaluation, target, lever, scales) else {
            return Ok(Vec::new());
        };
        let is_approximate = self.forward.has_approximate_rates();
        if best.has_own_rates && !is_approximate {
            return Ok(self.null_space(&redundancy, &best.evaluation));
        }
        let near = Some(&best.evaluation.solution);
        let exact = match is_approximate {
            true => {
                let tip = self.forward.with_exact_tip(&best.unknowns, places, &best.evaluation);
                tip.and_then(|tip| match tip {
                    Some(rates) => Ok(Arc::new(rates)),
                    None => {
                        let found = self.forward.evaluate_with_rates(&best.unknowns, places, near);
                        found.map(|(evaluation, _)| evaluation.rates)
                    }
                })
            }
            false => self.forward.evaluate(&best.unknowns, places, near).map(|of| of.rates),
        };
        match exact {
            Ok(rates) => {
                best.evaluation.rates = rates;
                best.has_own_rates = true;
                let exact = &best.evaluation;
                let redundancy = Redundancy::of(exact, target, lever, &self.forward.scales);
                Ok(redundancy.map(|of| self.null_space(&of, exact)).unwrap_or_default())
            }
            Err(error @ SolveError::Cancelled { .. }) => Err(error),
            Err(_) => Ok(self.null_space(&redundancy, &best.evaluation)),
        }
    }

    /// One start for a target with a tolerance far above the error of the model, within the ranges of the solver and constraints that
    /// [`Self::constraints`] gives.
    pub(crate) fn attempt(
        &mut self,
        start: Start<'_, Evaluation>,
        (target, tolerance): (&Target, Tolerance),
        constraints: &Constraints,
        options: &ReachOptions,
    ) -> Result<Candidate, SolveError> {
        let scales = self.forward.scales.clone();
        let mut search = Search::new(target, tolerance, constraints, &mut self.forward);
        let bounds = &self.ranges.unknowns;
        let (evaluations, ending) = (EVALUATIONS, Ending::COARSE);
        let control = Control { bounds, scales: &scales, evaluations, ending, curvature: None };
        search.attempt(start, &control, &mut self.workspace, options)
    }

    /// Directions of the commands, in their units.
    fn null_space(&self, redundancy: &Redundancy, evaluation: &Evaluation) -> Vec<Vec<f64>> {
        let robot = self.forward.robot();
        let actuators = &self.forward.actuators;
        let command = |direction: Vec<f64>| {
            let rates: Vec<f64> = (0..robot.cables().len())
                .map(|cable| {
                    let rates = evaluation.rates.shortening_rates.iter().zip(&direction);
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
}
