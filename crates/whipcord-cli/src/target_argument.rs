//! Targets on the command line: points, poses and directions.

use core::str::FromStr;

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_io::{Dimension, QuantityError, parse_quantity};

/// A point in m.
#[derive(Clone, Copy, Debug)]
pub struct Place(pub Vec3);

/// A direction of any length but zero.
#[derive(Clone, Copy, Debug)]
pub struct Axis(pub Vec3);

/// A position and an orientation.
#[derive(Clone, Copy, Debug)]
pub struct PoseArgument(pub Pose);

const PLACE: &str = "give three lengths, such as \"40 mm, 0 mm, 120 mm\" or \"40, 0, 120 mm\"";
const AXIS: &str = "give three numbers, such as 0,0,1";
const POSE: &str =
    "give a point and a quaternion (w, x, y, z), such as \"40, 0, 120 mm, 0.92, 0, 0.38, 0\"";

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split([',', ';']).map(str::trim).collect();
        place(&parts).map(Self).map_err(|error| format!("{error}: {PLACE}"))
    }
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split([',', ';']).map(str::trim).collect();
        let [x, y, z] = numbers(&parts).map_err(|error| format!("{error}: {AXIS}"))?;
        let direction = Vec3::new(x, y, z);
        if direction.norm() == 0.0 {
            return Err(format!("the direction has the length zero: {AXIS}"));
        }
        Ok(Self(direction))
    }
}

impl FromStr for PoseArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split([',', ';']).map(str::trim).collect();
        let help = |error: String| format!("{error}: {POSE}");
        let Some((point, turn)) = parts.split_at_checked(3) else {
            return Err(help(count(&parts)));
        };
        let wxyz = numbers(turn).map_err(help)?;
        let position = place(point).map_err(help)?;
        let rotation = UnitQuaternion::from_wxyz(wxyz)
            .ok_or_else(|| help("the quaternion is zero".to_owned()))?;
        Ok(Self(Pose { position, rotation }))
    }
}

/// A length greater than zero in m; a number without a unit is in metres.
pub fn length(text: &str) -> Result<f64, String> {
    positive(text, Dimension::Length, "0.1 mm")
}

/// An angle greater than zero in rad; a number without a unit is in radians.
pub fn angle(text: &str) -> Result<f64, String> {
    positive(text, Dimension::Angle, "0.1 deg")
}

fn positive(text: &str, dimension: Dimension, example: &str) -> Result<f64, String> {
    let value = quantity(text, dimension, None).map_err(|e| format!("{e}: give \"{example}\""))?;
    if value > 0.0 { Ok(value) } else { Err(format!("give more than zero, such as \"{example}\"")) }
}

fn count(parts: &[&str]) -> String {
    match parts.len() {
        1 => "one value is given".to_owned(),
        given => format!("{given} values are given"),
    }
}

/// Three lengths. A unit behind the last alone holds for all.
fn place(parts: &[&str]) -> Result<Vec3, String> {
    let [first, second, last] = parts else { return Err(count(parts)) };
    let is_bare = |text: &&&str| text.parse::<f64>().is_ok();
    let unit = match [first, second].iter().all(is_bare) {
        true => last.trim_start_matches(|c: char| !c.is_alphabetic() || c == 'e' || c == 'E'),
        false => "",
    };
    let unit = (!unit.is_empty()).then_some(unit);
    let of = |text: &str, unit| quantity(text, Dimension::Length, unit);
    Ok(Vec3::new(of(first, unit)?, of(second, unit)?, of(last, None)?))
}

fn numbers<const N: usize>(parts: &[&str]) -> Result<[f64; N], String> {
    let values: Vec<f64> = parts
        .iter()
        .map(|text| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("`{text}` is not a finite number")),
        })
        .collect::<Result<_, _>>()?;
    values.try_into().map_err(|_| count(parts))
}

/// A quantity of a dimension in SI; a plain number is in the unit, or in SI.
fn quantity(text: &str, dimension: Dimension, unit: Option<&str>) -> Result<f64, String> {
    if let Ok(number) = text.parse::<f64>() {
        if !number.is_finite() {
            return Err(format!("`{text}` is not a finite number"));
        }
        let Some(unit) = unit else { return Ok(number) };
        return quantity(&format!("{text} {unit}"), dimension, None);
    }
    let found = parse_quantity(text, &[dimension]);
    found.map(|(value, _)| value).map_err(|error: QuantityError| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_units_of_their_own_or_one_for_all() {
        let at = |text: &str| text.parse::<Place>().map(|Place(point)| point.to_array());
        assert_eq!(at("40 mm, 0, 0.12 m"), Ok([0.04, 0.0, 0.12]));
        assert_eq!(at("-40,0,120mm"), Ok([-0.04, 0.0, 0.12]));
        assert_eq!(at("0.04;1e-3;.12"), Ok([0.04, 0.001, 0.12]));
        assert_eq!(at("4e1,0,1.2e2 mm"), Ok([0.04, 0.0, 0.12]));
        for text in ["", "1,2", "1,2,3,4", "nan,0,0", "1e400,0,0 mm", "a,0,0", "1 N,0,0"] {
            assert!(at(text).is_err(), "{text}");
        }
    }

    #[test]
    fn poses_are_a_point_and_a_quaternion() {
        let PoseArgument(pose) = "40,0,120 mm, 2,0,0,0".parse().unwrap();
        assert_eq!(pose.position.to_array(), [0.04, 0.0, 0.12]);
        assert_eq!(pose.rotation, UnitQuaternion::IDENTITY);
        for text in ["40,0,120 mm", "1,2,3,0,0,0,0", "1,2,3,inf,0,0,0", "1,2"] {
            assert!(text.parse::<PoseArgument>().is_err(), "{text}");
        }
        assert!("0,0,0".parse::<Axis>().is_err());
    }
}
