//! What stands in the way, and how far off it is.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod exact;
mod forms;
mod meshes;
mod properties;
