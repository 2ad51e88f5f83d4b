use thiserror::Error;

use crate::camera::error::CameraError;
use crate::camera::locate::LocateError;

/// Why the pose of a second camera cannot be found.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StereoError {
    /// No pair can be used.
    #[error(
        "none of the {given} pairs of photographs can be used{}: both photographs of a pair must show the board at one time",
        first.map(|(pair, why)| format!("; pair {}: {why}", pair + 1)).unwrap_or_default()
    )]
    NoPair {
        /// Pairs given.
        given: usize,
        /// The first of them, from 0, and why it cannot be used.
        first: Option<(usize, RefusedPair)>,
    },
    /// Two poses of the second camera are as good.
    #[error(
        "the pairs do not tell two poses of the second camera apart, which differ by a turn of {:.0}° ({:.3} and {:.3} pixels RMS): add pairs with the board tilted and turned differently in each, or use a ChArUco board",
        turn.to_degrees(), rms[0], rms[1]
    )]
    Ambiguous {
        /// Angle between the two in rad.
        turn: f64,
        /// What each of them leaves, in pixels.
        rms: [f64; 2],
    },
    /// The iteration found no minimum.
    #[error(
        "no pose of the second camera explains the pairs: {rms:.3} pixels RMS are left; check that the photographs are in the same order and of one time each, and that nothing moved between the cameras"
    )]
    NotConverged {
        /// What is left, in pixels.
        rms: f64,
    },
    /// A residual or a derivative left what is computed with.
    #[error(
        "no pose of the second camera explains the pairs: check that the photographs of both cameras are in the same order and show the same board"
    )]
    NoPose,
    /// The corners do not determine the pose.
    #[error(
        "the pairs do not determine the pose of the second camera: add pairs with the board tilted by some 30°, differently in each"
    )]
    Undetermined,
    /// Both cameras are in one place.
    #[error(
        "the second camera is {:.3} mm from the first, with a standard deviation of {:.3} mm: two cameras determine points only from two places",
        1e3 * baseline, 1e3 * deviation
    )]
    NoBaseline {
        /// Distance of the cameras in m.
        baseline: f64,
        /// Its standard deviation in m.
        deviation: f64,
    },
    /// A lens or a pose out of range.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// Why a pair of photographs is not used.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RefusedPair {
    /// A photograph does not locate its camera before the board.
    #[error("photograph of camera {}: {error}", camera + 1)]
    NotLocated {
        /// Number of the camera, from 0.
        camera: usize,
        /// Why.
        error: LocateError,
    },
    /// The pair contradicts the others.
    #[error(
        "it contradicts the other pairs, with {rms:.1} pixels RMS where the others leave {others:.2}: its photographs are not of one time, or not of one another"
    )]
    Contradicts {
        /// What is left of it, in pixels.
        rms: f64,
        /// What is left of most others.
        others: f64,
    },
}
