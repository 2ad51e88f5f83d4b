//! The columns of a table: which there are, in which order and in which units.

use super::super::table::{Grid, problem, split_unit};
use super::{Known, LENGTH_UNITS};
use crate::error::{FileProblem, Problems};
use crate::source::quoted;
use crate::suggest;
use crate::units::listed;

/// A column, and what stands in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// Not of what is measured.
    Ignored,
    Key,
    Step,
    Disk,
    ArcLength,
    Offset(usize),
    Position(usize),
    Orientation(usize),
    Pixel(usize),
    Camera,
    Deviation,
    Confidence,
    /// What `whipcord measure` tells beside it, and nothing else needs.
    Told(u8),
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

    /// Whether a marker with columns of its own has this one.
    pub(super) const fn is_of_marker(self) -> bool {
        matches!(self, Self::Offset(_) | Self::Position(_) | Self::Orientation(_))
    }
}

/// A column with the unit of its lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Read {
    pub column: Column,
    pub unit: &'static str,
    /// Whether its header names that unit, else `unit` of [measured] does or says nothing.
    pub names_unit: bool,
    /// Number of the marker in [[measured.markers]] that the column is named after.
    pub marker: Option<usize>,
}

const COLUMNS: [(&str, Column); 22] = [
    ("step", Column::Step),
    ("disk", Column::Disk),
    ("arc_length", Column::ArcLength),
    ("offset_x", Column::Offset(0)),
    ("offset_y", Column::Offset(1)),
    ("offset_z", Column::Offset(2)),
    ("x", Column::Position(0)),
    ("y", Column::Position(1)),
    ("z", Column::Position(2)),
    ("qw", Column::Orientation(0)),
    ("qx", Column::Orientation(1)),
    ("qy", Column::Orientation(2)),
    ("qz", Column::Orientation(3)),
    ("u", Column::Pixel(0)),
    ("v", Column::Pixel(1)),
    ("camera", Column::Camera),
    ("deviation", Column::Deviation),
    ("confidence", Column::Confidence),
    ("deviation_x", Column::Told(0)),
    ("deviation_y", Column::Told(1)),
    ("deviation_z", Column::Told(2)),
    ("epipolar", Column::Told(3)),
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
    if names().all(|name| found(name, known).is_none()) {
        problems.push(grid.header, || unnamed(&names().collect::<Vec<_>>()));
        return None;
    }
    // The column by which rows are found, where no column has its name.
    let lost_key = known.key.filter(|_| !known.same_file).filter(|_| {
        names().all(|name| !matches!(found(name, known), Some((Column::Key | Column::Step, _))))
    });
    let mut columns: Vec<Read> = Vec::new();
    for (name, cell) in names().zip(&grid.columns) {
        let (bare, unit) = split_unit(name);
        match found(name, known) {
            Some((Column::Ignored, marker)) => {
                columns.push(Read {
                    column: Column::Ignored,
                    unit: known.unit,
                    names_unit: false,
                    marker,
                });
            }
            Some((column, marker))
                if columns.iter().any(|read| (read.column, read.marker) == (column, marker)) =>
            {
                let message = format!("the column `{}` is there twice", quoted(bare));
                let help = "give each column a name of its own, or leave out one of the two";
                problems.push(cell.span, || problem(message, help));
            }
            Some((column, marker)) => match unit_of(column, unit, known) {
                Ok(found) => {
                    columns.push(Read { column, unit: found, names_unit: unit.is_some(), marker })
                }
                Err(told) => problems.push(cell.span, || told),
            },
            None if name.is_empty() => {
                let help = "name it; or leave out row numbers, as pandas does with index=False";
                problems.push(cell.span, || problem("this column has no name", help));
            }
            None => problems.push(cell.span, || match lost_key {
                Some(key) => problem(
                    format!("there is no column `{}`", quoted(name)),
                    format!(
                        "if it has the keys of the rows, name it `{0}`, as `key` of [commands] says, or write `key = \"{1}\"` under [measured]",
                        quoted(key),
                        quoted(name)
                    ),
                ),
                None => unknown(name, known),
            }),
        }
    }
    let complete = columns.len() == grid.columns.len();
    if complete && !known.markers.is_empty() {
        return of_markers(grid, &columns, known, problems).then_some(columns);
    }
    let has = |column| columns.iter().any(|read| read.column == column);
    let mut complete = complete;
    if complete && known.rows().is_none() && !has(Column::Disk) && !has(Column::ArcLength) {
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
    complete = complete && whole_orientation(grid, &columns, None, problems);
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

/// The column that this name of the file is of, and the marker in whose name it is.
fn found(name: &str, known: &Known<'_>) -> Option<(Column, Option<usize>)> {
    let (bare, _) = split_unit(name);
    if known.ignored.iter().any(|ignored| *ignored == name || *ignored == bare) {
        return Some((Column::Ignored, None));
    }
    if known.key.is_some_and(|key| key == name || key == bare) {
        return Some((Column::Key, None));
    }
    let of_marker = known.markers.iter().enumerate().find_map(|(number, marker)| {
        let rest = bare.strip_prefix(marker.name?)?;
        let rest = rest.strip_prefix(MARKER_SEPARATORS)?;
        column(rest).filter(|column| column.is_of_marker()).map(|column| (column, Some(number)))
    });
    if of_marker.is_some() {
        return of_marker;
    }
    if let Some(plain) = column(bare) {
        let unnamed = known.markers.iter().position(|marker| marker.name.is_none());
        let is_known = known.markers.is_empty() || unnamed.is_some() || !plain.is_of_marker();
        if is_known {
            return Some((plain, unnamed.filter(|_| plain.is_of_marker())));
        }
    }
    let rows = known.rows()?;
    // The commands may stand in the same file, and what is said of rows there may be said here again.
    let is_of_rows = known.same_file && rows.columns.iter().any(|column| column == name)
        || ["time", "t", "group", "measured"].iter().any(|word| bare.eq_ignore_ascii_case(word));
    is_of_rows.then_some((Column::Ignored, None))
}

/// Whether each marker of `[[measured.markers]]` has its columns, and no column says where markers are besides.
fn of_markers(grid: &Grid, columns: &[Read], known: &Known<'_>, problems: &mut Problems) -> bool {
    let mut complete = true;
    for (number, marker) in known.markers.iter().enumerate() {
        let has = |column| {
            columns.iter().any(|read| (read.column, read.marker) == (column, Some(number)))
        };
        let missing: Vec<String> = ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .filter(|(axis, _)| !has(Column::Position(*axis)))
            .map(|(_, axis)| match marker.name {
                Some(name) => format!("`{}.{axis}`", quoted(name)),
                None => format!("`{axis}`"),
            })
            .collect();
        if !missing.is_empty() {
            let (word, verb) =
                if missing.len() == 1 { ("column", "is") } else { ("columns", "are") };
            let named = listed(missing.iter().map(String::as_str), "and");
            let message = format!("the {word} {named} {verb} missing");
            let help = "each marker of [[measured.markers]] has the columns x, y and z behind its name, as `m1.x`, `m1.y` and `m1.z`";
            problems.push(grid.header, || problem(message, help));
            complete = false;
        }
        complete &= whole_orientation(grid, columns, Some(number), problems);
    }
    for (read, cell) in columns.iter().zip(&grid.columns) {
        if matches!(read.column, Column::Disk | Column::ArcLength | Column::Pixel(_)) {
            let help = "say in [[measured.markers]] where each marker is, or leave out these tables and write one line for each marker";
            problems.push(cell.span, || {
                problem("this column and [[measured.markers]] exclude each other", help)
            });
            complete = false;
        }
    }
    complete
}

/// Whether an orientation, if any, has all four columns.
fn whole_orientation(
    grid: &Grid,
    columns: &[Read],
    marker: Option<usize>,
    problems: &mut Problems,
) -> bool {
    let has = |part: usize| {
        columns.iter().any(|read| (read.column, read.marker) == (Column::Orientation(part), marker))
    };
    let given = (0..4).filter(|part| has(*part)).count();
    if !matches!(given, 0 | 4) {
        let help = "an orientation is a quaternion with the columns qw, qx, qy and qz";
        problems.push(grid.header, || problem("a part of the orientation is missing", help));
    }
    matches!(given, 0 | 4)
}

/// What may stand between the name of a marker and that of its column.
pub(in crate::read) const MARKER_SEPARATORS: [char; 5] = ['.', '_', ' ', '-', ':'];

/// Whether a table of measurements has a column of this name, without its unit and the name of a marker.
pub(in crate::read) fn is_measured(bare: &str) -> bool {
    column(bare).is_some()
}

/// The column of a name, in capitals or not.
fn column(name: &str) -> Option<Column> {
    COLUMNS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, column)| *column)
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
fn unknown(name: &str, known: &Known<'_>) -> FileProblem {
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
    let named = || {
        let mut names = known.markers.iter().filter_map(|marker| marker.name);
        names.next().map(|name| {
            format!("{NAMES}; those of a marker begin with its name, as `{}.x`", quoted(name))
        })
    };
    match (with_unit, other.or_else(near)) {
        (Some(help), _) => problem(message, help),
        (None, Some(near)) => problem(message, format!("did you mean `{near}`?")),
        (None, None) if !known.ignored.is_empty() || known.rows().is_some() => {
            let help = named().unwrap_or_else(|| NAMES.to_owned());
            problem(
                message,
                format!(
                    "{help}; those that are not to be read are named in `ignore` of [measured]"
                ),
            )
        }
        (None, None) => problem(message, named().unwrap_or_else(|| NAMES.to_owned())),
    }
}
