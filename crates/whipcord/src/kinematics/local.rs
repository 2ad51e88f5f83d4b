use whipcord_numerics::Twist;

use super::ellipsoid::{Dexterity, dexterity};
use super::matrix6::Matrix6;

/// What a unit of a cable's command is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrivenBy {
    /// 1 N of tension.
    Tension,
    /// 1 m of shortening.
    Shortening,
}

/// Compliance of a place under a dead wrench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance {
    /// Motion under a wrench.
    pub compliance: Matrix6,
    /// Wrench that a motion takes; `None` where the place does not yield in every direction.
    pub stiffness: Option<Matrix6>,
}

/// Compliance of a place under a dead wrench, by what is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliances {
    /// With every tension held.
    pub tensions_held: Compliance,
    /// With every taut cable locked.
    pub lengths_held: Compliance,
}

/// Why a model that says how a place moves does not say how it yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {}", self.reason(), self.advice())]
pub enum ComplianceUnknown {
    /// No energy is least, so that nothing resists a wrench.
    NoEnergy,
    /// Every section keeps its share of each length: no one tension pulls a cable.
    SharedLengths,
    /// An arc of constant curvature bears nothing but its cables.
    NoLoads,
    /// Nothing says how stiff the robot is.
    NoStiffness,
}

impl ComplianceUnknown {
    pub(crate) const fn reason(self) -> &'static str {
        match self {
            Self::NoEnergy => "only lengths and no energy decide where it bends",
            Self::SharedLengths => {
                "every section keeps its own part of a cable, which has no one tension"
            }
            Self::NoLoads => "the model takes no loads",
            Self::NoStiffness => "its stiffness is not given",
        }
    }

    pub(crate) const fn advice(self) -> &'static str {
        match self {
            Self::NoEnergy => {
                "take the objective strain-energy and the length rule free, or use cosserat"
            }
            Self::SharedLengths => "take the length rule free, or use cosserat",
            Self::NoLoads => "use piecewise-constant-curvature, cosserat or cosserat-disks",
            Self::NoStiffness => "give Young's modulus and the cross-section",
        }
    }
}

/// How one place of a robot moves with its cables and yields to a load; see
/// [`crate::derivatives::Derivatives`] for the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Local {
    /// By the cables of the robot.
    pub driven_by: Vec<DrivenBy>,
    /// Motion of the place with the command of each cable, the others held.
    pub actuation_jacobian: Vec<Twist>,
    /// Change of the length of each cable in m with the command of each, by rows of lengths.
    pub length_jacobian: Vec<Vec<f64>>,
    /// How it yields to loads, or why that is not known.
    pub compliances: Result<Compliances, ComplianceUnknown>,
    /// Where the numbers come from.
    pub method: DerivativeMethod,
    /// What is about to change at the answer.
    pub one_sided: OneSided,
    /// Whether the commanded lengths depend on each other, so that the tensions are not determined: see
    /// [`crate::Linearization::are_lengths_dependent`].
    pub are_lengths_dependent: bool,
}

/// What is about to change at an answer, which has one-sided derivatives there: they are those of the side that the answer is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneSided {
    /// A contact is about to open or to close, to stick or to slide.
    pub contact: bool,
    /// A cable is about to stick or to slide in a hole.
    pub hole: bool,
    /// A cable of given length is about to go slack or to become taut.
    pub cable: bool,
    /// Friction against bending of the backbone is about to slide or to stick.
    pub bending: bool,
}

impl OneSided {
    /// As in JSON: `contact`, `hole`, `cable`, `bending`.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let all = [
            (self.contact, "contact"),
            (self.hole, "hole"),
            (self.cable, "cable"),
            (self.bending, "bending"),
        ];
        all.into_iter().filter_map(|(is_about_to_change, name)| is_about_to_change.then_some(name))
    }
}

/// Where derivatives come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DerivativeMethod {
    /// The discrete answer, differentiated exactly.
    Exact,
    /// Differences of answers.
    Differences {
        /// Estimated error of the motion with a wrench or a tension, relative to its size: how far
        /// differences of twice the step are off. That of locked cables and of stiffnesses is larger
        /// by the condition of what is inverted for them.
        error: f64,
    },
}

impl Local {
    /// How well the commands move the place: by the cables that are driven by tension, and by those
    /// driven by shortening, the others held. A newton and a metre of command have no common measure,
    /// and so neither have directions by both.
    #[must_use]
    pub fn dexterity(&self) -> Vec<(DrivenBy, Dexterity)> {
        [DrivenBy::Tension, DrivenBy::Shortening]
            .into_iter()
            .filter(|kind| self.driven_by.contains(kind))
            .map(|kind| {
                let columns: Vec<Twist> = (self.driven_by.iter().zip(&self.actuation_jacobian))
                    .filter(|(driven_by, _)| **driven_by == kind)
                    .map(|(_, column)| *column)
                    .collect();
                (kind, dexterity(&columns))
            })
            .collect()
    }
}
