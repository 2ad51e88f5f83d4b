//! The tables `[loads]` and `[base]`.

use whipcord::robot::limits::{self, Range};

use super::keys::{ANGLE, DISTANCE, key, ratio};
use super::{Kind, Rule, Table};
use crate::units::Dimension;

/// An acceleration of gravity.
pub(super) const GRAVITY: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Acceleration], limits::ACCELERATION), 3);

pub(super) const FORCE_VECTOR: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Force], limits::FORCE), 3);
pub(super) const MOMENT_VECTOR: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Moment], limits::MOMENT), 3);
const LINE_FORCE: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::LineForce], limits::LINE_FORCE), 3);
const LINE_MOMENT: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::LineMoment], limits::LINE_MOMENT), 3);
pub(super) const POSITION: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Length], limits::COORDINATE), 3);
/// A component of a quaternion or an axis, whatever its norm.
pub(super) const DIRECTION: Range = Range { least: -1e6, above: false, greatest: 1e6, unit: "" };

pub(super) static LOADS: Table = Table {
    title: "[loads]",
    doc: "External loads, fixed in the base frame unless they follow or `frame` says otherwise.",
    keys: &[
        key(
            "frame",
            Kind::Choice(&["base", "world"]),
            r#""world""#,
            "The frame in which gravity and the loads that do not follow are given: that of the robot's base, with which they turn (default), or the world, in which the base may be turned.",
        ),
        key(
            "gravity",
            GRAVITY,
            r#"["0", "0", "-9.81 m/s^2"]"#,
            "Acceleration of gravity as a vector; z points from base to tip of the straight robot. It acts on backbone, disks and masses.",
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
        key("distributed", Kind::Tables(&DISTRIBUTED), DISTRIBUTED.title, DISTRIBUTED.doc),
        key("mass", Kind::Tables(&POINT_MASS), POINT_MASS.title, POINT_MASS.doc),
    ],
    rules: &[],
};

pub(super) static POINT_LOAD: Table = Table {
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

pub(super) static DISTRIBUTED: Table = Table {
    title: "[[loads.distributed]]",
    doc: "A force and a moment spread along the backbone, for each metre of its undeformed length.",
    keys: &[
        key("from", DISTANCE, r#""40 mm""#, "Arc length at which it begins; by default the base."),
        key("to", DISTANCE, r#""140 mm""#, "Arc length at which it ends; by default the tip."),
        key(
            "at",
            Kind::List(&DISTANCE, 2),
            r#"["0 mm", "90 mm", "180 mm"]"#,
            "Arc lengths at which `force` and `moment` are given as lists, in ascending order; linear between them and nothing beyond them. Instead of `from` and `to`.",
        ),
        key(
            "force",
            Kind::Either(&[LINE_FORCE, Kind::List(&LINE_FORCE, 2)]),
            r#"["0 N/m", "0.5 N/m", "0 N/m"]"#,
            "Force per length: one vector, or a list with one for each entry of `at`.",
        ),
        key(
            "moment",
            Kind::Either(&[LINE_MOMENT, Kind::List(&LINE_MOMENT, 2)]),
            r#"["0", "0", "2 mN*m/m"]"#,
            "Moment per length: one vector, or a list with one for each entry of `at`.",
        ),
        key(
            "follower",
            Kind::Flag,
            "true",
            "Whether they turn with the cross-sections; false by default.",
        ),
    ],
    rules: &[
        Rule::AtLeastOne(&["force", "moment"]),
        Rule::AtMostOne(&["at", "from"]),
        Rule::AtMostOne(&["at", "to"]),
    ],
};

static POINT_MASS: Table = Table {
    title: "[[loads.mass]]",
    doc: "A mass that the robot carries on its backbone, such as a camera. Gravity acts on it.",
    keys: &[
        key("at", DISTANCE, r#""180 mm""#, "Arc length of the place."),
        key("mass", Kind::Quantity(&[Dimension::Mass], limits::MASS), r#""12 g""#, "Mass."),
    ],
    rules: &[Rule::Required("at"), Rule::Required("mass")],
};

pub(super) static BASE: Table = Table {
    title: "[base]",
    doc: "Where the robot's base is in the world; without it the frames of base and world are one.",
    keys: &[
        key(
            "position",
            POSITION,
            r#"["0 mm", "0 mm", "500 mm"]"#,
            "Position of the base; the origin by default.",
        ),
        key(
            "orientation",
            Kind::Vector(&ratio(DIRECTION), 4),
            "[0.7071, 0, 0.7071, 0]",
            "Rotation from the base frame to the world as a quaternion (w, x, y, z), of any norm.",
        ),
        key(
            "rotation",
            Kind::Table(&ROTATION),
            r#"{ axis = [0, 1, 0], angle = "90 deg" }"#,
            "The same rotation about an axis; instead of `orientation`.",
        ),
    ],
    rules: &[Rule::AtMostOne(&["orientation", "rotation"])],
};

pub(super) static ROTATION: Table = Table {
    title: "`rotation`",
    doc: "A rotation about an axis.",
    keys: &[
        key(
            "axis",
            Kind::Vector(&ratio(DIRECTION), 3),
            "[0, 1, 0]",
            "Direction of the axis, of any length.",
        ),
        key("angle", ANGLE, r#""90 deg""#, "Angle, right-handed about the axis."),
    ],
    rules: &[Rule::Required("axis"), Rule::Required("angle")],
};
