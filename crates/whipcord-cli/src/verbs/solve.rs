//! `whipcord solve`: the shape of one robot under one case.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, RangedU64ValueParser, TypedValueParser as _};
use clap::{Args, ValueEnum};
use whipcord::{Drive, Model, ModelKind, Robot, Shape, Solution, Stations};
use whipcord_io::{Beside, CaseFile, answer_json, shape_csv, steps_csv};
use whipcord_plot::{Acting, FINE_STATIONS, FigureOptions, RobotView, robot_figure};

use crate::failure::Failure;
use crate::files;
use crate::inputs::read_one;
use crate::paths;
use crate::quantity::{degrees, fixed, fixed_millimetres, newtons, number, percent};
use crate::rubbing;
use crate::steps;
use crate::style::Style;
use crate::table::{Align, Table};
use crate::timing::{self, TimedSolution, duration};
use crate::words::{driven_by, instability};

/// Solve one case with one model
///
/// Prints a summary for people, or one JSON object or CSV table in SI for programs. When there is no
/// answer, standard error says why and standard output stays empty.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Robot file
    file: PathBuf,
    /// Model
    #[arg(long, value_name = "NAME", default_value = "cosserat", value_parser = model_parser())]
    model: ModelKind,
    /// What drives all cables; by default what the model is driven by, where the file gives it
    #[arg(long, value_name = "WHAT")]
    actuation: Option<Actuation>,
    /// Give the shape at N equally spaced places, 2 to 100000, both ends included; by default at the
    /// disks
    #[arg(long, value_name = "N", value_parser = stations_parser())]
    stations: Option<usize>,
    /// Print one JSON object
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the shape as CSV
    #[arg(long)]
    csv: bool,
    /// Draw the robot before and after actuation; the name ends in .svg or .png
    #[arg(long, value_name = "OUT", value_parser = picture_path)]
    plot: Option<PathBuf>,
    /// List all equilibria under the load that hang together with the unloaded shape, stable or not
    #[arg(long, conflicts_with = "csv")]
    branches: bool,
    /// Show the iterations on standard error
    #[arg(long)]
    trace: bool,
}

/// What drives all cables.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Actuation {
    /// Their tensions
    Tension,
    /// Their shortenings
    Shortening,
}

/// Which command of each cable counts.
pub const fn drive(actuation: Option<Actuation>) -> Drive {
    match actuation {
        None => Drive::Natural,
        Some(Actuation::Tension) => Drive::Tension,
        Some(Actuation::Shortening) => Drive::Shortening,
    }
}

/// Each station ends an integration step, so that many of them take long; this many take seconds.
const MOST_STATIONS: u64 = 100_000;

/// More shapes than this hide one another in a picture: then only the last is drawn.
const MOST_STEPS_DRAWN: usize = 6;

pub fn model_parser() -> impl clap::builder::TypedValueParser<Value = ModelKind> {
    PossibleValuesParser::new(ModelKind::ALL.map(ModelKind::name))
        .try_map(|name| name.parse::<ModelKind>())
}

fn stations_parser() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(2..=MOST_STATIONS)
}

pub fn picture_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("svg" | "png") => Ok(path),
        _ => Err(String::from("the name must end in .svg or .png")),
    }
}

