//! Motions as JSON and tables.

use serde_json::{Value, json};
use whipcord::{Drive, Obstacle, Robot, Twist};
use whipcord_motion::{EnergyBalance, StartRates, State, Trajectory};

use super::NonFinite;
use super::csv::{CONTACT_COLUMNS, Cell, CsvTable, contact_cells};
use super::json::{number, numbers, quaternion, touch, vector};

/// A motion as the JSON object that `whipcord simulate --json` prints; SI. Poses are those of the nodes in the world; strains `(v, u)` are those at the
/// integration points, two for each element from base to tip. The last state has its rates, with which a motion goes on from it.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn motion_json(
    title: &str,
    robot: &Robot,
    obstacles: &[Obstacle],
    trajectory: &Trajectory,
) -> Result<Value, NonFinite> {
    let states = trajectory.states.iter().enumerate();
    let mut states: Vec<Value> = states
        .map(|(k, state)| self::state(k, robot, obstacles, state))
        .collect::<Result<_, _>>()?;
    if let (Some(state), Some(value)) = (trajectory.states.last(), states.last_mut())
        && let Some(of) = state.rates()
    {
        value["rates"] = rates(&of)?;
    }
    Ok(json!({
        "title": title,
        "model": trajectory.model.name(),
        "status": "converged",
        "arc_length": numbers("arc_length", &trajectory.arc_lengths)?,
        "version": env!("CARGO_PKG_VERSION"),
        "steps": trajectory.steps,
        "parts": trajectory.parts,
        "frictionless_parts": trajectory.frictionless_parts,
        "iterations": trajectory.iterations,
        "estimated_error": number(|| "estimated_error".to_owned(), trajectory.greatest_error)?,
        "states": states,
    }))
}

fn state(
    k: usize,
    robot: &Robot,
    obstacles: &[Obstacle],
    state: &State,
) -> Result<Value, NonFinite> {
    let place = |name: &str| format!("states[{k}].{name}");
    let poses: Vec<Value> = state
        .poses
        .iter()
        .enumerate()
        .map(|(i, pose)| {
            let path = |name: &str| place(&format!("poses[{i}].{name}"));
            Ok(json!({
                "position": vector(|| path("position"), pose.position)?,
                "orientation": quaternion(|| path("orientation"), pose)?,
            }))
        })
        .collect::<Result<_, NonFinite>>()?;
    let strains: Vec<Value> = state
        .strains
        .iter()
        .enumerate()
        .map(|(i, strain)| numbers(&place(&format!("strains[{i}]")), &six(strain)))
        .collect::<Result<_, _>>()?;
    let velocities: Vec<Value> = state
        .velocities
        .iter()
        .enumerate()
        .map(|(i, velocity)| numbers(&place(&format!("velocities[{i}]")), &six(velocity)))
        .collect::<Result<_, _>>()?;
    let cables: Vec<Value> = robot
        .cables()
        .iter()
        .zip(&state.cables)
        .enumerate()
        .map(|(i, (cable, of))| {
            let path = |name: &str| place(&format!("cables[{i}].{name}"));
            let mut value = json!({
                "name": cable.name,
                "tension": number(|| path("tension"), of.tension)?,
                "length": number(|| path("length"), of.length)?,
                "slack": number(|| path("slack"), of.slack)?,
            });
            let passages = state.passage_tensions(i);
            if !passages.is_empty() {
                value["passage_tensions"] = numbers(&path("passage_tensions"), passages)?;
                let beyond = state.lengths_beyond(i);
                value["lengths_beyond"] = numbers(&path("lengths_beyond"), beyond)?;
            }
            Ok(value)
        })
        .collect::<Result<_, NonFinite>>()?;
    let motors: Vec<Value> = robot
        .motors()
        .iter()
        .zip(&state.motors)
        .enumerate()
        .map(|(i, (motor, of))| {
            let path = |name: &str| place(&format!("motors[{i}].{name}"));
            Ok(json!({
                "name": motor.name,
                "position": number(|| path("position"), of.position)?,
                "velocity": number(|| path("velocity"), of.velocity)?,
                motor.drive.keys().effort: number(|| path("effort"), of.effort)?,
                "integral": number(|| path("integral"), of.integral)?,
            }))
        })
        .collect::<Result<_, NonFinite>>()?;
    let mut energy = serde_json::Map::new();
    for (name, of) in MOTION_ENERGIES {
        let value = number(|| place(&format!("energy.{name}")), of(&state.energy))?;
        energy.insert(name.to_owned(), value);
    }
    let contacts = state.contacts.iter().enumerate();
    let contacts: Vec<Value> = contacts
        .map(|(i, contact)| touch(&place(&format!("contacts[{i}]")), contact, obstacles))
        .collect::<Result<_, _>>()?;
    Ok(json!({
        "time": number(|| place("time"), state.time)?,
        "method": state.diagnostics.method.name(),
        "poses": poses,
        "velocities": velocities,
        "strains": strains,
        "cables": cables,
        "motor_outputs": numbers(&place("motor_outputs"), &state.motor_outputs)?,
        "contacts": contacts,
        "motors": motors,
        "energy": energy,
    }))
}

