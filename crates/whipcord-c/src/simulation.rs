//! A robot in motion.

use std::sync::Arc;

use whipcord_io::CaseFile;
use whipcord_motion::{Commands, Course, Simulation, State};

use crate::robot::{RobotFile, check_commands, check_motors, check_tensions, motion_failure};
use crate::status::Failure;

/// A robot in motion, with the commands in force.
pub struct MovingRobot {
    file: Arc<CaseFile>,
    simulation: Simulation,
    commands: Commands,
}

impl MovingRobot {
    pub(crate) fn new(robot: &RobotFile) -> Result<Self, Failure> {
        let file = Arc::clone(&robot.file);
        let (robot, case) = (&file.robot, &file.case);
        let mut commands = file.motion.commands(robot, case);
        let simulation = Simulation::with_commands(robot, case, &commands, file.motion.options());
        let simulation = simulation.map_err(|error| motion_failure(&file, &error))?;
        // Memory for commands of the motors, so that they take none later.
        commands.motors.resize(robot.motors().len(), None);
        Ok(Self { simulation, commands, file })
    }

    pub(crate) fn file(&self) -> &CaseFile {
        &self.file
    }

    pub(crate) fn set_tensions(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        check_tensions(tensions)?;
        for (i, &tension) in tensions.iter().enumerate() {
            self.commands.set_tension(i, tension);
        }
        self.commands.motors.fill(None);
        Ok(())
    }

    pub(crate) fn set_shortenings(&mut self, shortenings: &[f64]) {
        for (i, &by) in shortenings.iter().enumerate() {
            self.commands.set_shortening(i, by);
        }
        self.commands.motors.fill(None);
    }

    /// Of each cable its shortening where the flag is 1, else its tension.
    pub(crate) fn set_commands(
        &mut self,
        commands: &[f64],
        by_shortening: &[u8],
    ) -> Result<(), Failure> {
        check_commands(commands, by_shortening)?;
        for (i, (&value, &flag)) in commands.iter().zip(by_shortening).enumerate() {
            match flag {
                0 => self.commands.set_tension(i, value),
                _ => self.commands.set_shortening(i, value),
            }
        }
        self.commands.motors.fill(None);
        Ok(())
    }

    pub(crate) fn set_motors(&mut self, commands: &[f64]) -> Result<(), Failure> {
        check_motors(&self.file.robot, commands)?;
        for (of, &command) in self.commands.motors.iter_mut().zip(commands) {
            *of = Some(Course::constant(command));
        }
        Ok(())
    }

    pub(crate) fn step(&mut self, dt: f64) -> Result<(), Failure> {
        let Self { file, simulation, commands } = self;
        let stepped = simulation.step(commands, dt);
        stepped.map(drop).map_err(|error| motion_failure(file, &error))
    }

    pub(crate) const fn state(&self) -> &State {
        self.simulation.state()
    }
}
