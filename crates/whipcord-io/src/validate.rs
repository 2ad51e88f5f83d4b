//! Asks the library whether the robot and the case can be, and finds the place of what cannot.

use whipcord::robot::limits::Range;
use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, Drive, Loads, Motor, Obstacle, Pose, Problem,
    Robot, RobotError, Shortening, SolveError,
};
use whipcord_motion::MotionError;

use crate::check::given_text;
use crate::error::{CommandedMotor, Diagnostic, FileProblem, Problems};
use crate::node::{Node, Value};
use crate::read::{CommandTable, Motors};
use crate::schema::ROOT;
use crate::source::{Span, quoted};

/// The parts of a robot and of a case as the file gives them.
pub(crate) struct Parts {
    pub backbone: Backbone,
    pub disks: Disks,
    pub cables: Vec<Cable>,
    pub commands: Vec<CableCommand>,
    pub loads: Loads,
    /// Those of each step, where they differ.
    pub step_loads: Vec<Loads>,
    pub base: Pose,
    /// Steps of actuation, each with a command for each cable; where there are any, the last one
    /// stands for `commands`.
    pub steps: Vec<Vec<CableCommand>>,
    pub motors: Motors,
    /// What each step tells the motors.
    pub motor_steps: Vec<Vec<Option<f64>>>,
    /// Whether each step starts from the robot at rest.
    pub independent: bool,
    /// The table whose rows the steps are, and where these stand.
    pub table: Option<CommandTable>,
    pub row_spans: Vec<Span>,
    pub obstacles: Vec<Obstacle>,
}

/// What the places of the library's commands are in the file.
struct Numbering {
    /// Numbers in the file of the cables that are left.
    cables: Vec<usize>,
    /// The step that the final commands come from.
    last_step: Option<usize>,
    /// Where the steps stand, if they are the rows of a table.
    rows: Vec<Span>,
}

/// The robot and the case of these parts. The library stops at the first quantity that cannot be;
/// a cable that is refused is left out and the rest tried again, so that all of them are reported.
pub(crate) fn assemble(
    parts: Parts,
    document: &Node,
    problems: &mut Problems,
) -> Option<(Robot, Case)> {
    let Parts { backbone, disks, mut cables, mut commands, loads, base, .. } = parts;
    let Parts { steps: mut before, obstacles, motors, mut motor_steps, .. } = parts;
    let Parts { independent, row_spans: rows, step_loads: mut loads_before, .. } = parts;
    let loads = loads_before.pop().unwrap_or(loads);
    let last = before.pop();
    let mut numbers = Numbering {
        cables: (0..cables.len()).collect(),
        last_step: last.is_some().then_some(before.len()),
        rows,
    };
    if let Some(last) = last {
        commands = last;
    }
    let robot = loop {
        match Robot::new(backbone.clone(), disks.clone(), cables.clone()) {
            Ok(robot) => break robot,
            Err(error) => {
                let refused = cable_of(&error).filter(|&i| i < cables.len());
                report(&error, &numbers, document, problems);
                let i = refused?;
                cables.remove(i);
                commands.remove(i);
                before.iter_mut().for_each(|step| _ = step.remove(i));
                numbers.cables.remove(i);
                if problems.is_full() {
                    return None;
                }
            }
        }
    };
    let robot = match robot.with_motors(motors.motors) {
        Ok(robot) => robot,
        Err(error) => {
            report(&error, &numbers, document, problems);
            return None;
        }
    };
    if motor_steps.is_empty() {
        motor_steps.push(motors.commands);
    }
    let motors = if robot.motors().is_empty() { Vec::new() } else { motor_steps };
    let mut case =
        Case { commands, loads, base, before, loads_before, motors, obstacles, independent };
    if let Err(error) = case.drive(&robot) {
        report(&error, &numbers, document, problems);
        return None;
    }
    while let Err(error) = case.check(&robot) {
        report(&error, &numbers, document, problems);
        let refused = match step_of(&error) {
            Some((step, cable)) => case.before.get_mut(step)?.get_mut(cable)?,
            None => case.commands.get_mut(cable_of(&error)?)?,
        };
        *refused = CableCommand::default();
        if problems.is_full() {
            return None;
        }
    }
    shortenings(&robot, &case, &numbers, document, problems);
    Some((robot, case))
}

/// Refuses cables that are shortened by more than all of their length, as by a number of millimetres or per cent
/// without its unit.
fn shortenings(
    robot: &Robot,
    case: &Case,
    numbers: &Numbering,
    document: &Node,
    problems: &mut Problems,
) {
    for (k, commands) in case.before.iter().chain([&case.commands]).enumerate() {
        for (i, command) in commands.iter().enumerate() {
            let Some(Shortening::Length(value)) = command.shortening else { continue };
            // A cable is at least as long as the part of the backbone that it runs along.
            let at_least = robot.routes().get(i).map_or(0.0, |route| 0.5 * route.end());
            if value <= at_least {
                continue;
            }
            let length = robot.cable_length(i);
            if value <= length {
                continue;
            }
            let path = match numbers.last_step {
                None => format!("cables[{i}].shortening"),
                Some(_) => format!("steps[{k}].shortening[{i}]"),
            };
            let place = document.locate(&path);
            let span = numbers.rows.get(k).copied().unwrap_or(place.span);
            let without_unit = match &place.value {
                Value::Integer(_) | Value::Number(_) => given_text(place),
                _ => None,
            };
            problems.push(span, || FileProblem::ShorterThanNothing {
                path,
                value,
                length,
                without_unit,
                motor: motor_of(robot, case, (k, i)).map(Box::new),
            });
        }
    }
}

