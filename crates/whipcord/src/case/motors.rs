//! What the motors are told to do, and what that makes of the cables.

use super::{CableCommand, Case, Shortening};
use crate::robot::{Problem, Robot, RobotError};

impl Case {
    /// The case with these commands of the motors, angles in rad or travels in m, and no load.
    ///
    /// # Errors
    /// As [`Self::drive`].
    pub fn with_motors(robot: &Robot, commands: &[f64]) -> Result<Self, RobotError> {
        let mut case = Self {
            commands: vec![CableCommand::default(); robot.cables().len()],
            motors: vec![commands.iter().copied().map(Some).collect()],
            ..Self::default()
        };
        case.drive(robot)?;
        Ok(case)
    }

    /// Lets the motors of a robot wind up their cables, as [`Self::motors`] commands them: gives the cables of each motor with a
    /// command their shortenings in every step, eq. (1) and (2) of the page on motors. To be called whenever the commands of
    /// the motors or the motors themselves change.
    ///
    /// # Errors
    /// [`RobotError`] where the commands fit neither the motors nor the steps, or lie beyond the limits of a motor.
    pub fn drive(&mut self, robot: &Robot) -> Result<(), RobotError> {
        self.check_motors(robot)?;
        let mut outputs = vec![0.0; robot.motors().len()];
        let Self { motors, before, commands, independent, .. } = self;
        let earlier = motors.len().saturating_sub(before.len() + 1);
        let mut of_steps = before.iter_mut().chain(core::iter::once(commands));
        for (number, step) in motors.iter().enumerate() {
            let mut of_cables = if number < earlier { None } else { of_steps.next() };
            if *independent {
                outputs.fill(0.0);
            }
            for ((motor, output), command) in robot.motors().iter().zip(&mut outputs).zip(step) {
                let &Some(command) = command else { continue };
                *output = motor.output(*output, command);
                for of in &motor.cables {
                    let commands = of_cables.as_deref_mut();
                    if let Some(cable) = commands.and_then(|commands| commands.get_mut(of.cable)) {
                        cable.shortening = Some(Shortening::Length(of.pull() * *output));
                    }
                }
            }
        }
        Ok(())
    }

    /// The case with these commands of the cables in its last step: the motors are then where the cables have brought them.
    #[must_use]
    pub fn commanded(&self, commands: Vec<CableCommand>) -> Self {
        let mut case = Self { commands, ..self.clone() };
        if let Some(last) = case.motors.last_mut() {
            last.fill(None);
        }
        case
    }

    /// The case with these commands of the motors in its last step, one for each motor of the robot: an angle in rad or a
    /// travel in m, `None` where the cables of the motor keep their own commands.
    ///
    /// # Errors
    /// As [`Self::drive`].
    pub fn driven_to(&self, robot: &Robot, commands: &[Option<f64>]) -> Result<Self, RobotError> {
        let mut case = self.clone();
        *case.last_of_motors(robot) = commands.to_vec();
        case.drive(robot)?;
        Ok(case)
    }

    /// The commands of the motors in the last step, to be written.
    pub(crate) fn last_of_motors(&mut self, robot: &Robot) -> &mut Vec<Option<f64>> {
        let still = || vec![None; robot.motors().len()];
        while self.motors.len() <= self.before.len() {
            self.motors.push(still());
        }
        let last = self.motors.len() - 1;
        &mut self.motors[last]
    }

    /// The command of a motor in the last step.
    #[must_use]
    pub fn motor_command(&self, motor: usize) -> Option<f64> {
        *self.motors.last()?.get(motor)?
    }

    pub(super) fn check_motors(&self, robot: &Robot) -> Result<(), RobotError> {
        if self.motors.is_empty() {
            return Ok(());
        }
        let (given, steps) = (self.motors.len(), self.before.len() + 1);
        if given < steps {
            return Err(RobotError::new("motors", Problem::MotorSteps { given, steps }));
        }
        let earlier = given - steps;
        for (number, step) in self.motors.iter().enumerate() {
            let under = |path: String| match steps {
                1 => path,
                _ => format!("steps[{}].{path}", number.saturating_sub(earlier)),
            };
            if step.len() != robot.motors().len() {
                let problem =
                    Problem::MotorCount { given: step.len(), motors: robot.motors().len() };
                return Err(RobotError::new(under("motors".to_owned()), problem));
            }
            for (i, (motor, command)) in robot.motors().iter().zip(step).enumerate() {
                if let Some(Err(problem)) = command.map(|command| motor.check_command(command)) {
                    let path = match steps {
                        1 => format!("motors[{i}].{}", motor.drive.keys().command),
                        _ => format!("motors[{i}]"),
                    };
                    return Err(RobotError::new(under(path), problem));
                }
            }
        }
        Ok(())
    }
}
