//! The columns of a table of commands.

use whipcord::{Drive, Motor};

use super::{Commanded, CommandedRobot, HEADER};
use crate::check::{Data, Fields};
use crate::error::Problems;
use crate::node::Node;
use crate::read::measured::{MARKER_SEPARATORS, is_measured};
use crate::read::table::{Grid, Unit, problem, split_unit};
use crate::source::quoted;
use crate::suggest;
use crate::units::{Dimension, listed};

/// What stands in a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Column {
    Command {
        of: Commanded,
        /// How messages name it.
        name: String,
        unit: Unit,
    },
    /// A component of a load.
    Load {
        of: Loaded,
        /// How messages name it.
        name: String,
        unit: Unit,
    },
    Time(Unit),
    Group,
    Measured,
    Key,
    Ignored,
}

/// A load with a component of its own in each row: 0, 1 or 2 for x, y or z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Loaded {
    TipForce(usize),
    TipMoment(usize),
    Gravity(usize),
}

/// A load by the number of its component.
type OfAxis = fn(usize) -> Loaded;

/// The loads that columns may give, as robot files name them.
const LOADS: [(&str, OfAxis, Dimension); 3] = [
    ("tip_force", Loaded::TipForce, Dimension::Force),
    ("tip_moment", Loaded::TipMoment, Dimension::Moment),
    ("gravity", Loaded::Gravity, Dimension::Acceleration),
];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The load of a column `tip_force.x`, `loads.tip_force_x`, and the dimension of its unit.
fn load(bare: &str) -> Option<(Loaded, String, Dimension)> {
    let lower = bare.to_lowercase();
    let rest = lower.strip_prefix("loads.").unwrap_or(&lower);
    let (name, axis) = rest.rsplit_once(['.', '_', ' '])?;
    let axis = AXES.iter().position(|of| *of == axis)?;
    let (name, of, dimension) = LOADS.iter().find(|(known, ..)| *known == name)?;
    Some((of(axis), format!("{name}.{}", AXES[axis]), *dimension))
}

/// What `[commands]` says of the columns.
pub(super) struct Options<'a> {
    pub key: Option<&'a str>,
    group: &'a str,
    units: Vec<&'a str>,
    ignored: Vec<&'a str>,
    /// Names of markers and of other columns that [measured] has in the same file.
    measured: Option<Vec<&'a str>>,
}

impl<'a> Options<'a> {
    pub fn of(fields: &'a Fields, measured: Option<Vec<&'a str>>) -> Self {
        let texts = |key: &str| -> Vec<&'a str> {
            fields.list(key).unwrap_or_default().iter().filter_map(Data::as_text).collect()
        };
        Self {
            key: fields.text("key"),
            group: fields.text("group").unwrap_or("group"),
            units: texts("units"),
            ignored: texts("ignore"),
            measured,
        }
    }

    /// Whether the column is of what was measured.
    fn is_measured(&self, name: &str, bare: &str) -> bool {
        let Some(names) = &self.measured else { return false };
        is_measured(bare)
            || names.iter().any(|known| {
                let rest = bare.strip_prefix(known);
                let rest = rest.and_then(|rest| rest.strip_prefix(MARKER_SEPARATORS));
                *known == name || *known == bare || rest.is_some_and(is_measured)
            })
    }
}

/// Words for what a column of a cable or a motor gives.
const TENSION: [&str; 3] = ["tension", "force", "pull"];
const SHORTENING: [&str; 1] = ["shortening"];
const MOTOR: [&str; 4] = ["angle", "travel", "position", "command"];

/// A column of this name, of which the unit may say more.
enum Target {
    Tension(usize),
    Shortening(usize),
    /// A cable without a word for what it is told.
    Cable(usize),
    Motor(usize),
}

