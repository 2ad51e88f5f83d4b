//! A design as JSON and as tables.

use serde_json::{Map, Value, json};
use whipcord::{Robot, Routing};
use whipcord_design::{
    CriterionResult, Design, Ended, GoalResult, Quantity, Sampled, TolerancesResult, spread,
};

use super::NonFinite;
use super::csv::{Cell, CsvTable};
use super::json::{number, numbers, optional, vector};
use super::path::{Beside, answer_json};

/// The design as the JSON object that `whipcord design --json` prints, in SI units. Disks and holes count from 1, targets and cables from 0.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn design_json(
    title: &str,
    design: &Design,
    tolerances: Option<&TolerancesResult>,
) -> Result<Value, NonFinite> {
    let mut object = Map::new();
    object.insert("title".to_owned(), json!(title));
    object.insert("model".to_owned(), json!(design.model.name()));
    object.insert("proven".to_owned(), json!(design.is_proven()));
    object.insert("error".to_owned(), number(|| "error".to_owned(), design.error)?);
    object
        .insert("largest_error".to_owned(), number(|| "largest_error".to_owned(), design.largest)?);
    let before = match design.before {
        None => Value::Null,
        Some([error, largest]) => json!({
            "error": number(|| "before.error".to_owned(), error)?,
            "largest_error": number(|| "before.largest_error".to_owned(), largest)?,
        }),
    };
    object.insert("before".to_owned(), before);
    let bound = design.lower_bound.map(|bound| number(|| "lower_bound".to_owned(), bound));
    object.insert("lower_bound".to_owned(), bound.transpose()?.unwrap_or_default());
    object.insert("ended".to_owned(), json!(design.ended.map(Ended::name)));
    object.insert("solves".to_owned(), json!(design.solves));
    let findings = design.findings.iter().map(|finding| {
        json!({
            "vary": finding.what,
            "known": finding.known.name(),
            "proven": finding.known.is_proven(),
            "words": finding.known.to_string(),
        })
    });
    object.insert("findings".to_owned(), findings.collect());
    let criteria = design.criteria.iter().map(criterion).collect::<Result<Vec<_>, _>>()?;
    object.insert("criteria".to_owned(), criteria.into());
    let assumed = design.assumed_tension.map(|range| numbers("assumed_tension", &range));
    object.insert("assumed_tension".to_owned(), assumed.transpose()?.unwrap_or_default());
    let cables = design.robot.cables().iter().map(|cable| {
        let holes = match &cable.routing {
            Routing::Holes { holes, .. } => json!(holes),
            _ => Value::Null,
        };
        json!({ "name": cable.name, "holes": holes })
    });
    object.insert("cables".to_owned(), cables.collect());
    let targets = design.goals.iter().enumerate().map(|(k, goal)| target(title, k, goal, design));
    object.insert("targets".to_owned(), targets.collect::<Result<_, _>>()?);
    let tolerances = tolerances.map(tolerances_json).transpose()?;
    object.insert("tolerances".to_owned(), tolerances.unwrap_or_default());
    Ok(Value::Object(object))
}

/// A criterion with its value, in SI units.
fn criterion(of: &CriterionResult) -> Result<Value, NonFinite> {
    let quantity = of.criterion.quantity;
    let path = |key: &str| format!("criteria.{}.{key}", quantity.name());
    let mut object = Map::new();
    object.insert("quantity".to_owned(), json!(quantity.name()));
    if let Quantity::Stiffness { disk, direction } = quantity {
        object.insert("disk".to_owned(), json!(disk + 1));
        let direction = direction.map(|of| vector(|| path("direction"), of)).transpose()?;
        object.insert("direction".to_owned(), direction.unwrap_or_default());
    }
    for (key, value) in [
        ("weight", of.criterion.weight),
        ("limit", of.criterion.limit),
        ("value", Some(of.value)),
        ("before", of.before),
    ] {
        object.insert(key.to_owned(), optional(|| path(key), value)?);
    }
    object.insert("met".to_owned(), json!(of.is_met()));
    Ok(Value::Object(object))
}

