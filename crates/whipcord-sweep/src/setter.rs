//! What a value of an axis changes: a command or a load of the case, or any other key of the robot file.

use whipcord::{CableCommand, Case, Robot, Shortening, Vec3};
use whipcord_io::{Dimension, parse_quantity};

use crate::axis::Axis;

/// What an axis changes, with what its unit is in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Setter {
    pub what: What,
    factor: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    Tension(usize),
    Shortening(usize),
    /// As a part of the length of the cable.
    ShorteningFraction(usize),
    Motor(usize),
    TipForce(usize),
    TipMoment(usize),
    Gravity(usize),
    /// A key that the file is read again for.
    Key,
}

impl What {
    /// Whether it is a load.
    pub const fn is_load(self) -> bool {
        matches!(self, Self::TipForce(_) | Self::TipMoment(_) | Self::Gravity(_))
    }
}

impl Setter {
    /// What an axis changes of a robot. Whatever is no command or load of a plain unit is left to the reader of the file, which
    /// knows all keys, and what is wrong with them.
    pub fn of(axis: &Axis, robot: &Robot) -> Self {
        let key = Self { what: What::Key, factor: 1.0 };
        let Some((what, dimensions)) = known(&axis.path, robot) else { return key };
        let factor = |dimension| match axis.unit.as_str() {
            // As the file has it: a number is in SI units.
            "" => Some(1.0),
            unit => {
                let one = parse_quantity(&format!("1 {unit}"), &[dimension]);
                one.ok().map(|(factor, _)| factor)
            }
        };
        match (what, factor(dimensions)) {
            (what, Some(factor)) => Self { what, factor },
            (What::Shortening(cable), None) => match factor(Dimension::Ratio) {
                Some(factor) => Self { what: What::ShorteningFraction(cable), factor },
                None => key,
            },
            _ => key,
        }
    }

    /// Writes a value, in the unit of the axis, to a case and the commands of the motors.
    pub fn set(self, value: f64, case: &mut Case, motors: &mut [Option<f64>]) {
        let value = self.in_si(value);
        // What is given in another way would drive the models that prefer that.
        let shortened = |by| CableCommand { tension: None, shortening: Some(by) };
        let component = |vector: &mut Vec3, axis: usize| {
            let mut components = vector.to_array();
            components[axis] = value;
            *vector = components.into();
        };
        match self.what {
            What::Tension(cable) => {
                case.commands[cable] = CableCommand { tension: Some(value), shortening: None };
            }
            What::Shortening(cable) => {
                case.commands[cable] = shortened(Shortening::Length(value));
            }
            What::ShorteningFraction(cable) => {
                case.commands[cable] = shortened(Shortening::Fraction(value));
            }
            What::Motor(motor) => motors[motor] = Some(value),
            What::TipForce(axis) => component(&mut case.loads.tip_force, axis),
            What::TipMoment(axis) => component(&mut case.loads.tip_moment, axis),
            What::Gravity(axis) => {
                component(case.loads.gravity.get_or_insert(Vec3::ZERO), axis);
            }
            What::Key => {}
        }
    }

    /// A value of the axis in SI units, where the axis is no [`What::Key`].
    pub fn in_si(self, value: f64) -> f64 {
        value * self.factor
    }
}

/// The command or load that a path names, and what its values measure.
fn known(path: &str, robot: &Robot) -> Option<(What, Dimension)> {
    if let Some(component) = path.strip_prefix("loads.") {
        let (name, index) = component.strip_suffix(']')?.split_once('[')?;
        let axis: usize = index.parse().ok().filter(|axis| *axis < 3)?;
        return match name {
            "tip_force" => Some((What::TipForce(axis), Dimension::Force)),
            "tip_moment" => Some((What::TipMoment(axis), Dimension::Moment)),
            "gravity" => Some((What::Gravity(axis), Dimension::Acceleration)),
            _ => None,
        };
    }
    let (entry, key) = path.rsplit_once('.')?;
    let number = |list: &str, names: &[&str]| {
        let rest = entry.strip_prefix(list)?;
        let found = match rest.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            Some(index) => index.parse().ok(),
            None => {
                let name = rest.strip_prefix('.')?;
                names.iter().position(|own| *own == name)
            }
        };
        found.filter(|number: &usize| *number < names.len())
    };
    let cables: Vec<&str> = robot.cables().iter().map(|cable| cable.name.as_str()).collect();
    if let Some(cable) = number("cables", &cables) {
        return match key {
            "tension" => Some((What::Tension(cable), Dimension::Force)),
            "shortening" => Some((What::Shortening(cable), Dimension::Length)),
            _ => None,
        };
    }
    let motors: Vec<&str> = robot.motors().iter().map(|motor| motor.name.as_str()).collect();
    let motor = number("motors", &motors)?;
    match key {
        "angle" => Some((What::Motor(motor), Dimension::Angle)),
        "travel" => Some((What::Motor(motor), Dimension::Length)),
        _ => None,
    }
}
