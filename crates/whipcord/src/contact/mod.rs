//! Robots among obstacles: the shape that touches them without entering, and what pushes it there.
//!
//! The obstacles push without friction, along the normals of their surfaces. A model is asked only
//! how the robot yields to wrenches on its cross-sections ([`Yielding`]); everything about contact is
//! here. `body` says how near a part of the robot is to an obstacle, `pairs` which parts are near,
//! `step` is Newton's method on the conditions of contact, `path` follows the robot from where nothing
//! touches, or from a known answer, to the case. `docs/theory/contact.md` has the equations whose
//! numbers stand in the code.

mod body;
mod journey;
mod model;
mod pairs;
mod path;
mod scene;
mod step;

pub(crate) use model::{Push, Yielding};
pub(crate) use path::solve;
