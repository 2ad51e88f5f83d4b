use serde_json::{Map, Number, Value, json};
use whipcord::{
    CableOverlap, CableState, Contact, Diagnostics, Grasp, LengthMiss, Motor, MotorState,
    ObjectContact, ObjectState, Obstacle, Pose, Robot, Shape, Solution, Vec3, Wrench,
};

use whipcord::robot::DriveKeys;

use super::NonFinite;

/// A solution as the JSON object that `whipcord solve --json` prints. `solve_time` is in s, as
/// everything is in SI; the obstacles are those of the case, whose names the touches have. Where the robot is given, the cables
/// that pass through obstacles are listed.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn solution_json(
    title: &str,
    solution: &Solution,
    solve_time: f64,
    robot: Option<&Robot>,
    obstacles: &[Obstacle],
) -> Result<Value, NonFinite> {
    let stations = &solution.shape;
    let positions = stations.poses.iter().enumerate();
    let position: Vec<Value> = positions
        .map(|(i, pose)| vector(|| format!("shape.position[{i}]"), pose.position))
        .collect::<Result<_, _>>()?;
    let orientation: Vec<Value> = (stations.poses.iter().enumerate())
        .map(|(i, pose)| quaternion(|| format!("shape.orientation[{i}]"), pose))
        .collect::<Result<_, _>>()?;
    let wrench = solution.base_wrench.map(|wrench| -> Result<Value, NonFinite> {
        Ok(json!({
            "force": vector(|| "base_wrench.force".to_owned(), wrench.force)?,
            "moment": vector(|| "base_wrench.moment".to_owned(), wrench.moment)?,
        }))
    });
    let overlaps =
        robot.map_or_else(Vec::new, |robot| CableOverlap::all(robot, solution, obstacles));
    let mut object = json!({
        "title": title,
        "model": solution.model.name(),
        // A model answers with a converged solution or with an error.
        "status": match solution.diagnostics.length_misses.is_empty() {
            true => "converged",
            false => "least-squares",
        },
        // Null where it is not known: diagnostics.stability_absent says why.
        "stable": solution.diagnostics.stable,
        "shape": {
            "arc_length": numbers("shape.arc_length", &stations.arc_length)?,
            "position": position,
            "orientation": orientation,
        },
        "disks": disks(&solution.disks)?,
        "cables": solution.cables.iter().enumerate()
            .map(|(i, cable)| state(i, cable))
            .collect::<Result<Vec<_>, _>>()?,
        "base_wrench": wrench.transpose()?,
        "contacts": solution.contacts.iter().enumerate()
            .map(|(i, of)| touch(&format!("contacts[{i}]"), of, obstacles))
            .collect::<Result<Vec<_>, _>>()?,
        "grasps": Grasp::all(solution, obstacles).iter().enumerate()
            .map(|(i, of)| grasp(i, of, obstacles))
            .collect::<Result<Vec<_>, _>>()?,
        "cable_overlaps": overlaps.iter().enumerate()
            .map(|(i, of)| cable_overlap(i, of, solution, obstacles))
            .collect::<Result<Vec<_>, _>>()?,
        "diagnostics": diagnostics(&solution.diagnostics, solve_time)?,
    });
    if !solution.plastic_curvature.is_empty() {
        let held = solution.plastic_curvature.iter().enumerate();
        object["shape"]["plastic_curvature"] = held
            .map(|(i, held)| located(|| format!("shape.plastic_curvature[{i}]"), held))
            .collect::<Result<_, _>>()?;
    }
    if !solution.objects.is_empty() {
        let objects = solution.objects.iter().enumerate();
        object["objects"] =
            objects.map(|(i, of)| movable(i, of, obstacles)).collect::<Result<_, _>>()?;
    }
    Ok(object)
}

