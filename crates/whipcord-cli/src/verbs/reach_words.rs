//! Answers of `whipcord reach` in words.

use whipcord::{Drive, Robot};
use whipcord_inverse::{
    Actuator, InverseSolver, ReachStatus, Reached, SearchRange, Target, Tolerance,
};
use whipcord_io::CaseFile;

use super::solve;
use crate::goal::{point, target};
use whipcord_study::describe::{compromise, instability};
use whipcord_study::motors;
use whipcord_study::quantity::{degrees, millimetres, newtons, number};
use whipcord_study::style::Style;

/// What was asked, and what came of it.
pub struct Answer<'a> {
    /// With the commands that were found.
    pub file: &'a CaseFile,
    /// What was solved.
    pub solver: &'a InverseSolver,
    /// What was asked.
    pub target: &'a Target,
    /// How far the answer may be from it.
    pub tolerance: Tolerance,
    /// What came of it.
    pub reached: &'a Reached,
}

/// The answer for people.
pub fn summary(answer: &Answer<'_>, style: Style) -> String {
    let Answer { file, reached, .. } = answer;
    let solution = &reached.solution;
    let mut text = format!("{}\n", style.heading(&file.title));
    text += &format!("{}: {}\n\n", solution.model, status(answer));
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<11}")));
    };
    line("target", target(answer.target));
    line("tip", point(solution.disks.tip().position));
    line("error", error(answer));
    if let Some(bound) = reached.lower_bound {
        line("at least", format!("{}, as is proven", millimetres(bound)));
    }
    text += &format!("\n{}", solve::cables(solution).text(style));
    if solution.cables.iter().any(|cable| cable.tension.is_none()) {
        text += &format!("–: {} computes no tensions\n", solution.model);
    }
    if let Some(table) = motors::table(&file.robot, &file.case, solution) {
        text += &format!("\n{}", table.text(style));
    }
    text.push('\n');
    let limits = active_limits(answer);
    if !limits.is_empty() {
        text += &format!("at a limit: {}\n", limits.join(", "));
    }
    if let Some(reason) = reached.no_proof {
        text += &format!("no proof: {}\n", reason.words());
    }
    text += &format!("{}\n", free(answer));
    if let Some(assumed) = assumed(answer) {
        text += &format!("{assumed}\n");
    }
    for words in [compromise(solution, &file.case), instability(solution)].into_iter().flatten() {
        text += &format!("{}\n", style.heading(words));
    }
    text +=
        &format!("{}, {}\n", counted(reached.starts, "start"), counted(reached.solves, "solve"));
    text
}

/// What standard error says of a target that is not reached.
pub fn not_reached(answer: &Answer<'_>) -> String {
    let Answer { file, reached, .. } = answer;
    let mut text = format!("error: {}: {}\n", file.path.display(), status(answer));
    text += &format!("  target: {}\n", target(answer.target));
    text += &format!("  tip: {}\n", point(reached.solution.disks.tip().position));
    text += &format!("  distance: {}\n", error(answer));
    if let Some(bound) = reached.lower_bound {
        text +=
            &format!("  no commands within the limits come nearer than {}\n", millimetres(bound));
    }
    text += &format!("  nearest commands: {}\n", commands(answer).join(", "));
    let limits = active_limits(answer);
    if !limits.is_empty() {
        text += &format!("  at a limit: {}\n", limits.join(", "));
    }
    if let Some(reason) = reached.no_proof {
        text += &format!("  no proof: {}\n", reason.words());
    }
    if let Some(assumed) = assumed(answer) {
        text += &format!("  {assumed}\n");
    }
    if let Some(far) = beyond(answer) {
        text += &format!("  {far}\n");
    }
    text += "  help: --nearest prints this answer with exit status 0";
    text += match reached.status {
        ReachStatus::Undecided => "; --starts 200 searches from more shapes",
        _ => "; change the target or the limits, or allow more by --tolerance",
    };
    text
}

fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

