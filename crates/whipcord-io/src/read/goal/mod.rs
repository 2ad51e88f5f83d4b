//! `[target]`, `[limits]` and `[prefer]`, and the limits of cables.

mod points;

use std::path::PathBuf;

use whipcord::robot::limits::{COORDINATE, FRACTION, LENGTH, Range, SPEED, TENSION};
use whipcord::{Problem, Robot, Shortening, Vec3};
use whipcord_inverse::{
    Actuator, CableLimits, Limits, PathPoint, Preference, ReachOptions, Target, Tolerance,
};

use crate::check::{Data, Fields};
use crate::error::{FileProblem, Problems};
use crate::node::Node;
use crate::read::{DesignTable, design, pose, vec3};
use crate::schema::ANGLE_TOLERANCE;
use crate::source::Sources;
use crate::units::Dimension;

pub use points::{load_path, load_shape};
pub(super) use points::{path, shape};

/// What is to be reached, within which limits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goal {
    /// What is to be reached.
    pub target: Option<Target>,
    /// Targets at times, one after the other, instead of one target.
    pub path: Vec<PathPoint>,
    /// The file that a shape or a path was read from.
    pub table: Option<PathBuf>,
    /// How far a point may be from its target in m.
    pub tolerance: Option<f64>,
    /// How far a direction may be from its target in rad.
    pub tolerance_angle: Option<f64>,
    /// Limits of all cables.
    pub all: CableBounds,
    /// Limits of each cable by itself.
    pub own: Vec<CableBounds>,
    /// Which answer is preferred.
    pub preference: Option<Preference>,
    /// How near the robot may come to obstacles.
    pub clearance: Option<Clearance>,
    /// What may change of the robot, and the shapes that it is to take.
    pub design: DesignTable,
}

/// How near a robot may come to obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clearance {
    /// No nearer than so many m.
    Least(f64),
    /// It may touch them.
    Touch,
}

/// Limits of one cable, or of all, as a file gives them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableBounds {
    /// Least and greatest tension in N.
    pub tension: Option<[f64; 2]>,
    /// Least and greatest shortening.
    pub shortening: Option<[Shortening; 2]>,
    /// Greatest rate of the command, in m/s or N/s.
    pub rate: Option<(f64, Dimension)>,
}

/// A cable whose rate is limited in the unit of another command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateMismatch {
    /// Its number from 0.
    pub cable: usize,
    /// Whether it is commanded by its tension.
    pub by_tension: bool,
}

impl RateMismatch {
    /// What is wrong with the file of this robot, and how to mend it.
    #[must_use]
    pub fn words(&self, robot: &Robot) -> String {
        let name = &robot.cables()[self.cable].name;
        let (commanded, unit) = match self.by_tension {
            true => ("tension", "N/s"),
            false => ("shortening", "mm/s"),
        };
        format!(
            "the rate of cable {name} is limited in another unit, but its {commanded} is commanded: give it in {unit}"
        )
    }
}

impl Goal {
    /// Least distance of the robot from obstacles in m; `None` where it may touch them.
    #[must_use]
    pub fn least_clearance(&self) -> Option<f64> {
        match self.clearance {
            Some(Clearance::Touch) => None,
            Some(Clearance::Least(least)) => Some(least),
            None => ReachOptions::default().clearance,
        }
    }

    /// The tolerance for a backbone of this length in m; what is not given follows from the other at a lever of a third of the length.
    #[must_use]
    pub fn tolerance(&self, length: f64) -> Option<Tolerance> {
        let lever = length / 3.0;
        match (self.tolerance, self.tolerance_angle) {
            (None, None) => None,
            (Some(position), Some(angle)) => Some(Tolerance { position, angle }),
            (Some(position), None) => {
                Some(Tolerance { position, angle: (position / lever).min(core::f64::consts::PI) })
            }
            (None, Some(angle)) => Some(Tolerance { angle, ..Tolerance::of_length(length) }),
        }
    }

