//! `whipcord stiffness`: how a place of the robot moves with its cables and yields to loads.

use std::path::{Path, PathBuf};

use clap::Args;
use whipcord::kinematics::{
    Compliance, DerivativeMethod, Dexterity, DrivenBy, Local, Matrix6, PrincipalAxes,
    principal_axes,
};
use whipcord::{Differentiable as _, Model, Solution, Twist, UnitQuaternion, Vec3};
use whipcord_io::{CaseFile, Dimension, parse_quantity, stiffness_json, warnings_json};
use whipcord_plot::{Acting, Ellipsoid, FigureOptions, Quantity, RobotView, label, robot_figure};

use crate::inputs::{Settings, read_one};
use crate::model_arguments::ModelArguments;
use crate::path_argument::path_ending_in;
use crate::smooth::smooth;
use crate::warnings::Warnings;
use whipcord_study::describe::{driven_by, instability};
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::{fixed_millimetres, millimetres, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// Actuation Jacobian, compliance and stiffness at one point of the backbone
///
/// Prints the actuation Jacobian, and compliance and stiffness both at constant tensions and with
/// the taut cables locked, among obstacles too. All are in the base frame, for a wrench that is
/// fixed in space. The derivatives are exact. four-bar gives compliance and stiffness only with
/// --objective strain-energy --length-rule free, constant-curvature gives the Jacobian alone. The
/// output is in mm and degrees, with --json in SI units.
#[derive(Debug, Args)]
pub struct StiffnessArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: ModelArguments,
    /// Point on the backbone: an arc length such as "90 mm", or `tip`; a number without a unit is
    /// in metres
    #[arg(long, value_name = "ARC_LENGTH", default_value = "tip", value_parser = place)]
    at: Place,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Draw the robot with the ellipsoids of compliance and manipulability at the point; the name
    /// ends in .svg or .png
    #[arg(long, value_name = "OUT", value_parser = path_ending_in(&["svg", "png"]))]
    plot: Option<PathBuf>,
    #[command(flatten)]
    warnings: Warnings,
}

/// Where the robot is looked at.
#[derive(Clone, Copy, Debug)]
enum Place {
    Tip,
    /// In m.
    ArcLength(f64),
    /// The same, given without a unit.
    Metres(f64),
}

fn place(text: &str) -> Result<Place, String> {
    if text == "tip" {
        return Ok(Place::Tip);
    }
    if let Ok(metres) = text.parse::<f64>() {
        return Ok(Place::Metres(metres));
    }
    match parse_quantity(text, &[Dimension::Length]) {
        Ok((metres, _)) => Ok(Place::ArcLength(metres)),
        Err(error) => Err(format!("{error}; give a length such as \"90 mm\", or `tip`")),
    }
}

/// Solves, differentiates and returns what standard output shows.
pub fn run(args: &StiffnessArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    let length = file.robot.backbone().length;
    let at = match args.at {
        Place::Tip => length,
        Place::ArcLength(s) if (0.0..=length).contains(&s) => s,
        Place::Metres(s) if (0.0..=length).contains(&s) => s,
        Place::Metres(s) => {
            return Err(Failure::Input(format!(
                "error: --at {s} is {s} m, because a number without a unit is in metres, but the backbone is {} long: write --at \"{s} mm\"",
                millimetres(length)
            )));
        }
        Place::ArcLength(s) => {
            return Err(Failure::Input(format!(
                "error: --at {} is not on the backbone, which is {} long",
                millimetres(s),
                millimetres(length)
            )));
        }
    };
    let model = args.model.model()?;
    let mut warnings = file.warnings();
    // Before the solve: what is wrong with the file may be why there is no answer.
    args.warnings.tell(&file, &warnings)?;
    let (solution, local) = model
        .solve_at(&file.robot, &file.case, at)
        .map_err(|error| Failure::from_solve(&file, &error))?;
    let of_answer = file.answer_warnings([(None, &solution)]);
    args.warnings.tell(&file, &of_answer)?;
    warnings.extend(of_answer);
    let picture = match &args.plot {
        Some(path) => Some((path, draw(path, &file, &model, &solution, &local)?)),
        None => None,
    };
    let text = if args.json {
        let json = stiffness_json(&file.title, &solution, &local);
        let mut json = json.map_err(|error| files::no_result(&error))?;
        json["warnings"] = warnings_json(&file, &warnings);
        format!("{json:#}\n")
    } else {
        let mut text = summary(&file, args, at, &solution, &local, style);
        if let Some(path) = &args.plot {
            text += &format!("\npicture: {}\n", path.display());
        }
        text
    };
    // What can fail has been done: now the picture is written, or there is neither.
    if let Some((path, bytes)) = picture {
        files::write(path, &bytes)?;
    }
    Ok(text)
}

