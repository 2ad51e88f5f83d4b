//! Step sizes of load continuation.

use whipcord_numerics::ContinuationSteps;

/// The load is raised by at least this fraction, or the path is given up.
pub(crate) const LEAST_LOAD_STEP: f64 = LEAST_OF_FIRST * FIRST_LOAD_STEP;
/// The load is raised by no more than this at first.
pub(crate) const FIRST_LOAD_STEP: f64 = 0.25;
/// The least step over the first.
pub(crate) const LEAST_OF_FIRST: f64 = 1.0 / 1024.0;
/// An iteration longer than this means that the path bends: the step is not lengthened.
pub(crate) const SHORT_ITERATION: usize = 5;
/// What to do where the path ends.
pub(crate) const PATH_ENDS: &str = "no equilibrium near it was found at more load, as at a snap-through: apply less load, or lead the robot there by other tensions first";

/// Steps that are doubled where they are easy.
pub(crate) const fn load_steps(first: f64) -> ContinuationSteps {
    ContinuationSteps {
        first,
        least: LEAST_OF_FIRST * first,
        growth: 2.0,
        after_miss: f64::INFINITY,
    }
}
