//! The Cosserat rod with continuous cables (see `docs/theory/cosserat.md`).
//!
//! The total internal wrench of rod and cables is carried along the backbone instead of the
//! paper's state `(p, R, v, u)`: `section` solves one cross-section for its strains,
//! `unloaded` and `loaded` put the sections together, `lengths` finds the tensions that
//! give prescribed cable lengths, and `stability` says whether the equilibrium is one to stay in.

mod chain;
mod continuation;
mod grid;
mod lengths;
mod loaded;
mod loads;
mod model;
mod newton;
mod one_cable;
mod section;
mod sensitivity;
mod stability;
mod statics;
mod unloaded;

pub use model::{Accuracy, Cosserat, Options, Workspace};
