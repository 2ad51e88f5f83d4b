//! What was measured on the real robot, and the cameras that saw it.

use serde::{Deserialize, Serialize};

use crate::protocol::common::Pose;

/// A marker that was measured, and where on the robot it sits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// Where it was seen.
    pub seen: Sight,
    /// Where on the backbone it sits, in m; none where that is not known.
    pub arc_length: Option<f64>,
    /// Where it sits in the frame of the cross-section there, in m.
    pub offset: [f64; 3],
}

/// Where a marker was seen, in the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Sight {
    /// At this position in m.
    Position {
        /// The position.
        position: [f64; 3],
    },
    /// On this line of sight of a camera.
    Line {
        /// Number of the camera.
        camera: usize,
        /// Where it starts, in m.
        origin: [f64; 3],
        /// Unit vector along it, away from the camera.
        direction: [f64; 3],
    },
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// What it is called.
    pub name: String,
    /// Where it is: z is the direction in which it looks, y is down in the picture.
    pub pose: Pose,
    /// Its lens without distortion.
    pub lens: Lens,
    /// Columns and rows of its pictures.
    pub size: [f64; 2],
    /// How many places of a row of `ideal` there are.
    pub columns: usize,
    /// Where places of a picture lie without the distortion of the lens, in pixels, row by row: places at equal distances from the
    /// first corner of the picture to the last; none where the distortion has no inverse.
    pub ideal: Vec<Option<[f64; 2]>>,
}

/// A lens without distortion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Lens {
    /// Central projection.
    Pinhole {
        /// Focal lengths in pixels.
        focal: [f64; 2],
        /// The principal point in pixels.
        centre: [f64; 2],
    },
    /// Parallel projection.
    Orthographic {
        /// Pixels to the metre.
        scale: f64,
        /// Where the axis of the camera is seen, in pixels.
        centre: [f64; 2],
    },
}
