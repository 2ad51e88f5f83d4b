use std::borrow::Cow;

use super::error::BatchError;
use crate::case::{CableCommand, Case, Loads, Shortening};

/// What is asked of the robot, row by row.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// One tension in N for each cable, row after row, under the same loads.
    Tensions {
        /// Rows × cables.
        values: &'a [f64],
        /// The loads of all rows.
        loads: &'a Loads,
    },
    /// One shortening in m for each cable, row after row, under the same loads.
    Shortenings {
        /// Rows × cables.
        values: &'a [f64],
        /// The loads of all rows.
        loads: &'a Loads,
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
            Self::Tensions { loads, .. } | Self::Shortenings { loads, .. } => Cow::Borrowed(loads),
            Self::Cases([first, ..]) => Cow::Borrowed(&first.loads),
            Self::Cases([]) => Cow::Owned(Loads::default()),
        }
    }

    /// Writes row `row` to `case`.
    pub(super) fn case(&self, row: usize, cables: usize, case: &mut Case) {
        let mut set = |values: &[f64], loads: &Loads, command: fn(f64) -> CableCommand| {
            let values = &values[row * cables..(row + 1) * cables];
            case.commands.clear();
            case.commands.extend(values.iter().map(|&value| command(value)));
            case.loads.clone_from(loads);
        };
        match self {
            Self::Tensions { values, loads } => set(values, loads, |tension| CableCommand {
                tension: Some(tension),
                shortening: None,
            }),
            Self::Shortenings { values, loads } => set(values, loads, |shortening| CableCommand {
                tension: None,
                shortening: Some(Shortening::Length(shortening)),
            }),
            Self::Cases(cases) => case.clone_from(&cases[row]),
        }
    }
}
