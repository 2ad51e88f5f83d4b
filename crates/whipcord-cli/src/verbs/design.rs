//! `whipcord design`: a robot that takes target shapes.

use std::path::{Path, PathBuf};

use clap::Args;
use whipcord::warning::of_case;
use whipcord::{Actuation, Model, ModelKind, Stations, Vec3, Warning};
use whipcord_design::{
    CriterionResult, Design, DesignError, Ended, GoalResult, Quantity, Vary, design, spread,
};
use whipcord_io::{
    CaseFile, DesignShape, DesignTable, DesignTarget, FittedFile, design_json, designed_case,
    is_curve, load_shape, load_tip_path, parse_criterion, parse_curve, warnings_json,
};

use crate::deadline;
use crate::inputs::{Settings, read_one};
use crate::model_arguments::model_parser;
use crate::target_argument::Place;
use crate::verbs::design_report::{self, Report};
use crate::warnings::Warnings;
use whipcord_study::failure::{Failure, message};
use whipcord_study::files;
use whipcord_study::quantity::{millimetres, newtons, number};
use whipcord_study::style::Style;

/// Change holes, routing, pre-bend, taper or tensions so that the robot takes target shapes
///
/// What may change, the targets and the rules are those of [design] in the file, or of the options. Holes without loads
/// are proven optimal; of all else the output says what is known. Each shape is solved again by cosserat-disks. The output is
/// in N, mm and degrees, with --json in SI units.
#[derive(Debug, Args)]
pub struct DesignArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Shape to take: a curve, such as "arc, angle = 90 deg", "helix, radius = 20 mm, pitch = 60 mm", "s, angle = 45 deg" or
    /// "clothoid, start = 0 1/m, end = 10 1/m"; a point for the tip, such as "40, 0, 120 mm"; `measured`; or a CSV or
    /// Parquet file with points for disks (disk, x, y, z) or for the tip (t, x, y, z), each of the latter with tensions of its own. Several are taken by the same robot, each under the tensions of its step
    #[arg(long, value_name = "SHAPE", allow_hyphen_values = true)]
    target: Vec<String>,
    /// What may change: cables[0].holes, cables[pull].routing, cables[*].tension, backbone.rest_curvature,
    /// backbone.diameters, disks.positions, cables (their number), or a number of the robot; by default what the file
    /// says, or the holes of all cables
    #[arg(long, value_name = "WHAT")]
    vary: Vec<String>,
    /// What counts beside the targets: "tension, weight = 0.01", "tension, at_most = 6 N", "clearance, at_least = 5 mm",
    /// "stiffness, disk = 10, direction = x, at_least = 200 N/m" or "workspace, weight = 0.1". A limit is a hard constraint, a weight makes
    /// an objective. In place of those of the file
    #[arg(long, value_name = "CRITERION")]
    criterion: Vec<String>,
    /// Holes by which a cable may move from a disk to the next
    #[arg(long, value_name = "N")]
    max_jump: Option<usize>,
    /// No two cables may share a hole
    #[arg(long)]
    distinct: bool,
    /// Cables must not cross between two disks
    #[arg(long)]
    no_crossing: bool,
    /// Solves that the search may take; what is found by then is the answer. 40000 by default
    #[arg(long, value_name = "N")]
    solves: Option<usize>,
    /// Model; by default cosserat-disks where holes or disks vary, else cosserat
    #[arg(long, value_name = "NAME", value_parser = model_parser())]
    model: Option<ModelKind>,
    /// Fail, with exit status 1, unless the design is proven to be the best
    #[arg(long)]
    prove: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Robot file to write
    #[arg(short, long, value_name = "NEW")]
    output: Option<PathBuf>,
    /// Folder for the report: pictures of target and shape, errors of disks, drawings of the disks (SVG and DXF),
    /// bill of holes, and what tolerances of manufacture do
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    #[command(flatten)]
    warnings: Warnings,
}

