//! A model against what a camera saw.

use whipcord_numerics::Vec3;

use super::distances::root_mean_square;
use super::order::is_reversed;
use super::places::places;
use super::seen::{Observation, Place, Seen};
use crate::camera::{Camera, ReprojectionError};
use whipcord::case::Case;
use whipcord::error::SolveError;
use whipcord::model::Model;
use whipcord::robot::Robot;
use whipcord::shape::Shape;
use whipcord::solution::Solution;
use whipcord::stations::Stations;

/// A marker in a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InImage {
    /// All that is known of it.
    pub seen: Observation,
    /// Where on the backbone it sits, in m.
    pub arc_length: f64,
    /// Where it was seen: column and row.
    pub pixel: [f64; 2],
}

/// A model's answer over a photograph.
#[derive(Clone, Debug)]
pub struct Overlaid {
    /// At the disks.
    pub solution: Solution,
    /// With more stations, for pictures; the same where no answer is found there.
    pub fine: Shape,
    /// How far it is from each marker that was seen; `None` where the camera does not see it there.
    pub residuals: Vec<Option<ReprojectionError>>,
}

/// Root mean squares over the markers that are not at the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rms {
    /// In pixels.
    pub pixels: f64,
    /// In m, from the rays through the pixels.
    pub distance: f64,
}

impl InImage {
    /// Number of its disk, from 1; none where it is between disks.
    #[must_use]
    pub const fn disk(&self) -> Option<usize> {
        match self.seen.place {
            Place::Disk(disk) => Some(disk + 1),
            Place::ArcLength(_) => None,
        }
    }

    /// Whether it does not move with the robot.
    #[must_use]
    pub fn is_at_base(&self) -> bool {
        self.arc_length == 0.0
    }
}

/// What camera number `camera` saw of the robot in a step, both from 0.
#[must_use]
pub fn in_image(
    robot: &Robot,
    observations: &[Observation],
    camera: usize,
    step: usize,
) -> Vec<InImage> {
    let seen = observations.iter().filter(|observation| observation.step == step);
    seen.filter_map(|observation| match observation.seen {
        Seen::Pixel { camera: by, pixel } if by == camera => {
            let arc_length = observation.place.arc_length(robot.disks());
            Some(InImage { seen: *observation, arc_length, pixel })
        }
        _ => None,
    })
    .collect()
}

impl Overlaid {
    /// Whether the markers on the axis fit far better in opposite order.
    #[must_use]
    pub fn is_reversed(&self, markers: &[InImage]) -> bool {
        let on_axis =
            markers.iter().zip(&self.residuals).filter(|(m, _)| m.seen.offset == Vec3::ZERO);
        let places: Vec<_> = on_axis
            .filter_map(|(marker, miss)| Some((marker.arc_length, marker.pixel, (*miss)?.pixel)))
            .collect();
        is_reversed(&places)
    }

    /// Over the markers that are not at the base, which holds them whatever the model says; `None` where
    /// there are none.
    #[must_use]
    pub fn rms(&self, markers: &[InImage]) -> Option<Rms> {
        let misses = || {
            let moving = markers.iter().zip(&self.residuals).filter(|(m, _)| !m.is_at_base());
            moving.filter_map(|(_, miss)| *miss)
        };
        let pixels = root_mean_square(misses().map(|miss| miss.pixels))?;
        let distance = root_mean_square(misses().map(|miss| miss.distance))?;
        Some(Rms { pixels, distance })
    }
}

/// Solves a case, through all its steps, by a model and says how far the answer is from the markers that a camera saw.
/// `stations` is how many a picture needs; those of the model itself do not matter.
///
/// # Errors
/// [`SolveError`] where the model has no answer.
pub fn overlay(
    model: &Model,
    robot: &Robot,
    case: &Case,
    camera: &Camera,
    markers: &[InImage],
    stations: usize,
) -> Result<Overlaid, SolveError> {
    let mut prepared = model.at(Stations::Disks).prepare(robot, &case.loads)?;
    let solution = prepared.solve_to_the_end(case).map_err(|(_, error)| error)?;
    let follow = |stations| -> Result<Shape, SolveError> {
        let mut prepared = model.at(stations).prepare(robot, &case.loads)?;
        Ok(prepared.solve(case, Some(&solution))?.shape)
    };
    let fine = follow(Stations::Equal(stations)).unwrap_or_else(|_| solution.shape.clone());
    let places = places(model, robot, case, &solution, markers.iter().map(|marker| &marker.seen))?;
    let residuals = places
        .into_iter()
        .zip(markers)
        .map(|(place, m)| camera.reprojection_error(place, m.pixel).ok());
    let residuals = residuals.collect();
    Ok(Overlaid { solution, fine, residuals })
}
