//! The model that the command line chooses, with its options.

use clap::builder::{PossibleValuesParser, RangedU64ValueParser, TypedValueParser};
use clap::{Args, ValueEnum};
use whipcord::{
    Actuation, Budget, Model, ModelKind, ModelPreset, StabilityAnalysis, Stations, four_bar,
};
use whipcord_viewer::offered;

use crate::deadline;
use whipcord_study::failure::Failure;

/// A model, what drives it, and what only the four-bar model has to choose.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Model
    #[arg(long = "model", value_name = "NAME", default_value = "cosserat", value_parser = model_parser())]
    kind: ModelKind,
    /// Quantity that is prescribed for all cables; by default the one that the model prefers, if
    /// the file gives it
    #[arg(long, value_name = "WHAT")]
    actuation: Option<ActuationArgument>,
    #[command(flatten)]
    four_bar: FourBarArguments,
    /// Estimated error that cosserat and cosserat-disks may leave in positions and lengths, as a fraction of the length
    #[arg(long, value_name = "FRACTION", default_value = "1e-6", value_parser = tolerance)]
    tolerance: f64,
    /// Newton iterations that each solve may take, with those at parts of the load and those in vain; by default there are
    /// enough for about two seconds
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<usize>::new().range(1..))]
    max_iterations: Option<usize>,
}

/// What only the four-bar model has to choose.
#[derive(Debug, Args)]
pub struct FourBarArguments {
    /// Objective that four-bar minimises in each section
    #[arg(long, value_name = "NAME", value_parser = named::<four_bar::Objective>(
        &["coupler-angle", "strain-energy", "as-printed"]))]
    objective: Option<four_bar::Objective>,
    /// How four-bar distributes the shortening of a cable over the sections
    #[arg(long, value_name = "NAME", value_parser = named::<four_bar::LengthRule>(
        &["proportional", "equal", "free"]))]
    length_rule: Option<four_bar::LengthRule>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let range = Model::TOLERANCES;
    let given = text.parse::<f64>().ok().filter(|tolerance| range.contains(tolerance));
    given.ok_or_else(|| format!("give a number from {:e} to {}", range.start(), range.end()))
}

/// What drives all cables.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ActuationArgument {
    /// Cable tensions
    Tension,
    /// Cable shortenings
    Shortening,
}

/// Which command of each cable counts.
pub const fn actuation(actuation: Option<ActuationArgument>) -> Actuation {
    match actuation {
        None => Actuation::Natural,
        Some(ActuationArgument::Tension) => Actuation::Tension,
        Some(ActuationArgument::Shortening) => Actuation::Shortening,
    }
}

/// Models by their names.
pub fn model_parser() -> impl TypedValueParser<Value = ModelKind> {
    PossibleValuesParser::new(ModelKind::ALL.map(ModelKind::name))
        .try_map(|name| name.parse::<ModelKind>())
}

/// Models and their presets by their names.
pub fn preset_parser() -> impl TypedValueParser<Value = ModelPreset> {
    PossibleValuesParser::new(offered().into_iter().map(ModelPreset::name))
        .try_map(|name| name.parse::<ModelPreset>())
}

fn named<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: core::str::FromStr<Err = four_bar::UnknownOption> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

impl ModelArguments {
    /// Which command of each cable counts.
    pub const fn actuation(&self) -> Actuation {
        actuation(self.actuation)
    }

    /// The model, giving the shape at the disks.
    ///
    /// # Errors
    /// [`Failure::Input`] for an option that the model does not have.
    pub fn model(&self) -> Result<Model, Failure> {
        let model = Model::new(self.kind, Stations::Disks, self.actuation())
            .with_stability(StabilityAnalysis::Eigenvalue)
            .with_tolerance(self.tolerance)
            .with_budget(self.max_iterations.map_or_else(Budget::default, Budget::of_iterations));
        self.four_bar.applied_to(model.cancelled_by(&deadline::cancel()))
    }
}

impl FourBarArguments {
    /// The model with these options.
    ///
    /// # Errors
    /// [`Failure::Input`] for an option that the model does not have.
    pub fn applied_to(&self, mut model: Model) -> Result<Model, Failure> {
        if let Model::FourBar(options) = &mut model {
            options.objective = self.objective.unwrap_or(options.objective);
            options.lengths = self.length_rule.unwrap_or(options.lengths);
            return Ok(model);
        }
        let given = [
            ("--objective", self.objective.is_some()),
            ("--length-rule", self.length_rule.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            None => Ok(model),
            Some((option, _)) => Err(Failure::Input(format!(
                "error: {option} is an option of four-bar, not of {}: leave it out, or give --model four-bar",
                model.kind()
            ))),
        }
    }
}
