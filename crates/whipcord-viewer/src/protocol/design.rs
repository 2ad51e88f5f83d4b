//! Holes for a shape that was sketched.

use serde::{Deserialize, Serialize};

use crate::protocol::{Command, Request};

/// To look for the holes with which the disks come nearest to places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignRequest {
    /// What the sliders say, with the holes as they are now.
    pub request: Request,
    /// The cable whose holes may change, from 0.
    pub cable: usize,
    /// Whether its tension may change as well, where it has one.
    pub tension: bool,
    /// Places in m in the world for the disks behind the base.
    pub places: Vec<[f64; 3]>,
}

/// Holes that were found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Designed {
    /// Number of the request.
    pub id: u64,
    /// The holes of the cable from the base on, from 1.
    pub holes: Vec<usize>,
    /// What the sliders are to say.
    pub commands: Vec<Command>,
    /// Root of the mean square of the distances of the disks in m, and the greatest.
    pub error: f64,
    /// See [`Self::error`].
    pub largest: f64,
    /// Whether no other list of holes comes nearer, as is proven.
    pub proven: bool,
}
