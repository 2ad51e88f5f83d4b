//! Estimates of parameters of a robot, and what they rest on: cameras, registration, distances of measurements.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

#[allow(dead_code, reason = "the tests of the mechanics use other parts of it")]
#[path = "../../../whipcord/tests/mechanics/common/mod.rs"]
mod common;
mod identification;
mod observed;
