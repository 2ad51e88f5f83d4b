//! What is said of a fit.

use whipcord_numerics::least_squares::Status;

use super::error::NoAnswer;
use super::experiment::Unknown;
use super::quantity::Quantity;
use super::rows::{OverDetermined, Skipped};
use super::settings::Robustness;
use super::unresolved::Unresolved;
use whipcord::case::Case;
use whipcord::kind::ModelKind;
use whipcord::robot::Robot;
use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

/// What was found.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The model.
    pub model: ModelKind,
    /// How the search ended. Where it has not converged, the estimates are the best that were met.
    pub status: Status,
    /// Steps of the search.
    pub iterations: usize,
    /// How often all shapes were computed, not counting those for differences.
    pub evaluations: usize,
    /// What kept the last step that was shortened from an answer.
    pub refusal: Option<NoAnswer>,
    /// The unknowns, in their order.
    pub estimates: Vec<Estimate>,
    /// Correlation of each estimate with each, by rows; none where one of them is not sure at all.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// How large the noise is.
    pub noise: Noise,
    /// What is left of each observation, in their order.
    pub residuals: Vec<Residual>,
    /// How many answers, one for each step in which something was seen, the measurements are compared with.
    pub answers: usize,
    /// Which of these answers are unstable equilibria at the estimates: a real robot leaves them, so that it was
    /// hardly measured in them.
    pub unstable: Vec<Unstable>,
    /// Root mean square distance in m of the markers whose position was seen from where the model has them.
    pub rms_distance: Option<f64>,
    /// The same in pixels of those that were seen in images.
    pub rms_pixels: Option<f64>,
    /// The rows that were left out because the model has no answer to them ([`super::Settings::skips`]).
    pub skipped: Vec<Skipped>,
    /// The rows whose cable lengths contradict each other, which are met in the least-squares sense ([`super::Settings::skips`]).
    pub over_determined: Vec<OverDetermined>,
    /// How much observations counted that are far off.
    pub robustness: Robustness,
    /// What the measurements cannot tell apart.
    pub unresolved: Vec<Unresolved>,
    /// Akaike's criterion, up to a constant of the measurements; none where nothing is left of the noise.
    pub aic: Option<f64>,
    /// The Bayesian criterion, up to the same constant.
    pub bic: Option<f64>,
    /// The robot with the estimates that all experiments share.
    pub robot: Robot,
    /// Its case in each experiment.
    pub cases: Vec<Case>,
    /// From how many places the search started, and how many ended here.
    pub starts: Starts,
    /// Where the world is in the frame of the positions that were measured, in each experiment.
    pub frames: Vec<Pose>,
    /// The rotation of tracked bodies in the frames at their places, in each experiment whose orientations were fitted.
    pub bodies: Vec<Option<UnitQuaternion>>,
}

/// Starts of a search ([`super::Settings::starts`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Starts {
    /// How many.
    pub tried: usize,
    /// How many ended at the estimates that are given.
    pub agree: usize,
}

impl Identified {
    /// What is added to where the markers of an experiment are in the frames of their places, in m.
    #[must_use]
    pub fn marker_offset(&self, experiment: usize) -> Vec3 {
        let mut offset = Vec3::ZERO;
        for of in self.estimates.iter().filter(|of| of.unknown.is_of(experiment)) {
            if let Quantity::MarkerOffset { axis } = of.unknown.quantity {
                offset[axis] = of.value;
            }
        }
        offset
    }
}

/// An estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// What it is.
    pub unknown: Unknown,
    /// Its value in SI.
    pub value: f64,
    /// Standard deviation; none where the measurements say nothing of it, and at a bound.
    pub deviation: Option<f64>,
    /// Interval that holds the true value with the probability asked for; of what must be positive it is
    /// symmetric in the logarithm.
    pub interval: Option<[f64; 2]>,
    /// Whether it lies at a bound.
    pub is_at_bound: bool,
    /// Whether derivatives by it were differences of answers, else exact.
    pub by_differences: bool,
}

/// How large the noise is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of each number, in m or pixels, where it is estimated; else how many times as large
    /// as they say the deviations of the observations turn out to be.
    pub level: f64,
    /// Whether it is estimated.
    pub is_estimated: bool,
    /// Degrees of freedom: numbers and priors less unknowns.
    pub freedom: usize,
}

/// An unstable equilibrium that measurements are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unstable {
    /// The experiment, from 0.
    pub experiment: usize,
    /// The step, from 0.
    pub step: usize,
    /// [`whipcord::Diagnostics::stability`], which is negative.
    pub stability: f64,
}

/// What is left of one observation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The experiment, from 0.
    pub experiment: usize,
    /// The observation, from 0 within it.
    pub observation: usize,
    /// What the model says less what was seen: x, y and z in m, or column and row in pixels and 0.
    pub difference: [f64; 3],
    /// Weight that a robust loss gave it, from 0 to 1.
    pub weight: f64,
}

impl Residual {
    /// Whether a robust loss counts it for next to nothing.
    #[must_use]
    pub const fn is_negligible(&self) -> bool {
        self.weight < 0.1
    }

    /// How far off, in m or pixels.
    #[must_use]
    pub fn distance(&self) -> f64 {
        let [x, y, z] = self.difference;
        x.hypot(y).hypot(z)
    }
}
