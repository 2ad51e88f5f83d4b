//! Commands that bring a robot to a target.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use whipcord::batch::Progress;
use whipcord::{MotorState, Pose, Robot, UnitQuaternion, Vec3};
use whipcord_inverse::{
    Actuator, Followed, InverseSolver, PathPoint, ReachStatus, Reached, Target,
};

use crate::convert::array;
use crate::errors;
use crate::inverse::{Asked, Failure, Task, names, raised};
use crate::model::Model;
use crate::setup::Setup;
use crate::solution::Solution;
use crate::wait::{supervise, within};

/// The answer to one target: the solution, and what else is known of it. Without `shape` the target is that of the file data.
#[pyfunction]
pub fn reach<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    asked: Asked,
    shape: Option<Vec<(usize, [f64; 3])>>,
) -> PyResult<(Solution, Bound<'py, PyDict>)> {
    let target = match shape {
        Some(points) => Some(Target::Shape(
            points.into_iter().map(|(disk, [x, y, z])| (disk, Vec3::new(x, y, z))).collect(),
        )),
        None => setup.file_data.goal.target.clone(),
    };
    let Some(target) = target else {
        let message = "there is no target: give tip, pose, axis or shape, or [target] in the file";
        return Err(errors::input(py, "target", message.to_owned()));
    };
    let (method, limit) = model.begin();
    let task = Task::new(py, setup, method, &asked)?;
    let found = within(py, &limit, move || -> Result<_, Failure> {
        let mut solver = task.solver()?;
        let reached = solver.reach(&target, &task.options)?;
        Ok((reached, solver.actuators().to_vec(), task))
    })?;
    let (reached, actuators, task) = found.map_err(|failure| raised(py, failure))?;
    let values = PyDict::new(py);
    values.set_item("status", reached.status.name())?;
    values.set_item("error", reached.miss.position)?;
    values.set_item("error_angle", reached.miss.angle)?;
    values.set_item("lower_bound", reached.lower_bound)?;
    values.set_item("no_proof", reached.no_proof.map(|reason| reason.words()))?;
    let words = reached.active_limits.iter().map(|limit| limit.words(&task.robot, &actuators));
    values.set_item("active_limits", words.collect::<Vec<_>>())?;
    let free = reached.null_space.concat();
    let shape = [reached.null_space.len(), actuators.len()];
    values.set_item("null_space", array(py, free, shape)?)?;
    values.set_item("starts", reached.starts)?;
    values.set_item("solves", reached.solves)?;
    values.set_item("command", array(py, reached.commands.clone(), [actuators.len()])?)?;
    values.set_item("actuators", names(&task.robot, &actuators))?;
    values.set_item("motors", motors(&task.robot, &reached))?;
    let case = Arc::new(reached.case);
    Ok((Solution::new(reached.solution, &case), values))
}

fn motors(robot: &Robot, reached: &Reached) -> Vec<Option<f64>> {
    let commands = reached.case.motors.last().map_or(&[][..], Vec::as_slice);
    let states = MotorState::all(robot, commands, &reached.solution);
    states.into_iter().map(|state| state.command).collect()
}

/// Rows of points, or of points and quaternions (w, x, y, z), as targets; `None` for a row that is none.
fn targets(py: Python<'_>, rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Option<Target>>> {
    let rows = rows.as_array();
    if rows.ncols() != 3 && rows.ncols() != 7 {
        let message = format!(
            "targets must have the shape (N, 3), points, or (N, 7), points and quaternions, but have ({}, {})",
            rows.nrows(),
            rows.ncols()
        );
        return Err(errors::input(py, "targets", message));
    }
    let of = |row: usize| {
        let at = |k: usize| rows[[row, k]];
        let position = Vec3::new(at(0), at(1), at(2));
        if (0..rows.ncols()).any(|k| !at(k).is_finite()) {
            return None;
        }
        if rows.ncols() == 3 {
            return Some(Target::Tip(position));
        }
        let rotation = UnitQuaternion::from_wxyz([at(3), at(4), at(5), at(6)])?;
        Some(Target::Pose(Pose { position, rotation }))
    };
    Ok((0..rows.nrows()).map(of).collect())
}

