//! What stands in the robot's way.

use serde::{Deserialize, Serialize};

use crate::protocol::common::Pose;

/// A body in the robot's way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Obstacle {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub pose: Pose,
    /// Its form, in its own frame.
    pub form: Form,
}

/// The form of an obstacle, as robot files have it; lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Form {
    /// All below the plane z = 0.
    HalfSpace,
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A cylinder with round ends, along z.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Of the cylinder.
        length: f64,
    },
    /// A box.
    Box {
        /// Its edges.
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its length.
        length: f64,
    },
    /// A bore around a line.
    Pipe {
        /// Its radius.
        radius: f64,
        /// Points of its middle line.
        middle: Vec<[f64; 3]>,
    },
    /// |x/a|, |y/b|, |z/c| with these exponents.
    Superellipsoid {
        /// a, b and c.
        semi_axes: [f64; 3],
        /// North to south, and around.
        exponents: [f64; 2],
    },
    /// Triangles.
    Mesh {
        /// Corners.
        vertices: Vec<[f64; 3]>,
        /// Three corners each, counter-clockwise as seen from outside.
        triangles: Vec<[u32; 3]>,
    },
}
