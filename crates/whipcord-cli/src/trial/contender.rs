//! What takes part in a comparison: the models, and those of their variants that trade accuracy for time.

use core::fmt;

use whipcord::cosserat::Accuracy;
use whipcord::{Drive, Model, ModelKind, Stations, four_bar};

/// A model in one of its variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contender {
    /// The model.
    pub kind: ModelKind,
    /// How it is set.
    pub variant: Variant,
}

/// How a model is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

impl Contender {
    /// These models, each followed by its variants.
    pub fn of(kinds: &[ModelKind]) -> Vec<Self> {
        let variants = |kind: ModelKind| -> &'static [Variant] {
            match Model::new(kind, Stations::Disks, Drive::Natural) {
                Model::Cosserat(_) | Model::CosseratDisks(_) => {
                    &[Variant::Usual, Variant::StepPerSection]
                }
                Model::FourBar(_) => &[Variant::Usual, Variant::Sliding, Variant::StrainEnergy],
                _ => &[Variant::Usual],
            }
        };
        let each = |&kind| variants(kind).iter().map(move |&variant| Self { kind, variant });
        kinds.iter().flat_map(each).collect()
    }

    /// The model, for a robot of so many sections, giving the shape at the disks.
    pub fn model(self, sections: usize) -> Model {
        let usual = Model::new(self.kind, Stations::Disks, Drive::Natural);
        match self.variant {
            Variant::Usual => usual,
            Variant::StepPerSection => step_per_section(usual, sections),
            Variant::Sliding => sliding(four_bar::Objective::CouplerAngle),
            Variant::StrainEnergy => sliding(four_bar::Objective::StrainEnergy),
        }
    }

    /// The variant's name in tables for programs.
    pub const fn variant_name(self) -> &'static str {
        match self.variant {
            Variant::Usual => "usual",
            Variant::StepPerSection => "step-per-section",
            Variant::Sliding => "sliding",
            Variant::StrainEnergy => "strain-energy",
        }
    }
}

impl fmt::Display for Contender {
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

/// The four-bar model with cables that slide freely.
fn sliding(objective: four_bar::Objective) -> Model {
    let lengths = four_bar::LengthRule::Free;
    Model::FourBar(four_bar::Options { objective, lengths, ..Default::default() })
}

/// The model with one integration step for each section and nothing computed that the shape does not need;
/// one that does not integrate stays as it is.
pub fn step_per_section(mut model: Model, sections: usize) -> Model {
    if let Model::Cosserat(options) | Model::CosseratDisks(options) = &mut model {
        options.accuracy = Accuracy::Steps(sections);
        options.stability = false;
    }
    model
}

/// Tolerance and residual of a model at fine resolution: the smallest that rounding leaves room for.
const FINE: (f64, f64) = (1e-12, 1e-13);

/// The model at fine resolution; `None` for one that has none to refine.
pub fn fine(kind: ModelKind) -> Option<Model> {
    let mut model = Model::new(kind, Stations::Disks, Drive::Natural);
    let (Model::Cosserat(options) | Model::CosseratDisks(options)) = &mut model else {
        return None;
    };
    (options.accuracy, options.residual) = (Accuracy::Tolerance(FINE.0), FINE.1);
    Some(model)
}
