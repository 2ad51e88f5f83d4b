//! Where a solution gives the shape.

use whipcord_numerics::equally_spaced;

use crate::robot::{Robot, RobotError, check_on_backbone, limits};

/// At which arc lengths a solution gives the shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Stations {
    /// At the disks.
    #[default]
    Disks,
    /// At this many equally spaced places, both ends included; at least 2, at most [`limits::MOST_STATIONS`].
    Equal(usize),
    /// At these arc lengths in m.
    At(Vec<f64>),
}

impl Stations {
    /// Refuses a station that is not on the backbone, and more of them than anyone can look at.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), RobotError> {
        match self {
            Self::Disks => Ok(()),
            Self::Equal(count) => limits::check_number("stations", *count, limits::MOST_STATIONS),
            Self::At(arc_lengths) => {
                limits::check_count("stations", arc_lengths.len(), limits::MOST_STATIONS)?;
                let length = robot.backbone().length;
                arc_lengths
                    .iter()
                    .try_for_each(|&s| check_on_backbone("arc length of a station", s, length))
            }
        }
    }

    /// The arc lengths in m for a robot.
    #[must_use]
    pub fn arc_lengths(&self, robot: &Robot) -> Vec<f64> {
        match self {
            Self::Disks => robot.disks().arc_lengths.clone(),
            Self::At(arc_lengths) => arc_lengths.clone(),
            Self::Equal(count) => {
                equally_spaced(0.0, robot.backbone().length, (*count).max(2)).collect()
            }
        }
    }
}
