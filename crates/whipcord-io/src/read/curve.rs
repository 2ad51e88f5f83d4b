//! Named curves in words: `helix, radius = 20 mm, pitch = 60 mm`.

use core::f64::consts::TAU;

use whipcord_design::{CurveKind, NamedCurve};

use super::named::{self, Grammar, quantity};
use crate::suggest;
use crate::units::Dimension;

/// What is given of a curve, by the name of the number.
type Numbers = Vec<(String, f64)>;

const CIRCLE: &str = "circle, radius = 100 mm";
const ARC: &str = "arc, angle = 90 deg";
const HELIX: &str = "helix, radius = 20 mm, pitch = 60 mm";
const S: &str = "s, angle = 45 deg";
const CLOTHOID: &str = "clothoid, start = 0 1/m, end = 10 1/m";

/// More than any backbone bends.
const LARGEST_ANGLE: f64 = 100.0 * TAU;

/// Whether a text begins with the name of a curve.
#[must_use]
pub fn is_curve(text: &str) -> bool {
    NamedCurve::NAMES.contains(&named::name(text).as_str())
}

/// A curve by its name and numbers, such as `arc, angle = 90 deg, direction = 0 deg`; numbers without a unit are in SI.
///
/// # Errors
/// What is wrong with the text, and what to give.
pub fn parse_curve(text: &str) -> Result<NamedCurve, String> {
    let name = named::name(text);
    let (example, keys): (&str, &[&str]) = match name.as_str() {
        "circle" => (CIRCLE, &["radius", "direction"]),
        "arc" => (ARC, &["angle", "direction"]),
        "helix" => (HELIX, &["radius", "pitch", "direction"]),
        "s" => (S, &["angle", "direction"]),
        "clothoid" => (CLOTHOID, &["start", "end", "direction"]),
        _ => {
            let near = suggest::nearest(&name, NamedCurve::NAMES).filter(|_| name.len() > 1);
            let meant = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
            return Err(format!(
                "`{name}` is no curve: {meant}give one such as \"{CIRCLE}\", \"{ARC}\", \"{HELIX}\", \"{S}\" or \"{CLOTHOID}\""
            ));
        }
    };
    let numbers = numbers(text, &Grammar { what: "curve", name: &name, keys, example })?;
    let of = |key: &str| {
        let found = numbers.iter().find(|(name, _)| name == key);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| format!("a curve `{name}` has no `{key}`: give it as in \"{example}\""))
    };
    let positive = |key: &str| match of(key)? {
        value if value > 0.0 => Ok(value),
        _ => Err(format!("`{key}` must be more than zero, as in \"{example}\"")),
    };
    let kind = match name.as_str() {
        "circle" => CurveKind::Circle { radius: positive("radius")? },
        "arc" => CurveKind::Arc { angle: of("angle")? },
        "helix" => CurveKind::Helix { radius: positive("radius")?, pitch: of("pitch")? },
        "s" => CurveKind::S { angle: of("angle")? },
        _ => CurveKind::Clothoid { start: of("start")?, end: of("end")? },
    };
    Ok(NamedCurve { kind, direction: of("direction").unwrap_or(0.0) })
}

fn numbers(text: &str, grammar: &Grammar<'_>) -> Result<Numbers, String> {
    let number = |(key, value): (&str, &str)| {
        let dimension = match key {
            "radius" | "pitch" => Dimension::Length,
            "angle" | "direction" => Dimension::Angle,
            _ => Dimension::Curvature,
        };
        let value = quantity(key, value, dimension)?;
        if dimension == Dimension::Angle && value.abs() > LARGEST_ANGLE {
            return Err(format!("`{key}` is more than 100 turns: give it in deg or rad"));
        }
        Ok((key.to_owned(), value))
    };
    grammar.values(text)?.into_iter().map(number).collect()
}

/// The text of a curve.
#[must_use]
pub fn curve_text(curve: &NamedCurve) -> String {
    let mut text = curve.name().to_owned();
    let unit = |key: &str| match key {
        "radius" | "pitch" => "m",
        "angle" | "direction" => "rad",
        _ => "1/m",
    };
    let direction = Some(("direction", curve.direction)).filter(|(_, angle)| *angle != 0.0);
    for (key, value) in curve.numbers().into_iter().chain(direction) {
        text += &format!(", {key} = {value:?} {}", unit(key));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_read_with_units_and_written_as_they_are_read() {
        let curve = parse_curve("helix, radius = 20 mm, pitch = -6 cm, direction=90 deg").unwrap();
        assert_eq!(curve.kind, CurveKind::Helix { radius: 0.02, pitch: -0.06 });
        assert!((curve.direction - 0.25 * TAU).abs() < 1e-15);
        for text in [CIRCLE, ARC, HELIX, S, CLOTHOID, "Arc, angle = 2", "s,angle=-1 rad"] {
            let curve = parse_curve(text).unwrap();
            assert!(is_curve(text));
            assert_eq!(parse_curve(&curve_text(&curve)), Ok(curve), "{text}");
        }
        for (text, words) in [
            ("", "is no curve"),
            ("helixx, radius = 1", "did you mean `helix`?"),
            ("helix, radius = 20 mm", "has no `pitch`"),
            ("helix, radius = -20 mm, pitch = 1", "more than zero"),
            ("arc, angle", "no number with a name"),
            ("arc, angle = 90", ""),
            ("arc, angle = 900 mm", "`angle`"),
            ("arc, angle = 1, angle = 2", "given twice"),
            ("arc, turn = 1", "has no `turn`, but angle, direction"),
            ("arc, angle = inf", "not a finite"),
            ("arc, angle = 9000", "100 turns"),
        ] {
            let parsed = parse_curve(text);
            match words {
                "" => assert!(parsed.is_ok()),
                _ => assert!(parsed.as_ref().is_err_and(|e| e.contains(words)), "{parsed:?}"),
            }
        }
    }
}
