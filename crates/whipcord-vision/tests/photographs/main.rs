//! Detection against synthetic photographs whose truth is known.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod boards;
mod disks;
mod markers;
mod order;
mod refusals;
mod scenes;
mod study;
mod truth;
