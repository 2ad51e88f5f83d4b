//! What is said of inverse problems: where the tip is dragged to, and where it can go.

use serde::{Deserialize, Serialize};

use crate::protocol::request::Command;

/// Commands for the place that the tip is dragged to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Reach {
    /// Commands were found, for this place or for the nearest to it.
    Found {
        /// Whether the tip gets there.
        reached: bool,
        /// One for each slider.
        commands: Vec<Command>,
        /// Distance in m of the tip from the place.
        distance: f64,
        /// The limits that are met.
        limits: Vec<MetLimit>,
    },
    /// None were found, and why.
    Failed {
        /// Why.
        message: String,
    },
}

/// A limit that is met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetLimit {
    /// The slider that it is of, where it is of one.
    pub slider: Option<usize>,
    /// In words.
    pub words: String,
}

/// Where the tip can go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Number of the request.
    pub id: u64,
    /// Edge of a voxel in m.
    pub voxel: f64,
    /// A place of the tip in each voxel, in m.
    pub points: Vec<[f64; 3]>,
    /// Least motion of the tip in m there, for commands that bend the straight robot by half a turn.
    pub dexterity: Vec<f64>,
    /// 3 of a body, 2 of a surface, 1 of a curve.
    pub dimension: usize,
    /// Its volume in m³, its area in m² or its length in m.
    pub measure: f64,
    /// Whether the survey came to its end; if not there may be more.
    pub complete: bool,
}
