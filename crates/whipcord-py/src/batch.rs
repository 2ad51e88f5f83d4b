//! Many rows at once, with the interpreter free for others meanwhile.

use core::num::NonZeroUsize;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use whipcord::batch::{
    Arrays, BatchOptions, Gradients, Progress, Rows, Sensitivities, Solved, solve_batch_into,
    solve_robots,
};
use whipcord::{Diagnostics, ModelKind, SolveError};

use crate::convert::array;
use crate::errors;
use crate::model::Model;
use crate::setup::{Setup, parameter};
use crate::solution::Solution;
use crate::wait::supervise;

/// How each row was solved, or why it was not.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Outcomes {
    rows: Vec<Result<Solved, SolveError>>,
}

/// Positions, orientations, tensions and lengths, and how each row went.
type Solutions<'py> = (
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Outcomes,
);

/// Gradients by commands and by parameters, and how each row went.
type Pulled<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Outcomes);

#[pymethods]
impl Outcomes {
    /// (N,) whether a row has an answer.
    #[getter]
    fn ok<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        array(py, self.rows.iter().map(Result::is_ok).collect(), [self.rows.len()])
    }

    /// Numbers of the rows without an answer, from 0.
    #[getter]
    fn failed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let failed = self.rows.iter().enumerate().filter(|(_, row)| row.is_err());
        let numbers: Vec<i64> = failed.map(|(i, _)| i as i64).collect();
        let count = numbers.len();
        array(py, numbers, [count])
    }

    /// (N,) whether a row has an answer that is known to be stable.
    #[getter]
    fn stable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.recommendation(py, Some(true))
    }

    /// (N,) whether a row has an answer that is known to be unstable.
    #[getter]
    fn unstable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.recommendation(py, Some(false))
    }

    /// (N,) a diagnostic; NaN where a row has none.
    fn diagnostic<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let of: fn(&Diagnostics) -> Option<f64> = match name {
            "iterations" => |d| Some(d.iterations as f64),
            "residual" => |d| Some(d.residual),
            "stability" => |d| d.stability,
            "discretization_error" => |d| d.discretization_error,
            "steps" => |d| Some(d.steps as f64),
            "stability_lost_at" => |d| d.stability_lost_at,
            _ => {
                let message = format!("there is no diagnostic `{name}`");
                return Err(errors::input(py, "name", message));
            }
        };
        let value = |row: &Result<Solved, SolveError>| {
            row.as_ref().ok().and_then(|solved| of(&solved.diagnostics)).unwrap_or(f64::NAN)
        };
        array(py, self.rows.iter().map(value).collect(), [self.rows.len()])
    }

    /// Why a row has no answer, as an exception; None where it has one.
    fn error(&self, py: Python<'_>, row: usize) -> Option<Py<PyAny>> {
        let error = self.rows.get(row)?.as_ref().err()?;
        Some(errors::solve(py, error).into_value(py).into_any())
    }

    fn __len__(&self) -> usize {
        self.rows.len()
    }
}

impl Outcomes {
    /// (N,) whether a row has an answer with this verdict of stability.
    fn recommendation<'py>(
        &self,
        py: Python<'py>,
        stable: Option<bool>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let is_it = |row: &Result<Solved, SolveError>| {
            row.as_ref().is_ok_and(|solved| solved.is_stable() == stable)
        };
        array(py, self.rows.iter().map(is_it).collect(), [self.rows.len()])
    }
}

/// Solves rows of tensions in N or shortenings in m: (N, n, 3) positions, (N, n, 4) quaternions,
/// (N, c) tensions and (N, c) lengths, and how each went.
#[pyfunction]
#[pyo3(signature = (setup, model, values, driven_by, threads, path, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn solve_batch<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    values: PyReadonlyArray2<'py, f64>,
    driven_by: &str,
    threads: Option<usize>,
    path: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Solutions<'py>> {
    let (method, limit) = model.begin();
    let count = setup.rows(py, &values, driven_by)?;
    let cables = setup.robot.cables().len();
    let stations = setup.station_list(py, model)?.len();
    let position = PyArray3::zeros(py, [count, stations, 3], false);
    let orientation = PyArray3::zeros(py, [count, stations, 4], false);
    let tension = PyArray2::zeros(py, [count, cables], false);
    let length = PyArray2::zeros(py, [count, cables], false);
    let rows = {
        let (mut position, mut orientation) = (position.readwrite(), orientation.readwrite());
        let (mut tension, mut length) = (tension.readwrite(), length.readwrite());
        let arrays = Arrays {
            positions: position.as_slice_mut()?,
            orientations: orientation.as_slice_mut()?,
            tensions: tension.as_slice_mut()?,
            lengths: length.as_slice_mut()?,
        };
        let rows = asked(setup, values.as_slice()?, driven_by);
        supervise(py, &limit, progress, |progress| {
            let options = BatchOptions { warm_path: path, ..shared(threads, progress) };
            solve_batch_into(&method, &setup.robot, rows, &options, arrays)
        })?
    };
    Ok((position, orientation, tension, length, Outcomes { rows }))
}

