//! What the cables and motors are told to do over time.

use whipcord::{Case, Robot, Shortening};

use crate::course::Course;
use crate::error::{MotionError, count};

/// What drives one cable.
#[derive(Clone, Debug, PartialEq)]
pub enum CableDrive {
    /// Its tension in N, not negative.
    Tension(Course),
    /// By how much in m the length that it has at rest is shortened: it is never longer than that, but for its stretch and that of its drive,
    /// and has no tension where it is shorter.
    Shortening(Course),
}

impl CableDrive {
    /// What it is told, a tension or a shortening.
    #[must_use]
    pub const fn course(&self) -> &Course {
        match self {
            Self::Tension(course) | Self::Shortening(course) => course,
        }
    }
}

/// Commands of all cables and motors over time. The times are those of the simulation.
///
/// ```
/// use whipcord_motion::{CableDrive, Commands, Course};
///
/// // One cable, pulled by 4 N from 0.1 s on.
/// let step = Course::table(vec![0.1, 0.1], vec![0.0, 4.0])?;
/// let commands = Commands::new(vec![CableDrive::Tension(step)]);
/// assert_eq!(Commands::tensions(&[4.0]).cables.len(), commands.cables.len());
/// # Ok::<(), whipcord_motion::MotionError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commands {
    /// One for each cable of the robot.
    pub cables: Vec<CableDrive>,
    /// Angles in rad or travels in m of the motors, one for each motor of the robot, or none at all. The cables of a motor with a command are
    /// driven by it.
    pub motors: Vec<Option<Course>>,
}

impl Commands {
    /// These commands of the cables.
    #[must_use]
    pub const fn new(cables: Vec<CableDrive>) -> Self {
        Self { cables, motors: Vec::new() }
    }

    /// Constant tensions in N.
    #[must_use]
    pub fn tensions(tensions: &[f64]) -> Self {
        Self::new(tensions.iter().map(|&t| CableDrive::Tension(Course::constant(t))).collect())
    }

    /// Constant shortenings in m.
    #[must_use]
    pub fn shortenings(shortenings: &[f64]) -> Self {
        let drive = |&by: &f64| CableDrive::Shortening(Course::constant(by));
        Self::new(shortenings.iter().map(drive).collect())
    }

    /// The commands of a case, constant: of each cable the tension where it is given, else the shortening, else no tension; and those of the
    /// motors in its last step.
    #[must_use]
    pub fn of_case(robot: &Robot, case: &Case) -> Self {
        let drive = |i: usize| {
            let command = case.commands.get(i).copied().unwrap_or_default();
            match (command.tension, command.shortening) {
                (Some(tension), _) => CableDrive::Tension(Course::constant(tension)),
                (None, Some(Shortening::Length(by))) => {
                    CableDrive::Shortening(Course::constant(by))
                }
                (None, Some(Shortening::Fraction(part))) => {
                    let by = part * robot.cable_length(i);
                    CableDrive::Shortening(Course::constant(by))
                }
                (None, None) => CableDrive::Tension(Course::constant(0.0)),
            }
        };
        let motors = match case.motors.last() {
            Some(last) => last.iter().map(|command| command.map(Course::constant)).collect(),
            None => Vec::new(),
        };
        Self { cables: (0..robot.cables().len()).map(drive).collect(), motors }
    }

    /// The values of all commands at a time in s, behind a jump there, held constant.
    #[must_use]
    pub fn held_at(&self, time: f64) -> Self {
        let held = |course: &Course| Course::constant(course.after(time));
        let of_cable = |drive: &CableDrive| match drive {
            CableDrive::Tension(course) => CableDrive::Tension(held(course)),
            CableDrive::Shortening(course) => CableDrive::Shortening(held(course)),
        };
        let of_motor = |course: &Option<Course>| course.as_ref().map(held);
        Self {
            cables: self.cables.iter().map(of_cable).collect(),
            motors: self.motors.iter().map(of_motor).collect(),
        }
    }

    /// Sets a constant tension in N.
    pub fn set_tension(&mut self, cable: usize, tension: f64) {
        if let Some(drive) = self.cables.get_mut(cable) {
            *drive = CableDrive::Tension(Course::constant(tension));
        }
    }

    /// Sets a constant shortening in m.
    pub fn set_shortening(&mut self, cable: usize, by: f64) {
        if let Some(drive) = self.cables.get_mut(cable) {
            *drive = CableDrive::Shortening(Course::constant(by));
        }
    }

    pub(crate) fn check(&self, robot: &Robot) -> Result<(), MotionError> {
        count("commands of cables", self.cables.len(), robot.cables().len())?;
        if !self.motors.is_empty() {
            count("commands of motors", self.motors.len(), robot.motors().len())?;
        }
        Ok(())
    }

    /// All courses.
    fn courses(&self) -> impl Iterator<Item = &Course> {
        self.cables.iter().map(CableDrive::course).chain(self.motors.iter().flatten())
    }

    /// The first jump after `from` and before `to`.
    pub(crate) fn next_jump(&self, from: f64, to: f64) -> Option<f64> {
        self.courses().filter_map(|course| course.next_jump(from, to)).min_by(f64::total_cmp)
    }

    /// Writes the tensions of cables that all are driven by them, before any jump at a time.
    pub(crate) fn tensions_at(&self, time: f64, out: &mut [f64]) {
        for (tension, drive) in out.iter_mut().zip(&self.cables) {
            *tension = drive.course().before(time).max(0.0);
        }
    }

    /// The motor that drives a cable, and its command.
    pub(crate) fn motor_of(&self, robot: &Robot, cable: usize) -> Option<(usize, &Course)> {
        let motor = robot.motor_of(cable)?;
        Some((motor, self.motors.get(motor)?.as_ref()?))
    }
}
