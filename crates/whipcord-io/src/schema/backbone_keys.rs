//! The table `[backbone]` and what lies in it.

use whipcord::robot::limits;

use super::keys::{DISTANCE, LENGTH, force, key, ratio};
use super::motion_keys::DAMPING;
use super::{Key, Kind, Rule, Table};
use crate::materials::NAMES;
use crate::units::Dimension;

const PRESSURE: Kind = Kind::Quantity(&[Dimension::Pressure], limits::MODULUS);
const CURVATURE_VECTOR: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Curvature], limits::CURVATURE), 3);
const PLACES: Kind = Kind::List(&DISTANCE, 1);
const PLACES_EXAMPLE: &str = r#"["0 mm", "90 mm", "180 mm"]"#;
const PLACES_DOC: &str = "Arc lengths at which the values are given, in ascending order; constant before the first and beyond the last. A place named twice is a step from one value to the next.";
const FORCE_STIFFNESS: Kind = force(limits::SECTION_STIFFNESS);
const FORCE_STIFFNESSES: Kind = Kind::Vector(&FORCE_STIFFNESS, 2);
const BENDING_STIFFNESS: Kind =
    Kind::Quantity(&[Dimension::BendingStiffness], limits::BENDING_STIFFNESS);
const BENDING_STIFFNESSES: Kind = Kind::Vector(&BENDING_STIFFNESS, 2);
const YIELD_MOMENT: Kind = Kind::Quantity(&[Dimension::Moment], limits::YIELD_MOMENT);
pub(super) const SYMMETRIC_MATRIX: Kind = Kind::Vector(&Kind::Vector(&Kind::Number, 6), 6);
const LINEAR_DENSITY: Kind = Kind::Quantity(&[Dimension::LinearDensity], limits::LINEAR_DENSITY);

const STIFFNESS_FACTOR: Kind = ratio(limits::STIFFNESS_FACTOR);

