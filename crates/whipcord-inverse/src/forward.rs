//! The forward problem of a robot with its derivatives, as an inverse problem sees it.

use std::sync::Arc;

use whipcord::derivatives::Place;
use whipcord::{
    CableCommand, Cancel, Case, Model, Obstacle, Prepared, Robot, Solution, SolveError,
    StabilityAnalysis, Twist,
};

use crate::actuator::{Actuator, Actuators, commanded_shortening, write_commands};
use crate::evaluation::Evaluation;
use crate::few_steps::on_few_steps;

/// A model of a robot that answers for the unknowns of an inverse problem.
pub(crate) struct Forward {
    pub model: Prepared,
    /// With stability and all that the model asks of its answers.
    verifier: Prepared,
    pub actuators: Actuators,
    /// What all solves have in common, with the steps before where the robot remembers them.
    pub case: Case,
    /// The answer to the step before, from which every trial is a step where obstacles rub or move.
    origin: Option<Solution>,
    /// Whether the model has fewer steps than the verifier.
    pub is_on_few_steps: bool,
    /// What an answer depends on apart from its commands.
    memory: Remembers,
    /// Whether the origin is the answer to a point of a path, from which the robot moves on.
    is_following: bool,
    /// Whether answers have exact derivatives by commands.
    pub is_exact: bool,
    /// A change of each unknown that bends the robot by half a turn.
    pub scales: Vec<f64>,
    /// The tension of each cable that does, where the model knows tensions.
    half_turn_tensions: Vec<f64>,
    /// The greatest tension in N that each cable may have.
    pub greatest_tensions: Vec<f64>,
    /// How often the model was solved.
    pub solves: usize,
}

/// What an answer depends on apart from its commands and loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remembers {
    /// Nothing.
    Nothing,
    /// The answer to the step before, where obstacles rub or move.
    LastAnswer,
    /// The commands of all steps before, where cables rub in their holes or the backbone yields.
    AllSteps,
}

/// Where a robot is on its way.
pub(crate) struct Standing {
    origin: Option<Solution>,
    actuators: Actuators,
    steps: usize,
    is_following: bool,
}

impl Forward {
    pub fn new(
        model: &Model,
        robot: &Robot,
        case: &Case,
        actuators: Actuators,
    ) -> Result<Self, SolveError> {
        let memory = if robot.has_history() {
            Remembers::AllSteps
        } else if case.obstacles.iter().any(Obstacle::has_history) {
            Remembers::LastAnswer
        } else {
            Remembers::Nothing
        };
        let verifier = model.prepare(robot, &case.loads)?;
        let plain = model.clone().with_stability(StabilityAnalysis::Off);
        let is_on_few_steps = memory == Remembers::Nothing && case.obstacles.is_empty();
        let (plain, is_on_few_steps) = match on_few_steps(&plain) {
            Some(few) if is_on_few_steps => (few, true),
            _ => (plain, false),
        };
        let prepared = plain.prepare(robot, &case.loads)?;
        let mut case = case.clone();
        case.motors.clear();
        case.commands.resize(robot.cables().len(), CableCommand::default());
        let is_independent = core::mem::take(&mut case.independent);
        let before = core::mem::take(&mut case.before);
        let mut forward = Self {
            model: prepared,
            verifier,
            scales: vec![1.0; actuators.len()],
            actuators,
            case,
            origin: None,
            is_on_few_steps,
            memory,
            is_following: false,
            is_exact: model.has_derivatives(robot),
            half_turn_tensions: Vec::new(),
            greatest_tensions: Vec::new(),
            solves: 0,
        };
        let tensions = (0..robot.cables().len()).map(Actuator::Tension).collect();
        let asked = core::mem::replace(&mut forward.actuators.list, tensions);
        forward.half_turn_tensions = forward.half_turns();
        forward.actuators.list = asked;
        forward.scales = forward.half_turns();
        match memory {
            _ if is_independent => {}
            Remembers::Nothing => {}
            Remembers::AllSteps => forward.case.before = before,
            Remembers::LastAnswer => {
                if let Some((last, earlier)) = before.split_last() {
                    let (commands, before) = (last.clone(), earlier.to_vec());
                    let left = Case { commands, before, ..forward.case.clone() };
                    let end = forward.model.solve_to_the_end(&left).map_err(|(_, error)| error)?;
                    forward.origin = Some(end);
                }
            }
        }
        Ok(forward)
    }

