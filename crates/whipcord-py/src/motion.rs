//! Robots in motion.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::{CableCommand, Case, Obstacle, Robot, Shortening, Twist};
use whipcord_io::MOTION_ENERGIES;
use whipcord_motion::{
    CableDrive, CableMotion, Commands, Course, Linearized, Mode, MotionError, MotorMotion,
    Simulation as Inner, State as InnerState, Trajectory,
};

use crate::convert::{self, array, flat, twist};
use crate::errors;
use crate::setup::Setup;
use crate::solution::contact_values;
use crate::wait::{Limit, within};

/// A number of something, by its name.
type Named<T> = (&'static str, fn(&T) -> f64);
/// Numbers of the passages of a cable, by their name.
type NamedPassages = (&'static str, fn(&InnerState, usize) -> &[f64]);

/// The motion that `[motion]` of a file describes: arrays by their names, and the error where a step has no result.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    setup: &Setup,
    timeout: Option<f64>,
) -> PyResult<(Bound<'py, PyDict>, Option<PyErr>)> {
    let limit = Limit::starting_now(timeout.and_then(|of| Duration::try_from_secs_f64(of).ok()));
    let (robot, case) = (setup.robot.clone(), Arc::clone(&setup.case));
    let motion = setup.file_data.motion.clone();
    let Some((every, steps, rows)) = motion.rows() else {
        let message = "the motion has no duration: give one, such as duration=\"2 s\"";
        return Err(errors::input(py, "duration", message.to_owned()));
    };
    let cancel = limit.cancel.clone();
    let found = within(py, &limit, move || {
        let commands = motion.commands(&robot, &case);
        let mut simulation = Inner::with_commands(&robot, &case, &commands, motion.options())?;
        let mut trajectory = Trajectory::default();
        let result =
            simulation.run_into(&mut trajectory, &commands, every, (steps, rows), &mut |_| {
                !cancel.is_cancelled()
            });
        Ok::<_, MotionError>((trajectory, result.err()))
    })?;
    let (trajectory, failed) = found.map_err(|error| errors::motion(py, &error))?;
    let values = states(py, &trajectory.states, &setup.case.obstacles)?;
    let count = trajectory.arc_lengths.len();
    values.set_item("arc_length", array(py, trajectory.arc_lengths, [count])?)?;
    values.set_item("steps", trajectory.steps)?;
    values.set_item("parts", trajectory.parts)?;
    values.set_item("frictionless_parts", trajectory.frictionless_parts)?;
    values.set_item("iterations", trajectory.iterations)?;
    values.set_item("estimated_error", trajectory.greatest_error)?;
    let failed = match failed {
        Some(error) => Some(errors::motion(py, &error)),
        None if trajectory.states.len() <= rows => {
            let why =
                format!("the motion was computed for {rows} states of output, not all of them");
            Some(errors::timed_out(py, why, None))
        }
        None => None,
    };
    Ok((values, failed))
}

/// States as arrays, a row for each.
fn states<'py>(
    py: Python<'py>,
    states: &[InnerState],
    obstacles: &[Obstacle],
) -> PyResult<Bound<'py, PyDict>> {
    let rows = states.len();
    let of = states.first();
    let [nodes, points, cables, motors] = [
        of.map_or(0, |state| state.poses.len()),
        of.map_or(0, |state| state.strains.len()),
        of.map_or(0, |state| state.cables.len()),
        of.map_or(0, |state| state.motor_outputs.len()),
    ];
    let values = PyDict::new(py);
    values.set_item("time", array(py, states.iter().map(|state| state.time).collect(), [rows])?)?;
    let poses = || states.iter().flat_map(|state| &state.poses);
    let positions = flat(poses().map(|pose| pose.position));
    values.set_item("position", array(py, positions, [rows, nodes, 3])?)?;
    let orientations = poses().flat_map(|pose| pose.rotation.wxyz()).collect();
    values.set_item("orientation", array::<f64, _>(py, orientations, [rows, nodes, 4])?)?;
    let velocities = states.iter().flat_map(|state| &state.velocities);
    let velocities = velocities.flat_map(|of| twist(*of)).collect();
    values.set_item("velocity", array::<f64, _>(py, velocities, [rows, nodes, 6])?)?;
    let strains = states.iter().flat_map(|state| &state.strains);
    let strains = strains.flat_map(|of| twist(*of)).collect();
    values.set_item("strain", array::<f64, _>(py, strains, [rows, points, 6])?)?;
    let of_cables: [Named<CableMotion>; 3] = [
        ("tension", |cable| cable.tension),
        ("length", |cable| cable.length),
        ("slack", |cable| cable.slack),
    ];
    for (name, value) in of_cables {
        let all = states.iter().flat_map(|state| state.cables.iter().map(value)).collect();
        values.set_item(name, array::<f64, _>(py, all, [rows, cables])?)?;
    }
    let of_passages: [NamedPassages; 2] = [
        ("passage_tensions", InnerState::passage_tensions),
        ("lengths_beyond", InnerState::lengths_beyond),
    ];
    for (name, value) in of_passages {
        let passages: Vec<_> = (0..cables)
            .map(|cable| {
                let of_cable = |state: &InnerState| value(state, cable).to_vec();
                let count = of.map_or(0, |state| value(state, cable).len());
                array::<f64, _>(py, states.iter().flat_map(of_cable).collect(), [rows, count])
            })
            .collect::<PyResult<_>>()?;
        values.set_item(name, passages)?;
    }
    let outputs = states.iter().flat_map(|state| state.motor_outputs.iter().copied()).collect();
    values.set_item("motor_output", array::<f64, _>(py, outputs, [rows, motors])?)?;
    let of_motors: [Named<MotorMotion>; 4] = [
        ("motor_position", |motor| motor.position),
        ("motor_velocity", |motor| motor.velocity),
        ("motor_effort", |motor| motor.effort),
        ("motor_integral", |motor| motor.integral),
    ];
    for (name, value) in of_motors {
        let all = states.iter().flat_map(|state| state.motors.iter().map(value)).collect();
        values.set_item(name, array::<f64, _>(py, all, [rows, motors])?)?;
    }
    let energy = PyDict::new(py);
    for (name, value) in MOTION_ENERGIES {
        let all = states.iter().map(|state| value(&state.energy)).collect();
        energy.set_item(name, array::<f64, _>(py, all, [rows])?)?;
    }
    values.set_item("energy", energy)?;
    let contacts: Vec<_> = states
        .iter()
        .map(|state| contact_values(py, &state.contacts, obstacles))
        .collect::<PyResult<_>>()?;
    values.set_item("contacts", contacts)?;
    Ok(values)
}

