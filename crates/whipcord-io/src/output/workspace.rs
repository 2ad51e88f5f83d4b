//! Workspaces as JSON and tables.

use serde_json::{Value, json};
use whipcord::Robot;
use whipcord_inverse::{InverseSolver, Workspace};

use super::NonFinite;
use super::csv::{Cell, CsvTable};
use super::json::{number, numbers};
use super::reach::{named, searched};

/// A workspace as the JSON object that `whipcord workspace --json` prints, in SI units. The voxels are in the tables.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn workspace_json(
    title: &str,
    robot: &Robot,
    model: &str,
    solver: &InverseSolver,
    workspace: &Workspace,
) -> Result<Value, NonFinite> {
    let [least, greatest] = workspace.extent.map(whipcord::Vec3::to_array);
    let full = workspace.cells.iter().filter(|cell| cell.is_full).count();
    Ok(json!({
        "title": title,
        "model": model,
        "voxel": number(|| "voxel".to_owned(), workspace.voxel)?,
        "voxels": workspace.cells.len(),
        "full_voxels": full,
        "dimension": workspace.dimension,
        "measure": number(|| "measure".to_owned(), workspace.measure)?,
        "extent": { "least": numbers("extent.least", &least)?, "greatest": numbers("extent.greatest", &greatest)? },
        "boundary_points": workspace.boundary.len(),
        "complete": workspace.is_complete,
        "solves": workspace.solves,
        "search_ranges": searched(robot, solver)?,
    }))
}

/// The voxels: their centre, a place of the tip in them with the direction of the backbone and the commands, and what the maps show.
#[must_use]
pub fn workspace_table(robot: &Robot, solver: &InverseSolver, workspace: &Workspace) -> CsvTable {
    let fixed = [
        "x [m]",
        "y [m]",
        "z [m]",
        "tip_x [m]",
        "tip_y [m]",
        "tip_z [m]",
        "axis_x",
        "axis_y",
        "axis_z",
        "full",
        "directions",
        "condition",
        "least_motion [m]",
        "greatest_motion [m]",
        "least_stiffness [N/m]",
        "greatest_stiffness [N/m]",
    ];
    let commands = solver.actuators().iter().map(|actuator| {
        let (command, name) = named(robot, *actuator);
        let unit = match command {
            "tension" => "N",
            "angle" => "rad",
            _ => "m",
        };
        format!("{name}.{command} [{unit}]")
    });
    let mut table = CsvTable::new(fixed.map(str::to_owned).into_iter().chain(commands));
    for cell in &workspace.cells {
        let centre = cell.index.map(|i| Cell::Number((f64::from(i) + 0.5) * workspace.voxel));
        let place = cell.tip.to_array().into_iter().chain(cell.axis.to_array()).map(Cell::Number);
        let of = &cell.dexterity;
        let optional = |value: Option<f64>| value.map_or(Cell::Empty, Cell::Number);
        let values = [
            Cell::Integer(i64::from(cell.is_full)),
            Cell::from(of.directions),
            optional(of.condition),
            Cell::Number(of.motions().last().map_or(0.0, |(size, _)| size)),
            Cell::Number(of.singular[0].0),
            optional(cell.stiffness.map(|[least, _]| least)),
            optional(cell.stiffness.map(|[_, greatest]| greatest)),
        ];
        let commands = cell.commands.iter().copied().map(Cell::Number);
        table.push(centre.into_iter().chain(place).chain(values).chain(commands));
    }
    table
}

/// The points of the boundary, with what holds the tip back.
#[must_use]
pub fn boundary_table(robot: &Robot, solver: &InverseSolver, workspace: &Workspace) -> CsvTable {
    let columns = ["x [m]", "y [m]", "z [m]", "normal_x", "normal_y", "normal_z", "limits"];
    let mut table = CsvTable::new(columns);
    for point in &workspace.boundary {
        let place = point.tip.to_array().into_iter().chain(point.normal.to_array());
        let words: Vec<String> =
            point.limits.iter().map(|limit| limit.words(robot, solver.actuators())).collect();
        let words =
            if words.is_empty() { "no motion outward".to_owned() } else { words.join("; ") };
        table.push(place.map(Cell::Number).chain([Cell::Text(words)]));
    }
    table
}
