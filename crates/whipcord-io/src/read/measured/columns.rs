//! The columns of a table: which there are, in which order and in which units.

use super::grid::Grid;
use super::{Known, LENGTH_UNITS, problem};
use crate::error::{FileProblem, Problems};
use crate::source::quoted;
use crate::suggest;
use crate::units::listed;

/// A column, and what stands in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Step,
    Disk,
    ArcLength,
    Offset(usize),
    Position(usize),
    Pixel(usize),
    Camera,
    Deviation,
    Confidence,
}

/// What other programs call a column.
const OTHER_NAMES: [(&str, &str); 16] = [
    ("s", "arc_length"),
    ("arc", "arc_length"),
    ("arclength", "arc_length"),
    ("station", "arc_length"),
    ("id", "disk"),
    ("index", "disk"),
    ("marker", "disk"),
    ("node", "disk"),
    ("number", "disk"),
    ("px", "x"),
    ("py", "y"),
    ("pz", "z"),
    ("col", "u"),
    ("row", "v"),
    ("sigma", "deviation"),
    ("std", "deviation"),
];

impl Column {
    const fn is_length(self) -> bool {
        matches!(self, Self::ArcLength | Self::Offset(_) | Self::Position(_))
    }
}

/// A column with the unit of its lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Read {
    pub column: Column,
    pub unit: &'static str,
}

const COLUMNS: [(&str, Column); 14] = [
    ("step", Column::Step),
    ("disk", Column::Disk),
    ("arc_length", Column::ArcLength),
    ("offset_x", Column::Offset(0)),
    ("offset_y", Column::Offset(1)),
    ("offset_z", Column::Offset(2)),
    ("x", Column::Position(0)),
    ("y", Column::Position(1)),
    ("z", Column::Position(2)),
    ("u", Column::Pixel(0)),
    ("v", Column::Pixel(1)),
    ("camera", Column::Camera),
    ("deviation", Column::Deviation),
    ("confidence", Column::Confidence),
];

pub(super) const HEADER: &str = "the first line names the columns, in any order, such as `disk,x,y,z`; then follows one line for each disk";
/// What there may be, and how the columns are told from one another.
const NAMES: &str = "the columns are step, disk or arc_length, offset_x, offset_y, offset_z, then x, y, z or camera, u, v, and deviation, confidence; one of lengths may name its unit, as `x [mm]`";

/// Which column each cell is of.
pub(super) fn columns(
    grid: &Grid,
    known: &Known<'_>,
    problems: &mut Problems,
) -> Option<Vec<Read>> {
    let names = || grid.columns.iter().map(|cell| cell.value.text().unwrap_or_default());
    if names().all(|name| column(split_unit(name).0).is_none()) {
        problems.push(grid.header, || unnamed(&names().collect::<Vec<_>>()));
        return None;
    }
    let mut columns: Vec<Read> = Vec::new();
    for (name, cell) in names().zip(&grid.columns) {
        let (bare, unit) = split_unit(name);
        match column(bare) {
            Some(column) if columns.iter().any(|read| read.column == column) => {
                let message = format!("the column `{}` is there twice", quoted(bare));
                problems.push(cell.span, || problem(message, HEADER));
            }
            Some(column) => match unit_of(column, unit, known) {
                Ok(unit) => columns.push(Read { column, unit }),
                Err(told) => problems.push(cell.span, || told),
            },
            None if name.is_empty() => {
                let help = "name it; or leave out row numbers, as pandas does with index=False";
                problems.push(cell.span, || problem("this column has no name", help));
            }
            None => problems.push(cell.span, || unknown(name)),
        }
    }
    let has = |column| columns.iter().any(|read| read.column == column);
    let mut complete = columns.len() == grid.columns.len();
    if complete && !has(Column::Disk) && !has(Column::ArcLength) {
        let message = "there must be a column `disk` or `arc_length`";
        problems.push(grid.header, || problem(message, HEADER));
        complete = false;
    }
    let missing = |names: &[&'static str]| -> Vec<&'static str> {
        names.iter().copied().filter(|name| column(name).is_some_and(|c| !has(c))).collect()
    };
    let (positions, pixels) = (missing(&["x", "y", "z"]), missing(&["u", "v"]));
    if complete && !matches!((positions.len(), pixels.len()), (0, 0 | 2) | (3, 0)) {
        // What is begun must be complete; where nothing is, positions are what is missed.
        let begun = if pixels.len() == 1 { pixels.clone() } else { positions };
        let (word, verb) = if begun.len() == 1 { ("column", "is") } else { ("columns", "are") };
        let named: Vec<String> = begun.iter().map(|name| format!("`{name}`")).collect();
        let named = listed(named.iter().map(String::as_str), "and");
        let message = format!("the {word} {named} {verb} missing");
        problems.push(grid.header, || {
            problem(
                message,
                "a position has the columns x, y and z, a place in an image u and v; in any order",
            )
        });
        complete = false;
    }
    if complete && has(Column::Pixel(0)) && known.cameras.is_empty() {
        let help =
            "add [[measured.cameras]] with `name` and `file`, the camera that took the image";
        problems.push(grid.header, || problem("places in an image need a camera", help));
        complete = false;
    }
    if complete && has(Column::Pixel(0)) && known.cameras.len() > 1 && !has(Column::Camera) {
        let message = format!(
            "there must be a column `camera`: the file has {}",
            listed(known.cameras.iter().copied(), "and")
        );
        problems.push(grid.header, || {
            problem(message, "say in each line which camera saw it, by its name")
        });
        complete = false;
    }
    complete.then_some(columns)
}

/// The column of a name, in capitals or not.
fn column(name: &str) -> Option<Column> {
    COLUMNS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, column)| *column)
}