fn status(answer: &Answer<'_>) -> &'static str {
    match answer.reached.status {
        ReachStatus::Reached => "the target is reached",
        ReachStatus::Nearest => {
            "the target is not reached; this is the nearest that was found from all starts, which is no proof"
        }
        ReachStatus::UnreachableProven => "the target cannot be reached, as is proven",
        ReachStatus::Undecided => "the target is not reached, and whether it can be is undecided",
    }
}

/// How far the answer is from the target, and how far it may be.
fn error(answer: &Answer<'_>) -> String {
    let (miss, tolerance) = (answer.reached.miss, answer.tolerance);
    let mut parts = Vec::new();
    if !matches!(answer.target, Target::Axis { point: None, .. }) {
        let most = match answer.target {
            Target::Shape(points) if points.len() > 1 => "at most ",
            _ => "",
        };
        let (error, allowed) = (1e3 * miss.position, 1e3 * tolerance.position);
        parts.push(format!("{most}{} mm ({} mm allowed)", number(error, 3), number(allowed, 3)));
    }
    if matches!(answer.target, Target::Pose(_) | Target::Axis { .. }) {
        let [error, allowed] = [miss.angle, tolerance.angle].map(f64::to_degrees);
        parts.push(format!("{}° ({}° allowed)", number(error, 3), number(allowed, 3)));
    }
    parts.join(", ")
}

/// The name of what has a command, and the command.
pub fn command(robot: &Robot, actuator: Actuator, value: f64) -> (&str, String) {
    match actuator {
        Actuator::Tension(cable) => {
            // What rounding leaves of no tension is none.
            let tension = if value.abs() < 1e-9 { 0.0 } else { value };
            (&robot.cables()[cable].name, newtons(tension))
        }
        Actuator::Shortening(cable) => (&robot.cables()[cable].name, millimetres(value)),
        Actuator::Motor(motor) => {
            let motor = &robot.motors()[motor];
            (&motor.name, driven(motor.drive, value))
        }
    }
}

/// Each command with its number.
fn commands(answer: &Answer<'_>) -> Vec<String> {
    let of = |(actuator, value): (&Actuator, &f64)| {
        let (name, words) = command(&answer.file.robot, *actuator, *value);
        match actuator {
            Actuator::Shortening(_) => format!("{name} shortened by {words}"),
            Actuator::Tension(_) | Actuator::Motor(_) => format!("{name} {words}"),
        }
    };
    answer.solver.actuators().iter().zip(&answer.reached.commands).map(of).collect()
}

fn driven(drive: Drive, value: f64) -> String {
    match drive {
        Drive::Spool { .. } => degrees(value),
        Drive::Linear => millimetres(value),
    }
}

fn active_limits(answer: &Answer<'_>) -> Vec<String> {
    let words = |limit: &whipcord_inverse::Limit| {
        limit.words(&answer.file.robot, answer.solver.actuators())
    };
    answer.reached.active_limits.iter().map(words).collect()
}

/// In how many directions the commands can change without moving what the target is for.
fn free(answer: &Answer<'_>) -> String {
    let all = answer.solver.actuators().len();
    match answer.reached.null_space.len() {
        0 => format!("no direction is free: the target determines the {all} commands"),
        1 => format!(
            "1 of {all} directions of the commands is free: it does not move what the target is for"
        ),
        free => format!(
            "{free} of {all} directions of the commands are free: they do not move what the target is for"
        ),
    }
}

/// Limits that were not given.
fn assumed(answer: &Answer<'_>) -> Option<String> {
    let robot = &answer.file.robot;
    let ranges = answer.solver.search_ranges();
    let of = |searched: &SearchRange| {
        let ([least, greatest], [low, high]) = (searched.range, searched.assumed);
        let said = |value: f64| command(robot, searched.actuator, value).1;
        let (name, _) = command(robot, searched.actuator, 0.0);
        let words = match (low, high) {
            (false, false) => return None,
            (true, false) => format!("from {}", said(least)),
            (false, true) => format!("up to {}", said(greatest)),
            (true, true) => format!("from {} to {}", said(least), said(greatest)),
        };
        Some((name, words))
    };
    // What is assumed alike is said once.
    let mut groups: Vec<(Vec<&str>, String)> = Vec::new();
    for (name, words) in ranges.iter().filter_map(of) {
        match groups.iter_mut().find(|(_, known)| *known == words) {
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], words)),
        }
    }
    let all: Vec<String> =
        groups.iter().map(|(names, words)| format!("{} {words}", names.join(", "))).collect();
    let is_motor = |searched: &SearchRange| matches!(searched.actuator, Actuator::Motor(_));
    let table = match ranges.iter().any(is_motor) {
        true => "[[motors]]",
        false => "[limits]",
    };
    (!all.is_empty()).then(|| {
        format!("limits that are assumed, as none are given in {table}: {}", all.join("; "))
    })
}

/// What is said of a target that is farther than the robot is long, as by a wrong unit.
fn beyond(answer: &Answer<'_>) -> Option<String> {
    let farthest = match answer.target {
        Target::Tip(at) => *at,
        Target::Pose(pose) => pose.position,
        Target::Axis { point, .. } => (*point)?,
        Target::Shape(points) => points.last()?.1,
    };
    let length = answer.file.robot.backbone().length;
    let distance = (farthest - answer.file.case.base.position).norm();
    (distance > length).then(|| {
        let unit = if distance > 10.0 * length { ": check its unit" } else { "" };
        let (distance, length) = (millimetres(distance), millimetres(length));
        format!("the target is {distance} from the base, but the robot is {length} long{unit}")
    })
}
