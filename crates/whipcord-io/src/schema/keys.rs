//! The tables and keys of a robot file.

use whipcord::robot::limits::{self, Range};

use super::{Key, Kind, Rule, Table};
use crate::units::Dimension;

/// More disks than any robot has; it keeps a slip of the pen from filling the memory.
const MOST_DISKS: usize = 100_000;
const MOST_HOLES: usize = 100_000;

const LENGTH: Kind = Kind::Quantity(&[Dimension::Length], limits::LENGTH);
const DISTANCE: Kind = Kind::Quantity(&[Dimension::Length], limits::DISTANCE);
const PRESSURE: Kind = Kind::Quantity(&[Dimension::Pressure], limits::MODULUS);
const ANGLE: Kind = Kind::Quantity(&[Dimension::Angle], limits::ANGLE);
const PUBLISHED_TIME: Kind = Kind::Quantity(&[Dimension::Time], DURATION);
const FORCE_VECTOR: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Force], limits::FORCE), 3);
const MOMENT_VECTOR: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Moment], limits::MOMENT), 3);
const CURVATURE_VECTOR: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Curvature], limits::CURVATURE), 3);
const POINT: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Length], limits::COORDINATE), 2);

/// What a published solve time may be: up to 30 years.
pub(crate) const DURATION: Range = Range { least: 0.0, above: false, greatest: 1e9, unit: "s" };

const fn ratio(range: Range) -> Kind {
    Kind::Quantity(&[Dimension::Ratio], range)
}

const fn force(range: Range) -> Kind {
    Kind::Quantity(&[Dimension::Force], range)
}

const fn key(name: &'static str, kind: Kind, example: &'static str, doc: &'static str) -> Key {
    Key { name, kind, example, doc }
}

/// The whole file.
pub(crate) static ROOT: Table = Table {
    title: "the file",
    doc: "A cable-driven continuum robot and what is asked of it. A quantity is a number in SI units or a text of a number and a unit.",
    keys: &[
        key(
            "title",
            Kind::Text,
            r#""Case III""#,
            "What the file describes; by default the file's name.",
        ),
        key(
            "extends",
            Kind::Text,
            r#""prototype.toml""#,
            "Another robot file, relative to this one, over whose tables this file's are laid. Arrays, [[cables]] among them, replace those of the other file.",
        ),
        key("backbone", Kind::Table(&BACKBONE), BACKBONE.title, BACKBONE.doc),
        key("disks", Kind::Table(&DISKS), DISKS.title, DISKS.doc),
        key("cables", Kind::Tables(&CABLE), CABLE.title, CABLE.doc),
        key("loads", Kind::Table(&LOADS), LOADS.title, LOADS.doc),
        key("measured", Kind::Table(&MEASURED), MEASURED.title, MEASURED.doc),
        key("reference", Kind::Table(&REFERENCE), REFERENCE.title, REFERENCE.doc),
    ],
    rules: &[Rule::Required("backbone"), Rule::Required("disks")],
};