/// What each column is; `None` where one is refused or missing.
pub(super) fn columns(
    grid: &Grid,
    options: &Options<'_>,
    robot: &CommandedRobot<'_>,
    document: &Node,
    problems: &mut Problems,
) -> Option<Vec<Column>> {
    let mut columns: Vec<Column> = Vec::new();
    for cell in &grid.columns {
        let name = cell.value.text().unwrap_or_default();
        match column(name, options, robot) {
            Ok(column) => {
                let same = |other: &Column| match (other, &column) {
                    (Column::Command { of: a, .. }, Column::Command { of: b, .. }) => {
                        of_one(*a, *b)
                    }
                    (Column::Ignored, _) => false,
                    (Column::Load { of: a, .. }, Column::Load { of: b, .. }) => a == b,
                    (a, b) => core::mem::discriminant(a) == core::mem::discriminant(b),
                };
                if let Some(first) = columns.iter().position(same) {
                    let related = Some((grid.columns[first].span, "the other one is here"));
                    let message =
                        format!("the column `{}` gives what another one gives", quoted(name));
                    problems.push_related(cell.span, related, || {
                        problem(
                            message,
                            "leave out one of them, or name it in `ignore` of [commands]",
                        )
                    });
                }
                columns.push(column);
            }
            Err((message, help)) => {
                problems.push(cell.span, || problem(message, help));
                columns.push(Column::Ignored);
            }
        }
    }
    if let Some(key) = options.key.filter(|_| !columns.contains(&Column::Key)) {
        let near = suggest::nearest(key, grid.columns.iter().filter_map(|cell| cell.value.text()));
        let message =
            format!("there is no column `{}`, which `key` of [commands] names", quoted(key));
        let help = near.map_or_else(
            || "add it, with another text in each row; or leave out `key`".to_owned(),
            |near| format!("did you mean `{near}`?"),
        );
        problems.push(grid.header, || problem(message, help));
    }
    conflicts(grid, &columns, robot, document, problems);
    missing(grid, &columns, robot, problems);
    problems.is_empty().then_some(columns)
}

/// Whether two columns command one thing: a cable has a tension or a shortening.
fn of_one(a: Commanded, b: Commanded) -> bool {
    use Commanded::{Motor, Shortening, Tension};
    match (a, b) {
        (Motor(a), Motor(b)) => a == b,
        (Tension(a), Tension(b)) | (Shortening(a), Shortening(b)) => a == b,
        _ => false,
    }
}

type Refusal = (String, String);

fn column(
    name: &str,
    options: &Options<'_>,
    robot: &CommandedRobot<'_>,
) -> Result<Column, Refusal> {
    let (bare, unit) = split_unit(name);
    if options.ignored.iter().any(|ignored| *ignored == name || *ignored == bare) {
        return Ok(Column::Ignored);
    }
    if options.key.is_some_and(|key| key == name || key == bare) {
        return Ok(Column::Key);
    }
    if name.is_empty() {
        let help = "name it; or leave out row numbers, as pandas does with index=False";
        return Err(("this column has no name".to_owned(), help.to_owned()));
    }
    if let Some(target) = target(bare, robot) {
        return command(target, unit, options, robot);
    }
    if let Some((of, name, dimension)) = load(bare) {
        let unit = unit_of(&[dimension], unit, options)?;
        return Ok(Column::Load { of, name, unit });
    }
    let is = |word: &str| bare.eq_ignore_ascii_case(word);
    if is("time") || is("t") {
        return unit_of(&[Dimension::Time], unit, options).map(Column::Time);
    }
    if is(options.group) {
        return Ok(Column::Group);
    }
    if is("measured") {
        return Ok(Column::Measured);
    }
    if options.is_measured(name, bare) {
        return Ok(Column::Ignored);
    }
    Err(unknown(name, bare, options, robot))
}