/// A name of a column without the unit that follows it in brackets, and that unit.
fn split_unit(name: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((bare, unit)) = name.strip_suffix(close).and_then(|name| name.split_once(open))
        else {
            continue;
        };
        return (bare.trim(), Some(unit.trim()));
    }
    (name, None)
}

/// The unit of the lengths of a column: its own, else that of the file.
fn unit_of(
    column: Column,
    named: Option<&str>,
    known: &Known<'_>,
) -> Result<&'static str, FileProblem> {
    let Some(named) = named else { return Ok(known.unit) };
    let unit = LENGTH_UNITS.into_iter().find(|unit| *unit == named);
    match unit {
        Some(unit) if column.is_length() || column == Column::Deviation => Ok(unit),
        _ if matches!(column, Column::Pixel(_)) && ["px", "pixel", "pixels"].contains(&named) => {
            Ok(known.unit)
        }
        _ if column.is_length() => {
            let message = format!("`{}` is no unit of a length here", quoted(named));
            Err(problem(message, format!("the unit is {}", listed(LENGTH_UNITS, "or"))))
        }
        _ => {
            let message = format!("this column has no unit, but `{}` is given", quoted(named));
            Err(problem(message, "leave out the brackets"))
        }
    }
}

/// The first line names no column: what it may be instead.
fn unnamed(names: &[&str]) -> FileProblem {
    let message = "this line must name the columns";
    let numbers = names.iter().all(|name| name.is_empty() || name.parse::<f64>().is_ok());
    let mut words = names.iter().flat_map(|name| name.split_whitespace());
    if names.iter().all(|name| name.contains(' ')) && words.all(|name| column(name).is_some()) {
        problem(message, "separate the columns by commas, semicolons or tabs, not by spaces")
    } else if numbers {
        problem(
            message,
            "put a line before the numbers that names their columns, such as `disk,x,y,z`",
        )
    } else {
        problem(message, NAMES)
    }
}

/// A column that nothing knows.
fn unknown(name: &str) -> FileProblem {
    let lower = name.to_lowercase();
    let message = format!("there is no column `{}`", quoted(name));
    // `x_mm`, with the unit as a part of the name.
    let with_unit = lower.rsplit_once('_').and_then(|(bare, unit)| {
        let unit = LENGTH_UNITS.into_iter().find(|known| *known == unit)?;
        column(bare).filter(|column| column.is_length())?;
        Some(format!("write `{bare} [{unit}]` for lengths in {unit}"))
    });
    let other = OTHER_NAMES.iter().find(|(other, _)| *other == lower).map(|(_, name)| *name);
    let near = || suggest::nearest(&lower, COLUMNS.iter().map(|(known, _)| *known));
    match (with_unit, other.or_else(near)) {
        (Some(help), _) => problem(message, help),
        (None, Some(near)) => problem(message, format!("did you mean `{near}`?")),
        (None, None) => problem(message, NAMES),
    }
}
