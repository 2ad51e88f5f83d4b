//! `[commands]`: a table whose rows are the steps of actuation.

mod columns;
mod rows;

use std::path::{Path, PathBuf};

use whipcord::{Cable, CableCommand, Loads, Motor};

use super::table::{self, same_file};
use crate::check::Fields;
use crate::error::{FileProblem, Problems};
use crate::node::{Node, Value};
use crate::source::{Sources, Span};

/// The rows of the table that `[commands]` names. Each is a step of the case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommandTable {
    /// The file they were read from.
    pub path: PathBuf,
    /// The column that names each row, where there is one.
    pub key: Option<String>,
    /// The columns, as the file names them.
    pub columns: Vec<String>,
    /// The commands that columns give, with the unit in which the file gives them.
    pub commands: Vec<CommandColumn>,
    /// The rows, in the order of the file.
    pub rows: Vec<CommandRow>,
}

/// A column of commands.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandColumn {
    /// The name of the cable or motor, with `tension`, `shortening`, `angle` or `travel`.
    pub name: String,
    /// What it commands.
    pub of: Commanded,
}

/// What a column commands: the number of a cable or motor, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commanded {
    /// The tension of a cable.
    Tension(usize),
    /// The shortening of a cable.
    Shortening(usize),
    /// The angle or travel of a motor.
    Motor(usize),
}

/// What a row says beside its commands.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandRow {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Its name, where there is a column of them.
    pub key: Option<String>,
    /// When it was, in s.
    pub time: Option<f64>,
    /// The group that it belongs to.
    pub group: Option<String>,
    /// Whether the robot was measured; else the row only leads to those after it.
    pub is_measured: bool,
}

impl CommandTable {
    /// How a row, from 0, is called in tables for people: its name or its line.
    #[must_use]
    pub fn label(&self, row: usize) -> String {
        match self.rows.get(row) {
            Some(CommandRow { key: Some(key), .. }) => key.clone(),
            Some(CommandRow { line, .. }) => format!("line {line}"),
            None => format!("row {}", row + 1),
        }
    }
}

/// The robot that the commands are for.
pub(crate) struct CommandedRobot<'a> {
    pub cables: &'a [Cable],
    pub motors: &'a [Motor],
    /// Commands that cables and motors have of their own.
    pub own_cables: &'a [CableCommand],
    pub own_motors: &'a [Option<f64>],
    /// The loads of the robot file.
    pub loads: &'a Loads,
}

/// The steps that a table makes.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub table: CommandTable,
    pub steps: Vec<Vec<CableCommand>>,
    pub motors: Vec<Vec<Option<f64>>>,
    /// The loads of each row; empty where no column gives any.
    pub loads: Vec<Loads>,
    /// Where each row stands.
    pub spans: Vec<Span>,
}

/// What the first line of the file must be.
pub(super) const HEADER: &str = "the first line names the columns: a cable or a motor with its unit, such as `pull [N]` or `bend [deg]`; then follows one line for each step";

/// Whether each step starts from the robot at rest, as `[commands]`, the table at `node`, says. Where the robot remembers, the
/// file must say it.
pub(crate) fn are_independent(
    fields: &Fields,
    document: &Node,
    robot: &CommandedRobot<'_>,
    problems: &mut Problems,
) -> bool {
    match fields.text("each") {
        Some(each) => each == "independent",
        None => {
            let remembers = if robot.cables.iter().any(Cable::has_friction) {
                Some("cables have friction")
            } else if robot.motors.iter().any(|motor| motor.backlash > 0.0) {
                Some("motors have backlash")
            } else if document.find("backbone.yield_moment").is_some() {
                Some("the backbone has a yield moment")
            } else {
                None
            };
            if let Some(why) = remembers {
                problems.push(document.locate("commands").span, || FileProblem::Measured {
                    message: format!("[commands] must say how rows follow one another, because {why}"),
                    help: "write `each = \"in order\"` where the robot went from row to row, or `each = \"independent\"` where it was released before each row".into(),
                });
            }
            true
        }
    }
}

/// Names of the markers in `[measured]`, and of the columns that it does not read, where it names the same file.
fn measured<'d>(document: &'d Node, path: &Path, sources: &Sources) -> Option<Vec<&'d str>> {
    let text = |path: &str| match document.find(path) {
        Some(Node { span, value: Value::Text(text) }) => Some((*span, text.as_str())),
        _ => None,
    };
    let (span, named) = text("measured.table").or_else(|| text("measured.disks"))?;
    let of_measured = sources.resolve(span.file, named);
    if !same_file(&of_measured, path) {
        return None;
    }
    let texts = |list: &'static str, key: &'static str| {
        let each = (0..).map(move |i| document.find(&format!("measured.{list}[{i}]{key}")));
        each.map_while(|node| node).filter_map(|node| match &node.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        })
    };
    Some(texts("markers", ".name").chain(texts("ignore", "")).collect())
}

/// Reads the table that `[commands]` names; `None` where it is refused.
pub(crate) fn read(
    fields: &Fields,
    document: &Node,
    robot: &CommandedRobot<'_>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Rows> {
    let named = document.locate("commands.table").span;
    let path = sources.resolve(named.file, fields.text("table")?);
    let grid = table::read(&path, Some(named), HEADER, sources, problems)?;
    let options = columns::Options::of(fields, measured(document, &path, sources));
    let columns = columns::columns(&grid, &options, robot, document, problems)?;
    let text = sources.get(grid.header.file).and_then(|source| source.text.as_deref());
    rows::rows(&grid, &columns, robot, text.unwrap_or_default(), problems).map(|rows| Rows {
        table: CommandTable { path, key: options.key.map(str::to_owned), ..rows.table },
        ..rows
    })
}
