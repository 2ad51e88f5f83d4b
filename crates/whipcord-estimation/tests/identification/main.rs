//! Estimates of what a robot is from what was seen of it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[allow(dead_code, reason = "other binaries use other parts of it")]
#[path = "../../../whipcord/tests/common/mod.rs"]
mod common;

mod columns;
mod coverage;
mod estimates;
mod refusals;
mod synthetic;
