//! Commands over time in a table of its own.

use std::path::Path;

use whipcord_motion::{Course, MotionError};

use super::Motion;
use super::command::{Driven, Told, add, range};
use crate::error::{FileProblem, Problems};
use crate::read::table::{self, Grid, Unit, problem, split_unit};
use crate::schema::DURATION;
use crate::source::{Sources, Span, quoted};
use crate::units::Dimension;

/// What the first line of the file must be.
const HEADER: &str = "the first line names the columns: t, then cables and motors with their units, as in `pull [N]`; then follows one line for each time";

/// A column.
struct Column {
    at: usize,
    /// What it tells; `None` for the time.
    told: Option<Told>,
    unit: Unit,
    range: whipcord::robot::limits::Range,
}

/// Reads the table in a file that another one names at `named` into a motion.
pub(super) fn read(
    path: &Path,
    named: Span,
    driven: &Driven<'_>,
    motion: &mut Motion,
    sources: &mut Sources,
    problems: &mut Problems,
) {
    let Some(grid) = table::read(path, Some(named), HEADER, sources, problems) else { return };
    let Some(columns) = columns(&grid, driven, problems) else { return };
    let Some(values) = values(&grid, &columns, problems) else { return };
    let (Some(time), told) = (values.first(), columns.iter().zip(&values).skip(1)) else { return };
    for (column, values) in told {
        let Some(of) = column.told else { continue };
        match Course::table(time.clone(), values.clone()) {
            Ok(course) => {
                if !add(motion, of, course, column.unit.dimension) {
                    let name = grid.columns[column.at].value.text().unwrap_or_default();
                    let message = format!("`{}` has two commands over time", quoted(name));
                    problems.push(grid.columns[column.at].span, || {
                        problem(message, "keep one of the two")
                    });
                }
            }
            Err(MotionError::Course { row, problem: found }) => {
                let span = grid.rows.get(row).map_or(grid.header, |row| row.span);
                let help = "put the rows in the order of their times; two rows with the same time are a jump";
                problems.push(span, || problem(format!("this row {found}"), help));
                return;
            }
            Err(_) => return,
        }
    }
}

/// The columns, the time first; `None` where one is refused.
fn columns(grid: &Grid, driven: &Driven<'_>, problems: &mut Problems) -> Option<Vec<Column>> {
    let (mut time, mut told) = (None, Vec::new());
    let mut is_refused = false;
    for (at, cell) in grid.columns.iter().enumerate() {
        let name = cell.value.text().unwrap_or_default();
        let (bare, unit) = split_unit(name);
        let mut refuse = |message: String, help: String| {
            problems.push(cell.span, || problem(message, help));
            is_refused = true;
        };
        if bare.eq_ignore_ascii_case("t") || bare.eq_ignore_ascii_case("time") {
            let given = unit.map_or(Ok(Unit::si(Dimension::Time)), |unit| {
                Unit::named(unit, &[Dimension::Time])
            });
            match given {
                Ok(unit) => time = Some(Column { at, told: None, unit, range: DURATION }),
                Err((message, help)) => refuse(message, help),
            }
            continue;
        }
        let Some(of) = driven.find(bare) else {
            let message = format!("there is no cable or motor `{}`", quoted(bare));
            refuse(message, format!("cables and motors are {}", driven.names()));
            continue;
        };
        let Some(unit) = unit else {
            let message = format!("the column `{}` has no unit", quoted(name));
            let help = "a unit tells what is commanded, as in `pull [N]` for a tension or `pull [mm]` for a shortening";
            refuse(message, help.to_owned());
            continue;
        };
        match Unit::named(unit, driven.dimensions(of)) {
            Ok(unit) => {
                let range = range(unit.dimension);
                told.push(Column { at, told: Some(of), unit, range });
            }
            Err((message, help)) => refuse(message, help),
        }
    }
    let Some(time) = time else {
        problems.push(grid.header, || problem("there is no column t", HEADER));
        return None;
    };
    if told.is_empty() && !is_refused {
        problems.push(grid.header, || problem("there is no column of a cable or motor", HEADER));
        return None;
    }
    told.insert(0, time);
    (!is_refused).then_some(told)
}

/// The numbers of each column in SI.
fn values(grid: &Grid, columns: &[Column], problems: &mut Problems) -> Option<Vec<Vec<f64>>> {
    let mut values = vec![Vec::with_capacity(grid.rows.len()); columns.len()];
    for row in &grid.rows {
        for (out, column) in values.iter_mut().zip(columns) {
            let cell = &row.cells[column.at];
            let text = cell.value.text().unwrap_or_default();
            let Some(value) = column.unit.in_si(text) else {
                let message = format!("`{}` is not a finite number", quoted(text));
                let help = "write plain numbers with a decimal point; the unit is given in the first line, as in `pull [N]`";
                problems.push(cell.span, || problem(message, help));
                return None;
            };
            if let Some(found) = column.range.problem(value) {
                let path = grid.columns[column.at].value.text().unwrap_or_default().to_owned();
                problems.push(cell.span, || FileProblem::Physical { path, problem: found });
                return None;
            }
            out.push(value);
        }
    }
    Some(values)
}