    /// The limits of a robot that is commanded by these actuators.
    ///
    /// # Errors
    /// [`RateMismatch`] where the rate of a cable is that of another command.
    pub fn limits(&self, robot: &Robot, actuators: &[Actuator]) -> Result<Limits, RateMismatch> {
        let of = |cable: usize| {
            let own = self.own.get(cable).copied().unwrap_or_default();
            let free = CableLimits::default();
            let metres = |given: Shortening| given.in_metres(robot.cable_length(cable));
            let shortening = own.shortening.or(self.all.shortening);
            let by_tension = actuators.contains(&Actuator::Tension(cable));
            let by_shortening = actuators.contains(&Actuator::Shortening(cable));
            let rate = match own.rate.or(self.all.rate) {
                Some((rate, Dimension::ForceRate)) if by_tension => Some(rate),
                Some((rate, Dimension::Speed)) if by_shortening => Some(rate),
                // Of a cable that a motor pulls, the motor is limited.
                Some(_) if by_tension || by_shortening => {
                    return Err(RateMismatch { cable, by_tension });
                }
                _ => None,
            };
            Ok(CableLimits {
                tension: own.tension.or(self.all.tension).unwrap_or(free.tension),
                shortening: shortening.map_or(free.shortening, |pair| pair.map(metres)),
                rate,
            })
        };
        Ok(Limits { cables: (0..robot.cables().len()).map(of).collect::<Result<_, _>>()? })
    }
}

/// Reads the tables; a robot has so many disks.
pub(crate) fn goal(
    fields: &Fields,
    (disks, cables): (Option<usize>, &[String]),
    document: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Goal {
    let mut reader = Reader { document, problems };
    let mut goal = Goal::default();
    if let Some(table) = fields.table("target") {
        goal.tolerance = reader.number(table, "target", "tolerance", LENGTH);
        goal.tolerance_angle = reader.number(table, "target", "tolerance_angle", ANGLE_TOLERANCE);
        goal.target = reader.target(table);
        if let Some(named) = table.text("shape") {
            let span = document.locate("target.shape").span;
            let path = sources.resolve(span.file, named);
            let points = shape(&path, Some(span), disks, sources, reader.problems);
            goal.target = points.map(Target::Shape);
            goal.table = Some(path.canonicalize().unwrap_or(path));
        }
        if let Some(named) = table.text("path") {
            let span = document.locate("target.path").span;
            let path = sources.resolve(span.file, named);
            let points = points::path(&path, Some(span), sources, reader.problems);
            goal.path = points.unwrap_or_default();
            goal.table = Some(path.canonicalize().unwrap_or(path));
        }
    }
    if let Some(table) = fields.table("limits") {
        goal.all = reader.bounds(table, "limits", ["tension", "shortening", "rate"]);
    }
    for (i, table) in fields.tables("cables").iter().enumerate() {
        let keys = ["tension_limits", "shortening_limits", "rate_limit"];
        goal.own.push(reader.bounds(table, &format!("cables[{i}]"), keys));
    }
    if let Some(table) = fields.table("prefer") {
        goal.preference = match table.text("least") {
            Some("change") => Some(Preference::LeastChange),
            Some("clearance") => Some(Preference::MostClearance),
            Some(_) => Some(Preference::LeastTension),
            None => None,
        };
        goal.clearance = match table.text("clearance") {
            Some(_) => Some(Clearance::Touch),
            None => reader
                .number(table, "prefer", "clearance", whipcord::robot::limits::DISTANCE)
                .map(Clearance::Least),
        };
    }
    if let Some(table) = fields.table("design") {
        goal.design = design(table, disks, cables, document, sources, problems);
    }
    goal
}

/// Shortenings that are compared only where both are given in one way.
pub(crate) fn check_shortenings(
    goal: &Goal,
    robot: &Robot,
    document: &Node,
    problems: &mut Problems,
) {
    for (i, own) in goal.own.iter().enumerate() {
        let (path, pair) = match (own.shortening, goal.all.shortening) {
            (Some(pair), _) => (format!("cables[{i}].shortening_limits"), pair),
            (None, Some(pair)) => ("limits.shortening".to_owned(), pair),
            (None, None) => continue,
        };
        let [least, greatest] = pair.map(|given| given.in_metres(robot.cable_length(i)));
        if least > greatest {
            let span = document.locate(&path).span;
            let problem = Problem::NotAscending { least, greatest };
            problems.push(span, || FileProblem::Physical { path, problem });
            return;
        }
    }
}

struct Reader<'a> {
    document: &'a Node,
    problems: &'a mut Problems,
}