fn target(title: &str, k: usize, goal: &GoalResult, design: &Design) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("targets[{k}].{name}");
    let [error, largest] = spread(&goal.distances);
    let mut object = Map::new();
    object.insert("error".to_owned(), number(|| path("error"), error)?);
    object.insert("largest_error".to_owned(), number(|| path("largest_error"), largest)?);
    let tensions = goal.case.commands.iter().map(|of| optional(|| path("tensions"), of.tension));
    object.insert("tensions".to_owned(), tensions.collect::<Result<_, _>>()?);
    let poses = &goal.solution.disks.poses;
    let checked = goal.check.as_ref().and_then(|check| check.as_ref().ok());
    let points = goal.points.iter().zip(&goal.distances).enumerate();
    let points = points.map(|(i, ((disk, wanted), distance))| {
        Ok(json!({
            "disk": disk + 1,
            "wanted": vector(|| path("points.wanted"), *wanted)?,
            "position": vector(|| path("points.position"), poses[*disk].position)?,
            "error": number(|| path("points.error"), *distance)?,
            "error_cosserat_disks": optional(
                || path("points.error_cosserat_disks"),
                checked.and_then(|distances| distances.get(i)).copied(),
            )?,
        }))
    });
    object.insert("points".to_owned(), points.collect::<Result<_, NonFinite>>()?);
    let check = match &goal.check {
        None => Value::Null,
        Some(Err(refused)) => json!({ "model": "cosserat-disks", "refused": refused.to_string() }),
        Some(Ok(distances)) => {
            let [error, largest] = spread(distances);
            json!({
                "model": "cosserat-disks",
                "error": number(|| path("check.error"), error)?,
                "largest_error": number(|| path("check.largest_error"), largest)?,
            })
        }
    };
    object.insert("check".to_owned(), check);
    let beside = Beside { robot: Some(&design.robot), case: Some(&goal.case), ..Beside::default() };
    let mut solved = answer_json(title, &goal.solution, 0.0, &beside)?;
    // It is one of many solves, none of which is timed.
    solved["diagnostics"]["solve_time"] = Value::Null;
    object.insert("solution".to_owned(), solved);
    Ok(Value::Object(object))
}

/// What a sample of robots with deviations of manufacture does to the shapes, in SI units.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn tolerances_json(of: &TolerancesResult) -> Result<Value, NonFinite> {
    let given = &of.tolerances;
    let mut object = Map::new();
    for (key, value) in [
        ("hole_radius", given.hole_radius),
        ("hole_angle", given.hole_angle),
        ("disk_position", given.disk_position),
        ("stiffness", given.stiffness),
        ("tension", given.tension),
    ] {
        object.insert(key.to_owned(), number(|| format!("tolerances.{key}"), value)?);
    }
    object.insert("samples".to_owned(), json!(given.samples));
    object.insert("seed".to_owned(), json!(given.seed));
    object.insert("failed".to_owned(), json!(of.failed));
    let targets = of.goals.iter().map(|samples| {
        let mut object = Map::new();
        for (name, values) in distributions(samples) {
            object.insert(name.to_owned(), distribution(name, &values)?);
        }
        Ok(Value::Object(object))
    });
    object.insert("targets".to_owned(), targets.collect::<Result<_, NonFinite>>()?);
    Ok(Value::Object(object))
}

/// Quantities of a sample by their names.
#[must_use]
pub fn distributions(samples: &[Sampled]) -> [(&'static str, Vec<f64>); 4] {
    let of = |pick: fn(&Sampled) -> f64| samples.iter().map(pick).collect();
    [
        ("tip_shift", of(|sample| sample.tip_shift)),
        ("tip_error", of(|sample| sample.tip_error)),
        ("worst_disk", of(|sample| sample.worst)),
        ("rms", of(|sample| sample.mean)),
    ]
}

/// The value that this part of a sample does not exceed; none of an empty one.
#[must_use]
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    #[allow(clippy::cast_precision_loss, reason = "few samples")]
    let at = (part * last as f64).round();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to last")]
    Some(sorted[(at as usize).min(last)])
}

