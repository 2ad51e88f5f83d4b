//! What takes part in a comparison: the models, and those of their presets that trade accuracy for time.

use whipcord::cosserat::Accuracy;
use whipcord::{Actuation, Model, ModelKind, Stations};

pub use whipcord::ModelPreset as Candidate;
pub use whipcord::presets::{Preset, step_per_section};

/// Tolerance and residual of a model at fine resolution: the smallest that rounding leaves room for.
const FINE: (f64, f64) = (1e-12, 1e-13);

/// The model at fine resolution; `None` for one that has none to refine.
pub fn fine(kind: ModelKind) -> Option<Model> {
    let mut model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let (Model::Cosserat(options) | Model::CosseratDisks(options)) = &mut model else {
        return None;
    };
    (options.accuracy, options.residual) = (Accuracy::Tolerance(FINE.0), FINE.1);
    Some(model)
}