/// Answers to many targets, each by itself: arrays by their names.
#[pyfunction]
#[pyo3(signature = (setup, model, asked, rows, threads, nearest, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn reach_batch<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    asked: Asked,
    rows: PyReadonlyArray2<'py, f64>,
    threads: Option<usize>,
    nearest: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let targets = targets(py, &rows)?;
    let (method, limit) = model.begin();
    let mut task = Task::new(py, setup, method, &asked)?;
    task.options.null_space = false;
    let solver = task.solver().map_err(|failure| raised(py, failure))?;
    let actuators = solver.actuators().to_vec();
    let of = setup.station_disks();
    let answers = supervise(py, &limit, progress, |progress| {
        Ok(worked_off(&task, &targets, threads, progress))
    })?;
    table(py, &task.robot, &actuators, of, &answers, nearest)
}

/// One row of a batch: its answer, or why it has none.
enum Row {
    Answer(Box<Reached>),
    Failed(String),
    /// Not begun, because the work was ended.
    Ended,
}

/// Each target by a thread that is free. Each thread has a solver of its own, and an answer depends on its target and on how many there are.
fn worked_off(
    task: &Task,
    targets: &[Option<Target>],
    threads: Option<usize>,
    progress: Progress<'_>,
) -> Vec<Row> {
    let available = thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or(available).clamp(1, targets.len().max(1));
    let rows: Mutex<Vec<Row>> = Mutex::new(targets.iter().map(|_| Row::Ended).collect());
    let (next, done, ended) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    let work = || {
        let mut solver = None;
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(target) = targets.get(number) else { return };
            if ended.load(Ordering::Relaxed) {
                return;
            }
            let shapes = if targets.len() < MANY { 0 } else { targets.len() / FOR_SHAPE };
            let row = row(task, target.as_ref(), shapes.min(SHAPES), &mut solver);
            // A panic elsewhere leaves the list whole.
            rows.lock().unwrap_or_else(PoisonError::into_inner)[number] = row;
            if !progress(done.fetch_add(1, Ordering::Relaxed) + 1, targets.len()) {
                ended.store(true, Ordering::Relaxed);
            }
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(work);
        }
        work();
    });
    rows.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// For so many targets it is worth its while to start from shapes: one for so many of them, and so many at most.
const MANY: usize = 256;
const FOR_SHAPE: usize = 8;
const SHAPES: usize = 128;

fn row(
    task: &Task,
    target: Option<&Target>,
    shapes: usize,
    solver: &mut Option<InverseSolver>,
) -> Row {
    let Some(target) = target else {
        return Row::Failed("the target has no finite numbers, or no orientation".to_owned());
    };
    let solver = match solver {
        Some(solver) => solver,
        none => match task.solver() {
            Ok(mut new) => {
                new.start_from_shapes(shapes);
                none.insert(new)
            }
            Err(Failure::Inverse(error)) => return Row::Failed(error.to_string()),
            Err(Failure::Rate(message) | Failure::Atlas(message)) => return Row::Failed(message),
        },
    };
    match solver.reach(target, &task.options) {
        Ok(reached) => Row::Answer(Box::new(reached)),
        Err(error) => Row::Failed(error.to_string()),
    }
}