/// The cable or motor of a name: its own, with a word for the quantity behind it, or its kind with its number.
fn target(bare: &str, robot: &CommandedRobot<'_>) -> Option<Target> {
    if let Some(found) = named(bare, robot) {
        return Some(match found {
            Found::Cable(cable) => Target::Cable(cable),
            Found::Motor(motor) => Target::Motor(motor),
        });
    }
    let (owner, word) = bare.rsplit_once(['.', '_', ' '])?;
    let word = word.to_lowercase();
    let word = word.as_str();
    match named(owner.trim(), robot)? {
        Found::Cable(cable) if TENSION.contains(&word) => Some(Target::Tension(cable)),
        Found::Cable(cable) if SHORTENING.contains(&word) => Some(Target::Shortening(cable)),
        Found::Motor(motor) if MOTOR.contains(&word) => Some(Target::Motor(motor)),
        _ => None,
    }
}

#[derive(Clone, Copy)]
enum Found {
    Cable(usize),
    Motor(usize),
}

fn named(name: &str, robot: &CommandedRobot<'_>) -> Option<Found> {
    let motor = robot.motors.iter().position(|motor| motor.name == name).map(Found::Motor);
    let cable = || robot.cables.iter().position(|cable| cable.name == name).map(Found::Cable);
    motor.or_else(cable).or_else(|| numbered(name, robot))
}

/// `cable1`, `cable-1`, `Motor 2`: counted from 1.
fn numbered(name: &str, robot: &CommandedRobot<'_>) -> Option<Found> {
    let lower = name.to_lowercase();
    let number = |kind: &str, count: usize| {
        let rest = lower.strip_prefix(kind)?.trim_start_matches(['-', '_', ' ', '#']);
        let number: usize = rest.parse().ok()?;
        number.checked_sub(1).filter(|index| *index < count)
    };
    let motor = number("motor", robot.motors.len()).map(Found::Motor);
    motor.or_else(|| number("cable", robot.cables.len()).map(Found::Cable))
}

fn command(
    target: Target,
    unit: Option<&str>,
    options: &Options<'_>,
    robot: &CommandedRobot<'_>,
) -> Result<Column, Refusal> {
    const FORCE: &[Dimension] = &[Dimension::Force];
    const SHORT: &[Dimension] = &[Dimension::Length, Dimension::Ratio];
    let cable = |cable: usize| robot.cables[cable].name.as_str();
    let (of, name, unit) = match target {
        Target::Tension(i) => {
            (Commanded::Tension(i), format!("{}.tension", cable(i)), unit_of(FORCE, unit, options)?)
        }
        Target::Shortening(i) => {
            let unit = unit_of(SHORT, unit, options)?;
            (Commanded::Shortening(i), format!("{}.shortening", cable(i)), unit)
        }
        Target::Cable(i) => {
            if unit.is_none() {
                let message = format!(
                    "it is not clear what the column `{}` tells the cable",
                    quoted(cable(i))
                );
                let help = format!(
                    "give it a unit, `{0} [N]` for a tension or `{0} [mm]` for a shortening; or write `{0}.tension` or `{0}.shortening` for numbers in SI units",
                    cable(i)
                );
                return Err((message, help));
            }
            let of_both = [Dimension::Force, Dimension::Length, Dimension::Ratio];
            let unit = unit_of(&of_both, unit, options)?;
            match unit.dimension {
                Dimension::Force => (Commanded::Tension(i), format!("{}.tension", cable(i)), unit),
                _ => (Commanded::Shortening(i), format!("{}.shortening", cable(i)), unit),
            }
        }
        Target::Motor(i) => {
            let Motor { name, drive, .. } = &robot.motors[i];
            let dimension = match drive {
                Drive::Spool { .. } => Dimension::Angle,
                Drive::Linear => Dimension::Length,
            };
            let unit = unit_of(&[dimension], unit, options)?;
            (Commanded::Motor(i), format!("{name}.{}", drive.keys().command), unit)
        }
    };
    Ok(Column::Command { of, name, unit })
}

