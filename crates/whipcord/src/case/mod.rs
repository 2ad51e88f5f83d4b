//! What is asked of a robot: how its cables are pulled, what loads it carries, and where its base is.

mod loads;
mod motor_history;
mod motors;

use whipcord_numerics::Pose;

use crate::obstacle::Obstacle;
use crate::robot::limits::check_pose;
use crate::robot::{Problem, Robot, RobotError, limits};

use motor_history::MotorHistory;

pub use loads::{DistributedLoad, LoadFrame, Loads, Piece, PointLoad, PointMass, Profile};

/// What is asked of a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Case {
    /// One for each cable of the robot.
    pub commands: Vec<CableCommand>,
    /// External loads.
    pub loads: Loads,
    /// Where the robot's base is in the world, and how it is turned there. Every shape that a model
    /// returns is in the world frame.
    pub base: Pose,
    /// Steps of actuation that came before [`Self::commands`], in order, each with one command for
    /// each cable. A solve from cold of a model without friction does not ask for them; one with
    /// friction goes through them. Without friction, too, the way can matter where a robot has
    /// several equilibria: [`Prepared::solve_steps`](crate::Prepared::solve_steps) goes it.
    pub before: Vec<Vec<CableCommand>>,
    /// The loads of the steps in [`Self::before`], where they differ from step to step; empty where all steps have [`Self::loads`].
    pub loads_before: Vec<Loads>,
    /// Commands of the motors, one for each motor of the robot in each step, the last being that of [`Self::commands`]: an angle
    /// in rad, or a travel in m; `None` leaves the cables to their own commands. Empty for a robot without motors. There may be
    /// more than the steps of the case: those before only say how the backlash of the drives was left.
    /// [`Self::drive`] makes shortenings of the cables of them.
    pub motors: Vec<Vec<Option<f64>>>,
    /// Whether each step starts from the robot at rest, not from where the one before left it: the steps are then separate
    /// experiments, and no answer depends on another step.
    pub independent: bool,
    /// What stands in the robot's way, in the world.
    pub obstacles: Vec<Obstacle>,
}

/// What one cable is told to do; a model uses what it is driven by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableCommand {
    /// Tension in N, not negative.
    pub tension: Option<f64>,
    /// Shortening of the part of the cable inside the robot; negative is paid out.
    pub shortening: Option<Shortening>,
}

/// Initial minus present length of a cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shortening {
    /// In m.
    Length(f64),
    /// As a fraction of the cable's own initial length.
    Fraction(f64),
}

/// Which of the two commands of a cable drives the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Actuation {
    /// What the model is driven by by nature where it is given, else the other; each cable by
    /// itself.
    #[default]
    Natural,
    /// All cables by their tension.
    Tension,
    /// All cables by their shortening.
    Shortening,
}

impl CableCommand {
    fn check(&self) -> Result<(), RobotError> {
        if let Some(tension) = self.tension {
            limits::TENSION.check("tension", tension)?;
        }
        match self.shortening {
            Some(Shortening::Length(length)) => limits::COORDINATE.check("shortening", length),
            Some(Shortening::Fraction(f)) => limits::FRACTION.check("shortening", f),
            None => Ok(()),
        }
    }
}

impl Shortening {
    /// In m, for a cable of this initial length.
    #[must_use]
    pub fn in_metres(self, initial_length: f64) -> f64 {
        match self {
            Self::Length(length) => length,
            Self::Fraction(fraction) => fraction * initial_length,
        }
    }
}

impl Case {
    /// The case with these tensions in N and no load.
    #[must_use]
    pub fn with_tensions(tensions: &[f64]) -> Self {
        let command = |&tension| CableCommand { tension: Some(tension), shortening: None };
        Self { commands: tensions.iter().map(command).collect(), ..Self::default() }
    }

    /// The case with these shortenings and no load.
    #[must_use]
    pub fn with_shortenings(shortenings: &[Shortening]) -> Self {
        let command = |&shortening| CableCommand { tension: None, shortening: Some(shortening) };
        Self { commands: shortenings.iter().map(command).collect(), ..Self::default() }
    }

