//! What was seen of a robot in a case, and the numbers that are estimated from it.

use std::collections::BTreeSet;

use super::quantity::Quantity;
use super::shared::Shared;
use crate::camera::Camera;
use crate::observation::Observation;
use crate::registration::Alignment;
use whipcord::case::Case;
use whipcord_numerics::{Pose, UnitQuaternion};

/// A case, and what was seen of the robot in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Experiment {
    /// What messages call it, such as the name of its file; empty for its number.
    pub name: String,
    /// What was asked of the robot, in one or several steps ([`Case::steps`]).
    pub case: Case,
    /// The cameras that pixels are of.
    pub cameras: Vec<Camera>,
    /// What was seen.
    pub observations: Vec<Observation>,
    /// Of each step, what is known of the measurement; empty where nothing is.
    pub labels: Vec<RowLabel>,
    /// How positions are moved onto the robot before they are compared; [`registered`](super::registered) sees to it.
    pub alignment: Alignment,
    /// Where the world is in the frame of the positions that were measured.
    pub frame: Pose,
    /// The rotation of tracked bodies in the frames at their places; [`registered`](super::registered) estimates it where it is `None`.
    pub body: Option<UnitQuaternion>,
    /// Steps whose cable lengths contradict each other and are met in the least-squares sense, each by itself; a fit finds them where it
    /// [skips](super::Settings::skips) rows.
    pub over_determined: BTreeSet<usize>,
}

/// What is known of the measurement of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowLabel {
    /// The group of rows that it belongs to, such as one motion: rows of a group are held out together.
    pub group: Option<String>,
    /// When it was, in s.
    pub time: Option<f64>,
}

/// A number that is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// What it is; of a number that several cables or motors share, that of the first.
    pub quantity: Quantity,
    /// What shares it.
    pub shared: Option<Shared>,
    /// The number of the one experiment that it belongs to; else all share it.
    pub experiment: Option<usize>,
    /// Where to start; else where robot and case have it.
    pub start: Option<f64>,
    /// Least and greatest value; infinite where there are none.
    pub bounds: [f64; 2],
    /// What is known of it besides.
    pub prior: Option<Prior>,
}

impl Unknown {
    /// One that all experiments share, without bounds.
    #[must_use]
    pub const fn new(quantity: Quantity) -> Self {
        let bounds = [f64::NEG_INFINITY, f64::INFINITY];
        Self { quantity, shared: None, experiment: None, start: None, bounds, prior: None }
    }

    /// All quantities that have this number.
    pub fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let others = self.shared.iter().flat_map(|shared| shared.others.iter().copied());
        core::iter::once(self.quantity).chain(others)
    }

    /// Its path, as it was given.
    #[must_use]
    pub fn path(&self) -> String {
        match &self.shared {
            Some(shared) => shared.path.clone(),
            None => self.quantity.to_string(),
        }
    }

    /// Whether it is a change that several cables share, each from where robot and case have it.
    #[must_use]
    pub fn is_change(&self) -> bool {
        self.shared.as_ref().is_some_and(|shared| shared.is_change)
    }

    /// Whether it is the same unknown of the same experiment as another, whatever is known of them.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        self.experiment == other.experiment
            && self.is_change() == other.is_change()
            && self.quantities().eq(other.quantities())
    }

    /// Whether it cannot be negative, so that changes are seen as fractions of it.
    pub(super) fn is_positive(&self) -> bool {
        self.quantity.is_positive() && !self.is_change()
    }

    /// Whether it must be greater than zero.
    pub(super) fn is_above_zero(&self) -> bool {
        self.quantity.is_above_zero() && !self.is_change()
    }

    /// Values that are possible at all.
    fn range(&self) -> [f64; 2] {
        match self.is_change() {
            true => [f64::NEG_INFINITY, f64::INFINITY],
            false => self.quantity.range(),
        }
    }

    /// One of a single experiment.
    #[must_use]
    pub fn of(quantity: Quantity, experiment: usize) -> Self {
        Self { experiment: Some(experiment), ..Self::new(quantity) }
    }

    /// Whether it plays a part in an experiment.
    pub(super) fn is_of(&self, experiment: usize) -> bool {
        self.experiment.is_none_or(|only| only == experiment)
    }

    pub(super) fn least(&self) -> f64 {
        self.bounds[0].max(self.range()[0])
    }

    pub(super) fn greatest(&self) -> f64 {
        self.bounds[1].min(self.range()[1])
    }
}

/// What is known of a number before anything is measured: the normal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}
