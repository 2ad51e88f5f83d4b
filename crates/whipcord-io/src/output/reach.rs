//! The answer to an inverse problem as JSON.

use serde_json::{Map, Value, json};
use whipcord::{MotorState, Robot, Solution};
use whipcord_inverse::{
    Actuator, Followed, InverseSolver, Limit, NoProof, PathPoint, Reached, Tolerance,
};

use super::NonFinite;
use super::csv::{Cell, CsvTable};
use super::json::{number, numbers, optional, quaternion, vector};
use super::path::{Beside, answer_json};

/// The answer as the JSON object that `whipcord reach --json` prints, in SI units; cables, motors and obstacles count from 0. The shape
/// is under `solution`, as `whipcord solve --json` prints it.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn reach_json(
    title: &str,
    robot: &Robot,
    solver: &InverseSolver,
    tolerance: Tolerance,
    reached: &Reached,
) -> Result<Value, NonFinite> {
    let mut object = heading(title, &reached.solution);
    answer(&mut object, robot, solver, reached)?;
    asked(&mut object, robot, solver, tolerance)?;
    let beside = Beside { robot: Some(robot), case: Some(&reached.case), ..Beside::default() };
    let mut solved = answer_json(title, &reached.solution, 0.0, &beside)?;
    // It is one of many solves, none of which is timed.
    solved["diagnostics"]["solve_time"] = Value::Null;
    object.insert("solution".to_owned(), solved);
    Ok(Value::Object(object))
}

/// The answers along a path as the JSON object that `whipcord reach --json` prints for one: those of the points under `points`, and the
/// places where the robot does not move smoothly under `jumps`.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn follow_json(
    title: &str,
    robot: &Robot,
    solver: &InverseSolver,
    tolerance: Tolerance,
    path: &[PathPoint],
    followed: &Followed,
) -> Result<Value, NonFinite> {
    let mut object =
        followed.answers.first().map(|first| heading(title, &first.solution)).unwrap_or_default();
    object.insert("reached".to_owned(), json!(followed.reached()));
    asked(&mut object, robot, solver, tolerance)?;
    let points = path.iter().zip(&followed.answers).enumerate();
    let points = points.map(|(i, (point, reached))| {
        let mut object = Map::new();
        object.insert("time".to_owned(), number(|| format!("points[{i}].time"), point.time)?);
        let tip = reached.solution.disks.tip();
        let path = |name: &str| format!("points[{i}].{name}");
        object.insert("position".to_owned(), vector(|| path("position"), tip.position)?);
        object.insert("orientation".to_owned(), quaternion(|| path("orientation"), &tip)?);
        answer(&mut object, robot, solver, reached)?;
        Ok(Value::Object(object))
    });
    object.insert("points".to_owned(), points.collect::<Result<_, NonFinite>>()?);
    let jumps = followed.jumps.iter().enumerate().map(|(i, jump)| {
        let distance = number(|| format!("jumps[{i}].distance"), jump.distance)?;
        Ok(json!({ "point": jump.point, "kind": jump.kind.name(), "distance": distance }))
    });
    object.insert("jumps".to_owned(), jumps.collect::<Result<_, NonFinite>>()?);
    Ok(Value::Object(object))
}

/// The commands along a path, in the columns of a table for `[commands]` of a robot file: the time in s, and one column for each actuator.
#[must_use]
pub fn path_table(
    robot: &Robot,
    solver: &InverseSolver,
    path: &[PathPoint],
    followed: &Followed,
) -> CsvTable {
    let commands = solver.actuators().iter().map(|actuator| {
        let (command, name) = named(robot, *actuator);
        format!("{name}.{command}")
    });
    let mut table = CsvTable::new(core::iter::once("time".to_owned()).chain(commands));
    for (point, answer) in path.iter().zip(&followed.answers) {
        let all = core::iter::once(point.time).chain(answer.commands.iter().copied());
        table.push(all.map(Cell::Number));
    }
    table
}

fn heading(title: &str, solution: &Solution) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("title".to_owned(), json!(title));
    object.insert("model".to_owned(), json!(solution.model.name()));
    object
}

