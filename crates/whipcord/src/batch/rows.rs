use std::borrow::Cow;

use super::error::BatchError;
use crate::case::{CableCommand, Case, Loads, Shortening};

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
    /// Cases of any kind: one robot under many loads, for one.
    Cases(&'a [Case]),
}

impl Rows<'_> {
    /// How many rows there are for a robot of so many cables.
    pub(super) fn count(&self, cables: usize) -> Result<usize, BatchError> {
        let given = match self {
            Self::Cases(cases) => return Ok(cases.len()),
            Self::Tensions { values, .. } | Self::Shortenings { values, .. } => values.len(),
        };
        match (given, cables) {
            (0, _) => Ok(0),
            (_, 0) => Err(BatchError::NoCables),
            _ if given % cables == 0 => Ok(given / cables),
            _ => Err(BatchError::Width { given, cables }),
        }
    }

    /// The loads that the model is built for at first.
    pub(super) fn first_loads(&self) -> Cow<'_, Loads> {
        match self {
            Self::Tensions { case, .. } | Self::Shortenings { case, .. } => {
                Cow::Borrowed(&case.loads)
            }
            Self::Cases([first, ..]) => Cow::Borrowed(&first.loads),
            Self::Cases([]) => Cow::Owned(Loads::default()),
        }
    }

    /// What rows of commands are written to, one after the other.
    pub(super) fn blank(&self) -> Case {
        match self {
            Self::Tensions { case, .. } | Self::Shortenings { case, .. } => (*case).clone(),
            Self::Cases(_) => Case::default(),
        }
    }

    /// The case of row `row`: as it was given, or with its commands written to `blank`.
    pub(super) fn case<'c>(&'c self, row: usize, cables: usize, blank: &'c mut Case) -> &'c Case {
        let mut set = |values: &[f64], command: fn(f64) -> CableCommand| {
            let values = &values[row * cables..(row + 1) * cables];
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
            Self::Cases(cases) => return &cases[row],
        }
        blank
    }
}
