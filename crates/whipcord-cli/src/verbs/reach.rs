//! `whipcord reach`: the commands that bring the robot to a target.

use std::path::{Path, PathBuf};

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use whipcord::{Model, StabilityAnalysis, Stations, Vec3};
use whipcord_inverse::{
    PathPoint, Preference, ReachOptions, ReachStatus, Reached, Target, Tolerance,
};
use whipcord_io::{CaseFile, load_path, load_shape, reach_json, warnings_json};

use crate::deadline;
use crate::film;
use crate::inputs::read_one;
use crate::inverse::{RobotArguments, failure, keep_atlas, solver};
use crate::path_argument::path_ending_in;
use crate::target_argument::{Axis, Place, PoseArgument, angle, length};
use crate::verbs::reach_path::{self, Task};
use crate::verbs::reach_picture::{draw, points};
use crate::verbs::reach_words::{self as words, Answer};
use whipcord_study::failure::{Failure, message};
use whipcord_study::files;
use whipcord_study::style::Style;

/// Commands that bring the tip to a point, a pose or a direction, or the robot to a shape
///
/// The target is that of [target] in the file, or is given by --tip, --pose, --axis, --shape or --path. Limits of
/// tensions, shortenings and motors are those of [limits], [[cables]] and [[motors]]. If the target is not
/// reached, standard error gives the nearest commands and the distance, and the exit status is 1. The output
/// is in N, mm and degrees, with --json in SI units.
#[derive(Debug, Args)]
pub struct ReachArgs {
    #[command(flatten)]
    robot: RobotArguments,
    /// Point for the tip, such as "40 mm, 0 mm, 120 mm" or "40, 0, 120 mm"; numbers without a unit are in metres
    #[arg(long, value_name = "X,Y,Z", conflicts_with_all = ["pose", "shape"], allow_hyphen_values = true)]
    tip: Option<Place>,
    /// Position and orientation of the tip: a point and a quaternion (w, x, y, z), such as
    /// "40, 0, 120 mm, 0.92, 0, 0.38, 0"
    #[arg(long, value_name = "X,Y,Z,W,X,Y,Z", conflicts_with_all = ["axis", "shape"], allow_hyphen_values = true)]
    pose: Option<PoseArgument>,
    /// Direction of the backbone at the tip, of any length, such as 0,0,1; alone or with --tip
    #[arg(long, value_name = "X,Y,Z", conflicts_with = "shape", allow_hyphen_values = true)]
    axis: Option<Axis>,
    /// CSV or Parquet file with points for disks: columns disk (from 1) and x, y, z with units, as in `x [mm]`
    #[arg(long, value_name = "CSV")]
    shape: Option<PathBuf>,
    /// CSV or Parquet file with points for the tip at times, which are followed within the limits of the rates:
    /// columns t, x, y, z with units, for poses also qw, qx, qy, qz
    #[arg(long, value_name = "CSV", conflicts_with_all = ["tip", "pose", "axis", "shape"])]
    path: Option<PathBuf>,
    /// How far a point may be from its target, such as "0.1 mm"; by default what the file says, or 1e-5 of the
    /// length of the backbone
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    tolerance: Option<f64>,
    /// How far a direction or orientation may be from its target, such as "0.1 deg"
    #[arg(long, value_name = "ANGLE", value_parser = angle)]
    tolerance_angle: Option<f64>,
    /// Print the nearest commands where the target is not reached, with exit status 0
    #[arg(long)]
    nearest: bool,
    /// Where the target is not reached, try to prove that it cannot be: a bound of the distance over all
    /// tensions within the limits. Only for cosserat, without loads and friction, with [limits] tension
    #[arg(long)]
    prove: bool,
    /// Shapes from which the iteration may start, after the commands of the file
    #[arg(long, value_name = "N", default_value_t = ReachOptions::default().starts, value_parser = starts_parser())]
    starts: usize,
    /// Parquet file for the shapes from which the iteration may start: computed and written there by the first run, and read by the next ones of the same robot,
    /// model, loads and limits
    #[arg(long, value_name = "FILE", value_parser = path_ending_in(&["parquet"]))]
    atlas: Option<PathBuf>,
    /// Which of several answers is given; by default what the file says, or the least tension
    #[arg(long, value_name = "WHAT")]
    least: Option<Least>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Draw the robot and the target, along a path the robot at some of its points; the name ends in .svg or .png
    #[arg(long, value_name = "OUT", value_parser = path_ending_in(&["svg", "png"]))]
    plot: Option<PathBuf>,
    /// Film of the robot along a path, with the time of the path; the name ends in .png, for an animated PNG that browsers play, or in .webm,
    /// which the program ffmpeg encodes
    #[arg(long, value_name = "OUT", value_parser = path_ending_in(&film::ENDINGS))]
    film: Option<PathBuf>,
    /// File to write: for one target the robot file with the commands found; for a path its commands, as a table for
    /// [commands] if the name ends in .csv or .parquet, with all that --json prints if it ends in .json
    #[arg(short, long, value_name = "NEW")]
    output: Option<PathBuf>,
}

