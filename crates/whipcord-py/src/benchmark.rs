//! Benchmark of the models: how far each is from a reference, how long it takes, and which to use for what.

use pyo3::prelude::*;
use whipcord::ModelKind;
use whipcord_study::judging::{Judgement, JudgingError, Tried};

use crate::errors;
use crate::model::{self, named};
use crate::setup::Setup;
use crate::wait::{Limit, within};

/// JSON, text and, where there is an error to draw, the SVG of a benchmark of these models: on cases, or on those of a
/// suite whose names contain one of `only`.
#[pyfunction]
#[pyo3(signature = (setups, models, reference, suite = None, only = Vec::new(), timeout = None))]
pub fn benchmark(
    py: Python<'_>,
    setups: Vec<PyRef<'_, Setup>>,
    models: Vec<String>,
    reference: String,
    suite: Option<&str>,
    only: Vec<String>,
    timeout: Option<f64>,
) -> PyResult<(String, String, Option<String>)> {
    let timeout = timeout.map(|seconds| model::timeout(py, seconds)).transpose()?;
    let refused = |error: JudgingError| {
        let path = match error {
            JudgingError::Reference(_) => "reference",
            JudgingError::NoSuite(_) => "suite",
            JudgingError::NoCase(_) | JudgingError::Case(_) => "only",
            JudgingError::Cancelled => return errors::timed_out(py, error.to_string(), None),
        };
        errors::input(py, path, error.to_string())
    };
    let kinds: Vec<ModelKind> =
        models.iter().map(|name| named(py, "by", name)).collect::<PyResult<_>>()?;
    let tried: Vec<Tried> = match suite {
        Some(name) => Tried::suite(name, &only).map_err(refused)?,
        None => setups
            .iter()
            .map(|setup| {
                let measured = setup.file_data.measured.as_deref().cloned();
                Tried::new(
                    setup.title.clone(),
                    setup.robot.clone(),
                    (*setup.case).clone(),
                    measured,
                )
            })
            .collect(),
    };
    let limit = Limit::starting_now(timeout);
    let cancel = limit.cancel.clone();
    let judgement =
        within(py, &limit, move || Judgement::new(&tried, &kinds, &reference, &cancel))?;
    let judgement = judgement.map_err(refused)?;
    let json = judgement.json().map_err(|error| errors::input(py, "cases", error.to_string()))?;
    let svg = judgement.svg().map_err(|error| errors::input(py, "cases", error.to_string()))?;
    Ok((json.to_string(), judgement.text(), svg))
}

/// The cases of a suite whose names contain one of `only`: their names, and the cases.
#[pyfunction]
#[pyo3(signature = (name, only = Vec::new()))]
pub fn suite(py: Python<'_>, name: &str, only: Vec<String>) -> PyResult<Vec<(String, Setup)>> {
    let cases = Tried::suite(name, &only);
    let cases = cases.map_err(|error| errors::input(py, "suite", error.to_string()))?;
    let setup =
        |Tried { title, name, robot, case, .. }| (name, Setup::new(title, robot, case.into()));
    Ok(cases.into_iter().map(setup).collect())
}
