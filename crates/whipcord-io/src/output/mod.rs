//! Answers as JSON and CSV, and files that are written whole or not at all.

mod atomic;
mod csv;
mod design;
mod fit;
mod fit_analyses;
mod json;
mod modes;
mod motion;
mod notices;
mod parquet;
mod path;
mod reach;
mod stiffness;
mod workspace;

use thiserror::Error;

pub use atomic::{remove_stale, remove_unfinished, write_atomically, write_one_of_many};
pub use csv::{
    Cell, CsvTable, SpacePoint, contacts_csv, marks_csv, points_csv, shape_csv, steps_csv,
};
pub use design::{
    design_errors_table, design_json, distributions, holes_table, quantile, samples_table,
    tolerances_json,
};
pub use fit::{fit_json, loss_name, status_words};
pub use json::{
    length_misses_json, number as json_number, optional as json_optional, solution_json,
};
pub use modes::{mode_shapes_table, modes_json, modes_table};
pub use motion::{
    EnergyOf, MOTION_ENERGIES, motion_contacts_table, motion_json, motion_table, poses_table,
};
pub use notices::{problems_json, warnings_json};
pub use parquet::{Column, Values, columns_to_parquet};
pub use path::{Beside, answer_json};
pub use reach::{follow_json, path_table, reach_json};
pub use stiffness::stiffness_json;
pub use workspace::{boundary_table, workspace_json, workspace_table};

/// A number that no output may hold: outputs are finite or there are none.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{path} is {value}, which is no result")]
pub struct NonFinite {
    /// Where it stands in the output.
    pub path: String,
    /// The value.
    pub value: f64,
}
