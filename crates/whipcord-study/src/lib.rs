//! Comparisons of models and the reports about them: which model answers a question best, how far each is from the others and
//! from measurements, how long each takes, and what a fit has found.
//!
//! The command line and the Python package take their results from this crate. It reads clocks, and writes files where it is
//! given a folder; the mechanics is in [`whipcord`].

pub mod benchmark;
pub mod bending_friction;
pub mod comparison;
pub mod contacts;
pub mod describe;
pub mod failure;
pub mod files;
pub mod fitting;
pub mod html;
pub mod judging;
mod mirrored;
pub mod model_benchmark;
pub mod motors;
pub mod quantity;
pub mod remark;
mod resample;
pub mod score;
pub mod statistics;
pub mod steps;
pub mod style;
pub mod suite;
pub mod table;
pub mod timing;
pub mod warnings;