/// The unit of a column: its own, else that of `units`, else that of SI.
fn unit_of(
    dimensions: &[Dimension],
    own: Option<&str>,
    options: &Options<'_>,
) -> Result<Unit, Refusal> {
    let find = |unit: &str| dimensions.iter().copied().find(|d| d.find(unit).is_some());
    let Some(own) = own else {
        let of_file = options.units.iter().find_map(|unit| Some((*unit, find(unit)?)));
        return Ok(match of_file {
            Some((unit, dimension)) => Unit { name: Some(unit.to_owned()), dimension },
            None => Unit { name: None, dimension: dimensions[0] },
        });
    };
    Unit::named(own, dimensions).map_err(|(message, help)| {
        match COUNTS.contains(&own.to_lowercase().as_str()) {
            true => (message, OF_COUNTS.to_owned()),
            false => (message, help),
        }
    })
}

/// What logs call the numbers of an encoder.
const COUNTS: [&str; 8] = ["count", "counts", "tick", "ticks", "step", "steps", "pulse", "pulses"];

const OF_COUNTS: &str = "counts of an encoder have no unit: leave it out, and give the motor a `gear_ratio` in counts per radian of its spool";

/// A column that nothing knows.
fn unknown(name: &str, bare: &str, options: &Options<'_>, robot: &CommandedRobot<'_>) -> Refusal {
    let owners = robot.motors.iter().map(|motor| motor.name.as_str());
    let owners = owners.chain(robot.cables.iter().map(|cable| cable.name.as_str()));
    let known: Vec<&str> =
        owners.chain(["time", options.group, "measured"]).chain(options.key).collect();
    let message = format!("there is no motor, cable or other column `{}`", quoted(name));
    let owner = bare.rsplit_once(['.', '_', ' ']).map_or(bare, |(owner, _)| owner);
    // `bend_deg`, with the unit as a part of the name.
    let with_unit = bare.rsplit_once('_').and_then(|(owner, unit)| {
        Dimension::ALL.into_iter().find(|d| d.find(unit).is_some())?;
        target(owner, robot).map(|_| format!("write `{owner} [{unit}]`"))
    });
    // `x_mm` of a tracker, in the table that is that of the measurements as well.
    let with_unit = with_unit.or_else(|| {
        let (owner, unit) = bare.rsplit_once('_')?;
        let is_length = Dimension::Length.find(unit).is_some();
        (options.is_measured(owner, owner) && is_length)
            .then(|| format!("write `{owner} [{unit}]`"))
    });
    let near = || {
        suggest::nearest(bare, known.iter().copied())
            .or_else(|| suggest::nearest(owner, known.iter().copied()))
    };
    let help = if let Some(help) = with_unit {
        help
    } else if let Some(near) = near() {
        format!(
            "did you mean `{near}`? Columns that are not to be read are named in `ignore` of [commands]"
        )
    } else {
        let names = listed(known.iter().take(12).copied(), "and");
        format!(
            "columns are named {names}; those that are not to be read are named in `ignore = [\"{}\"]` of [commands]",
            quoted(bare)
        )
    };
    (message, help)
}