/// Solves and returns what standard output shows.
pub fn run(args: &SolveArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file)?;
    let solved = match &args.plot {
        Some(_) => Stations::Equal(args.stations.map_or(FINE_STATIONS, fine)),
        None => args.stations.map_or(Stations::Disks, Stations::Equal),
    };
    let drive = drive(args.actuation);
    let model = Model::new(args.model, solved, drive);
    let trace = if args.trace { Some(paths::trace(&model, &file)?) } else { None };
    if let Some(events) = &trace {
        let text = paths::trace_text(events, Style::for_stderr());
        // A closed standard error is no reason not to solve.
        let _ = io::stderr().lock().write_all(text.as_bytes());
    }
    let mut timed = timing::solve(&model, &file.robot, &file.case)
        .map_err(|(step, error)| Failure::from_step(&file, &error, step))?;
    let picture = match &args.plot {
        Some(path) => Some((path, draw(path, &file, &timed)?)),
        None => None,
    };
    if picture.is_some() {
        let of_steps = timed.steps.iter_mut().map(|(solution, _)| solution);
        for solution in of_steps.chain([&mut timed.solution]) {
            solution.shape = asked_for(&file.robot, solution, args.stations);
        }
    }
    let branches = if args.branches { Some(paths::branches(&model, &file)?) } else { None };
    let solution = &timed.solution;
    let text = if args.json {
        let answers: Vec<_> = timed.steps.iter().map(|(step, time)| (step, *time)).collect();
        let beside =
            Beside { steps: &answers, branches: branches.as_ref(), trace: trace.as_deref() };
        let json = answer_json(&file.title, solution, timed.solve.median, &beside);
        format!("{}\n", json.map_err(|error| files::no_result(&error))?)
    } else if args.csv {
        let csv = match timed.steps.as_slice() {
            [] => shape_csv(&solution.shape),
            steps => steps_csv(steps.iter().map(|(step, _)| &step.shape)),
        };
        csv.map_err(|error| files::no_result(&error))?
    } else {
        let branches = branches.as_ref().map(|b| paths::branches_text(b, style));
        let summary = summary(&file, &timed, drive, args.plot.as_deref(), style);
        branches.map_or_else(|| summary.clone(), |branches| format!("{summary}\n{branches}"))
    };
    // What can fail has been done: now the picture is written, or there is neither.
    if let Some((path, bytes)) = picture {
        files::write(path, &bytes)?;
    }
    Ok(text)
}

/// Stations that a picture is smooth with and that have `stations` equally spaced ones among them,
/// so that picture and numbers come from one solve.
const fn fine(stations: usize) -> usize {
    let parts = stations - 1;
    parts * (FINE_STATIONS - 1).div_ceil(parts) + 1
}

/// The part of a solution at [`fine`] stations that was asked for: at equally spaced stations, or at
/// the disks.
fn asked_for(robot: &Robot, solution: &Solution, stations: Option<usize>) -> Shape {
    let Some(count) = stations else { return solution.disks.clone() };
    let every = (solution.shape.poses.len() - 1) / (count - 1);
    Shape {
        arc_length: Stations::Equal(count).arc_lengths(robot),
        poses: solution.shape.poses.iter().step_by(every).copied().collect(),
    }
}

fn draw(path: &Path, file: &CaseFile, timed: &TimedSolution) -> Result<Vec<u8>, Failure> {
    let TimedSolution { solution, steps, .. } = timed;
    let view = |name: String, solution: &Solution| {
        let unstable = if solution.diagnostics.is_unstable() { ", unstable" } else { "" };
        RobotView::model(format!("{name}{unstable}"), solution)
    };
    let mut views = vec![RobotView::at_rest(&file.robot, file.case.base)];
    if steps.len() > MOST_STEPS_DRAWN || steps.is_empty() {
        views.push(view(solution.model.to_string(), solution));
    } else {
        let named = steps.iter().enumerate();
        views.extend(named.map(|(i, (step, _))| view(format!("step {}", i + 1), step)));
    }
    let measured = file.measured.as_ref();
    let options = FigureOptions {
        title: file.title.clone(),
        measured: measured.map_or_else(Vec::new, |m| m.disks.iter().map(|d| d.position).collect()),
        loads: Acting::on(&file.case, &solution.shape),
        ..FigureOptions::default()
    };
    let svg = robot_figure(&file.robot, &views, &options)
        .map_err(|error| files::plot_failure(path, &error))?;
    files::picture(&svg, path)
}

