//! The tables `[motion]` and `[backbone.damping]`.

use whipcord::ModelKind;
use whipcord::robot::limits::{self, Range};
use whipcord_motion::{Method, MotionOptions};

use super::backbone_keys::SYMMETRIC_MATRIX;
use super::keys::{DURATION, LENGTH, force, key};
use super::load_keys::{DISTRIBUTED, FORCE_VECTOR, GRAVITY, MOMENT_VECTOR, POINT_LOAD};
use super::{Kind, Rule, Table};
use crate::units::Dimension;

/// What a length of time may be: from a nanosecond to 30 years.
pub(crate) const LENGTH_OF_TIME: Range =
    Range { least: 1e-9, above: false, greatest: 1e9, unit: "s" };
/// A velocity of the base, or a rate of its turning.
pub(crate) const EITHER_WAY: Range = Range { least: -1e6, above: false, greatest: 1e6, unit: "" };
/// Drag of the surroundings.
pub(crate) const LINE_DRAG: Range =
    Range { least: 0.0, above: false, greatest: 1e9, unit: "N·s/m²" };
/// A number of a row over time, whichever of the two it is.
const OF_COURSE: Range = Range { least: -1e12, above: false, greatest: 1e12, unit: "" };

const TIME: Kind = Kind::Quantity(&[Dimension::Time], LENGTH_OF_TIME);

const TENSION_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::Force], OF_COURSE), 2);
const SHORTENING_ROW: Kind = Kind::Vector(
    &Kind::Quantity(&[Dimension::Time, Dimension::Length, Dimension::Ratio], OF_COURSE),
    2,
);
const ANGLE_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::Angle], OF_COURSE), 2);
const TRAVEL_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::Length], OF_COURSE), 2);
const FACTOR_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::Ratio], OF_COURSE), 2);

const SPEED: Kind = Kind::Quantity(&[Dimension::Speed], EITHER_WAY);
const SPEED_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::Speed], OF_COURSE), 2);
const RATE: Kind = Kind::Quantity(&[Dimension::AngularRate], EITHER_WAY);
const RATE_ROW: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Time, Dimension::AngularRate], OF_COURSE), 2);
const DRAG: Kind = Kind::Quantity(&[Dimension::LineDrag], LINE_DRAG);
const LISTS: Kind = Kind::List(&Kind::List(&Kind::Number, 1), 1);
const SIX_NUMBERS: Kind = Kind::List(&Kind::Vector(&Kind::Number, 6), 1);

const SHORTENING: Kind = Kind::Quantity(&[Dimension::Length, Dimension::Ratio], limits::COORDINATE);
const ANGLE: Kind = Kind::Quantity(&[Dimension::Angle], limits::ANGLE);
const TRAVEL: Kind = Kind::Quantity(&[Dimension::Length], limits::COORDINATE);

