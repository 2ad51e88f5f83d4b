//! How the two Cosserat models are discretised and driven.

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::Actuation;
use crate::robot::{Robot, RobotError, limits};
use crate::stations::Stations;

/// How a model is discretised and driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the tension.
    pub actuation: Actuation,
    /// How finely it integrates. Where cables run straight between the disks, these are the model:
    /// they stay as many as the robot has, and only the spans between them are divided.
    pub accuracy: Accuracy,
    /// What is computed of the stability of the answer. It also decides which equilibrium under load is
    /// the answer: with it a solve from cold goes on from an unstable one to a stable one where there is
    /// any; without it the first that is found is kept.
    pub stability: StabilityAnalysis,
    /// Residual at which equilibrium under load counts as met, relative to the scales of moment (EI/L,
    /// and what acts there), force (EI/L²), turn (1 rad) and length. It is about the relative error of
    /// the shape that the iteration leaves. With [`Accuracy::Tolerance`] a thousandth of the tolerance suffices, where that
    /// is more.
    pub residual: f64,
    /// What a solve may spend.
    pub budget: Budget,
    /// Ends a solve from outside.
    pub cancel: Cancel,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            stations: Stations::default(),
            actuation: Actuation::default(),
            accuracy: Accuracy::default(),
            stability: StabilityAnalysis::default(),
            residual: 2e-11,
            budget: Budget::default(),
            cancel: Cancel::default(),
        }
    }
}

impl Options {
    /// Refuses stations that are not on the backbone, and more steps than a computer holds.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), RobotError> {
        self.stations.check(robot)?;
        match self.accuracy {
            Accuracy::Steps(steps) => limits::check_number("steps", steps, limits::MOST_STEPS),
            Accuracy::Tolerance(_) => Ok(()),
        }
    }

    /// Residual at which equilibrium counts as met.
    pub(crate) fn greatest_residual(&self) -> f64 {
        match self.accuracy {
            Accuracy::Tolerance(tolerance) => self.residual.max(RESIDUAL_OF_TOLERANCE * tolerance),
            Accuracy::Steps(_) => self.residual,
        }
    }
}

/// Part of the tolerance that the iteration may leave.
const RESIDUAL_OF_TOLERANCE: f64 = 1e-3;

/// What is computed of the stability of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StabilityAnalysis {
    /// Nothing.
    Off,
    /// Whether it is stable; the eigenvalue where it is not, or nearly not ([`crate::Diagnostics::NEAR_CRITICAL`]).
    #[default]
    Verdict,
    /// The least eigenvalue of the tangent stiffness too, [`crate::Diagnostics::stability`], which takes several times
    /// as long.
    Eigenvalue,
}

/// How finely the rod is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// The steps are halved until the estimated error of every position and of every cable's length
    /// is below this fraction of the length; where lengths are given, at the tensions found.
    Tolerance(f64),
    /// At least this many steps from base to tip. Disks, stations, cable ends, corners of a routing
    /// and places of loads always end a step.
    Steps(usize),
}

impl Accuracy {
    /// A thousandth of the thickness of a rod that is a thousand times as long as thick: far below what is known of any real
    /// robot.
    pub const DEFAULT_TOLERANCE: f64 = 1e-6;
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::Tolerance(Self::DEFAULT_TOLERANCE)
    }
}