/// A movable object where it is in equilibrium.
fn movable(index: usize, state: &ObjectState, obstacles: &[Obstacle]) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("objects[{index}].{name}");
    let name = |number: usize| obstacles.get(number).map(|obstacle| obstacle.name.as_str());
    let wrench = |key: &str, wrench: Wrench| -> Result<Value, NonFinite> {
        Ok(json!({
            "force": vector(|| path(&format!("{key}.force")), wrench.force)?,
            "moment": vector(|| path(&format!("{key}.moment")), wrench.moment)?,
        }))
    };
    let contact = |(k, contact): (usize, &ObjectContact)| -> Result<Value, NonFinite> {
        let path = |name: &str| path(&format!("contacts[{k}].{name}"));
        Ok(json!({
            "obstacle": contact.obstacle,
            "name": name(contact.obstacle),
            "point": vector(|| path("point"), contact.point)?,
            "normal": vector(|| path("normal"), contact.normal)?,
            "force": number(|| path("force"), contact.force)?,
            "friction": vector(|| path("friction"), contact.friction)?,
            "sticks": contact.sticks,
            "gap": number(|| path("gap"), contact.gap)?,
        }))
    };
    Ok(json!({
        "obstacle": state.obstacle,
        "name": name(state.obstacle),
        "position": vector(|| path("position"), state.pose.position)?,
        "orientation": quaternion(|| path("orientation"), &state.pose)?,
        "center_of_mass": vector(|| path("center_of_mass"), state.center_of_mass)?,
        "load": wrench("load", state.load)?,
        "contacts": state.contacts.iter().enumerate().map(contact).collect::<Result<Vec<_>, _>>()?,
        "imbalance": wrench("imbalance", state.imbalance)?,
        "slip_margin": optional(|| path("slip_margin"), state.slip_margin)?,
    }))
}

/// The motors of a robot in an answer to these commands.
pub(super) fn motors_json(
    robot: &Robot,
    commands: &[Option<f64>],
    solution: &Solution,
) -> Result<Value, NonFinite> {
    let states = MotorState::all(robot, commands, solution);
    let of_motor = |(i, (motor, state)): (usize, (&Motor, MotorState))| {
        let path = |name: &str| format!("motors[{i}].{name}");
        let DriveKeys { command, effort, .. } = motor.drive.keys();
        let mut object = Map::new();
        object.insert("name".to_owned(), json!(motor.name));
        object.insert(command.to_owned(), optional(|| path(command), state.command)?);
        object.insert(effort.to_owned(), optional(|| path(effort), state.effort)?);
        let utilization = optional(|| path("utilization"), state.utilization)?;
        object.insert("utilization".to_owned(), utilization);
        Ok(Value::Object(object))
    };
    robot.motors().iter().zip(states).enumerate().map(of_motor).collect()
}

fn disks(shape: &Shape) -> Result<Vec<Value>, NonFinite> {
    (shape.arc_length.iter().zip(&shape.poses).enumerate())
        .map(|(i, (&arc_length, pose))| {
            let path = |name: &str| format!("disks[{i}].{name}");
            Ok(json!({
                "arc_length": number(|| path("arc_length"), arc_length)?,
                "position": vector(|| path("position"), pose.position)?,
                "orientation": quaternion(|| path("orientation"), pose)?,
            }))
        })
        .collect()
}

fn state(index: usize, cable: &CableState) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("cables[{index}].{name}");
    let mut object = json!({
        "name": cable.name,
        "tension": optional(|| path("tension"), cable.tension)?,
        "length": number(|| path("length"), cable.length)?,
        "initial_length": number(|| path("initial_length"), cable.initial_length)?,
        "slack": cable.slack,
    });
    if !cable.span_tensions.is_empty() {
        object["span_tensions"] = numbers(&path("span_tensions"), &cable.span_tensions)?;
        object["slip_states"] = cable.slip_states.iter().map(|contact| contact.name()).collect();
    }
    Ok(object)
}

/// Obstacles and disks count from 0, as everything in JSON does.
pub(super) fn touch(
    place: &str,
    touch: &Contact,
    obstacles: &[Obstacle],
) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("{place}.{name}");
    Ok(json!({
        "obstacle": touch.obstacle,
        "name": obstacles.get(touch.obstacle).map(|obstacle| obstacle.name.as_str()),
        "part": touch.part.name(),
        "disk": touch.part.disk(),
        "arc_length": number(|| path("arc_length"), touch.arc_length)?,
        "point": vector(|| path("point"), touch.point)?,
        "normal": vector(|| path("normal"), touch.normal)?,
        "force": optional(|| path("force"), touch.force)?,
        "friction": match touch.friction {
            Some(friction) => vector(|| path("friction"), friction)?,
            None => Value::Null,
        },
        "sticks": touch.sticks,
        "gap": number(|| path("gap"), touch.gap)?,
    }))
}

