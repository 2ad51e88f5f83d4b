//! The table `[design]`.

use whipcord::robot::limits::{self, Range};

use super::keys::{DISTANCE, LENGTH, TENSION, key, ratio};
use super::load_keys::POSITION;
use super::{Kind, Rule, Table};
use crate::units::Dimension;

/// What a standard deviation of an angle may be.
pub(crate) const DEVIATION_OF_ANGLE: Range =
    Range { least: 0.0, above: false, greatest: core::f64::consts::PI, unit: "rad" };
/// What a standard deviation may be as a part of a quantity.
pub(crate) const DEVIATION: Range = Range { least: 0.0, above: false, greatest: 1.0, unit: "" };
/// What a weight may be.
pub(crate) const WEIGHT: Range = Range { least: 0.0, above: true, greatest: 1e9, unit: "" };

/// Robots that a sample of tolerances may have.
pub(crate) const MOST_SAMPLES: usize = 1_000_000;

pub(super) static DESIGN: Table = Table {
    title: "[design]",
    doc: "What `whipcord design` may change of the robot, so that it takes its target shapes, within which rules. Its target is that of [[design.targets]], else that of [target].",
    keys: &[
        key(
            "vary",
            Kind::List(&Kind::Text, 1),
            r#"["cables[0].holes", "backbone.rest_curvature"]"#,
            "What may change: cables[0].holes, cables[0].routing (as polynomials), cables[0].tension, each with a number from 0, a name, or * for all in the brackets; backbone.rest_curvature (pre-bend), backbone.diameters (taper), disks.positions, cables (their number), or a number of the robot such as backbone.young_modulus.",
        ),
        key(
            "max_jump",
            Kind::Count { least: 0, greatest: 100_000 },
            "2",
            "Holes by which a cable may move from a disk to the next, either way; not limited by default.",
        ),
        key(
            "distinct",
            Kind::Flag,
            "true",
            "Whether no two cables may share a hole; they may by default.",
        ),
        key(
            "crossing",
            Kind::Flag,
            "false",
            "Whether cables may cross one another between two disks; they may by default.",
        ),
        key("fixed", Kind::Tables(&FIXED), FIXED.title, FIXED.doc),
        key(
            "criteria",
            Kind::List(&Kind::Text, 1),
            r#"["tension, weight = 0.01", "clearance, at_least = 5 mm"]"#,
            "What counts beside the targets: `tension`, with `at_most` for a limit; `clearance` from obstacles, `stiffness, disk = 10, direction = x` of a disk against a force (without `direction` in the direction with the least stiffness), and `workspace`, the volume that the tip gets to, each with `at_least` for a limit. A limit is a hard constraint; `weight` makes an objective, which counts beside the squares of the distances as parts of the length. With criteria there need not be targets.",
        ),
        key(
            "diameter",
            Kind::Vector(&LENGTH, 2),
            r#"["1 mm", "5 mm"]"#,
            "Least and greatest diameter of the backbone; by default a quarter and four times of what it has.",
        ),
        key(
            "degree",
            Kind::Count { least: 0, greatest: 15 },
            "5",
            "Degree of the polynomials of a continuous routing; 5 by default.",
        ),
        key(
            "places",
            Kind::Count { least: 3, greatest: 500 },
            "37",
            "Places along the backbone at which a rest curvature or a diameter is given; 37 by default.",
        ),
        key(
            "starts",
            Kind::Count { least: 1, greatest: 1000 },
            "6",
            "Starts of least squares; 6 by default.",
        ),
        key(
            "iterations",
            Kind::Count { least: 1, greatest: 100_000 },
            "200",
            "Steps of least squares from each start; 200 by default.",
        ),
        key(
            "solves",
            Kind::Count { least: 1, greatest: 1_000_000_000 },
            "40000",
            "Solves of whole shapes that the search may take, after which the best so far is the answer; 40000 by default.",
        ),
        key("targets", Kind::Tables(&TARGETS), TARGETS.title, TARGETS.doc),
        key("tolerances", Kind::Table(&TOLERANCES), TOLERANCES.title, TOLERANCES.doc),
    ],
    rules: &[],
};