    /// The steps of actuation in order, the last being the case itself: each with those that came
    /// before it. To solve them all, start each from the answer of the one before:
    ///
    /// ```
    /// # use whipcord::{Backbone, Cable, Case, Disks, Material, Model, ModelKind, Robot, Routing, Section};
    /// # let backbone = Backbone {
    /// #     section: Some(Section::circle(0.003)),
    /// #     material: Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() },
    /// #     ..Backbone::new(0.18)
    /// # };
    /// # let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    /// # let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
    /// let commands = |tension: f64| Case::with_tensions(&[tension]).commands;
    /// let case = Case { before: vec![commands(1.0), commands(3.0)], ..Case::with_tensions(&[2.0]) };
    /// let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
    /// let mut prepared = model.prepare(&robot, &case.loads)?;
    /// let mut solutions = Vec::new();
    /// for step in case.steps() {
    ///     let solution = prepared.solve(&step, solutions.last())?;
    ///     solutions.push(solution);
    /// }
    /// let tensions: Vec<_> = solutions.iter().map(|solution| solution.cables[0].tension).collect();
    /// assert_eq!(tensions, [Some(1.0), Some(3.0), Some(2.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// All of them together take memory that grows with the square of their number: for many steps use
    /// [`Self::single_steps`].
    pub fn steps(&self) -> impl ExactSizeIterator<Item = Self> + '_ {
        (0..self.before.len() + 1).map(|number| self.step_after(number, &self.before[..number]))
    }

    /// One of [`Self::steps`], counted from 0; `None` beyond the last.
    #[must_use]
    pub fn step(&self, number: usize) -> Option<Self> {
        Some(self.step_after(number, self.before.get(..number)?))
    }

    /// The steps of actuation in order, each without those before it: for solves that start from the answer to the step
    /// before, where that answer is all that is left of the way. Of the earlier commands of the motors each step has those that
    /// matter to the backlash of a drive.
    pub fn single_steps(&self) -> impl ExactSizeIterator<Item = Self> + '_ {
        let mut history = MotorHistory::default();
        (0..self.before.len() + 1).map(move |number| {
            let (of_step, earlier) = match self.motors_until(number).split_last() {
                Some((of_step, earlier)) => (Some(of_step), earlier),
                None => (None, &[][..]),
            };
            if !self.independent {
                for step in earlier.get(history.taken..).unwrap_or_default() {
                    history.push(step);
                }
            }
            let motors = history.steps().chain(of_step.cloned()).collect();
            Self { motors, ..self.bare_step(number) }
        })
    }

    /// One step without those before it, counted from 0, of a case whose steps are independent; `None` beyond the last.
    #[must_use]
    pub fn independent_step(&self, number: usize) -> Option<Self> {
        (number <= self.before.len()).then(|| {
            let motors = self.motors_until(number).last().cloned().into_iter().collect();
            Self { motors, ..self.bare_step(number) }
        })
    }

    /// Some of the steps, counted from 0, of a case whose steps are independent, as such a case; `None` where there is no such
    /// step.
    #[must_use]
    pub fn independent_steps(&self, numbers: &[usize]) -> Option<Self> {
        let (last, others) = numbers.split_last()?;
        let mut steps = Self { independent: true, ..self.independent_step(*last)? };
        let commands_of = |number: usize| self.before.get(number);
        steps.before = others.iter().map(|n| commands_of(*n).cloned()).collect::<Option<_>>()?;
        if !self.loads_before.is_empty() {
            let loads_of = |number: &usize| self.loads_before.get(*number).cloned();
            steps.loads_before = others.iter().map(loads_of).collect::<Option<_>>()?;
        }
        let motors = others.iter().filter_map(|number| self.motors_until(*number).last().cloned());
        steps.motors.splice(..0, motors.collect::<Vec<_>>());
        Some(steps)
    }

    /// Whether an obstacle has friction: the answer remembers the way to it.
    pub(crate) fn has_rubbing_obstacles(&self) -> bool {
        self.obstacles.iter().any(Obstacle::has_friction)
    }

    /// Whether the derivatives of an answer from rest are those of the way to it though no cable rubs: obstacles do, and contacts slide on another way
    /// with another command. A backbone with friction against bending among obstacles follows the answer before alone.
    pub(crate) fn differentiates_way(&self, robot: &Robot) -> bool {
        self.has_rubbing_obstacles() && !robot.has_bending_friction()
    }

    /// The steps that lead to the answer to this case, of [`Self::single_steps`]: all of them, or the last alone where they are
    /// independent.
    pub fn leading_steps(&self) -> impl Iterator<Item = Self> + '_ {
        let skipped = if self.independent { self.before.len() } else { 0 };
        self.single_steps().skip(skipped)
    }

    fn step_after(&self, number: usize, before: &[Vec<CableCommand>]) -> Self {
        let motors = self.motors_until(number).to_vec();
        let independent = self.independent && number > 0;
        let loads_before = self.loads_before.iter().take(number).cloned().collect();
        let before = before.to_vec();
        Self { before, loads_before, motors, independent, ..self.bare_step(number) }
    }

    /// A step without those before it and without motors.
    fn bare_step(&self, number: usize) -> Self {
        Self {
            commands: self.before.get(number).unwrap_or(&self.commands).clone(),
            loads: self.loads_before.get(number).unwrap_or(&self.loads).clone(),
            base: self.base,
            before: Vec::new(),
            loads_before: Vec::new(),
            motors: Vec::new(),
            independent: false,
            obstacles: self.obstacles.clone(),
        }
    }

    /// The commands of the motors up to a step.
    fn motors_until(&self, number: usize) -> &[Vec<Option<f64>>] {
        let later = self.before.len().saturating_sub(number);
        &self.motors[..self.motors.len().saturating_sub(later)]
    }

    /// Checks that the case fits the robot and that every number in it can be.
    ///
    /// # Errors
    /// [`RobotError`] with the path of the offending quantity.
    pub fn check(&self, robot: &Robot) -> Result<(), RobotError> {
        let (given, cables) = (self.commands.len(), robot.cables().len());
        if given != cables {
            return Err(RobotError::new("cables", Problem::CableCount { given, cables }));
        }
        for (i, command) in self.commands.iter().enumerate() {
            command.check().map_err(|error| error.under(&format!("cables[{i}]")))?;
        }
        for (k, step) in self.before.iter().enumerate() {
            if step.len() != cables {
                let problem = Problem::CableCount { given: step.len(), cables };
                return Err(RobotError::new(format!("steps[{k}]"), problem));
            }
            for (i, command) in step.iter().enumerate() {
                let of_step = |error: RobotError| RobotError {
                    path: format!("steps[{k}].{}[{i}]", error.path),
                    ..error
                };
                command.check().map_err(of_step)?;
            }
        }
        self.check_motors(robot)?;
        check_pose(&self.base).map_err(|error| error.under("base"))?;
        for (k, obstacle) in self.obstacles.iter().enumerate() {
            obstacle.check().map_err(|error| error.under(&format!("obstacles[{k}]")))?;
        }
        for (k, loads) in self.loads_before.iter().enumerate() {
            let checked = loads.check(robot.backbone().length);
            checked.map_err(|error| error.under(&format!("steps[{k}]")))?;
        }
        self.loads.check(robot.backbone().length)
    }
}