pub(super) static MOTION: Table = Table {
    title: "[motion]",
    doc: "How `whipcord simulate` computes the motion of the robot.",
    keys: &[
        key("duration", TIME, r#""2 s""#, "Time that is simulated."),
        key(
            "step",
            TIME,
            r#""10 ms""#,
            "Length of a step; 10 ms by default. Steps are divided where commands jump and where the equations cannot be solved otherwise.",
        ),
        key(
            "method",
            Kind::Choice(&[Method::Accurate.name(), Method::Energy.name(), Method::Robust.name()]),
            r#""accurate""#,
            "How the equations are integrated: accurate (Runge-Kutta of order 4, the default), energy (midpoint rule that conserves the energy but for what is damped), or robust (generalised-alpha, damps vibrations too fast for the step). Cables that are driven by their lengths are always integrated by robust.",
        ),
        key(
            "model",
            Kind::Choice(&[ModelKind::Cosserat.name(), ModelKind::CosseratDisks.name()]),
            r#""cosserat-disks""#,
            "How cables run: cosserat, along their routing (default), or cosserat-disks, straight from disk to disk.",
        ),
        key(
            "tolerance",
            LENGTH,
            r#""0.1 mm""#,
            "Error that a step may have, as estimated; steps are divided until they meet it. By default each step is taken as it is.",
        ),
        key(
            "initial",
            Kind::Either(&[Kind::Text, Kind::Table(&INITIAL)]),
            r#""equilibrium""#,
            "Where the motion starts: `equilibrium`, at rest in equilibrium with the commands and loads before the start (default); `rest`, at rest in the shape without them; or the path of a motion that was written as JSON, relative to this file, to go on from its last state. A state may also be given as a table.",
        ),
        key(
            "elements",
            Kind::Count { least: 1, greatest: MotionOptions::MOST_ELEMENTS },
            "6",
            "Least number of elements along the backbone; 6 by default. There are more where disks, cable ends, loads or changes of the cross-section need them.",
        ),
        key("drag", Kind::Table(&MOTION_DRAG), MOTION_DRAG.title, MOTION_DRAG.doc),
        key("base", Kind::Table(&MOTION_BASE), MOTION_BASE.title, MOTION_BASE.doc),
        key("commands", Kind::Tables(&MOTION_COMMAND), MOTION_COMMAND.title, MOTION_COMMAND.doc),
        key("loads", Kind::Tables(&MOTION_LOADS), MOTION_LOADS.title, MOTION_LOADS.doc),
        key("output", Kind::Table(&OUTPUT), OUTPUT.title, OUTPUT.doc),
    ],
    rules: &[Rule::Required("duration")],
};

static INITIAL: Table = Table {
    title: "[motion.initial]",
    doc: "The state that a motion starts from.",
    keys: &[
        key(
            "strains",
            SIX_NUMBERS,
            "[[0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0]]",
            "Strains at the two points of each element from base to tip: of translation, then curvatures in 1/m.",
        ),
        key(
            "velocities",
            SIX_NUMBERS,
            "[[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]",
            "Velocities of the nodes from base to tip, in their own frames: m/s, then rad/s.",
        ),
        key(
            "tensions",
            Kind::List(&Kind::Number, 1),
            "[1.5]",
            "Tension of each cable in N; zero by default. It counts for cables that are driven by their lengths.",
        ),
        key(
            "motor_outputs",
            Kind::List(&Kind::Number, 1),
            "[0.2]",
            "Motion of the spool or drive of each motor, behind gear and backlash, in rad or m; zero by default.",
        ),
        key(
            "motors",
            Kind::List(&Kind::Vector(&Kind::Number, 3), 1),
            "[[10.5, 0, 0.01]]",
            "Of each motor its angle or travel, its rate and the integral of the error of its position loop, which motors with inertia start from; by default they are at rest at `motor_outputs`.",
        ),
        key(
            "passage_tensions",
            LISTS,
            "[[1.5, 1.42], [0.8, 0.8]]",
            "Of each cable the tensions in N of its passages from the base on; of a robot whose cables have friction.",
        ),
        key(
            "lengths_beyond",
            LISTS,
            "[[0.18, 0.09], [0.17, 0.085]]",
            "Of each cable the unstretched length in m beyond the near hole of each of its passages, which says where it sticks; of a robot whose cables have friction.",
        ),
        key("rates", Kind::Table(&RATES), RATES.title, RATES.doc),
    ],
    rules: &[Rule::Required("strains"), Rule::Required("velocities")],
};

static RATES: Table = Table {
    title: "[motion.initial.rates]",
    doc: "The rates that the first step goes on from, where commands and loads go on as they were; without them it begins as behind a jump.",
    keys: &[
        key(
            "velocities",
            SIX_NUMBERS,
            "[[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]",
            "Of the velocities of the nodes.",
        ),
        key("strains", SIX_NUMBERS, "[[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]", "Of the strains."),
        key(
            "motors",
            Kind::List(&Kind::Vector(&Kind::Number, 3), 1),
            "[[0, 0, 0]]",
            "Of the three numbers of each motor.",
        ),
        key("step", Kind::Number, "0.01", "Length in s of the step that they are of."),
        key(
            "commands",
            Kind::List(&Kind::Number, 1),
            "[1.5]",
            "What each cable was told at the end of that step: a tension in N or a shortening in m.",
        ),
        key(
            "loads",
            Kind::Vector(&Kind::Number, 15),
            "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -9.81]",
            "Sums of the forces in N and moments in N·m on the nodes in that step, of those that turn with the robot, and gravity in m/s², in the frame of the base.",
        ),
    ],
    rules: &[
        Rule::Required("velocities"),
        Rule::Required("strains"),
        Rule::Required("step"),
        Rule::Required("loads"),
    ],
};

static MOTION_DRAG: Table = Table {
    title: "[motion.drag]",
    doc: "Viscous drag of the surroundings on the backbone: force for each metre of it, by its velocity.",
    keys: &[
        key(
            "across",
            DRAG,
            r#""0.5 N*s/m^2""#,
            "Against motion across the backbone; zero by default.",
        ),
        key(
            "along",
            DRAG,
            r#""0.2 N*s/m^2""#,
            "Against motion along the backbone; zero by default.",
        ),
    ],
    rules: &[Rule::AtLeastOne(&["across", "along"])],
};

static MOTION_BASE: Table = Table {
    title: "[motion.base]",
    doc: "How the base moves, from where [base] puts it: velocities over time, a table of its poses, or freely. Methods accurate and robust take it.",
    keys: &[
        key(
            "free",
            Kind::Flag,
            "true",
            "Whether nothing holds the base from the start on; false by default. The drives of the cables ride on it. The equilibrium to start from is that in which it is held.",
        ),
        key(
            "velocity",
            Kind::Vector(&Kind::Either(&[SPEED, Kind::List(&SPEED_ROW, 1)]), 3),
            r#"[0, 0, [["0 s", "0 m/s"], ["0.1 s", "0.5 m/s"]]]"#,
            "Velocity along the axes of the base, which turn with it: each a value, or rows of time and value.",
        ),
        key(
            "angular_velocity",
            Kind::Vector(&Kind::Either(&[RATE, Kind::List(&RATE_ROW, 1)]), 3),
            r#"[0, 0, "90 deg/s"]"#,
            "Angular velocity about the axes of the base, likewise.",
        ),
        key(
            "csv",
            Kind::Text,
            r#""base.csv""#,
            "CSV or Parquet file, relative to this one, with the poses of the base over time in a frame at rest. Its columns are t, x, y, z with their units, and qw, qx, qy, qz where the base turns. What counts is the motion from the first row on; between two rows the velocity is constant, and it is zero before the first and beyond the last.",
        ),
    ],
    rules: &[
        Rule::AtLeastOne(&["velocity", "angular_velocity", "csv", "free"]),
        Rule::AtMostOne(&["free", "velocity"]),
        Rule::AtMostOne(&["free", "angular_velocity"]),
        Rule::AtMostOne(&["free", "csv"]),
        Rule::AtMostOne(&["velocity", "csv"]),
        Rule::AtMostOne(&["angular_velocity", "csv"]),
    ],
};

static MOTION_COMMAND: Table = Table {
    title: "[[motion.commands]]",
    doc: "What a cable or a motor is told over time, instead of its constant command. A value, or rows of time and value: linear between them, constant before the first and beyond the last; a time given twice is a jump.",
    keys: &[
        key("cable", Kind::Text, r#""pull""#, "Name of the cable."),
        key("motor", Kind::Text, r#""bend""#, "Name of the motor."),
        key(
            "tension",
            Kind::Either(&[force(limits::TENSION), Kind::List(&TENSION_ROW, 1)]),
            r#"[["0 s", "4 N"], ["0 s", "0 N"]]"#,
            "Tension of the cable.",
        ),
        key(
            "shortening",
            Kind::Either(&[SHORTENING, Kind::List(&SHORTENING_ROW, 1)]),
            r#"[["0 s", "0 mm"], ["0.5 s", "10 mm"]]"#,
            "By how much the cable is shortened from its initial length, as a length or in `%` of that length.",
        ),
        key(
            "angle",
            Kind::Either(&[ANGLE, Kind::List(&ANGLE_ROW, 1)]),
            r#"[["0 s", "0 deg"], ["0.5 s", "90 deg"]]"#,
            "Angle of a motor with a spool.",
        ),
        key(
            "travel",
            Kind::Either(&[TRAVEL, Kind::List(&TRAVEL_ROW, 1)]),
            r#"[["0 s", "0 mm"], ["0.5 s", "5 mm"]]"#,
            "Travel of a linear motor.",
        ),
        key(
            "csv",
            Kind::Text,
            r#""commands.csv""#,
            "CSV or Parquet file, relative to this one, with the commands of several cables or motors. Its columns are t, and the names of cables and motors with a unit that tells what is commanded, as in `pull [N]` or `pull [mm]`; the time in s without one.",
        ),
    ],
    rules: &[
        Rule::ExactlyOne(&["cable", "motor", "csv"]),
        Rule::AtMostOne(&["tension", "shortening", "angle", "travel", "csv"]),
        Rule::Needs("cable", &["tension", "shortening"]),
        Rule::Needs("tension", &["cable"]),
        Rule::Needs("shortening", &["cable"]),
        Rule::Needs("angle", &["motor"]),
        Rule::Needs("travel", &["motor"]),
        Rule::Needs("motor", &["angle", "travel"]),
    ],
};

static MOTION_LOADS: Table = Table {
    title: "[[motion.loads]]",
    doc: "Loads over time, beside those of [loads] and in the same frame.",
    keys: &[
        key(
            "factor",
            Kind::List(&FACTOR_ROW, 1),
            r#"[["0 s", 1], ["0 s", 0]]"#,
            "What all loads of this table are multiplied by, as rows of time and factor: linear between them, constant before the first and beyond the last; a time given twice is a jump.",
        ),
        key(
            "gravity",
            GRAVITY,
            r#"["0", "0", "-9.81 m/s^2"]"#,
            "Acceleration of gravity as a vector, beside that of [loads]: of a base that is shaken, or in a parabolic flight.",
        ),
        key("tip_force", FORCE_VECTOR, r#"["0.05 N", "0 N", "0 N"]"#, "Force at the tip."),
        key("tip_moment", MOMENT_VECTOR, r#"["0", "0", "1 mN*m"]"#, "Moment at the tip."),
        key(
            "follower",
            Kind::Flag,
            "true",
            "Whether tip force and tip moment turn with the tip; false by default.",
        ),
        key("point", Kind::Tables(&POINT_LOAD), "[[motion.loads.point]]", POINT_LOAD.doc),
        key(
            "distributed",
            Kind::Tables(&DISTRIBUTED),
            "[[motion.loads.distributed]]",
            DISTRIBUTED.doc,
        ),
    ],
    rules: &[
        Rule::Required("factor"),
        Rule::AtLeastOne(&["gravity", "tip_force", "tip_moment", "point", "distributed"]),
    ],
};

static OUTPUT: Table = Table {
    title: "[motion.output]",
    doc: "What is written of a motion.",
    keys: &[key(
        "every",
        TIME,
        r#""10 ms""#,
        "Time between the states that are written; by default `step`. Steps are shortened so that they end at these times.",
    )],
    rules: &[Rule::Required("every")],
};

pub(super) static DAMPING: Table = Table {
    title: "[backbone.damping]",
    doc: "Damping of the material (Kelvin-Voigt): forces and moments in a section by the rates of its strains. Only motion needs it.",
    keys: &[
        key(
            "time",
            Kind::Quantity(&[Dimension::Time], DURATION),
            r#""3.5 ms""#,
            "The damping is this time multiplied by the stiffness.",
        ),
        key(
            "matrix",
            SYMMETRIC_MATRIX,
            "[[5, 0, 0, 0, 0, 0], [0, 5, 0, 0, 0, 0], [0, 0, 20, 0, 0, 0], [0, 0, 0, 1e-5, 0, 0], [0, 0, 0, 0, 1e-5, 0], [0, 0, 0, 0, 0, 8e-6]]",
            "The symmetric damping in N*s and N*m^2*s, by rows: shear along x and y, extension, bending about x and y, twist. Instead of `time`.",
        ),
    ],
    rules: &[Rule::ExactlyOne(&["time", "matrix"])],
};
