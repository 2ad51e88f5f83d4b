//! Robots among obstacles: contact with friction, for every model that gives its response to wrenches ([`Compliant`]).
//!
//! `docs/theory/contact.md` has the equations whose numbers stand in the code.
//!
//! | module | content |
//! |---|---|
//! | `model` | the interface to a model |
//! | `pushed_places` | the cross-sections that are pushed, and their compliance |
//! | `rod`, `rod_response`, `refinement`, `dense_output` | what both Cosserat rods have of it |
//! | `scene`, `body` | the obstacles; distances of a part of the robot from one |
//! | `pairs` | the parts of the robot that are near an obstacle |
//! | `sliding` | contacts that move along the backbone |
//! | `friction` | stick and slip of a contact |
//! | `complementarity` | which contacts touch and which stick |
//! | `step` | Newton's method on the conditions of contact |
//! | `holding` | the contacts of an answer, linearised |
//! | `free_path` | robots that keep clear of all obstacles |
//! | `relaxation`, `dampers` | where the robot jumps to if it loses its equilibrium on the way |
//! | `homotopy`, `path` | the way from a shape without contact, or from a known answer, to the case |

mod body;
mod complementarity;
mod dampers;
mod dense_output;
mod free_path;
mod friction;
mod holding;
mod homotopy;
pub(crate) mod model;
mod pairs;
mod path;
mod pushed_places;
mod refinement;
mod relaxation;
mod rod;
mod rod_response;
mod scene;
mod sliding;
mod step;

pub(crate) use dense_output::DenseOutput;
pub(crate) use free_path::{Unobstructed, solve_free};
pub(crate) use holding::Holding;
pub(crate) use model::{is_same_shape, with_pushes};
pub(crate) use path::{solve, solve_holding};
pub(crate) use pushed_places::PushedPlaces;
pub(crate) use refinement::{Refinement, centres};
pub(crate) use rod::{PushedRod, RodAdapter, on_few_steps_or_more, watched};
pub(crate) use rod_response::RodResponse;
