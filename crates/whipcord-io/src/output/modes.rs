//! Natural vibrations as JSON and tables.

use serde_json::{Value, json};
use whipcord_motion::{Mode, Simulation};

use super::NonFinite;
use super::csv::{Cell, CsvTable};
use super::json::{number, numbers, optional, quaternion, vector};

/// Names of the parts of the kinetic energy.
const SHARES: [&str; 4] = ["x", "y", "z", "rotation"];

/// Natural vibrations about the state of a simulation as the JSON object that `whipcord modes --json` prints; SI, frequencies in Hz. Displacements
/// and rotations of the nodes are along the axes of the world, in a scale in which the modal mass is 1 kg·m²: a vibration of the
/// amplitude 1 has the greatest kinetic energy ω²/2. The frequency is null where the equilibrium is unstable in this shape, the damped one also where the
/// damping is critical or more.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn modes_json(
    title: &str,
    simulation: &Simulation,
    modes: &[Mode],
) -> Result<Value, NonFinite> {
    let state = simulation.state();
    let arc_lengths: Vec<f64> = simulation.arc_lengths().collect();
    let poses: Vec<Value> = state
        .poses
        .iter()
        .enumerate()
        .map(|(i, pose)| {
            let path = |name: &str| format!("poses[{i}].{name}");
            Ok(json!({
                "position": vector(|| path("position"), pose.position)?,
                "orientation": quaternion(|| path("orientation"), pose)?,
            }))
        })
        .collect::<Result<_, NonFinite>>()?;
    let modes: Vec<Value> = modes
        .iter()
        .enumerate()
        .map(|(k, mode)| self::mode(k, simulation, mode))
        .collect::<Result<_, _>>()?;
    Ok(json!({
        "title": title,
        "model": simulation.options().model.name(),
        "status": "converged",
        "version": env!("CARGO_PKG_VERSION"),
        "arc_length": numbers("arc_length", &arc_lengths)?,
        "poses": poses,
        "modes": modes,
    }))
}

fn mode(k: usize, simulation: &Simulation, mode: &Mode) -> Result<Value, NonFinite> {
    let path = |name: &str| format!("modes[{k}].{name}");
    let mut energy = serde_json::Map::new();
    for (name, share) in SHARES.iter().zip(simulation.energy_shares(mode)) {
        energy.insert((*name).to_owned(), number(|| path(&format!("energy.{name}")), share)?);
    }
    let world = mode.in_world(simulation.state());
    let (mut displacement, mut rotation) = (Vec::new(), Vec::new());
    for (i, twist) in world.iter().enumerate() {
        displacement.push(vector(|| path(&format!("displacement[{i}]")), twist.linear)?);
        rotation.push(vector(|| path(&format!("rotation[{i}]")), twist.angular)?);
    }
    Ok(json!({
        "frequency": optional(|| path("frequency"), mode.frequency())?,
        "damped_frequency": optional(|| path("damped_frequency"), mode.damped_frequency())?,
        "damping_ratio": number(|| path("damping_ratio"), mode.damping_ratio)?,
        "squared_angular_frequency":
            number(|| path("squared_angular_frequency"), mode.squared_frequency)?,
        "stable": mode.squared_frequency > 0.0,
        "energy": energy,
        "displacement": displacement,
        "rotation": rotation,
    }))
}

/// A row for each vibration: its frequencies, damping ratio and the parts of its kinetic energy. Frequencies that there are not are blank.
#[must_use]
pub fn modes_table(simulation: &Simulation, modes: &[Mode]) -> CsvTable {
    let columns =
        ["mode", "frequency [Hz]", "damped_frequency [Hz]", "damping_ratio"].map(str::to_owned);
    let shares = SHARES.iter().map(|name| format!("energy_{name}"));
    let mut table = CsvTable::new(columns.into_iter().chain(shares));
    for (k, mode) in modes.iter().enumerate() {
        let mut row = vec![
            Cell::from(k + 1),
            mode.frequency().map_or(Cell::Empty, Cell::from),
            mode.damped_frequency().map_or(Cell::Empty, Cell::from),
            Cell::from(mode.damping_ratio),
        ];
        row.extend(simulation.energy_shares(mode).map(Cell::from));
        table.push(row);
    }
    table
}

/// A row for each node of each vibration: arc length, and displacement and rotation as in [`modes_json`].
#[must_use]
pub fn mode_shapes_table(simulation: &Simulation, modes: &[Mode]) -> CsvTable {
    let mut table = CsvTable::new([
        "mode",
        "s [m]",
        "displacement_x [m]",
        "displacement_y [m]",
        "displacement_z [m]",
        "rotation_x [rad]",
        "rotation_y [rad]",
        "rotation_z [rad]",
    ]);
    for (k, mode) in modes.iter().enumerate() {
        for (s, twist) in simulation.arc_lengths().zip(mode.in_world(simulation.state())) {
            let mut row = vec![Cell::from(k + 1), Cell::from(s)];
            row.extend(twist.linear.to_array().map(Cell::from));
            row.extend(twist.angular.to_array().map(Cell::from));
            table.push(row);
        }
    }
    table
}
