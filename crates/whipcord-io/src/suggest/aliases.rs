//! What people call things whose keys have other names here, as other programs, papers and drawings
//! do, and what to write instead.

use super::remedy::Remedy;
use super::remedy::Remedy::{Half, Key, Say, Twice};

/// Names of one thing in some tables, which are told by their titles.
struct Alias {
    tables: &'static [&'static str],
    names: &'static [&'static str],
    remedy: Remedy,
}

const fn alias(
    tables: &'static [&'static str],
    names: &'static [&'static str],
    remedy: Remedy,
) -> Alias {
    Alias { tables, names, remedy }
}

const FILE: &[&str] = &["the file"];
const BACKBONE: &[&str] = &["[backbone]"];
const DISKS: &[&str] = &["[disks]"];
const CABLES: &[&str] = &["[[cables]]"];
const STEPS: &[&str] = &["[[steps]]"];
const LOADS: &[&str] = &["[loads]"];
const POINT: &[&str] = &["[[loads.point]]", "[[loads.mass]]"];
const MEASURED: &[&str] = &["[measured]"];
const BASE: &[&str] = &["[base]"];
const FORMS: &[&str] = &[
    "a half-space",
    "a sphere",
    "a capsule",
    "a box",
    "a cylinder",
    "a pipe",
    "a superellipsoid",
    "a mesh",
];
const ROUND: &[&str] = &["a sphere", "a capsule", "a cylinder", "a pipe"];
const LONG: &[&str] = &["a capsule", "a cylinder"];
const ROUTINGS: &[&str] = &["a straight routing", "a helix routing"];