static FIXED: Table = Table {
    title: "[[design.fixed]]",
    doc: "A hole that a cable goes through in any case.",
    keys: &[
        key("cable", Kind::Text, r#""pull""#, "Name of the cable."),
        key(
            "disk",
            Kind::Count { least: 1, greatest: limits::MOST_DISKS },
            "1",
            "Number of the disk, from 1, the base disk.",
        ),
        key(
            "hole",
            Kind::Count { least: 1, greatest: 100_000 },
            "4",
            "Number of the hole, from 1.",
        ),
    ],
    rules: &[Rule::Required("cable"), Rule::Required("disk"), Rule::Required("hole")],
};

static TARGETS: Table = Table {
    title: "[[design.targets]]",
    doc: "A shape that the robot is to take. Several of them are taken by the same robot, each under its own tensions.",
    keys: &[
        key(
            "curve",
            Kind::Text,
            r#""arc, angle = 90 deg, direction = 0 deg""#,
            "A curve that begins at the base, along the backbone: `circle, radius = 100 mm`; `arc, angle = 90 deg`; `helix, radius = 20 mm, pitch = 60 mm`; `s, angle = 45 deg`; `clothoid, start = 0 1/m, end = 10 1/m`; each with the `direction` in which it first bends, an angle from x, 0 by default.",
        ),
        key(
            "shape",
            Kind::Text,
            r#""shape.csv""#,
            "CSV or Parquet file, relative to this one, with points for disks. Its columns are disk, the number from 1, and x, y, z with a unit, as in `x [mm]`.",
        ),
        key(
            "path",
            Kind::Text,
            r#""path.csv""#,
            "CSV or Parquet file, relative to this one, with points for the tip, each of them a target with tensions of its own, so that tensions must vary. Its columns are t and x, y, z with units, as in `x [mm]`.",
        ),
        key(
            "tip",
            POSITION,
            r#"["40 mm", "0 mm", "120 mm"]"#,
            "A point for the tip of the backbone.",
        ),
        key(
            "measured",
            Kind::Flag,
            "true",
            "The shape of [measured]: the positions of its disks in the last step, in the frame of the world.",
        ),
        key(
            "tension",
            Kind::List(&TENSION, 1),
            r#"["4 N", "0 N"]"#,
            "Tension of each cable, in the order of [[cables]]; by default the commands of the file: those of the step with the same number where there are as many steps as targets, else those of the last.",
        ),
        key(
            "weight",
            ratio(WEIGHT),
            "2",
            "How much the squares of its distances count beside those of other targets; 1 by default.",
        ),
    ],
    rules: &[Rule::ExactlyOne(&["curve", "shape", "path", "tip", "measured"])],
};

static TOLERANCES: Table = Table {
    title: "[design.tolerances]",
    doc: "Standard deviations of what is manufactured and commanded, for the report on what they do to the shape; all of normal distributions and independent of one another.",
    keys: &[
        key(
            "hole_radius",
            DISTANCE,
            r#""0.1 mm""#,
            "Of the radius of the hole circle of each disk, and of where a cable without holes runs; by default 1 % of the radius of the disks.",
        ),
        key(
            "hole_angle",
            Kind::Quantity(&[Dimension::Angle], DEVIATION_OF_ANGLE),
            r#""1 deg""#,
            "Of the angle of each hole; 1° by default.",
        ),
        key(
            "disk_position",
            DISTANCE,
            r#""0.2 mm""#,
            "Of the arc length of each disk between the first and the last; by default 1 % of the mean distance of the disks.",
        ),
        key(
            "stiffness",
            ratio(DEVIATION),
            r#""3 %""#,
            "Of the stiffness of the backbone, as a part of it; 3 % by default.",
        ),
        key(
            "tension",
            ratio(DEVIATION),
            r#""2 %""#,
            "Of the tension of each cable, as a part of it; 2 % by default.",
        ),
        key(
            "samples",
            Kind::Count { least: 1, greatest: MOST_SAMPLES },
            "1000",
            "Robots that are drawn; 1000 by default.",
        ),
        key(
            "seed",
            Kind::Count { least: 0, greatest: 1_000_000_000 },
            "1",
            "Of the random numbers: the same seed gives the same robots; 1 by default.",
        ),
    ],
    rules: &[],
};
