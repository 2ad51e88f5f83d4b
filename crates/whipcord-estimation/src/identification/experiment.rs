//! What was seen of a robot in a case, and the numbers that are estimated from it.

use super::quantity::Quantity;
use crate::camera::Camera;
use crate::observation::Observation;
use whipcord::case::Case;

/// A case, and what was seen of the robot in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// What was asked of the robot, in one or several steps ([`Case::steps`]).
    pub case: Case,
    /// The cameras that pixels are of.
    pub cameras: Vec<Camera>,
    /// What was seen.
    pub observations: Vec<Observation>,
}

/// A number that is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// What it is.
    pub quantity: Quantity,
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
        Self { quantity, experiment: None, start: None, bounds, prior: None }
    }

    /// One of a single experiment.
    #[must_use]
    pub const fn of(quantity: Quantity, experiment: usize) -> Self {
        Self { experiment: Some(experiment), ..Self::new(quantity) }
    }

    /// Whether it plays a part in an experiment.
    pub(super) fn is_of(&self, experiment: usize) -> bool {
        self.experiment.is_none_or(|only| only == experiment)
    }

    pub(super) fn least(&self) -> f64 {
        self.bounds[0].max(self.quantity.range()[0])
    }

    pub(super) fn greatest(&self) -> f64 {
        self.bounds[1].min(self.quantity.range()[1])
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
