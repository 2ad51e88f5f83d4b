//! The forward problem of a robot with its derivatives, as an inverse problem sees it.

use std::sync::Arc;

use whipcord::derivatives::{Change, Hold, Place};
use whipcord::differences::differentiate;
use whipcord::{
    CableCommand, Cancel, Case, Linearization, Mat3, Model, Obstacle, Prepared, Robot, Solution,
    SolveError, StabilityAnalysis, Twist, Wrench,
};

use crate::actuator::{Actuator, Actuators, commanded_shortening, write_commands};
use crate::evaluation::{Evaluation, Rates};
use crate::few_steps::on_few_steps;

/// A model of a robot that answers for the unknowns of an inverse problem.
pub(crate) struct Forward {
    model: Prepared,
    /// With stability and all that the model asks of its answers.
    verifier: Prepared,
    pub actuators: Actuators,
    /// What all solves have in common, with the steps before where the robot remembers them.
    pub case: Case,
    /// The answer to the step before, from which every trial is a step where obstacles rub or move.
    origin: Option<Solution>,
    /// Whether the model has fewer steps than the verifier.
    is_on_few_steps: bool,
    /// What an answer depends on apart from its commands.
    memory: Remembers,
    /// Whether the origin is the answer to a point of a path, from which the robot moves on.
    is_following: bool,
    /// Whether answers have exact derivatives by commands.
    is_exact: bool,
    /// A change of each unknown that bends the robot by half a turn.
    pub scales: Vec<f64>,
    /// The tension of each cable that does, where the model knows tensions.
    half_turn_tensions: Vec<f64>,
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

