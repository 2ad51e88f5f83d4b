//! `whipcord solve`: the shape of one robot under one case.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::RangedU64ValueParser;
use whipcord::{Actuation, Model, NoStability, Shape, Solution, Stations};
use whipcord_estimation::observation::measured_in_world;
use whipcord_io::{Beside, CaseFile, Measured, answer_json, shape_csv, steps_csv, warnings_json};
use whipcord_plot::{Acting, FINE_STATIONS, FigureOptions, RobotView, label, robot_figure};

use crate::inputs::{Settings, read_one};
use crate::model_arguments::ModelArguments;
use crate::path_argument::path_ending_in;
use crate::paths;
use crate::rubbing;
use crate::warnings::Warnings;
use whipcord_study::bending_friction;
use whipcord_study::contacts;
use whipcord_study::describe::{compromise, driven_by, instability};
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::motors;
use whipcord_study::quantity::{degrees, fixed, fixed_millimetres, newtons, number, percent};
use whipcord_study::steps;
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};
use whipcord_study::timing::{self, TimedSolution, duration};
use whipcord_study::warnings::about_answers;

/// Solve one case with one model
///
/// Prints a summary in mm and degrees, or with --json or --csv all results in SI units. If no
/// solution is found, standard error gives the reason and standard output stays empty.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: ModelArguments,
    /// Number of equally spaced stations of the shape, 2 to 100000, both ends included; by default
    /// the shape is given at the disks
    #[arg(long, value_name = "N", value_parser = stations_parser())]
    stations: Option<usize>,
    /// Print one JSON object
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the shape as CSV
    #[arg(long)]
    csv: bool,
    /// Draw the robot before and after actuation; the name ends in .svg or .png
    #[arg(long, value_name = "OUT", value_parser = path_ending_in(&["svg", "png"]))]
    plot: Option<PathBuf>,
    /// List all equilibria connected to the unloaded shape, stable and unstable
    #[arg(long, conflicts_with_all = ["csv", "max_iterations"])]
    branches: bool,
    /// Where prescribed cable lengths contradict each other, give the stable shape that misses them least (least squares), with what each cable
    /// misses; by default that is an error
    #[arg(long)]
    least_squares_lengths: bool,
    /// Show the iterations on standard error
    #[arg(long)]
    trace: bool,
    #[command(flatten)]
    warnings: Warnings,
}

/// Each station ends an integration step, so that many of them take long; this many take seconds.
const MOST_STATIONS: u64 = 100_000;

/// More shapes than this hide one another in a picture: then only the last is drawn.
const MOST_STEPS_DRAWN: usize = 6;

fn stations_parser() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(2..=MOST_STATIONS)
}

