//! From measurements of a real cable-driven continuum robot to the parameters of its model.
//!
//! [`observation`] holds what was measured and its distance from a solution, [`registration`] the rigid motion between the
//! frame of a measurement and that of the robot, [`camera`] the models of cameras, and [`identification`] estimates parameters
//! of robot and case with their covariance. The mechanics is in the crate [`whipcord`].
//!
//! This crate opens no files, reads no clocks and starts no threads.

pub mod camera;
pub mod identification;
pub mod observation;
pub mod registration;
mod uncertainty;

pub use camera::{Camera, Lens};
pub use observation::{Observation, Place, Seen};
