//! What was seen, and a pose that explains it.

use whipcord_numerics::Vec3;

use crate::camera::view::Camera;

/// A point of the world, and where it was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// The point, in m.
    pub point: Vec3,
    /// Column and row.
    pub pixel: [f64; 2],
}

/// Another pose that explains what was seen as well as its neighbours do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// The camera there.
    pub camera: Camera,
    /// Root mean square distance in pixels.
    pub rms: f64,
}