/// Rows as arrays; NaN where there is no answer, and of commands and shapes where the target is not reached, unless the nearest is asked for.
fn table<'py>(
    py: Python<'py>,
    robot: &Robot,
    actuators: &[Actuator],
    disks: usize,
    rows: &[Row],
    nearest: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (cables, driven, width) = (robot.cables().len(), robot.motors().len(), actuators.len());
    let count = rows.len();
    let mut status: Vec<&'static str> = Vec::with_capacity(count);
    let (mut why, mut error, mut angle) = (Vec::new(), Vec::new(), Vec::new());
    let (mut bound, mut solves) = (Vec::new(), Vec::new());
    let (mut tension, mut length, mut motor) = (Vec::new(), Vec::new(), Vec::new());
    let (mut command, mut position, mut orientation) = (Vec::new(), Vec::new(), Vec::new());
    let none = f64::NAN;
    for row in rows {
        let (answer, name, reason) = match row {
            Row::Answer(reached) => (Some(reached), reached.status.name(), None),
            Row::Failed(reason) => (None, "failed", Some(reason.as_str())),
            Row::Ended => (None, "failed", Some("the time was over before this row was begun")),
        };
        status.push(name);
        why.push(reason);
        error.push(answer.map_or(none, |of| of.miss.position));
        angle.push(answer.map_or(none, |of| of.miss.angle));
        bound.push(answer.and_then(|of| of.lower_bound).unwrap_or(none));
        solves.push(answer.map_or(0, |of| of.solves as i64));
        let shown = answer.filter(|of| nearest || of.status == ReachStatus::Reached);
        let Some(reached) = shown else {
            tension.resize(tension.len() + cables, none);
            length.resize(length.len() + cables, none);
            motor.resize(motor.len() + driven, none);
            command.resize(command.len() + width, none);
            position.resize(position.len() + 3 * disks, none);
            orientation.resize(orientation.len() + 4 * disks, none);
            continue;
        };
        let solution = &reached.solution;
        tension.extend(solution.cables.iter().map(|of| of.tension.unwrap_or(none)));
        length.extend(solution.cables.iter().map(|of| of.length));
        motor.extend(motors(robot, reached).into_iter().map(|of| of.unwrap_or(none)));
        command.extend_from_slice(&reached.commands);
        position.extend(solution.disks.poses.iter().flat_map(|pose| pose.position.to_array()));
        orientation.extend(solution.disks.poses.iter().flat_map(|pose| pose.rotation.wxyz()));
    }
    let values = PyDict::new(py);
    values.set_item("status", status)?;
    values.set_item("reason", why)?;
    values.set_item("error", array(py, error, [count])?)?;
    values.set_item("error_angle", array(py, angle, [count])?)?;
    values.set_item("lower_bound", array(py, bound, [count])?)?;
    values.set_item("solves", array(py, solves, [count])?)?;
    values.set_item("tension", array(py, tension, [count, cables])?)?;
    values.set_item("length", array(py, length, [count, cables])?)?;
    values.set_item("motors", array(py, motor, [count, driven])?)?;
    values.set_item("command", array(py, command, [count, width])?)?;
    values.set_item("position", array(py, position, [count, disks, 3])?)?;
    values.set_item("orientation", array(py, orientation, [count, disks, 4])?)?;
    values.set_item("actuators", names(robot, actuators))?;
    Ok(values)
}

/// Answers along a path: arrays as of a batch, and the jumps. Without rows the path is that of the file data.
#[pyfunction]
#[pyo3(signature = (setup, model, asked, rows, times, nearest))]
pub fn follow<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    asked: Asked,
    rows: Option<PyReadonlyArray2<'py, f64>>,
    times: Vec<f64>,
    nearest: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let path = match rows {
        None => setup.file_data.goal.path.clone(),
        Some(rows) => {
            let targets = targets(py, &rows)?;
            if targets.len() != times.len() {
                let message =
                    format!("{} times are given for {} points", times.len(), targets.len());
                return Err(errors::input(py, "time", message));
            }
            let points = targets.into_iter().zip(times).enumerate();
            let points = points.map(|(k, (target, time))| {
                let target = target.ok_or_else(|| {
                    let message = format!("path[{k}] has no finite numbers, or no orientation");
                    errors::input(py, "path", message)
                })?;
                Ok(PathPoint { time, target })
            });
            points.collect::<PyResult<Vec<_>>>()?
        }
    };
    if path.is_empty() {
        let message =
            "there is no path: give its points and times, or path under [target] in the file";
        return Err(errors::input(py, "path", message.to_owned()));
    }
    let (method, limit) = model.begin();
    let mut task = Task::new(py, setup, method, &asked)?;
    task.options.null_space = false;
    let times: Vec<f64> = path.iter().map(|point| point.time).collect();
    let found = within(py, &limit, move || -> Result<_, Failure> {
        let mut solver = task.solver()?;
        let followed = solver.follow(&path, &task.options)?;
        Ok((followed, solver.actuators().to_vec(), task))
    })?;
    let (followed, actuators, task) = found.map_err(|failure| raised(py, failure))?;
    let Followed { answers, jumps } = followed;
    let rows: Vec<Row> = answers.into_iter().map(|of| Row::Answer(Box::new(of))).collect();
    let values = table(py, &task.robot, &actuators, setup.station_disks(), &rows, nearest)?;
    let count = times.len();
    values.set_item("time", array(py, times, [count])?)?;
    let list = PyList::empty(py);
    for jump in jumps {
        list.append((jump.point, jump.kind.name(), jump.distance))?;
    }
    values.set_item("jumps", list)?;
    Ok(values)
}