/// Names in lower case with `_` between words. The first alias of a name holds.
static ALIASES: &[Alias] = &[
    alias(FILE, &["rod", "beam", "spine", "body", "arm", "robot", "tube"], Key("backbone")),
    alias(
        FILE,
        &["disc", "discs", "spacer", "spacers", "spacer_disks", "spacer_discs", "plates"],
        Key("disks"),
    ),
    alias(
        FILE,
        &[
            "tendon",
            "tendons",
            "wire",
            "wires",
            "rope",
            "ropes",
            "string",
            "strings",
            "actuator",
            "actuators",
        ],
        Key("cables"),
    ),
    alias(FILE, &["forces", "external_loads", "external_forces", "external"], Key("loads")),
    alias(FILE, &["actuation"], Key("steps")),
    alias(FILE, &["measurement", "measurements", "experiment"], Key("measured")),
    alias(FILE, &["contact", "contacts", "objects", "bodies"], Key("obstacles")),
    alias(FILE, &["name", "description"], Key("title")),
    alias(
        FILE,
        &["material", "materials"],
        Say(
            "write `material` under [backbone], such as `material = \"nitinol\"`, or the numbers `young_modulus`, `poisson_ratio` and `density`",
        ),
    ),
    alias(
        FILE,
        &["unit", "units"],
        Say(
            "each quantity has its own unit, such as \"180 mm\"; a number without one is in SI units",
        ),
    ),
    alias(
        BACKBONE,
        &["l", "total_length", "arc_length", "arclength", "rod_length", "backbone_length"],
        Key("length"),
    ),
    alias(
        BACKBONE,
        &["d", "do", "od", "outer_diameter", "outside_diameter", "rod_diameter", "wire_diameter"],
        Key("diameter"),
    ),
    alias(
        BACKBONE,
        &[
            "r",
            "ro",
            "r_o",
            "radius",
            "outer_radius",
            "outside_radius",
            "rod_radius",
            "wire_radius",
        ],
        Twice("diameter"),
    ),
    alias(
        BACKBONE,
        &["id", "di", "bore", "bore_diameter", "inside_diameter"],
        Key("inner_diameter"),
    ),
    alias(
        BACKBONE,
        &["ri", "r_i", "inner_radius", "inside_radius", "bore_radius"],
        Twice("inner_diameter"),
    ),
    alias(
        BACKBONE,
        &["wall", "wall_thickness", "t", "thickness"],
        Say("write `inner_diameter`: `diameter` less twice the thickness of the wall"),
    ),
    alias(
        BACKBONE,
        &["width", "height", "w", "h", "b"],
        Say("a rectangular section is `section = { width = \"6 mm\", height = \"4 mm\" }`"),
    ),
    alias(
        BACKBONE,
        &[
            "e",
            "young",
            "youngs",
            "youngs_modulus",
            "young's_modulus",
            "elastic_modulus",
            "e_modulus",
            "emodulus",
            "modulus",
            "modulus_of_elasticity",
            "elasticity",
        ],
        Key("young_modulus"),
    ),
    alias(
        BACKBONE,
        &["nu", "ν", "poisson", "poissons_ratio", "poisson's_ratio"],
        Key("poisson_ratio"),
    ),
    alias(BACKBONE, &["g", "modulus_of_rigidity", "rigidity"], Key("shear_modulus")),
    alias(BACKBONE, &["rho", "ρ", "mass_density"], Key("density")),
    alias(BACKBONE, &["mass_per_length", "mass_per_unit_length", "rho_a"], Key("linear_density")),
    alias(
        BACKBONE,
        &["mass", "m", "weight"],
        Say("write `density`, or `linear_density`, the mass over the length"),
    ),
    alias(
        BACKBONE,
        &[
            "ei",
            "gj",
            "ea",
            "ga",
            "bending_stiffness",
            "bending",
            "torsion",
            "axial",
            "flexural_rigidity",
            "flexural_stiffness",
            "kb",
            "k_b",
            "kbt",
            "kse",
        ],
        Say(
            "write a table [backbone.stiffness] with `bending = [EI_x, EI_y]`, `torsion = GJ`, `axial = EA` and `shear = [GA_x, GA_y]`, instead of section and material",
        ),
    ),
    alias(
        BACKBONE,
        &["i", "j", "a", "ix", "iy", "area", "second_moment"],
        Say(
            "areas and second moments follow from `diameter` or `section`; else write the stiffnesses EI, GJ, EA and GA as [backbone.stiffness]",
        ),
    ),
    alias(
        BACKBONE,
        &["curvature", "precurvature", "pre_curvature", "initial_curvature", "kappa", "u_star"],
        Key("rest_curvature"),
    ),
    alias(
        BACKBONE,
        &["radius_of_curvature", "bend_radius", "bending_radius"],
        Say(
            "write `rest_curvature`, 1 over the radius: `rest_curvature = [\"0 1/m\", \"4 1/m\", \"0 1/m\"]` bends about y with a radius of 250 mm",
        ),
    ),
    alias(BACKBONE, &["materials", "preset", "alloy", "material_name"], Key("material")),
    alias(
        DISKS,
        &[
            "n",
            "number",
            "num",
            "n_disks",
            "n_disk",
            "num_disks",
            "disk_count",
            "ndisks",
            "number_of_disks",
            "disks",
            "amount",
        ],
        Key("count"),
    ),
    alias(DISKS, &["at", "s", "arc_lengths", "locations", "disk_positions"], Key("positions")),
    alias(
        DISKS,
        &["spacing", "pitch", "distance", "gap", "disk_spacing"],
        Say(
            "write `count`, base and tip disk included: the length of the backbone over the spacing, plus 1",
        ),
    ),
    alias(
        DISKS,
        &[
            "pitch_radius",
            "pitch_circle_radius",
            "bolt_circle_radius",
            "tendon_radius",
            "cable_radius",
            "routing_radius",
            "tendon_offset",
            "cable_offset",
            "hole_offset",
            "offset",
            "hole_distance",
        ],
        Key("hole_circle_radius"),
    ),
    alias(
        DISKS,
        &[
            "hole_circle_diameter",
            "pitch_diameter",
            "pitch_circle_diameter",
            "pcd",
            "bolt_circle_diameter",
        ],
        Half("hole_circle_radius"),
    ),
    alias(
        DISKS,
        &["hole_radius", "hole_diameter", "hole_size"],
        Say(
            "the holes have no size of their own; `hole_circle_radius` is the radius of the circle on which their centres lie",
        ),
    ),
    alias(
        DISKS,
        &["radius", "r"],
        Say(
            "`hole_circle_radius` is the radius of the circle on which the holes lie, `outer_radius` that of the disk's rim",
        ),
    ),
    alias(DISKS, &["disk_radius", "r_disk", "rim_radius"], Key("outer_radius")),
    alias(DISKS, &["diameter", "outer_diameter", "disk_diameter", "od", "d"], Half("outer_radius")),
    alias(
        DISKS,
        &["n_holes", "num_holes", "nholes", "hole_count", "holes_per_disk", "number_of_holes"],
        Key("holes"),
    ),
    alias(DISKS, &["height", "h", "t", "width", "disk_thickness"], Key("thickness")),
    alias(DISKS, &["m", "weight", "disk_mass"], Key("mass")),
    alias(DISKS, &["density", "rho"], Say("write `mass`, the mass of each disk")),
    alias(
        CABLES,
        &["pull"],
        Say("write `tension`, a force such as \"4 N\", or `shortening`, such as \"5 mm\""),
    ),
    alias(
        CABLES,
        &["force", "f", "t", "tau", "τ", "load", "pull_force", "cable_tension", "tendon_tension"],
        Key("tension"),
    ),
    alias(
        CABLES,
        &[
            "displacement",
            "stroke",
            "travel",
            "retraction",
            "delta_l",
            "dl",
            "delta_length",
            "length_change",
            "pull_length",
            "q",
        ],
        Key("shortening"),
    ),
    alias(
        CABLES,
        &["length", "cable_length", "l"],
        Say(
            "write `shortening`: the length of the cable's part inside the robot before actuation, less that after it",
        ),
    ),
    alias(CABLES, &["path", "hole_list", "hole_sequence"], Key("holes")),
    alias(CABLES, &["route"], Key("routing")),
    alias(
        CABLES,
        &["angle", "theta", "phi", "radius", "r", "offset", "turns", "position"],
        Say(
            "give the course of the cable as one table: `routing = { kind = \"straight\", angle = \"90 deg\", radius = \"8 mm\" }`",
        ),
    ),
    alias(
        CABLES,
        &["mu", "μ", "µ", "friction_coefficient", "coefficient_of_friction"],
        Key("friction"),
    ),
    alias(CABLES, &["ea", "ae"], Key("axial_stiffness")),
    alias(
        CABLES,
        &["stiffness", "spring_constant", "k"],
        Say(
            "write `axial_stiffness`, Young's modulus times cross-section in N: a stiffness in N/m times the length of the cable",
        ),
    ),
    alias(
        CABLES,
        &["young_modulus", "e", "diameter"],
        Say("write `axial_stiffness`, Young's modulus times cross-section in N"),
    ),
    alias(CABLES, &["angle_offset", "hole_turn", "holes_angle"], Key("hole_angle_offset")),
    alias(CABLES, &["radius_offset", "hole_shift", "holes_radius"], Key("hole_radius_offset")),
    alias(CABLES, &["end", "end_at", "anchor", "anchored_at", "terminates_at"], Key("ends_at")),
    alias(
        CABLES,
        &["end_disk", "last_disk"],
        Say("let the list of `holes` end at that disk, or write `ends_at`, an arc length"),
    ),
    alias(ROUTINGS, &["r", "offset", "distance"], Key("radius")),
    alias(ROUTINGS, &["diameter", "d"], Half("radius")),
    alias(&["a straight routing"], &["theta", "phi", "start_angle"], Key("angle")),
    alias(&["a helix routing"], &["theta", "phi", "angle"], Key("start_angle")),
    alias(
        &["a helix routing"],
        &["pitch", "lead"],
        Say("write `turns`, the length of the backbone over the pitch"),
    ),
    alias(STEPS, &["tensions", "force", "forces", "f", "tau"], Key("tension")),
    alias(STEPS, &["shortenings", "displacement", "displacements", "stroke"], Key("shortening")),
    alias(LOADS, &["g", "acceleration"], Key("gravity")),
    alias(LOADS, &["force", "f", "end_force", "tip_load", "load", "f_tip"], Key("tip_force")),
    alias(
        LOADS,
        &["moment", "torque", "m", "tip_torque", "end_moment", "m_tip", "tip_couple"],
        Key("tip_moment"),
    ),
    alias(
        LOADS,
        &["payload", "tip_mass", "weight", "tip_weight"],
        Say(
            "add a table [[loads.mass]] with `mass` and `at`, the length of the backbone for one at the tip, and `gravity` under [loads]",
        ),
    ),
    alias(LOADS, &["points", "point_load", "point_loads", "point_force"], Key("point")),
    alias(LOADS, &["line_load", "distributed_load", "distributed_loads"], Key("distributed")),
    alias(POINT, &["position", "s", "arc_length", "location", "where"], Key("at")),
    alias(POINT, &["f", "load"], Key("force")),
    alias(POINT, &["torque"], Key("moment")),
    alias(MEASURED, &["file", "path", "csv", "data", "filename"], Key("disks")),
    alias(MEASURED, &["units", "length_unit"], Key("unit")),
    alias(BASE, &["origin", "translation", "location"], Key("position")),
    alias(BASE, &["quaternion", "q"], Key("orientation")),
    alias(FORMS, &["center", "centre", "origin", "location", "translation"], Key("position")),
    alias(FORMS, &["quaternion", "q"], Key("orientation")),
    alias(FORMS, &["mu", "μ", "µ"], Key("friction")),
    alias(ROUND, &["r"], Key("radius")),
    alias(ROUND, &["diameter", "d"], Half("radius")),
    alias(LONG, &["height", "h", "l"], Key("length")),
    alias(&["a box"], &["dimensions", "extents", "lengths"], Key("size")),
    alias(&["a half-space"], &["direction", "n"], Key("normal")),
    alias(
        LONG,
        &["axis", "direction"],
        Say(
            "its axis is the z axis of its frame: turn the frame, by `rotation = { axis = [0, 1, 0], angle = \"90 deg\" }` to lie along x or by `axis = [1, 0, 0]` to lie along y",
        ),
    ),
];