/// What the robot exerts on an obstacle, all its contacts together.
fn grasp(index: usize, grasp: &Grasp, obstacles: &[Obstacle]) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("grasps[{index}].{name}");
    let part = |name: &str, of: fn(Wrench) -> Vec3| match grasp.wrench {
        Some(wrench) => vector(|| path(name), of(wrench)),
        None => Ok(Value::Null),
    };
    Ok(json!({
        "obstacle": grasp.obstacle,
        "name": obstacles.get(grasp.obstacle).map(|obstacle| obstacle.name.as_str()),
        "contacts": grasp.contacts,
        "sliding": grasp.sliding,
        "normal_force": optional(|| path("normal_force"), grasp.normal_force)?,
        "force": part("force", |wrench| wrench.force)?,
        "moment": part("moment", |wrench| wrench.moment)?,
        "slip_margin": optional(|| path("slip_margin"), grasp.slip_margin)?,
    }))
}

/// A cable that passes through an obstacle; spans count from 0.
fn cable_overlap(
    index: usize,
    overlap: &CableOverlap,
    solution: &Solution,
    obstacles: &[Obstacle],
) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("cable_overlaps[{index}].{name}");
    Ok(json!({
        "cable": solution.cables.get(overlap.cable).map(|cable| cable.name.as_str()),
        "span": overlap.span,
        "obstacle": overlap.obstacle,
        "name": obstacles.get(overlap.obstacle).map(|obstacle| obstacle.name.as_str()),
        "arc_length": number(|| path("arc_length"), overlap.arc_length)?,
        "point": vector(|| path("point"), overlap.point)?,
        "normal": vector(|| path("normal"), overlap.normal)?,
        "depth": number(|| path("depth"), overlap.depth)?,
        "force": optional(|| path("force"), overlap.force)?,
    }))
}

fn diagnostics(diagnostics: &Diagnostics, solve_time: f64) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("diagnostics.{name}");
    let mut object = Map::new();
    let mut insert = |name: &str, value: Value| object.insert(name.to_owned(), value);
    insert("iterations", json!(diagnostics.iterations));
    insert("residual", number(|| path("residual"), diagnostics.residual)?);
    insert("stability", optional(|| path("stability"), diagnostics.stability)?);
    if let Some(reason) = diagnostics.stability_absent {
        insert("stability_absent", json!(reason.name()));
    }
    let error = diagnostics.discretization_error;
    insert("discretization_error", optional(|| path("discretization_error"), error)?);
    insert("steps", json!(diagnostics.steps));
    if !diagnostics.length_misses.is_empty() {
        insert("length_misses", length_misses_json(&diagnostics.length_misses));
    }
    let lost_at = diagnostics.stability_lost_at;
    insert("stability_lost_at", optional(|| path("stability_lost_at"), lost_at)?);
    insert("solve_time", number(|| path("solve_time"), solve_time)?);
    insert("version", json!(env!("CARGO_PKG_VERSION")));
    Ok(Value::Object(object))
}

/// What each cable misses in a least-squares answer to lengths that contradict each other, in m.
#[must_use]
pub fn length_misses_json(misses: &[LengthMiss]) -> Value {
    misses.iter().map(|of| json!({ "cable": of.cable, "excess": of.excess })).collect()
}

/// A number as JSON.
///
/// # Errors
/// [`NonFinite`] with the path where it stands.
pub fn number(path: impl FnOnce() -> String, value: f64) -> Result<Value, NonFinite> {
    match Number::from_f64(value) {
        Some(number) => Ok(Value::Number(number)),
        None => Err(NonFinite { path: path(), value }),
    }
}

/// A number or null as JSON.
///
/// # Errors
/// As [`number`].
pub fn optional(path: impl FnOnce() -> String, value: Option<f64>) -> Result<Value, NonFinite> {
    value.map_or(Ok(Value::Null), |value| number(path, value))
}

