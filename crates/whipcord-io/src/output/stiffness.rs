use serde_json::{Value, json};
use whipcord::kinematics::{
    Compliance, Compliances, DerivativeMethod, Dexterity, DrivenBy, Local, Matrix6, principal_axes,
};
use whipcord::{Mat3, NoStability, Solution, Vec3};

use super::NonFinite;
use super::json::{number, numbers, optional, quaternion, vector};

/// What a robot's answer says of one place, the first station of the solution, as the JSON object
/// that `whipcord stiffness --json` prints; SI. The pose of the place is in the world, all else in the
/// frame of the base.
///
/// Rows of a compliance are translation (x, y, z) and rotation (x, y, z), columns force and moment;
/// of a stiffness the other way round; both are null from a model that does not know them, and
/// `yield_unknown` says why. `one_sided` names what is about to change at the answer, so that the derivatives are those of one side; with
/// `lengths_dependent` the commanded lengths leave the tensions undetermined. Rows of the Jacobian are translation and rotation, of that of the lengths the
/// cables; columns are the commands of the cables.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn stiffness_json(title: &str, solution: &Solution, local: &Local) -> Result<Value, NonFinite> {
    let place = |name: &str| format!("place.{name}");
    let pose = solution.shape.tip();
    let arc_length = solution.shape.arc_length.first().copied().unwrap_or_default();
    let cables: Vec<Value> = solution
        .cables
        .iter()
        .zip(&local.driven_by)
        .enumerate()
        .map(|(i, (cable, driven_by))| {
            let path = |name: &str| format!("cables[{i}].{name}");
            Ok(json!({
                "name": cable.name,
                "driven_by": command(*driven_by),
                "tension": optional(|| path("tension"), cable.tension)?,
                "length": number(|| path("length"), cable.length)?,
                "slack": cable.slack,
            }))
        })
        .collect::<Result<_, NonFinite>>()?;
    let jacobian: Vec<Value> = (0..6)
        .map(|row| {
            let entries: Vec<f64> = local
                .actuation_jacobian
                .iter()
                .map(|t| if row < 3 { t.linear[row] } else { t.angular[row - 3] })
                .collect();
            numbers(&format!("actuation_jacobian[{row}]"), &entries)
        })
        .collect::<Result<_, _>>()?;
    let dexterity: Vec<Value> = (local.dexterity().iter().enumerate())
        .map(|(i, (driven_by, dexterity))| moved(&format!("dexterity[{i}]"), *driven_by, dexterity))
        .collect::<Result<_, _>>()?;
    let lengths: Vec<Value> = (local.length_jacobian.iter().enumerate())
        .map(|(i, row)| numbers(&format!("length_jacobian[{i}]"), row))
        .collect::<Result<_, _>>()?;
    let held = |path: &str, of: fn(&Compliances) -> &Compliance| match &local.compliances {
        Ok(yields) => yielding(path, of(yields)),
        Err(_) => Ok(Value::Null),
    };
    let stability = solution.diagnostics.stability;
    Ok(json!({
        "title": title,
        "model": solution.model.name(),
        "status": "converged",
        "stable": solution.diagnostics.stable,
        "place": {
            "arc_length": number(|| place("arc_length"), arc_length)?,
            "position": vector(|| place("position"), pose.position)?,
            "orientation": quaternion(|| place("orientation"), &pose)?,
            "frame": "world",
        },
        "derivatives": match local.method {
            DerivativeMethod::Exact => json!({ "frame": "base", "by": "exact", "estimated_error": null }),
            DerivativeMethod::Differences { error } => json!({
                "frame": "base",
                "by": "differences",
                "estimated_error": number(|| "derivatives.estimated_error".to_owned(), error)?,
            }),
        },
        "one_sided": local.one_sided.names().collect::<Vec<_>>(),
        "lengths_dependent": local.are_lengths_dependent,
        "cables": cables,
        "actuation_jacobian": jacobian,
        "dexterity": dexterity,
        "length_jacobian": lengths,
        "tensions_held": held("tensions_held", |yields| &yields.tensions_held)?,
        "lengths_held": held("lengths_held", |yields| &yields.lengths_held)?,
        "yield_unknown": local.compliances.as_ref().err().map(ToString::to_string),
        "stability": optional(|| "stability".to_owned(), stability)?,
        "stability_absent": solution.diagnostics.stability_absent.map(NoStability::name),
        "version": env!("CARGO_PKG_VERSION"),
    }))
}

const fn command(driven_by: DrivenBy) -> &'static str {
    match driven_by {
        DrivenBy::Tension => "tension",
        DrivenBy::Shortening => "shortening",
    }
}

/// How well the cables of one kind move the place, with the directions of motion, most first.
fn moved(path: &str, driven_by: DrivenBy, dexterity: &Dexterity) -> Result<Value, NonFinite> {
    let (motion, along): (Vec<f64>, Vec<Vec3>) = dexterity.motions().unzip();
    Ok(json!({
        "driven_by": command(driven_by),
        "manipulability": number(|| format!("{path}.manipulability"), dexterity.manipulability)?,
        "directions": dexterity.directions,
        "condition": optional(|| format!("{path}.condition"), dexterity.condition)?,
        "translation": {
            "motion": numbers(&format!("{path}.translation.motion"), &motion)?,
            "directions": directions(&format!("{path}.translation"), &along)?,
        },
    }))
}

fn directions(path: &str, directions: &[Vec3]) -> Result<Vec<Value>, NonFinite> {
    let along = directions.iter().enumerate();
    along.map(|(i, d)| vector(|| format!("{path}.directions[{i}]"), *d)).collect()
}

fn yielding(path: &str, yielding: &Compliance) -> Result<Value, NonFinite> {
    let stiffness = match &yielding.stiffness {
        Some(matrix) => by_rows(&format!("{path}.stiffness"), matrix)?,
        None => Value::Null,
    };
    Ok(json!({
        "compliance": by_rows(&format!("{path}.compliance"), &yielding.compliance)?,
        "stiffness": stiffness,
        "translation": axes(&format!("{path}.translation"), &yielding.compliance.blocks[0][0])?,
        "rotation": axes(&format!("{path}.rotation"), &yielding.compliance.blocks[1][1])?,
    }))
}

/// Principal compliances, ascending, and their directions.
fn axes(path: &str, block: &Mat3) -> Result<Value, NonFinite> {
    let axes = principal_axes(block);
    Ok(json!({
        "compliance": numbers(&format!("{path}.compliance"), &axes.values)?,
        "directions": directions(path, &axes.directions)?,
    }))
}

fn by_rows(path: &str, matrix: &Matrix6) -> Result<Value, NonFinite> {
    let rows = matrix.rows();
    rows.iter().enumerate().map(|(i, row)| numbers(&format!("{path}[{i}]"), row)).collect()
}