/// The vibrations about the equilibrium under the commands and loads of a case, or those of its motion at a time in s.
#[pyfunction]
pub fn modes<'py>(
    py: Python<'py>,
    setup: &Setup,
    count: usize,
    time: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let robot = setup.robot.clone();
    let (case, commands, options) = setup.file_data.motion.held_at(&robot, &setup.case, time);
    let found = within(py, &Limit::default(), move || {
        let mut simulation = Inner::with_commands(&robot, &case, &commands, options)?;
        let modes = simulation.modes(&commands, count)?;
        Ok::<_, MotionError>((simulation, modes))
    })?;
    let (simulation, modes) = found.map_err(|error| errors::motion(py, &error))?;
    modes_values(py, &simulation, &modes)
}

fn modes_values<'py>(
    py: Python<'py>,
    simulation: &Inner,
    modes: &[Mode],
) -> PyResult<Bound<'py, PyDict>> {
    let (state, rows) = (simulation.state(), modes.len());
    let nodes = state.poses.len();
    let values = PyDict::new(py);
    let numbers: [Named<Mode>; 4] = [
        ("frequency", |mode| mode.frequency().unwrap_or(f64::NAN)),
        ("damped_frequency", |mode| mode.damped_frequency().unwrap_or(f64::NAN)),
        ("damping_ratio", |mode| mode.damping_ratio),
        ("squared_angular_frequency", |mode| mode.squared_frequency),
    ];
    for (name, value) in numbers {
        let all = modes.iter().map(value).collect();
        values.set_item(name, array::<f64, _>(py, all, [rows])?)?;
    }
    let shares = modes.iter().flat_map(|mode| simulation.energy_shares(mode)).collect();
    values.set_item("energy", array::<f64, _>(py, shares, [rows, 4])?)?;
    let world: Vec<Twist> = modes.iter().flat_map(|mode| mode.in_world(state)).collect();
    let displacement = flat(world.iter().map(|of| of.linear));
    values.set_item("displacement", array(py, displacement, [rows, nodes, 3])?)?;
    let rotation = flat(world.iter().map(|of| of.angular));
    values.set_item("rotation", array(py, rotation, [rows, nodes, 3])?)?;
    values.set_item("arc_length", array(py, simulation.arc_lengths().collect(), [nodes])?)?;
    let positions = flat(state.poses.iter().map(|pose| pose.position));
    values.set_item("position", array(py, positions, [nodes, 3])?)?;
    let orientations = state.poses.iter().flat_map(|pose| pose.rotation.wxyz()).collect();
    values.set_item("orientation", array::<f64, _>(py, orientations, [nodes, 4])?)?;
    Ok(values)
}

