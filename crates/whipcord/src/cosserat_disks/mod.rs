//! The Cosserat rod whose cables run straight from hole to hole (see
//! `docs/theory/cosserat-disks.md`).
//!
//! A real cable leaves one disk at a hole and runs straight to the hole of the next. Between the
//! disks only the rod bears anything, so that a span is a rod under an end wrench. From the inside
//! out: `layout` cuts the robot at its disks; `rod` integrates one span and differentiates it;
//! `joint` puts the cables to it; `unloaded` solves span after span where nothing but the cables
//! pulls, and `chain` all of them at once under loads, by their `link`s and with the cables that are
//! `held` at their lengths; `statics` finds equilibria for tensions or lengths, `loading` the way to
//! them under loads, `friction` those of cables that rub; `stability` says whether the robot `stays` in
//! them; `local` how it yields; `model` is what the rest of the library sees.

mod bare;
mod chain;
mod closing;
mod friction;
mod held;
mod joint;
pub(crate) mod layout;
mod link;
mod loading;
mod local;
mod model;
mod rod;
mod stability;
mod statics;
mod stays;
mod twins;
mod unloaded;

pub use crate::statics::options::Options;
pub(crate) use local::solve_at;
pub use model::{CosseratDisks, Workspace};
