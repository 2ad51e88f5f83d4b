//! The answer to an inverse problem as JSON.

use serde_json::{Value, json};
use whipcord::{MotorState, Robot};
use whipcord_inverse::{Actuator, InverseSolver, Limit, NoProof, Reached, Tolerance};

use super::NonFinite;
use super::json::{number, numbers, optional};
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
    let solution = &reached.solution;
    let beside = Beside { robot: Some(robot), case: Some(&reached.case), ..Beside::default() };
    let mut solved = answer_json(title, solution, 0.0, &beside)?;
    // It is one of many solves, none of which is timed.
    solved["diagnostics"]["solve_time"] = Value::Null;
    let cables = solution.cables.iter().enumerate();
    let tensions = cables.clone().map(|(i, of)| optional(|| format!("tensions[{i}]"), of.tension));
    let lengths: Vec<f64> = solution.cables.iter().map(|of| of.length).collect();
    let commands = reached.case.motors.last().map_or(&[][..], Vec::as_slice);
    let motors = MotorState::all(robot, commands, solution);
    let motors = motors.iter().enumerate();
    let motors = motors.map(|(i, of)| optional(|| format!("motors[{i}]"), of.command));
    let limits = reached.active_limits.iter().map(|of| limit(*of, robot, solver.actuators()));
    let null_space = reached.null_space.iter().enumerate();
    let null_space = null_space.map(|(i, of)| numbers(&format!("null_space[{i}]"), of));
    Ok(json!({
        "title": title,
        "model": solution.model.name(),
        "status": reached.status.name(),
        "tensions": tensions.collect::<Result<Vec<_>, _>>()?,
        "lengths": numbers("lengths", &lengths)?,
        "motors": motors.collect::<Result<Vec<_>, _>>()?,
        "error": number(|| "error".to_owned(), reached.miss.position)?,
        "error_angle": number(|| "error_angle".to_owned(), reached.miss.angle)?,
        "tolerance": number(|| "tolerance".to_owned(), tolerance.position)?,
        "tolerance_angle": number(|| "tolerance_angle".to_owned(), tolerance.angle)?,
        "lower_bound": optional(|| "lower_bound".to_owned(), reached.lower_bound)?,
        // Why there is none where it was asked for.
        "no_proof": reached.no_proof.map(NoProof::words),
        "active_limits": limits.collect::<Vec<_>>(),
        "null_space": null_space.collect::<Result<Vec<_>, _>>()?,
        "starts": reached.starts,
        "solves": reached.solves,
        "commands": commanded(robot, solver, reached)?,
        "search_ranges": searched(robot, solver)?,
        "solution": solved,
    }))
}

/// Which command of what: its kind and a name.
fn named(robot: &Robot, actuator: Actuator) -> (&'static str, &str) {
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
fn searched(robot: &Robot, solver: &InverseSolver) -> Result<Vec<Value>, NonFinite> {
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
