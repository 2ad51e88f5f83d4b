//! Friction of cables at their holes, for any model whose shape answers the tensions of all pieces of cable.
//!
//! | module | content |
//! |---|---|
//! | `holes` | the holes of a robot, their state, and what they remember |
//! | `modes` | stick, slip and slack at a hole |
//! | `law` | the capstan equation with stick and slip as one equation for each hole, eqs. (1) and (2) |
//! | `linear_problem` | the linear problem of the holes in given cases |
//! | `response` | what a model tells: shape, lengths and angles by the tensions |
//! | `pivoting` | modes that agree with the solution of their linear problem, by block principal pivoting and Lemke's method |
//! | `newton` | shape and tensions in one semismooth Newton's method |
//! | `events` | where the holes slide and stop in a substep, by the linear response of the shape |
//! | `substeps` | a step of actuation, divided where the linear response misses too much |
//! | `condensed_holes` | the holes of a robot among obstacles, in the Newton's method of its contacts |
//! | `moving_holes` | the holes of a robot in motion, whose time steps are the substeps |
//! | `way` | the way of a step: its commands, its state, and where holes come to rest on it |
//! | `trail` | the ends of the substeps, and where holes stop in between, for derivatives |
//! | `standing` | how the cables stand in their holes there |
//! | `carrying` | how what the holes remember changes from end to end |
//! | `held` | the tensions of all passages while something else changes: the derivatives of the equations of the holes |
//!
//! `docs/theory/hole-friction.md` derives the equations.

mod carried;
mod carrying;
mod condensed_holes;
mod events;
mod held;
mod holes;
mod law;
mod linear_problem;
mod modes;
mod moving_holes;
mod newton;
mod pivoting;
mod response;
mod standing;
mod substeps;
mod trail;
mod way;

pub(crate) use carried::Carried;
pub(crate) use carrying::{Carrying, Place};
pub(crate) use condensed_holes::CondensedHoles;
pub(crate) use held::{HeldHoles, HoleChange, HoleSource};
pub(crate) use holes::{History, Holes, Slides};
pub use moving_holes::{HoleEquation, HoleFriction, HoleMemory, HoleResponse};
pub(crate) use newton::FrictionScratch;
pub(crate) use response::{PassageResponse, Passages, Response};
pub(crate) use substeps::{Course, step};
pub(crate) use trail::{Standing, SubstepEnd, Trail};
