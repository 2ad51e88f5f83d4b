//! Motion against independent references.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

mod allocation;
mod energy;
mod lengths;
mod references;
mod robots;
mod scratch;
