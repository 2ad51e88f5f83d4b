//! Motion against independent references.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod allocation;
mod closed_forms;
mod contact;
mod drives;
mod energy;
mod free;
mod free_contact;
mod friction;
mod friction_contact;
mod friction_drives;
mod gradient;
mod gradient_contact;
mod gradient_friction;
mod gradient_impact;
mod gravity_over_time;
mod invariance;
mod lengths;
mod order;
mod references;
mod refusals;
mod robots;
mod straight;
mod study;
mod vibrations;
