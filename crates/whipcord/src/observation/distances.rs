//! A model against what was measured in space.

use thiserror::Error;
use whipcord_numerics::{Pose, Vec3};

use super::{Observation, Place, Seen, is_reversed, places};
use crate::case::Case;
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::registration::{Alignment, RegistrationError, align};
use crate::robot::Robot;
use crate::shape::Solution;

/// An answer beside what was measured in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// The markers.
    pub markers: Vec<Apart>,
    /// How the measurement was moved onto the answer, where that was asked for.
    pub motion: Option<Pose>,
}

/// A marker that was measured, and where a model has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Number of the disk, from 1, whose centre it is.
    pub disk: Option<usize>,
    /// Where it was measured, in m, after the measurement was moved.
    pub measured: Vec3,
    /// Where the model has it.
    pub model: Vec3,
    /// Whether it does not move with the robot.
    pub at_base: bool,
}

/// Why an answer cannot be compared with what was measured.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Incomparable {
    /// The model is not found where markers are.
    #[error("between the disks: {0}")]
    Between(SolveError),
    /// No motion brings the measurement to the answer.
    #[error("the measurement cannot be moved: {0}")]
    Motion(#[from] RegistrationError),
}

impl Distances {
    /// Root mean square distance in m over the markers that are not at the base, which holds them whatever
    /// the model says; `None` where there are none.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        let moving = self.markers.iter().filter(|marker| !marker.at_base);
        root_mean_square(moving.map(|marker| (marker.model - marker.measured).norm()))
    }

    /// Whether the centres of disks fit far better in opposite order.
    #[must_use]
    pub fn is_reversed(&self) -> bool {
        let disks = self.markers.iter().filter_map(|marker| {
            let place = marker.disk? as f64;
            Some((place, marker.measured.to_array(), marker.model.to_array()))
        });
        is_reversed(&disks.collect::<Vec<_>>())
    }

    /// Where a disk was, by its number from 1.
    #[must_use]
    pub fn disk(&self, number: usize) -> Option<Vec3> {
        Some(self.markers.iter().find(|marker| marker.disk == Some(number))?.measured)
    }
}

/// `None` of nothing.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) =
        values.fold((0.0, 0_usize), |(sum, count), value| (sum + value * value, count + 1));
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// What was measured in space after the last step of a case: each with its position in m, in the frame of the
/// measurement.
pub fn in_space<'a>(
    case: &Case,
    observations: &'a [Observation],
) -> impl Iterator<Item = (&'a Observation, Vec3)> {
    let last = case.before.len();
    observations.iter().filter(move |observation| observation.step == last).filter_map(
        |observation| match observation.seen {
            Seen::Position(position) => Some((observation, position)),
            Seen::Pixel { .. } => None,
        },
    )
}

/// Where what was measured in space after the last step lies beside an answer, in m in the world: moved onto that as
/// `alignment` says.
///
/// # Errors
/// As [`distances`], where it has to be moved.
pub fn measured_in_world(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    solution: &Solution,
    observations: &[Observation],
    alignment: Alignment,
) -> Result<Vec<Vec3>, Incomparable> {
    if alignment == Alignment::None {
        return Ok(in_space(case, observations).map(|(_, position)| position).collect());
    }
    let moved = distances(kind, robot, case, solution, observations, alignment)?;
    let markers = moved.into_iter().flat_map(|distances| distances.markers);
    Ok(markers.map(|marker| marker.measured).collect())
}

/// Compares an answer at the disks with what was measured in space after the last step, moved onto it as
/// `alignment` says; `None` where nothing was. What was seen is on the robot.
///
/// # Errors
/// [`Incomparable`] where a marker has no place in the model, or the motion is not fixed.
pub fn distances(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    solution: &Solution,
    observations: &[Observation],
    alignment: Alignment,
) -> Result<Option<Distances>, Incomparable> {
    let seen: Vec<_> = in_space(case, observations).collect();
    if seen.is_empty() {
        return Ok(None);
    }
    let model = places(kind, robot, case, solution, seen.iter().map(|(seen, _)| *seen))
        .map_err(Incomparable::Between)?;
    let mut markers: Vec<Apart> = seen
        .into_iter()
        .zip(model)
        .map(|((seen, measured), model)| Apart {
            disk: match seen.place {
                Place::Disk(disk) if seen.offset == Vec3::ZERO => Some(disk + 1),
                _ => None,
            },
            measured,
            model,
            at_base: seen.place.arc_length(robot.disks()) == 0.0,
        })
        .collect();
    let pairs = markers.iter().map(|marker| ([marker.measured, marker.model], marker.at_base));
    let motion = align(pairs, alignment)?;
    for marker in &mut markers {
        marker.measured = motion.map_or(marker.measured, |pose| pose.transform(marker.measured));
    }
    Ok(Some(Distances { markers, motion }))
}
