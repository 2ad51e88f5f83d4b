//! What the verbs about motion share.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use whipcord::ModelKind;
use whipcord_io::CaseFile;
use whipcord_motion::{MotionError, MotionOptions};
use whipcord_study::failure::{Failure, message, refuses};

/// The model of a motion.
#[derive(Debug, Args)]
pub struct MotionModel {
    /// How cables run, instead of the model of [motion]: along their routing (cosserat) or straight from disk to disk (cosserat-disks)
    #[arg(short, long, value_name = "MODEL", value_parser = models())]
    model: Option<ModelKind>,
}

impl MotionModel {
    /// Puts it into a file.
    pub fn choose(&self, file: &mut CaseFile) {
        file.motion.model = self.model.or(file.motion.model);
    }
}

fn models() -> impl TypedValueParser<Value = ModelKind> {
    PossibleValuesParser::new(MotionOptions::MODELS.map(ModelKind::name))
        .try_map(|name| name.parse::<ModelKind>())
}

/// What a motion says: with its place in the file where it refuses robot or case.
pub fn failure(file: &CaseFile, error: &MotionError) -> Failure {
    if let Some(located) = file.locate_motion(error) {
        return Failure::Input(message(&located));
    }
    let text = format!("error: {}: {error}", file.path.display());
    match error {
        MotionError::NoEquilibrium(error) if !refuses(error) => Failure::Solve(text),
        MotionError::Unbalanced { .. }
        | MotionError::MotorOverload { .. }
        | MotionError::NotConverged { .. }
        | MotionError::Tolerance { .. }
        | MotionError::NoGradient { .. }
        | MotionError::NotSmooth { .. }
        | MotionError::Sliding { .. }
        | MotionError::NoModes => Failure::Solve(text),
        _ => Failure::Input(text),
    }
}