/// Solves and returns what standard output shows.
pub fn run(args: &SolveArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    let model = args.model.model()?;
    let mut warnings = file.warnings();
    // Before the solve: what is wrong with the file may be why there is no answer.
    args.warnings.tell(&file, &warnings)?;
    let trace = if args.trace { Some(paths::trace(&model, &file)?) } else { None };
    if let Some(events) = &trace {
        let text = paths::trace_text(events, Style::for_stderr());
        // A closed standard error is no reason not to solve.
        let _ = io::stderr().lock().write_all(text.as_bytes());
    }
    let solve = match args.least_squares_lengths {
        true => timing::solve_in_least_squares,
        false => timing::solve,
    };
    let mut timed = solve(&model, &file.robot, &file.case)
        .map_err(|(step, error)| Failure::from_step(&file, &error, step))?;
    let of_answer = about_answers(&file, &(model.clone(), timed.answers()));
    args.warnings.tell(&file, &of_answer)?;
    warnings.extend(of_answer);
    // Stations and picture follow the answer: it is the same whatever is shown of it.
    if let Some(count) = args.stations {
        let stations = model.at(Stations::Equal(count));
        let shapes = timed.shapes_at_stations_of(&stations, &file.robot, &file.case);
        let shapes: Option<Vec<Shape>> = shapes.into_iter().collect();
        let missed = timed.answers().iter().any(|of| !of.diagnostics.length_misses.is_empty());
        let shapes = shapes.or_else(|| {
            // The shape of least squares is not found by a plain solve.
            let again = || solve(&stations, &file.robot, &file.case).ok();
            let of = missed.then(again).flatten()?;
            Some(of.answers().into_iter().map(|answer| answer.shape.clone()).collect())
        });
        let Some(shapes) = shapes else {
            let path = file.path.display();
            return Err(Failure::Solve(format!(
                "error: {path}: there is an answer, but with {count} stations none was found near it: \
                 leave out --stations, or give other stations"
            )));
        };
        give(&mut timed, shapes);
    }
    let picture = match &args.plot {
        Some(path) => Some(draw(path, &file, &timed, &model)?),
        None => None,
    };
    let plot = args.plot.as_deref().zip(picture.as_ref().map(|picture| picture.lacks.as_slice()));
    if let Some((_, lacks)) = plot
        && (args.json || args.csv)
    {
        for lack in lacks {
            let _ = writeln!(io::stderr().lock(), "picture: {lack}");
        }
    }
    let branches = if args.branches {
        let stations = args.stations.map_or(Stations::Disks, Stations::Equal);
        Some(paths::branches(&model.at(stations), &file)?)
    } else {
        None
    };
    let solution = &timed.solution;
    let text = if args.json {
        let answers: Vec<_> = timed.steps.iter().map(|(step, time)| (step, *time)).collect();
        let beside = Beside {
            steps: &answers,
            branches: branches.as_ref(),
            trace: trace.as_deref(),
            robot: Some(&file.robot),
            case: Some(&file.case),
        };
        let json = answer_json(&file.title, solution, timed.solve.median, &beside);
        let mut json = json.map_err(|error| files::no_result(&error))?;
        json["warnings"] = warnings_json(&file, &warnings);
        format!("{json}\n")
    } else if args.csv {
        let csv = match timed.steps.as_slice() {
            [] => shape_csv(&solution.shape),
            steps => steps_csv(steps.iter().map(|(step, _)| &step.shape)),
        };
        csv.map_err(|error| files::no_result(&error))?
    } else {
        let branches = branches.as_ref().map(|b| paths::branches_text(b, style));
        let summary = summary(&file, &timed, args.model.actuation(), plot, style);
        branches.map_or_else(|| summary.clone(), |branches| format!("{summary}\n{branches}"))
    };
    // What can fail has been done: now the picture is written, or there is neither.
    if let (Some(path), Some(picture)) = (&args.plot, picture) {
        files::write(path, &picture.bytes)?;
    }
    Ok(text)
}

/// A picture to be written.
struct Picture {
    bytes: Vec<u8>,
    /// What it does not show, or not well, in words.
    lacks: Vec<String>,
}

/// What is said of a picture that is not smooth.
const COARSE: &str =
    "drawn through the places of the answer alone, as none was found near it with more";

/// Gives each answer a shape.
fn give(timed: &mut TimedSolution, shapes: Vec<Shape>) {
    if let Some(last) = shapes.last() {
        timed.solution.shape.clone_from(last);
    }
    for ((solution, _), shape) in timed.steps.iter_mut().zip(shapes) {
        solution.shape = shape;
    }
}

fn draw(
    path: &Path,
    file: &CaseFile,
    timed: &TimedSolution,
    model: &Model,
) -> Result<Picture, Failure> {
    let smooth = model.at(Stations::Equal(FINE_STATIONS));
    let shapes = timed.shapes_at_stations_of(&smooth, &file.robot, &file.case);
    let is_smooth = shapes.iter().all(Option::is_some);
    let mut timed = timed.clone();
    let answers: Vec<Shape> = match timed.steps.as_slice() {
        [] => vec![timed.solution.shape.clone()],
        steps => steps.iter().map(|(step, _)| step.shape.clone()).collect(),
    };
    let drawn = shapes.into_iter().zip(answers).map(|(shape, answer)| shape.unwrap_or(answer));
    give(&mut timed, drawn.collect());
    let TimedSolution { solution, steps, .. } = &timed;
    let view =
        |name: String, solution: &Solution| RobotView::model(label(name, solution), solution);
    let mut views = vec![RobotView::at_rest(&file.robot, file.case.base)];
    if steps.len() > MOST_STEPS_DRAWN || steps.is_empty() {
        views.push(view(solution.model.to_string(), solution));
    } else {
        let named = steps.iter().enumerate();
        views.extend(named.map(|(i, (step, _))| view(format!("step {}", i + 1), step)));
    }
    let mut lacks = Vec::new();
    if !is_smooth {
        lacks.push(COARSE.to_owned());
    }
    let (robot, case) = (&file.robot, &file.case);
    let measured = file.measured.as_ref().map_or(
        Ok(Vec::new()),
        |Measured { observations, alignment, .. }| {
            let answers = timed.answers();
            measured_in_world(model.kind(), robot, case, &answers, observations, *alignment)
        },
    );
    let measured = measured.unwrap_or_else(|error| {
        lacks.push(format!("without what was measured: {error}"));
        Vec::new()
    });
    let options = FigureOptions {
        title: file.title.clone(),
        measured,
        loads: Acting::on(&file.case, &solution.shape),
        ..FigureOptions::default()
    }
    .among(&file.case.obstacles, Some(solution));
    let svg = robot_figure(&file.robot, &views, &options)
        .map_err(|error| files::plot_failure(path, &error))?;
    Ok(Picture { bytes: files::picture(&svg, path)?, lacks })
}

