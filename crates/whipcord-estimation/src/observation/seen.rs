//! Markers that were seen of a robot.

use whipcord_numerics::{UnitQuaternion, Vec3};

use whipcord::robot::Disks;

/// One marker, seen once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Step of actuation, from 0; 0 where the case has no steps.
    pub step: usize,
    /// Where on the backbone the marker sits.
    pub place: Place,
    /// Where the marker is in the frame at its place, in m.
    pub offset: Vec3,
    /// What was seen of it.
    pub seen: Seen,
    /// Standard deviation of each number that was seen, in m or pixels, where it is known.
    pub deviation: Option<f64>,
}

/// A place on the backbone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A disk, from 0.
    Disk(usize),
    /// An arc length in m.
    ArcLength(f64),
}

impl Place {
    /// Where on the backbone it is, in m. The disk is one of these.
    #[must_use]
    pub fn arc_length(self, disks: &Disks) -> f64 {
        match self {
            Self::Disk(disk) => disks.arc_lengths[disk],
            Self::ArcLength(arc_length) => arc_length,
        }
    }
}

/// What was seen of a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// Its position in m, in the frame of the measurement.
    Position(Vec3),
    /// Its place in an image.
    Pixel {
        /// Number of the camera, from 0.
        camera: usize,
        /// Column and row in pixels; the centre of the first pixel is (0, 0).
        pixel: [f64; 2],
    },
    /// How a body at its place is turned: the rotation from the frame of the body to that of the measurement. A turn of 1 rad counts as much as a
    /// distance of `arm` in m.
    Rotation {
        /// The rotation.
        rotation: UnitQuaternion,
        /// The distance in m.
        arm: f64,
    },
}

impl Seen {
    /// Whether it is a position.
    #[must_use]
    pub const fn is_position(self) -> bool {
        matches!(self, Self::Position(_))
    }

    /// Whether it is how a body is turned.
    #[must_use]
    pub const fn is_rotation(self) -> bool {
        matches!(self, Self::Rotation { .. })
    }

    /// Whether it is a place in an image.
    #[must_use]
    pub const fn is_in_image(self) -> bool {
        matches!(self, Self::Pixel { .. })
    }
}
