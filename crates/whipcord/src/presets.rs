//! The models as they are compared and chosen: each as it is, and in those presets that trade accuracy for time or
//! reach for simplicity.

use core::fmt;
use core::str::FromStr;

use crate::case::Actuation;
use crate::four_bar;
use crate::kind::{ModelKind, UnknownModel};
use crate::model::Model;
use crate::statics::options::{Accuracy, StabilityAnalysis};
use crate::stations::Stations;

/// A model in one of its presets.
///
/// ```
/// use whipcord::{ModelKind, ModelPreset};
///
/// let preset: ModelPreset = "four-bar-strain-energy".parse()?;
/// assert_eq!(preset.kind, ModelKind::FourBar);
/// assert_eq!(preset.to_string(), "four-bar, strain energy");
/// # Ok::<(), whipcord::kind::UnknownModel>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModelPreset {
    /// The model.
    pub kind: ModelKind,
    /// How it is set.
    pub preset: Preset,
}

/// How a model is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Preset {
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

impl ModelPreset {
    /// The model as it is.
    #[must_use]
    pub const fn usual(kind: ModelKind) -> Self {
        Self { kind, preset: Preset::Usual }
    }

    /// These models, each followed by its presets.
    #[must_use]
    pub fn of(kinds: &[ModelKind]) -> Vec<Self> {
        let presets = |kind: ModelKind| -> &'static [Preset] {
            match kind {
                ModelKind::Cosserat | ModelKind::CosseratDisks => {
                    &[Preset::Usual, Preset::StepPerSection]
                }
                ModelKind::FourBar => &[Preset::Usual, Preset::Sliding, Preset::StrainEnergy],
                _ => &[Preset::Usual],
            }
        };
        let each = |&kind| presets(kind).iter().map(move |&preset| Self { kind, preset });
        kinds.iter().flat_map(each).collect()
    }

    /// The model, giving the shape at these stations, for a robot of so many sections.
    #[must_use]
    pub fn model(self, stations: Stations, sections: usize) -> Model {
        let sliding = |stations, objective| {
            let lengths = four_bar::LengthRule::Free;
            // Presets are compared at the cable lengths of another model.
            let conflicts = four_bar::Conflicts::Compromise;
            Model::FourBar(four_bar::Options {
                stations,
                objective,
                lengths,
                conflicts,
                ..Default::default()
            })
        };
        match self.preset {
            Preset::Usual => Model::new(self.kind, stations, Actuation::Natural),
            Preset::StepPerSection => {
                step_per_section(Model::new(self.kind, stations, Actuation::Natural), sections)
            }
            Preset::Sliding => sliding(stations, four_bar::Objective::CouplerAngle),
            Preset::StrainEnergy => sliding(stations, four_bar::Objective::StrainEnergy),
        }
    }

    /// The preset's name in tables for programs.
    #[must_use]
    pub const fn preset_name(self) -> &'static str {
        match self.preset {
            Preset::Usual => "usual",
            Preset::StepPerSection => "step-per-section",
            Preset::Sliding => "sliding",
            Preset::StrainEnergy => "strain-energy",
        }
    }

    /// The name of both together, such as `four-bar-sliding`; that of the model where it is as it is, or has no such preset.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.kind, self.preset) {
            (ModelKind::Cosserat, Preset::StepPerSection) => "cosserat-step-per-section",
            (ModelKind::CosseratDisks, Preset::StepPerSection) => "cosserat-disks-step-per-section",
            (ModelKind::FourBar, Preset::Sliding) => "four-bar-sliding",
            (ModelKind::FourBar, Preset::StrainEnergy) => "four-bar-strain-energy",
            (kind, _) => kind.name(),
        }
    }
}

impl FromStr for ModelPreset {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        let all = Self::of(&ModelKind::ALL);
        let found = all.into_iter().find(|preset| preset.name() == name);
        found.ok_or_else(|| UnknownModel(name.to_owned()))
    }
}

impl fmt::Display for ModelPreset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind;
        match self.preset {
            Preset::Usual => write!(f, "{kind}"),
            Preset::StepPerSection => write!(f, "{kind}, step a section"),
            Preset::Sliding => write!(f, "{kind}, sliding"),
            Preset::StrainEnergy => write!(f, "{kind}, strain energy"),
        }
    }
}

/// The model with one integration step for each section and nothing computed that the shape does not need;
/// one that does not integrate stays as it is.
#[must_use]
pub fn step_per_section(mut model: Model, sections: usize) -> Model {
    if let Model::Cosserat(options) | Model::CosseratDisks(options) = &mut model {
        options.accuracy = Accuracy::Steps(sections);
        options.stability = StabilityAnalysis::Off;
    }
    model
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_has_a_name_of_its_own_and_is_found_by_it() {
        for preset in ModelPreset::of(&ModelKind::ALL) {
            assert_eq!(preset.name().parse(), Ok(preset));
            let usual = preset.preset == Preset::Usual;
            assert_eq!(preset.name().ends_with(preset.preset_name()), !usual);
        }
        assert!("four-bar-usual".parse::<ModelPreset>().is_err());
    }
}
