//! The Cosserat rod whose cables run straight from hole to hole (see `docs/theory/cosserat-disks.md`).
//!
//! A cable leaves a disk at a hole and runs straight to the hole of the next disk. Between two disks the rod alone carries
//! load, so that a span is a rod under an end wrench.
//!
//! | module | content |
//! |---|---|
//! | `model` | the interface: robot, loads and options to solutions |
//! | `layout`, `repeated_spans` | the robot divided at its disks, and spans that are equal but for a turn |
//! | `rod`, `unloaded_span` | the rod of one span as an initial value problem; without loads inside the span |
//! | `span`, `loaded_span` | one span with its cables; one span of the loaded chain |
//! | `anchors` | cables that are anchored to the rod between two disks |
//! | `unloaded` | robots without loads, span by span |
//! | `chain`, `linear_step`, `newton` | the loaded robot as a chain of spans, its linear step, and Newton's method |
//! | `path`, `branches` | the chain as an equilibrium path, and all equilibria that are connected to the unloaded shape |
//! | `statics`, `load_continuation` | equilibrium on one mesh, and continuation of the load |
//! | `friction` | the response of the chain to the tensions of all passages, for friction at holes |
//! | `refinement` | halving of the steps to a tolerance |
//! | `stability`, `stability_check` | the second variation of the energy, and the decision |
//! | `contact`, `contact_response` | contact with obstacles: the adapter, and the response to contact forces |

mod anchors;
mod branches;
mod chain;
mod contact;
mod contact_response;
mod friction;
pub(crate) mod layout;
mod linear_step;
mod load_continuation;
mod loaded_span;
mod model;
mod newton;
mod path;
mod refinement;
mod repeated_spans;
mod rod;
mod span;
mod stability;
mod stability_check;
mod statics;
mod unloaded;
mod unloaded_span;

pub use crate::statics::options::Options;
pub use model::{CosseratDisks, Workspace};
