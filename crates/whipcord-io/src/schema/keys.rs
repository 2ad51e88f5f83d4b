//! The tables and keys of a robot file.

use whipcord::robot::limits::{self, Range};

use super::backbone_keys::BACKBONE;
use super::design_keys::DESIGN;
use super::goal_keys::{LIMITS, PREFER, RATE_LIMIT, SHORTENING_LIMITS, TARGET, TENSION_LIMITS};
use super::load_keys::{BASE, DIRECTION, LOADS, ROTATION};
use super::motion_keys::MOTION;
use super::motor_keys::MOTOR;
use super::obstacle_keys::OBSTACLES;
use super::{Key, Kind, Rule, Table};
use crate::read::LENGTH_UNITS;
use crate::units::Dimension;

/// More holes than any disk has.
const MOST_HOLES: usize = 100_000;

pub(super) const LENGTH: Kind = Kind::Quantity(&[Dimension::Length], limits::LENGTH);
pub(super) const DISTANCE: Kind = Kind::Quantity(&[Dimension::Length], limits::DISTANCE);
pub(super) const ANGLE: Kind = Kind::Quantity(&[Dimension::Angle], limits::ANGLE);
const PUBLISHED_TIME: Kind = Kind::Quantity(&[Dimension::Time], DURATION);
pub(super) const TENSION: Kind = force(limits::TENSION);
const SHORTENING: Kind = Kind::Quantity(&[Dimension::Length, Dimension::Ratio], limits::COORDINATE);
const POINT: Kind = Kind::Vector(&Kind::Quantity(&[Dimension::Length], limits::COORDINATE), 2);

/// What a published solve time may be: up to 30 years.
pub(crate) const DURATION: Range = Range { least: 0.0, above: false, greatest: 1e9, unit: "s" };

pub(super) const fn ratio(range: Range) -> Kind {
    Kind::Quantity(&[Dimension::Ratio], range)
}

pub(super) const fn force(range: Range) -> Kind {
    Kind::Quantity(&[Dimension::Force], range)
}

pub(super) const fn key(
    name: &'static str,
    kind: Kind,
    example: &'static str,
    doc: &'static str,
) -> Key {
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
            "Another robot file, relative to this one, whose keys this file overrides. An entry of [[cables]] with the name of a cable of the other file changes the keys of that cable; an entry with a new name adds a cable. Other arrays replace those of the other file.",
        ),
        key("backbone", Kind::Table(&BACKBONE), BACKBONE.title, BACKBONE.doc),
        key("disks", Kind::Table(&DISKS), DISKS.title, DISKS.doc),
        key("cables", Kind::Tables(&CABLE), CABLE.title, CABLE.doc),
        key("motors", Kind::Tables(&MOTOR), MOTOR.title, MOTOR.doc),
        key("base", Kind::Table(&BASE), BASE.title, BASE.doc),
        key("loads", Kind::Table(&LOADS), LOADS.title, LOADS.doc),
        OBSTACLES,
        key("steps", Kind::Tables(&STEP), STEP.title, STEP.doc),
        key("commands", Kind::Table(&COMMANDS), COMMANDS.title, COMMANDS.doc),
        key("measured", Kind::Table(&MEASURED), MEASURED.title, MEASURED.doc),
        key("reference", Kind::Table(&REFERENCE), REFERENCE.title, REFERENCE.doc),
        key("fit", Kind::Table(&FIT), FIT.title, FIT.doc),
        key("target", Kind::Table(&TARGET), TARGET.title, TARGET.doc),
        key("limits", Kind::Table(&LIMITS), LIMITS.title, LIMITS.doc),
        key("prefer", Kind::Table(&PREFER), PREFER.title, PREFER.doc),
        key("design", Kind::Table(&DESIGN), DESIGN.title, DESIGN.doc),
        key("motion", Kind::Table(&MOTION), MOTION.title, MOTION.doc),
    ],
    rules: &[Rule::Required("backbone")],
};

