//! Tables of points that disks are to reach.

use std::path::Path;

use whipcord::robot::limits::COORDINATE;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_inverse::{PathPoint, Target};

use crate::error::{FileError, FileProblem, Problems};
use crate::read::table::{self, Grid, Row, Unit, problem, split_unit};
use crate::source::{Sources, Span, quoted};
use crate::suggest;
use crate::units::{Dimension, listed};

/// What the first line of the file of a shape must be.
const SHAPE: &str = "the first line names the columns: disk, x, y, z, each coordinate with its unit, as in `x [mm]`; then follows one line for each disk";
/// The same for a path.
const PATH: &str = "the first line names the columns: t, x, y, z, with units, as in `x [mm]`, and for poses also qw, qx, qy, qz; then follows one line for each point";

/// A kind of table.
struct Kind {
    what: &'static str,
    header: &'static str,
    columns: &'static [(&'static str, Dimension)],
    /// How many of the columns, the first ones, must be there.
    needed: usize,
}

const OF_SHAPE: Kind = Kind {
    what: "a shape",
    header: SHAPE,
    columns: &[
        ("disk", Dimension::Ratio),
        ("x", Dimension::Length),
        ("y", Dimension::Length),
        ("z", Dimension::Length),
    ],
    needed: 4,
};

const OF_PATH: Kind = Kind {
    what: "a path",
    header: PATH,
    columns: &[
        ("t", Dimension::Time),
        ("x", Dimension::Length),
        ("y", Dimension::Length),
        ("z", Dimension::Length),
        ("qw", Dimension::Ratio),
        ("qx", Dimension::Ratio),
        ("qy", Dimension::Ratio),
        ("qz", Dimension::Ratio),
    ],
    needed: 4,
};

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

/// The points of a path in a file.
///
/// # Errors
/// [`FileError`] with all that is wrong with it.
pub fn load_path(path: &Path) -> Result<Vec<PathPoint>, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match self::path(path, None, &mut sources, &mut problems) {
        Some(points) if problems.is_empty() => Ok(points),
        _ => Err(problems.into_error(sources)),
    }
}

/// The points of a path in a file that another one may name at `named`.
pub(in crate::read) fn path(
    path: &Path,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<PathPoint>> {
    let grid = table::read(path, named, PATH, sources, problems)?;
    let columns = columns(&grid, &OF_PATH, problems)?;
    let has_turns = columns[4..].iter().any(Option::is_some);
    if let Some(k) = (4..8).find(|k| has_turns && columns[*k].is_none()) {
        let message = format!("there is no column `{}` beside the others", OF_PATH.columns[k].0);
        problems.push(grid.header, || problem(message, PATH));
        return None;
    }
    let mut points: Vec<PathPoint> = Vec::new();
    for row in &grid.rows {
        if problems.is_full() {
            return None;
        }
        let mut number = |k: usize| {
            let column = columns[k].as_ref()?;
            value(row, column, OF_PATH.columns[k].0, problems)
        };
        let first = [0, 1, 2, 3].map(&mut number);
        let turn = if has_turns { [4, 5, 6, 7].map(&mut number) } else { [None; 4] };
        let [Some(time), Some(x), Some(y), Some(z)] = first else { continue };
        let position = Vec3::new(x, y, z);
        let target = match turn {
            [Some(w), Some(x), Some(y), Some(z)] => {
                let Some(rotation) = UnitQuaternion::from_wxyz([w, x, y, z]) else {
                    let help = "give a quaternion (w, x, y, z) that is not zero";
                    problems.push(row.span, || problem("the orientation has no direction", help));
                    continue;
                };
                Target::Pose(Pose { position, rotation })
            }
            _ if has_turns => continue,
            _ => Target::Tip(position),
        };
        if points.last().is_some_and(|before| before.time >= time) {
            let help = "put the points in the order of their times, each time once";
            problems.push(row.span, || problem("the times do not ascend", help));
        }
        points.push(PathPoint { time, target });
    }
    problems.is_empty().then_some(points)
}

/// The points of a shape in a file that another one may name at `named`, for a robot with so many disks where they are known.
pub(in crate::read) fn shape(
    path: &Path,
    named: Option<Span>,
    disks: Option<usize>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<(usize, Vec3)>> {
    let grid = table::read(path, named, SHAPE, sources, problems)?;
    let [Some(disk), Some(x), Some(y), Some(z)] = &columns(&grid, &OF_SHAPE, problems)?[..] else {
        return None;
    };
    let axes = [x, y, z];
    let mut points: Vec<(usize, Vec3)> = Vec::new();
    let mut spans: Vec<Span> = Vec::new();
    for row in &grid.rows {
        if problems.is_full() {
            return None;
        }
        let number = number_of_disk(row, disk.at, disks, problems);
        let coordinates =
            [0, 1, 2].map(|k| value(row, axes[k], OF_SHAPE.columns[k + 1].0, problems));
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

/// The columns in the order of their names; `None` where one that is needed is missing, or one is unknown.
fn columns(grid: &Grid, kind: &Kind, problems: &mut Problems) -> Option<Vec<Option<Column>>> {
    let names = || kind.columns.iter().map(|(name, _)| *name);
    let mut found: Vec<Option<Column>> = names().map(|_| None).collect();
    let mut is_refused = false;
    for (at, cell) in grid.columns.iter().enumerate() {
        let name = cell.value.text().unwrap_or_default();
        let (bare, unit) = split_unit(name);
        let is = |known: &str| bare.eq_ignore_ascii_case(known) || (known == "t" && bare == "time");
        let Some(k) = names().position(is) else {
            let message = format!("there is no column `{}` in {}", quoted(name), kind.what);
            // A single letter or digit resembles every other one.
            let near = suggest::nearest(bare, names()).filter(|_| bare.len() > 1);
            let help = near
                .map_or_else(|| kind.header.to_owned(), |near| format!("did you mean `{near}`?"));
            problems.push(cell.span, || problem(message, help));
            is_refused = true;
            continue;
        };
        let (name, dimension) = kind.columns[k];
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
                let message = format!("the column `{name}` is given twice");
                problems.push(cell.span, || problem(message, "leave out one of the two"));
                is_refused = true;
            }
            Ok(unit) => found[k] = Some(Column { at, unit }),
        }
    }
    if is_refused {
        return None;
    }
    let missing = names().zip(&found).take(kind.needed).filter(|(_, column)| column.is_none());
    let missing: Vec<&str> = missing.map(|(name, _)| name).collect();
    if !missing.is_empty() {
        let message = format!("there is no column {}", listed(missing, "and no column"));
        problems.push(grid.header, || problem(message, kind.header));
        return None;
    }
    Some(found)
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

/// A number in SI.
fn value(row: &Row, column: &Column, name: &str, problems: &mut Problems) -> Option<f64> {
    let cell = &row.cells[column.at];
    let text = cell.value.text().unwrap_or_default();
    let Some(value) = column.unit.in_si(text) else {
        let message = match text {
            "" => format!("this line has no `{name}`"),
            _ => format!("`{}` is not a finite number", quoted(text)),
        };
        let help = "write plain numbers with a decimal point; the unit is given in the first line, as in `x [mm]`; leave out lines without a number";
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
