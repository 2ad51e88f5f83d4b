//! The Cosserat rod with continuous cables (see `docs/theory/cosserat.md`).
//!
//! The total internal wrench of rod and cables is carried along the backbone instead of the paper's state `(p, R, v, u)`.
//!
//! | module | content |
//! |---|---|
//! | `model`, `prepared` | the interface: robot, loads and options to solutions; the model of one robot, and its memory |
//! | `answer` | what a solve leaves, as a solution |
//! | `problem`, `scratch` | what is to be solved on one grid, and memory |
//! | `unloaded`, `loaded` | the rod without load; the rod integrated from its base under loads |
//! | `strain_guess` | where the iteration of a section starts |
//! | `sensitivity` | derivatives of the loaded rod at its tip |
//! | `solve`, `statics` | equilibrium on one grid: the order of the strategies below |
//! | `guess`, `relaxation`, `without_load` | initial guesses: the loaded rod after one step; the rod without load |
//! | `shooting`, `newton` | single shooting on eq. (7), and its Newton step |
//! | `chain`, `gap` | multiple shooting; how its steps miss the next node |
//! | `base_sweep` | its Newton step under weak dead loads |
//! | `redundant_cables` | antagonistic cables under load |
//! | `continuation`, `perturbed` | load continuation by multiple shooting, and on to a branch by small moments |
//! | `path`, `state` | the rod as an equilibrium path, and its states |
//! | `branches` | all equilibria that are connected to the unloaded shape |
//! | `search` | equilibria from many base moments |
//! | `stability`, `verdict` | stability under dead loads, eqs. (8) and (11), and of the answer |
//! | `refinement` | halving of the steps to a tolerance, and the check of stability |
//! | `tension_nodes`, `friction`, `friction_steps` | friction of cables: where their tension is given, the rod's answer to it, and steps of actuation |
//! | `contact`, `contact_response` | contact with obstacles: the adapter, and the response to contact forces |
//! | `contact_grid`, `contact_derivatives` | its nodes under contact forces, and its derivatives there |
//! | `friction_derivatives` | exact derivatives where cables rub |
//! | `bending_friction` | friction of the backbone against bending |
//! | `command_changes` | derivatives by commands alone, for trials of inverse problems |
//! | `target` | what a rod is shot at |
//! | `lanes` | many rods at once, without load or under dead loads |
//! | `step_lanes` | the steps of one rod at once, each from a start of its own |
//! | `trace` | solves with a record of the iterations |

mod answer;
mod base_sweep;
mod bending_friction;
mod branches;
mod chain;
mod command_changes;
mod contact;
mod contact_derivatives;
mod contact_grid;
mod contact_response;
mod continuation;
mod friction;
mod friction_derivatives;
mod friction_steps;
mod gap;
mod guess;
mod lanes;
mod loaded;
mod model;
mod newton;
mod path;
mod perturbed;
mod prepared;
mod problem;
mod redundant_cables;
mod refinement;
mod relaxation;
mod scratch;
mod search;
mod sensitivity;
mod shooting;
mod solve;
mod stability;
mod state;
mod statics;
mod step_lanes;
#[cfg(test)]
mod step_tests;
mod strain_guess;
mod target;
mod tension_nodes;
mod trace;
mod unloaded;
mod verdict;
mod without_load;

pub use crate::statics::options::{Accuracy, Options};
pub use crate::statics::trace::{Stage, TraceEvent};
pub(crate) use lanes::RodLanes;
pub use prepared::{Cosserat, Workspace};