/// The motor that drives a cable in a step, with what it is told.
fn motor_of(robot: &Robot, case: &Case, (step, cable): (usize, usize)) -> Option<CommandedMotor> {
    let drives = |motor: &&Motor| motor.cables.iter().any(|of| of.cable == cable);
    let (number, motor) = robot.motors().iter().enumerate().find(|(_, motor)| drives(motor))?;
    Some(CommandedMotor {
        name: quoted(&motor.name),
        command: (*case.motors.get(step)?.get(number)?)?,
        is_angle: matches!(motor.drive, Drive::Spool { .. }),
    })
}

/// The number of the cable that an error is about.
fn cable_of(error: &RobotError) -> Option<usize> {
    let (number, _) = error.path.strip_prefix("cables[")?.split_once(']')?;
    number.parse().ok()
}

/// The numbers of the step and of the cable in it that an error is about: those of
/// `steps[1].tension[2]` are 1 and 2.
fn step_of(error: &RobotError) -> Option<(usize, usize)> {
    let (step, rest) = error.path.strip_prefix("steps[")?.split_once(']')?;
    let (_, cable) = rest.strip_suffix(']')?.split_once('[')?;
    Some((step.parse().ok()?, cable.parse().ok()?))
}

/// The number of the step that a path is of.
fn step_number(path: &str) -> Option<usize> {
    path.strip_prefix("steps[")?.split_once(']')?.0.parse().ok()
}

impl Numbering {
    /// The path in the file of what the library names.
    fn path(&self, error: &RobotError) -> Option<String> {
        let (_, rest) = error.path.split_once(']')?;
        if let Some((step, cable)) = step_of(error) {
            let (list, _) = rest.split_once('[')?;
            return Some(format!("steps[{step}]{list}[{}]", self.cables.get(cable)?));
        }
        let cable = self.cables.get(cable_of(error)?)?;
        Some(match self.last_step {
            Some(step) if [".tension", ".shortening"].contains(&rest) => {
                format!("steps[{step}]{rest}[{cable}]")
            }
            _ => format!("cables[{cable}]{rest}"),
        })
    }
}

fn report(error: &RobotError, numbers: &Numbering, document: &Node, problems: &mut Problems) {
    let mut path = numbers.path(error).unwrap_or_else(|| error.path.clone());
    let mut problem = error.problem.clone();
    let mut related = None;
    if let Problem::DuplicateName { what, first, .. } = &mut problem {
        if *what == "cable" {
            *first = numbers.cables.get(*first).copied().unwrap_or(*first);
        }
        let list = match *what {
            "segment of the backbone" => "backbone.segments".to_owned(),
            other => format!("{other}s"),
        };
        let other = document.locate(&format!("{list}[{first}].name"));
        related = Some((other.span, "the other one is here"));
    }
    // The library knows only positions; the file may have given their number.
    if path == "disks.count" && document.locate("disks").has("positions") {
        "disks.positions".clone_into(&mut path);
    }
    let place = document.locate(&path);
    if matches!(&place.value, Value::Text(text) if text.trim_end().ends_with('%')) {
        problem = in_percent(problem);
    }
    let row = step_number(&path).and_then(|step| numbers.rows.get(step).copied());
    let span = row.unwrap_or(place.span);
    problems.push_related(span, related, || FileProblem::Physical { path, problem });
}

/// The same problem of a plain number that the file gives in per cent.
fn in_percent(problem: Problem) -> Problem {
    // Without the last digits, in which the file's number has been rounded.
    let percent = |ratio: f64| (ratio * 1e14).round() / 1e12;
    match problem {
        Problem::OutOfRange { value, range } if range.unit.is_empty() => Problem::OutOfRange {
            value: percent(value),
            range: Range {
                least: percent(range.least),
                greatest: percent(range.greatest),
                unit: "%",
                ..range
            },
        },
        other => other,
    }
}

/// What a model that refuses the robot or the case says, and where that is: at the value, or, where
/// it is missing, at the header of what it belongs to. `None` for what no file says.
pub(crate) fn refusal(error: &SolveError, document: &Node) -> Option<Diagnostic> {
    let (path, problem) = match error.clone() {
        SolveError::Invalid(RobotError { path, problem }) => {
            (path.clone(), FileProblem::Physical { path, problem })
        }
        SolveError::Missing { model, path, advice } => {
            (path.clone(), FileProblem::Needed { model, path, help: advice })
        }
        SolveError::Unsupported { model, path, what, advice } => {
            (path.clone(), FileProblem::NotTaken { model, path, what, help: advice })
        }
        _ => return None,
    };
    ROOT.key(path.split(['.', '[']).next()?)?;
    // A density is missed only by weight.
    let weight = path == "backbone.density" && document.locate("loads").has("gravity");
    let related =
        weight.then(|| (document.locate("loads.gravity").span, "the gravity is given here"));
    Some(Diagnostic { span: document.locate(&path).span, problem, related })
}

/// The same of a motion.
pub(crate) fn motion_refusal(error: &MotionError, document: &Node) -> Option<Diagnostic> {
    let (path, message, help) = match error {
        MotionError::Invalid(error) => {
            return refusal(&SolveError::Invalid(error.clone()), document);
        }
        MotionError::NoEquilibrium(error) => return refusal(error, document),
        MotionError::Missing { path, advice } => {
            (path, format!("the motion needs `{path}`"), *advice)
        }
        MotionError::Unsupported { path, what, advice } => {
            (path, format!("the motion cannot take {what}"), *advice)
        }
        _ => return None,
    };
    ROOT.key(path.split(['.', '[']).next()?)?;
    let problem = FileProblem::Measured { message, help: help.into() };
    Some(Diagnostic { span: document.locate(path).span, problem, related: None })
}
