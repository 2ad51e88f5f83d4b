//! How to estimate.

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
}

impl Settings {
    /// Least squares with a model, 95 % confidence.
    #[must_use]
    pub const fn new(model: Model) -> Self {
        Self { model, robustness: Robustness::Squares, confidence: 0.95, iterations: 100 }
    }
}
