//! The Cosserat rod whose cables run straight from hole to hole (see `docs/theory/cosserat-disks.md`).
//!
//! A cable leaves a disk at a hole and runs straight to the hole of the next disk. Between two disks the rod alone carries
//! load, so that a span is a rod under an end wrench.
//!
//! | module | content |
//! |---|---|
//! | `model` | the interface: robot, loads and options to solutions |
//! | `layout`, `between_disks`, `repeated_spans` | the robot divided at its disks, and spans that are equal but for a turn |
//! | `rod`, `variation`, `unloaded_span` | the rod of one span as an initial value problem; without loads inside the span |
//! | `span`, `chord`, `loaded_span` | one span with its cables; one span of the loaded chain |
//! | `anchors` | cables that are anchored to the rod between two disks |
//! | `unloaded` | robots without loads, span by span |
//! | `chain`, `node`, `task`, `column`, `linear_step`, `newton` | the loaded robot as a chain of spans, its linear step, and Newton's method |
//! | `path`, `branches` | the chain as an equilibrium path, and all equilibria that are connected to the unloaded shape |
//! | `statics`, `problem`, `scratch`, `tensions` | equilibrium on one mesh: what is to be solved, its memory, and the response to tensions |
//! | `load_continuation`, `raise` | equilibrium under loads, and continuation of the load |
//! | `friction` | the response of the chain to the tensions of all passages, for friction at holes |
//! | `refinement`, `levels` | halving of the steps to a tolerance |
//! | `stability`, `span_form`, `stability_check` | the second variation of the energy, its form in a span, and the decision |
//! | `tip_rates` | how the tip moves with the commands, in memory that is kept |
//! | `contact`, `contact_response` | contact with obstacles: the adapter, and the response to contact forces |
//! | `contact_mesh`, `contact_derivatives` | where its steps end under contact forces, and its derivatives there |

mod anchors;
mod answer;
mod bending_friction;
mod between_disks;
mod branches;
mod chain;
mod chord;
mod column;
mod contact;
mod contact_derivatives;
mod contact_mesh;
mod contact_response;
mod friction;
mod friction_derivatives;
pub(crate) mod layout;
mod levels;
mod linear_step;
mod load_continuation;
mod loaded_span;
mod model;
mod newton;
mod node;
mod path;
mod problem;
mod raise;
mod refinement;
mod repeated_spans;
mod rod;
mod scratch;
mod span;
mod span_form;
mod stability;
mod stability_check;
mod statics;
mod task;
mod tensions;
mod tip_rates;
mod unloaded;
mod unloaded_span;
mod variation;
mod workspace;

pub use crate::statics::options::Options;
pub use model::CosseratDisks;
pub use workspace::Workspace;
