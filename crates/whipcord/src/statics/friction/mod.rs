//! Friction of cables at their holes, for any model whose shape answers the tensions of all pieces of cable.
//!
//! | module | content |
//! |---|---|
//! | `holes` | the holes of a robot, their state, and what they remember |
//! | `law` | the capstan equation with stick and slip as one equation for each hole, eqs. (1) and (2) |
//! | `linear_problem` | the linear problem of the holes in given cases |
//! | `response` | what a model tells: shape, lengths and angles by the tensions |
//! | `newton` | shape and tensions in one semismooth Newton's method |
//! | `events` | where the holes slide and stop in a substep, by the linear response of the shape |
//! | `substeps` | a step of actuation, divided where the linear response misses too much |
//!
//! `docs/theory/hole-friction.md` derives the equations.

mod events;
mod holes;
mod law;
mod linear_problem;
mod newton;
mod response;
mod substeps;

pub(crate) use holes::{History, Holes, Slides};
pub(crate) use newton::FrictionScratch;
pub(crate) use response::{PassageResponse, Passages, Response};
pub(crate) use substeps::{Course, step};
