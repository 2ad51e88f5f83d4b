use thiserror::Error;
use whipcord_numerics::Vec3;

use crate::camera::error::ViewError;
use whipcord::format::{Round, millimetres, significant};

/// Why a camera cannot be located.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LocateError {
    /// Too few points.
    #[error("a camera's pose needs {least} points or more, but {given} {} given", if *given == 1 { "is" } else { "are" })]
    TooFew {
        /// Points given.
        given: usize,
        /// Fewest points that do.
        least: usize,
    },
    /// A point that cannot be used.
    #[error("point {}: {error}", sighting + 1)]
    Unseen {
        /// Number of the point, from 0.
        sighting: usize,
        /// What is wrong with it.
        error: ViewError,
    },
    /// All points in one place.
    #[error("the points lie within {} of one another: no pose can be had from them", millimetres(*spread, Round::Up))]
    Coincident {
        /// Their root mean square distance from their centre, in m.
        spread: f64,
    },
    /// The points are on one line, about which the camera may go round.
    #[error(
        "the points are on one line, along ({}, {}, {}), and look the same from all sides of it: add a marker off the line, or give the direction in which the camera looks",
        direction(axis.x), direction(axis.y), direction(axis.z)
    )]
    FreeTurn {
        /// The line in the world: a unit vector.
        axis: Vec3,
    },
    /// The viewing direction is along the line of the points, and says nothing of the turn about it.
    #[error(
        "the direction in which the camera looks is along the line of the points: give one that is across it"
    )]
    ViewAlongLine,
    /// A viewing direction that is zero or not finite.
    #[error("the direction in which the camera looks must be finite, and not zero")]
    NoDirection,
    /// No pose has all points in view.
    #[error(
        "no pose of the camera explains the {given} points: check that each pixel goes with its point, and that the lens is the one of the photograph"
    )]
    NoPose {
        /// Points given.
        given: usize,
    },
}

fn direction(component: f64) -> String {
    significant((component * 1e4).round() / 1e4, 4, Round::Nearest)
}
