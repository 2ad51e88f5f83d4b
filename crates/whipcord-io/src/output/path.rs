//! Steps, branches and iterations as JSON.

use serde_json::{Value, json};
use whipcord::cosserat::TraceEvent;
use whipcord::{Branches, Case, CriticalKind, CriticalPoint, Robot, Solution};

use super::NonFinite;
use super::json::{motors_json, number, numbers, solution_json, vector};

/// What an answer may be told with beside itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside<'a> {
    /// The answers of all steps of actuation, each with its solve time in s, where there are
    /// several; the last is that of the case.
    pub steps: &'a [(&'a Solution, f64)],
    /// All equilibria of the case.
    pub branches: Option<&'a Branches>,
    /// The iterations of its solve.
    pub trace: Option<&'a [TraceEvent]>,
    /// The robot, whose cables may pass through obstacles, and whose motors hold them.
    pub robot: Option<&'a Robot>,
    /// What was asked of it, with the obstacles and the commands of the motors.
    pub case: Option<&'a Case>,
}

/// [`solution_json`], with what else there is: one such object for each step under `steps`, the
/// equilibria of a case under `branches` and what lies between them under `critical_points`, and the
/// iterations under `trace`.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn answer_json(
    title: &str,
    solution: &Solution,
    solve_time: f64,
    beside: &Beside<'_>,
) -> Result<Value, NonFinite> {
    let Beside { robot, case, .. } = *beside;
    let obstacles = case.map_or(&[][..], |case| &case.obstacles);
    // Steps count from the last one.
    let commands = |back: usize| {
        let motors = case.map_or(&[][..], |case| &case.motors);
        let at = motors.len().checked_sub(back + 1);
        at.map_or(&[][..], |at| motors[at].as_slice())
    };
    let of_step = |solution: &Solution, time, back: usize| -> Result<Value, NonFinite> {
        let mut object = solution_json(title, solution, time, robot, obstacles)?;
        if let Some(robot) = robot.filter(|robot| !robot.motors().is_empty()) {
            object["motors"] = motors_json(robot, commands(back), solution)?;
        }
        Ok(object)
    };
    let of = |solution: &Solution, time| of_step(solution, time, 0);
    let mut object = of(solution, solve_time)?;
    if !beside.steps.is_empty() {
        let count = beside.steps.len();
        let steps = beside.steps.iter().enumerate();
        let steps = steps.map(|(k, &(step, time))| of_step(step, time, count - 1 - k));
        object["steps"] = steps.collect::<Result<Vec<_>, _>>()?.into();
    }
    if let Some(branches) = beside.branches {
        let equilibria = branches.equilibria.iter().map(|equilibrium| {
            let mut value = of(&equilibrium.solution, solve_time)?;
            // All were found in one walk, none in a time of its own.
            value["diagnostics"]["solve_time"] = Value::Null;
            value["branch"] = json!(equilibrium.branch);
            value["stable"] = json!(equilibrium.stable);
            Ok(value)
        });
        object["branches"] = equilibria.collect::<Result<Vec<_>, _>>()?.into();
        let points = branches.critical_points.iter().enumerate();
        let points = points.map(|(i, point)| critical(i, point));
        object["critical_points"] = points.collect::<Result<Vec<_>, _>>()?.into();
    }
    if let Some(trace) = beside.trace {
        object["trace"] = iterations(trace)?;
    }
    Ok(object)
}

fn critical(index: usize, point: &CriticalPoint) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("critical_points[{index}].{name}");
    let (kind, leads_to) = match &point.kind {
        CriticalKind::Limit => ("limit", &[][..]),
        CriticalKind::CableSlackens => ("cable-slackens", &[][..]),
        CriticalKind::Bifurcation(others) => ("bifurcation", &others[..]),
    };
    Ok(json!({
        "branch": point.branch,
        "load": number(|| path("load"), point.load)?,
        "kind": kind,
        "leads_to": leads_to,
        "tip": vector(|| path("tip"), point.tip)?,
    }))
}

fn iterations(events: &[TraceEvent]) -> Result<Value, NonFinite> {
    let events = events.iter().enumerate().map(|(i, event)| {
        let path = |name: &str| format!("trace[{i}].{name}");
        Ok(json!({
            "stage": event.stage.name(),
            "steps": event.steps,
            "load": number(|| path("load"), event.load)?,
            "iteration": event.iteration,
            "residual": number(|| path("residual"), event.residual)?,
            "step": number(|| path("step"), event.step)?,
            "tensions": numbers(&path("tensions"), &event.tensions)?,
        }))
    });
    Ok(events.collect::<Result<Vec<_>, _>>()?.into())
}