fn summary(
    file: &CaseFile,
    timed: &TimedSolution,
    drive: Drive,
    plot: Option<&Path>,
    style: Style,
) -> String {
    let TimedSolution { solution, solve, build, steps } = timed;
    let tip = solution.disks.tip();
    let [x, y, z] = tip.position.to_array().map(|c| fixed_millimetres(c, 3));
    let (bend, direction) = solution.disks.bend();
    let towards =
        if bend > 1e-9 { format!(", towards {}", degrees(direction)) } else { String::new() };
    let quaternion = tip.rotation.wxyz().map(|c| fixed(c, 6)).join(", ");
    let driver = driven_by(solution.model, drive, &file.case);

    let mut text = format!("{}\n", style.heading(&file.title));
    if steps.is_empty() {
        text += &format!("{}, driven by {driver}\n\n", solution.model);
    } else {
        let all = steps::table(&file.case, drive, steps).text(style);
        text += &format!("{}, driven in steps\n\n{all}\nafter the last step:\n", solution.model);
    }
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<11}")));
    };
    line("tip", format!("({x}, {y}, {z}) mm"));
    line("bend", format!("{}{towards}", degrees(bend)));
    line("orientation", format!("({quaternion}) as w, x, y, z"));
    if !solution.cables.is_empty() {
        text += &format!("\n{}", cables(solution).text(style));
    }
    let rubbing = if steps.is_empty() {
        rubbing::table(std::iter::once(solution))
    } else {
        rubbing::table(steps.iter().map(|(step, _)| step))
    };
    if let Some(table) = rubbing {
        text += &format!("\n{}", table.text(style));
    }
    text.push('\n');
    if let Some(words) = instability(solution) {
        text += &format!("{}\n", style.heading(words));
    }
    text += &format!("{}\n", diagnostics(solution));
    let repeats = match (solve.repeats, steps.len()) {
        (1, 0) => String::from("one cold solve"),
        (n, 0) => format!("median of {n} cold solves"),
        (_, n) => format!("the last of {n} steps"),
    };
    let stations = if plot.is_some() { " with the stations of the picture" } else { "" };
    text += &format!(
        "solve time {} ({repeats}{stations}; building the model took {})\n",
        duration(solve.median),
        duration(build.median)
    );
    if let Some(path) = plot {
        text += &format!("picture: {}\n", path.display());
    }
    text
}

fn cables(solution: &Solution) -> Table {
    let mut table = Table::new([
        ("cable", Align::Left),
        ("tension", Align::Right),
        ("length", Align::Right),
        ("shortening", Align::Right),
        ("", Align::Right),
        ("", Align::Left),
    ]);
    table.group();
    for cable in &solution.cables {
        let shortening = cable.initial_length - cable.length;
        table.row(vec![
            cable.name.clone(),
            cable.tension.map_or_else(|| String::from("–"), newtons),
            format!("{} mm", fixed_millimetres(cable.length, 3)),
            format!("{} mm", fixed_millimetres(shortening, 3)),
            percent(shortening / cable.initial_length),
            if cable.slack { String::from("slack") } else { String::new() },
        ]);
    }
    table
}

fn diagnostics(solution: &Solution) -> String {
    let diagnostics = &solution.diagnostics;
    let mut parts = vec![format!("converged: {} steps", diagnostics.steps)];
    if diagnostics.iterations > 0 {
        parts.push(format!("{} iterations", diagnostics.iterations));
    }
    parts.push(format!("residual {}", number(diagnostics.residual, 2)));
    if let Some(error) = diagnostics.discretization_error {
        parts.push(format!("estimated error {} mm", number(error * 1e3, 2)));
    }
    match diagnostics.stability {
        Some(stability) if !diagnostics.is_unstable() => {
            parts.push(format!("stability {}", number(stability, 3)));
        }
        // The geometric model never has any.
        None if solution.model != ModelKind::FourBar => {
            parts.extend(diagnostics.stability_absent.map(|reason| reason.words().to_owned()));
        }
        _ => {}
    }
    parts.join(", ")
}