fn normal(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}

/// What to write instead of `name` in the table of this title.
pub(super) fn find(name: &str, title: &str) -> Option<Remedy> {
    let name = normal(name);
    let of = |alias: &&Alias| alias.tables.contains(&title) && alias.names.contains(&&*name);
    ALIASES.iter().find(of).map(|alias| alias.remedy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Kind, ROOT, Table};

    fn titles(table: &'static Table, all: &mut Vec<&'static Table>) {
        all.push(table);
        for key in table.keys {
            match &key.kind {
                Kind::Table(inner) | Kind::Tables(inner) => titles(inner, all),
                Kind::Variants { variants, .. } | Kind::TablesOfKinds { variants, .. } => {
                    variants.iter().for_each(|(_, inner)| titles(inner, all));
                }
                _ => {}
            }
        }
    }

    #[test]
    fn every_alias_leads_to_a_key_of_its_table_and_none_is_a_key_itself() {
        let mut tables = Vec::new();
        titles(&ROOT, &mut tables);
        for alias in ALIASES {
            for title in alias.tables {
                let table = tables.iter().find(|table| table.title == *title);
                let table = table.unwrap_or_else(|| panic!("there is no table {title}"));
                for name in alias.names {
                    assert_eq!(*name, normal(name), "{name}");
                    // A form that has the key is not asked about it.
                    let is_key = table.key(name).is_some();
                    assert!(!is_key || alias.tables.len() > 1, "{name} is a key of {title}");
                }
                if let Some(key) = alias.remedy.key() {
                    let of_some = alias.tables.len() > 1;
                    assert!(table.key(key).is_some() || of_some, "{title} has no {key}");
                }
            }
        }
    }

    #[test]
    fn no_name_means_two_things_in_a_table() {
        let mut seen = std::collections::BTreeSet::new();
        for alias in ALIASES {
            for title in alias.tables {
                for name in alias.names {
                    assert!(seen.insert((title, name)), "{name} in {title}");
                }
            }
        }
    }
}
