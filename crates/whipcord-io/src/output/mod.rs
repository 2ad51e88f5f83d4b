//! Answers as JSON and CSV, and files that are written whole or not at all.

mod atomic;
mod csv;
mod json;

use thiserror::Error;

pub use atomic::{remove_unfinished, write_atomically};
pub use csv::{Cell, CsvTable, shape_csv};
pub use json::solution_json;

/// A number that no output may hold: outputs are finite or there are none.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{path} is {value}, which is no result")]
pub struct NonFinite {
    /// Where it stands in the output.
    pub path: String,
    /// The value.
    pub value: f64,
}
