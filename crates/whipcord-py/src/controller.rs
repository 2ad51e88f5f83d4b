//! A controller with its estimator.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::{Case, Pose, Robot, Twist, UnitQuaternion, Vec3};
use whipcord_inverse::{
    Actuator, ControlOptions, Controller as Inner, Estimate, EstimatorOptions, Target,
};

use crate::convert::{array, jacobian, twist};
use crate::errors;
use crate::inverse::{Asked, Failure, Task, names, raised};
use crate::model::Model;
use crate::setup::Setup;
use crate::solution::Solution;

/// How a controller works, as Python gives it.
#[derive(FromPyObject)]
pub struct Options {
    #[pyo3(item)]
    period: f64,
    #[pyo3(item)]
    gain: Option<f64>,
    #[pyo3(item)]
    damping: Option<f64>,
    #[pyo3(item)]
    estimates: bool,
    #[pyo3(item)]
    position: Option<f64>,
    #[pyo3(item)]
    angle: Option<f64>,
    #[pyo3(item)]
    bias: Option<f64>,
    #[pyo3(item)]
    force: Option<f64>,
    #[pyo3(item)]
    memory: Option<f64>,
}

impl Options {
    fn over(&self, usual: ControlOptions) -> ControlOptions {
        let estimator = usual.estimator.filter(|_| self.estimates);
        ControlOptions {
            gain: self.gain.unwrap_or(usual.gain),
            damping: self.damping.unwrap_or(usual.damping),
            estimator: estimator.map(|of| EstimatorOptions {
                position: self.position.unwrap_or(of.position),
                angle: self.angle.unwrap_or(of.angle),
                bias: self.bias.unwrap_or(of.bias),
                force: self.force.unwrap_or(of.force),
                memory: self.memory.unwrap_or(of.memory),
            }),
            ..usual
        }
    }
}

/// A target or a measurement, as Python gives it: one of tip, pose, axis with or without tip, and shape.
#[derive(FromPyObject)]
pub struct Aim {
    #[pyo3(item)]
    tip: Option<[f64; 3]>,
    #[pyo3(item)]
    orientation: Option<[f64; 4]>,
    #[pyo3(item)]
    axis: Option<[f64; 3]>,
    #[pyo3(item)]
    shape: Option<Vec<(usize, [f64; 3])>>,
}

impl Aim {
    fn target(self, py: Python<'_>, name: &str) -> PyResult<Target> {
        let vector = |[x, y, z]: [f64; 3]| Vec3::new(x, y, z);
        let tip = self.tip.map(vector);
        Ok(match (tip, self.orientation, self.axis, self.shape) {
            (_, _, _, Some(points)) => {
                Target::Shape(points.into_iter().map(|(disk, at)| (disk, vector(at))).collect())
            }
            (point, _, Some(direction), None) => {
                Target::Axis { point, direction: vector(direction) }
            }
            (Some(position), Some(wxyz), None, None) => {
                let rotation = UnitQuaternion::from_wxyz(wxyz).ok_or_else(|| {
                    let message = "the orientation of a pose must be a quaternion (w, x, y, z) other than zero";
                    errors::input(py, name, message.to_owned())
                })?;
                Target::Pose(Pose { position, rotation })
            }
            (Some(point), None, None, None) => Target::Tip(point),
            (None, _, None, None) => {
                let message = "there is no target: give tip, pose, axis or shape";
                return Err(errors::input(py, name, message.to_owned()));
            }
        })
    }
}

/// A controller of one robot.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Controller {
    inner: Mutex<Inner>,
    actuators: Vec<Actuator>,
    robot: Robot,
    case: Arc<Case>,
}

#[pymethods]
impl Controller {
    #[new]
    fn new(
        py: Python<'_>,
        setup: &Setup,
        model: &Model,
        asked: Asked,
        options: Options,
    ) -> PyResult<Self> {
        let (method, _) = model.begin();
        let task = Task::new(py, setup, method, &asked)?;
        let make = || -> Result<Inner, Failure> {
            let limits = task.limits()?;
            let length = task.robot.backbone().length;
            let mut usual = ControlOptions::new(options.period, length);
            usual.tolerance = task.options.tolerance.unwrap_or(usual.tolerance);
            let options = options.over(usual);
            let Task { model, robot, case, by, .. } = &task;
            Ok(Inner::new(model, robot, case, &limits, *by, options)?)
        };
        let inner = make().map_err(|failure| raised(py, failure))?;
        let actuators = inner.actuators().to_vec();
        Ok(Self { inner: Mutex::new(inner), actuators, robot: task.robot, case: task.case })
    }

    /// Kind and name of each command.
    #[getter]
    fn actuators(&self) -> Vec<(&'static str, String)> {
        names(&self.robot, &self.actuators)
    }

    /// One cycle: the shape of the estimated robot, and what else is known.
    fn cycle<'py>(
        &self,
        py: Python<'py>,
        target: Aim,
        measured: Option<Aim>,
    ) -> PyResult<(Solution, Bound<'py, PyDict>)> {
        let target = target.target(py, "target")?;
        let measured = measured.map(|aim| aim.target(py, "measured")).transpose()?;
        let found = py.detach(|| {
            // A panic elsewhere leaves the commands in force whole.
            let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            inner.cycle(&target, measured.as_ref())
        });
        let cycle = found.map_err(|error| raised(py, Failure::Inverse(error)))?;
        let (n, cables) = (self.actuators.len(), self.robot.cables().len());
        let values = PyDict::new(py);
        values.set_item("command", array(py, cycle.commands, [n])?)?;
        values.set_item("error", cycle.miss.position)?;
        values.set_item("error_angle", cycle.miss.angle)?;
        values.set_item("jacobian", jacobian(py, &cycle.jacobian)?)?;
        values.set_item("compliance", by_force(py, &cycle.compliance)?)?;
        let by_actuators = |rates: &[Vec<f64>], factor: f64| -> Vec<f64> {
            let of = |cable: usize| rates.iter().map(move |of| factor * of[cable]);
            (0..cables).flat_map(of).collect()
        };
        let tension = by_actuators(&cycle.tension_rates, 1.0);
        values.set_item("tension_by_command", array(py, tension, [cables, n])?)?;
        let length = by_actuators(&cycle.length_rates, 1.0);
        values.set_item("length_by_command", array(py, length, [cables, n])?)?;
        let split = |all: &[Estimate]| -> (Vec<f64>, Vec<f64>) {
            all.iter().map(|of| (of.value, of.deviation)).unzip()
        };
        let (bias, deviation) = split(&cycle.bias);
        values.set_item("bias", array(py, bias, [n])?)?;
        values.set_item("bias_deviation", array(py, deviation, [n])?)?;
        let (force, deviation) = split(&cycle.force);
        values.set_item("force", array(py, force, [3])?)?;
        values.set_item("force_deviation", array(py, deviation, [3])?)?;
        let words = cycle.limits.iter().map(|limit| limit.words(&self.robot, &self.actuators));
        values.set_item("active_limits", words.collect::<Vec<_>>())?;
        Ok((Solution::new(cycle.solution, &self.case), values))
    }
}

/// (6, 3) motion of the tip by a force on it.
fn by_force<'py>(
    py: Python<'py>,
    columns: &[Twist; 3],
) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
    let columns = columns.map(twist);
    let values = (0..6).flat_map(|row| columns.map(|column| column[row])).collect();
    array(py, values, [6, 3])
}