/// The robot with what its place yields and how its cables move it.
fn draw(
    path: &Path,
    file: &CaseFile,
    model: &Model,
    solution: &Solution,
    local: &Local,
) -> Result<Vec<u8>, Failure> {
    let fine = smooth(model, file, solution);
    let options = FigureOptions {
        title: file.title.clone(),
        loads: Acting::on(&file.case, &fine.shape),
        ellipsoids: ellipsoids(solution, local, file.case.base.rotation),
        ..FigureOptions::default()
    }
    .among(&file.case.obstacles, Some(solution));
    let view = RobotView::model(label(solution.model, solution), &fine);
    let svg = robot_figure(&file.robot, &[view], &options)
        .map_err(|error| files::plot_failure(path, &error))?;
    files::picture(&svg, path)
}

/// Compliance with tensions held and with cables locked, and what unit commands do; `base` turns
/// from the frame of the base to that of the shape.
fn ellipsoids(solution: &Solution, local: &Local, base: UnitQuaternion) -> Vec<Ellipsoid> {
    let at = solution.shape.tip().position;
    let turned = |axes: PrincipalAxes| PrincipalAxes {
        directions: axes.directions.map(|d| base.rotate(d)),
        ..axes
    };
    let compliance = |label: &str, yielding: &Compliance| Ellipsoid {
        label: label.to_owned(),
        at,
        axes: turned(principal_axes(&yielding.compliance.blocks[0][0])),
        quantity: Quantity::Compliance,
    };
    let mut ellipsoids = match &local.compliances {
        Err(_) => Vec::new(),
        Ok(yields) if local.actuation_jacobian.is_empty() => {
            return vec![compliance("compliance", &yields.tensions_held)];
        }
        Ok(yields) => vec![
            compliance("compliance, tensions held", &yields.tensions_held),
            compliance("compliance, cables locked", &yields.lengths_held),
        ],
    };
    let kinds = local.dexterity();
    for (driven_by, dexterity) in &kinds {
        let (by, quantity) = match driven_by {
            DrivenBy::Tension => ("tension", Quantity::ByTension),
            DrivenBy::Shortening => ("shortening", Quantity::ByShortening),
        };
        // What rounding leaves of a direction in which nothing moves is nothing.
        let mut values = [0.0; 3];
        for (value, (moved, _)) in values.iter_mut().zip(dexterity.motions()) {
            *value = moved;
        }
        let moved = PrincipalAxes {
            values,
            directions: dexterity.singular.map(|(_, direction)| direction),
        };
        let label = match kinds.len() {
            1 => String::from("manipulability"),
            _ => format!("manipulability by {by}"),
        };
        ellipsoids.push(Ellipsoid { label, at, axes: turned(moved), quantity });
    }
    ellipsoids
}

fn summary(
    file: &CaseFile,
    args: &StiffnessArgs,
    at: f64,
    solution: &Solution,
    local: &Local,
    style: Style,
) -> String {
    let driver = driven_by(solution.model, args.model.actuation(), &file.case);
    let [x, y, z] = solution.shape.tip().position.to_array().map(|c| fixed_millimetres(c, 3));
    let place = match args.at {
        Place::Tip => "tip".to_owned(),
        Place::ArcLength(_) | Place::Metres(_) => format!("arc length {}", millimetres(at)),
    };
    let mut text = format!("{}\n", style.heading(&file.title));
    text += &format!("{}, driven by {driver}\n\n", solution.model);
    let turned = file.case.base.rotation != UnitQuaternion::IDENTITY;
    let frame = if turned { ", in the world" } else { "" };
    text += &format!("{}  ({x}, {y}, {z}) mm{frame}\n", style.faint(place));
    if turned {
        text += "the base is turned: all that follows is along the axes of the base, not of the world\n";
    }
    if let DerivativeMethod::Differences { error } = local.method {
        text += &format!(
            "from differences of solutions, with an estimated relative error of {} at held tensions\n",
            number(error, 2)
        );
    }
    if let Some(words) = instability(solution) {
        text += &format!("{}\n", style.heading(words));
    } else if let Some(stability) = solution.diagnostics.stability {
        text += &format!("{}  {}\n", style.faint("stability"), number(stability, 3));
    }
    for what in local.one_sided.names() {
        let change = match what {
            "contact" => "a contact is about to open, to close, to stick or to slide",
            "hole" => "a cable is about to stick or to slide in a hole",
            "bending" => "friction against bending of the backbone is about to stick or to slide",
            _ => "a cable is about to go slack or to become taut",
        };
        text += &format!("derivatives of one side: {change}\n");
    }
    if local.are_lengths_dependent {
        text += "the commanded lengths depend on each other: the tensions are not determined, and a command counts by the part that does not contradict the others\n";
    }
    if !local.actuation_jacobian.is_empty() {
        text += &format!("\n{}", actuation(solution, local, style));
    }
    match &local.compliances {
        Err(unknown) => text += &format!("\nhow it yields is not known: {unknown}\n"),
        Ok(known) => {
            text += &format!("\n{}", yields("tensions held", &known.tensions_held, style));
            // Without cables nothing is locked.
            if !local.actuation_jacobian.is_empty() {
                text += &format!("\n{}", yields("cables locked", &known.lengths_held, style));
            }
        }
    }
    text
}