/// Designs, writes the files and returns what standard output shows.
pub fn run(args: &DesignArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    if let Some(path) = &args.output {
        files::keep(path, file.files())?;
    }
    let warnings = file.warnings();
    args.warnings.tell(&file, &warnings)?;
    let input = |words: String| Failure::Input(format!("error: {}: {words}", file.path.display()));
    let table = asked(args, &file)?;
    let problem = table.problem(&file.robot, &file.case, &file.goal, file.measured.as_ref());
    let mut problem = problem.map_err(|error| input(error.to_string()))?;
    problem.options.stop = deadline::end_of_search();
    let kind = args.model.unwrap_or_else(|| Vary::usual_model(&problem.vary));
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let model = model.cancelled_by(&deadline::cancel());
    let fail = |error: DesignError| failure(&file, &error);
    let found = design(&model, &file.robot, &problem.goals, &problem.vary, &problem.options);
    let found = found.map_err(fail)?;
    if args.prove && !found.is_proven() {
        let findings: Vec<String> =
            found.findings.iter().map(|of| format!("  {}: {}", of.what, of.known)).collect();
        return Err(Failure::Solve(format!(
            "error: {}: the design is not proven to be the best\n{}",
            file.path.display(),
            findings.join("\n")
        )));
    }
    let cases: Vec<_> = found.goals.iter().map(|goal| goal.case.clone()).collect();
    let mut designed = file.clone();
    designed.robot = found.robot.clone();
    designed.case = designed_case(&found.robot, &file.case, &cases);
    let tolerances = match &args.report {
        None => None,
        Some(_) => {
            let options = whipcord::batch::BatchOptions::default();
            let sampled = found.sample_tolerances(&model, &problem.tolerances, &options);
            Some(sampled.map_err(fail)?)
        }
    };
    let json = design_json(&file.title, &found, tolerances.as_ref());
    let mut json = json.map_err(|error| files::no_result(&error))?;
    json["warnings"] = warnings_json(&file, &warnings);
    let written = match &args.output {
        Some(path) => Some((path, new_file(path, &file, &designed)?)),
        None => None,
    };
    let report = match (&args.report, &tolerances) {
        (Some(folder), Some(tolerances)) => {
            Some((folder, Report::new(&designed, &model, &found, tolerances)?))
        }
        _ => None,
    };
    let text = if args.json {
        format!("{json:#}\n")
    } else {
        let mut text = summary(&file, &found, style);
        if let Some(tolerances) = &tolerances {
            text += &design_report::tolerance_words(tolerances);
        }
        if let Some((path, new)) = &written {
            let note = match new.keeps_text {
                true => "",
                false => {
                    " (written anew: without comments, units, [measured], [fit] and [reference])"
                }
            };
            text += &format!("written: {}{note}\n", path.display());
        }
        if let Some((folder, _)) = &report {
            text += &format!("report: {}\n", folder.display());
        }
        text
    };
    warn_of_new(args.warnings, &file, &designed)?;
    // What can fail has been done: now the files are written, or there are none.
    if let Some((folder, report)) = report {
        report.write(folder, &json)?;
    }
    if let Some((path, new)) = written {
        files::write(path, new.text.as_bytes())?;
    }
    Ok(text)
}

/// Warns of what is wrong with the new robot that was not wrong with the old one, such as a cable that leads through the backbone.
fn warn_of_new(warnings: Warnings, old: &CaseFile, new: &CaseFile) -> Result<(), Failure> {
    let named = |warning: &Warning| (warning.code(), warning.path());
    let known: Vec<_> = of_case(&old.robot, &old.case).iter().map(named).collect();
    for warning in of_case(&new.robot, &new.case) {
        if !known.contains(&named(&warning)) {
            warnings.tell_of_all(&format!("the new robot: {warning}"), &warning.help())?;
        }
    }
    Ok(())
}

/// What the file says of a design, with what the command line says instead.
fn asked(args: &DesignArgs, file: &CaseFile) -> Result<DesignTable, Failure> {
    let mut table = file.goal.design.clone();
    if !args.vary.is_empty() {
        table.vary.clone_from(&args.vary);
    } else if table.vary.is_empty() {
        table.vary = vec!["holes".to_owned()];
    }
    if !args.target.is_empty() {
        let targets = args.target.iter().map(|text| target(text, file));
        table.targets = targets.collect::<Result<_, _>>()?;
    }
    if !args.criterion.is_empty() {
        let criteria = args.criterion.iter().map(|text| {
            parse_criterion(text)
                .map_err(|error| Failure::Input(format!("error: --criterion: {error}")))
        });
        table.criteria = criteria.collect::<Result<_, _>>()?;
    }
    table.max_jump = args.max_jump.or(table.max_jump);
    table.solves = args.solves.or(table.solves);
    table.distinct |= args.distinct;
    if args.no_crossing {
        table.crossing = Some(false);
    }
    Ok(table)
}

