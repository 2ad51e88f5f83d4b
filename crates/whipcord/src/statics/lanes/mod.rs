//! Sections without load side by side in the lanes of the processor's vectors.
//!
//! | module | content |
//! |---|---|
//! | `section` | a section in each lane: its equilibrium and the Hessian there |
//! | `run` | the sections of one robot that [`super::section_runs`] puts side by side |

pub(crate) mod run;
pub(crate) mod section;
