//! Many motions of a robot at once, and their gradients.

use core::num::NonZero;
use std::sync::Arc;

use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyReadonlyArray4};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::{Twist, Vec3, jobs};
use whipcord_motion::{
    CableDrive, Commands, Course, Factors, Gradient, MotionError, Seed, Simulation,
};

use crate::convert::{array, flat, twist};
use crate::errors;
use crate::setup::Setup;
use crate::wait::{Limit, within};

/// A robot that moves under many rows of commands, each constant in a step.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Motions {
    start: Arc<Simulation>,
    /// What keeps its own command.
    own: Commands,
    dt: f64,
}

/// What the rows of commands are.
#[derive(Clone, Copy)]
enum Actuation {
    Tension,
    Shortening,
    Motors,
}

impl Actuation {
    fn named(py: Python<'_>, name: &str) -> PyResult<Self> {
        match name {
            "tension" => Ok(Self::Tension),
            "shortening" => Ok(Self::Shortening),
            "motors" => Ok(Self::Motors),
            _ => {
                let message =
                    format!("actuation must be tension, shortening or motors, but is {name}");
                Err(errors::input(py, "actuation", message))
            }
        }
    }

    /// The commands of a step: those of a row, and the own ones where the row has NaN.
    fn put(self, own: &Commands, row: &[f64]) -> Commands {
        let mut commands = own.clone();
        for (i, &value) in row.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            match self {
                Self::Tension => {
                    if let Some(of) = commands.cables.get_mut(i) {
                        *of = CableDrive::Tension(Course::constant(value));
                    }
                }
                Self::Shortening => {
                    if let Some(of) = commands.cables.get_mut(i) {
                        *of = CableDrive::Shortening(Course::constant(value));
                    }
                }
                Self::Motors => {
                    commands.motors.resize(row.len(), None);
                    commands.motors[i] = Some(Course::constant(value));
                }
            }
        }
        commands
    }

    /// The derivatives by these commands.
    fn of(self, gradient: &Gradient) -> &[Vec<f64>] {
        match self {
            Self::Tension | Self::Shortening => &gradient.cables,
            Self::Motors => &gradient.motors,
        }
    }

    fn of_mut(self, direction: &mut Gradient) -> &mut Vec<Vec<f64>> {
        match self {
            Self::Tension | Self::Shortening => &mut direction.cables,
            Self::Motors => &mut direction.motors,
        }
    }
}

/// Commands of all rows in all steps, checked.
struct Asked {
    actuation: Actuation,
    rows: usize,
    steps: usize,
    width: usize,
    values: Vec<f64>,
    threads: Option<NonZero<usize>>,
}

impl Asked {
    fn commands(&self, own: &Commands, row: usize) -> Vec<Commands> {
        let size = self.steps * self.width;
        let values = &self.values[row * size..(row + 1) * size];
        let step =
            |k: usize| self.actuation.put(own, &values[k * self.width..(k + 1) * self.width]);
        (0..self.steps).map(step).collect()
    }
}

/// Arrays by their names, and the numbers of rows that failed with why.
type Found<'py> = (Bound<'py, PyDict>, Vec<(usize, PyErr)>);
type Given<'py> = PyReadonlyArray3<'py, f64>;

impl Motions {
    fn asked(
        &self,
        py: Python<'_>,
        actuation: &str,
        commands: &Given<'_>,
        threads: Option<usize>,
    ) -> PyResult<Asked> {
        let actuation = Actuation::named(py, actuation)?;
        let commands = commands.as_array();
        let (rows, steps, width) = commands.dim();
        let start = self.start.state();
        let (expected, kind) = match actuation {
            Actuation::Motors => (start.motor_outputs.len(), "motors"),
            _ => (start.cables.len(), "cables"),
        };
        if width != expected {
            let message =
                format!("commands have {width} columns, but the robot has {expected} {kind}");
            return Err(errors::input(py, "commands", message));
        }
        let values: Vec<f64> = commands.iter().copied().collect();
        let is_tension = matches!(actuation, Actuation::Tension);
        for value in &values {
            let problem = if value.is_infinite() {
                "must be finite"
            } else if is_tension && *value < 0.0 {
                "must not be negative"
            } else {
                continue;
            };
            return Err(errors::input(py, "commands", format!("commands {problem}")));
        }
        Ok(Asked { actuation, rows, steps, width, values, threads: threads.and_then(NonZero::new) })
    }