/// Adds how far an answer may be from its target, and what was searched.
fn asked(
    object: &mut Map<String, Value>,
    robot: &Robot,
    solver: &InverseSolver,
    tolerance: Tolerance,
) -> Result<(), NonFinite> {
    for (key, value) in [("tolerance", tolerance.position), ("tolerance_angle", tolerance.angle)] {
        object.insert(key.to_owned(), number(|| key.to_owned(), value)?);
    }
    object.insert("search_ranges".to_owned(), searched(robot, solver)?.into());
    Ok(())
}

/// Adds an answer without its shape.
fn answer(
    object: &mut Map<String, Value>,
    robot: &Robot,
    solver: &InverseSolver,
    reached: &Reached,
) -> Result<(), NonFinite> {
    let solution = &reached.solution;
    let cables = solution.cables.iter().enumerate();
    let tensions = cables.map(|(i, of)| optional(|| format!("tensions[{i}]"), of.tension));
    let lengths: Vec<f64> = solution.cables.iter().map(|of| of.length).collect();
    let commands = reached.case.motors.last().map_or(&[][..], Vec::as_slice);
    let motors = MotorState::all(robot, commands, solution);
    let motors = motors.iter().enumerate();
    let motors = motors.map(|(i, of)| optional(|| format!("motors[{i}]"), of.command));
    let limits = reached.active_limits.iter().map(|of| limit(*of, robot, solver.actuators()));
    let null_space = reached.null_space.iter().enumerate();
    let null_space = null_space.map(|(i, of)| numbers(&format!("null_space[{i}]"), of));
    for (key, value) in [
        ("status", json!(reached.status.name())),
        ("tensions", tensions.collect::<Result<_, _>>()?),
        ("lengths", numbers("lengths", &lengths)?),
        ("motors", motors.collect::<Result<_, _>>()?),
        ("error", number(|| "error".to_owned(), reached.miss.position)?),
        ("error_angle", number(|| "error_angle".to_owned(), reached.miss.angle)?),
        ("lower_bound", optional(|| "lower_bound".to_owned(), reached.lower_bound)?),
        // Why there is none where it was asked for.
        ("no_proof", json!(reached.no_proof.map(NoProof::words))),
        ("active_limits", limits.collect()),
        ("null_space", null_space.collect::<Result<_, _>>()?),
        ("starts", json!(reached.starts)),
        ("solves", json!(reached.solves)),
        ("commands", commanded(robot, solver, reached)?.into()),
    ] {
        object.insert(key.to_owned(), value);
    }
    Ok(())
}

/// Which command of what: its kind and a name.
pub(super) fn named(robot: &Robot, actuator: Actuator) -> (&'static str, &str) {
    match actuator {
        Actuator::Tension(cable) => ("tension", &robot.cables()[cable].name),
        Actuator::Shortening(cable) => ("shortening", &robot.cables()[cable].name),
        Actuator::Motor(motor) => {
            let motor = &robot.motors()[motor];
            (motor.drive.keys().command, &motor.name)
        }
    }
}

/// The commands that were sought.
fn commanded(
    robot: &Robot,
    solver: &InverseSolver,
    reached: &Reached,
) -> Result<Vec<Value>, NonFinite> {
    let of = solver.actuators().iter().zip(&reached.commands).enumerate();
    of.map(|(i, (actuator, command))| {
        let (kind, name) = named(robot, *actuator);
        let value = number(|| format!("commands[{i}].value"), *command)?;
        Ok(json!({ "command": kind, "name": name, "value": value }))
    })
    .collect()
}

/// The ranges that were searched, and whether their ends were assumed because no limit is given.
pub(super) fn searched(robot: &Robot, solver: &InverseSolver) -> Result<Vec<Value>, NonFinite> {
    let of = solver.search_ranges().into_iter().enumerate();
    of.map(|(i, searched)| {
        let (kind, name) = named(robot, searched.actuator);
        let range = numbers(&format!("search_ranges[{i}].range"), &searched.range)?;
        let assumed = searched.assumed;
        Ok(json!({ "command": kind, "name": name, "range": range, "assumed": assumed }))
    })
    .collect()
}

fn limit(limit: Limit, robot: &Robot, actuators: &[Actuator]) -> Value {
    json!({ "limit": limit.name(), "of": limit.of(), "words": limit.words(robot, actuators) })
}