pub(super) fn numbers(path: &str, values: &[f64]) -> Result<Value, NonFinite> {
    let entries = values.iter().enumerate();
    entries.map(|(i, &value)| number(|| format!("{path}[{i}]"), value)).collect()
}

pub(super) fn vector(path: impl FnOnce() -> String, vector: Vec3) -> Result<Value, NonFinite> {
    located(path, &vector.to_array())
}

pub(super) fn quaternion(path: impl FnOnce() -> String, pose: &Pose) -> Result<Value, NonFinite> {
    located(path, &pose.rotation.wxyz())
}

fn located(path: impl FnOnce() -> String, values: &[f64]) -> Result<Value, NonFinite> {
    if values.iter().all(|value| value.is_finite()) {
        return Ok(json!(values));
    }
    numbers(&path(), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{
        Form, InternalState, ModelKind, NoStability, Part, SlipState, UnitQuaternion, Wrench,
    };

    fn solution() -> Solution {
        let shape = Shape {
            arc_length: vec![0.0, 0.18],
            poses: vec![
                Pose::default(),
                Pose {
                    position: Vec3::new(0.0, 0.1, 0.15),
                    rotation: UnitQuaternion::from_wxyz([0.8, -0.6, 0.0, 0.0]).unwrap(),
                },
            ],
        };
        Solution {
            model: ModelKind::Cosserat,
            disks: shape.clone(),
            shape,
            cables: vec![
                CableState {
                    name: "pull".to_owned(),
                    tension: Some(3.92),
                    length: 0.172,
                    initial_length: 0.1828,
                    slack: false,
                    span_tensions: vec![3.5, 3.1],
                    slip_states: vec![SlipState::Pulled, SlipState::Sticks],
                },
                CableState {
                    name: "idle".to_owned(),
                    tension: None,
                    length: 0.18,
                    initial_length: 0.18,
                    slack: true,
                    span_tensions: Vec::new(),
                    slip_states: Vec::new(),
                },
            ],
            base_wrench: Some(Wrench::default()),
            plastic_curvature: vec![[0.0, 0.5], [0.0, 0.25]],
            contacts: vec![
                Contact {
                    obstacle: 0,
                    part: Part::Disk(1),
                    arc_length: 0.18,
                    point: Vec3::new(0.0, 0.11, 0.15),
                    normal: -Vec3::Y,
                    force: Some(0.25),
                    friction: Some(Vec3::ZERO),
                    sticks: false,
                    gap: -1e-9,
                },
                Contact {
                    obstacle: 1,
                    part: Part::Backbone,
                    arc_length: 0.09,
                    point: Vec3::ZERO,
                    normal: Vec3::Z,
                    force: None,
                    friction: None,
                    sticks: false,
                    gap: 0.0,
                },
            ],
            objects: Vec::new(),
            internal: InternalState::default(),
            diagnostics: Diagnostics {
                steps: 18,
                stability_absent: Some(NoStability::NotAsked),
                ..Diagnostics::default()
            },
        }
    }

    fn ball() -> Obstacle {
        let form = Form::Sphere { radius: 0.02 };
        Obstacle {
            name: "ball".to_owned(),
            form,
            pose: Pose::IDENTITY,
            friction: 0.0,
            movable: None,
        }
    }

    #[test]
    fn a_solution_has_the_keys_of_the_contract() {
        let mut value = solution_json("Case III", &solution(), 4.1e-6, None, &[ball()]).unwrap();
        value["diagnostics"]["version"] = json!("x.y.z");
        insta::assert_json_snapshot!(value);
    }

    #[test]
    fn a_number_that_is_none_is_an_error_and_not_null() {
        let mut bad = solution();
        bad.shape.poses[1].position.y = f64::NAN;
        let error = solution_json("", &bad, 0.0, None, &[]).unwrap_err();
        assert_eq!(error.path, "shape.position[1][1]");
        bad = solution();
        bad.cables[0].tension = Some(f64::INFINITY);
        let error = solution_json("", &bad, 0.0, None, &[]).unwrap_err();
        assert_eq!(error.to_string(), "cables[0].tension is inf, which is no result");
    }
}