fn distribution(name: &str, values: &[f64]) -> Result<Value, NonFinite> {
    if values.is_empty() {
        return Ok(Value::Null);
    }
    #[allow(clippy::cast_precision_loss, reason = "few samples")]
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    let path = |key: &str| format!("tolerances.{name}.{key}");
    let mut object = Map::new();
    object.insert("mean".to_owned(), number(|| path("mean"), mean)?);
    object.insert("deviation".to_owned(), number(|| path("deviation"), square.sqrt())?);
    for (key, part) in [
        ("median", 0.5),
        ("quantile_90", 0.9),
        ("quantile_95", 0.95),
        ("quantile_99", 0.99),
        ("largest", 1.0),
    ] {
        object.insert(key.to_owned(), optional(|| path(key), quantile(values, part))?);
    }
    Ok(Value::Object(object))
}

fn count(number: usize) -> Cell {
    Cell::Integer(i64::try_from(number).unwrap_or(i64::MAX))
}

/// Each disk with a wanted place, of each target: where it is wanted, where it is, and how far off, by the model and by `cosserat-disks`.
#[must_use]
pub fn design_errors_table(design: &Design) -> CsvTable {
    let columns = [
        "target",
        "disk",
        "wanted_x",
        "wanted_y",
        "wanted_z",
        "x",
        "y",
        "z",
        "error",
        "error_cosserat_disks",
    ];
    let mut table = CsvTable::new(columns.map(str::to_owned));
    for (k, goal) in design.goals.iter().enumerate() {
        let checked = goal.check.as_ref().and_then(|check| check.as_ref().ok());
        for (i, ((disk, wanted), distance)) in goal.points.iter().zip(&goal.distances).enumerate() {
            let position = goal.solution.disks.poses[*disk].position;
            let check = checked.and_then(|distances| distances.get(i)).copied();
            let numbers = wanted.to_array().into_iter().chain(position.to_array());
            let cells = [count(k + 1), count(disk + 1)]
                .into_iter()
                .chain(numbers.map(Cell::Number))
                .chain([Cell::Number(*distance), check.map_or(Cell::Empty, Cell::Number)]);
            table.push(cells);
        }
    }
    table
}

/// Where each cable passes each disk: the number of the hole, where it has one, and its place on the disk.
#[must_use]
pub fn holes_table(robot: &Robot) -> CsvTable {
    let columns = ["disk", "arc_length", "cable", "hole", "x", "y", "radius", "angle"];
    let mut table = CsvTable::new(columns.map(str::to_owned));
    for (disk, &s) in robot.disks().arc_lengths.iter().enumerate() {
        for (cable, route) in robot.cables().iter().zip(robot.routes()) {
            if s > route.end() + 1e-9 * robot.backbone().length {
                continue;
            }
            let offset = route.at(s.min(route.end())).offset;
            let hole = match &cable.routing {
                Routing::Holes { holes, .. } => holes.get(disk).copied(),
                _ => None,
            };
            table.push([
                count(disk + 1),
                Cell::Number(s),
                Cell::Text(cable.name.clone()),
                hole.map_or(Cell::Empty, count),
                Cell::Number(offset.x),
                Cell::Number(offset.y),
                Cell::Number(offset.x.hypot(offset.y)),
                Cell::Number(offset.y.atan2(offset.x).rem_euclid(core::f64::consts::TAU)),
            ]);
        }
    }
    table
}

/// Each robot of a sample: how far its tip moved, and how far its disks are from where they are wanted.
#[must_use]
pub fn samples_table(of: &TolerancesResult) -> CsvTable {
    let columns = ["target", "sample", "tip_shift", "tip_error", "worst_disk", "rms"];
    let mut table = CsvTable::new(columns.map(str::to_owned));
    for (k, samples) in of.goals.iter().enumerate() {
        for (i, sample) in samples.iter().enumerate() {
            table.push([
                count(k + 1),
                count(i + 1),
                Cell::Number(sample.tip_shift),
                Cell::Number(sample.tip_error),
                Cell::Number(sample.worst),
                Cell::Number(sample.mean),
            ]);
        }
    }
    table
}
