//! `whipcord reach` along a path.

use std::io::{self, Write as _};
use std::path::Path;

use whipcord::Model;
use whipcord_inverse::{
    Followed, InverseSolver, JumpKind, PathPoint, ReachOptions, ReachStatus, Tolerance,
};
use whipcord_io::{CaseFile, follow_json, path_table, warnings_json};

use super::reach_picture::{draw_path, film_path};
use super::reach_words::command;
use crate::inverse::failure;
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::{millimetres, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// A path and how it is to be followed.
pub struct Task<'a> {
    pub file: &'a CaseFile,
    pub path: &'a [PathPoint],
    pub tolerance: Tolerance,
    pub options: &'a ReachOptions,
    /// Whether points that are not reached have the nearest commands.
    pub nearest: bool,
    pub json: bool,
    pub plot: Option<&'a Path>,
    pub film: Option<&'a Path>,
    /// File for the commands.
    pub output: Option<&'a Path>,
}

/// Follows the path, and returns what standard output shows.
pub fn run(
    task: &Task<'_>,
    solver: &mut InverseSolver,
    model: &Model,
    style: Style,
) -> Result<String, Failure> {
    let &Task { file, path, tolerance, options, .. } = task;
    let format = task.output.map(Format::of).transpose()?;
    let followed = solver.follow(path, options).map_err(|error| failure(file, &error))?;
    if followed.reached() < path.len() && !task.nearest {
        return Err(Failure::Solve(not_followed(task, &followed)));
    }
    for words in jumps(&followed) {
        // A closed standard error is no reason to fail.
        let _ = writeln!(io::stderr().lock(), "warning: {}: {words}", file.path.display());
    }
    let (at, along) = ((file, model), (path, &followed));
    let mut written: Vec<(&str, &Path, Vec<u8>)> = Vec::new();
    if let Some(out) = task.plot {
        written.push(("picture", out, draw_path(out, at, along)?));
    }
    if let Some(out) = task.film {
        written.push(("film", out, film_path(out, at, along)?));
    }
    let json = || -> Result<String, Failure> {
        let json = follow_json(&file.title, &file.robot, solver, tolerance, path, &followed);
        let mut json = json.map_err(|error| files::no_result(&error))?;
        json["warnings"] = warnings_json(file, &file.warnings());
        Ok(format!("{json:#}\n"))
    };
    if let (Some(out), Some(format)) = (task.output, format) {
        let table = || path_table(&file.robot, solver, path, &followed);
        let bytes = match format {
            Format::Json => json()?.into_bytes(),
            Format::Csv => table().to_csv().map_err(|error| files::no_result(&error))?.into_bytes(),
            Format::Parquet => table().to_parquet().map_err(|error| files::no_result(&error))?,
        };
        written.push(("commands", out, bytes));
    }
    let text = if task.json {
        json()?
    } else {
        let mut text = summary(task, solver, &followed, style);
        for (what, out, _) in &written {
            text += &format!("{what}: {}\n", out.display());
        }
        text
    };
    // What can fail has been done: now the files are written, or there are none.
    for (_, out, bytes) in written {
        files::write(out, &bytes)?;
    }
    Ok(text)
}

/// How the commands of a path are written.
#[derive(Clone, Copy)]
enum Format {
    Csv,
    Parquet,
    Json,
}

impl Format {
    fn of(out: &Path) -> Result<Self, Failure> {
        let extension = out.extension().map(|extension| extension.to_ascii_lowercase());
        match extension.as_deref().and_then(|extension| extension.to_str()) {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            Some("json") => Ok(Self::Json),
            _ => Err(Failure::Input(format!(
                "error: {}: the commands of a path are written as .csv, .parquet or .json",
                out.display()
            ))),
        }
    }
}

/// The commands at each time, for people.
fn summary(task: &Task<'_>, solver: &InverseSolver, followed: &Followed, style: Style) -> String {
    let robot = &task.file.robot;
    let mut columns = vec![("time".to_owned(), Align::Right)];
    for actuator in solver.actuators() {
        columns.push((command(robot, *actuator, 0.0).0.to_owned(), Align::Right));
    }
    columns.push(("error".to_owned(), Align::Right));
    columns.push((String::new(), Align::Left));
    let mut table = Table::new(columns);
    table.group();
    for (k, (point, answer)) in task.path.iter().zip(&followed.answers).enumerate() {
        let mut row = vec![format!("{} s", number(point.time, 6))];
        let commands = solver.actuators().iter().zip(&answer.commands);
        row.extend(commands.map(|(actuator, value)| command(robot, *actuator, *value).1));
        row.push(format!("{} mm", number(1e3 * answer.miss.position, 3)));
        let jump = followed.jumps.iter().find(|jump| jump.point == k);
        row.push(match (answer.status, jump) {
            (ReachStatus::Reached, None) => String::new(),
            (ReachStatus::Reached, Some(_)) => "jump".to_owned(),
            (_, None) => "not reached".to_owned(),
            (_, Some(_)) => "not reached, jump".to_owned(),
        });
        table.row(row);
    }
    let mut text = format!("{}\n", style.heading(&task.file.title));
    let model =
        followed.answers.first().map_or_else(String::new, |of| of.solution.model.to_string());
    text += &format!("{model}: {} of {} points reached\n\n", followed.reached(), task.path.len());
    text += &table.text(style);
    for words in jumps(followed) {
        text += &format!("{words}\n");
    }
    let solves: usize = followed.answers.iter().map(|answer| answer.solves).sum();
    text + &format!("\n{solves} solves\n")
}

fn jumps(followed: &Followed) -> Vec<String> {
    let words = |jump: &whipcord_inverse::Jump| {
        let what = match jump.kind {
            JumpKind::Commands => "the commands jump",
            JumpKind::Shape => "the robot snaps into another shape",
        };
        let (point, distance) = (jump.point + 1, millimetres(jump.distance));
        format!("{what} between points {} and {point} of the path, by {distance}", jump.point)
    };
    followed.jumps.iter().map(words).collect()
}

/// What standard error says of a path that is not followed to its end.
fn not_followed(task: &Task<'_>, followed: &Followed) -> String {
    let missed: Vec<(usize, f64)> = followed
        .answers
        .iter()
        .enumerate()
        .filter(|(_, answer)| answer.status != ReachStatus::Reached)
        .map(|(k, answer)| (k + 1, answer.miss.position))
        .collect();
    let mut text = format!(
        "error: {}: {} of {} points of the path are not reached\n",
        task.file.path.display(),
        missed.len(),
        task.path.len()
    );
    if let Some((first, distance)) = missed.first() {
        text += &format!("  the first is point {first}, {} away\n", millimetres(*distance));
    }
    if let Some((worst, distance)) = missed.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        text += &format!("  the farthest is point {worst}, {} away\n", millimetres(*distance));
    }
    for words in jumps(followed) {
        text += &format!("  {words}\n");
    }
    text + "  help: --nearest prints the nearest commands with exit status 0; give more time where rates are limited, or change the limits or the path"
}
