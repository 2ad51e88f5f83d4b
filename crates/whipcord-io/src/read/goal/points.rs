//! Tables of points that disks are to reach.

use std::path::Path;

use whipcord::Vec3;
use whipcord::robot::limits::COORDINATE;

use crate::error::{FileError, FileProblem, Problems};
use crate::read::table::{self, Grid, Row, Unit, problem, split_unit};
use crate::source::{Sources, Span, quoted};
use crate::suggest;
use crate::units::{Dimension, listed};

/// What the first line of the file must be.
const SHAPE: &str = "the first line names the columns: disk, x, y, z, each coordinate with its unit, as in `x [mm]`; then follows one line for each disk";

/// The columns of a shape: the number of the disk, and its coordinates.
const COLUMNS: [&str; 4] = ["disk", "x", "y", "z"];

/// The points of a shape in a file: numbers of disks from 0, and where they are to be in m.
///
/// # Errors
/// [`FileError`] with all that is wrong with it.
pub fn load_shape(path: &Path, disks: usize) -> Result<Vec<(usize, Vec3)>, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match shape(path, None, Some(disks), &mut sources, &mut problems) {
        Some(points) if problems.is_empty() => Ok(points),
        _ => Err(problems.into_error(sources)),
    }
}

/// The same of a file that another one may name at `named`, for a robot with so many disks where they are known.
pub(super) fn shape(
    path: &Path,
    named: Option<Span>,
    disks: Option<usize>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<(usize, Vec3)>> {
    let grid = table::read(path, named, SHAPE, sources, problems)?;
    let [disk, axes @ ..] = columns(&grid, problems)?;
    let mut points: Vec<(usize, Vec3)> = Vec::new();
    let mut spans: Vec<Span> = Vec::new();
    for row in &grid.rows {
        if problems.is_full() {
            return None;
        }
        let number = number_of_disk(row, disk.at, disks, problems);
        let coordinates = [0, 1, 2].map(|k| coordinate(row, &axes[k], COLUMNS[k + 1], problems));
        let (Some(number), [Some(x), Some(y), Some(z)]) = (number, coordinates) else { continue };
        if let Some(first) = points.iter().position(|(other, _)| *other == number) {
            let related = Some((spans[first], "it is first given here"));
            let message = format!("disk {} is given twice", number + 1);
            let help = "leave out one of the two lines";
            problems.push_related(row.span, related, || problem(message, help));
            continue;
        }
        points.push((number, Vec3::new(x, y, z)));
        spans.push(row.span);
    }
    problems.is_empty().then_some(points)
}

/// Where a column is, and the unit of its numbers.
struct Column {
    at: usize,
    unit: Unit,
}

/// The columns in the order of their names; `None` where one is missing or unknown.
fn columns(grid: &Grid, problems: &mut Problems) -> Option<[Column; 4]> {
    let mut found: [Option<Column>; 4] = [const { None }; 4];
    let mut is_refused = false;
    for (at, cell) in grid.columns.iter().enumerate() {
        let name = cell.value.text().unwrap_or_default();
        let (bare, unit) = split_unit(name);
        let Some(k) = COLUMNS.iter().position(|known| bare.eq_ignore_ascii_case(known)) else {
            let message = format!("there is no column `{}` in a shape", quoted(name));
            // A single letter or digit resembles every other one.
            let near = suggest::nearest(bare, COLUMNS).filter(|_| bare.len() > 1);
            let help =
                near.map_or_else(|| SHAPE.to_owned(), |near| format!("did you mean `{near}`?"));
            problems.push(cell.span, || problem(message, help));
            is_refused = true;
            continue;
        };
        let dimension = if k == 0 { Dimension::Ratio } else { Dimension::Length };
        let unit = match unit {
            None => Ok(Unit::si(dimension)),
            Some(unit) => Unit::named(unit, &[dimension]),
        };
        match unit {
            Err((message, help)) => {
                problems.push(cell.span, || problem(message, help));
                is_refused = true;
            }
            Ok(_) if found[k].is_some() => {
                let message = format!("the column `{}` is given twice", COLUMNS[k]);
                problems.push(cell.span, || problem(message, "leave out one of the two"));
                is_refused = true;
            }
            Ok(unit) => found[k] = Some(Column { at, unit }),
        }
    }
    let missing = COLUMNS.iter().zip(&found).filter(|(_, column)| column.is_none());
    let missing: Vec<&str> = missing.map(|(name, _)| *name).collect();
    if !missing.is_empty() && !is_refused {
        let message = format!("there is no column {}", listed(missing, "and no column"));
        problems.push(grid.header, || problem(message, SHAPE));
    }
    let [Some(disk), Some(x), Some(y), Some(z)] = found else { return None };
    (!is_refused).then_some([disk, x, y, z])
}

/// The number of a disk from 0.
fn number_of_disk(
    row: &Row,
    at: usize,
    disks: Option<usize>,
    problems: &mut Problems,
) -> Option<usize> {
    let cell = &row.cells[at];
    let text = cell.value.text().unwrap_or_default();
    // Other programs write whole numbers with a point.
    let number = text.parse::<f64>().ok().filter(|number| number.fract() == 0.0);
    let most = disks.unwrap_or(usize::MAX);
    #[allow(clippy::cast_precision_loss, reason = "a bound on a number of disks")]
    let number = number.filter(|number| *number >= 1.0 && *number <= most as f64);
    if number.is_none() {
        let message = format!("`{}` is no disk", quoted(text));
        let help = match disks {
            Some(disks) => format!("disks count from 1, the base disk, to {disks}, the tip"),
            None => "disks count from 1, the base disk".to_owned(),
        };
        problems.push(cell.span, || problem(message, help));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 1"
    )]
    number.map(|number| number as usize - 1)
}

/// A coordinate in m.
fn coordinate(row: &Row, column: &Column, name: &str, problems: &mut Problems) -> Option<f64> {
    let cell = &row.cells[column.at];
    let text = cell.value.text().unwrap_or_default();
    let Some(value) = column.unit.in_si(text) else {
        let message = match text {
            "" => format!("this line has no `{name}`"),
            _ => format!("`{}` is not a finite number", quoted(text)),
        };
        let help = "write plain numbers with a decimal point; the unit is given in the first line, as in `x [mm]`; leave out disks that may be anywhere";
        problems.push(cell.span, || problem(message, help));
        return None;
    };
    if let Some(found) = COORDINATE.problem(value) {
        let path = name.to_owned();
        problems.push(cell.span, || FileProblem::Physical { path, problem: found });
        return None;
    }
    Some(value)
}