fn target(text: &str, file: &CaseFile) -> Result<DesignTarget, Failure> {
    let shape = if text == "measured" {
        DesignShape::Measured
    } else if is_curve(text) {
        let curve = parse_curve(text);
        DesignShape::Curve(curve.map_err(|e| Failure::Input(format!("error: --target: {e}")))?)
    } else if let Ok(Place(point)) = text.parse() {
        DesignShape::Tip(point)
    } else if Path::new(text).is_file() {
        let path = PathBuf::from(text);
        let refused = |error| Failure::Input(message(&error));
        match load_shape(&path, file.robot.disks().count()) {
            Ok(points) => DesignShape::Points(points, path),
            Err(of_shape) => match load_tip_path(&path) {
                Ok(points) => DesignShape::Path(points, path),
                Err(of_path) if is_path(&path) => return Err(refused(of_path)),
                Err(_) => return Err(refused(of_shape)),
            },
        }
    } else {
        let curve = parse_curve(text).err().unwrap_or_default();
        return Err(Failure::Input(format!(
            "error: --target: `{text}` is no file, no point such as \"40, 0, 120 mm\", and {curve}"
        )));
    };
    Ok(DesignTarget { shape, tension: None, weight: None })
}

/// Whether the header of a table has a column of times, so that what is wrong with it is wrong with a path.
fn is_path(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let header = text.lines().next().unwrap_or_default();
    let mut names = header.split(',').map(|name| name.trim().split(' ').next().unwrap_or_default());
    names.any(|name| name == "t")
}

fn failure(file: &CaseFile, error: &DesignError) -> Failure {
    let message = format!("error: {}: {error}", file.path.display());
    match error {
        DesignError::Solve(error) | DesignError::NoAnswer(error) => {
            Failure::from_solve(file, error)
        }
        DesignError::NotAttainable { .. }
        | DesignError::NotMet(_)
        | DesignError::NotConverged { .. }
        | DesignError::Ended
        | DesignError::Stopped(_) => Failure::Solve(message),
        _ => Failure::Input(message),
    }
}

fn new_file(path: &Path, old: &CaseFile, new: &CaseFile) -> Result<FittedFile, Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = old.with_numbers_of(&new.robot, &new.case, Vec3::ZERO, folder);
    file.map_err(|error| Failure::Input(format!("error: the design cannot be written: {error}")))
}

/// A criterion with its value, what it was before, and its limit.
fn criterion_words(of: &CriterionResult) -> String {
    let quantity = of.criterion.quantity;
    let (factor, unit) = match quantity {
        Quantity::Tension => (1.0, "N"),
        Quantity::Clearance => (1e3, "mm"),
        Quantity::Stiffness { .. } => (1.0, "N/m"),
        Quantity::Workspace => (1e6, "cm³"),
    };
    let value = |value: f64| format!("{} {unit}", number(factor * value, 4));
    let mut text = value(of.value);
    if let Quantity::Stiffness { .. } = quantity {
        text = format!("{text}, {}", of.criterion);
    }
    if let Some(before) = of.before {
        text += &format!(", before {}", value(before));
    }
    if let Some(limit) = of.criterion.limit {
        let words = if quantity.is_limited_above() { "at most" } else { "at least" };
        text += &format!("; wanted {words} {}", value(limit));
    }
    text
}

/// What to do where the cables that run straight between disks bend the robot otherwise than the model of the design says.
fn check_note(found: &Design) -> Option<&'static str> {
    // As many times farther off, and by more than this part of the length.
    const FARTHER: f64 = 2.0;
    const PART: f64 = 0.005;
    let length = found.robot.backbone().length;
    let is_off = |goal: &GoalResult| {
        let Some(Ok(check)) = &goal.check else { return false };
        let [checked, found] = [spread(check)[0], spread(&goal.distances)[0]];
        checked > FARTHER * found && checked - found > PART * length
    };
    (found.model != ModelKind::CosseratDisks && found.goals.iter().any(is_off)).then_some(
        "the cables run straight from disk to disk in the check: --model cosserat-disks designs for that, and more disks bring both together\n",
    )
}

