use serde_json::{Value, json};
use whipcord::kinematics::{DrivenBy, Local, Matrix6, Means, Yield, principal_axes};
use whipcord::{Mat3, Solution};

use super::NonFinite;
use super::json::{number, numbers, optional, quaternion, vector};

/// What a robot's answer says of one place, the first station of the solution, as the JSON object
/// that `whipcord stiffness --json` prints; SI. The pose of the place is in the world, all else in the
/// frame of the base.
///
/// Rows of a compliance are translation (x, y, z) and rotation (x, y, z), columns force and moment;
/// of a stiffness the other way round. Rows of the Jacobian are translation and rotation, columns the
/// cables.
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
                "driven_by": match driven_by {
                    DrivenBy::Tension => "tension",
                    DrivenBy::Shortening => "shortening",
                },
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
    let dexterity = local.dexterity();
    let stability = solution.diagnostics.stability;
    Ok(json!({
        "title": title,
        "model": solution.model.name(),
        "status": "converged",
        "place": {
            "arc_length": number(|| place("arc_length"), arc_length)?,
            "position": vector(|| place("position"), pose.position)?,
            "orientation": quaternion(|| place("orientation"), &pose)?,
        },
        "frame": "base",
        "derivatives": match local.means {
            Means::Exact => json!({ "by": "exact", "estimated_error": null }),
            Means::Differences { error } => json!({
                "by": "differences",
                "estimated_error": number(|| "derivatives.estimated_error".to_owned(), error)?,
            }),
        },
        "cables": cables,
        "actuation_jacobian": jacobian,
        "dexterity": {
            "manipulability": number(|| "dexterity.manipulability".to_owned(), dexterity.manipulability)?,
            "directions": dexterity.directions,
            "condition": optional(|| "dexterity.condition".to_owned(), dexterity.condition)?,
        },
        "tensions_held": yielding("tensions_held", &local.tensions_held)?,
        "lengths_held": yielding("lengths_held", &local.lengths_held)?,
        "stability": optional(|| "stability".to_owned(), stability)?,
        "version": env!("CARGO_PKG_VERSION"),
    }))
}

fn yielding(path: &str, yielding: &Yield) -> Result<Value, NonFinite> {
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
    let directions: Vec<Value> = axes
        .directions
        .iter()
        .enumerate()
        .map(|(i, direction)| vector(|| format!("{path}.directions[{i}]"), *direction))
        .collect::<Result<_, _>>()?;
    Ok(json!({
        "compliance": numbers(&format!("{path}.compliance"), &axes.values)?,
        "directions": directions,
    }))
}

fn by_rows(path: &str, matrix: &Matrix6) -> Result<Value, NonFinite> {
    let rows = matrix.rows();
    rows.iter().enumerate().map(|(i, row)| numbers(&format!("{path}[{i}]"), row)).collect()
}
