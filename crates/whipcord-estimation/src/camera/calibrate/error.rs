use thiserror::Error;

use crate::camera::error::CameraError;
use crate::camera::locate::LocateError;

/// Why a camera cannot be calibrated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrateError {
    /// Too few photographs.
    #[error("a calibration needs {least} photographs of the board or more, but {given} {} given", if *given == 1 { "is" } else { "are" })]
    TooFew {
        /// Photographs given.
        given: usize,
        /// Fewest that do.
        least: usize,
    },
    /// Too few points for what is sought.
    #[error(
        "{points} points in the photographs are too few for the {unknowns} unknowns of lens and places: {least} or more are needed"
    )]
    TooFewPoints {
        /// Points in all photographs.
        points: usize,
        /// Numbers that are sought.
        unknowns: usize,
        /// Fewest points that do.
        least: usize,
    },
    /// The board's points are not on a plane, or too few of them are seen.
    #[error("photograph {}: a board has four points or more, on a plane and on no line, but this one's {points} do not", view + 1)]
    NoBoard {
        /// Number of the photograph, from 0.
        view: usize,
        /// Points seen in it.
        points: usize,
    },
    /// Nothing tells the focal length.
    #[error(
        "the photographs do not tell the focal length{}: the boards in them are tilted by no more than some {:.1}° to one another; tilt the board to the camera by some 30°, differently in each",
        within(*relative), tilt.to_degrees()
    )]
    NoFocalLength {
        /// Greatest angle between the planes of two boards in rad, as far as it can be told.
        tilt: f64,
        /// Standard deviation of the focal length, relative to it; none where it may be anything.
        relative: Option<f64>,
    },
    /// The board has no place in front of the camera.
    #[error("photograph {}: {error}", view + 1)]
    NotLocated {
        /// Number of the photograph, from 0.
        view: usize,
        /// Why.
        error: LocateError,
    },
    /// The iteration found no minimum.
    #[error(
        "no lens explains the photographs: {rms:.3} pixels RMS are left after {iterations} steps; ask for fewer coefficients, or take more photographs"
    )]
    NotConverged {
        /// What is left, in pixels.
        rms: f64,
        /// Steps taken.
        iterations: usize,
    },
    /// A residual or a derivative left what is computed with.
    #[error(
        "no lens explains the photographs: check that all show this board, and are of one camera"
    )]
    NoLens,
    /// A lens or a place out of range.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

impl CalibrateError {
    /// The same, of a photograph that has another number.
    #[must_use]
    pub fn renumbered(self, number: impl FnOnce(usize) -> usize) -> Self {
        match self {
            Self::NoBoard { view, points } => Self::NoBoard { view: number(view), points },
            Self::NotLocated { view, error } => Self::NotLocated { view: number(view), error },
            other => other,
        }
    }
}

fn within(relative: Option<f64>) -> String {
    relative.map_or_else(String::new, |share| format!(" to better than ±{:.0} %", 100.0 * share))
}
