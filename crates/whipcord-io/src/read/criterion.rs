//! Criteria of a design in words: `clearance, at_least = 5 mm`.

use whipcord::Vec3;
use whipcord_design::{Criterion, Quantity};

use super::named::{self, Grammar, quantity};
use crate::suggest;
use crate::units::Dimension;

const TENSION: &str = "tension, weight = 0.01, at_most = 6 N";
const CLEARANCE: &str = "clearance, at_least = 5 mm";
const STIFFNESS: &str = "stiffness, disk = 10, direction = x, at_least = 200 N/m";
const WORKSPACE: &str = "workspace, weight = 0.1, at_least = 30 cm^3";

/// A criterion by its quantity, with `weight` for an objective and `at_most` or `at_least` for a hard constraint.
///
/// # Errors
/// What is wrong with the text, and what to give.
pub fn parse_criterion(text: &str) -> Result<Criterion, String> {
    let name = named::name(text);
    let (example, keys): (&str, &[&str]) = match name.as_str() {
        "tension" => (TENSION, &["weight", "at_most"]),
        "clearance" => (CLEARANCE, &["weight", "at_least"]),
        "stiffness" => (STIFFNESS, &["disk", "direction", "weight", "at_least"]),
        "workspace" => (WORKSPACE, &["weight", "at_least"]),
        _ => {
            let near = suggest::nearest(&name, Quantity::NAMES).filter(|_| name.len() > 1);
            let meant = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
            return Err(format!(
                "`{name}` is no criterion: {meant}give one such as \"{TENSION}\", \"{CLEARANCE}\", \"{STIFFNESS}\" or \"{WORKSPACE}\""
            ));
        }
    };
    let values = Grammar { what: "criterion", name: &name, keys, example }.values(text)?;
    let of = |key: &str| values.iter().find(|(name, _)| *name == key).map(|(_, value)| *value);
    let number = |key: &str, read: &dyn Fn(&str) -> Result<f64, String>| match of(key) {
        None => Ok(None),
        Some(value) => match read(value)? {
            value if value > 0.0 || (value == 0.0 && name == "clearance") => Ok(Some(value)),
            _ => Err(format!("`{key}` must be more than zero, as in \"{example}\"")),
        },
    };
    let with_unit = |key: &'static str, dimension: Dimension| {
        number(key, &move |value: &str| quantity(key, value, dimension))
    };
    let weight = with_unit("weight", Dimension::Ratio)?;
    let (kind, limit) = match name.as_str() {
        "tension" => (Quantity::Tension, with_unit("at_most", Dimension::Force)?),
        "clearance" => (Quantity::Clearance, with_unit("at_least", Dimension::Length)?),
        "stiffness" => {
            let disk = of("disk").ok_or_else(|| {
                format!("a criterion `stiffness` has no `disk`: give it as in \"{example}\"")
            })?;
            let disk = disk.parse::<usize>().ok().filter(|disk| *disk > 0);
            let disk = disk.ok_or_else(|| {
                "`disk` is the number of a disk, from 1, the base disk".to_owned()
            })?;
            let direction = of("direction").map(direction).transpose()?;
            let kind = Quantity::Stiffness { disk: disk - 1, direction };
            (kind, with_unit("at_least", Dimension::LineForce)?)
        }
        _ => (Quantity::Workspace, number("at_least", &volume)?),
    };
    if weight.is_none() && limit.is_none() {
        return Err(format!(
            "`{name}` is neither an objective nor a constraint: give `weight` or `{}`, as in \"{example}\"",
            keys.last().unwrap_or(&"at_least")
        ));
    }
    Ok(Criterion { quantity: kind, weight, limit })
}

