//! Warnings: the input is valid but probably a mistake. Each warning carries its numbers. A solve computes no warnings.
//!
//! [`of_case`] checks the robot and the case, [`of_answer`] an answer. [`of_spacing`] solves the case once more with half the
//! spacing of the disks. All are pure functions of their arguments.

mod answer;
mod case;
mod geometry;
mod intersection;
mod kinds;
mod message;
mod robot;
mod spacing;
mod span;

pub use answer::of_answer;
pub use case::of_case;
pub use kinds::{
    BareUnits, LARGE_STRAIN, NEAR_CRITICAL, Place, SLENDER, SOFT, SPACING, USUAL_LENGTHS, Warning,
};
pub use spacing::of_spacing;
