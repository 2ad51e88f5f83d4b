//! Rigid bodies on springs between each two disks, in equilibrium with cables and loads: the
//! pseudo-rigid-body model.
//!
//! `docs/theory/pseudo-rigid-body.md` has the equations and where the coefficients come from.

use core::fmt;
use core::str::FromStr;

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::Actuation;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::linkage::division::{Bend, Division, Energy, Joint};
use crate::linkage::{self, Linkage};
use crate::robot::Robot;
use crate::statics::options::StabilityAnalysis;
use crate::stations::Stations;

pub use crate::linkage::Workspace;

/// How the model is driven, what it computes, and with which coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the tension.
    pub actuation: Actuation,
    /// What is computed of the stability of the answer.
    pub stability: StabilityAnalysis,
    /// Residual at which equilibrium counts as met, relative to EI/L and the moments in play.
    pub residual: f64,
    /// Lengths of the bodies and stiffness of the joints.
    pub coefficients: Coefficients,
    /// What a solve may spend.
    pub budget: Budget,
    /// Ends a solve from outside.
    pub cancel: Cancel,
}

impl Default for Options {
    fn default() -> Self {
        let linkage::Options { stations, actuation, stability, residual, budget, cancel } =
            Default::default();
        let coefficients = Coefficients::default();
        Self { stations, actuation, stability, residual, coefficients, budget, cancel }
    }
}

/// Published lengths of the four bodies of a section, as fractions of it, and stiffnesses of the three joints between
/// them by EI over its length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coefficients {
    /// Su 2009: the best for all directions of a force and a moment at the tip of a cantilever.
    #[default]
    Su,
    /// Those that Rao, Peyron, Lilge and Burgner-Kahrs 2021 take for tendon-driven robots.
    Rao,
}

/// No coefficients have this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there are no coefficients `{0}`: choose su or rao")]
pub struct UnknownCoefficients(pub String);

const SU: Division = Division {
    first: 0.1,
    joints: &[
        Joint { stiffness: 3.51, link: 0.35 },
        Joint { stiffness: 2.99, link: 0.4 },
        Joint { stiffness: 2.58, link: 0.15 },
    ],
    bend: Bend::Point,
    energy: Energy::Coordinates,
};

/// The lengths as printed add up to 0.999 of a section; here the last body reaches its end.
const RAO: Division = Division {
    first: 0.125,
    joints: &[
        Joint { stiffness: 3.25, link: 0.35 },
        Joint { stiffness: 2.84, link: 0.388 },
        Joint { stiffness: 2.95, link: 0.137 },
    ],
    bend: Bend::Point,
    energy: Energy::Coordinates,
};

impl Coefficients {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Su, Self::Rao];

    /// The name in options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Su => "su",
            Self::Rao => "rao",
        }
    }

    pub(crate) const fn division(self) -> Division {
        match self {
            Self::Su => SU,
            Self::Rao => RAO,
        }
    }
}

impl fmt::Display for Coefficients {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Coefficients {
    type Err = UnknownCoefficients;

    fn from_str(name: &str) -> Result<Self, UnknownCoefficients> {
        let unknown = || UnknownCoefficients(name.to_owned());
        Self::ALL.into_iter().find(|known| known.name() == name).ok_or_else(unknown)
    }
}

/// The model of a robot: between each two disks four rigid bodies, with three joints that bend about
/// two axes each; the section twists as a whole.
///
/// # Errors
/// As [`crate::piecewise_constant_curvature::build`].
pub fn build(robot: &Robot, options: &Options) -> Result<Linkage, SolveError> {
    let Options { stations, actuation, stability, residual, coefficients, budget, cancel } =
        options.clone();
    let options = linkage::Options { stations, actuation, stability, residual, budget, cancel };
    Linkage::new(robot, ModelKind::PseudoRigidBody, coefficients.division(), options)
}