    pub fn robot(&self) -> &Robot {
        self.model.robot()
    }

    /// The change of each unknown that would bend the robot by half a turn, from its rate at rest.
    fn half_turns(&mut self) -> Vec<f64> {
        let length = self.robot().backbone().length;
        let disks = self.robot().disks().count();
        let places: Vec<Place> = (0..disks).map(Place::Disk).chain([Place::Tip]).collect();
        let fallback = |actuator: &Actuator| match actuator {
            Actuator::Tension(_) => 1.0,
            Actuator::Shortening(_) => 0.1 * length,
            Actuator::Motor(_) => 1.0,
        };
        let list = self.actuators.list.clone();
        // Without a pull a cable is slack in either direction: a small one is taken.
        let start: Vec<f64> = list.iter().map(|actuator| 1e-3 * fallback(actuator)).collect();
        self.scales.clone_from(&start);
        let Ok(evaluation) = self.evaluate(&start, &places, None) else {
            return list.iter().map(fallback).collect();
        };
        let of = |(actuator, motions): (&Actuator, &Vec<Twist>)| {
            let fastest = motions.iter().map(|motion| motion.angular.norm()).fold(0.0, f64::max);
            let half_turn = core::f64::consts::PI / fastest;
            if half_turn.is_finite() && half_turn < 1e6 * fallback(actuator) {
                half_turn
            } else {
                fallback(actuator)
            }
        };
        list.iter().zip(&evaluation.rates.motions).map(of).collect()
    }

    pub fn command(&mut self, unknowns: &[f64]) {
        let robot = self.model.robot();
        write_commands(&self.actuators.list, robot, unknowns, &mut self.case.commands);
    }

    /// The tension of a cable in N that bends the robot by about half a turn.
    pub fn tension_of_half_turn(&self, cable: usize) -> f64 {
        self.half_turn_tensions.get(cable).copied().unwrap_or(1.0)
    }

    /// The answer as a solve of these commands gives it, with its stability: through the steps before and from rest, or from
    /// the point before of a path, or from the shape that was found near it. `shortenings` are the commands of the cables as such.
    pub fn verify(
        &mut self,
        unknowns: &[f64],
        shortenings: &[f64],
        near: &Solution,
    ) -> Result<Solution, SolveError> {
        self.solves += 1;
        let robot = self.model.robot();
        let values = self.actuators.values(robot, unknowns, shortenings);
        write_commands(&self.actuators.asked, robot, &values, &mut self.case.commands);
        let greatest = &self.greatest_tensions;
        let mut is_only =
            || self.verifier.has_one_equilibrium(&self.case, greatest).unwrap_or(false);
        let from = match self.memory {
            Remembers::LastAnswer => self.origin.as_ref(),
            Remembers::Nothing if self.is_following || is_only() => Some(near),
            Remembers::Nothing | Remembers::AllSteps => None,
        };
        self.verifier.solve(&self.case, from)
    }

    /// The values of the actuators in a solution.
    pub fn values(&self, unknowns: &[f64], solution: &Solution) -> Vec<f64> {
        self.actuators.values(self.model.robot(), unknowns, &self.shortenings(solution))
    }

    /// The unknowns that the case commands.
    pub fn commanded(&mut self, case: &Case) -> Vec<f64> {
        let values = self.actuators.commanded(self.model.robot(), case);
        if self.actuators.are_direct() {
            return values;
        }
        let robot = self.model.robot();
        write_commands(&self.actuators.asked, robot, &values, &mut self.case.commands);
        self.solves += 1;
        let solution = self.model.solve(&self.case, None).ok();
        let tension = |actuator: &Actuator| {
            let cable = actuator.cables(self.model.robot()).next().map(|(cable, _)| cable);
            let state = solution.as_ref().zip(cable).and_then(|(of, cable)| of.cables.get(cable));
            state.and_then(|state| state.tension).unwrap_or(0.0)
        };
        self.actuators.list.iter().map(tension).collect()
    }