/// Boxes of tensions that a proof may look at, which take some seconds.
const BOXES: usize = 1_000_000;

/// An atlas has no more shapes.
const MOST_STARTS: u64 = 20_000;

fn starts_parser() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(0..=MOST_STARTS)
}

/// Which of several answers is given.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Least {
    /// The least sum of squared tensions
    Tension,
    /// The nearest to the commands of the file
    Change,
    /// The greatest distance from obstacles
    Clearance,
}

/// Solves, and returns what standard output shows.
pub fn run(args: &ReachArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.robot.file, &args.robot.settings)?;
    if let Some(path) = &args.output {
        files::keep(path, file.files())?;
    }
    let mut warnings = file.warnings();
    args.robot.warnings.tell(&file, &warnings)?;
    let path = path(args, &file)?;
    let target = if path.is_empty() { Some(target(args, &file)?) } else { None };
    let length = file.robot.backbone().length;
    let mut goal = file.goal.clone();
    goal.tolerance = args.tolerance.or(goal.tolerance);
    goal.tolerance_angle = args.tolerance_angle.or(goal.tolerance_angle);
    let tolerance = goal.tolerance(length).unwrap_or_else(|| Tolerance::of_length(length));
    let options = ReachOptions {
        tolerance: Some(tolerance),
        prefer: match args.least {
            Some(Least::Tension) => Preference::LeastTension,
            Some(Least::Change) => Preference::LeastChange,
            Some(Least::Clearance) => Preference::MostClearance,
            None => goal.preference.unwrap_or_default(),
        },
        clearance: goal.least_clearance(),
        starts: args.starts,
        proof: args.prove.then_some(BOXES),
        ..ReachOptions::default()
    };
    let model = Model::new(args.robot.kind, Stations::Disks, whipcord::Actuation::Natural)
        .with_stability(StabilityAnalysis::Eigenvalue)
        .with_tolerance((0.1 * tolerance.position / length).clamp(1e-12, 1e-6));
    let model = args.robot.four_bar.applied_to(model.cancelled_by(&deadline::cancel()))?;
    let mut solver = solver(args.robot.by, &file, &model)?;
    if let Some(path) = &args.atlas {
        files::keep(path, file.files())?;
        keep_atlas(&file, &mut solver, path)?;
    }
    if target.is_some() && args.film.is_some() {
        return Err(Failure::Input("error: --film is for a path".into()));
    }
    if let Some(path) = &args.film {
        film::check(path)?;
    }
    let Some(target) = target else {
        let task = Task {
            file: &file,
            path: &path,
            tolerance,
            options: &options,
            nearest: args.nearest,
            json: args.json,
            plot: args.plot.as_deref(),
            film: args.film.as_deref(),
            output: args.output.as_deref(),
        };
        return reach_path::run(&task, &mut solver, &model, style);
    };
    let reached = solver.reach(&target, &options).map_err(|error| failure(&file, &error))?;
    let mut answered = file.clone();
    answered.case = reached.case.clone();
    let answer =
        Answer { file: &answered, solver: &solver, target: &target, tolerance, reached: &reached };
    if reached.status != ReachStatus::Reached && !args.nearest {
        return Err(Failure::Solve(words::not_reached(&answer)));
    }
    let of_answer = answered.answer_warnings([(None, &reached.solution)]);
    args.robot.warnings.tell(&answered, &of_answer)?;
    warnings.extend(of_answer);
    let picture = match &args.plot {
        Some(path) => Some((path, draw(path, (&answered, &model), &reached, points(&target))?)),
        None => None,
    };
    let written = match &args.output {
        Some(path) => Some((path, new_file(path, &file, &reached)?)),
        None => None,
    };
    let text = if args.json {
        let json = reach_json(&file.title, &file.robot, &solver, tolerance, &reached);
        let mut json = json.map_err(|error| files::no_result(&error))?;
        json["warnings"] = warnings_json(&file, &warnings);
        format!("{json:#}\n")
    } else {
        let mut text = words::summary(&answer, style);
        if let Some((path, _)) = &picture {
            text += &format!("picture: {}\n", path.display());
        }
        if let Some((path, (_, note))) = &written {
            text += &format!("written: {}{note}\n", path.display());
        }
        text
    };
    // What can fail has been done: now the files are written, or there are none.
    if let Some((path, bytes)) = picture {
        files::write(path, &bytes)?;
    }
    if let Some((path, (text, _))) = written {
        files::write(path, text.as_bytes())?;
    }
    Ok(text)
}

