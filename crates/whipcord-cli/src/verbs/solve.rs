//! `whipcord solve`: the shape of one robot under one case.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, RangedU64ValueParser, TypedValueParser as _};
use clap::{Args, ValueEnum};
use whipcord::{Drive, Model, ModelKind, Solution, Statics, Stations, Vec3};
use whipcord_io::{CaseFile, shape_csv, solution_json};
use whipcord_plot::{FigureOptions, RobotView, robot_figure};

use crate::comparison::figures::{FINE_STATIONS, before};
use crate::failure::Failure;
use crate::files;
use crate::inputs::read_one;
use crate::quantity::{degrees, fixed, fixed_millimetres, newtons, number, percent};
use crate::style::Style;
use crate::table::{Align, Table};
use crate::timing::{self, TimedSolution, duration};
use crate::words::driven_by;

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
    /// Give the shape at N equally spaced places, both ends included; by default at the disks
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
}

/// What drives all cables.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Actuation {
    /// Their tensions
    Tension,
    /// Their shortenings
    Shortening,
}

/// More stations than anyone draws; what is beyond is a slip of the finger.
const MOST_STATIONS: u64 = 1_000_000;

fn model_parser() -> impl clap::builder::TypedValueParser<Value = ModelKind> {
    PossibleValuesParser::new(ModelKind::ALL.map(ModelKind::name))
        .try_map(|name| name.parse::<ModelKind>())
}

fn stations_parser() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(2..=MOST_STATIONS)
}

fn picture_path(text: &str) -> Result<PathBuf, String> {
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
    let stations = args.stations.map_or(Stations::Disks, Stations::Equal);
    let drive = match args.actuation {
        None => Drive::Natural,
        Some(Actuation::Tension) => Drive::Tension,
        Some(Actuation::Shortening) => Drive::Shortening,
    };
    let model = Model::new(args.model, stations, drive);
    let timed = timing::solve(&model, &file.robot, &file.case)
        .map_err(|error| Failure::from_solve(&args.file, &error))?;
    let solution = &timed.solution;
    if let Some(path) = &args.plot {
        plot(path, &file, solution, drive)?;
    }
    if args.json {
        let json = solution_json(&file.title, solution, timed.solve.median);
        Ok(format!("{}\n", json.map_err(|error| files::no_result(&error))?))
    } else if args.csv {
        shape_csv(&solution.shape).map_err(|error| files::no_result(&error))
    } else {
        Ok(summary(&file, &timed, drive, args.plot.as_deref(), style))
    }
}

fn plot(path: &Path, file: &CaseFile, solution: &Solution, drive: Drive) -> Result<(), Failure> {
    let fine = Model::new(solution.model, Stations::Equal(FINE_STATIONS), drive)
        .solve(&file.robot, &file.case)
        .map_err(|error| Failure::from_solve(&file.path, &error))?;
    let views = [before(&file.robot), RobotView::model(solution.model.name(), &fine)];
    let measured = file.measured.as_ref();
    let options = FigureOptions {
        title: file.title.clone(),
        measured: measured.map_or_else(Vec::new, |m| m.disks.iter().map(|d| d.position).collect()),
        ..FigureOptions::default()
    };
    let svg = robot_figure(&file.robot, &views, &options)
        .map_err(|error| files::plot_failure(path, &error))?;
    files::write(path, &files::picture(&svg, path)?)
}

fn summary(
    file: &CaseFile,
    timed: &TimedSolution,
    drive: Drive,
    plot: Option<&Path>,
    style: Style,
) -> String {
    let TimedSolution { solution, solve, build } = timed;
    let tip = solution.disks.tip();
    let [x, y, z] = tip.position.to_array().map(|c| fixed_millimetres(c, 3));
    let tangent = tip.rotation.rotate(Vec3::Z);
    let bend = tangent.x.hypot(tangent.y).atan2(tangent.z);
    let towards = if bend > 1e-9 {
        format!(", towards {}", degrees(tangent.y.atan2(tangent.x)))
    } else {
        String::new()
    };
    let quaternion = tip.rotation.wxyz().map(|c| fixed(c, 6)).join(", ");
    let driver = driven_by(solution.model, drive, &file.case);

    let mut text = format!("{}\n", style.heading(&file.title));
    text += &format!("{}, driven by {driver}\n\n", solution.model);
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<11}")));
    };
    line("tip", format!("({x}, {y}, {z}) mm"));
    line("bend", format!("{}{towards}", degrees(bend)));
    line("orientation", format!("({quaternion}) as w, x, y, z"));
    text.push('\n');
    text += &cables(solution).text(style);
    text += &format!("\n{}\n", diagnostics(solution));
    let repeats = match solve.repeats {
        1 => String::from("one cold solve"),
        n => format!("median of {n} cold solves"),
    };
    text += &format!(
        "solve time {} ({repeats}; building the model took {})\n",
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
        parts.push(format!("estimated error {} m", number(error, 2)));
    }
    if let Some(stability) = diagnostics.stability {
        parts.push(format!("stability {}", number(stability, 3)));
    }
    parts.join(", ")
}
