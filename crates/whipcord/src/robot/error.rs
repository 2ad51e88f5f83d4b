use thiserror::Error;

use whipcord_numerics::Vec3;

use super::range::{Range, number};
use crate::format::{Round, millimetres};

/// A quantity of a robot or a case that cannot be.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}: {problem}", in_words(path))]
pub struct RobotError {
    /// Which quantity, in the terms of the robot file: `backbone.length`, `cables[1].holes[3]`
    /// (indices from 0).
    pub path: String,
    /// What is wrong with it.
    pub problem: Problem,
}

impl RobotError {
    /// The problem of the quantity at this path of the robot file.
    pub fn new(path: impl Into<String>, problem: Problem) -> Self {
        Self { path: path.into(), problem }
    }

    /// The same error of a part that lies at `parent`.
    pub(crate) fn under(mut self, parent: &str) -> Self {
        self.path = format!("{parent}.{}", self.path);
        self
    }
}

/// The quantity at a path such as `cables[1].holes[3]`, named as people would: `` `holes` of cable 2 ``.
/// Which entry of a list it is, a path in words leaves out.
#[must_use]
pub fn in_words(path: &str) -> String {
    for (list, what) in [
        ("cables[", "cable"),
        ("motors[", "motor"),
        ("backbone.segments[", "segment"),
        ("obstacles[", "obstacle"),
        ("loads.point[", "point load"),
        ("steps[", "step"),
        ("loads.distributed[", "distributed load"),
        ("loads.mass[", "mass"),
    ] {
        let numbered = path.strip_prefix(list).and_then(|rest| rest.split_once(']'));
        if let Some((number, rest)) = numbered
            && let Ok(number) = number.parse::<usize>()
        {
            let number = number.saturating_add(1);
            return match rest.strip_prefix('.') {
                Some(rest) => format!("`{}` of {what} {number}", without_entry(rest)),
                None => format!("{what} {number}"),
            };
        }
    }
    // What no file says, such as an option of a model, is in words already.
    if path.contains(' ') { path.to_owned() } else { format!("`{}`", without_entry(path)) }
}

/// A path without the numbers of the list's entry at its end.
fn without_entry(path: &str) -> &str {
    match path.rfind('[') {
        Some(at) if path.ends_with(']') => without_entry(&path[..at]),
        _ => path,
    }
}

