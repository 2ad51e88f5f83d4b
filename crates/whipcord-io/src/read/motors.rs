//! Motors and their commands.

use whipcord::{Drive, Motor, MotorCable, MotorDynamics, MotorLimits};

use crate::check::{Data, Fields};
use crate::error::{FileProblem, Problems};
use crate::node::{Node, Value};
use crate::overlay::default_name;
use crate::source::quoted;
use crate::units::Dimension;

/// Motors, each with its command.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motors {
    pub motors: Vec<Motor>,
    pub commands: Vec<Option<f64>>,
}

/// The entries of `[[motors]]` that are in order, of cables with these names.
pub(crate) fn motors(
    tables: &[Fields],
    cables: &[String],
    document: &Node,
    problems: &mut Problems,
) -> Motors {
    let mut all = Motors::default();
    for (index, fields) in tables.iter().enumerate() {
        if let Some(motor) = motor(fields, index, cables, document, problems) {
            all.commands.push(fields.number("angle").or_else(|| fields.number("travel")));
            all.motors.push(motor);
        }
    }
    all
}

fn motor(
    fields: &Fields,
    index: usize,
    cables: &[String],
    document: &Node,
    problems: &mut Problems,
) -> Option<Motor> {
    let path = format!("motors[{index}]");
    let turns = fields.data("spool_radius").is_some();
    let names = fields.list("cables")?;
    let radii = fields.numbers("spool_radius");
    if let Some(given) = radii.as_ref().map(Vec::len).filter(|given| *given != names.len()) {
        let span = document.locate(&format!("{path}.spool_radius")).span;
        let (key, expected) = ("spool_radius", names.len());
        problems.push(span, || FileProblem::WrongCount { key, expected, given });
        return None;
    }
    let mut pulled = Vec::with_capacity(names.len());
    for (k, name) in names.iter().filter_map(Data::as_text).enumerate() {
        let found = find(name, cables);
        let Some((cable, is_reversed)) = found else {
            let span = document.locate(&format!("{path}.cables[{k}]")).span;
            problems.push(span, || FileProblem::UnknownCable {
                name: quoted(name),
                names: cables.iter().map(|name| format!("`{}`", quoted(name))).collect(),
            });
            return None;
        };
        let radius = match &radii {
            Some(radii) => radii[k],
            None => fields.number("spool_radius").unwrap_or(1.0),
        };
        pulled.push(MotorCable { cable, radius, is_reversed });
    }
    for (key, [angle, length]) in [
        ("backlash", [Dimension::Angle, Dimension::Length]),
        ("rate_limit", [Dimension::AngularRate, Dimension::Speed]),
        ("inertia", [Dimension::Inertia, Dimension::Mass]),
        ("damping", [Dimension::AngularDamping, Dimension::Damping]),
        ("proportional_gain", [Dimension::AngularStiffness, Dimension::LineForce]),
        ("derivative_gain", [Dimension::AngularDamping, Dimension::Damping]),
    ] {
        let node = document.locate(&format!("{path}.{key}"));
        let given = fields.quantity(key).filter(|_| matches!(node.value, Value::Text(_)));
        let needed = if turns { angle } else { length };
        if given.is_some_and(|(_, dimension)| dimension != needed) {
            problems.push(node.span, || of_other_drive(key, index, needed));
            return None;
        }
    }
    let range = fields.vector("angle_limits").or_else(|| fields.vector("travel_limits"));
    let offset = fields.number("angle_offset").or_else(|| fields.number("travel_offset"));
    let gear_ratio = fields.number("gear_ratio").unwrap_or(1.0);
    Some(Motor {
        name: fields.text("name").map_or_else(|| default_name("motor", index), str::to_owned),
        group: fields.text("group").map(str::to_owned),
        drive: if turns { Drive::Spool { gear_ratio } } else { Drive::Linear },
        cables: pulled,
        stiffness: fields.number("stiffness"),
        free_length: fields.number("free_length").unwrap_or(0.0),
        pretension: fields.number("pretension").unwrap_or(0.0),
        backlash: fields.number("backlash").unwrap_or(0.0),
        offset: offset.unwrap_or(0.0),
        limits: MotorLimits {
            range,
            rate: fields.number("rate_limit"),
            effort: fields.number("torque_limit").or_else(|| fields.number("force_limit")),
        },
        dynamics: dynamics(fields),
    })
}

/// Inertia and gains, where they are given: the rules of the table have both.
fn dynamics(fields: &Fields) -> Option<MotorDynamics> {
    let number = |key: &str| fields.number(key).unwrap_or(0.0);
    Some(MotorDynamics {
        inertia: fields.number("inertia")?,
        damping: number("damping"),
        proportional: fields.number("proportional_gain")?,
        derivative: number("derivative_gain"),
        integral: number("integral_gain"),
    })
}

/// The cable of this name, and whether it is paid out: a name may have a sign before it.
fn find(name: &str, cables: &[String]) -> Option<(usize, bool)> {
    let find = |name: &str| cables.iter().position(|cable| cable == name);
    let name = name.trim();
    let signed = |sign: char| name.strip_prefix(sign).and_then(|name| find(name.trim_start()));
    find(name)
        .map(|cable| (cable, false))
        .or_else(|| signed('-').or_else(|| signed('−')).map(|cable| (cable, true)))
        .or_else(|| signed('+').map(|cable| (cable, false)))
}

/// The commands that an entry of `[[steps]]` gives the motors.
pub(crate) fn motor_step(
    fields: &Fields,
    step: usize,
    motors: &[Motor],
    document: &Node,
    problems: &mut Problems,
) -> Vec<Option<f64>> {
    let Some(list) = fields.list("motors") else { return vec![None; motors.len()] };
    let mut commands = Vec::with_capacity(list.len());
    for (i, (data, motor)) in list.iter().zip(motors).enumerate() {
        let turns = matches!(motor.drive, Drive::Spool { .. });
        let node = document.locate(&format!("steps[{step}].motors[{i}]"));
        let needed = if turns { Dimension::Angle } else { Dimension::Length };
        let given = data.as_quantity();
        if matches!(node.value, Value::Text(_)) && given.is_some_and(|(_, of)| of != needed) {
            problems.push(node.span, || of_other_drive("motors", i, needed));
        }
        commands.push(given.map(|(value, _)| value));
    }
    commands
}

fn of_other_drive(key: &'static str, index: usize, needed: Dimension) -> FileProblem {
    let expected = match needed {
        Dimension::Angle => "an angle",
        Dimension::Length => "a length",
        Dimension::AngularRate => "a rate of an angle",
        Dimension::Inertia => "a moment of inertia",
        Dimension::Mass => "a mass",
        Dimension::AngularDamping => "a moment per rate of an angle",
        Dimension::Damping => "a force per speed",
        Dimension::AngularStiffness => "a moment per angle",
        Dimension::LineForce => "a force per length",
        _ => "a speed",
    };
    FileProblem::OtherDrive { key, what: format!("motor {}", index + 1), expected }
}
