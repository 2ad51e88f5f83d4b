//! The keys of `[[motors]]`.

use whipcord::robot::limits;

use super::keys::{ANGLE, DISTANCE, LENGTH, force, key};
use super::{Kind, Rule, Table};
use crate::units::Dimension;

const TRAVEL: Kind = Kind::Quantity(&[Dimension::Length], limits::COORDINATE);

pub(super) static MOTOR: Table = Table {
    title: "[[motors]]",
    doc: "A motor that pulls one or several cables: a spool behind a gear, or without `spool_radius` a linear drive. Its angle or travel is the command of its cables, for models driven by length.",
    keys: &[
        key(
            "name",
            Kind::Text,
            r#""bend""#,
            "Name, unique in the file; by default `motor-1`, `motor-2`, ... In a file that extends one with motors: the motor whose keys are changed, or a new name.",
        ),
        key(
            "group",
            Kind::Text,
            r#""segment 1""#,
            "Group of motors that it belongs to. A fit can give the motors of a group one number together: motors[segment 1].stiffness.",
        ),
        key(
            "cables",
            Kind::List(&Kind::Text, 1),
            r#"["left", "-right"]"#,
            "Names of the cables that it pulls; a minus sign before a name for a cable that is paid out where the others are wound up. A cable belongs to one motor at most.",
        ),
        key(
            "spool_radius",
            Kind::Either(&[LENGTH, Kind::List(&LENGTH, 1)]),
            r#""10 mm""#,
            "Radius of the spool to the middle of the cable: one for all cables, or a list with one for each. Without it the motor is a linear drive.",
        ),
        key(
            "gear_ratio",
            Kind::Number,
            "50",
            "Turns of the motor for one of the spool; 1 by default. Negative where the spool turns the other way.",
        ),
        key(
            "angle",
            ANGLE,
            r#""90 deg""#,
            "Angle of the motor, before the gear. Its cables then have no shortening of their own.",
        ),
        key(
            "travel",
            TRAVEL,
            r#""5 mm""#,
            "Travel of a linear drive. Its cables then have no shortening of their own.",
        ),
        key(
            "stiffness",
            Kind::Quantity(&[Dimension::LineForce], limits::DRIVE_STIFFNESS),
            r#""5 N/mm""#,
            "Stiffness of drive and cable outside the robot, of each cable by itself; rigid by default. The part of a cable inside the robot is longer by (tension - pretension) / stiffness, in series with `axial_stiffness` of the cable.",
        ),
        key(
            "free_length",
            DISTANCE,
            r#""300 mm""#,
            "Length of each cable between motor and base, which stretches by the `axial_stiffness` of the cable; 0 by default.",
        ),
        key(
            "pretension",
            force(limits::TENSION),
            r#""2 N""#,
            "Tension of each cable where the motor is at its offset and the robot has its shape at rest; 0 by default. Needs a `stiffness`, or cables with an `axial_stiffness`.",
        ),
        key(
            "backlash",
            Kind::Quantity(&[Dimension::Angle, Dimension::Length], limits::DISTANCE),
            r#""1 deg""#,
            "Play of the drive behind the gear: an angle of the spool, or a length of a linear drive. The drive follows that much late when the motor turns back. 0 by default.",
        ),
        key(
            "angle_offset",
            ANGLE,
            r#""3 deg""#,
            "Angle of the motor at which it shortens no cable; 0 by default.",
        ),
        key(
            "travel_offset",
            TRAVEL,
            r#""1 mm""#,
            "Travel of a linear drive at which it shortens no cable; 0 by default.",
        ),
        key(
            "angle_limits",
            Kind::Vector(&ANGLE, 2),
            r#"["-180 deg", "180 deg"]"#,
            "Least and greatest angle of the motor.",
        ),
        key(
            "travel_limits",
            Kind::Vector(&TRAVEL, 2),
            r#"["-10 mm", "40 mm"]"#,
            "Least and greatest travel of a linear drive.",
        ),
        key(
            "rate_limit",
            Kind::Quantity(&[Dimension::AngularRate, Dimension::Speed], limits::ANGULAR_RATE),
            r#""90 deg/s""#,
            "Greatest rate of the angle or the travel.",
        ),
        key(
            "torque_limit",
            Kind::Quantity(&[Dimension::Moment], limits::TORQUE),
            r#""0.5 N*m""#,
            "Greatest torque of the motor; an answer that needs more is told of.",
        ),
        key(
            "force_limit",
            force(limits::TENSION),
            r#""40 N""#,
            "Greatest force of a linear drive; an answer that needs more is told of.",
        ),
        key(
            "inertia",
            Kind::Quantity(&[Dimension::Inertia, Dimension::Mass], limits::MOTOR_INERTIA),
            r#""20 g*cm^2""#,
            "Moment of inertia of the motor about its shaft, before the gear, or the mass of a linear drive. Its command is then the set-point of a position loop in motions, which needs a `proportional_gain`; other verbs have the motor where its command says. Without it that is so in motions too.",
        ),
        key(
            "damping",
            Kind::Quantity(&[Dimension::AngularDamping, Dimension::Damping], limits::GAIN),
            r#""0.01 mN*m*s/rad""#,
            "Viscous friction of a motor with inertia, before the gear; 0 by default.",
        ),
        key(
            "proportional_gain",
            Kind::Quantity(
                &[Dimension::AngularStiffness, Dimension::LineForce],
                limits::PROPORTIONAL_GAIN,
            ),
            r#""0.5 N*m/rad""#,
            "Position loop of a motor with inertia: torque of the motor, or force of a linear drive, by the error of its position. The torque stays within `torque_limit` or `force_limit`.",
        ),
        key(
            "derivative_gain",
            Kind::Quantity(&[Dimension::AngularDamping, Dimension::Damping], limits::GAIN),
            r#""2 mN*m*s/rad""#,
            "Torque or force by the rate of that error; 0 by default.",
        ),
        key(
            "integral_gain",
            Kind::Number,
            "3",
            "Torque or force by the integral of that error over time, in N*m/(rad*s) or N/(m*s); 0 by default. The integral stands still while the torque is at its limit.",
        ),
        key(
            "remove",
            Kind::Flag,
            "true",
            "In a file that extends another one: removes the motor of this name.",
        ),
    ],
    rules: &[
        Rule::MergedByName("motor"),
        Rule::Required("cables"),
        Rule::AtMostOne(&["angle", "travel"]),
        Rule::AtMostOne(&["angle_offset", "travel_offset"]),
        Rule::AtMostOne(&["angle_limits", "travel_limits"]),
        Rule::AtMostOne(&["torque_limit", "force_limit"]),
        Rule::Needs("inertia", &["proportional_gain"]),
        Rule::Needs("proportional_gain", &["inertia"]),
        Rule::Needs("derivative_gain", &["inertia"]),
        Rule::Needs("integral_gain", &["inertia"]),
        Rule::Needs("damping", &["inertia"]),
        Rule::Needs("angle", &["spool_radius"]),
        Rule::Needs("gear_ratio", &["spool_radius"]),
        Rule::Needs("angle_offset", &["spool_radius"]),
        Rule::Needs("angle_limits", &["spool_radius"]),
        Rule::Needs("torque_limit", &["spool_radius"]),
        Rule::AtMostOne(&["spool_radius", "travel"]),
        Rule::AtMostOne(&["spool_radius", "travel_offset"]),
        Rule::AtMostOne(&["spool_radius", "travel_limits"]),
        Rule::AtMostOne(&["spool_radius", "force_limit"]),
    ],
};
