//! How to estimate.

use core::num::NonZero;
use std::sync::Arc;

use whipcord_numerics::least_squares::Loss;

use whipcord::model::Model;

/// How much observations count that are far off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Robustness {
    /// All by their square.
    #[default]
    Squares,
    /// Those beyond the noise linearly: [`Loss::Huber`].
    Huber,
    /// The same, smoothly: [`Loss::SoftL1`].
    SoftL1,
    /// Those far beyond the noise hardly at all: [`Loss::Cauchy`].
    Cauchy,
}

impl Robustness {
    /// The loss of residuals whose deviation is 1. Of markers that only noise moves, it counts nearly all by
    /// nearly their square.
    pub(super) const fn loss(self) -> Loss {
        match self {
            Self::Squares => Loss::Squares,
            Self::Huber => Loss::Huber { scale: 2.8 },
            Self::SoftL1 => Loss::SoftL1 { scale: 2.8 },
            Self::Cauchy => Loss::Cauchy { scale: 4.0 },
        }
    }
}

/// How to estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The model, with its options; where it gives the shape is of no effect.
    pub model: Model,
    /// How much observations count that are far off.
    pub robustness: Robustness,
    /// Probability that an interval of confidence holds the true value.
    pub confidence: f64,
    /// Steps that the iteration may take.
    pub iterations: usize,
    /// Whether rows that the model has no answer to are left out, and said in the result; else there is no fit then.
    pub skips: bool,
    /// From how many places the search starts: the best end counts.
    pub starts: usize,
    /// How many threads share the rows, by default one for each processor: the same to the last bit for any number. Without the cargo
    /// feature `parallel` there is one.
    pub threads: Option<NonZero<usize>>,
    /// What is told of each evaluation.
    pub progress: Progress,
}

/// What is told of each evaluation of a fit.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<dyn Fn(Evaluation) + Send + Sync>>);

/// An evaluation: the shapes of all rows were computed for some values of the unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Its number, from 1.
    pub number: usize,
    /// Root mean square of what is left of the numbers that were seen, in units of their deviations, or in m or pixels.
    pub rms: f64,
}

impl Progress {
    /// Calls this for each evaluation.
    #[must_use]
    pub fn new(each: impl Fn(Evaluation) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(each)))
    }

    pub(super) fn tell(&self, number: usize, rms: f64) {
        if let Some(each) = &self.0 {
            each(Evaluation { number, rms });
        }
    }
}

impl core::fmt::Debug for Progress {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(if self.0.is_some() { "Progress(..)" } else { "Progress" })
    }
}

/// Who is told changes nothing of a fit.
impl PartialEq for Progress {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Settings {
    /// Least squares with a model, 95 % confidence.
    #[must_use]
    pub const fn new(model: Model) -> Self {
        Self {
            model,
            robustness: Robustness::Squares,
            confidence: 0.95,
            iterations: 100,
            skips: false,
            starts: 1,
            threads: None,
            progress: Progress(None),
        }
    }
}
