//! Numbers without a unit that look like millimetres or megapascals.

use whipcord::Warning;
use whipcord::warning::{BareUnits, USUAL_LENGTHS};

use crate::node::{Node, Value};

/// A number without a unit at most this many metres is a distance across a robot as it may be.
const WIDE: f64 = 0.1;

/// One warning for each key; a modulus below `softest` in Pa looks like megapascals.
pub(super) fn bare_numbers(document: &Node, softest: f64) -> Vec<Warning> {
    const DISTANCES: [&str; 9] = [
        "backbone.diameter",
        "backbone.diameters",
        "backbone.diameters.values",
        "backbone.inner_diameter",
        "backbone.section.width",
        "backbone.section.height",
        "disks.hole_circle_radius",
        "disks.outer_radius",
        "disks.thickness",
    ];
    let mut found = Vec::new();
    let mut bare = |path: &str, value: f64, units: BareUnits| {
        found.push(Warning::BareNumber { path: path.to_owned(), value, units });
    };
    let number = |path: &str| document.find(path).and_then(plain);
    let length = number("backbone.length").filter(|length| *length > USUAL_LENGTHS[1]);
    if let Some(length) = length {
        bare("backbone.length", length, BareUnits::Millimetres);
    }
    // A distance is wide for the robot whose length is credible.
    let widest = match number("backbone.length") {
        Some(given) if length.is_none() => WIDE.max(WIDE * given),
        _ => WIDE,
    };
    let cables = match document.find("cables").map(|node| &node.value) {
        Some(Value::List(cables)) => cables.len(),
        _ => 0,
    };
    let routings = (0..cables)
        .flat_map(|i| ["radius", "start", "end"].map(|key| format!("cables[{i}].routing.{key}")));
    for path in DISTANCES.iter().map(|path| (*path).to_owned()).chain(routings) {
        let Some(node) = document.find(&path) else { continue };
        // The first of a list stands for all.
        let wide = match &node.value {
            Value::List(items) => items.iter().enumerate().find_map(|(i, item)| {
                Some((format!("{path}[{i}]"), plain(item)?)).filter(|of| of.1.abs() > widest)
            }),
            _ => plain(node).filter(|value| value.abs() > widest).map(|value| (path, value)),
        };
        if let Some((path, value)) = wide {
            bare(&path, value, BareUnits::Millimetres);
        }
    }
    for path in ["backbone.young_modulus", "backbone.shear_modulus"] {
        if let Some(value) = number(path).filter(|value| *value < softest) {
            bare(path, value, BareUnits::Megapascals);
        }
    }
    found
}

/// A number without a unit.
fn plain(node: &Node) -> Option<f64> {
    match node.value {
        Value::Integer(value) => Some(value as f64),
        Value::Number(value) => Some(value),
        _ => None,
    }
}