fn summary(
    file: &CaseFile,
    timed: &TimedSolution,
    actuation: Actuation,
    plot: Option<(&Path, &[String])>,
    style: Style,
) -> String {
    let TimedSolution { solution, solve, build, steps } = timed;
    let tip = solution.disks.tip();
    let [x, y, z] = tip.position.to_array().map(|c| fixed_millimetres(c, 3));
    let (bend, direction) = solution.disks.bend();
    let towards =
        if bend > 1e-9 { format!(", towards {}", degrees(direction)) } else { String::new() };
    let quaternion = tip.rotation.wxyz().map(|c| fixed(c, 6)).join(", ");
    let driver = driven_by(solution.model, actuation, &file.case);

    let mut text = format!("{}\n", style.heading(&file.title));
    if steps.is_empty() {
        text += &format!("{}, driven by {driver}\n\n", solution.model);
    } else {
        let all = steps::table(&file.case, actuation, steps).text(style);
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
        if solution.cables.iter().any(|cable| cable.tension.is_none()) {
            text += &match solution.diagnostics.length_misses.is_empty() {
                true => format!("–: {} computes no tensions\n", solution.model),
                false => String::from("–: not determined, as the cables pull against each other\n"),
            };
        }
    }
    if let Some(table) = motors::table(&file.robot, &file.case, solution) {
        text += &format!("\n{}", table.text(style));
    }
    let rubbing = if steps.is_empty() {
        rubbing::table(std::iter::once(solution))
    } else {
        rubbing::table(steps.iter().map(|(step, _)| step))
    };
    let touching = contacts::table(solution, &file.case.obstacles);
    let grasps = contacts::grasps(solution, &file.case.obstacles);
    let overlaps = contacts::cable_overlaps(&file.robot, solution, &file.case.obstacles);
    let objects = contacts::objects(solution, &file.case.obstacles);
    for table in [rubbing, touching, grasps, objects, overlaps].into_iter().flatten() {
        text += &format!("\n{}", table.text(style));
    }
    text.push('\n');
    if let Some(words) = bending_friction::words(&file.case, solution) {
        text += &format!("{words}\n");
    }
    for words in [compromise(solution, &file.case), instability(solution)].into_iter().flatten() {
        text += &format!("{}\n", style.heading(words));
    }
    text += &format!("{}\n", diagnostics(solution));
    let repeats = match (solve.repeats, steps.len()) {
        (1, 0) => String::from("one cold solve"),
        (n, 0) => format!("median of {n} cold solves"),
        (1, n) => format!("the last of {n} steps"),
        (_, n) => format!("the mean of {n} steps"),
    };
    text += &format!(
        "solve time {} ({repeats}; building the model took {})\n",
        duration(solve.median),
        duration(build.median)
    );
    if let Some((path, lacks)) = plot {
        let lacks: String = lacks.iter().map(|lack| format!(" ({lack})")).collect();
        text += &format!("picture: {}{lacks}\n", path.display());
    }
    text
}

/// The cables of an answer.
pub fn cables(solution: &Solution) -> Table {
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
        // Models that never have any are silent about it.
        None if diagnostics.stability_absent != Some(NoStability::NoEnergy) => {
            parts.extend(diagnostics.stability_absent.map(|reason| reason.words().to_owned()));
        }
        _ => {}
    }
    parts.join(", ")
}
