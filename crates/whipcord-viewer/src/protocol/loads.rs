//! What pulls and pushes at the robot, as the page draws it.

use serde::{Deserialize, Serialize};

/// A force at a place of the backbone, which the page pulls with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pull {
    /// Arc length in m.
    pub arc_length: f64,
    /// In N, in the world.
    pub force: [f64; 3],
}

/// A load of the file that no slider moves. Vectors are those of the frame of the loads, or of the cross-section where they follow it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Load {
    /// At one place.
    Single {
        /// Arc length in m.
        arc_length: f64,
        /// In N.
        force: [f64; 3],
        /// In N·m.
        moment: [f64; 3],
        /// Whether it turns with the cross-section.
        follows: bool,
    },
    /// Along a stretch: at each of these places, linear between them.
    Spread {
        /// Arc lengths in m.
        arc_lengths: Vec<f64>,
        /// In N/m.
        forces: Vec<[f64; 3]>,
        /// In N·m/m.
        moments: Vec<[f64; 3]>,
        /// Whether it turns with the cross-sections.
        follows: bool,
    },
    /// A mass that is carried.
    Mass {
        /// Arc length in m.
        arc_length: f64,
        /// In kg.
        mass: f64,
    },
}
