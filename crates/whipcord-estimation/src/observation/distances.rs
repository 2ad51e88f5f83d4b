//! A model against what was measured in space.

use thiserror::Error;
use whipcord_numerics::{Pose, Vec3};

use super::order::is_reversed;
use super::places::places_in_steps;
use super::seen::{Observation, Place, Seen};
use crate::registration::{Aligned, Alignment, RegistrationError, align};
use whipcord::case::Case;
use whipcord::error::SolveError;
use whipcord::kind::ModelKind;
use whipcord::robot::{Disks, Robot};
use whipcord::solution::Solution;

/// The answers to all steps of a case beside what was measured in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// The markers.
    pub markers: Vec<Apart>,
    /// How the measurement was moved onto the answers, where that was asked for.
    pub motion: Option<Pose>,
    /// Numbers of the markers that count less in this motion, as they are far off ([`Aligned::lowered`]).
    pub lowered: Vec<usize>,
}

/// A marker that was measured, and where a model has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// The step of actuation in which it was measured, from 0.
    pub step: usize,
    /// Number of the disk, from 1, whose centre it is.
    pub disk: Option<usize>,
    /// Where on the backbone it is, in m.
    pub arc_length: f64,
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

impl Apart {
    /// Distance in m of the model's place from the measured one.
    #[must_use]
    pub fn distance(&self) -> f64 {
        (self.model - self.measured).norm()
    }
}

impl Distances {
    /// The markers that are not at the base, which holds them whatever the model says. They are what
    /// [`Self::rms`] is taken over.
    pub fn moving(&self) -> impl Iterator<Item = &Apart> {
        self.markers.iter().filter(|marker| !marker.at_base)
    }

    /// In how many steps a marker was measured that is not at the base.
    #[must_use]
    pub fn steps(&self) -> usize {
        let mut steps: Vec<usize> = self.moving().map(|marker| marker.step).collect();
        steps.sort_unstable();
        steps.dedup();
        steps.len()
    }

    /// Root mean square distance in m over the markers of all steps that are not at the base; `None` where
    /// there are none.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        root_mean_square(self.moving().map(Apart::distance))
    }

    /// Whether in any step the centres of disks fit far better in opposite order.
    #[must_use]
    pub fn is_reversed(&self) -> bool {
        let mut disks: Vec<(&Apart, usize)> =
            self.markers.iter().filter_map(|marker| Some((marker, marker.disk?))).collect();
        disks.sort_by_key(|(marker, _)| marker.step);
        disks.chunk_by(|(a, _), (b, _)| a.step == b.step).any(|step| {
            let of_step: Vec<_> = step
                .iter()
                .map(|(marker, disk)| {
                    (*disk as f64, marker.measured.to_array(), marker.model.to_array())
                })
                .collect();
            is_reversed(&of_step)
        })
    }

    /// Where a disk was in a step, by its number from 1 and the number of the step from 0.
    #[must_use]
    pub fn disk(&self, step: usize, number: usize) -> Option<Vec3> {
        let is_it = |marker: &&Apart| marker.step == step && marker.disk == Some(number);
        Some(self.markers.iter().find(is_it)?.measured)
    }

    /// Root mean square distance in m of a disk over all steps in which it was measured, by its number from 1.
    #[must_use]
    pub fn rms_of_disk(&self, number: usize) -> Option<f64> {
        let of_disk = self.markers.iter().filter(|marker| marker.disk == Some(number));
        root_mean_square(of_disk.map(Apart::distance))
    }
}

/// `None` of nothing.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) =
        values.fold((0.0, 0_usize), |(sum, count), value| (sum + value * value, count + 1));
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// What was measured in space in any step: each with its position in m, in the frame of the measurement.
pub fn in_space(observations: &[Observation]) -> impl Iterator<Item = (&Observation, Vec3)> {
    observations.iter().filter_map(|observation| match observation.seen {
        Seen::Position(position) => Some((observation, position)),
        Seen::Pixel { .. } | Seen::Rotation { .. } => None,
    })
}

/// Positions in m, in the world, of what was measured in space in the last step: moved onto the answers as
/// `alignment` says, by the motion that [`distances`] finds from all steps.
///
/// # Errors
/// As [`distances`], where the measurement has to be moved.
pub fn measured_in_world(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    answers: &[&Solution],
    observations: &[Observation],
    alignment: Alignment,
) -> Result<Vec<Vec3>, Incomparable> {
    let last = case.before.len();
    if alignment == Alignment::None {
        let of_last = in_space(observations).filter(|(seen, _)| seen.step == last);
        return Ok(of_last.map(|(_, position)| position).collect());
    }
    let moved = distances(kind, robot, case, answers, observations, alignment)?;
    let markers = moved.into_iter().flat_map(|distances| distances.markers);
    Ok(markers.filter(|marker| marker.step == last).map(|marker| marker.measured).collect())
}

/// The disk, from 0, at a place: also one that is given by the arc length of a disk, but for rounding.
fn disk_at(place: Place, disks: &Disks) -> Option<usize> {
    const ROUNDING: f64 = 1e-9;
    match place {
        Place::Disk(disk) => Some(disk),
        Place::ArcLength(_) if !disks.are_present => None,
        Place::ArcLength(s) => {
            let near = ROUNDING * disks.arc_lengths.last()?;
            disks.arc_lengths.iter().position(|disk| (disk - s).abs() <= near)
        }
    }
}

/// Compares the answers to all steps of a case, at the disks, with what was measured in space in each step;
/// `None` where nothing was. Where `alignment` asks for it, the measurement is moved onto the answers by one
/// motion for all steps: the frame of the measurement stays where it is while the robot moves. The answers are in
/// the order of the steps, one for a case without steps. What was seen is on the robot.
///
/// # Errors
/// [`Incomparable`] where a marker has no place in the model, or the motion is not fixed.
pub fn distances(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    answers: &[&Solution],
    observations: &[Observation],
    alignment: Alignment,
) -> Result<Option<Distances>, Incomparable> {
    let seen: Vec<_> =
        in_space(observations).filter(|(seen, _)| seen.step < answers.len()).collect();
    if seen.is_empty() {
        return Ok(None);
    }
    let markers: Vec<&Observation> = seen.iter().map(|(seen, _)| *seen).collect();
    let model =
        places_in_steps(kind, robot, case, answers, &markers).map_err(Incomparable::Between)?;
    let mut markers: Vec<Apart> = seen
        .into_iter()
        .zip(model)
        .map(|((seen, measured), model)| Apart {
            step: seen.step,
            disk: disk_at(seen.place, robot.disks())
                .filter(|_| seen.offset == Vec3::ZERO)
                .map(|disk| disk + 1),
            arc_length: seen.place.arc_length(robot.disks()),
            measured,
            model,
            at_base: seen.place.arc_length(robot.disks()) == 0.0,
        })
        .collect();
    let pairs = markers.iter().map(|marker| ([marker.measured, marker.model], marker.at_base));
    let Aligned { motion, lowered } = align(pairs, alignment)?;
    for marker in &mut markers {
        marker.measured = motion.map_or(marker.measured, |pose| pose.transform(marker.measured));
    }
    Ok(Some(Distances { markers, motion, lowered }))
}
