//! What is seen of a robot: cameras, their places and their calibration, and rigid registration.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod calibrating;
mod camera;
mod locating;
mod registration;
