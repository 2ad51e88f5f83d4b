//! How an answer changes with one number.

use std::sync::Arc;

use whipcord_numerics::Twist;

use crate::section::Strain;
use crate::shape::Wrench;

/// How an answer changes with one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    pub(super) places: Arc<Places>,
    /// Of the places.
    pub(super) twists: Vec<Twist>,
    /// Of the places; empty where the model has no strains.
    pub(super) strains: Vec<Strain>,
    pub(super) base: Wrench,
    /// By cables of the robot.
    pub(super) lengths: Vec<f64>,
    pub(super) tensions: Vec<f64>,
}

/// The numbers of the places that have names.
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
        self.twists[self.places.number(at)]
    }

    /// Rates of the strains `v` and `u` at a place, body frame: just behind it, and at the tip just
    /// in front of it. `None` of a model that has sections for a rod.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn strain(&self, at: Place) -> Option<Twist> {
        let number = self.places.number(at);
        (!self.strains.is_empty()).then(|| self.strains[number])
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
    pub fn number(&self, at: Place) -> usize {
        match at {
            Place::Station(i) => self.stations[i],
            Place::Disk(i) => self.disks[i],
            Place::Tip => self.tip,
        }
    }
}

/// A place of the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A station of [`crate::Solution::shape`], from 0.
    Station(usize),
    /// A disk, from 0 at the base.
    Disk(usize),
    /// The tip.
    Tip,
}
