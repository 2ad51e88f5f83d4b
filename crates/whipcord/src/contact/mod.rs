//! Robots among obstacles: the shape that touches them without entering, and what pushes it there.
//!
//! The obstacles push along the normals of their surfaces and rub with Coulomb friction. A model is asked only
//! how the robot yields to wrenches on its cross-sections ([`Yielding`]); everything about contact is
//! here. `body` says how near a part of the robot is to an obstacle, `pairs` which parts are near, `friction` how they
//! hold on; `step` is Newton's method on the conditions of contact, in which `complementarity` decides what touches and
//! what sticks; `path` follows the robot from where nothing
//! touches, or from a known answer, to the case. `docs/theory/contact.md` has the equations whose
//! numbers stand in the code.

mod body;
mod complementarity;
mod friction;
mod journey;
mod model;
mod pairs;
mod path;
mod scene;
mod step;

pub(crate) use model::{Push, Yielding};
pub(crate) use path::solve;
