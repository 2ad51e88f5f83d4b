//! From checked tables to the library's types, one reader per table.

mod backbone;
mod cables;
mod commands;
mod criterion;
mod curve;
mod design;
mod disks;
mod fit;
mod goal;
mod loads;
mod measured;
mod mesh;
mod motion;
mod motors;
mod named;
mod numbers;
mod obstacles;
mod pose;
mod reference;
mod table;

pub(crate) use backbone::{backbone, material};
pub(crate) use cables::{cable, command, step};
pub use commands::{CommandColumn, CommandRow, CommandTable, Commanded};
pub(crate) use commands::{CommandedRobot, are_independent, read as commands};
pub use criterion::{criterion_text, parse_criterion};
pub use curve::{curve_text, is_curve, parse_curve};
pub use design::{
    DesignShape, DesignTable, DesignTarget, FixedHoleEntry, ToleranceTable, load_tip_path,
};
pub(crate) use design::{check_design, design};
pub(crate) use disks::disks;
pub(crate) use fit::fit;
pub use fit::{Fit, parameter_path};
pub use goal::{CableBounds, Clearance, Goal, RateMismatch, load_path, load_shape};
pub(crate) use goal::{check_shortenings, goal};
pub(crate) use loads::loads;
pub(crate) use measured::{Extent, read as measured};
pub use measured::{
    LENGTH_UNITS, Measured, MeasuredDisk, MeasuredRotation, MeasuringCamera, load_markers,
};
pub use motion::{CableCourse, Motion};
pub(crate) use motion::{Driven, Moved, check_motion, motion};
pub(crate) use motors::{Motors, motor_step, motors};
pub use numbers::{NumberTable, load_numbers};
pub(crate) use obstacles::obstacles;
pub(crate) use pose::pose;
pub use reference::Reference;
pub(crate) use reference::reference;
pub(crate) use table::{TableColumn, columns as table_columns};

use whipcord::Vec3;

use crate::check::{Data, Fields};

fn vector_quantities(list: &[Data]) -> Vec<f64> {
    list.iter().filter_map(Data::as_number).collect()
}

fn vec3(fields: &Fields, name: &str) -> Option<Vec3> {
    fields.vector(name).map(|[x, y, z]| Vec3::new(x, y, z))
}

fn vector(data: &Data) -> Option<Vec3> {
    match data.as_list()? {
        [x, y, z] => Some(Vec3::new(x.as_number()?, y.as_number()?, z.as_number()?)),
        _ => None,
    }
}
