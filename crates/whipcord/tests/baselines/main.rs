//! The baseline models against closed forms, against the rods and against each other.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[allow(dead_code, reason = "other binaries use other parts of it")]
#[path = "../common/mod.rs"]
mod common;

mod constant_curvature;
mod sections;
