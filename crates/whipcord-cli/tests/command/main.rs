//! Runs the command as people do, and reads what it says.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test fails by panicking"
)]

mod bench;
mod benchmarks;
mod blank_cells;
mod camera;
mod check;
mod compare;
mod design;
mod export;
mod fit;
#[cfg(target_os = "linux")]
mod hostile;
mod measure;
mod modes;
mod over_determined;
mod overlay;
mod reach;
mod reference;
mod simulate;
mod solve;
mod start;
mod stereo;
mod stiffness;
mod support;
mod sweep;
mod tables;
mod timeout;
mod warnings;
mod workspace;
