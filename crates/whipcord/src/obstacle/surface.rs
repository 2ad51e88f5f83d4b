//! What a point sees of an obstacle.

use whipcord_numerics::Vec3;

/// The surface of an obstacle as a point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Distance of the point from the surface in m, negative inside the obstacle.
    pub distance: f64,
    /// Gradient of the distance: a unit vector out of the obstacle.
    pub normal: Vec3,
}
