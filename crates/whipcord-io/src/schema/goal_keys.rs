//! The tables `[target]`, `[limits]` and `[prefer]`, and the limits of a cable.

use whipcord::robot::limits::{self, Range};

use super::keys::{DISTANCE, LENGTH, TENSION, key, ratio};
use super::load_keys::{DIRECTION, POSITION, ROTATION};
use super::{Key, Kind, Rule, Table};
use crate::units::Dimension;

/// What the tolerance of an angle may be.
pub(crate) const ANGLE_TOLERANCE: Range =
    Range { least: 0.0, above: true, greatest: core::f64::consts::PI, unit: "rad" };

const TENSIONS: Kind = Kind::Vector(&TENSION, 2);
const SHORTENINGS: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Length, Dimension::Ratio], limits::COORDINATE), 2);
/// The rate of a shortening, or of a tension.
const RATE: Kind = Kind::Quantity(&[Dimension::Speed, Dimension::ForceRate], limits::SPEED);

pub(super) static TARGET: Table = Table {
    title: "[target]",
    doc: "What `whipcord reach` is to reach, in the frame of the world.",
    keys: &[
        key(
            "tip",
            POSITION,
            r#"["40 mm", "0 mm", "120 mm"]"#,
            "A point for the tip of the backbone.",
        ),
        key("pose", Kind::Table(&POSE), POSE.title, POSE.doc),
        key(
            "axis",
            Kind::Vector(&ratio(DIRECTION), 3),
            "[0, 0, 1]",
            "Direction of the backbone at the tip, of any length; with `tip` also a point for the tip.",
        ),
        key(
            "shape",
            Kind::Text,
            r#""shape.csv""#,
            "CSV or Parquet file, relative to this one, with points for disks. Its columns are disk, the number from 1, the base disk, and x, y, z with a unit, as in `x [mm]`; in m without one. Disks that are not named may be anywhere.",
        ),
        key(
            "path",
            Kind::Text,
            r#""path.csv""#,
            "CSV or Parquet file, relative to this one, with points for the tip at times. Its columns are t, x, y, z with units, as in `x [mm]`; in s and m without one; for poses also qw, qx, qy, qz.",
        ),
        key(
            "tolerance",
            LENGTH,
            r#""0.1 mm""#,
            "How far a point may be from its target; by default 1e-5 of the length of the backbone.",
        ),
        key(
            "tolerance_angle",
            Kind::Quantity(&[Dimension::Angle], ANGLE_TOLERANCE),
            r#""0.1 deg""#,
            "How far a direction or an orientation may be from its target; by default the angle that moves the tip by `tolerance` at a third of the length of the backbone.",
        ),
    ],
    rules: &[
        Rule::AtLeastOne(&["tip", "pose", "axis", "shape", "path"]),
        Rule::AtMostOne(&["tip", "pose", "shape", "path"]),
        Rule::AtMostOne(&["axis", "pose"]),
        Rule::AtMostOne(&["axis", "shape"]),
        Rule::AtMostOne(&["axis", "path"]),
    ],
};

static POSE: Table = Table {
    title: "[target.pose]",
    doc: "Position and orientation of the tip.",
    keys: &[
        key("position", POSITION, r#"["40 mm", "0 mm", "120 mm"]"#, "Position of the tip."),
        key(
            "orientation",
            Kind::Vector(&ratio(DIRECTION), 4),
            "[0.7071, 0, 0.7071, 0]",
            "Rotation from the frame of the tip to the world as a quaternion (w, x, y, z), of any norm.",
        ),
        key(
            "rotation",
            Kind::Table(&ROTATION),
            r#"{ axis = [0, 1, 0], angle = "90 deg" }"#,
            "The same rotation about an axis; instead of `orientation`.",
        ),
    ],
    rules: &[Rule::Required("position"), Rule::ExactlyOne(&["orientation", "rotation"])],
};

pub(super) static LIMITS: Table = Table {
    title: "[limits]",
    doc: "What no cable may exceed in an answer of `whipcord reach`. A cable may have limits of its own, and the limits of motors hold as well.",
    keys: &[
        key(
            "tension",
            TENSIONS,
            r#"["0.2 N", "20 N"]"#,
            "Least and greatest tension of each cable. The least is the pretension that keeps the cables taut.",
        ),
        key(
            "shortening",
            SHORTENINGS,
            r#"["-10 mm", "25 mm"]"#,
            "Least and greatest shortening of each cable, as lengths or in `%` of the initial length of each.",
        ),
        key(
            "rate",
            RATE,
            r#""5 mm/s""#,
            "Greatest rate of the shortening of each cable, or of its tension where that is commanded: a speed, or N/s.",
        ),
    ],
    rules: &[Rule::AtLeastOne(&["tension", "shortening", "rate"])],
};

pub(super) static PREFER: Table = Table {
    title: "[prefer]",
    doc: "Which of several answers `whipcord reach` gives.",
    keys: &[
        key(
            "least",
            Kind::Choice(&["tension", "change", "clearance"]),
            r#""tension""#,
            "Of several commands that reach the target: those with the least sum of squared tensions (tension, the default), those nearest to the commands of this file (change), or those with the greatest distance from obstacles (clearance).",
        ),
        key(
            "clearance",
            Kind::Either(&[Kind::Choice(&["touch"]), DISTANCE]),
            r#""2 mm""#,
            "Least distance of the robot from obstacles; 0 by default. With \"touch\" it may touch them.",
        ),
    ],
    rules: &[Rule::AtLeastOne(&["least", "clearance"])],
};

pub(super) const TENSION_LIMITS: Key = key(
    "tension_limits",
    TENSIONS,
    r#"["0.2 N", "20 N"]"#,
    "Least and greatest tension of this cable in an answer of `whipcord reach`; by default those of [limits].",
);
pub(super) const SHORTENING_LIMITS: Key = key(
    "shortening_limits",
    SHORTENINGS,
    r#"["-10 mm", "25 mm"]"#,
    "Least and greatest shortening of this cable in such an answer; by default those of [limits].",
);
pub(super) const RATE_LIMIT: Key = key(
    "rate_limit",
    RATE,
    r#""5 mm/s""#,
    "Greatest rate of its command; by default that of [limits].",
);
