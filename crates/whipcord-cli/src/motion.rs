//! What the verbs about motion share.

use whipcord_io::CaseFile;
use whipcord_motion::MotionError;
use whipcord_study::failure::{Failure, message, refuses};

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
        | MotionError::NoModes => Failure::Solve(text),
        _ => Failure::Input(text),
    }
}
