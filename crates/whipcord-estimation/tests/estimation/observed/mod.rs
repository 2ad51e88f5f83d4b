//! What is seen of a robot: cameras, their places and their calibration, rigid registration, and models beside it.

mod calibrating;
mod camera;
mod compared;
mod locating;
mod locating_uncertainty;
mod noise;
mod registration;
mod stereo;
mod triangulating;
