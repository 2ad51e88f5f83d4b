use std::borrow::Cow;

use super::error::{BatchError, Driven};
use crate::case::{CableCommand, Case, Loads, Shortening};
use crate::robot::Robot;

/// What is asked of the robot, row by row.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// One tension in N for each cable, row after row.
    Tensions {
        /// Rows × cables.
        values: &'a [f64],
        /// What all rows have in common: loads, the pose of the base, earlier steps of actuation. Its
        /// own commands count for nothing.
        case: &'a Case,
    },
    /// One shortening in m for each cable, row after row.
    Shortenings {
        /// Rows × cables.
        values: &'a [f64],
        /// What all rows have in common: loads, the pose of the base, earlier steps of actuation. Its
        /// own commands count for nothing.
        case: &'a Case,
    },
    /// One command for each motor of the robot, an angle in rad or a travel in m, row after row. Each row comes after the
    /// earlier steps of the case alone: no row changes where another finds the play of the drives.
    Motors {
        /// Rows × motors.
        values: &'a [f64],
        /// What all rows have in common: loads, the pose of the base, earlier steps of actuation, commands of
        /// cables without a motor.
        case: &'a Case,
    },
    /// Cases of any kind: one robot under many loads, for one.
    Cases(&'a [Case]),
}

impl Rows<'_> {
    /// How many rows there are for a robot.
    pub(super) fn count(&self, robot: &Robot) -> Result<usize, BatchError> {
        let (given, driven) = match self {
            Self::Cases(cases) => return Ok(cases.len()),
            Self::Tensions { values, .. } | Self::Shortenings { values, .. } => {
                (values.len(), Driven::Cables)
            }
            Self::Motors { values, .. } => (values.len(), Driven::Motors),
        };
        match (given, self.width(robot)) {
            (0, _) => Ok(0),
            (_, 0) => Err(BatchError::NoCommands { driven }),
            (_, count) if given % count == 0 => Ok(given / count),
            (_, count) => Err(BatchError::Width { given, count, driven }),
        }
    }

    /// How many commands a row has for a robot.
    pub(super) fn width(&self, robot: &Robot) -> usize {
        match self {
            Self::Motors { .. } => robot.motors().len(),
            Self::Tensions { .. } | Self::Shortenings { .. } | Self::Cases(_) => {
                robot.cables().len()
            }
        }
    }

    /// The loads that the model is built for at first.
    pub(super) fn first_loads(&self) -> Cow<'_, Loads> {
        match self {
            Self::Tensions { case, .. }
            | Self::Shortenings { case, .. }
            | Self::Motors { case, .. } => Cow::Borrowed(&case.loads),
            Self::Cases([first, ..]) => Cow::Borrowed(&first.loads),
            Self::Cases([]) => Cow::Owned(Loads::default()),
        }
    }

    /// What rows of commands are written to, one after the other.
    pub(super) fn blank(&self) -> Case {
        match self {
            Self::Tensions { case, .. } | Self::Shortenings { case, .. } => {
                case.commanded(Vec::new())
            }
            Self::Motors { case, .. } => (*case).clone(),
            Self::Cases(_) => Case::default(),
        }
    }

    /// The case of row `row`: as it was given, or with its commands written to `blank`.
    pub(super) fn case<'c>(&'c self, row: usize, robot: &Robot, blank: &'c mut Case) -> &'c Case {
        let width = self.width(robot);
        let mut set = |values: &[f64], command: fn(f64) -> CableCommand| {
            let values = &values[row * width..(row + 1) * width];
            blank.commands.clear();
            blank.commands.extend(values.iter().map(|&value| command(value)));
        };
        match self {
            Self::Tensions { values, .. } => {
                set(values, |tension| CableCommand { tension: Some(tension), shortening: None });
            }
            Self::Shortenings { values, .. } => set(values, |shortening| CableCommand {
                tension: None,
                shortening: Some(Shortening::Length(shortening)),
            }),
            Self::Motors { values, .. } => {
                let commands = blank.last_of_motors(robot);
                commands.clear();
                let of_row = &values[row * width..(row + 1) * width];
                commands.extend(of_row.iter().map(|&command| Some(command)));
                // What is wrong with the commands the solve finds in the case itself.
                let _ = blank.drive(robot);
            }
            Self::Cases(cases) => return &cases[row],
        }
        blank
    }
}
