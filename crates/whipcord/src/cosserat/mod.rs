//! The Cosserat rod with continuous cables (see `docs/theory/cosserat.md`).
//!
//! The total internal wrench of rod and cables is carried along the backbone instead of the
//! paper's state `(p, R, v, u)`. From the inside out: `section` (and `one_cable`) solves one
//! cross-section for its strains; `unloaded` and `loaded` put the sections together on a `grid`,
//! `sensitivity` differentiates the latter; `lengths` finds tensions for prescribed cable lengths;
//! `statics` shoots at equilibrium under `loads` with the Newton step of `newton`, from the rod
//! `without_load` or along the path of `continuation`, where `chain` shoots from many starts at once;
//! `stability` says whether the equilibrium is one to stay in; `model` is what the rest of the library
//! sees.

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
mod without_load;

pub use model::{Accuracy, Cosserat, Options, Workspace};