/// `x`, `y`, `z`, or three numbers between spaces.
fn direction(text: &str) -> Result<Vec3, String> {
    let vector = match text {
        "x" => Vec3::X,
        "y" => Vec3::Y,
        "z" => Vec3::Z,
        _ => {
            let numbers: Vec<f64> =
                text.split_whitespace().map_while(|number| number.parse().ok()).collect();
            match numbers[..] {
                [x, y, z] if text.split_whitespace().count() == 3 => Vec3::new(x, y, z),
                _ => {
                    return Err(
                        "`direction` is x, y, z, or three numbers such as `1 0 1`".to_owned()
                    );
                }
            }
        }
    };
    let size = vector.norm();
    match size > 0.0 && size.is_finite() {
        true => Ok(vector * (1.0 / size)),
        false => Err("`direction` has no length: give x, y, z, or three numbers".to_owned()),
    }
}

/// A volume in m³, or with a unit.
fn volume(text: &str) -> Result<f64, String> {
    let units = [("mm^3", 1e-9), ("cm^3", 1e-6), ("l", 1e-3), ("m^3", 1.0), ("", 1.0)];
    let known = units.iter().find_map(|(unit, factor)| {
        let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
        Some(number * factor).filter(|value| value.is_finite())
    });
    known.ok_or_else(|| format!("`at_least`: `{text}` is no volume such as \"30 cm^3\""))
}

/// The text of a criterion.
#[must_use]
pub fn criterion_text(of: &Criterion) -> String {
    let mut text = of.quantity.name().to_owned();
    if let Quantity::Stiffness { disk, direction } = of.quantity {
        text += &format!(", disk = {}", disk + 1);
        if let Some(Vec3 { x, y, z }) = direction {
            text += &format!(", direction = {x:?} {y:?} {z:?}");
        }
    }
    if let Some(weight) = of.weight {
        text += &format!(", weight = {weight:?}");
    }
    if let Some(limit) = of.limit {
        let key = if of.quantity.is_limited_above() { "at_most" } else { "at_least" };
        text += &format!(", {key} = {limit:?} {}", of.quantity.unit());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn criteria_are_read_with_units_and_written_as_they_are_read() {
        let stiffness = parse_criterion(STIFFNESS).unwrap();
        let quantity = Quantity::Stiffness { disk: 9, direction: Some(Vec3::X) };
        assert_eq!(stiffness, Criterion { quantity, weight: None, limit: Some(200.0) });
        let workspace = parse_criterion(WORKSPACE).unwrap();
        assert!((workspace.limit.unwrap() - 3e-5).abs() < 1e-18);
        for text in [
            TENSION,
            CLEARANCE,
            STIFFNESS,
            WORKSPACE,
            "Clearance, at_least=0",
            "stiffness, disk = 2, weight = 1",
            "stiffness, disk = 2, direction = 1 0 1, weight = 1",
            "tension, at_most = 400 gf",
            "workspace, at_least = 1e-6",
        ] {
            let criterion = parse_criterion(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            let again = parse_criterion(&criterion_text(&criterion)).unwrap();
            assert_eq!(again.weight, criterion.weight, "{text}");
            assert!((again.limit.unwrap_or(0.0) - criterion.limit.unwrap_or(0.0)).abs() < 1e-12);
        }
        for (text, words) in [
            ("", "is no criterion"),
            ("tensions, weight = 1", "did you mean `tension`?"),
            ("tension", "neither an objective nor a constraint"),
            ("tension, at_least = 1 N", "has no `at_least`, but weight, at_most"),
            ("tension, weight = 0", "more than zero"),
            ("tension, at_most = 5 mm", "`at_most`"),
            ("clearance, at_least = -1 mm", "more than zero"),
            ("stiffness, weight = 1", "has no `disk`"),
            ("stiffness, disk = 0, weight = 1", "from 1"),
            ("stiffness, disk = 3, direction = up, weight = 1", "three numbers"),
            ("stiffness, disk = 3, direction = 0 0 0, weight = 1", "no length"),
            ("workspace, at_least = 30 cm", "no volume"),
            ("workspace, at_least = inf", "no volume"),
            ("workspace, weight = nan", "not a finite"),
        ] {
            let parsed = parse_criterion(text);
            assert!(
                parsed.as_ref().is_err_and(|error| error.contains(words)),
                "{text}: {parsed:?}"
            );
        }
    }
}
