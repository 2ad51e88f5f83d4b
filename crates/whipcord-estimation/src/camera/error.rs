use thiserror::Error;

use whipcord::format::{Round, millimetres, significant};
use whipcord::robot::Problem;
use whipcord::robot::limits::Range;

/// Why a camera cannot be.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CameraError {
    /// A number out of its range.
    #[error("the camera's {what} {problem}")]
    Quantity {
        /// Which number.
        what: &'static str,
        /// What is wrong with it.
        problem: Problem,
    },
    /// Distortion coefficients in a number that no model has.
    #[error("a lens has 4, 5, 8, 12 or 14 distortion coefficients, or none, but {given} are given")]
    CoefficientCount {
        /// Coefficients given.
        given: usize,
    },
}

impl CameraError {
    pub(super) fn check(range: Range, what: &'static str, value: f64) -> Result<(), Self> {
        match range.problem(value) {
            None => Ok(()),
            Some(problem) => Err(Self::Quantity { what, problem }),
        }
    }
}

/// Why a camera does not see a point, or looks nowhere through a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ViewError {
    /// A coordinate that is not a number, or beyond what is computed with.
    #[error("a coordinate is {value}, which must be a finite number within 1e9")]
    OutOfRange {
        /// The coordinate, in m or pixels.
        value: f64,
    },
    /// The point is not in front of the camera.
    #[error("the point is not in front of the camera: its depth is {}", millimetres(*depth, Round::Nearest))]
    Behind {
        /// Distance from the camera along the optical axis, in m.
        depth: f64,
    },
    /// The point is so far from the optical axis that the distortion folds the image.
    #[error(
        "the point is {} off the optical axis, where the distortion of the lens folds the image: it can be used up to {}",
        degrees(*angle), degrees(*reach)
    )]
    BeyondLens {
        /// Angle between the optical axis and the point, in rad.
        angle: f64,
        /// [`Distortion::reach`](super::Distortion::reach) in rad; with much tangential distortion or
        /// tilt the lens may end before.
        reach: f64,
    },
    /// No point is seen at the pixel.
    #[error(
        "nothing can be seen at pixel ({}, {}): the distortion of the lens cannot be inverted there",
        pixels(pixel[0]), pixels(pixel[1])
    )]
    NoRay {
        /// Column and row.
        pixel: [f64; 2],
    },
}

fn degrees(angle: f64) -> String {
    format!("{}°", significant(angle.to_degrees(), 4, Round::Nearest))
}

fn pixels(coordinate: f64) -> String {
    significant(coordinate, 6, Round::Nearest)
}