const MOTIONS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];
const WRENCHES: [&str; 6] = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];

/// Millimetres or degrees of a motion.
fn shown(motion: &Twist, row: usize) -> f64 {
    if row < 3 { motion.linear[row] * 1e3 } else { motion.angular[row - 3].to_degrees() }
}

/// The Jacobian, by a newton of tension or a millimetre of shortening, and what it is worth.
fn actuation(solution: &Solution, local: &Local, style: Style) -> String {
    let mut table = Table::new(by_cable("moves, mm and °", solution, local));
    table.group();
    for row in 0..6 {
        let mut cells = vec![MOTIONS[row].to_owned()];
        for (column, driven) in local.actuation_jacobian.iter().zip(&local.driven_by) {
            cells.push(tidy(
                shown(column, row) * unit(*driven),
                largest(&local.actuation_jacobian, row),
            ));
        }
        table.row(cells);
    }
    let mut text = table.text(style);
    let kinds = local.dexterity();
    for (driven_by, dexterity) in &kinds {
        let by = match (kinds.len(), driven_by) {
            (1, _) => "",
            (_, DrivenBy::Tension) => "by tension, ",
            (_, DrivenBy::Shortening) => "by shortening, ",
        };
        let cables = local.driven_by.iter().filter(|kind| *kind == driven_by).count();
        text += &format!("{by}{}", dexterous(*driven_by, dexterity, cables));
    }
    text + &format!("\n{}", lengths(solution, local).text(style))
}

/// How well cables of one kind move the place, and along which directions.
fn dexterous(driven_by: DrivenBy, dexterity: &Dexterity, cables: usize) -> String {
    let condition = match dexterity.condition {
        Some(condition) => format!(", condition {}", number(condition, 4)),
        None => String::new(),
    };
    // A volume, an area or a length for each unit of command; by shortening that is a plain number.
    let unit = match (driven_by, cables) {
        (DrivenBy::Tension, 1) => " m/N",
        (DrivenBy::Tension, 2) => " m²/N²",
        (DrivenBy::Tension, _) => " m³/N³",
        (DrivenBy::Shortening, _) => "",
    };
    let mut text = format!(
        "translates in {} of 3 directions{condition}, manipulability {}{unit}\n",
        dexterity.directions,
        number(dexterity.manipulability, 4)
    );
    for (moved, direction) in dexterity.motions() {
        let moved = match driven_by {
            DrivenBy::Tension => format!("{} mm/N", number(moved * 1e3, 4)),
            DrivenBy::Shortening => format!("{} mm/mm", number(moved, 4)),
        };
        text += &format!("along {}  {moved}\n", components(direction));
    }
    text
}

/// How the length of each cable changes, by a newton of tension or a millimetre of shortening.
fn lengths(solution: &Solution, local: &Local) -> Table {
    let mut table = Table::new(by_cable("lengthens, mm", solution, local));
    table.group();
    for (cable, row) in solution.cables.iter().zip(&local.length_jacobian) {
        let shown = |(rate, driven): (&f64, &DrivenBy)| rate * 1e3 * unit(*driven);
        let entries: Vec<f64> = row.iter().zip(&local.driven_by).map(shown).collect();
        let largest = entries.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let cells = entries.iter().map(|&entry| tidy(entry, largest));
        table.row(core::iter::once(cable.name.clone()).chain(cells).collect());
    }
    table
}

/// Columns of what the command of each cable does.
fn by_cable(corner: &str, solution: &Solution, local: &Local) -> Vec<(String, Align)> {
    let mut columns = vec![(corner.to_owned(), Align::Left)];
    for (cable, driven) in solution.cables.iter().zip(&local.driven_by) {
        let unit = match driven {
            DrivenBy::Tension => "N",
            DrivenBy::Shortening => "mm",
        };
        columns.push((format!("{} per {unit}", cable.name), Align::Right));
    }
    columns
}

