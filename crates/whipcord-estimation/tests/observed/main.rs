//! What is seen of a robot: cameras, their places and their calibration, rigid registration, and models beside it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod calibrating;
mod camera;
mod compared;
mod locating;
mod registration;
