use thiserror::Error;

use crate::camera::error::ViewError;
use whipcord::format::{Round, millimetres};

/// Why two cameras do not determine a point.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TriangulateError {
    /// Both cameras are in one place.
    #[error(
        "both cameras are in one place, {} apart: two cameras determine points only from two places; give cameras with their poses, as a stereo calibration writes them",
        millimetres(*baseline, Round::Up)
    )]
    NoBaseline {
        /// Distance of the cameras in m.
        baseline: f64,
    },
    /// The lines of sight are parallel.
    #[error(
        "the lines of sight of the two cameras are parallel to within {:.3}°, so that the depth is not determined: place the cameras farther apart, or let them look from directions that differ by 30° or more",
        angle.to_degrees()
    )]
    NoParallax {
        /// Angle between the lines of sight in rad.
        angle: f64,
    },
    /// The lines of sight do not meet in front of both cameras, or a pixel has no line of sight.
    #[error("camera {}: {error}", camera + 1)]
    Unseen {
        /// Number of the camera, from 0.
        camera: usize,
        /// What is wrong.
        error: ViewError,
    },
    /// The iteration found no minimum.
    #[error(
        "no point is near both lines of sight: {distance:.1} pixels are left; check that both pixels are of one marker, and that the cameras are those of the photographs"
    )]
    NotConverged {
        /// Distance from the epipolar constraint that is left, in pixels.
        distance: f64,
    },
    /// A standard deviation out of range.
    #[error("the standard deviation of a pixel must be positive and finite, but is {given}")]
    Deviation {
        /// What was given, in pixels.
        given: f64,
    },
}