/// A newton or a millimetre.
const fn unit(driven: DrivenBy) -> f64 {
    match driven {
        DrivenBy::Tension => 1.0,
        DrivenBy::Shortening => 1e-3,
    }
}

/// Greatest entry of a row: what is rounding beside it is shown as zero.
fn largest(jacobian: &[Twist], row: usize) -> f64 {
    let of =
        |part: fn(&Twist) -> Vec3| jacobian.iter().map(|t| part(t).norm()).fold(0.0_f64, f64::max);
    if row < 3 { of(|t| t.linear) * 1e3 } else { of(|t| t.angular).to_degrees() }
}

fn tidy(value: f64, largest: f64) -> String {
    if value.abs() <= 1e-7 * largest { "0".to_owned() } else { number(value, 4) }
}

fn yields(name: &str, yielding: &Compliance, style: Style) -> String {
    let mut text = format!("{}\n", style.heading(format!("compliance with {name}")));
    let compliance = |i: usize, j: usize| {
        let moved = if i < 3 { 1e3 } else { 180.0 / core::f64::consts::PI };
        // Per newton and per newton-millimetre.
        yielding.compliance.at(i, j) * moved * if j < 3 { 1.0 } else { 1e-3 }
    };
    text += &matrix("mm and °", &WRENCHES, ["per N", "per N·mm"], &MOTIONS, compliance).text(style);
    text += &axes(&yielding.compliance);
    text.push('\n');
    match &yielding.stiffness {
        None => {
            text += &format!("stiffness with {name}: the place does not yield in every direction\n")
        }
        Some(stiffness) => {
            text += &format!("{}\n", style.heading(format!("stiffness with {name}")));
            let stiffness = |i: usize, j: usize| {
                let exerted = if i < 3 { 1.0 } else { 1e3 };
                let moved = if j < 3 { 1e-3 } else { core::f64::consts::PI / 180.0 };
                stiffness.at(i, j) * exerted * moved
            };
            let columns = ["per mm", "per °"];
            text += &matrix("N and N·mm", &MOTIONS, columns, &WRENCHES, stiffness).text(style);
        }
    }
    text
}

/// A 6×6 matrix whose rows and columns have these names; `per` are the units of the columns.
fn matrix(
    corner: &str,
    columns: &[&str; 6],
    per: [&str; 2],
    rows: &[&str; 6],
    entry: impl Fn(usize, usize) -> f64,
) -> Table {
    let mut headings = vec![(format!("{corner} {}, {}", per[0], per[1]), Align::Left)];
    headings.extend(columns.iter().map(|name| ((*name).to_owned(), Align::Right)));
    let mut table = Table::new(headings);
    for i in 0..6 {
        if i % 3 == 0 {
            table.group();
        }
        let mut cells = vec![rows[i].to_owned()];
        for j in 0..6 {
            // Beside the greatest of its block, what is left by rounding is nothing.
            let block = (0..9).map(|k| entry(i / 3 * 3 + k / 3, j / 3 * 3 + k % 3).abs());
            cells.push(tidy(entry(i, j), block.fold(0.0, f64::max)));
        }
        table.row(cells);
    }
    table
}

/// Along which directions the place yields least and most to a force, and about which to a moment.
fn axes(compliance: &Matrix6) -> String {
    let mut text = String::new();
    let kinds = [
        // Millimetres for each newton, degrees for each newton-millimetre.
        ("along", 0, 1e3, "mm/N", "N/mm"),
        ("about", 1, 1e-3 * 180.0 / core::f64::consts::PI, "°/N·mm", "N·mm/°"),
    ];
    for (way, block, shown, per_load, per_motion) in kinds {
        let axes = principal_axes(&compliance.blocks[block][block]);
        let largest = axes.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (value, direction) in axes.values.iter().zip(axes.directions) {
            // What rounding leaves of a direction that does not yield is nothing; an unstable robot yields
            // the wrong way.
            let (yields, stiffness) = if value.abs() > 1e-9 * largest {
                let yields = value * shown;
                (yields, format!(", {} {per_motion}", number(1.0 / yields, 4)))
            } else {
                (0.0, String::new())
            };
            let direction = components(direction);
            text += &format!("{way} {direction}  {} {per_load}{stiffness}\n", number(yields, 4));
        }
    }
    text
}

fn components(direction: Vec3) -> String {
    let [x, y, z] = direction.to_array().map(|c| whipcord_study::quantity::fixed(c, 3));
    format!("({x}, {y}, {z})")
}
