//! The Cosserat rod with continuous cables (see `docs/theory/cosserat.md`).
//!
//! The total internal wrench of rod and cables is carried along the backbone instead of the
//! paper's state `(p, R, v, u)`. From the inside out: `crate::section` (and `one_cable`) solves one
//! cross-crate::section for its strains; `unloaded` and `loaded` put the sections together on a `crate::statics::grid`,
//! `sensitivity` differentiates the latter; `crate::statics::lengths` finds tensions for prescribed cable crate::statics::lengths, and
//! `crate::statics::infeasible_lengths` those of which there are none, `crate::statics::rank` which cables leave their tensions open,
//! `antagonists` what they do under load;
//! `statics` finds equilibrium under `crate::statics::loads`, by single `shooting` with the Newton step of `newton` from a
//! `guess`, from the rod `without_load` or along the path of `continuation`, where `chain` shoots from many
//! starts at once, with the linear algebra of `crate::statics::elimination` and `shared` on the points of `state`, and `crate::statics::active_set`
//! says which cables a step makes pull;
//! `arc_length` follows the path where the load cannot be raised, `kink` round the
//! corners where cables go slack or taut, `search` looks for what no path leads to, `branches` collects what lies on it;
//! `stability` says whether the equilibrium is one to stay in; `crate::statics::trace` records iterations; `refinement`
//! halves the steps until the answer changes no more, from as many on as the `strength` of the load asks for. `crate::statics::command` is what drives a cable, `crate::statics::outcome` how a
//! solve on one crate::statics::grid ended, and `model` with its `crate::statics::options` what the rest of the library sees.

mod antagonists;
mod arc_length;
mod branches;
mod chain;
mod contact;
mod continuation;
pub mod derivatives;
mod guess;
mod kink;
mod lanes;
mod loaded;
mod model;
mod newton;
mod pushed;
mod refinement;
mod search;
mod sensitivity;
mod shared;
mod shooting;
mod stability;
mod state;
mod statics;
mod strength;
mod unloaded;
mod without_load;

pub use crate::statics::hold::Hold;
pub use crate::statics::options::{Accuracy, Options};
pub use crate::statics::trace::{Stage, TraceEvent};
pub use branches::{BranchOptions, Branches, CriticalKind, CriticalPoint, Equilibrium};
pub use derivatives::{Derivatives, Place};
pub(crate) use lanes::UnloadedLanes;
pub use model::{Cosserat, Workspace};