impl Reader<'_> {
    fn refuse(&mut self, path: String, problem: Problem) {
        let span = self.document.locate(&path).span;
        self.problems.push(span, || FileProblem::Physical { path, problem });
    }

    /// A number within a range.
    fn number(&mut self, table: &Fields, title: &str, key: &str, range: Range) -> Option<f64> {
        let value = table.number(key)?;
        self.within(value, range, || format!("{title}.{key}")).then_some(value)
    }

    fn within(&mut self, value: f64, range: Range, path: impl Fn() -> String) -> bool {
        let problem = range.problem(value);
        let is_within = problem.is_none();
        if let Some(problem) = problem {
            self.refuse(path(), problem);
        }
        is_within
    }

    /// Whether a point can be one of the world.
    fn is_place(&mut self, point: Vec3, path: &str) -> bool {
        let mut values = point.to_array().into_iter().enumerate();
        values.all(|(i, value)| self.within(value, COORDINATE, || format!("{path}[{i}]")))
    }

    /// A target that the table itself gives.
    fn target(&mut self, table: &Fields) -> Option<Target> {
        let point = vec3(table, "tip");
        if !point.is_none_or(|point| self.is_place(point, "target.tip")) {
            return None;
        }
        if let Some(given) = table.table("pose") {
            return match pose(given) {
                Ok(pose) => self
                    .is_place(pose.position, "target.pose.position")
                    .then_some(Target::Pose(pose)),
                Err(path) => {
                    self.refuse(format!("target.pose.{path}"), Problem::NoDirection);
                    None
                }
            };
        }
        let Some(direction) = vec3(table, "axis") else { return point.map(Target::Tip) };
        if direction.norm() == 0.0 {
            self.refuse("target.axis".to_owned(), Problem::NoDirection);
            return None;
        }
        Some(Target::Axis { point, direction })
    }

    /// Limits of tension, shortening and rate under these keys.
    fn bounds(&mut self, table: &Fields, title: &str, keys: [&str; 3]) -> CableBounds {
        let [tension, shortening, rate] = keys;
        let pair = |key: &str| match table.list(key) {
            Some([least, greatest]) => {
                Some([least, greatest].map(Data::as_quantity)).and_then(|[a, b]| Some([a?, b?]))
            }
            _ => None,
        };
        let mut bounds = CableBounds::default();
        if let Some(given) = pair(tension) {
            let values = given.map(|(value, _)| value);
            if self.pair(values, [TENSION; 2], &format!("{title}.{tension}")) {
                bounds.tension = Some(values);
            }
        }
        if let Some(given) = pair(shortening) {
            let values = given.map(|(value, _)| value);
            let ranges =
                given.map(|(_, of)| if of == Dimension::Ratio { FRACTION } else { COORDINATE });
            let of_one = given[0].1 == given[1].1;
            let compared = if of_one { values } else { [0.0, 0.0] };
            let path = format!("{title}.{shortening}");
            let are_within =
                (0..2).all(|k| self.within(values[k], ranges[k], || format!("{path}[{k}]")));
            if are_within && self.pair(compared, ranges, &path) {
                bounds.shortening = Some(given.map(|(value, of)| match of {
                    Dimension::Ratio => Shortening::Fraction(value),
                    _ => Shortening::Length(value),
                }));
            }
        }
        if let Some((value, dimension)) = table.quantity(rate) {
            // The same range in N/s.
            if self.within(value, SPEED, || format!("{title}.{rate}")) {
                bounds.rate = Some((value, dimension));
            }
        }
        bounds
    }

    /// Whether two limits are within their ranges and in order.
    fn pair(&mut self, [least, greatest]: [f64; 2], ranges: [Range; 2], path: &str) -> bool {
        if !self.within(least, ranges[0], || format!("{path}[0]"))
            || !self.within(greatest, ranges[1], || format!("{path}[1]"))
        {
            return false;
        }
        if least > greatest {
            self.refuse(path.to_owned(), Problem::NotAscending { least, greatest });
            return false;
        }
        true
    }
}
