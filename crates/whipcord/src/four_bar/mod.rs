//! The geometric model of Mahapatra, Ashwin and Ghosal: one four-bar section between each two
//! disks, bent as little as the prescribed lengths of the cables allow.
//!
//! `docs/theory/four-bar.md` derives the equations whose numbers stand in the code.

mod answer;
mod as_printed;
mod bend;
mod derivatives;
mod equilibrium;
mod joint;
mod length;
mod local;
mod measure;
mod model;
mod one_cable;
mod options;
mod plane;
mod refusal;
mod section;
mod several;
mod solve;
#[cfg(test)]
mod tests;
mod under_forces;
mod workspace;

pub use derivatives::Derivatives;
pub(crate) use local::solve_at;
pub use model::FourBar;
pub use options::{Chord, Conflicts, LengthRule, Objective, Options, UnknownOption};
pub use workspace::Workspace;
