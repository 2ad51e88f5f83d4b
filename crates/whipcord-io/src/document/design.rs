//! What a design may change and its targets, as tables of a file.

use super::Table;
use crate::read::{DesignShape, DesignTable, criterion_text, curve_text};

/// Adds the table `[design]` to a file: read again, it says the same. Points are told by the name of their file.
pub(super) fn describe_design(design: &DesignTable, file: &mut Table) {
    let mut table = Table::default();
    let texts: Vec<&str> = design.vary.iter().map(String::as_str).collect();
    table.insert_some("vary", (!texts.is_empty()).then_some(texts));
    table.insert_some("max_jump", design.max_jump);
    table.insert_some("distinct", design.distinct.then_some(true));
    table.insert_some("crossing", design.crossing);
    let criteria: Vec<String> = design.criteria.iter().map(criterion_text).collect();
    let criteria: Vec<&str> = criteria.iter().map(String::as_str).collect();
    table.insert_some("criteria", (!criteria.is_empty()).then_some(criteria));
    table.insert_some("diameter", design.diameter);
    table.insert_some("degree", design.degree);
    table.insert_some("places", design.places);
    table.insert_some("starts", design.starts);
    table.insert_some("iterations", design.iterations);
    table.insert_some("solves", design.solves);
    let fixed: Vec<Table> = design
        .fixed
        .iter()
        .map(|fixed| {
            let mut table = Table::default();
            table.insert("cable", fixed.cable.as_str());
            table.insert("disk", fixed.disk);
            table.insert("hole", fixed.hole);
            table
        })
        .collect();
    table.insert_some("fixed", (!fixed.is_empty()).then_some(fixed));
    let targets: Vec<Table> = design
        .targets
        .iter()
        .map(|target| {
            let mut table = Table::default();
            match &target.shape {
                DesignShape::Curve(curve) => table.insert("curve", curve_text(curve).as_str()),
                DesignShape::Points(_, path) => {
                    table.insert("shape", path.display().to_string().as_str());
                }
                DesignShape::Path(_, path) => {
                    table.insert("path", path.display().to_string().as_str());
                }
                DesignShape::Tip(point) => table.insert("tip", *point),
                DesignShape::Measured => table.insert("measured", true),
            }
            table.insert_some("tension", target.tension.clone());
            table.insert_some("weight", target.weight);
            table
        })
        .collect();
    table.insert_some("targets", (!targets.is_empty()).then_some(targets));
    let given = &design.tolerances;
    let mut tolerances = Table::default();
    for (key, value) in [
        ("hole_radius", given.hole_radius),
        ("hole_angle", given.hole_angle),
        ("disk_position", given.disk_position),
        ("stiffness", given.stiffness),
        ("tension", given.tension),
    ] {
        tolerances.insert_some(key, value);
    }
    tolerances.insert_some("samples", given.samples);
    tolerances.insert_some("seed", given.seed);
    if !tolerances.is_empty() {
        table.insert("tolerances", tolerances);
    }
    if !table.is_empty() {
        file.insert("design", table);
    }
}
