//! The models as they are compared and chosen: each as it is, and in those variants that trade accuracy for time or
//! reach for simplicity.

use core::fmt;
use core::str::FromStr;

use crate::case::Actuation;
use crate::four_bar;
use crate::kind::{ModelKind, UnknownModel};
use crate::model::Model;
use crate::statics::options::Accuracy;
use crate::stations::Stations;

/// A model in one of its variants.
///
/// ```
/// use whipcord::{ModelKind, ModelVariant};
///
/// let variant: ModelVariant = "four-bar-strain-energy".parse()?;
/// assert_eq!(variant.kind, ModelKind::FourBar);
/// assert_eq!(variant.to_string(), "four-bar, strain energy");
/// # Ok::<(), whipcord::kind::UnknownModel>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModelVariant {
    /// The model.
    pub kind: ModelKind,
    /// How it is set.
    pub variant: Variant,
}

/// How a model is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variant {
    /// As it is.
    Usual,
    /// One integration step for each section and nothing computed that the shape does not need: as the
    /// paper times the Cosserat rod (its Fig. 4).
    StepPerSection,
    /// The four-bar model with cables that slide freely: what they lose is shared out between the sections so that
    /// the coupler angles of all together are least.
    Sliding,
    /// The same by least strain energy, as the authors of the model extended it.
    StrainEnergy,
}

impl ModelVariant {
    /// The model as it is.
    #[must_use]
    pub const fn usual(kind: ModelKind) -> Self {
        Self { kind, variant: Variant::Usual }
    }

    /// These models, each followed by its variants.
    #[must_use]
    pub fn of(kinds: &[ModelKind]) -> Vec<Self> {
        let variants = |kind: ModelKind| -> &'static [Variant] {
            match kind {
                ModelKind::Cosserat | ModelKind::CosseratDisks => {
                    &[Variant::Usual, Variant::StepPerSection]
                }
                ModelKind::FourBar => &[Variant::Usual, Variant::Sliding, Variant::StrainEnergy],
                _ => &[Variant::Usual],
            }
        };
        let each = |&kind| variants(kind).iter().map(move |&variant| Self { kind, variant });
        kinds.iter().flat_map(each).collect()
    }

    /// The model, giving the shape at these stations, for a robot of so many sections.
    #[must_use]
    pub fn model(self, stations: Stations, sections: usize) -> Model {
        let sliding = |stations, objective| {
            let lengths = four_bar::LengthRule::Free;
            // Variants are compared at the cable lengths of another model.
            let conflicts = four_bar::Conflicts::Compromise;
            Model::FourBar(four_bar::Options {
                stations,
                objective,
                lengths,
                conflicts,
                ..Default::default()
            })
        };
        match self.variant {
            Variant::Usual => Model::new(self.kind, stations, Actuation::Natural),
            Variant::StepPerSection => {
                step_per_section(Model::new(self.kind, stations, Actuation::Natural), sections)
            }
            Variant::Sliding => sliding(stations, four_bar::Objective::CouplerAngle),
            Variant::StrainEnergy => sliding(stations, four_bar::Objective::StrainEnergy),
        }
    }

    /// The variant's name in tables for programs.
    #[must_use]
    pub const fn variant_name(self) -> &'static str {
        match self.variant {
            Variant::Usual => "usual",
            Variant::StepPerSection => "step-per-section",
            Variant::Sliding => "sliding",
            Variant::StrainEnergy => "strain-energy",
        }
    }

    /// The name of both together, such as `four-bar-sliding`; that of the model where it is as it is, or has no such variant.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.kind, self.variant) {
            (ModelKind::Cosserat, Variant::StepPerSection) => "cosserat-step-per-section",
            (ModelKind::CosseratDisks, Variant::StepPerSection) => {
                "cosserat-disks-step-per-section"
            }
            (ModelKind::FourBar, Variant::Sliding) => "four-bar-sliding",
            (ModelKind::FourBar, Variant::StrainEnergy) => "four-bar-strain-energy",
            (kind, _) => kind.name(),
        }
    }
}

impl FromStr for ModelVariant {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        let all = Self::of(&ModelKind::ALL);
        let found = all.into_iter().find(|variant| variant.name() == name);
        found.ok_or_else(|| UnknownModel(name.to_owned()))
    }
}

impl fmt::Display for ModelVariant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind;
        match self.variant {
            Variant::Usual => write!(f, "{kind}"),
            Variant::StepPerSection => write!(f, "{kind}, step a section"),
            Variant::Sliding => write!(f, "{kind}, sliding"),
            Variant::StrainEnergy => write!(f, "{kind}, strain energy"),
        }
    }
}

/// The model with one integration step for each section and nothing computed that the shape does not need;
/// one that does not integrate stays as it is.
#[must_use]
pub fn step_per_section(mut model: Model, sections: usize) -> Model {
    if let Model::Cosserat(options) | Model::CosseratDisks(options) = &mut model {
        options.accuracy = Accuracy::Steps(sections);
        options.stability = false;
    }
    model
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_variant_has_a_name_of_its_own_and_is_found_by_it() {
        for variant in ModelVariant::of(&ModelKind::ALL) {
            assert_eq!(variant.name().parse(), Ok(variant));
            let usual = variant.variant == Variant::Usual;
            assert_eq!(variant.name().ends_with(variant.variant_name()), !usual);
        }
        assert!("four-bar-usual".parse::<ModelVariant>().is_err());
    }
}
