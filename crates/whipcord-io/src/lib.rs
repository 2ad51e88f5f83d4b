//! Files of whipcord: robot files with units and messages that point at the place, the JSON
//! Schema of robot files, cameras in OpenCV's YAML and JSON, and answers as JSON and CSV.
//!
//! There are no mechanics here, and no judgement of what a robot can be: [`load`] reads what a
//! file says into the types of the [`whipcord`] crate, which checks them.

mod atlas_file;
mod camera;
mod case_file;
mod check;
mod design_problem;
mod document;
mod error;
mod files;
mod help;
mod materials;
mod node;
mod output;
mod overlay;
mod read;
mod render;
mod schema;
mod settings;
mod source;
mod suggest;
mod syntax;
mod units;
mod validate;
mod warnings;

pub use atlas_file::{AtlasFileError, atlas_to_parquet, load_atlas, start_from_atlas};
pub use camera::{
    CalibratedCamera, CameraFormat, calibrated_camera_text, camera_text, load_calibrated_camera,
    load_camera, parse_calibrated_camera, parse_camera,
};
pub use case_file::{CaseFile, load, load_stream, load_with, parse};
pub use design_problem::{DesignProblem, NoDesignProblem, designed_case};
pub use document::{
    FittedFile, Inexpressible, Item, Mounting, Table, describe, describe_fit, describe_goal,
    describe_motion, table_in_si, toml,
};
pub use error::{CommandedMotor, Diagnostic, FileError, FileProblem};
pub use files::read_photograph;
pub use materials::{MaterialPreset, Shear, materials};
pub use output::{
    Beside, Cell, Column, CsvTable, EnergyOf, MOTION_ENERGIES, NonFinite, SpacePoint, Values,
    answer_json, boundary_table, columns_to_parquet, contacts_csv, design_errors_table,
    design_json, distributions, fit_json, follow_json, holes_table, json_number, json_optional,
    length_misses_json, loss_name, marks_csv, mode_shapes_table, modes_json, modes_table,
    motion_contacts_table, motion_json, motion_table, path_table, points_csv, poses_table,
    problems_json, quantile, reach_json, remove_stale, remove_unfinished, samples_table, shape_csv,
    solution_json, status_words, steps_csv, stiffness_json, tolerances_json, warnings_json,
    workspace_json, workspace_table, write_atomically, write_one_of_many,
};
pub use read::{
    CableBounds, CableCourse, Clearance, CommandColumn, CommandRow, CommandTable, Commanded,
    DesignShape, DesignTable, DesignTarget, Fit, FixedHoleEntry, Goal, LENGTH_UNITS, Measured,
    MeasuredDisk, MeasuredRotation, MeasuringCamera, Motion, NumberTable, RateMismatch, Reference,
    ToleranceTable, criterion_text, curve_text, is_curve, load_markers, load_numbers, load_path,
    load_shape, load_tip_path, parameter_path, parse_criterion, parse_curve,
};
pub use render::{render, render_warnings};
pub use schema::schema;
pub use source::{Position, Source, Sources, Span};
pub use suggest::nearest_parameter;
pub use units::{Dimension, QuantityError, Unit, parse_quantity, split_quantity};
pub use warnings::{AnswerOf, FileWarning};
