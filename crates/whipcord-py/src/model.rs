//! A model with its options.

use core::str::FromStr;
use std::time::Duration;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::Cancel;
use whipcord::cosserat::{self, Accuracy};
use whipcord::{
    Actuation, Budget, ModelKind, StabilityAnalysis, Stations, four_bar, linkage, pseudo_rigid_body,
};

use crate::errors;
use crate::wait::Limit;

/// A model, its options, and where it gives the shape.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Model {
    pub inner: whipcord::Model,
    /// How long a call may take.
    timeout: Option<Duration>,
    /// What it was made of.
    arguments: Py<PyDict>,
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (
        kind, *, stations = None, actuation = None, tolerance = None, steps = None, stability = None,
        residual = None, max_iterations = None, objective = None, chord = None, length_rule = None,
        coefficients = None, timeout = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        kind: &str,
        stations: Option<&Bound<'_, PyAny>>,
        actuation: Option<&str>,
        tolerance: Option<f64>,
        steps: Option<usize>,
        stability: Option<&Bound<'_, PyAny>>,
        residual: Option<f64>,
        max_iterations: Option<usize>,
        objective: Option<&str>,
        chord: Option<&str>,
        length_rule: Option<&str>,
        coefficients: Option<&str>,
        timeout: Option<f64>,
    ) -> PyResult<Self> {
        let arguments = PyDict::new(py);
        arguments.set_item("kind", kind)?;
        arguments.set_item("stations", stations)?;
        arguments.set_item("actuation", actuation)?;
        arguments.set_item("tolerance", tolerance)?;
        arguments.set_item("steps", steps)?;
        arguments.set_item("stability", stability)?;
        arguments.set_item("residual", residual)?;
        arguments.set_item("max_iterations", max_iterations)?;
        arguments.set_item("objective", objective)?;
        arguments.set_item("chord", chord)?;
        arguments.set_item("length_rule", length_rule)?;
        arguments.set_item("coefficients", coefficients)?;
        let stability = stability_analysis(py, stability)?;
        let kind: ModelKind = named(py, "model", kind)?;
        let stations = self::stations(stations)?;
        let actuation = match actuation {
            None => Actuation::Natural,
            Some("tension") => Actuation::Tension,
            Some("shortening") => Actuation::Shortening,
            Some(other) => {
                let message =
                    format!("there is no actuation `{other}`: choose tension or shortening");
                return Err(errors::input(py, "actuation", message));
            }
        };
        let rod = || -> PyResult<cosserat::Options> {
            let mut options = cosserat::Options {
                stations: stations.clone(),
                actuation,
                stability,
                ..Default::default()
            };
            options.accuracy = match (tolerance, steps) {
                (None, None) => options.accuracy,
                (Some(tolerance), None) if whipcord::Model::TOLERANCES.contains(&tolerance) => {
                    Accuracy::Tolerance(tolerance)
                }
                (Some(_), None) => {
                    let range = whipcord::Model::TOLERANCES;
                    let message = format!(
                        "tolerance must be from {:e} to {}, a part of the length",
                        range.start(),
                        range.end()
                    );
                    return Err(errors::input(py, "tolerance", message));
                }
                (None, Some(steps)) if steps > 0 => Accuracy::Steps(steps),
                (Some(_), Some(_)) => {
                    let message = "give either a tolerance or a number of steps".to_owned();
                    return Err(errors::input(py, "steps", message));
                }
                _ => {
                    let message = "steps must be greater than zero".to_owned();
                    return Err(errors::input(py, "steps", message));
                }
            };
            match residual {
                Some(residual) if residual > 0.0 => options.residual = residual,
                None => {}
                Some(residual) => {
                    let message = format!("residual must be greater than zero, but is {residual}");
                    return Err(errors::input(py, "residual", message));
                }
            }
            Ok(options)
        };
        let inner = match kind {
            ModelKind::Cosserat => whipcord::Model::Cosserat(rod()?),
            ModelKind::CosseratDisks => whipcord::Model::CosseratDisks(rod()?),
            ModelKind::FourBar => {
                let mut options = four_bar::Options { stations, actuation, ..Default::default() };
                if let Some(name) = objective {
                    options.objective = named(py, "objective", name)?;
                }
                if let Some(name) = chord {
                    options.chord = named(py, "chord", name)?;
                }
                if let Some(name) = length_rule {
                    options.lengths = named(py, "length_rule", name)?;
                }
                whipcord::Model::FourBar(options)
            }
            ModelKind::ConstantCurvature => whipcord::Model::new(kind, stations, actuation),
            ModelKind::PiecewiseConstantCurvature => {
                let cosserat::Options { residual: given, .. } = rod()?;
                let mut options =
                    linkage::Options { stations, actuation, stability, ..Default::default() };
                if residual.is_some() {
                    options.residual = given;
                }
                whipcord::Model::PiecewiseConstantCurvature(options)
            }
            ModelKind::PseudoRigidBody => {
                let cosserat::Options { residual: given, .. } = rod()?;
                let mut options = pseudo_rigid_body::Options {
                    stations,
                    actuation,
                    stability,
                    ..Default::default()
                };
                if residual.is_some() {
                    options.residual = given;
                }
                if let Some(name) = coefficients {
                    options.coefficients = named(py, "coefficients", name)?;
                }
                whipcord::Model::PseudoRigidBody(options)
            }
        };
        let inner = match max_iterations {
            None => inner,
            Some(iterations) if iterations > 0 => {
                inner.with_budget(Budget::of_iterations(iterations))
            }
            Some(_) => {
                let message = "max_iterations must be greater than zero".to_owned();
                return Err(errors::input(py, "max_iterations", message));
            }
        };
        let timeout = timeout.map(|seconds| self::timeout(py, seconds)).transpose()?;
        Ok(Self { inner, timeout, arguments: arguments.unbind() })
    }

    /// Name of the model.
    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.kind().name()
    }

    /// The arguments that make the same model.
    #[getter]
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.arguments.bind(py).copy()
    }
}

