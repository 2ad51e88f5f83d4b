//! `[measured]`: where the disks and markers of the real robot were.

mod csv;
mod grid;
mod rows;

use std::path::PathBuf;

use whipcord::{Observation, Place, Seen, Vec3};

use crate::check::Fields;
use crate::error::Problems;
use crate::files;
use crate::source::{Sources, Span};
use rows::Known;

/// What was seen of the real robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// All that was seen, by step, then by place.
    pub observations: Vec<Observation>,
    /// The centres of disks whose positions were measured in the last step, in ascending order.
    pub disks: Vec<MeasuredDisk>,
    /// The file they were read from.
    pub path: PathBuf,
}

/// Where one disk was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredDisk {
    /// Number of the disk, from 1.
    pub disk: usize,
    /// Position of its centre in m, in the frame of the measurement.
    pub position: Vec3,
}

/// The robot that was measured, as far as what was seen refers to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Number of its disks, where that is known.
    pub disks: Option<usize>,
    /// Length of its backbone in m, where that is known.
    pub length: Option<f64>,
    /// Steps of actuation; 0 where there is one alone.
    pub steps: usize,
}

/// Units that lengths may have in a table.
pub(crate) const UNITS: [&str; 5] = ["m", "cm", "mm", "um", "in"];

/// Reads the file that `[measured]` names. `named` is where it does so.
pub(crate) fn read(
    fields: &Fields,
    named: Span,
    robot: Extent,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Measured> {
    let path = sources.resolve(named.file, fields.text("disks")?);
    let (file, text) = files::read_named(&path, files::LARGEST_TABLE, named, sources, problems)?;
    let grid = csv::grid(&text, file, problems)?;
    let unit = fields.text("unit").unwrap_or("m");
    let known = Known {
        robot,
        unit: UNITS.into_iter().find(|name| *name == unit)?,
        deviation: fields.number("deviation"),
    };
    let observations = rows::observations(&grid, &known, problems)?;
    let last = robot.steps.saturating_sub(1);
    let disks = observations.iter().filter(|seen| seen.step == last).filter_map(centre).collect();
    Some(Measured { observations, disks, path })
}

/// The centre of a disk, where that is what was seen.
fn centre(observation: &Observation) -> Option<MeasuredDisk> {
    match (observation.place, observation.seen) {
        (Place::Disk(disk), Seen::Position(position)) if observation.offset == Vec3::ZERO => {
            Some(MeasuredDisk { disk: disk + 1, position })
        }
        _ => None,
    }
}