    /// Does something with the motion of each row, on threads.
    fn each<T: Send + 'static>(
        &self,
        py: Python<'_>,
        asked: Asked,
        work: impl Fn(&mut Simulation, &[Commands], usize) -> T + Send + Sync + 'static,
    ) -> PyResult<Vec<T>> {
        let (start, own) = (Arc::clone(&self.start), self.own.clone());
        let limit = Limit::default();
        let cancel = limit.cancel.clone();
        let found = within(py, &limit, move || {
            let mut results: Vec<Option<T>> = (0..asked.rows).map(|_| None).collect();
            let rows = results.iter_mut().enumerate();
            let shared = jobs::share(
                rows,
                asked.threads,
                || Simulation::clone(&start),
                |(row, out), simulation| {
                    // What another row has left is put back; the state is of this very robot.
                    let started = simulation.set_state(start.state());
                    debug_assert!(started.is_ok());
                    *out = Some(work(simulation, &asked.commands(&own, row), row));
                    !cancel.is_cancelled()
                },
            );
            shared.map(|()| results.into_iter().flatten().collect::<Vec<T>>())
        })?;
        found.map_err(|error| errors::input(py, "threads", error.to_string()))
    }
}

#[pymethods]
impl Motions {
    #[new]
    fn new(py: Python<'_>, setup: &Setup, dt: f64) -> PyResult<Self> {
        let (robot, case) = (setup.robot.clone(), Arc::clone(&setup.case));
        let motion = setup.file_data.motion.clone();
        let made = within(py, &Limit::default(), move || {
            let own = motion.commands(&robot, &case);
            let start = Simulation::with_commands(&robot, &case, &own, motion.options())?;
            Ok::<_, MotionError>((start, own))
        })?;
        let (start, own) = made.map_err(|error| errors::motion(py, &error))?;
        Ok(Self { start: Arc::new(start), own, dt })
    }

