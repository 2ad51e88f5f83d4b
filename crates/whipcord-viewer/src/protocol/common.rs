//! Parts of several messages.

use serde::{Deserialize, Serialize};

/// A frame in the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of its origin in m.
    pub position: [f64; 3],
    /// How it is turned.
    pub orientation: [f64; 4],
}

/// A warning: the input is valid but probably a mistake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// What, with the line of the file where there is one.
    pub message: String,
    /// What to do about it.
    pub help: String,
}