static DISKS: Table = Table {
    title: "[disks]",
    doc: "The perforated disks, base disk first. The first sits at the base, the last at the tip. Without this table the robot is a body with cables in channels.",
    keys: &[
        key(
            "count",
            Kind::Count { least: 2, greatest: limits::MOST_DISKS },
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
        key(
            "outer_radius",
            LENGTH,
            r#""10 mm""#,
            "Outer radius of the disks, with which they touch obstacles; by default that of each disk's hole circle.",
        ),
        key(
            "thickness",
            LENGTH,
            r#""2 mm""#,
            "Thickness of the disks, whose rims are rounded with half of it where they touch obstacles; by default a tenth of the outer radius.",
        ),
        key(
            "remove",
            Kind::Flag,
            "true",
            "In a file that extends another one: removes its disks. The robot is then a body with cables in channels.",
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
            "Name, unique in the file; by default `cable-1`, `cable-2`, ... In a file that extends one with cables: the cable whose keys are changed, or a new name.",
        ),
        key(
            "group",
            Kind::Text,
            r#""segment 1""#,
            "Group of cables that it belongs to. A fit can give the cables of a group one number together: cables[segment 1].axial_stiffness.",
        ),
        key(
            "holes",
            Kind::List(&Kind::Count { least: 1, greatest: MOST_HOLES }, 2),
            "[1, 2, 3, 4]",
            "The hole it passes at each disk, from the base disk on, counted from 1. A list shorter than the disks ends the cable at its last hole. Without [disks] a cable needs a `routing` instead.",
        ),
        key(
            "interpolation",
            Kind::Choice(&["spline", "pchip", "fourier"]),
            r#""pchip""#,
            "How the continuous models lead it from hole to hole: a twice continuously differentiable cubic spline of hole angle and radius (default), monotone cubics, or a Fourier series of order 8 in x and y.",
        ),
        key(
            "hole_angle_offset",
            ANGLE,
            r#""1.5 deg""#,
            "Angle by which it runs beside the centres of its holes at every disk, counter-clockwise seen from the tip; 0 by default. A fit finds it as cables[0].routing.angle.",
        ),
        key(
            "hole_radius_offset",
            Kind::Quantity(&[Dimension::Length], limits::COORDINATE),
            r#""0.2 mm""#,
            "By how much it runs farther from the axis than the centres of its holes at every disk, negative if nearer: a thin cable lies at the side of a wide hole; 0 by default. A fit finds it as cables[0].routing.radius.",
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
            "Axial stiffness, Young's modulus times area; inextensible by default. With `shortening` the part inside the robot is then longer than commanded by tension * initial length / axial_stiffness.",
        ),
        key("tension", TENSION, r#""400 gf""#, "Tension, for models driven by force."),
        key(
            "shortening",
            SHORTENING,
            r#""5.7 %""#,
            "By how much its part inside the robot is shortened, for models driven by length: a length, or `%` of its own initial length. Negative is paid out. With `axial_stiffness` the part is longer than that by its stretch.",
        ),
        TENSION_LIMITS,
        SHORTENING_LIMITS,
        RATE_LIMIT,
        key(
            "remove",
            Kind::Flag,
            "true",
            "In a file that extends another one: removes the cable of this name. `cables = []` removes all cables.",
        ),
    ],
    rules: &[
        Rule::MergedByName("cable"),
        Rule::ExactlyOne(&["holes", "routing"]),
        Rule::AtMostOne(&["interpolation", "routing"]),
        Rule::AtMostOne(&["hole_angle_offset", "routing"]),
        Rule::AtMostOne(&["hole_radius_offset", "routing"]),
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

const MOTOR_COMMAND: Kind = Kind::Quantity(&[Dimension::Angle, Dimension::Length], limits::ANGLE);

static STEP: Table = Table {
    title: "[[steps]]",
    doc: "One step of actuation. The steps are taken in the order of the file, each from where the one before left the robot, and the last is the case; the cables and motors then have no command of their own. Only friction remembers the steps before the last.",
    keys: &[
        key(
            "tension",
            Kind::List(&TENSION, 1),
            r#"["2 N", "0 N"]"#,
            "Tension of each cable, in the order of [[cables]].",
        ),
        key(
            "shortening",
            Kind::List(&SHORTENING, 1),
            r#"["5 mm", "-5 mm"]"#,
            "Shortening of each cable, in the order of [[cables]], from its length before all steps.",
        ),
        key(
            "motors",
            Kind::List(&MOTOR_COMMAND, 1),
            r#"["90 deg", "-5 mm"]"#,
            "Angle or travel of each motor, in the order of [[motors]].",
        ),
    ],
    rules: &[
        Rule::AtLeastOne(&["tension", "shortening", "motors"]),
        Rule::AtMostOne(&["shortening", "motors"]),
    ],
};

static COMMANDS: Table = Table {
    title: "[commands]",
    doc: "A table of commands whose rows are the steps of actuation, instead of [[steps]]; and how steps follow one another.",
    keys: &[
        key(
            "table",
            Kind::Text,
            r#""rows.csv""#,
            "CSV or Parquet file, relative to this one. Its columns, which the first line of a CSV file names, are motors and cables by their name or number, with a unit: `bend [deg]`, `pull [N]`, `cable1.shortening (mm)`. Further columns: time, group (the rows that belong together), measured (false for rows without a measurement, which only lead to those after them), and that of `key`. A cable or motor without a column keeps its own command in all rows.",
        ),
        key(
            "each",
            Kind::Choice(&["independent", "in order"]),
            r#""in order""#,
            "Whether each step starts from the robot at rest (independent, the default), or from where the step before left it (in order; the default for [[steps]]). With friction, backlash or a yield moment the two differ, and the file must say which.",
        ),
        key(
            "key",
            Kind::Text,
            r#""run""#,
            "Column that names each row: by it [measured] finds the row of a measurement. Without it the measurements are in the order of the rows.",
        ),
        key(
            "group",
            Kind::Text,
            r#""motion""#,
            "Column of the groups of rows; by default `group`.",
        ),
        key(
            "units",
            Kind::List(&Kind::Text, 1),
            r#"["deg", "mm"]"#,
            "Units of the columns that name none; without them such columns are in SI units.",
        ),
        key(
            "ignore",
            Kind::List(&Kind::Text, 1),
            r#"["note", "temperature"]"#,
            "Columns that are not read.",
        ),
    ],
    rules: &[
        Rule::AtLeastOne(&["table", "each"]),
        Rule::Needs("key", &["table"]),
        Rule::Needs("group", &["table"]),
        Rule::Needs("units", &["table"]),
        Rule::Needs("ignore", &["table"]),
    ],
};

static MEASURED: Table = Table {
    title: "[measured]",
    doc: "What the real robot did.",
    keys: &[
        key(
            "disks",
            Kind::Text,
            r#""case3_disks.csv""#,
            "CSV or Parquet file, relative to this one. Its columns, which the first line of a CSV file names, are disk (number from 1) or arc_length, and x, y, z, the position that was measured, or camera, u, v, the name of a camera and the column and row of its image in pixels; where they are needed also step (number from 1 in the order of [[steps]]; by default the last), offset_x, offset_y, offset_z (where the marker is in the frame of its disk or cross-section), and deviation (standard deviation of its position). What was not seen is left out or empty.",
        ),
        key(
            "table",
            Kind::Text,
            r#""tracker.csv""#,
            "The same file under another name: `disks` or `table`. Beside [commands] its lines belong to the rows of commands: by a column `step`, by the column that `key` of [commands] names, or line by line in the order of the rows that are measured; it may be the file of the commands itself. Without columns disk and arc_length the lines are of the tip, or of [[measured.markers]]. Further columns are qw, qx, qy, qz, the orientation of the tracked body.",
        ),
        key(
            "key",
            Kind::Text,
            r#""sample""#,
            "Column of the keys of rows, where it is named otherwise than `key` of [commands] says.",
        ),
        key(
            "ignore",
            Kind::List(&Kind::Text, 1),
            r#"["frame", "quality"]"#,
            "Columns that are not read.",
        ),
        key(
            "offset",
            MARKER_OFFSET,
            r#"["0 mm", "12 mm", "5 mm"]"#,
            "Where the marker, or the origin of the tracked body, is in the frame of its disk or cross-section, where the file does not give it; on the axis by default.",
        ),
        key(
            "orientation",
            Kind::Vector(&ratio(DIRECTION), 4),
            "[0.7071, 0, 0.7071, 0]",
            "Rotation from the frame of the tracked body to that of its disk or cross-section as a quaternion (w, x, y, z), of any norm. By default it is estimated from all rows before orientations are compared.",
        ),
        key(
            "rotation",
            Kind::Table(&ROTATION),
            r#"{ axis = [0, 0, 1], angle = "90 deg" }"#,
            "The same rotation about an axis; instead of `orientation`.",
        ),
        key(
            "orientation_arm",
            LENGTH,
            r#""50 mm""#,
            "Has a fit take orientations into account: a turn of 1 rad counts as much as this distance, so that it is the deviation of a position over that of an orientation in rad. By default orientations are scored but not fitted.",
        ),
        key("markers", Kind::Tables(&MARKER), MARKER.title, MARKER.doc),
        key(
            "unit",
            Kind::Choice(&LENGTH_UNITS),
            r#""mm""#,
            "Unit of the lengths in the file; by default m.",
        ),
        key(
            "registration",
            Kind::Choice(&["none", "rigid", "base"]),
            r#""rigid""#,
            "How positions are moved onto a model before they are compared: not at all, as they were measured in the frame of the world (none, the default); by the rigid motion that brings all of them nearest to it (rigid); or by that of the markers on the base, one alone by a shift (base).",
        ),
        key(
            "deviation",
            LENGTH,
            r#""0.3 mm""#,
            "Standard deviation of each coordinate of a position, where the file does not give it.",
        ),
        key(
            "pixel_deviation",
            Kind::Number,
            "0.3",
            "Standard deviation in pixels of each coordinate of a place in an image, where the file does not give it.",
        ),
        key(
            "cameras",
            Kind::Tables(&MEASURING_CAMERA),
            MEASURING_CAMERA.title,
            MEASURING_CAMERA.doc,
        ),
    ],
    rules: &[Rule::ExactlyOne(&["disks", "table"]), Rule::AtMostOne(&["orientation", "rotation"])],
};

const MARKER_OFFSET: Kind =
    Kind::Vector(&Kind::Quantity(&[Dimension::Length], limits::COORDINATE), 3);

static MARKER: Table = Table {
    title: "[[measured.markers]]",
    doc: "A marker that has columns of its own in the table, so that one line gives several markers.",
    keys: &[
        key(
            "name",
            Kind::Text,
            r#""m1""#,
            "What its columns begin with: `m1.x`, `m1.y`, `m1.z`. Without a name they are `x`, `y`, `z`.",
        ),
        key(
            "disk",
            Kind::Count { least: 1, greatest: limits::MOST_DISKS },
            "5",
            "Number of its disk, from 1, the base disk.",
        ),
        key(
            "arc_length",
            DISTANCE,
            r#""90 mm""#,
            "Arc length at which it sits; the tip by default. Instead of `disk`.",
        ),
        key(
            "offset",
            MARKER_OFFSET,
            r#"["0 mm", "12 mm", "5 mm"]"#,
            "Where it is in the frame of its disk or cross-section; by default that of `offset` under [measured].",
        ),
    ],
    rules: &[Rule::AtMostOne(&["disk", "arc_length"])],
};

static MEASURING_CAMERA: Table = Table {
    title: "[[measured.cameras]]",
    doc: "A camera that saw the robot.",
    keys: &[
        key("name", Kind::Text, r#""side""#, "What the file with what was measured calls it."),
        key(
            "file",
            Kind::Text,
            r#""side.yml""#,
            "Camera file, relative to this one: YAML or JSON of OpenCV with the lens and where the camera was.",
        ),
    ],
    rules: &[Rule::Required("name"), Rule::Required("file")],
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

static FIT: Table = Table {
    title: "[fit]",
    doc: "What `whipcord fit` estimates from what was measured.",
    keys: &[
        key(
            "parameters",
            Kind::List(&Kind::Text, 1),
            r#"["backbone.diameter", "cables.friction"]"#,
            "Paths of what is estimated, once for all files that are fitted together, counting from 0: numbers of this file such as backbone.young_modulus, disks.hole_circle_radius, cables[0].routing.radius, loads.tip_force[2] or base.position[0]; and cables.friction (of all cables alike), cables[0].tension_offset, cables[0].shortening_offset (slack is negative), cables[0].gain (a factor on the command), measured.offset[0] (of the markers from where the measurement says), base.turn[0] (about x, then y, then z of the world), backbone.torsion_factor and bending_factor, of the whole backbone or of a segment (backbone.segments[near].bending_factor). One number for several cables, motors or segments: cables[*].axial_stiffness for all, cables[segment 1].friction for a `group`, motors[left].stiffness by a name; of `routing` a change that all of them share. For a cable through holes `routing.angle` and `routing.radius` are its `hole_angle_offset` and `hole_radius_offset`.",
        ),
        key(
            "each",
            Kind::List(&Kind::Text, 1),
            r#"["base.position[0]"]"#,
            "Paths of what is estimated for each file by itself, such as where the base was.",
        ),
        key("known", Kind::Tables(&KNOWN), KNOWN.title, KNOWN.doc),
    ],
    rules: &[Rule::AtLeastOne(&["parameters", "each"])],
};

static KNOWN: Table = Table {
    title: "[[fit.known]]",
    doc: "What is known of an unknown before it is estimated; numbers in SI.",
    keys: &[
        key("parameter", Kind::Text, r#""backbone.young_modulus""#, "Its path."),
        key(
            "start",
            Kind::Number,
            "1.2e9",
            "Where the search starts; by default what the file says.",
        ),
        key("least", Kind::Number, "1.0e9", "Least value."),
        key("greatest", Kind::Number, "2.0e9", "Greatest value."),
        key("value", Kind::Number, "1.1e9", "What it is known to be, within `deviation`."),
        key("deviation", Kind::Number, "0.1e9", "Standard deviation of `value`."),
    ],
    rules: &[
        Rule::Required("parameter"),
        Rule::Needs("value", &["deviation"]),
        Rule::Needs("deviation", &["value"]),
    ],
};
