//! What the rows of a table of commands say.

use std::collections::HashMap;

use whipcord::robot::limits::{ACCELERATION, COORDINATE, FORCE, FRACTION, MOMENT, Range, TENSION};
use whipcord::{CableCommand, Shortening, Vec3};

use super::columns::{Column, Loaded};
use super::{CommandColumn, CommandRow, Commanded, CommandedRobot, Rows};
use crate::error::{FileProblem, Problems};
use crate::read::table::{Cell, Grid, Row, Unit, problem};
use crate::source::quoted;
use crate::units::Dimension;

/// The rows as steps; `None` where one is refused.
pub(super) fn rows(
    grid: &Grid,
    columns: &[Column],
    robot: &CommandedRobot<'_>,
    text: &str,
    problems: &mut Problems,
) -> Option<Rows> {
    let mut rows = Rows::default();
    let mut keys: HashMap<&str, usize> = HashMap::new();
    let mut lines = Lines { text, at: 0, line: 1 };
    let is_loaded = columns.iter().any(|column| matches!(column, Column::Load { .. }));
    for row in &grid.rows {
        let mut step = robot.own_cables.to_vec();
        let mut motors = robot.own_motors.to_vec();
        motors.resize(robot.motors.len(), None);
        let mut loads = robot.loads.clone();
        let line = lines.of(row.span.start);
        let mut about = CommandRow { line, key: None, time: None, group: None, is_measured: true };
        for (column, cell) in columns.iter().zip(&row.cells) {
            match column {
                Column::Command { of, name, unit } => {
                    let Some(value) = number(cell, row, name, unit, problems) else { continue };
                    command(*of, value, unit, (&mut step, &mut motors));
                    out_of_range(*of, value, unit, robot, cell, problems);
                }
                Column::Load { of, name, unit } => {
                    let Some(value) = number(cell, row, name, unit, problems) else { continue };
                    let (range, component) = match *of {
                        Loaded::TipForce(axis) => (FORCE, &mut loads.tip_force[axis]),
                        Loaded::TipMoment(axis) => (MOMENT, &mut loads.tip_moment[axis]),
                        Loaded::Gravity(axis) => {
                            (ACCELERATION, &mut loads.gravity.get_or_insert(Vec3::ZERO)[axis])
                        }
                    };
                    *component = value;
                    if let Some(found) = range.problem(value) {
                        let path = format!("loads.{name}");
                        problems.push(cell.span, || FileProblem::Physical { path, problem: found });
                    }
                }
                Column::Time(unit) => {
                    if cell.value.text().is_some() {
                        about.time = number(cell, row, "time", unit, problems);
                    }
                }
                Column::Group => about.group = cell.value.text().map(str::to_owned),
                Column::Measured => about.is_measured = truth(cell, row, problems),
                Column::Key => {
                    let Some(key) = cell.value.text() else {
                        let help = "give each row a text or number of its own in the column that `key` names";
                        problems.push(row.span, || problem("this row has no key", help));
                        continue;
                    };
                    if let Some(first) = keys.insert(key, rows.steps.len()) {
                        let related = Some((grid.rows[first].span, "it is first given here"));
                        let message = format!("the key `{}` is given twice", quoted(key));
                        let help = "give each row a key of its own";
                        problems.push_related(cell.span, related, || problem(message, help));
                    }
                    about.key = Some(key.to_owned());
                }
                Column::Ignored => {}
            }
        }
        rows.steps.push(step);
        rows.motors.push(motors);
        if is_loaded {
            rows.loads.push(loads);
        }
        rows.spans.push(row.span);
        rows.table.rows.push(about);
        if problems.is_full() {
            return None;
        }
    }
    let name = |cell: &Cell| cell.value.text().unwrap_or_default().to_owned();
    rows.table.columns = grid.columns.iter().map(name).collect();
    rows.table.commands = columns
        .iter()
        .filter_map(|column| match column {
            Column::Command { of, name, .. } => Some(CommandColumn { name: name.clone(), of: *of }),
            _ => None,
        })
        .collect();
    if rows.table.rows.iter().all(|row| !row.is_measured) {
        let help =
            "write true for the rows that have a measurement, or leave out the column `measured`";
        problems.push(grid.header, || problem("no row is measured", help));
    }
    problems.is_empty().then_some(rows)
}

fn command(
    of: Commanded,
    value: f64,
    unit: &Unit,
    (step, motors): (&mut [CableCommand], &mut [Option<f64>]),
) {
    match of {
        Commanded::Tension(i) => step[i].tension = Some(value),
        Commanded::Shortening(i) => {
            step[i].shortening = Some(match unit.dimension {
                Dimension::Ratio => Shortening::Fraction(value),
                _ => Shortening::Length(value),
            });
        }
        Commanded::Motor(i) => motors[i] = Some(value),
    }
}

/// A number in SI; `None` where it is missing or none.
fn number(cell: &Cell, row: &Row, name: &str, unit: &Unit, problems: &mut Problems) -> Option<f64> {
    let Some(text) = cell.value.text() else {
        let message = format!("this row has no number for `{}`", quoted(name));
        problems.push(row.span, || {
            problem(
                message,
                "give each row a number for each cable or motor; leave out the rows without",
            )
        });
        return None;
    };
    let value = unit.in_si(text);
    if value.is_none() {
        let message = format!("`{}` is not a finite number", quoted(text));
        let help = "write plain numbers with a decimal point; the unit is given in the first line, as in `bend [deg]`";
        problems.push(cell.span, || problem(message, help));
    }
    value
}

fn truth(cell: &Cell, row: &Row, problems: &mut Problems) -> bool {
    const HELP: &str =
        "write true or false (or 1 or 0): whether the robot was measured in this row";
    match cell.value.text().map(str::to_lowercase).as_deref() {
        Some("true" | "1" | "yes" | "1.0") => true,
        Some("false" | "0" | "no" | "0.0") => false,
        Some(other) => {
            let message = format!("`{}` is neither true nor false", quoted(other));
            problems.push(cell.span, || problem(message, HELP));
            true
        }
        None => {
            problems
                .push(row.span, || problem("this row does not say whether it is measured", HELP));
            true
        }
    }
}

/// Refuses a command that no cable or motor can have.
fn out_of_range(
    of: Commanded,
    value: f64,
    unit: &Unit,
    robot: &CommandedRobot<'_>,
    cell: &Cell,
    problems: &mut Problems,
) {
    let of_range = |path: String, range: Range| range.problem(value).map(|found| (path, found));
    let refused = match of {
        Commanded::Tension(i) => of_range(format!("cables[{i}].tension"), TENSION),
        Commanded::Shortening(i) => {
            let range = if unit.dimension == Dimension::Ratio { FRACTION } else { COORDINATE };
            of_range(format!("cables[{i}].shortening"), range)
        }
        Commanded::Motor(i) => {
            let motor = &robot.motors[i];
            let path = format!("motors[{i}].{}", motor.drive.keys().command);
            motor.check_command(value).err().map(|found| (path, found))
        }
    };
    if let Some((path, found)) = refused {
        problems.push(cell.span, || FileProblem::Physical { path, problem: found });
    }
}

/// Counts the lines of a text up to places that come in order.
struct Lines<'a> {
    text: &'a str,
    at: usize,
    line: usize,
}

impl Lines<'_> {
    fn of(&mut self, start: usize) -> usize {
        let passed = self.text.as_bytes().get(self.at..start).unwrap_or_default();
        self.line += passed.iter().filter(|&&byte| byte == b'\n').count();
        self.at = self.at.max(start);
        self.line
    }
}