    fn command(&mut self, unknowns: &[f64]) {
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
        let mut is_only = || self.verifier.has_one_equilibrium(&self.case).unwrap_or(false);
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

    /// The answer for these unknowns and its derivatives, from a neighbouring solution when given.
    pub fn evaluate(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<Evaluation, SolveError> {
        self.starting(from, |forward, from| match forward.is_exact {
            true => {
                forward.command(unknowns);
                forward.solves += 1;
                let (solution, changes) =
                    forward.model.solve_with_command_changes(&forward.case, from)?;
                Ok(forward.with_rates(unknowns, solution, &changes, places))
            }
            false => forward.by_differences(unknowns, places, from),
        })
    }

    /// The answer for these unknowns by the model of the trials, from a neighbouring solution.
    pub fn trial(&mut self, unknowns: &[f64], near: &Solution) -> Result<Solution, SolveError> {
        self.starting(Some(near), |forward, from| {
            forward.command(unknowns);
            forward.solves += 1;
            forward.model.solve(&forward.case, from)
        })
    }

    /// [`Self::evaluate`] with all the derivatives, where the model has exact ones.
    pub fn evaluate_with_rates(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Option<Linearization>), SolveError> {
        self.starting(from, |forward, from| match forward.is_exact {
            true => {
                let found = forward.linearize(unknowns, places, from);
                found.map(|(evaluation, rates)| (evaluation, Some(rates)))
            }
            false => {
                let found = forward.by_differences(unknowns, places, from);
                found.map(|evaluation| (evaluation, None))
            }
        })
    }

    /// An evaluation from a neighbouring solution, or from where the robot stands if its answers depend on that.
    fn starting<T>(
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

    /// [`Self::evaluate`] of a model with exact derivatives, from a neighbouring solution alone, with all the derivatives.
    pub fn linearize(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Linearization), SolveError> {
        self.command(unknowns);
        self.solves += 1;
        let (solution, rates) = self.model.solve_with_derivatives(&self.case, from, &[])?;
        let changes = rates.commands();
        Ok((self.with_rates(unknowns, solution, &changes, places), rates))
    }

    /// Motions of the places in the world with a force on the tip along x, y and z of the base, in m/N, the commands held.
    pub fn motions_with_forces(&self, rates: &Linearization, places: &[Place]) -> [Vec<Twist>; 3] {
        let turn = self.case.base.rotation;
        [0, 1, 2].map(|component| {
            let change = rates.wrench(Place::Tip, component, Hold::Commands);
            let motion = |place: &Place| {
                let of = change.twist(*place);
                Twist { linear: turn.rotate(of.linear), angular: turn.rotate(of.angular) }
            };
            places.iter().map(motion).collect()
        })
    }

    /// A solution with its rates by the unknowns, from its changes with the command of each cable.
    fn with_rates(
        &self,
        unknowns: &[f64],
        solution: Solution,
        by_cable: &[Change],
        places: &[Place],
    ) -> Evaluation {
        let turn = self.case.base.rotation;
        let mut evaluation = self.without_rates(solution);
        let mut rates = Rates { at: unknowns.to_vec(), ..Rates::default() };
        for actuator in &self.actuators.list {
            let mut motions = vec![Twist::default(); places.len()];
            let mut tensions = vec![0.0; by_cable.len()];
            let mut lengths = vec![0.0; by_cable.len()];
            let mut base = Wrench::default();
            for (cable, rate) in actuator.cables(self.model.robot()) {
                let change = &by_cable[cable];
                base.force += change.base_wrench().force * rate;
                base.moment += change.base_wrench().moment * rate;
                for (motion, place) in motions.iter_mut().zip(places) {
                    let of = change.twist(*place);
                    motion.linear += turn.rotate(of.linear) * rate;
                    motion.angular += turn.rotate(of.angular) * rate;
                }
                for (sum, of) in tensions.iter_mut().zip(change.tensions()) {
                    *sum += rate * of;
                }
                for (sum, of) in lengths.iter_mut().zip(change.lengths()) {
                    *sum += rate * of;
                }
            }
            self.push_rates(&evaluation.solution, &mut rates, motions, tensions, lengths);
            rates.base_rates.push(base);
        }
        evaluation.rates = Arc::new(rates);
        evaluation
    }

    /// The exact motions of the tip with the unknowns at an answer, beside other rates of it that are nearly its own; `None` where the answers have more than these to
    /// be exact in, or depend on more than tensions.
    pub fn with_exact_tip(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        Evaluation { solution, rates, .. }: &Evaluation,
    ) -> Result<Option<Rates>, SolveError> {
        let cable = |actuator: &Actuator| match *actuator {
            Actuator::Tension(cable) => Some(cable),
            Actuator::Shortening(_) | Actuator::Motor(_) => None,
        };
        let cables: Option<Vec<usize>> = self.actuators.list.iter().map(cable).collect();
        let is_tip = places == [Place::Tip] && self.is_on_few_steps && self.actuators.are_direct();
        let Some(cables) = cables.filter(|_| is_tip) else { return Ok(None) };
        self.command(unknowns);
        self.solves += 1;
        let mut motions = Vec::new();
        self.model.tip_by_commands(&self.case, solution, &mut motions)?;
        let turn = self.case.base.rotation;
        let motion = |&cable: &usize| {
            let Twist { linear, angular } = motions[cable];
            vec![Twist { linear: turn.rotate(linear), angular: turn.rotate(angular) }]
        };
        Ok(Some(Rates {
            at: unknowns.to_vec(),
            motions: cables.iter().map(motion).collect(),
            tension_rates: rates.tension_rates.clone(),
            shortening_rates: rates.shortening_rates.clone(),
            base_rates: rates.base_rates.clone(),
        }))
    }

    /// The translational compliance of the tip in m/N in the world, with the commands held; `None` where the robot is about to buckle.
    pub fn tip_compliance(&self, rates: &Linearization) -> Option<Mat3> {
        let holds_tensions =
            self.actuators.asked.iter().all(|actuator| matches!(actuator, Actuator::Tension(_)));
        let hold = if holds_tensions { Hold::Tensions } else { Hold::Lengths };
        let local = rates.compliance(Place::Tip, hold).ok()?.blocks[0][0];
        let turn = self.case.base.rotation.to_matrix();
        Some(turn * local * turn.transpose())
    }

    /// [`Self::evaluate`] by the model of the answers.
    pub fn evaluate_answer(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
    ) -> Result<Evaluation, SolveError> {
        self.by_verifier(|forward| forward.evaluate(unknowns, places, None))
    }

    /// What is asked, with another model of the answers.
    pub fn answering_by<T>(&mut self, mut model: Prepared, ask: impl FnOnce(&mut Self) -> T) -> T {
        core::mem::swap(&mut self.verifier, &mut model);
        let found = ask(self);
        core::mem::swap(&mut self.verifier, &mut model);
        found
    }

    /// [`Self::evaluate_with_rates`] by the model of the answers.
    pub fn answer_with_rates(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Option<Linearization>), SolveError> {
        self.by_verifier(|forward| forward.evaluate_with_rates(unknowns, places, from))
    }

    fn by_verifier<T>(&mut self, ask: impl FnOnce(&mut Self) -> T) -> T {
        core::mem::swap(&mut self.model, &mut self.verifier);
        let found = ask(self);
        core::mem::swap(&mut self.model, &mut self.verifier);
        found
    }

    /// [`Self::evaluate`] of a model without exact derivatives.
    fn by_differences(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<Evaluation, SolveError> {
        self.command(unknowns);
        self.solves += 1;
        let solution = self.model.solve(&self.case, from)?;
        let mut all = Rates { at: unknowns.to_vec(), ..Rates::default() };
        let mut moved = unknowns.to_vec();
        for k in 0..unknowns.len() {
            let step = 1e-4 * self.scales[k];
            let solve = |h: f64| {
                moved.copy_from_slice(unknowns);
                moved[k] += h;
                self.command(&moved);
                self.solves += 1;
                let near = if self.memory == Remembers::Nothing { Some(&solution) } else { from };
                self.model.solve(&self.case, near)
            };
            let rates = differentiate(solve, step)?;
            let at = |place: &Place| match *place {
                Place::Station(station) => rates.stations.get(station),
                Place::Disk(disk) => rates.disks.get(disk),
                Place::Tip => rates.disks.last(),
            };
            let motions =
                places.iter().map(|place| at(place).copied().unwrap_or_default()).collect();
            let none = vec![0.0; solution.cables.len()];
            self.push_rates(&solution, &mut all, motions, none, rates.lengths);
        }
        let mut evaluation = self.without_rates(solution);
        evaluation.rates = Arc::new(all);
        Ok(evaluation)
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

    fn push_rates(
        &self,
        solution: &Solution,
        rates: &mut Rates,
        motions: Vec<Twist>,
        tensions: Vec<f64>,
        mut lengths: Vec<f64>,
    ) {
        let robot = self.model.robot();
        let states = solution.cables.iter().zip(&tensions).enumerate();
        for ((cable, (state, tension)), length) in states.zip(&mut lengths) {
            *length = robot.cable_compliance(cable, state.initial_length) * tension - *length;
        }
        rates.shortening_rates.push(lengths);
        rates.motions.push(motions);
        rates.tension_rates.push(tensions);
    }

    /// The shortening in m that each cable is commanded to in a solution.
    pub fn shortenings(&self, solution: &Solution) -> Vec<f64> {
        let of = |(cable, state)| commanded_shortening(self.model.robot(), cable, state);
        solution.cables.iter().enumerate().map(of).collect()
    }
}