/// What is wrong with a quantity.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Problem {
    /// Not a number, or infinite.
    #[error("must be a finite number, but is {value}")]
    NotFinite {
        /// Value given.
        value: f64,
    },
    /// Zero or negative where only a positive number makes sense.
    #[error("must be greater than zero, but is {}", number(*value))]
    NotPositive {
        /// Value given.
        value: f64,
    },
    /// Negative where zero is the least that makes sense.
    #[error("must not be negative, but is {}", number(*value))]
    Negative {
        /// Value given.
        value: f64,
    },
    /// Outside the range that is possible.
    #[error("must be {}, but is {}", range.end_passed(*value), range.with_unit(*value))]
    OutOfRange {
        /// Value given.
        value: f64,
        /// Values that are possible.
        range: Range,
    },
    /// A cable that would run beyond the axis of the backbone.
    #[error(
        "must not take the cable beyond the axis, which is {} m from its nearest hole, but is {}",
        number(*least), number(*value)
    )]
    BeyondAxis {
        /// Value given in m.
        value: f64,
        /// Distance of its nearest hole from the axis in m.
        least: f64,
    },
    /// A list of the wrong length.
    #[error("must have {expected} entries, one for each disk, but has {given}")]
    Count {
        /// Entries given.
        given: usize,
        /// Entries needed.
        expected: usize,
    },
    /// A list that does not go with its arc lengths.
    #[error(
        "must have {expected} {}, one for each place of `at`, but has {given}",
        if *expected == 1 { "entry" } else { "entries" }
    )]
    CountOfPlaces {
        /// Entries given.
        given: usize,
        /// Places given.
        expected: usize,
    },
    /// The same thing said by two quantities.
    #[error("says what {} says as well", in_words(other))]
    GivenTwice {
        /// Path of the other quantity.
        other: &'static str,
    },
    /// A stiffness that is missing where the backbone can deform.
    #[error("must be given as long as `{hold}` is true")]
    StiffnessMissing {
        /// The switch by which the strain can be held.
        hold: &'static str,
    },
    /// A stiffness matrix that is not symmetric. Rows and columns count from 0.
    #[error(
        "must be symmetric: row {}, column {} has {}, but row {}, column {} has {}",
        row + 1, column + 1, number(*value), column + 1, row + 1, number(*mirror)
    )]
    NotSymmetric {
        /// Row below the diagonal.
        row: usize,
        /// Its column.
        column: usize,
        /// Value there.
        value: f64,
        /// Value on the other side of the diagonal.
        mirror: f64,
    },
    /// A stiffness matrix by which some strain would store no energy.
    #[error(
        "must be positive definite: once the strains before it may relax, {axis} has the stiffness {}",
        number(*pivot)
    )]
    NotPositiveDefinite {
        /// The first strain that is not stiff, in the order shear x, shear y, axial, bending x,
        /// bending y, twist.
        axis: &'static str,
        /// The pivot of its row in Cholesky's factorisation, not positive to working precision.
        pivot: f64,
    },
    /// A list that is too short.
    #[error("must have at least {least} entries, but has {given}")]
    TooFew {
        /// Entries given.
        given: usize,
        /// Fewest entries that make sense.
        least: usize,
    },
    /// A list that is too long.
    #[error("must have at most {most} entries, but has {given}")]
    TooMany {
        /// Entries given.
        given: usize,
        /// Most entries that are taken.
        most: usize,
    },
    /// A number of things that is too great.
    #[error("must be at most {most}, but is {given}")]
    TooGreat {
        /// Number given.
        given: usize,
        /// Greatest number that is taken.
        most: usize,
    },
    /// A point of a line that coincides with the one before it.
    #[error("lies only {} m from the point before it", number(*chord))]
    TooNear {
        /// Distance to the point before in m.
        chord: f64,
    },
    /// A point at which a smooth line would have no direction.
    #[error("makes the line turn back on itself")]
    TurnsBack,
    /// A pipe that bends more sharply than its bore can follow.
    #[error(
        "make the pipe bend with a radius of {} m, which must be more than that of its bore, {} m",
        number(*sharpest), number(*radius)
    )]
    BendsTooSharply {
        /// Radius of the bore in m.
        radius: f64,
        /// Least radius of curvature of its middle in m.
        sharpest: f64,
    },
    /// A mesh without a triangle.
    #[error("has no triangle")]
    NoTriangles,
    /// A corner of a triangle that there is not.
    #[error("has no vertex {} for its triangle {}: there are {vertices}", vertex + 1, triangle + 1)]
    NoSuchVertex {
        /// The triangle, from 0.
        triangle: usize,
        /// The vertex named, from 0.
        vertex: usize,
        /// Vertices given.
        vertices: usize,
    },
    /// Triangles whose corners lie on a line.
    #[error(
        "has {count} {} without area, first triangle {}",
        triangles(*count), triangle + 1
    )]
    FlatTriangles {
        /// How many.
        count: usize,
        /// The first, from 0.
        triangle: usize,
    },
    /// Edges of one triangle alone.
    #[error(
        "has holes: {count} {} one triangle alone, such as the one near {}",
        edges(*count), place(*near)
    )]
    OpenEdges {
        /// How many.
        count: usize,
        /// The middle of one, in m.
        near: Vec3,
    },
    /// Edges of more than two triangles.
    #[error(
        "has {count} {} more than two triangles, such as the one near {}",
        edges(*count), place(*near)
    )]
    CrowdedEdges {
        /// How many.
        count: usize,
        /// The middle of one, in m.
        near: Vec3,
    },
    /// Edges along which two triangles run the same way.
    #[error(
        "has {count} {} triangles of opposite orientation, such as the one near {}",
        edges(*count), place(*near)
    )]
    OpposedTriangles {
        /// How many.
        count: usize,
        /// The middle of one, in m.
        near: Vec3,
    },
    /// Triangles that are all clockwise as seen from outside.
    #[error(
        "is inside out, with a volume of {} m³",
        number(*volume)
    )]
    InsideOut {
        /// What it encloses in m³, negative, or zero.
        volume: f64,
    },
    /// A mass of an obstacle that has no end.
    #[error(
        "makes the obstacle a movable object, but a {form} has no end and cannot move: leave out the mass, or give the object another shape"
    )]
    CannotMove {
        /// Name of the form.
        form: &'static str,
    },
    /// More holes than disks.
    #[error(
        "names {given} holes, but there are only {disks} disks: give at most one hole for each disk, from the base on"
    )]
    MoreHolesThanDisks {
        /// Holes named.
        given: usize,
        /// Disks of the robot.
        disks: usize,
    },
    /// A hole that no disk has.
    #[error("there is no hole {hole}: the disks have holes 1 to {holes}")]
    NoSuchHole {
        /// Hole named.
        hole: usize,
        /// Holes of each disk.
        holes: usize,
    },
    /// Holes are named, but the disks have none.
    #[error(
        "names holes, but the number of holes of a disk is not given: set disks.holes and disks.hole_circle_radius"
    )]
    DisksWithoutHoles,
    /// Holes are named, but there are no disks.
    #[error("names holes, but the robot has no disks")]
    HolesWithoutDisks,
    /// A list with one value for each disk, but there are no disks.
    #[error("has one value for each disk, but the robot has no disks")]
    ListWithoutDisks,
    /// Positions that do not increase.
    #[error("must increase from the base to the tip, but {} follows {}", number(*value), number(*previous))]
    NotIncreasing {
        /// Value given.
        value: f64,
        /// The value before it.
        previous: f64,
    },
    /// Places that are the same but for rounding.
    #[error("lies only {} m behind the one before it", number(*pitch))]
    TooClose {
        /// Distance to the place before in m.
        pitch: f64,
        /// Least distance in m.
        least: f64,
    },
    /// Disks that reach into one another.
    #[error(
        "must be at most {}, the distance from disk {} to disk {}, but is {}",
        millimetres(*spacing, Round::Down), first + 1, first + 2, millimetres(*thickness, Round::Up)
    )]
    ThickerThanSpacing {
        /// Thickness given in m.
        thickness: f64,
        /// Distance of two disks in m.
        spacing: f64,
        /// The first of the two, from 0.
        first: usize,
    },
    /// A disk that is thicker than wide, so that half of its thickness does not fit its rim.
    #[error(
        "must be at most {}, twice the outer radius of disk {}, but is {}",
        millimetres(2.0 * radius, Round::Down), disk + 1, millimetres(*thickness, Round::Up)
    )]
    ThickerThanWide {
        /// Thickness given in m.
        thickness: f64,
        /// Outer radius of the disk in m.
        radius: f64,
        /// The disk, from 0.
        disk: usize,
    },
    /// A stretch of a distributed load that is all but a point.
    #[error(
        "lies only {} m behind the one before it, and {} m is the least: give a load on so short a stretch as a point load",
        number(*stretch), number(*least)
    )]
    TooShort {
        /// Length of the stretch in m.
        stretch: f64,
        /// Least length in m.
        least: f64,
    },
    /// Values of a distributed load that do not go with its stations.
    #[error("must have {expected} entries, one for each entry of `at`, but has {given}")]
    StationCount {
        /// Entries given.
        given: usize,
        /// Stations given.
        expected: usize,
    },
    /// A direction or a quaternion that is zero.
    #[error("must have a direction, but is zero")]
    NoDirection,
    /// A quaternion that is no rotation.
    #[error("must be a quaternion of norm 1, but its norm is {}", number(*norm))]
    NotUnit {
        /// Norm given.
        norm: f64,
    },
    /// The first disk is the base disk and the last one the tip disk.
    #[error(
        "must be {}, but is {}: the first disk sits at the base and the last at the tip",
        number(*expected),
        number(*value)
    )]
    NotAtEnd {
        /// Value given.
        value: f64,
        /// Where the disk must be.
        expected: f64,
    },
    /// A place beyond the end of the backbone.
    #[error("lies at {} m, beyond the tip at {} m", number(*value), number(*length))]
    BeyondTip {
        /// Arc length given.
        value: f64,
        /// Length of the backbone.
        length: f64,
    },
    /// A cable that is to end where it has no hole left.
    #[error(
        "lies at {} m, beyond the disk of the cable's last hole at {} m: name more holes, or end the cable earlier",
        number(*value),
        number(*last)
    )]
    BeyondLastHole {
        /// Arc length given.
        value: f64,
        /// Arc length of the disk of the last hole.
        last: f64,
    },
    /// A tube whose bore is not smaller than its outside.
    #[error("must be smaller than the outer diameter {}, but is {}", number(*outer), number(*inner))]
    BoreTooWide {
        /// Inner diameter given.
        inner: f64,
        /// Outer diameter at the same place.
        outer: f64,
    },
    /// Two cables or two motors of the same name.
    #[error("`{name}` is already the name of {what} {}: give each {what} its own", first + 1)]
    DuplicateName {
        /// What they are.
        what: &'static str,
        /// The name.
        name: String,
        /// Number of the first of that name, from 0.
        first: usize,
    },
    /// A factor on a stiffness that is given as a matrix.
    #[error(
        "cannot change a stiffness that is given as a matrix: give the matrix at both ends of the segment in `backbone.stiffness`"
    )]
    FactorOnMatrix,
    /// A cable of a motor that the robot does not have.
    #[error("is cable {given}, but the robot has {cables} cables")]
    NoSuchCable {
        /// Number given, from 1.
        given: usize,
        /// Cables of the robot.
        cables: usize,
    },
    /// A cable that two motors pull.
    #[error(
        "is `{cable}`, which motor `{motor}` pulls already: a cable belongs to one motor at most"
    )]
    TwoMotors {
        /// Name of the cable.
        cable: String,
        /// Name of the other motor.
        motor: String,
    },
    /// Limits that leave nothing between them.
    #[error("must have its lesser value first, but has {} and then {}", micro(*least), micro(*greatest))]
    NotAscending {
        /// First value.
        least: f64,
        /// Second value.
        greatest: f64,
    },
    /// Pretension of cables that do not stretch.
    #[error(
        "needs cables that stretch: give the motor a `stiffness`, or its cables an `axial_stiffness`"
    )]
    RigidUnderPretension,
    /// A command that the motor cannot take.
    #[error(
        "must be from {} {unit} to {} {unit}, the limits of this motor, but is {} {unit}",
        micro(*least), micro(*greatest), micro(*value)
    )]
    BeyondMotorLimit {
        /// Command given.
        value: f64,
        /// Least command.
        least: f64,
        /// Greatest command.
        greatest: f64,
        /// Unit of the command.
        unit: &'static str,
    },
    /// Commands of motors that do not fit the robot.
    #[error("has {given} entries, but the robot has {motors} motors")]
    MotorCount {
        /// Entries given.
        given: usize,
        /// Motors of the robot.
        motors: usize,
    },
    /// Commands of motors for another number of steps.
    #[error("has the commands of only {given} steps, but the case has {steps}")]
    MotorSteps {
        /// Steps given.
        given: usize,
        /// Steps of the case.
        steps: usize,
    },
    /// Loads elsewhere than where the model was built to take them.
    #[error(
        "sit elsewhere than where this model was built to take them: build the model with the loads of the case"
    )]
    LoadPlaces,
    /// A parameter that the robot or the case does not have.
    #[error(
        "there is no such number in this robot and case: give it in the file, as the value to start from"
    )]
    NoSuchQuantity,
    /// A case whose list does not fit the robot.
    #[error("has {given} entries, but the robot has {cables} cables")]
    CableCount {
        /// Entries given.
        given: usize,
        /// Cables of the robot.
        cables: usize,
    },
}

/// A number of a motor in a message, to a millionth of its unit.
fn micro(value: f64) -> String {
    number((value * 1e6).round() / 1e6)
}

fn triangles(count: usize) -> &'static str {
    if count == 1 { "triangle" } else { "triangles" }
}

fn edges(count: usize) -> &'static str {
    if count == 1 { "edge of" } else { "edges of" }
}

/// A place in a message.
fn place(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(number);
    format!("({x}, {y}, {z}) m")
}

/// Refuses a place that is not on the backbone.
pub(crate) fn check_on_backbone(path: &str, value: f64, length: f64) -> Result<(), RobotError> {
    let problem = if !value.is_finite() {
        Problem::NotFinite { value }
    } else if value < 0.0 {
        Problem::Negative { value }
    } else if value > length {
        Problem::BeyondTip { value, length }
    } else {
        return Ok(());
    };
    Err(RobotError::new(path, problem))
}
