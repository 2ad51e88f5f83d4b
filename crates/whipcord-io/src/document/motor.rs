//! A motor as an entry of `[[motors]]`.

use whipcord::{Drive, Motor, MotorCable};

use super::{Item, Table};

/// The table of a motor with its command, in a robot whose cables have these names.
pub(super) fn motor(motor: &Motor, names: &[&str], command: Option<f64>) -> Table {
    let mut table = Table::default();
    table.insert("name", motor.name.as_str());
    table.insert_some("group", motor.group.as_deref());
    let of_cable = |of: &MotorCable| of.signed(names.get(of.cable).copied().unwrap_or_default());
    let cables = motor.cables.iter().map(|of| Item::Text(of_cable(of)));
    table.insert("cables", Item::List(cables.collect()));
    let some = |value: f64| (value != 0.0).then_some(value);
    let keys = motor.drive.keys();
    match motor.drive {
        Drive::Spool { gear_ratio } => {
            match motor.cables.as_slice() {
                [first, rest @ ..] if rest.iter().all(|of| of.radius == first.radius) => {
                    table.insert("spool_radius", first.radius);
                }
                all => {
                    table.insert("spool_radius", all.iter().map(|of| of.radius).collect::<Vec<_>>())
                }
            }
            if gear_ratio != 1.0 {
                table.insert("gear_ratio", gear_ratio);
            }
        }
        Drive::Linear => {}
    }
    table.insert_some(keys.command, command);
    table.insert_some("stiffness", motor.stiffness);
    table.insert_some("free_length", some(motor.free_length));
    table.insert_some("pretension", some(motor.pretension));
    table.insert_some("backlash", some(motor.backlash));
    table.insert_some(keys.offset, some(motor.offset));
    table.insert_some(keys.limits, motor.limits.range);
    table.insert_some("rate_limit", motor.limits.rate);
    table.insert_some(keys.effort_limit, motor.limits.effort);
    if let Some(dynamics) = &motor.dynamics {
        for (key, value) in dynamics.numbers() {
            table.insert_some(key, some(value));
        }
    }
    table
}
