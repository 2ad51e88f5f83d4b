//! Inverse problems of many robots: answers are checked by solves of their own.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

mod answers;
mod clock;
mod control;
mod follow;
mod planted;
mod proof;
mod robots;
mod speed;
mod workspace;
