//! The motors of a robot in an answer, as a table.

use whipcord::{Case, Drive, MotorState, Robot, Solution};

use crate::quantity::{degrees, fixed_millimetres, newtons, number, percent};
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

/// A command of a motor in words.
#[must_use]
pub fn command_words(drive: Drive, command: f64) -> String {
    match drive {
        Drive::Spool { .. } => degrees(command),
        Drive::Linear => format!("{} mm", fixed_millimetres(command, 3)),
    }
}

/// What a motor must hold, in words.
#[must_use]
pub fn effort_words(drive: Drive, effort: f64) -> String {
    match drive {
        Drive::Spool { .. } => format!("{} mN·m", number(1e3 * effort, 4)),
        Drive::Linear => newtons(effort),
    }
}
