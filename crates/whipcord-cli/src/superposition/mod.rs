//! Models laid over a photograph, and how far each is from what was seen there.

pub mod seen;
pub mod tables;

use whipcord::{ModelKind, SolveError};
use whipcord_estimation::observation::Overlaid;

/// A model on the case of a photograph.
#[derive(Debug)]
pub struct Run {
    /// Which model.
    pub model: ModelKind,
    /// Its answer, or why it has none.
    pub outcome: Result<Overlaid, SolveError>,
}
