//! Robots among obstacles: contact with friction, for every model that gives its response to wrenches (`Compliant`).
//!
//! `docs/theory/contact.md` has the equations whose numbers stand in the code.
//!
//! | module | content |
//! |---|---|
//! | `model` | the interface to a model |
//! | `loaded_places` | the cross-sections that are pushed, and their compliance |
//! | `contact_rod`, `rod`, `rod_response`, `rod_solves`, `refinement`, `dense_output` | what both Cosserat rods have of it |
//! | `member` | the parts of the robot that can touch |
//! | `scene`, `body` | the obstacles; distances of a part of the robot from one |
//! | `pairs` | the parts of the robot that are near an obstacle |
//! | `sliding` | contacts that move along the backbone |
//! | `friction` | stick and slip of a contact |
//! | `stability` | the directions in which a robot leaves an equilibrium in contact |
//! | `complementarity`, `descent`, `partly_known` | which contacts touch and which stick |
//! | `step`, `two_bodies`, `differences` | Newton's method on the conditions of contact |
//! | `object`, `object_pair`, `object_pairs`, `features` | movable objects, and what of them and of obstacles can touch |
//! | `holding`, `held_contact`, `carried` | the contacts of an answer, linearised; the movable objects among them |
//! | `alone` | answers without obstacles that several attempts ask for |
//! | `free_path`, `watched_places` | robots that keep clear of all obstacles; where rods are watched |
//! | `rim_places`, `clearance` | disks that fit a bore closely |
//! | `relaxation`, `dampers` | where the robot jumps to if it loses its equilibrium on the way |
//! | `laid_along`, `bore_line` | the robot that finds no way into a pipe, laid along its bore |
//! | `approach`, `drawn_out` | where it may come to if it finds no rest |
//! | `noted` | the equilibria on the way, for derivatives |
//! | `step_length` | how far the robot may move in one step on the way |
//! | `equilibrium` | the equilibrium at one place of the way, in which contacts come and go |
//! | `homotopy`, `start`, `path` | the way from a shape without contact, or from a known answer, to the case |
//! | `steps`, `division` | the steps of actuation of a case, each with its way; how finely this is divided |

mod alone;
mod approach;
pub mod body;
mod bore_line;
mod carried;
mod clearance;
pub mod complementarity;
mod contact_rod;
mod dampers;
mod dense_output;
mod descent;
mod differences;
mod discovery;
mod division;
mod drawn_out;
mod equilibrium;
mod features;
mod free_path;
mod friction;
mod held_contact;
mod holding;
mod homotopy;
mod laid_along;
mod loaded_places;
pub mod member;
pub(crate) mod model;
mod noted;
mod object;
mod object_pair;
mod object_pairs;
mod overlap;
mod pair;
mod pairs;
mod partly_known;
mod path;
mod refinement;
mod relaxation;
mod rim_places;
mod rod;
mod rod_response;
mod rod_solves;
mod scene;
mod sliding;
mod stability;
mod start;
mod step;
mod step_length;
mod steps;
mod two_bodies;
mod watched_places;

pub(crate) use contact_rod::ContactRod;
pub(crate) use dense_output::DenseOutput;
pub(crate) use free_path::{
    FreeWay, Unobstructed, last_of, or_none_alone, rubbing_or_free, solve_free, steps_alone,
};
pub(crate) use holding::Holding;
pub(crate) use loaded_places::LoadedPlaces;
pub(crate) use model::{is_same_shape, with_pushes};
pub(crate) use noted::{
    Noted, NotedEnd, NotedWay, Noting, OnWay, last_with_derivatives, where_it_counts,
};
pub(crate) use refinement::{Refinement, centres};
pub(crate) use rod::RodAdapter;
pub(crate) use rod_response::{Linearised, RodHoles, RodResponse};
pub(crate) use rod_solves::RodSolves;
pub(crate) use steps::{RubbedAnswer, solve, solve_holding, solve_rubbing};
pub(crate) use watched_places::WatchedPlaces;