/// The path of the command line, else that of the file where the command line has no target.
fn path(args: &ReachArgs, file: &CaseFile) -> Result<Vec<PathPoint>, Failure> {
    if let Some(path) = &args.path {
        return load_path(path).map_err(|error| Failure::Input(message(&error)));
    }
    let has_target =
        args.shape.is_some() || args.tip.is_some() || args.axis.is_some() || args.pose.is_some();
    Ok(if has_target { Vec::new() } else { file.goal.path.clone() })
}

/// The target of the command line, else that of the file.
fn target(args: &ReachArgs, file: &CaseFile) -> Result<Target, Failure> {
    if let Some(path) = &args.shape {
        let disks = file.robot.disks().count();
        let points = load_shape(path, disks).map_err(|error| Failure::Input(message(&error)))?;
        return Ok(Target::Shape(points));
    }
    let point = args.tip.map(|Place(point)| point);
    if let Some(Axis(direction)) = args.axis {
        return Ok(Target::Axis { point, direction });
    }
    if let Some(PoseArgument(pose)) = args.pose {
        return Ok(Target::Pose(pose));
    }
    point.map(Target::Tip).or_else(|| file.goal.target.clone()).ok_or_else(|| {
        Failure::Input(format!(
            "error: {}: there is no target: add [target] to the file, such as tip = [\"40 mm\", \"0 mm\", \"120 mm\"], or give --tip, --pose, --axis, --shape or --path",
            file.path.display()
        ))
    })
}

/// The robot file with the commands found, and what to say of it.
fn new_file(
    path: &Path,
    old: &CaseFile,
    reached: &Reached,
) -> Result<(String, &'static str), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let case = reached.case_beside(&old.robot, &old.case);
    let file = old.with_numbers_of(&old.robot, &case, Vec3::ZERO, folder);
    let file = file.map_err(|error| {
        Failure::Input(format!("error: the commands cannot be written: {error}"))
    })?;
    let note = match file.keeps_text {
        true => "",
        false => " (written anew: without comments, units, [measured], [fit] and [reference])",
    };
    Ok((file.text, note))
}
