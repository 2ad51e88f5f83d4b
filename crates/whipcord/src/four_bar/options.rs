//! The variants of the model.

use core::fmt;
use core::str::FromStr;

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::Actuation;
use crate::statics::options::StabilityAnalysis;
use crate::stations::Stations;

/// What is minimised, and how lengths are shared out.
///
/// ```
/// use whipcord::four_bar::{Chord, LengthRule, Objective, Options};
///
/// let options = Options { objective: "strain-energy".parse()?, ..Options::default() };
/// assert_eq!(options.objective, Objective::StrainEnergy);
/// assert_eq!((options.chord, options.lengths), (Chord::Bisector, LengthRule::Proportional));
/// # Ok::<(), whipcord::four_bar::UnknownOption>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the shortening. Tensions drive it where the strain energy decides on the
    /// shape, under the length rule `free`.
    pub actuation: Actuation,
    /// What is computed of the stability of the answer, where the strain energy and a given stiffness decide on it.
    pub stability: StabilityAnalysis,
    /// Residual at which equilibrium under tensions, loads and contacts counts as met, relative to EI/L and the moments in play.
    pub residual: f64,
    /// What is minimised.
    pub objective: Objective,
    /// How the backbone runs from disk to disk.
    pub chord: Chord,
    /// How a cable's shortening is shared out between the sections.
    pub lengths: LengthRule,
    /// What becomes of whole cable lengths that contradict each other, under the rule `free`.
    pub conflicts: Conflicts,
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
            stability: StabilityAnalysis::default(),
            residual: 1e-11,
            objective: Objective::default(),
            chord: Chord::default(),
            lengths: LengthRule::default(),
            conflicts: Conflicts::default(),
            budget: Budget::default(),
            cancel: Cancel::default(),
        }
    }
}

impl Options {
    /// Whether the strain energy decides on the shape.
    pub(crate) const fn has_energy(&self) -> bool {
        matches!(self.objective, Objective::StrainEnergy)
            && matches!(self.lengths, LengthRule::Free)
    }
}

/// What is minimised in a section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Objective {
    /// The sum of the squared coupler angles: the paper's eq. (1), with each coupler compared with
    /// itself before actuation.
    #[default]
    CouplerAngle,
    /// The energy of bending and twist. It needs Poisson's ratio; with Young's modulus and a
    /// cross-section it also yields the cables' tensions.
    StrainEnergy,
    /// Eqs. (1) and (2) as they are printed, one cable only, for study: they twist a robot with a
    /// helical cable even when nothing pulls.
    AsPrinted,
}

/// What becomes of whole cable lengths that contradict each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Conflicts {
    /// They are refused: every cable has the prescribed length, or is slack.
    #[default]
    Refuse,
    /// The least squares of what the lengths miss, where no cable is longer than prescribed by more than 1 % of the
    /// backbone: for lengths that come from another model, whose backbone gets shorter under its cables.
    Compromise,
}

/// How the backbone runs from disk to disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Chord {
    /// A rigid link of the section's length that makes equal angles with both disks' normals.
    #[default]
    Bisector,
    /// A circular arc of the section's length that touches both disks' normals.
    Arc,
}

/// How a cable's shortening is shared out between the sections it passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthRule {
    /// By the same fraction in every section.
    #[default]
    Proportional,
    /// By the same length in every section.
    Equal,
    /// As makes the sum of the objective over the sections least: a cable that slides freely.
    Free,
}

/// No variant has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {kind} `{name}`: choose {choices}")]
pub struct UnknownOption {
    kind: &'static str,
    name: String,
    choices: &'static str,
}

/// Names of the variants as they stand in files and on the command line.
macro_rules! named {
    ($type:ident, $kind:literal, $choices:literal, $($variant:ident = $name:literal),+) => {
        impl $type {
            /// All variants.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The name on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl FromStr for $type {
            type Err = UnknownOption;

            fn from_str(name: &str) -> Result<Self, UnknownOption> {
                match name {
                    $($name => Ok(Self::$variant),)+
                    _ => Err(UnknownOption { kind: $kind, name: name.to_owned(), choices: $choices }),
                }
            }
        }
    };
}

named!(
    Objective,
    "objective",
    "coupler-angle, strain-energy or as-printed",
    CouplerAngle = "coupler-angle",
    StrainEnergy = "strain-energy",
    AsPrinted = "as-printed"
);
named!(Chord, "chord", "bisector or arc", Bisector = "bisector", Arc = "arc");
named!(
    LengthRule,
    "length rule",
    "proportional, equal or free",
    Proportional = "proportional",
    Equal = "equal",
    Free = "free"
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for &objective in Objective::ALL {
            assert_eq!(objective.name().parse(), Ok(objective));
        }
        for &chord in Chord::ALL {
            assert_eq!(chord.to_string().parse(), Ok(chord));
        }
        for &rule in LengthRule::ALL {
            assert_eq!(rule.name().parse(), Ok(rule));
        }
        assert_eq!(
            "arch".parse::<Chord>().unwrap_err().to_string(),
            "there is no chord `arch`: choose bisector or arc"
        );
    }
}