static SEGMENT: Table = Table {
    title: "[[backbone.segments]]",
    doc: "A named segment of the backbone, with factors on the stiffness that section and material, or `[backbone.stiffness]`, give there. Segments are listed from the base on and do not overlap.",
    keys: &[
        key(
            "name",
            Kind::Text,
            r#""near""#,
            "Name, unique among the segments; by default `segment-1`, `segment-2`, ... A fit names the segment by it: backbone.segments[near].bending_factor.",
        ),
        key(
            "group",
            Kind::Text,
            r#""soft""#,
            "Group of segments that it belongs to. A fit can give the segments of a group one number together: backbone.segments[soft].bending_factor.",
        ),
        key(
            "starts_at",
            DISTANCE,
            r#""0 mm""#,
            "Arc length at which it begins; by default the end of the segment before it, or the base.",
        ),
        key("ends_at", LENGTH, r#""90 mm""#, "Arc length at which it ends; by default the tip."),
        key(
            "bending_factor",
            STIFFNESS_FACTOR,
            "1.1",
            "Factor on the bending stiffness EI about x and y; 1 by default.",
        ),
        key(
            "torsion_factor",
            STIFFNESS_FACTOR,
            "0.9",
            "Factor on the torsional stiffness GJ; 1 by default.",
        ),
        key(
            "extension_factor",
            STIFFNESS_FACTOR,
            "1.0",
            "Factor on the extensional stiffness EA; 1 by default.",
        ),
        key(
            "shear_factor",
            STIFFNESS_FACTOR,
            "1.0",
            "Factor on the shear stiffness GA; 1 by default.",
        ),
    ],
    rules: &[],
};

pub(super) static BACKBONE: Table = Table {
    title: "[backbone]",
    doc: "The elastic rod that runs through the disks.",
    keys: &[
        key("length", LENGTH, r#""180 mm""#, "Length of the undeformed backbone."),
        key("diameter", LENGTH, r#""3 mm""#, "Outer diameter of a round rod or tube."),
        key(
            "inner_diameter",
            Kind::Either(&[DISTANCE, Kind::List(&DISTANCE, 2), Kind::Table(&DISTANCES_AT)]),
            r#""2 mm""#,
            "Inner diameter of a tube; beside `diameter` or `diameters`. One value, or a list with one for each disk, between which it varies linearly, or one for each of the arc lengths of a table `{ at = [...], values = [...] }`.",
        ),
        key(
            "diameters",
            Kind::Either(&[Kind::List(&LENGTH, 2), Kind::Table(&LENGTHS_AT)]),
            r#"["4 mm", "3 mm", "2 mm"]"#,
            "Outer diameter at each disk, base disk first, or at the arc lengths of a table `{ at = [...], values = [...] }`; it varies linearly between them.",
        ),
        key(
            "section",
            Kind::Table(&SECTION),
            r#"{ width = "6 mm", height = "4 mm" }"#,
            SECTION.doc,
        ),
        key(
            "material",
            Kind::Choice(&NAMES),
            r#""nitinol""#,
            "Name of a material preset: it sets `young_modulus`, `poisson_ratio` or `shear_modulus`, `density` and, if it is known, `yield_strain`. Keys beside it override single values. The documentation lists the values, their ranges and sources under Materials.",
        ),
        key("young_modulus", PRESSURE, r#""1.1 GPa""#, "Young's modulus."),
        key(
            "poisson_ratio",
            ratio(limits::POISSON_RATIO),
            "0.3",
            "Poisson's ratio; instead of `shear_modulus`.",
        ),
        key(
            "shear_modulus",
            PRESSURE,
            r#""420 MPa""#,
            "Shear modulus; instead of `poisson_ratio`.",
        ),
        key(
            "shear_correction",
            ratio(limits::SHEAR_CORRECTION),
            "0.886",
            "Timoshenko's factor on the shear stiffness GA of section and material; 1 by default. For a circle it is 6(1+nu)/(7+6nu), for a rectangle 5/6.",
        ),
        key("stiffness", Kind::Table(&STIFFNESS), STIFFNESS.title, STIFFNESS.doc),
        key("damping", Kind::Table(&DAMPING), DAMPING.title, DAMPING.doc),
        key("segments", Kind::Tables(&SEGMENT), SEGMENT.title, SEGMENT.doc),
        key(
            "density",
            Kind::Quantity(&[Dimension::Density], limits::DENSITY),
            r#""1040 kg/m^3""#,
            "Density; needed only with gravity or motion.",
        ),
        key(
            "linear_density",
            Kind::Either(&[
                LINEAR_DENSITY,
                Kind::List(&LINEAR_DENSITY, 2),
                Kind::Table(&LINEAR_DENSITIES_AT),
            ]),
            r#""7.4 g/m""#,
            "Mass per length, instead of `density`; needed only with gravity or motion. One value, or a list with one for each disk, or a table `{ at = [...], values = [...] }`.",
        ),
        key(
            "yield_strain",
            ratio(limits::YIELD_STRAIN),
            r#""8 %""#,
            "Strain up to which the material springs back. No model computes with it: where the surface of the backbone is strained more, there is a warning; without it that is so above 10 %.",
        ),
        key(
            "yield_moment",
            Kind::Either(&[YIELD_MOMENT, Kind::Vector(&YIELD_MOMENT, 2)]),
            r#""10 mN*m""#,
            "Greatest moment of the friction against bending inside the backbone, for example between strands or sheaths: one value, or one about x and one about y. The shape then depends on all steps before (`[[steps]]`), and equal commands from either side give different shapes.",
        ),
        key(
            "yield_stiffness",
            Kind::Either(&[BENDING_STIFFNESS, BENDING_STIFFNESSES]),
            r#""0.04 N*m^2""#,
            "Bending stiffness that this friction adds until it slides: one value, or one about x and one about y; 10 times the elastic bending stiffness EI by default.",
        ),
        key(
            "rest_curvature",
            Kind::Either(&[
                CURVATURE_VECTOR,
                Kind::List(&CURVATURE_VECTOR, 2),
                Kind::Table(&CURVATURES_AT),
            ]),
            r#"["0 1/m", "4 1/m", "0 1/m"]"#,
            "Curvature of the backbone when nothing pulls on it, in its own frame: about x, about y, twist. One such vector, or a list with one for each disk, between which it varies linearly, or one for each of the arc lengths of a table `{ at = [...], values = [...] }`.",
        ),
        key(
            "extensible",
            Kind::Flag,
            "false",
            "Whether the backbone can stretch; true by default. If not, its stiffness EA is of no effect.",
        ),
        key(
            "shearable",
            Kind::Flag,
            "false",
            "Whether the sections can shear; true by default. If not, their stiffness GA is of no effect.",
        ),
    ],
    rules: &[
        Rule::Required("length"),
        Rule::AtMostOne(&["diameter", "diameters", "section"]),
        Rule::AtMostOne(&["inner_diameter", "section"]),
        Rule::Needs("inner_diameter", &["diameter", "diameters"]),
        Rule::AtMostOne(&["poisson_ratio", "shear_modulus"]),
        Rule::AtMostOne(&["material", "stiffness"]),
        Rule::AtMostOne(&["young_modulus", "stiffness"]),
        Rule::AtMostOne(&["poisson_ratio", "stiffness"]),
        Rule::AtMostOne(&["shear_modulus", "stiffness"]),
        Rule::AtMostOne(&["shear_correction", "stiffness"]),
        Rule::AtMostOne(&["density", "linear_density"]),
        Rule::Needs("yield_stiffness", &["yield_moment"]),
        Rule::Replaces(
            "material",
            &[
                "young_modulus",
                "poisson_ratio",
                "shear_modulus",
                "density",
                "linear_density",
                "yield_strain",
            ],
        ),
    ],
};

const fn values_at(title: &'static str, doc: &'static str, keys: &'static [Key]) -> Table {
    Table { title, doc, keys, rules: &[Rule::Required("at"), Rule::Required("values")] }
}

static LENGTHS_AT: Table = values_at(
    "backbone.diameters",
    "Outer diameters at arc lengths.",
    &[
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
        key("values", Kind::List(&LENGTH, 1), r#"["4 mm", "3 mm", "2 mm"]"#, "Outer diameters."),
    ],
);

static DISTANCES_AT: Table = values_at(
    "backbone.inner_diameter",
    "Inner diameters at arc lengths.",
    &[
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
        key("values", Kind::List(&DISTANCE, 1), r#"["3 mm", "2 mm", "1 mm"]"#, "Inner diameters."),
    ],
);

static LINEAR_DENSITIES_AT: Table = values_at(
    "backbone.linear_density",
    "Mass per length at arc lengths.",
    &[
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
        key(
            "values",
            Kind::List(&LINEAR_DENSITY, 1),
            r#"["9 g/m", "7 g/m", "5 g/m"]"#,
            "Mass per length.",
        ),
    ],
);

static CURVATURES_AT: Table = values_at(
    "backbone.rest_curvature",
    "Rest curvatures at arc lengths.",
    &[
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
        key(
            "values",
            Kind::List(&CURVATURE_VECTOR, 1),
            r#"[[0, "4 1/m", 0], [0, "2 1/m", 0], [0, 0, 0]]"#,
            "Curvatures: about x, about y, twist.",
        ),
    ],
);

static STIFFNESS: Table = Table {
    title: "[backbone.stiffness]",
    doc: "Stiffness of the backbone's sections, instead of that of section and material. Each entry is one value, or a list with one for each disk, between which it varies linearly, or one for each place of `at`.",
    keys: &[
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
        key(
            "shear",
            Kind::Either(&[FORCE_STIFFNESSES, Kind::List(&FORCE_STIFFNESSES, 1)]),
            r#"["3 kN", "3 kN"]"#,
            "GA, the stiffness against shear along x and y; not needed where the backbone is not shearable.",
        ),
        key(
            "axial",
            Kind::Either(&[FORCE_STIFFNESS, Kind::List(&FORCE_STIFFNESS, 1)]),
            r#""8 kN""#,
            "EA, the stiffness against extension; not needed where the backbone is not extensible.",
        ),
        key(
            "bending",
            Kind::Either(&[BENDING_STIFFNESSES, Kind::List(&BENDING_STIFFNESSES, 1)]),
            r#"["0.004 N*m^2", "0.004 N*m^2"]"#,
            "EI, the stiffness against bending about x and y.",
        ),
        key(
            "torsion",
            Kind::Either(&[BENDING_STIFFNESS, Kind::List(&BENDING_STIFFNESS, 1)]),
            r#""0.003 N*m^2""#,
            "GJ, the stiffness against twist.",
        ),
        key(
            "matrix",
            Kind::Either(&[SYMMETRIC_MATRIX, Kind::List(&SYMMETRIC_MATRIX, 1)]),
            "[[3000, 0, 0, 0, 0, 1.5], [0, 3000, 0, 0, 0, 0], [0, 0, 8000, 0, 0, 0], [0, 0, 0, 0.004, 0.001, 0], [0, 0, 0, 0.001, 0.004, 0], [1.5, 0, 0, 0, 0, 0.003]]",
            "The full symmetric, positive definite stiffness in SI units, by rows: shear along x and y, extension, bending about x and y, twist. Instead of the other entries.",
        ),
    ],
    rules: &[
        Rule::ExactlyOne(&["bending", "matrix"]),
        Rule::Needs("bending", &["torsion"]),
        Rule::AtMostOne(&["shear", "matrix"]),
        Rule::AtMostOne(&["axial", "matrix"]),
        Rule::AtMostOne(&["torsion", "matrix"]),
    ],
};

static SECTION: Table = Table {
    title: "backbone.section",
    doc: "A rectangular cross-section. Each extent is one value, or a list with one for each disk, between which it varies linearly, or one for each place of `at`.",
    keys: &[
        key(
            "width",
            Kind::Either(&[LENGTH, Kind::List(&LENGTH, 1)]),
            r#""6 mm""#,
            "Extent along x.",
        ),
        key(
            "height",
            Kind::Either(&[LENGTH, Kind::List(&LENGTH, 1)]),
            r#""4 mm""#,
            "Extent along y.",
        ),
        key("at", PLACES, PLACES_EXAMPLE, PLACES_DOC),
    ],
    rules: &[Rule::Required("width"), Rule::Required("height")],
};
