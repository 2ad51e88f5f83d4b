//! Sections and steps of rods side by side in the lanes of the processor's vectors.
//!
//! | module | content |
//! |---|---|
//! | `columns` | numbers of several sections, one in each lane |
//! | `one_cable` | a section that one cable crosses in each lane |
//! | `section` | a section in each lane, its response at rest and its Hessian |
//! | `equilibrium` | the strain of a section in each lane by Newton's method |
//! | `slots` | the sections of a table, one in each lane |
//! | `run` | the sections of one robot that [`super::section_runs`] puts side by side |
//! | `rod_step` | a step of a rod under loads in each lane |

pub(crate) mod columns;
pub(crate) mod equilibrium;
pub(crate) mod one_cable;
pub(crate) mod rod_step;
pub(crate) mod run;
pub(crate) mod section;
pub(crate) mod slots;
