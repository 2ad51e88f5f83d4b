//! How far models are from a table of measurements.

use std::num::NonZero;
use std::path::PathBuf;

use pyo3::prelude::*;
use whipcord::ModelKind;
use whipcord_io::CaseFile;
use whipcord_study::failure::Failure;
use whipcord_study::files::Folder;
use whipcord_study::score::{Score, Solved, output};

use crate::errors;
use crate::fit::file;
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// Models and files with the answers to all measured rows.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Scored {
    cases: Vec<CaseFile>,
    solved: Solved,
}

/// Solves the measured rows of the cases by these models; the time is that of the first.
#[pyfunction]
#[pyo3(signature = (setups, models, threads = None))]
pub fn score(
    py: Python<'_>,
    setups: Vec<PyRef<'_, Setup>>,
    models: Vec<PyRef<'_, Model>>,
    threads: Option<usize>,
) -> PyResult<Scored> {
    let Some(first) = models.first() else {
        return Err(errors::input(py, "by", "there is no model to score".to_owned()));
    };
    if setups.is_empty() {
        return Err(errors::input(py, "cases", "there is no case to score".to_owned()));
    }
    let (_, limit) = first.begin();
    let kinds: Vec<ModelKind> = models.iter().map(|model| model.inner.kind()).collect();
    let cases: Vec<CaseFile> =
        setups.iter().enumerate().map(|(i, setup)| file(py, i, setup)).collect::<PyResult<_>>()?;
    let (threads, cancel) = (threads.and_then(NonZero::new), limit.cancel.clone());
    let (cases, solved) = within(py, &limit, move || {
        let of = cases.iter().collect::<Vec<_>>();
        let solved = Solved::of(&of, kinds, threads, &cancel, &|_, _| ());
        (cases, solved)
    })?;
    let solved = solved.map_err(|failure| match failure {
        Failure::Solve(_) => errors::timed_out(py, "not all rows were solved".to_owned(), None),
        other => {
            let message = other.to_string();
            let message = message.trim_start_matches("error: ").to_owned();
            errors::input(py, "cases", message)
        }
    })?;
    Ok(Scored { cases, solved })
}

impl Scored {
    fn with<T>(&self, work: impl FnOnce(Score<'_>) -> T) -> T {
        work(self.solved.clone().score(&self.cases.iter().collect::<Vec<_>>()))
    }
}

#[pymethods]
impl Scored {
    /// What `whipcord score --json --rows` prints.
    fn json(&self, rows: bool) -> String {
        self.with(|score| output::json(&score, rows).to_string())
    }

    /// Writes report, figures and CSV to a folder, and returns the path of the report.
    fn report(&self, py: Python<'_>, folder: PathBuf, figures: bool) -> PyResult<PathBuf> {
        let write = || {
            let to = Folder::create(&folder)?;
            self.with(|score| score.write(&to, figures, &[]))
        };
        py.detach(write).map_err(|failure: Failure| errors::os(&failure.to_string()))?;
        Ok(folder.join("report.html"))
    }
}
