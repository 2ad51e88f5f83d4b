//! How often the steps of a mesh are halved.

use crate::statics::outcome::Found;

/// Finer meshes that are kept once they were needed.
pub(super) const FINER_MESHES: usize = 5;

/// Of them the finest on which stability is computed where it has steps enough.
pub(super) const STABILITY_LEVEL: usize = 2;

/// How often the steps may be halved.
pub(super) const MAX_REFINEMENTS: usize = 8;

/// With so many, the least eigenvalue of a column is known to better than 1e-6.
pub(super) const STABILITY_STEPS: usize = 16;

/// An answer that the workspace holds, how often the steps of its mesh are halved, and its estimated error in m where it was refined.
pub(super) struct Refined {
    pub found: Found,
    pub level: usize,
    pub error: Option<f64>,
}
