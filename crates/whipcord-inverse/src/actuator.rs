//! What an inverse problem commands: tensions, shortenings or motors.

use whipcord::{Actuation, CableCommand, CableState, Case, ModelKind, Motor, Robot, Shortening};

use crate::error::InverseError;
use crate::limits::Limits;

/// One command of a robot, an unknown of an inverse problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Actuator {
    /// The tension of a cable in N.
    Tension(usize),
    /// The shortening of a cable in m.
    Shortening(usize),
    /// A motor: its angle in rad, or its travel in m.
    Motor(usize),
}

/// Which commands are the unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommandedBy {
    /// Those that the case commands: the motors where there are some, else tensions or shortenings, each cable by itself. A
    /// cable without a command is driven as the model is by nature.
    #[default]
    Case,
    /// The tensions of all cables.
    Tensions,
    /// The shortenings of all cables.
    Shortenings,
    /// The motors, and the cables that have none as the case commands them.
    Motors,
}

impl Actuator {
    /// The actuators of a robot, motors first.
    ///
    /// # Errors
    /// [`InverseError::NoActuators`] for a robot without cables, [`InverseError::NoMotors`] for one without motors whose motors are asked for.
    pub fn of(
        robot: &Robot,
        case: &Case,
        model: ModelKind,
        by: CommandedBy,
    ) -> Result<Vec<Self>, InverseError> {
        let cables = 0..robot.cables().len();
        let actuators: Vec<Self> = match by {
            CommandedBy::Tensions => cables.map(Self::Tension).collect(),
            CommandedBy::Shortenings => cables.map(Self::Shortening).collect(),
            CommandedBy::Motors if robot.motors().is_empty() => return Err(InverseError::NoMotors),
            CommandedBy::Motors | CommandedBy::Case => {
                let is_commanded = |cable: usize| {
                    case.commands
                        .get(cable)
                        .is_some_and(|c| c.tension.is_some() || c.shortening.is_some())
                };
                let is_motor = |number: &usize| {
                    by == CommandedBy::Motors
                        || case.motor_command(*number).is_some()
                        || !robot.motors()[*number].cables.iter().any(|of| is_commanded(of.cable))
                };
                let motors: Vec<usize> = (0..robot.motors().len()).filter(is_motor).collect();
                let pulled = |cable: &usize| {
                    let of = |&motor: &usize| robot.motors()[motor].cables.iter();
                    motors.iter().flat_map(of).any(|of| of.cable == *cable)
                };
                let of_cable = |cable: usize| {
                    let command = case.commands.get(cable).copied().unwrap_or_default();
                    let by_tension = match model.natural_actuation() {
                        Actuation::Shortening => {
                            command.shortening.is_none() && command.tension.is_some()
                        }
                        Actuation::Natural | Actuation::Tension => {
                            command.tension.is_some() || command.shortening.is_none()
                        }
                    };
                    if by_tension { Self::Tension(cable) } else { Self::Shortening(cable) }
                };
                let free = cables.filter(|cable| !pulled(cable)).map(of_cable);
                motors.iter().map(|&motor| Self::Motor(motor)).chain(free).collect()
            }
        };
        if actuators.is_empty() { Err(InverseError::NoActuators) } else { Ok(actuators) }
    }

    /// The greatest rate of its value.
    pub(crate) fn rate_limit(self, robot: &Robot, limits: &Limits) -> Option<f64> {
        match self {
            Self::Tension(cable) | Self::Shortening(cable) => limits.cables[cable].rate,
            Self::Motor(number) => {
                let motor = &robot.motors()[number];
                motor.limits.rate.map(|rate| rate / motor.gear_ratio().abs())
            }
        }
    }

