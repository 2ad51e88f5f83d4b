//! The motors of a robot in words, and what they hold in an answer as a table.

use whipcord::{Case, Drive, Motor, MotorCable, MotorState, Robot, Solution};

use crate::quantity::{degrees, fixed_millimetres, millimetres, newtons, number, percent};
use crate::statistics::extent;
use crate::table::{Align, Table};

/// Command and effort of each motor; `None` for a robot without motors.
#[must_use]
pub fn table(robot: &Robot, case: &Case, solution: &Solution) -> Option<Table> {
    if robot.motors().is_empty() {
        return None;
    }
    let mut table = Table::new([
        ("motor", Align::Left),
        ("command", Align::Right),
        ("torque or force", Align::Right),
        ("of its limit", Align::Right),
    ]);
    table.group();
    let none = || String::from("–");
    let commands = case.motors.last().map_or(&[][..], Vec::as_slice);
    let states = MotorState::all(robot, commands, solution);
    for (motor, state) in robot.motors().iter().zip(states) {
        table.row(vec![
            motor.name.clone(),
            state.command.map_or_else(none, |command| command_words(motor.drive, command)),
            state.effort.map_or_else(none, |effort| effort_words(motor.drive, effort)),
            state.utilization.map_or_else(String::new, percent),
        ]);
    }
    Some(table)
}

/// An angle or a travel of a motor.
#[must_use]
pub fn command_words(drive: Drive, command: f64) -> String {
    match drive {
        Drive::Spool { .. } => degrees(command),
        Drive::Linear => format!("{} mm", fixed_millimetres(command, 3)),
    }
}

/// A torque or a force of a motor.
#[must_use]
pub fn effort_words(drive: Drive, effort: f64) -> String {
    match drive {
        Drive::Spool { .. } => format!("{} mN·m", number(1e3 * effort, 4)),
        Drive::Linear => newtons(effort),
    }
}

/// A motor of a robot in words, with its command.
#[must_use]
pub fn words(robot: &Robot, motor: &Motor, command: Option<f64>) -> String {
    let name = |of: &MotorCable| of.signed(&robot.cables()[of.cable].name);
    let cables: Vec<String> = motor.cables.iter().map(name).collect();
    let mut parts = Vec::new();
    let amount: fn(f64) -> String = match motor.drive {
        Drive::Spool { .. } => degrees,
        Drive::Linear => millimetres,
    };
    let named = |command| format!("{} {}", motor.drive.keys().command, amount(command));
    parts.extend(command.map(named));
    match motor.drive {
        Drive::Spool { gear_ratio } => {
            let radii: Vec<f64> = motor.cables.iter().map(|of| of.radius).collect();
            if let Some((least, greatest)) = extent(&radii) {
                let radius = if least == greatest {
                    millimetres(least)
                } else {
                    format!("{} to {}", millimetres(least), millimetres(greatest))
                };
                parts.push(format!("spool of radius {radius}"));
            }
            if gear_ratio != 1.0 {
                parts.push(format!("gear {} : 1", number(gear_ratio, 5)));
            }
        }
        Drive::Linear => parts.push("linear drive".to_owned()),
    }
    parts.push(format!("pulls {}", cables.join(", ")));
    if let Some(stiffness) = motor.stiffness {
        parts.push(format!("stiffness {} N/mm", number(1e-3 * stiffness, 4)));
    }
    if motor.free_length > 0.0 {
        parts.push(format!("{} of cable outside", millimetres(motor.free_length)));
    }
    if motor.pretension > 0.0 {
        parts.push(format!("pretension {}", newtons(motor.pretension)));
    }
    if motor.backlash > 0.0 {
        parts.push(format!("backlash {}", amount(motor.backlash)));
    }
    parts.join(", ")
}