fn summary(file: &CaseFile, found: &Design, style: Style) -> String {
    let mut text = format!("{}\n{}\n\n", style.heading(&file.title), found.model);
    let distance = |metres: f64| {
        // What rounding leaves is no distance.
        let metres = if metres < 1e-12 { 0.0 } else { metres };
        format!("{} mm", number(1e3 * metres, 3))
    };
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<12}")));
    };
    let both = |error, largest| {
        format!("{} in the root mean square, {} at most", distance(error), distance(largest))
    };
    let has_points = found.goals.iter().any(|goal| !goal.points.is_empty());
    if has_points {
        line("error", both(found.error, found.largest));
    }
    if let Some([error, largest]) = found.before {
        line("before", both(error, largest));
    }
    for (k, goal) in found.goals.iter().enumerate() {
        let name = match found.goals.len() {
            1 => "target".to_owned(),
            _ => format!("target {}", k + 1),
        };
        let [error, largest] = spread(&goal.distances);
        let distances = match goal.points.is_empty() {
            true => "no points".to_owned(),
            false => both(error, largest),
        };
        let pulled = found.robot.cables().iter().zip(&goal.case.commands);
        let pulled: Vec<String> = pulled
            .filter_map(|(cable, of)| Some(format!("{} {}", cable.name, newtons(of.tension?))))
            .collect();
        line(&name, format!("{distances}; {}", pulled.join(", ")));
        match &goal.check {
            None => {}
            Some(Err(error)) => line("check", format!("cosserat-disks has no answer: {error}")),
            Some(Ok(distances)) if distances.is_empty() => {}
            Some(Ok(distances)) => {
                let [error, largest] = spread(distances);
                line("check", format!("cosserat-disks, finely: {}", both(error, largest)));
            }
        }
    }
    for result in &found.criteria {
        line(result.criterion.quantity.name(), criterion_words(result));
    }
    for cable in found.robot.cables() {
        if let whipcord::Routing::Holes { holes, .. } = &cable.routing {
            let list: Vec<String> = holes.iter().map(ToString::to_string).collect();
            line(&cable.name, format!("holes {}", list.join("-")));
        }
    }
    text.push('\n');
    for finding in &found.findings {
        text += &format!("{}: {}\n", finding.what, finding.known);
    }
    if let Some(bound) = found.lower_bound.filter(|bound| *bound < found.error * (1.0 - 1e-6)) {
        text += &format!(
            "no list of holes comes nearer than {} in the root mean square with these tensions\n",
            distance(bound)
        );
    }
    if let Some(ended) = found.ended {
        text += &format!("{}\n", ended_words(ended, found.solves));
    }
    if let Some([_, greatest]) = found.assumed_tension {
        text += &format!(
            "tensions up to {} are assumed to be allowed, as [limits] gives none\n",
            newtons(greatest)
        );
    }
    if let Some(note) = check_note(found) {
        text += note;
    }
    text + &far_note(found)
}

/// What ended the search, and how it may go on.
fn ended_words(ended: Ended, solves: usize) -> String {
    match ended {
        Ended::Solves => format!(
            "the search took its {solves} solves and found this until then: --solves {} looks on",
            10 * solves
        ),
        Ended::Stopped => format!(
            "the time of the search was over after {solves} solves, and this was found until then: a longer --timeout looks on"
        ),
    }
}

/// Of a shape that is far from its target, why that may be.
fn far_note(found: &Design) -> String {
    // As parts of the length: what is far, and beyond what no stretch gets.
    const FAR: f64 = 0.1;
    const BEYOND: f64 = 2.0;
    let length = found.robot.backbone().length;
    if found.largest <= FAR * length {
        return String::new();
    }
    let far = format!("the shape is far from the target, at a length of {}", millimetres(length));
    let away = |goal: &GoalResult| {
        let base = goal.case.base.position;
        goal.points.iter().map(|(_, point)| (*point - base).norm()).fold(0.0, f64::max)
    };
    let farthest = found.goals.iter().map(away).fold(0.0, f64::max);
    let is_pulled = |goal: &GoalResult| {
        let mut commands = goal.case.commands.iter();
        commands.any(|command| command.tension.is_none_or(|tension| tension > 0.0))
    };
    if farthest > BEYOND * length {
        let farthest = number(farthest, 4);
        format!(
            "{far}: a wanted place is {farthest} m from the base; numbers without a unit are in m, and a column may name another, as in x [mm]\n"
        )
    } else if !found.goals.iter().any(is_pulled) {
        format!("{far}: no cable is pulled; give tensions, or let them vary (--vary tension)\n")
    } else {
        format!("{far}\n")
    }
}
