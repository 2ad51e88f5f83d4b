//! The tables and keys of a robot file.

use super::{Key, Kind, Rule, Table};
use crate::units::Dimension;

/// More disks than any robot has; it keeps a slip of the pen from filling the memory.
const MOST_DISKS: usize = 100_000;
const MOST_HOLES: usize = 100_000;

const LENGTH: Kind = Kind::Quantity(&[Dimension::Length]);
const PRESSURE: Kind = Kind::Quantity(&[Dimension::Pressure]);
const FORCE: Kind = Kind::Quantity(&[Dimension::Force]);
const ANGLE: Kind = Kind::Quantity(&[Dimension::Angle]);
const RATIO: Kind = Kind::Quantity(&[Dimension::Ratio]);
const TIME: Kind = Kind::Quantity(&[Dimension::Time]);
const FORCE_VECTOR: Kind = Kind::Vector(&FORCE, 3);
const MOMENT_VECTOR: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Moment]), 3);
const CURVATURE_VECTOR: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Curvature]), 3);
const POINT: Kind = Kind::Vector(&LENGTH, 2);

const fn key(name: &'static str, kind: Kind, doc: &'static str) -> Key {
    Key { name, kind, doc }
}

/// The whole file.
pub(crate) static ROOT: Table = Table {
    title: "the file",
    doc: "A cable-driven continuum robot and what is asked of it. A quantity is a number in SI units or a text of a number and a unit.",
    keys: &[
        key("title", Kind::Text, "What the file describes; by default the file's name."),
        key(
            "extends",
            Kind::Text,
            "Another robot file, relative to this one, over whose tables this file's are laid. Arrays, [[cables]] among them, replace those of the other file.",
        ),
        key("backbone", Kind::Table(&BACKBONE), BACKBONE.doc),
        key("disks", Kind::Table(&DISKS), DISKS.doc),
        key("cables", Kind::Tables(&CABLE), CABLE.doc),
        key("loads", Kind::Table(&LOADS), LOADS.doc),
        key("measured", Kind::Table(&MEASURED), MEASURED.doc),
        key("reference", Kind::Table(&REFERENCE), REFERENCE.doc),
    ],
    rules: &[Rule::Required("backbone"), Rule::Required("disks")],
};

