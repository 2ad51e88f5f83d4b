//! Rods with few steps, for trials and for the shapes of an atlas.

use whipcord::cosserat::{self, Accuracy};
use whipcord::{Model, StabilityAnalysis};

/// Steps of a Cosserat rod on which trials are solved, or one between two disks: with them the tip is known to some 1e-5 of the length.
const FEW_STEPS: usize = 9;
/// What the iteration of a trial may leave: far below the tolerance of any target.
const RESIDUAL: f64 = 1e-7;

/// A Cosserat rod with few steps; `None` for other models.
pub(crate) fn on_few_steps(model: &Model) -> Option<Model> {
    match model {
        Model::Cosserat(options) => {
            let accuracy = Accuracy::Steps(FEW_STEPS);
            let residual = options.residual.max(RESIDUAL);
            Some(Model::Cosserat(cosserat::Options { accuracy, residual, ..options.clone() }))
        }
        _ => None,
    }
}

/// Residual of the shapes of an atlas, which say where an answer is looked for but not what it is.
const RESIDUAL_OF_ATLAS: f64 = 1e-4;

/// A Cosserat rod for the shapes of an atlas: with few steps and without their stability. `None` for other models.
pub(crate) fn for_atlas(model: &Model) -> Option<Model> {
    match on_few_steps(model)? {
        Model::Cosserat(options) => Some(Model::Cosserat(cosserat::Options {
            residual: options.residual.max(RESIDUAL_OF_ATLAS),
            stability: StabilityAnalysis::Off,
            ..options
        })),
        _ => None,
    }
}
