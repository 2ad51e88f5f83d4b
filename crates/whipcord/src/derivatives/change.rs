//! How an answer changes with one number.

use whipcord_numerics::Twist;

use super::Place;
use super::elimination::NodeChange;
use crate::section::Strain;
use crate::shape::Wrench;

/// How an answer changes with one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    pub(super) places: Places,
    pub(super) nodes: Vec<NodeChange>,
    pub(super) strains: Vec<Strain>,
    pub(super) base: Wrench,
    /// By cables of the robot.
    pub(super) lengths: Vec<f64>,
    pub(super) tensions: Vec<f64>,
}

/// Nodes of the grid that have names.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Places {
    pub stations: Vec<usize>,
    pub disks: Vec<usize>,
    pub tip: usize,
}

impl Change {
    /// Velocity of the place's point and its angular velocity, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn twist(&self, at: Place) -> Twist {
        self.nodes[self.places.node(at)].twist()
    }

    /// Rates of the strains `v` and `u` at a place, body frame: just behind it, and at the tip just
    /// in front of it.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn strain(&self, at: Place) -> Twist {
        self.strains[self.places.node(at)]
    }

    /// Rates of the lengths of the cables in m.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Rates of the tensions of the cables in N.
    #[must_use]
    pub fn tensions(&self) -> &[f64] {
        &self.tensions
    }

    /// Rate of what rod and cables exert on the base, base frame.
    #[must_use]
    pub fn base_wrench(&self) -> Wrench {
        self.base
    }
}

impl Places {
    pub fn node(&self, at: Place) -> usize {
        match at {
            Place::Station(i) => self.stations[i],
            Place::Disk(i) => self.disks[i],
            Place::Tip => self.tip,
        }
    }
}