    /// Arc lengths of the nodes in m.
    fn arc_length<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<f64> = self.start.arc_lengths().collect();
        let count = values.len();
        Ok(array(py, values, [count])?.into_any())
    }

    /// Numbers of points with strains and of cables.
    fn sizes(&self) -> (usize, usize) {
        let state = self.start.state();
        (state.strains.len(), state.cables.len())
    }

    /// The motions under (rows, steps, cables or motors) commands: arrays by their names, and the numbers of rows that failed with why.
    #[pyo3(signature = (actuation, commands, threads = None))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        actuation: &str,
        commands: Given<'py>,
        threads: Option<usize>,
    ) -> PyResult<Found<'py>> {
        let asked = self.asked(py, actuation, &commands, threads)?;
        let (rows, steps) = (asked.rows, asked.steps);
        let start = self.start.state();
        let (nodes, points, cables) = (start.poses.len(), start.strains.len(), start.cables.len());
        let dt = self.dt;
        let rolled = self.each(py, asked, move |simulation, commands, _| {
            let mut states = vec![simulation.state().clone()];
            for commands in commands {
                states.push(simulation.step(commands, dt)?.clone());
            }
            Ok::<_, MotionError>(states)
        })?;
        if rolled.len() < rows {
            return Err(errors::timed_out(py, "the motions were ended".to_owned(), None));
        }
        let states = steps + 1;
        let mut failed = Vec::new();
        let mut of: [Vec<f64>; 6] = Default::default();
        let widths = [3 * nodes, 4 * nodes, 6 * nodes, 6 * points, cables, cables];
        for (row, result) in rolled.into_iter().enumerate() {
            match result {
                Ok(all) => {
                    for state in &all {
                        of[0].extend(flat(state.poses.iter().map(|pose| pose.position)));
                        of[1].extend(state.poses.iter().flat_map(|pose| pose.rotation.wxyz()));
                        of[2].extend(state.velocities.iter().flat_map(|of| twist(*of)));
                        of[3].extend(state.strains.iter().flat_map(|of| twist(*of)));
                        of[4].extend(state.cables.iter().map(|cable| cable.tension));
                        of[5].extend(state.cables.iter().map(|cable| cable.length));
                    }
                }
                Err(error) => {
                    failed.push((row, errors::motion(py, &error)));
                    for (of, width) in of.iter_mut().zip(widths) {
                        of.resize(of.len() + width * states, f64::NAN);
                    }
                }
            }
        }
        let [position, orientation, velocity, strain, tension, length] = of;
        let values = PyDict::new(py);
        values.set_item("position", array(py, position, [rows, states, nodes, 3])?)?;
        values.set_item("orientation", array(py, orientation, [rows, states, nodes, 4])?)?;
        values.set_item("velocity", array(py, velocity, [rows, states, nodes, 6])?)?;
        values.set_item("strain", array(py, strain, [rows, states, points, 6])?)?;
        values.set_item("tension", array(py, tension, [rows, states, cables])?)?;
        values.set_item("length", array(py, length, [rows, states, cables])?)?;
        Ok((values, failed))
    }

    /// Derivatives of a number by the commands, and by factors on stiffness, damping and mass, from those by positions (rows, steps + 1, nodes, 3),
    /// velocities (…, 6) and strains (rows, steps + 1, points, 6), and whether those of each step are of one side. Rows that fail have zeros.
    #[pyo3(signature = (actuation, commands, position, velocity, strain, threads = None))]
    #[expect(clippy::too_many_arguments, reason = "those of the method in Python")]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        actuation: &str,
        commands: Given<'py>,
        position: PyReadonlyArray4<'py, f64>,
        velocity: PyReadonlyArray4<'py, f64>,
        strain: PyReadonlyArray4<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<Found<'py>> {
        let asked = self.asked(py, actuation, &commands, threads)?;
        let (rows, steps, width, actuation) =
            (asked.rows, asked.steps, asked.width, asked.actuation);
        let owned = |given: &PyReadonlyArray4<'py, f64>| given.as_array().to_owned();
        let (position, velocity, strain) = (owned(&position), owned(&velocity), owned(&strain));
        let start = self.start.state();
        let (nodes, points) = (start.poses.len(), start.strains.len());
        for (name, shape, expected) in [
            ("position", position.shape(), [rows, steps + 1, nodes, 3]),
            ("velocity", velocity.shape(), [rows, steps + 1, nodes, 6]),
            ("strain", strain.shape(), [rows, steps + 1, points, 6]),
        ] {
            if shape != expected {
                let message = format!("{name} must have the shape {expected:?}, but has {shape:?}");
                return Err(errors::input(py, name, message));
            }
        }
        let dt = self.dt;
        let found = self.each(py, asked, move |simulation, commands, row| {
            let record = simulation.record(commands, dt)?;
            let twist = |of: &numpy::ndarray::Array4<f64>, k: usize, a: usize| {
                let at = |i: usize| of[[row, k, a, i]];
                Twist {
                    linear: Vec3::new(at(0), at(1), at(2)),
                    angular: Vec3::new(at(3), at(4), at(5)),
                }
            };
            let seed = |k: usize| Seed {
                positions: (0..nodes)
                    .map(|a| {
                        let at = |i: usize| position[[row, k, a, i]];
                        Vec3::new(at(0), at(1), at(2))
                    })
                    .collect(),
                turns: Vec::new(),
                velocities: (0..nodes).map(|a| twist(&velocity, k, a)).collect(),
                strains: (0..points).map(|q| twist(&strain, k, q)).collect(),
            };
            let seeds: Vec<Seed> = (0..=steps).map(seed).collect();
            Ok::<_, MotionError>((
                simulation.gradient(&record, &seeds)?,
                record.one_sided().to_vec(),
            ))
        })?;
        if found.len() < rows {
            return Err(errors::timed_out(py, "the gradients were ended".to_owned(), None));
        }
        let mut failed = Vec::new();
        let (mut by_commands, mut factors) = (Vec::new(), [(); 3].map(|()| Vec::new()));
        let mut one_sided = vec![false; rows * steps];
        for (row, result) in found.into_iter().enumerate() {
            let (gradient, sides) = result.unwrap_or_else(|error| {
                failed.push((row, errors::motion(py, &error)));
                Default::default()
            });
            sides.into_iter().for_each(|k| one_sided[row * steps + k] = true);
            by_commands.extend(actuation.of(&gradient).iter().flatten());
            by_commands.resize((row + 1) * steps * width, 0.0);
            let of = gradient.factors;
            for (out, value) in factors.iter_mut().zip([of.stiffness, of.damping, of.mass]) {
                out.push(value);
            }
        }
        let values = PyDict::new(py);
        values.set_item("command", array(py, by_commands, [rows, steps, width])?)?;
        values.set_item("one_sided", array(py, one_sided, [rows, steps])?)?;
        for (name, of) in ["stiffness", "damping", "mass"].into_iter().zip(factors) {
            values.set_item(name, array(py, of, [rows])?)?;
        }
        Ok((values, failed))
    }
    /// What positions, turns, velocities and strains change by, for changes (rows, steps, cables or motors) of the commands and (rows, 3) of factors on stiffness, damping and
    /// mass. Rows that fail have zeros.
    #[pyo3(signature = (actuation, commands, changes, factors, threads = None))]
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        actuation: &str,
        commands: Given<'py>,
        changes: Given<'py>,
        factors: PyReadonlyArray2<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<Found<'py>> {
        let asked = self.asked(py, actuation, &commands, threads)?;
        let (rows, steps, width, actuation) =
            (asked.rows, asked.steps, asked.width, asked.actuation);
        let (changes, factors) = (changes.as_array().to_owned(), factors.as_array().to_owned());
        for (name, shape, expected) in [
            ("command", changes.shape(), &[rows, steps, width][..]),
            ("factors", factors.shape(), &[rows, 3]),
        ] {
            if shape != expected {
                let message = format!("{name} must have the shape {expected:?}, but has {shape:?}");
                return Err(errors::input(py, name, message));
            }
        }
        let start = self.start.state();
        let (nodes, points) = (start.poses.len(), start.strains.len());
        let dt = self.dt;
        let found = self.each(py, asked, move |simulation, commands, row| {
            let record = simulation.record(commands, dt)?;
            let step = |k: usize| (0..width).map(|i| changes[[row, k, i]]).collect();
            let told: Vec<Vec<f64>> = (0..steps).map(step).collect();
            let [stiffness, damping, mass] = [0, 1, 2].map(|k| factors[[row, k]]);
            let mut direction =
                Gradient { factors: Factors { stiffness, damping, mass }, ..Gradient::default() };
            *actuation.of_mut(&mut direction) = told;
            Ok::<_, MotionError>((
                simulation.tangent(&record, &direction)?,
                record.one_sided().to_vec(),
            ))
        })?;
        if found.len() < rows {
            return Err(errors::timed_out(py, "the changes were ended".to_owned(), None));
        }
        let states = steps + 1;
        let widths = [3 * nodes, 3 * nodes, 6 * nodes, 6 * points];
        let (mut failed, mut of): (_, [Vec<f64>; 4]) = (Vec::new(), Default::default());
        let mut one_sided = vec![false; rows * steps];
        for (row, result) in found.into_iter().enumerate() {
            let (all, sides) = result.unwrap_or_else(|error| {
                failed.push((row, errors::motion(py, &error)));
                Default::default()
            });
            sides.into_iter().for_each(|k| one_sided[row * steps + k] = true);
            for change in all {
                of[0].extend(flat(change.positions.into_iter()));
                of[1].extend(flat(change.turns.into_iter()));
                of[2].extend(change.velocities.iter().flat_map(|of| twist(*of)));
                of[3].extend(change.strains.iter().flat_map(|of| twist(*of)));
            }
            for (of, width) in of.iter_mut().zip(widths) {
                of.resize((row + 1) * states * width, 0.0);
            }
        }
        let [position, turn, velocity, strain] = of;
        let values = PyDict::new(py);
        values.set_item("position", array(py, position, [rows, states, nodes, 3])?)?;
        values.set_item("one_sided", array(py, one_sided, [rows, steps])?)?;
        values.set_item("turn", array(py, turn, [rows, states, nodes, 3])?)?;
        values.set_item("velocity", array(py, velocity, [rows, states, nodes, 6])?)?;
        values.set_item("strain", array(py, strain, [rows, states, points, 6])?)?;
        Ok((values, failed))
    }
}
