//! Vectors and poses as the page gets them.

use whipcord::Vec3;

use crate::protocol::Pose;

/// A vector.
pub fn array(vector: Vec3) -> [f64; 3] {
    vector.to_array()
}

/// A pose.
pub fn pose(pose: &whipcord::Pose) -> Pose {
    Pose { position: array(pose.position), orientation: pose.rotation.wxyz() }
}