/// Refuses columns for what has a command of its own, and for cables whose motor has one.
fn conflicts(
    grid: &Grid,
    columns: &[Column],
    robot: &CommandedRobot<'_>,
    document: &Node,
    problems: &mut Problems,
) {
    let motor_of = |cable: usize| {
        robot.motors.iter().position(|motor| motor.cables.iter().any(|of| of.cable == cable))
    };
    let has = |wanted: Commanded| {
        columns.iter().any(|column| matches!(column, Column::Command { of, .. } if *of == wanted))
    };
    for (column, cell) in columns.iter().zip(&grid.columns) {
        if let Column::Load { name, .. } = column {
            let path = format!("loads.{}", name.split('.').next().unwrap_or_default());
            if document.find(&path).is_some() {
                let related = Some((document.locate(&path).span, "the robot file gives it here"));
                let message =
                    format!("`{}` is given in the table and in the robot file", quoted(name));
                problems.push_related(cell.span, related, || {
                    problem(
                        message,
                        "leave it out of the robot file, or name the column in `ignore` of [commands]",
                    )
                });
            }
        }
        let Column::Command { of, name, .. } = column else { continue };
        let own = match *of {
            Commanded::Motor(i) => robot
                .own_motors
                .get(i)
                .copied()
                .flatten()
                .map(|_| format!("motors[{i}].{}", robot.motors[i].drive.keys().command)),
            Commanded::Tension(i) => {
                robot.own_cables[i].tension.map(|_| format!("cables[{i}].tension"))
            }
            Commanded::Shortening(i) => {
                robot.own_cables[i].shortening.map(|_| format!("cables[{i}].shortening"))
            }
        };
        if let Some(path) = own {
            let related = Some((document.locate(&path).span, "the robot file gives it here"));
            let message = format!("`{}` is given in the table and in the robot file", quoted(name));
            problems.push_related(cell.span, related, || {
                problem(
                    message,
                    "leave it out of the robot file, or name the column in `ignore` of [commands]",
                )
            });
        }
        if let Commanded::Shortening(cable) = *of
            && let Some(motor) = motor_of(cable)
            && (has(Commanded::Motor(motor))
                || robot.own_motors.get(motor).is_some_and(Option::is_some))
        {
            let message = format!(
                "`{}` and the motor `{}` both pull this cable",
                quoted(name),
                quoted(&robot.motors[motor].name)
            );
            problems.push(cell.span, || {
                problem(
                    message,
                    "leave out one of the columns, or name it in `ignore` of [commands]",
                )
            });
        }
    }
}

/// Refuses a table that does not say what each motor and cable does.
fn missing(grid: &Grid, columns: &[Column], robot: &CommandedRobot<'_>, problems: &mut Problems) {
    if !problems.is_empty() {
        return;
    }
    let commanded = || {
        columns.iter().filter_map(|column| match column {
            Column::Command { of, .. } => Some(*of),
            _ => None,
        })
    };
    if commanded().next().is_none() {
        problems.push(grid.header, || problem("no column commands a cable or a motor", HEADER));
        return;
    }
    for (i, motor) in robot.motors.iter().enumerate() {
        let own = robot.own_motors.get(i).copied().flatten().is_some();
        let by_cables = |of: Commanded| match of {
            Commanded::Motor(motor) => motor == i,
            Commanded::Tension(cable) | Commanded::Shortening(cable) => {
                motor.cables.iter().any(|of| of.cable == cable)
            }
        };
        if !own && !commanded().any(by_cables) {
            let (key, unit) = match motor.drive {
                Drive::Spool { .. } => ("angle", "deg"),
                Drive::Linear => ("travel", "mm"),
            };
            let name = &motor.name;
            let message = format!("there is no column for the motor `{}`", quoted(name));
            let help = format!(
                "add a column `{name} [{unit}]`, or give the motor an `{key}` in [[motors]], which all rows then have"
            );
            problems.push(grid.header, || problem(message, help));
        }
    }
    for (i, cable) in robot.cables.iter().enumerate() {
        let own = robot.own_cables[i].tension.is_some() || robot.own_cables[i].shortening.is_some();
        let has_motor =
            robot.motors.iter().any(|motor| motor.cables.iter().any(|of| of.cable == i));
        let given = commanded()
            .any(|of| matches!(of, Commanded::Tension(c) | Commanded::Shortening(c) if c == i));
        if !own && !has_motor && !given {
            let name = &cable.name;
            let message = format!("there is no column for the cable `{}`", quoted(name));
            let help = format!(
                "add a column `{name} [N]` or `{name} [mm]`, or give the cable a `tension` or `shortening` in [[cables]], which all rows then have"
            );
            problems.push(grid.header, || problem(message, help));
        }
    }
}