    /// Moves on from the answer to a point of a path.
    pub fn move_on(&mut self, unknowns: &[f64], solution: &Solution) {
        let values = self.values(unknowns, solution);
        self.command_actuators(&values);
        if self.memory == Remembers::AllSteps {
            self.command(unknowns);
            self.case.before.push(self.case.commands.clone());
        }
        self.origin = Some(solution.clone());
        self.is_following = true;
    }

    /// Takes note of the values that the actuators have now: backlash counts from there.
    pub fn command_actuators(&mut self, values: &[f64]) {
        self.actuators.move_on(self.model.robot(), values);
    }

    /// Whether the rates of [`Self::evaluate`] are only as exact as a descent needs them.
    pub fn has_approximate_rates(&self) -> bool {
        matches!(self.model, Prepared::Cosserat(..)) && !self.case.loads.is_none()
    }

    /// Whether an answer depends on its commands and loads alone.
    pub fn has_no_memory(&self) -> bool {
        self.memory == Remembers::Nothing
    }

    /// Whether trials are solved on fewer steps than answers.
    pub const fn is_on_few_steps(&self) -> bool {
        self.is_on_few_steps
    }

    /// Where the robot is: what [`Self::return_to`] takes it back to.
    pub fn standing(&self) -> Standing {
        Standing {
            origin: self.origin.clone(),
            actuators: self.actuators.clone(),
            steps: self.case.before.len(),
            is_following: self.is_following,
        }
    }

    /// Takes the robot back.
    pub fn return_to(&mut self, standing: Standing) {
        let Standing { origin, actuators, steps, is_following } = standing;
        self.case.before.truncate(steps);
        (self.origin, self.actuators, self.is_following) = (origin, actuators, is_following);
    }

    /// The answer for these unknowns by the model of the trials, from a neighbouring solution.
    pub fn trial(&mut self, unknowns: &[f64], near: &Solution) -> Result<Solution, SolveError> {
        self.starting(Some(near), |forward, from| {
            forward.command(unknowns);
            forward.solves += 1;
            forward.model.solve(&forward.case, from)
        })
    }

    /// An evaluation from a neighbouring solution, or from where the robot stands if its answers depend on that.
    pub fn starting<T>(
        &mut self,
        from: Option<&Solution>,
        evaluate: impl FnOnce(&mut Self, Option<&Solution>) -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        // Taken for the time of the evaluation, which changes the rest.
        let origin = self.origin.take();
        let from = match self.memory {
            Remembers::Nothing => from.or(origin.as_ref()),
            Remembers::LastAnswer => origin.as_ref(),
            Remembers::AllSteps => None,
        };
        let found = evaluate(self, from);
        self.origin = origin;
        found
    }

    pub fn by_verifier<T>(&mut self, ask: impl FnOnce(&mut Self) -> T) -> T {
        core::mem::swap(&mut self.model, &mut self.verifier);
        let found = ask(self);
        core::mem::swap(&mut self.model, &mut self.verifier);
        found
    }

    /// Lets this flag end the solves.
    pub fn set_cancel(&mut self, cancel: &Cancel) {
        self.model.set_cancel(cancel);
        self.verifier.set_cancel(cancel);
    }

    /// The solution that the model of the answers has, with the rates of an evaluation.
    pub fn with_rates_of(&self, solution: Solution, evaluation: &Evaluation) -> Evaluation {
        let rates = Arc::clone(&evaluation.rates);
        Evaluation { rates, ..self.without_rates(solution) }
    }

    /// Of a solution whose rates are not known.
    pub fn without_rates(&self, solution: Solution) -> Evaluation {
        Evaluation {
            tensions: solution.cables.iter().map(|cable| cable.tension).collect(),
            shortenings: self.shortenings(&solution),
            rates: Arc::default(),
            solution,
        }
    }

    /// The shortening in m that each cable is commanded to in a solution.
    pub fn shortenings(&self, solution: &Solution) -> Vec<f64> {
        let of = |(cable, state)| commanded_shortening(self.model.robot(), cable, state);
        solution.cables.iter().enumerate().map(of).collect()
    }
}
