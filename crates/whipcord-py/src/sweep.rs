//! Data sets of many shapes.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::SolveError;
use whipcord_sweep::{Axis, AxisValues, Plan, Question, RunOptions, Sampling, SweepError, run};

use crate::errors;
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// Of the columns of a table their paths and units, and the values row by row.
type Rows = (Vec<(String, String)>, Vec<f64>);

/// What is asked of a sweep.
#[derive(FromPyObject)]
pub struct Asked {
    #[pyo3(item)]
    vary: Vec<String>,
    #[pyo3(item)]
    table: Option<Rows>,
    #[pyo3(item)]
    samples: Option<u64>,
    #[pyo3(item)]
    sampling: String,
    #[pyo3(item)]
    seed: u64,
    #[pyo3(item)]
    outputs: Vec<String>,
    #[pyo3(item)]
    rows_per_part: Option<u64>,
}

/// Why there is no data set.
enum Failure {
    Input(&'static str, String),
    Sweep(SweepError),
}

impl Asked {
    fn question(self) -> Result<Question, Failure> {
        let (axes, sampling) = match self.table {
            Some((columns, values)) => {
                let axis = |(path, unit)| Axis { path, unit, values: AxisValues::OfTable };
                (columns.into_iter().map(axis).collect(), Sampling::Table { values })
            }
            None => {
                let axes = self.vary.iter().map(|axis| axis.parse());
                let axes: Result<Vec<Axis>, _> = axes.collect();
                let sampling = match self.samples {
                    None => Sampling::Grid,
                    Some(rows) => {
                        let named = Sampling::named(&self.sampling, rows, self.seed);
                        named.ok_or_else(|| {
                            let name = &self.sampling;
                            let message = format!(
                                "there is no sampling `{name}`: choose random, latin-hypercube or sobol"
                            );
                            Failure::Input("sampling", message)
                        })?
                    }
                };
                (axes.map_err(|error| Failure::Input("vary", error.to_string()))?, sampling)
            }
        };
        let outputs = self.outputs.iter().map(|name| name.parse());
        let outputs: Result<Vec<_>, _> = outputs.collect();
        let outputs = outputs.map_err(|error: whipcord_sweep::UnknownOutput| {
            Failure::Input("outputs", error.to_string())
        })?;
        Ok(Question { axes, sampling, outputs, rows_per_part: self.rows_per_part })
    }
}

/// Makes a data set, or a shard of one.
#[pyfunction]
#[pyo3(signature = (setup, model, asked, out, shard, resume))]
pub fn sweep<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    asked: Asked,
    out: PathBuf,
    shard: (u64, u64),
    resume: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let text = whipcord_io::describe(Some(&setup.title), &setup.robot, &setup.case);
    let text = text.map_err(|error| errors::input(py, "case", error.to_string()))?;
    let text = whipcord_io::toml(&text);
    let file = whipcord_io::parse(&text, &setup.title);
    let file = file.map_err(|error| errors::file(py, &error, &setup.title))?;
    let (model, limit) = model.begin();
    let made = within(py, &limit, move || -> Result<_, Failure> {
        let question = asked.question()?;
        let plan = Plan::new(&file, &model, &question).map_err(Failure::Sweep)?;
        let options = RunOptions { shard, resume, progress: None };
        let summary = run(&plan, &out, &options).map_err(Failure::Sweep)?;
        Ok((plan, summary))
    })?;
    let (plan, summary) = made.map_err(|failure| raised(py, failure))?;
    let values = PyDict::new(py);
    values.set_item("rows", summary.rows)?;
    values.set_item("parts", summary.parts)?;
    values.set_item("kept_parts", summary.kept)?;
    values.set_item("failed", summary.failed)?;
    values.set_item("unstable", summary.unstable)?;
    values.set_item("first_failure", summary.first_failure)?;
    values.set_item("all_rows", plan.rows())?;
    values.set_item("all_parts", plan.parts())?;
    values.set_item("columns", plan.column_names())?;
    Ok(values)
}

fn raised(py: Python<'_>, failure: Failure) -> PyErr {
    let error = match failure {
        Failure::Input(path, message) => return errors::input(py, path, message),
        Failure::Sweep(error) => error,
    };
    let path = match &error {
        SweepError::Stopped { .. } => {
            return errors::solve(py, &SolveError::Cancelled { last_load: None });
        }
        SweepError::Write { .. } => return errors::os(&error.to_string()),
        SweepError::File(of_file) => return errors::file(py, of_file, ""),
        SweepError::Batch(_) | SweepError::NoJacobian { .. } => "model",
        SweepError::Shard { .. } => "shard",
        SweepError::RowsPerPart { .. } => "rows_per_part",
        SweepError::Begun { .. } | SweepError::Another { .. } | SweepError::Manifest { .. } => {
            "out"
        }
        SweepError::NoRows
        | SweepError::NoCount { .. }
        | SweepError::Count { .. }
        | SweepError::TooManySobolAxes { .. } => "samples",
        _ => "vary",
    };
    errors::input(py, path, error.to_string())
}