static BACKBONE: Table = Table {
    title: "[backbone]",
    doc: "The elastic rod that runs through the disks.",
    keys: &[
        key("length", LENGTH, "Length of the undeformed backbone."),
        key("diameter", LENGTH, "Outer diameter of a round rod or tube."),
        key(
            "inner_diameter",
            LENGTH,
            "Inner diameter of a tube; beside `diameter` or `diameters`.",
        ),
        key(
            "diameters",
            Kind::List(&LENGTH),
            "Outer diameter at each disk, base disk first; it varies linearly between them.",
        ),
        key("section", Kind::Table(&SECTION), SECTION.doc),
        key("young_modulus", PRESSURE, "Young's modulus."),
        key("poisson_ratio", RATIO, "Poisson's ratio; instead of `shear_modulus`."),
        key("shear_modulus", PRESSURE, "Shear modulus; instead of `poisson_ratio`."),
        key(
            "density",
            Kind::Quantity(&[Dimension::Density]),
            "Density; needed only with gravity or motion.",
        ),
        key(
            "rest_curvature",
            Kind::Either(&[CURVATURE_VECTOR, Kind::List(&CURVATURE_VECTOR)]),
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
    keys: &[key("width", LENGTH, "Extent along x."), key("height", LENGTH, "Extent along y.")],
    rules: &[Rule::Required("width"), Rule::Required("height")],
};

static DISKS: Table = Table {
    title: "[disks]",
    doc: "The perforated disks, base disk first. The first sits at the base, the last at the tip.",
    keys: &[
        key(
            "count",
            Kind::Count { least: 2, greatest: MOST_DISKS },
            "Number of equally spaced disks, base and tip disk included.",
        ),
        key(
            "positions",
            Kind::List(&LENGTH),
            "Arc length of each disk, from 0 to the length of the backbone; instead of `count`.",
        ),
        key(
            "hole_circle_radius",
            Kind::Either(&[LENGTH, Kind::List(&LENGTH)]),
            "Radius of the circle on which the holes lie: one for all disks, or a list with one for each.",
        ),
        key(
            "holes",
            Kind::Count { least: 1, greatest: MOST_HOLES },
            "Number of equally spaced holes of each disk. Hole 1 lies on the x axis; they count counter-clockwise, seen from the tip.",
        ),
        key("mass", Kind::Quantity(&[Dimension::Mass]), "Mass of each disk; 0 by default."),
    ],
    rules: &[Rule::ExactlyOne(&["count", "positions"])],
};

static CABLE: Table = Table {
    title: "[[cables]]",
    doc: "A cable: where it runs and how it is pulled.",
    keys: &[
        key("name", Kind::Text, "Name, unique in the file; by default `cable-1`, `cable-2`, ..."),
        key(
            "holes",
            Kind::List(&Kind::Count { least: 1, greatest: MOST_HOLES }),
            "The hole it passes at each disk, from the base disk on, counted from 1. A list shorter than the disks ends the cable at its last hole.",
        ),
        key(
            "interpolation",
            Kind::Choice(&["spline", "pchip", "fourier"]),
            "How the continuous models lead it from hole to hole: a twice continuously differentiable cubic spline of hole angle and radius (default), monotone cubics, or a Fourier series of order 8 in x and y.",
        ),
        key(
            "routing",
            Kind::Variants { tag: "kind", variants: ROUTINGS },
            "Where it runs, as a curve; instead of `holes`.",
        ),
        key("ends_at", LENGTH, "Arc length at which it is anchored; by default the tip."),
        key("friction", RATIO, "Capstan friction coefficient at the holes; 0 by default."),
        key(
            "axial_stiffness",
            FORCE,
            "Axial stiffness, Young's modulus times area; inextensible by default.",
        ),
        key("tension", FORCE, "Tension, for models driven by force."),
        key(
            "shortening",
            Kind::Quantity(&[Dimension::Length, Dimension::Ratio]),
            "By how much its part inside the robot is shortened, for models driven by length: a length, or `%` of its own initial length. Negative is paid out.",
        ),
    ],
    rules: &[
        Rule::ExactlyOne(&["holes", "routing"]),
        Rule::AtMostOne(&["interpolation", "routing"]),
    ],
};

static ROUTINGS: &[(&str, Table)] = &[
    (
        "straight",
        Table {
            title: "a straight routing",
            doc: "Parallel to the backbone.",
            keys: &[
                key("angle", ANGLE, "Angle from x, counter-clockwise seen from the tip."),
                key("radius", LENGTH, "Distance from the backbone's axis."),
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
                key("start_angle", ANGLE, "Angle at the base; 0 by default."),
                key(
                    "turns",
                    RATIO,
                    "Turns over the whole backbone, positive counter-clockwise seen from the tip.",
                ),
                key("radius", LENGTH, "Distance from the backbone's axis."),
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
                key("start", POINT, "(x, y) at the base."),
                key("end", POINT, "(x, y) at the tip of the backbone."),
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
                    Kind::List(&Kind::Number),
                    "Coefficients of x in ascending powers of the arc length, in SI.",
                ),
                key(
                    "y",
                    Kind::List(&Kind::Number),
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
            Kind::Vector(&Kind::Quantity(&[Dimension::Acceleration]), 3),
            "Acceleration of gravity as a vector; z points from base to tip of the straight robot.",
        ),
        key("tip_force", FORCE_VECTOR, "Force at the tip of the backbone."),
        key("tip_moment", MOMENT_VECTOR, "Moment at the tip of the backbone."),
        key(
            "follower",
            Kind::Flag,
            "Whether tip force and tip moment turn with the tip; false by default.",
        ),
        key("point", Kind::Tables(&POINT_LOAD), POINT_LOAD.doc),
    ],
    rules: &[],
};

static POINT_LOAD: Table = Table {
    title: "[[loads.point]]",
    doc: "A force and a moment at one place of the backbone.",
    keys: &[
        key("at", LENGTH, "Arc length of the place."),
        key("force", FORCE_VECTOR, "Force."),
        key("moment", MOMENT_VECTOR, "Moment."),
        key("follower", Kind::Flag, "Whether they turn with the backbone; false by default."),
    ],
    rules: &[Rule::Required("at"), Rule::AtLeastOne(&["force", "moment"])],
};

static MEASURED: Table = Table {
    title: "[measured]",
    doc: "What the real robot did.",
    keys: &[key(
        "disks",
        Kind::Text,
        "CSV file, relative to this one, with the columns disk, x, y, z: number of the disk from 1, and its measured position in m. Disks that were not measured may be missing.",
    )],
    rules: &[Rule::Required("disks")],
};

static REFERENCE: Table = Table {
    title: "[reference]",
    doc: "What others have published for this case: printed beside our values, never computed with.",
    keys: &[
        key("source", Kind::Text, "Where the values stand."),
        key("rms_four_bar", LENGTH, "RMS error of the four-bar model against the measurement."),
        key("rms_cosserat", LENGTH, "RMS error of the Cosserat model against the measurement."),
        key("time_four_bar", TIME, "Solve time of the four-bar model."),
        key("time_cosserat", TIME, "Solve time of the Cosserat model."),
    ],
    rules: &[Rule::Required("source")],
};
