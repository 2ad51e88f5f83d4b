//! The Cosserat rod with continuous cables (see `docs/theory/cosserat.md`).
//!
//! The total internal wrench of rod and cables is carried along the backbone instead of the
//! paper's state `(p, R, v, u)`. From the inside out: `section` (and `one_cable`) solves one
//! cross-section for its strains; `unloaded` and `loaded` put the sections together on a `grid`,
//! `sensitivity` differentiates the latter; `lengths` finds tensions for prescribed cable lengths, and
//! `contradiction` those of which there are none, `independent` which cables leave their tensions open,
//! `antagonists` what they do under load;
//! `statics` finds equilibrium under `loads`, by single `shooting` with the Newton step of `newton` from a
//! `guess`, from the rod `without_load` or along the path of `continuation`, where `chain` shoots from many
//! starts at once, with the linear algebra of `elimination` and `shared` on the points of `state`, and `foreseen`
//! says which cables a step makes pull;
//! `arc_length` follows the path where the load cannot be raised, `kink` round the
//! corners where cables go slack or taut, `search` looks for what no path leads to, `branches` collects what lies on it;
//! `stability` says whether the equilibrium is one to stay in; `trace` records iterations; `refinement`
//! halves the steps until the answer changes no more, from as many on as the `strength` of the load asks for. `command` is what drives a cable, `outcome` how a
//! solve on one grid ended, and `model` with its `options` what the rest of the library sees.

mod antagonists;
mod arc_length;
mod branches;
mod chain;
pub(crate) mod command;
mod contact;
pub(crate) mod continuation;
mod contradiction;
pub mod derivatives;
pub(crate) mod elimination;
pub(crate) mod foreseen;
pub(crate) mod grid;
mod guess;
mod independent;
mod kink;
mod lanes;
mod length_step;
pub(crate) mod lengths;
pub(crate) mod loaded;
pub(crate) mod loads;
mod model;
mod newton;
mod one_cable;
mod options;
pub(crate) mod outcome;
mod pushed;
pub(crate) mod refinement;
mod search;
pub(crate) mod section;
mod sensitivity;
mod shared;
mod shooting;
pub(crate) mod stability;
mod state;
mod statics;
pub(crate) mod strength;
pub(crate) mod trace;
pub(crate) mod unloaded;
pub(crate) mod without_load;

pub use branches::{BranchOptions, Branches, CriticalKind, CriticalPoint, Equilibrium};
pub use derivatives::{Derivatives, Hold, Place};
pub(crate) use lanes::UnloadedLanes;
pub use model::{Cosserat, Workspace};
pub use options::{Accuracy, Options};
pub use trace::{Stage, TraceEvent};