impl Model {
    /// The time of a call begins: the model whose solves end when it is over, or when a signal comes.
    pub fn begin(&self) -> (whipcord::Model, Limit) {
        let limit = Limit::starting_now(self.timeout);
        (self.inner.cancelled_by(&limit.cancel), limit)
    }

    /// The same of a search that takes the best so far when its time is over, and the flag that tells it so.
    pub fn begin_search(&self) -> (whipcord::Model, Limit, Cancel) {
        let (limit, stop) = Limit::of_search(self.timeout);
        (self.inner.cancelled_by(&limit.cancel), limit, stop)
    }

    /// What drives all cables, where that was chosen.
    pub fn actuation(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let chosen = self.arguments.bind(py).get_item("actuation")?;
        chosen.map_or(Ok(None), |chosen| chosen.extract())
    }
}

/// A time limit of a call in seconds.
pub fn timeout(py: Python<'_>, seconds: f64) -> PyResult<Duration> {
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|_| seconds > 0.0);
    time.ok_or_else(|| {
        let message =
            format!("timeout must be a number of seconds greater than zero, but is {seconds}");
        errors::input(py, "timeout", message)
    })
}

pub fn named<T: FromStr<Err: ToString>>(py: Python<'_>, path: &str, name: &str) -> PyResult<T> {
    name.parse().map_err(|error: T::Err| errors::input(py, path, error.to_string()))
}

fn stations(given: Option<&Bound<'_, PyAny>>) -> PyResult<Stations> {
    const MOST: usize = whipcord::robot::limits::MOST_STATIONS;
    let Some(given) = given else { return Ok(Stations::Disks) };
    if let Ok(count) = given.extract::<usize>() {
        if (2..=MOST).contains(&count) {
            return Ok(Stations::Equal(count));
        }
        let message = format!("stations must be a number from 2 to {MOST}, but is {count}");
        return Err(errors::input(given.py(), "stations", message));
    }
    match given.extract::<Vec<f64>>() {
        Ok(places) if !places.is_empty() => Ok(Stations::At(places)),
        _ => {
            let message =
                "stations must be a number of equally spaced places, or a list of arc lengths in m";
            Err(errors::input(given.py(), "stations", message.to_owned()))
        }
    }
}

/// What is computed of the stability: `True` and `None` for the verdict, `False` for nothing, `"eigenvalue"` for the least
/// eigenvalue too.
fn stability_analysis(
    py: Python<'_>,
    given: Option<&Bound<'_, PyAny>>,
) -> PyResult<StabilityAnalysis> {
    let Some(given) = given.filter(|given| !given.is_none()) else {
        return Ok(StabilityAnalysis::default());
    };
    match given.extract::<bool>() {
        Ok(true) => Ok(StabilityAnalysis::Verdict),
        Ok(false) => Ok(StabilityAnalysis::Off),
        Err(_) if given.extract::<&str>().is_ok_and(|name| name == "eigenvalue") => {
            Ok(StabilityAnalysis::Eigenvalue)
        }
        Err(_) => {
            let message =
                format!("stability must be True, False or \"eigenvalue\", but is {given}");
            Err(errors::input(py, "stability", message))
        }
    }
}
