//! Files for other programs.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use whipcord_export::{ExportError, Exported, Format, Job};

use crate::errors;
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// Names and contents of files, and what is not in them.
type Files<'py> = (Vec<(String, Bound<'py, PyBytes>)>, Vec<String>);

/// The files of a format, whose names begin with `stem`.
#[pyfunction]
pub fn export<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    format: &str,
    stem: String,
    per_span: Option<usize>,
) -> PyResult<Files<'py>> {
    let format = Format::named(format).ok_or_else(|| {
        let names = Format::ALL.map(Format::name).join(", ");
        errors::input(py, "to", format!("there is no format `{format}`: choose one of {names}"))
    })?;
    let (title, robot, case) = (setup.title.clone(), setup.robot.clone(), Arc::clone(&setup.case));
    let damping = setup.file_data.motion.damping.clone();
    let (model, limit) = model.begin();
    let made = within(py, &limit, move || {
        let (title, robot, case) = (title.as_str(), &robot, &*case);
        let (model, damping) = (&model, &damping);
        let job = Job { title, robot, case, model, damping, per_span };
        whipcord_export::export(&job, format, &stem)
    })?;
    let Exported { files, lost } = made.map_err(|error| match &error {
        ExportError::Solve { error, .. } => errors::solve(py, error),
        ExportError::NoTensions { .. } => errors::input(py, "model", error.to_string()),
        ExportError::TooManyBodies { .. } | ExportError::BentTooFar { .. } => {
            errors::input(py, "per_span", error.to_string())
        }
        ExportError::Unsupported { path, .. } => errors::input(py, path, error.to_string()),
        ExportError::Name { .. } | ExportError::Unwritten { .. } => {
            errors::input(py, "path", error.to_string())
        }
    })?;
    let files = files.into_iter().map(|file| (file.name, PyBytes::new(py, &file.bytes)));
    Ok((files.collect(), lost))
}