static BACKBONE: Table = Table {
    title: "[backbone]",
    doc: "The elastic rod that runs through the disks.",
    keys: &[
        key("length", LENGTH, r#""180 mm""#, "Length of the undeformed backbone."),
        key("diameter", LENGTH, r#""3 mm""#, "Outer diameter of a round rod or tube."),
        key(
            "inner_diameter",
            DISTANCE,
            r#""2 mm""#,
            "Inner diameter of a tube; beside `diameter` or `diameters`.",
        ),
        key(
            "diameters",
            Kind::List(&LENGTH, 2),
            r#"["4 mm", "3 mm", "2 mm"]"#,
            "Outer diameter at each disk, base disk first; it varies linearly between them.",
        ),
        key(
            "section",
            Kind::Table(&SECTION),
            r#"{ width = "6 mm", height = "4 mm" }"#,
            SECTION.doc,
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
            "density",
            Kind::Quantity(&[Dimension::Density], limits::DENSITY),
            r#""1040 kg/m^3""#,
            "Density; needed only with gravity or motion.",
        ),
        key(
            "rest_curvature",
            Kind::Either(&[CURVATURE_VECTOR, Kind::List(&CURVATURE_VECTOR, 2)]),
            r#"["0 1/m", "4 1/m", "0 1/m"]"#,
            "Curvature of the backbone when nothing pulls on it, in its own frame: about x, about y, twist. One such vector, or a list with one for each disk, between which it varies linearly.",
        ),
    ],
    rules: &[
        Rule::Required("length"),
        Rule::AtMostOne(&["diameter", "diameters", "section"]),
        Rule::AtMostOne(&["inner_diameter", "section"]),
        Rule::Needs("inner_diameter", &["diameter", "diameters"]),
        Rule::AtMostOne(&["poisson_ratio", "shear_modulus"]),
    ],
};

static SECTION: Table = Table {
    title: "backbone.section",
    doc: "A rectangular cross-section.",
    keys: &[
        key("width", LENGTH, r#""6 mm""#, "Extent along x."),
        key("height", LENGTH, r#""4 mm""#, "Extent along y."),
    ],
    rules: &[Rule::Required("width"), Rule::Required("height")],
};

static DISKS: Table = Table {
    title: "[disks]",
    doc: "The perforated disks, base disk first. The first sits at the base, the last at the tip.",
    keys: &[
        key(
            "count",
            Kind::Count { least: 2, greatest: MOST_DISKS },
            "10",
            "Number of equally spaced disks, base and tip disk included.",
        ),
        key(
            "positions",
            Kind::List(&DISTANCE, 2),
            r#"["0 mm", "90 mm", "180 mm"]"#,
            "Arc length of each disk, from 0 to the length of the backbone; instead of `count`.",
        ),
        key(
            "hole_circle_radius",
            Kind::Either(&[LENGTH, Kind::List(&LENGTH, 2)]),
            r#""8 mm""#,
            "Radius of the circle on which the holes lie: one for all disks, or a list with one for each.",
        ),
        key(
            "holes",
            Kind::Count { least: 1, greatest: MOST_HOLES },
            "12",
            "Number of equally spaced holes of each disk. Hole 1 lies on the x axis; they count counter-clockwise, seen from the tip.",
        ),
        key(
            "mass",
            Kind::Quantity(&[Dimension::Mass], limits::MASS),
            r#""1.2 g""#,
            "Mass of each disk; 0 by default.",
        ),
    ],
    rules: &[Rule::ExactlyOne(&["count", "positions"])],
};

static CABLE: Table = Table {
    title: "[[cables]]",
    doc: "A cable: where it runs and how it is pulled.",
    keys: &[
        key(
            "name",
            Kind::Text,
            r#""pull""#,
            "Name, unique in the file; by default `cable-1`, `cable-2`, ...",
        ),
        key(
            "holes",
            Kind::List(&Kind::Count { least: 1, greatest: MOST_HOLES }, 2),
            "[1, 2, 3, 4]",
            "The hole it passes at each disk, from the base disk on, counted from 1. A list shorter than the disks ends the cable at its last hole.",
        ),
        key(
            "interpolation",
            Kind::Choice(&["spline", "pchip", "fourier"]),
            r#""pchip""#,
            "How the continuous models lead it from hole to hole: a twice continuously differentiable cubic spline of hole angle and radius (default), monotone cubics, or a Fourier series of order 8 in x and y.",
        ),
        key(
            "routing",
            Kind::Variants { tag: &ROUTING_KIND, variants: ROUTINGS },
            r#"{ kind = "straight", angle = "90 deg", radius = "8 mm" }"#,
            "Where it runs, as a curve; instead of `holes`.",
        ),
        key(
            "ends_at",
            LENGTH,
            r#""90 mm""#,
            "Arc length at which it is anchored; by default the tip.",
        ),
        key(
            "friction",
            ratio(limits::FRICTION),
            "0.1",
            "Capstan friction coefficient at the holes; 0 by default.",
        ),
        key(
            "axial_stiffness",
            force(limits::AXIAL_STIFFNESS),
            r#""2 kN""#,
            "Axial stiffness, Young's modulus times area; inextensible by default. A commanded length is then that of the unstretched cable: the part inside the robot, of unstretched length l0, is longer by tension * l0 / axial_stiffness.",
        ),
        key(
            "tension",
            force(limits::TENSION),
            r#""400 gf""#,
            "Tension, for models driven by force.",
        ),
        key(
            "shortening",
            Kind::Quantity(&[Dimension::Length, Dimension::Ratio], limits::COORDINATE),
            r#""5.7 %""#,
            "By how much its part inside the robot is shortened, for models driven by length: a length, or `%` of its own initial length. Negative is paid out. With `axial_stiffness` it is the unstretched cable that is shortened.",
        ),
    ],
    rules: &[
        Rule::ExactlyOne(&["holes", "routing"]),
        Rule::AtMostOne(&["interpolation", "routing"]),
    ],
};

static ROUTING_KIND: Key = key(
    "kind",
    Kind::Choice(&["straight", "helix", "linear", "polynomial"]),
    "\"straight\"",
    "The shape of the curve.",
);

static ROUTINGS: &[(&str, Table)] = &[
    (
        "straight",
        Table {
            title: "a straight routing",
            doc: "Parallel to the backbone.",
            keys: &[
                key(
                    "angle",
                    ANGLE,
                    r#""90 deg""#,
                    "Angle from x, counter-clockwise seen from the tip.",
                ),
                key("radius", DISTANCE, r#""8 mm""#, "Distance from the backbone's axis."),
            ],
            rules: &[Rule::Required("angle"), Rule::Required("radius")],
        },
    ),
    (
        "helix",
        Table {
            title: "a helix routing",
            doc: "On a helix round the backbone.",
            keys: &[
                key("start_angle", ANGLE, r#""0 deg""#, "Angle at the base; 0 by default."),
                key(
                    "turns",
                    ratio(limits::TURNS),
                    "0.75",
                    "Turns over the whole backbone, positive counter-clockwise seen from the tip.",
                ),
                key("radius", DISTANCE, r#""8 mm""#, "Distance from the backbone's axis."),
            ],
            rules: &[Rule::Required("turns"), Rule::Required("radius")],
        },
    ),
    (
        "linear",
        Table {
            title: "a linear routing",
            doc: "On the straight line between a point of the base and a point of the tip.",
            keys: &[
                key("start", POINT, r#"["8 mm", "0 mm"]"#, "(x, y) at the base."),
                key("end", POINT, r#"["3 mm", "0 mm"]"#, "(x, y) at the tip of the backbone."),
            ],
            rules: &[Rule::Required("start"), Rule::Required("end")],
        },
    ),
    (
        "polynomial",
        Table {
            title: "a polynomial routing",
            doc: "By polynomials in the arc length.",
            keys: &[
                key(
                    "x",
                    Kind::List(&Kind::Number, 1),
                    "[0.008, 0.0]",
                    "Coefficients of x in ascending powers of the arc length, in SI.",
                ),
                key(
                    "y",
                    Kind::List(&Kind::Number, 1),
                    "[0.0, 0.02]",
                    "Coefficients of y in ascending powers of the arc length, in SI.",
                ),
            ],
            rules: &[Rule::Required("x"), Rule::Required("y")],
        },
    ),
];

static LOADS: Table = Table {
    title: "[loads]",
    doc: "External loads, fixed in the base frame unless they follow.",
    keys: &[
        key(
            "gravity",
            Kind::Vector(&Kind::Quantity(&[Dimension::Acceleration], limits::ACCELERATION), 3),
            r#"["0", "0", "-9.81 m/s^2"]"#,
            "Acceleration of gravity as a vector; z points from base to tip of the straight robot.",
        ),
        key(
            "tip_force",
            FORCE_VECTOR,
            r#"["0.05 N", "0 N", "0 N"]"#,
            "Force at the tip of the backbone.",
        ),
        key(
            "tip_moment",
            MOMENT_VECTOR,
            r#"["0", "0", "1 mN*m"]"#,
            "Moment at the tip of the backbone.",
        ),
        key(
            "follower",
            Kind::Flag,
            "true",
            "Whether tip force and tip moment turn with the tip; false by default.",
        ),
        key("point", Kind::Tables(&POINT_LOAD), POINT_LOAD.title, POINT_LOAD.doc),
    ],
    rules: &[],
};

static POINT_LOAD: Table = Table {
    title: "[[loads.point]]",
    doc: "A force and a moment at one place of the backbone.",
    keys: &[
        key("at", DISTANCE, r#""90 mm""#, "Arc length of the place."),
        key("force", FORCE_VECTOR, r#"["0 N", "0.1 N", "0 N"]"#, "Force."),
        key("moment", MOMENT_VECTOR, r#"["0", "0", "1 mN*m"]"#, "Moment."),
        key(
            "follower",
            Kind::Flag,
            "true",
            "Whether they turn with the backbone; false by default.",
        ),
    ],
    rules: &[Rule::Required("at"), Rule::AtLeastOne(&["force", "moment"])],
};

static MEASURED: Table = Table {
    title: "[measured]",
    doc: "What the real robot did.",
    keys: &[key(
        "disks",
        Kind::Text,
        r#""case3_disks.csv""#,
        "CSV file, relative to this one, with the columns disk, x, y, z: number of the disk from 1, and its measured position in m. Disks that were not measured may be missing.",
    )],
    rules: &[Rule::Required("disks")],
};

static REFERENCE: Table = Table {
    title: "[reference]",
    doc: "What others have published for this case: printed beside our values, never computed with.",
    keys: &[
        key("source", Kind::Text, r#""Table 1""#, "Where the values stand."),
        key(
            "rms_four_bar",
            DISTANCE,
            r#""1.44 mm""#,
            "RMS error of the four-bar model against the measurement.",
        ),
        key(
            "rms_cosserat",
            DISTANCE,
            r#""1.80 mm""#,
            "RMS error of the Cosserat model against the measurement.",
        ),
        key("time_four_bar", PUBLISHED_TIME, r#""2.20 s""#, "Solve time of the four-bar model."),
        key("time_cosserat", PUBLISHED_TIME, r#""10.07 s""#, "Solve time of the Cosserat model."),
    ],
    rules: &[Rule::Required("source")],
};