/// Solves cases of any robots, each from cold: of each its answer, or an exception.
#[pyfunction]
#[pyo3(signature = (setups, model, threads, progress))]
pub fn solve_cases<'py>(
    py: Python<'py>,
    setups: Vec<PyRef<'py, Setup>>,
    model: &Model,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Vec<Py<PyAny>>> {
    let cases: Vec<_> =
        setups.iter().map(|setup| (setup.robot.clone(), (*setup.case).clone())).collect();
    let (method, limit) = model.begin();
    let answers = supervise(py, &limit, progress, |progress| {
        solve_robots(&method, &cases, &shared(threads, progress))
    })?;
    let answered = answers.into_iter().zip(&setups).map(|(answer, setup)| match answer {
        Ok(solution) => Ok(Py::new(py, Solution::new(solution, &setup.case))?.into_any()),
        Err(error) => Ok(errors::solve(py, &error).into_value(py).into_any()),
    });
    answered.collect()
}

/// Pulls sensitivities of one scalar for each row to its positions, turns, tensions and lengths back:
/// (N, c) gradients by the commands, (N, p) by parameters, and which rows have one.
#[pyfunction]
#[pyo3(signature = (
    setup, model, values, driven_by, parameters, threads, progress, positions = None,
    rotations = None, tensions = None, lengths = None
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn pull_back_batch<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    values: PyReadonlyArray2<'py, f64>,
    driven_by: &str,
    parameters: Vec<String>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
    positions: Option<PyReadonlyArray3<'py, f64>>,
    rotations: Option<PyReadonlyArray3<'py, f64>>,
    tensions: Option<PyReadonlyArray2<'py, f64>>,
    lengths: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<Pulled<'py>> {
    let count = setup.rows(py, &values, driven_by)?;
    let (method, limit) = model.begin();
    if matches!(method.kind(), ModelKind::FourBar | ModelKind::ConstantCurvature)
        && !method.has_derivatives(&setup.robot)
    {
        return Err(errors::not_by(py, method.kind(), "gradients"));
    }
    let parameters: Vec<_> =
        parameters.iter().map(|path| parameter(py, path)).collect::<PyResult<_>>()?;
    let by_commands = PyArray2::zeros(py, [count, values.as_array().ncols()], false);
    let by_parameters = PyArray2::zeros(py, [count, parameters.len()], false);
    let rows = {
        let (mut commands, mut others) = (by_commands.readwrite(), by_parameters.readwrite());
        let gradients =
            Gradients { commands: commands.as_slice_mut()?, parameters: others.as_slice_mut()? };
        let sensitivities = Sensitivities {
            positions: positions.as_ref().map_or(Ok(&[][..]), |array| array.as_slice())?,
            rotations: rotations.as_ref().map_or(Ok(&[][..]), |array| array.as_slice())?,
            tensions: tensions.as_ref().map_or(Ok(&[][..]), |array| array.as_slice())?,
            lengths: lengths.as_ref().map_or(Ok(&[][..]), |array| array.as_slice())?,
        };
        let rows = asked(setup, values.as_slice()?, driven_by);
        supervise(py, &limit, progress, |progress| {
            let options = shared(threads, progress);
            let robot = &setup.robot;
            whipcord::batch::pull_back_batch(
                &method,
                robot,
                rows,
                &parameters,
                &options,
                sensitivities,
                gradients,
            )
        })?
    };
    let rows = rows.into_iter().map(|row| row.map(|()| Solved::default())).collect();
    Ok((by_commands, by_parameters, Outcomes { rows }))
}

/// The rows of a case: tensions, shortenings, or commands of the motors.
fn asked<'a>(setup: &'a Setup, values: &'a [f64], driven_by: &str) -> Rows<'a> {
    let case = &*setup.case;
    match driven_by {
        "motors" => Rows::Motors { values, case },
        "shortening" => Rows::Shortenings { values, case },
        _ => Rows::Tensions { values, case },
    }
}

/// So many threads, or one for each processor.
fn shared(threads: Option<usize>, progress: Progress<'_>) -> BatchOptions<'_> {
    let threads = threads.and_then(NonZeroUsize::new);
    BatchOptions { threads, progress: Some(progress), ..BatchOptions::default() }
}

impl Setup {
    /// The number of rows.
    fn rows(
        &self,
        py: Python<'_>,
        values: &PyReadonlyArray2<'_, f64>,
        driven_by: &str,
    ) -> PyResult<usize> {
        let (count, kind) = match driven_by {
            "motors" => (self.robot.motors().len(), "motor"),
            _ => (self.robot.cables().len(), "cable"),
        };
        let array = values.as_array();
        let [rows, columns] = [array.nrows(), array.ncols()];
        if columns == count {
            return Ok(rows);
        }
        let message = format!(
            "the rows must have the shape (N, {count}), one column for each {kind}, but have ({rows}, {columns})"
        );
        Err(errors::input(py, driven_by, message))
    }
}
