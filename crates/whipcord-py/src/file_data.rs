//! What a robot file says apart from the robot and the case: measurements, published values, and what is to be estimated.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord_io::{CaseFile, Fit, Goal, Measured, Motion, Reference};

use crate::notice::{Notice, notices};

/// What a robot file says apart from the robot and the case.
#[derive(Clone, Default)]
pub struct FileData {
    pub measured: Option<Arc<Measured>>,
    pub reference: Option<Arc<Reference>>,
    pub fit: Option<Fit>,
    /// What is to be reached, and within which limits.
    pub goal: Goal,
    /// How it moves over time.
    pub motion: Motion,
    /// The file itself, of what was loaded from one and not changed.
    pub file: Option<Arc<CaseFile>>,
    /// Warnings about the file; `None` if robot and case do not come from a file.
    pub notices: Option<Arc<Vec<Notice>>>,
}

impl FileData {
    pub fn of(file: &CaseFile, has_units: bool) -> Self {
        Self {
            measured: file.measured.clone().map(Arc::new),
            reference: file.reference.clone().map(Arc::new),
            fit: file.fit.clone(),
            goal: file.goal.clone(),
            motion: file.motion.clone(),
            file: None,
            notices: Some(Arc::new(notices(file, has_units))),
        }
    }
}

/// The published values as a dict.
pub fn reference<'py>(py: Python<'py>, reference: &Reference) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    values.set_item("source", &reference.source)?;
    values.set_item("rms_four_bar", reference.rms_four_bar)?;
    values.set_item("rms_cosserat", reference.rms_cosserat)?;
    values.set_item("time_four_bar", reference.time_four_bar)?;
    values.set_item("time_cosserat", reference.time_cosserat)?;
    Ok(values)
}
