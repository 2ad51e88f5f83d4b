//! Designs against exhaustion, closed forms and forward solves.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and a study prints its results"
)]

mod criteria;
mod curves;
mod holes;
mod robots;
mod study;
mod whole;
