//! The models by name.

use core::fmt;
use core::str::FromStr;

use crate::case::Actuation;

/// The models, by the names they have in files and on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// Cosserat rod with continuous cables.
    #[default]
    Cosserat,
    /// Cosserat rod with cables that run straight from hole to hole.
    CosseratDisks,
    /// Four-bar sections, the paper's optimisation-based model.
    FourBar,
    /// One arc of a circle from base to tip.
    ConstantCurvature,
    /// An arc between each two disks, in equilibrium with cables and loads.
    PiecewiseConstantCurvature,
    /// Rigid bodies on springs between each two disks.
    PseudoRigidBody,
}

impl ModelKind {
    /// All models.
    pub const ALL: [Self; 6] = [
        Self::Cosserat,
        Self::CosseratDisks,
        Self::FourBar,
        Self::ConstantCurvature,
        Self::PiecewiseConstantCurvature,
        Self::PseudoRigidBody,
    ];

    /// The name in files and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cosserat => "cosserat",
            Self::CosseratDisks => "cosserat-disks",
            Self::FourBar => "four-bar",
            Self::ConstantCurvature => "constant-curvature",
            Self::PiecewiseConstantCurvature => "piecewise-constant-curvature",
            Self::PseudoRigidBody => "pseudo-rigid-body",
        }
    }

    /// What it is driven by where a cable has both commands, never [`Actuation::Natural`]: tensions by a model
    /// that knows forces, shortenings by a geometric one.
    #[must_use]
    pub const fn natural_actuation(self) -> Actuation {
        match self {
            Self::Cosserat
            | Self::CosseratDisks
            | Self::PiecewiseConstantCurvature
            | Self::PseudoRigidBody => Actuation::Tension,
            Self::FourBar | Self::ConstantCurvature => Actuation::Shortening,
        }
    }

    /// How it differentiates its answer by the commands of the cables.
    #[must_use]
    pub const fn command_derivatives(self) -> CommandDerivatives {
        match self {
            Self::Cosserat
            | Self::CosseratDisks
            | Self::FourBar
            | Self::ConstantCurvature
            | Self::PiecewiseConstantCurvature
            | Self::PseudoRigidBody => CommandDerivatives::Exact,
        }
    }
}

/// How a model differentiates its answer by the commands of the cables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandDerivatives {
    /// Exactly, with the solve.
    Exact,
    /// By differences of answers: a solve or two for each cable.
    Differences,
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No model has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no model `{0}`: choose cosserat, cosserat-disks, four-bar, constant-curvature, piecewise-constant-curvature or pseudo-rigid-body"
)]
pub struct UnknownModel(pub String);

impl FromStr for ModelKind {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownModel(name.to_owned()))
    }
}