/// A robot in motion, taken forward step by step.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Simulation {
    running: Mutex<Running>,
    robot: Robot,
    case: Arc<Case>,
}

struct Running {
    simulation: Inner,
    /// The commands in force.
    commands: Commands,
}

/// A state that a simulation can go on from.
#[pyclass(frozen, module = "whipcord._core")]
pub struct SimulationState {
    inner: InnerState,
    commands: Commands,
}

impl Simulation {
    fn lock(&self) -> MutexGuard<'_, Running> {
        // Behind a panic the state is that of a step before.
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts commands, `None` where a cable or motor keeps its own, into others.
    fn told(
        &self,
        commands: &mut Commands,
        cables: Option<Vec<CableCommand>>,
        motors: Option<Vec<Option<f64>>>,
    ) {
        for (i, command) in cables.into_iter().flatten().enumerate() {
            match (command.tension, command.shortening) {
                (Some(tension), _) => commands.set_tension(i, tension),
                (None, Some(Shortening::Length(by))) => commands.set_shortening(i, by),
                (None, Some(Shortening::Fraction(part))) => {
                    commands.set_shortening(i, part * self.robot.cable_length(i));
                }
                (None, None) => {}
            }
        }
        if let Some(motors) = motors {
            commands.motors.resize(motors.len(), None);
            for (of, command) in commands.motors.iter_mut().zip(motors) {
                if let Some(value) = command {
                    *of = Some(Course::constant(value));
                }
            }
        }
    }
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, setup: &Setup) -> PyResult<Self> {
        let (robot, case) = (setup.robot.clone(), Arc::clone(&setup.case));
        let motion = setup.file_data.motion.clone();
        let made = within(py, &Limit::default(), move || {
            let commands = motion.commands(&robot, &case);
            let simulation = Inner::with_commands(&robot, &case, &commands, motion.options())?;
            Ok::<_, MotionError>(Running { simulation, commands })
        })?;
        let running = made.map_err(|error| errors::motion(py, &error))?;
        let case = Arc::clone(&setup.case);
        Ok(Self { running: Mutex::new(running), robot: setup.robot.clone(), case })
    }

    /// A step of `dt` seconds under these commands, which stay in force; without commands those in force.
    #[pyo3(signature = (dt, tension = None, shortening = None, motors = None))]
    fn step(
        &self,
        py: Python<'_>,
        dt: f64,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let cables = convert::commands(&self.robot, tension, shortening)?;
        let motors = motors.map(|given| convert::motor_commands(&self.robot, given)).transpose()?;
        for (name, value) in cables
            .iter()
            .flatten()
            .flat_map(|of| [("tension", of.tension), ("shortening", in_any_unit(of.shortening))])
            .chain(motors.iter().flatten().map(|value| ("motors", *value)))
        {
            let problem = match value {
                Some(value) if !value.is_finite() => "must be finite",
                Some(value) if name == "tension" && value < 0.0 => "must not be negative",
                _ => continue,
            };
            return Err(errors::input(py, name, format!("{name} {problem}")));
        }
        let stepped = py.detach(|| {
            let mut running = self.lock();
            let mut commands = running.commands.clone();
            self.told(&mut commands, cables, motors);
            running.simulation.step(&commands, dt).map(drop)?;
            running.commands = commands;
            Ok::<_, MotionError>(())
        });
        stepped.map_err(|error| errors::motion(py, &error))
    }

    /// Has the forces and moments of another case act from now on.
    fn set_loads(&self, py: Python<'_>, setup: &Setup) -> PyResult<()> {
        let set = self.lock().simulation.set_loads(&setup.case.loads);
        set.map_err(|error| errors::motion(py, &error))
    }

    /// The state as arrays with one row.
    fn read<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let running = self.lock();
        states(py, core::slice::from_ref(running.simulation.state()), &self.case.obstacles)
    }

    /// Arc lengths of the nodes in m.
    fn arc_length<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<f64> = self.lock().simulation.arc_lengths().collect();
        let count = values.len();
        Ok(array(py, values, [count])?.into_any())
    }

    /// Time in s.
    #[getter]
    fn time(&self) -> f64 {
        self.lock().simulation.state().time
    }

    /// The state, to go on from later.
    fn state(&self) -> SimulationState {
        let running = self.lock();
        SimulationState {
            inner: running.simulation.state().clone(),
            commands: running.commands.clone(),
        }
    }

    /// Goes on from a state.
    fn restore(&self, py: Python<'_>, state: &SimulationState) -> PyResult<()> {
        let mut running = self.lock();
        let set = running.simulation.set_state(&state.inner);
        set.map_err(|error| errors::motion(py, &error))?;
        running.commands = state.commands.clone();
        Ok(())
    }

    /// The vibrations about the state.
    fn modes<'py>(&self, py: Python<'py>, count: usize) -> PyResult<Bound<'py, PyDict>> {
        let mut guard = self.lock();
        let Running { simulation, commands } = &mut *guard;
        let modes = py.detach(|| simulation.modes(commands, count));
        let modes = modes.map_err(|error| errors::motion(py, &error))?;
        modes_values(py, simulation, &modes)
    }

    /// A, B and the rate of the motion linearised about the state.
    fn linearize<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Linearized { states, inputs, a, b, rate } = py
            .detach(|| self.lock().simulation.linearize())
            .map_err(|error| errors::motion(py, &error))?;
        let values = PyDict::new(py);
        values.set_item("a", array(py, a, [states, states])?)?;
        values.set_item("b", array(py, b, [states, inputs])?)?;
        values.set_item("rate", array(py, rate, [states])?)?;
        Ok(values)
    }

    /// Force in N and moment in N·m that the base exerts, in the world.
    fn base_wrench(&self) -> [f64; 6] {
        let wrench = self.lock().simulation.base_wrench();
        twist(Twist { linear: wrench.force, angular: wrench.moment })
    }

    /// Linear momentum in kg·m/s in the world.
    fn momentum(&self) -> [f64; 3] {
        self.lock().simulation.momentum().to_array()
    }

    /// Angular momentum in kg·m²/s about the origin of the world.
    fn angular_momentum(&self) -> [f64; 3] {
        self.lock().simulation.angular_momentum().to_array()
    }

    /// The method of the last step.
    #[getter]
    fn method(&self) -> &'static str {
        self.lock().simulation.state().diagnostics.method.name()
    }

    /// What each cable is told: `tension` or `shortening`, and its value at the time of the state.
    fn commands(&self) -> Vec<(&'static str, f64)> {
        let running = self.lock();
        let time = running.simulation.state().time;
        let told = |drive: &CableDrive| match drive {
            CableDrive::Tension(course) => ("tension", course.after(time)),
            CableDrive::Shortening(course) => ("shortening", course.after(time)),
        };
        running.commands.cables.iter().map(told).collect()
    }
}

fn in_any_unit(shortening: Option<Shortening>) -> Option<f64> {
    shortening.map(|of| match of {
        Shortening::Length(value) | Shortening::Fraction(value) => value,
    })
}
