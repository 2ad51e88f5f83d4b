//! The Cosserat rod with cables straight from hole to hole: to run one module,
//! `cargo test -p whipcord --test cosserat_disks MODULE::`.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by panicking, and a study prints"
)]

#[allow(dead_code, reason = "other binaries use other parts of it")]
#[path = "../common/mod.rs"]
mod common;

mod compliance;
mod friction;
mod loads;
mod reference;
mod stability;
mod statics;
mod study;
