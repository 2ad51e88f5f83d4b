//! The extension module `whipcord._core` of the Python package.
//!
//! It converts arguments, lets go of the interpreter's lock, calls the library, and makes exceptions
//! of errors; what is pleasant to use from Python is written in Python, in `python/whipcord`.

mod batch;
mod benchmark;
mod calibration;
mod camera;
mod controller;
mod convert;
mod derivatives;
mod design;
mod errors;
mod export;
mod figure;
mod file_data;
mod fit;
mod inverse;
mod measurement;
mod model;
mod motion;
mod motion_batch;
mod notice;
mod object_state;
mod overlay;
mod photo;
mod prepared;
mod reach;
mod score;
mod setup;
mod solution;
mod stereo;
mod sweep;
mod wait;
mod workspace;

use std::ffi::OsString;

use pyo3::prelude::*;
use whipcord_cli::examples::EXAMPLES;

/// Runs the command line with these arguments, the first being its own name; returns its exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| whipcord_cli::run(arguments))
}

/// The example files: relative path and content of each.
#[pyfunction]
fn examples() -> Vec<(&'static str, &'static [u8])> {
    EXAMPLES.iter().map(|example| (example.name, example.content)).collect()
}

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::batch::{Outcomes, pull_back_batch, solve_batch, solve_cases};
    #[pymodule_export]
    use super::benchmark::{benchmark, suite};
    #[pymodule_export]
    use super::calibration::{Board, Seen, calibrate};
    #[pymodule_export]
    use super::camera::{Camera, locate_orthographic};
    #[pymodule_export]
    use super::controller::Controller;
    #[pymodule_export]
    use super::convert::{materials, parse_quantity, table_in_si, toml, write_file};
    #[pymodule_export]
    use super::derivatives::{Derivatives, derivatives};
    #[pymodule_export]
    use super::design::design;
    #[pymodule_export]
    use super::examples;
    #[pymodule_export]
    use super::export::export;
    #[pymodule_export]
    use super::figure::svg;
    #[pymodule_export]
    use super::fit::{Fitted, fit};
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::measurement::distances;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::motion::{Simulation, SimulationState, modes, simulate};
    #[pymodule_export]
    use super::motion_batch::Motions;
    #[pymodule_export]
    use super::overlay::overlay;
    #[pymodule_export]
    use super::photo::{Photo, marks_csv, picture};
    #[pymodule_export]
    use super::reach::{follow, reach, reach_batch};
    #[pymodule_export]
    use super::score::{Scored, score};
    #[pymodule_export]
    use super::setup::Setup;
    #[pymodule_export]
    use super::solution::Solution;
    #[pymodule_export]
    use super::stereo::{calibrate_two, in_space, locate_pair, points_csv, triangulate};
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::workspace::workspace;

    /// Version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