fn rates(of: &StartRates) -> Result<Value, NonFinite> {
    let list = |name: &str, values: &[[f64; 6]]| -> Result<Vec<Value>, NonFinite> {
        values.iter().map(|row| numbers(&format!("rates.{name}"), row)).collect()
    };
    let twists = |of: &[Twist]| of.iter().map(six).collect::<Vec<_>>();
    let motors = of.motors.iter().map(|row| numbers("rates.motors", row));
    Ok(json!({
        "velocities": list("velocities", &twists(&of.velocities))?,
        "strains": list("strains", &twists(&of.strains))?,
        "motors": motors.collect::<Result<Vec<_>, _>>()?,
        "step": number(|| "rates.step".to_owned(), of.step)?,
        "commands": numbers("rates.commands", &of.commands)?,
        "loads": numbers("rates.loads", &of.loads)?,
    }))
}

fn six(twist: &Twist) -> [f64; 6] {
    let ([a, b, c], [d, e, f]) = (twist.linear.to_array(), twist.angular.to_array());
    [a, b, c, d, e, f]
}

/// An energy of the balance, in J.
pub type EnergyOf = fn(&EnergyBalance) -> f64;

/// The energies of a motion, by their names.
pub const MOTION_ENERGIES: [(&str, EnergyOf); 12] = [
    ("kinetic", |energy| energy.kinetic),
    ("elastic", |energy| energy.elastic),
    ("gravity", |energy| energy.gravity),
    ("motors", |energy| energy.motors),
    ("stretch", |energy| energy.stretch),
    ("cables", |energy| energy.cables),
    ("control", |energy| energy.control),
    ("loads", |energy| energy.loads),
    ("base", |energy| energy.base),
    ("contacts", |energy| energy.contacts),
    ("dissipated", |energy| energy.dissipated),
    ("defect", EnergyBalance::defect),
];

/// A row for each state: time, tip, its speed, the cables, the sum of the normal forces of all contacts, and the energy balance.
#[must_use]
pub fn motion_table(robot: &Robot, trajectory: &Trajectory) -> CsvTable {
    let mut columns: Vec<String> = ["t [s]", "tip_x [m]", "tip_y [m]", "tip_z [m]"]
        .into_iter()
        .chain(["tip_qw", "tip_qx", "tip_qy", "tip_qz", "tip_speed [m/s]"])
        .map(str::to_owned)
        .collect();
    for cable in robot.cables() {
        for what in ["tension [N]", "length [m]", "slack [m]"] {
            columns.push(format!("{}.{what}", cable.name));
        }
    }
    for motor in robot.motors() {
        let (position, velocity, effort) = match motor.drive {
            Drive::Spool { .. } => ("angle [rad]", "rate [rad/s]", "torque [N*m]"),
            Drive::Linear => ("travel [m]", "rate [m/s]", "force [N]"),
        };
        columns.extend([position, velocity, effort].map(|what| format!("{}.{what}", motor.name)));
    }
    columns.push("contact_force [N]".to_owned());
    columns.extend(MOTION_ENERGIES.iter().map(|(name, _)| format!("{name} [J]")));
    let mut table = CsvTable::new(columns);
    for state in &trajectory.states {
        let (tip, last) = (state.tip(), state.velocities.last());
        let speed = last.map_or(0.0, |velocity| velocity.linear.norm());
        let mut row = vec![Cell::from(state.time)];
        row.extend(tip.position.to_array().map(Cell::from));
        row.extend(tip.rotation.wxyz().map(Cell::from));
        row.push(Cell::from(speed));
        for cable in &state.cables {
            row.extend([cable.tension, cable.length, cable.slack].map(Cell::from));
        }
        let pushed: f64 = state.contacts.iter().filter_map(|contact| contact.force).sum();
        for motor in &state.motors {
            row.extend([motor.position, motor.velocity, motor.effort].map(Cell::from));
        }
        row.push(Cell::from(pushed));
        row.extend(MOTION_ENERGIES.map(|(_, of)| Cell::from(of(&state.energy))));
        table.push(row);
    }
    table
}

/// Where the robot touches obstacles: a row for each contact of each state; disks and obstacles count from 1.
#[must_use]
pub fn motion_contacts_table(obstacles: &[Obstacle], trajectory: &Trajectory) -> CsvTable {
    let columns = core::iter::once("t [s]").chain(CONTACT_COLUMNS);
    let mut table = CsvTable::new(columns);
    for state in &trajectory.states {
        for contact in &state.contacts {
            let mut row = vec![Cell::from(state.time)];
            row.extend(contact_cells(contact, obstacles));
            table.push(row);
        }
    }
    table
}

/// A row for each node of each state: time, arc length and pose in the world.
#[must_use]
pub fn poses_table(trajectory: &Trajectory) -> CsvTable {
    let mut table =
        CsvTable::new(["t [s]", "s [m]", "x [m]", "y [m]", "z [m]", "qw", "qx", "qy", "qz"]);
    for state in &trajectory.states {
        for (s, pose) in trajectory.arc_lengths.iter().zip(&state.poses) {
            let mut row = vec![Cell::from(state.time), Cell::from(*s)];
            row.extend(pose.position.to_array().map(Cell::from));
            row.extend(pose.rotation.wxyz().map(Cell::from));
            table.push(row);
        }
    }
    table
}