    /// The cables that it moves, each with the rate of its command, a tension in N or a shortening in m, by the unknown.
    pub(crate) fn cables(self, robot: &Robot) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (single, motor) = match self {
            Self::Tension(cable) | Self::Shortening(cable) => (Some((cable, 1.0)), None),
            Self::Motor(motor) => (None, Some(&robot.motors()[motor])),
        };
        let of_motor = |motor: &'_ Motor| motor.cables.clone();
        let pulled = motor.map(of_motor).unwrap_or_default();
        single.into_iter().chain(pulled.into_iter().map(|of| (of.cable, of.pull())))
    }
}

/// The actuators of an inverse problem and its unknowns.
///
/// A motor has the motion of its spool or drive behind gear and play for a value: the robot's shape is a smooth function of it, where it is
/// constant in the play of the command. Where every actuator shortens one cable of a robot without hole friction, the unknowns are the tensions, and
/// shortenings are read off the shape: the shape is a smooth function of the tensions, and of the shortenings it is none where a cable
/// goes slack.
#[derive(Clone, Debug)]
pub(crate) struct Actuators {
    /// What is commanded.
    pub asked: Vec<Actuator>,
    /// The unknowns.
    pub list: Vec<Actuator>,
    /// Where the spool or drive of each motor of the robot was left by the steps before.
    outputs: Vec<f64>,
    /// The command that each motor of the robot had in the step before.
    commands: Vec<Option<f64>>,
}

impl Actuators {
    /// The unknowns are the values of the actuators themselves.
    pub fn direct(robot: &Robot, case: &Case, asked: Vec<Actuator>) -> Self {
        Self::new(robot, case, asked, false)
    }

