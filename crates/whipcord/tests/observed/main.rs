//! What is seen of a robot: cameras, and rigid registration.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod camera;
mod locating;
mod registration;