    /// `knows_tensions` says whether the model can be driven by tensions.
    pub fn new(robot: &Robot, case: &Case, asked: Vec<Actuator>, knows_tensions: bool) -> Self {
        let motors = robot.motors();
        let (mut outputs, mut commands) = (vec![0.0; motors.len()], vec![None; motors.len()]);
        let before = case.motors.len().saturating_sub(1);
        if !case.independent {
            for step in &case.motors[..before] {
                for (number, motor) in motors.iter().enumerate() {
                    if let Some(command) = step.get(number).copied().flatten() {
                        outputs[number] = motor.output(outputs[number], command);
                        commands[number] = Some(command);
                    }
                }
            }
        }
        let single = |actuator: &Actuator| {
            let mut cables = actuator.cables(robot);
            let cable = cables.next().map(|(cable, _)| cable);
            cable.filter(|_| cables.next().is_none())
        };
        let cables: Option<Vec<usize>> = asked.iter().map(single).collect();
        let list = match cables {
            Some(cables) if knows_tensions && !robot.has_history() => {
                cables.into_iter().map(Actuator::Tension).collect()
            }
            _ => asked.clone(),
        };
        Self { asked, list, outputs, commands }
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether the unknowns are the values of the actuators.
    pub fn are_direct(&self) -> bool {
        self.asked == self.list
    }

    /// The values of the actuators, from the unknowns or from the shortenings of the cables.
    pub fn values(&self, robot: &Robot, unknowns: &[f64], shortenings: &[f64]) -> Vec<f64> {
        let of = |(actuator, x): (&Actuator, &f64)| match actuator {
            Actuator::Tension(_) => *x,
            Actuator::Shortening(_) | Actuator::Motor(_) if self.are_direct() => *x,
            Actuator::Shortening(_) | Actuator::Motor(_) => {
                let cable = actuator.cables(robot).next();
                cable.map_or(0.0, |(cable, rate)| shortenings[cable] / rate)
            }
        };
        self.asked.iter().zip(unknowns).map(of).collect()
    }

    /// The values of the actuators that the case commands, zero where it has no command.
    pub fn commanded(&self, robot: &Robot, case: &Case) -> Vec<f64> {
        let of = |actuator: &Actuator| match *actuator {
            Actuator::Tension(cable) => {
                case.commands.get(cable).and_then(|command| command.tension).unwrap_or(0.0)
            }
            Actuator::Shortening(cable) => {
                let shortening = case.commands.get(cable).and_then(|command| command.shortening);
                let length = robot.cable_length(cable);
                shortening.map_or(0.0, |shortening: Shortening| shortening.in_metres(length))
            }
            Actuator::Motor(motor) => {
                case.motor_command(motor).map_or(self.outputs[motor], |command| {
                    robot.motors()[motor].output(self.outputs[motor], command)
                })
            }
        };
        self.asked.iter().map(of).collect()
    }

    /// The command of an actuator for its value: the same, but of a motor the angle or travel that brings the drive there.
    pub fn command(&self, robot: &Robot, actuator: Actuator, unknown: f64) -> f64 {
        let Actuator::Motor(number) = actuator else { return unknown };
        let motor = &robot.motors()[number];
        let before = self.outputs[number];
        let half = 0.5 * motor.backlash;
        let asked = if unknown > before {
            unknown + half
        } else if unknown < before {
            unknown - half
        } else if let Some(command) = self.commands[number] {
            return command;
        } else {
            unknown
        };
        motor.offset + motor.gear_ratio() * asked
    }

    /// The commands of the actuators for their values.
    pub fn commands(&self, robot: &Robot, values: &[f64]) -> Vec<f64> {
        let of = self.asked.iter().zip(values);
        of.map(|(actuator, value)| self.command(robot, *actuator, *value)).collect()
    }

    /// Takes note that the actuators have these values: the next step starts there.
    pub fn move_on(&mut self, robot: &Robot, values: &[f64]) {
        let commands = self.commands(robot, values);
        for ((actuator, value), command) in self.asked.iter().zip(values).zip(commands) {
            if let Actuator::Motor(number) = *actuator {
                self.commands[number] = Some(command);
                self.outputs[number] = *value;
            }
        }
    }

    /// Least and greatest value of these actuators that keep the limits of their commands.
    pub fn bounds(&self, list: &[Actuator], robot: &Robot, limits: &Limits) -> Vec<[f64; 2]> {
        let of = |actuator: &Actuator| match *actuator {
            Actuator::Tension(cable) => limits.cables[cable].tension,
            Actuator::Shortening(cable) => limits.cables[cable].shortening,
            Actuator::Motor(number) => {
                let motor = &robot.motors()[number];
                let Some([least, greatest]) = motor.limits.range else {
                    return [f64::NEG_INFINITY, f64::INFINITY];
                };
                let asked = |command: f64| (command - motor.offset) / motor.gear_ratio();
                let (a, b) = (asked(least), asked(greatest));
                let (half, at) = (0.5 * motor.backlash, self.outputs[number]);
                [at.min(a.min(b) + half), at.max(a.max(b) - half)]
            }
        };
        list.iter().map(of).collect()
    }
}

/// Whether a model is driven by tensions by nature, and so knows them of every answer.
pub(crate) fn knows_tensions(model: ModelKind) -> bool {
    model.natural_actuation() == Actuation::Tension
}

/// The shortening in m that a cable is commanded to in an answer: by how much its part in the robot is shorter, and what it and its drive
/// are longer by under its tension.
pub(crate) fn commanded_shortening(robot: &Robot, cable: usize, state: &CableState) -> f64 {
    let stretch = state
        .tension
        .map_or(0.0, |tension| robot.cable_stretch(cable, state.initial_length, tension));
    state.initial_length - state.length + stretch
}

/// Writes the values of actuators into the commands of the cables.
pub(crate) fn write_commands(
    list: &[Actuator],
    robot: &Robot,
    values: &[f64],
    commands: &mut [CableCommand],
) {
    for (actuator, &x) in list.iter().zip(values) {
        for (cable, rate) in actuator.cables(robot) {
            commands[cable] = match actuator {
                Actuator::Tension(_) => {
                    CableCommand { tension: Some(x.max(0.0)), shortening: None }
                }
                Actuator::Shortening(_) | Actuator::Motor(_) => {
                    CableCommand { tension: None, shortening: Some(Shortening::Length(rate * x)) }
                }
            };
        }
    }
}
