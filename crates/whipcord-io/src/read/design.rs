//! `[design]`: what may change of a robot, its target shapes, and tolerances.

use std::path::{Path, PathBuf};

use whipcord::robot::limits::{COORDINATE, LENGTH, TENSION};
use whipcord::{Problem, Robot, Vec3};
use whipcord_design::{Criterion, NamedCurve, Quantity, Vary};
use whipcord_inverse::{PathPoint, Target};

use super::criterion::parse_criterion;
use super::curve::parse_curve;
use super::goal::{path, shape};
use super::table::problem;
use super::{vec3, vector_quantities};
use crate::check::Fields;
use crate::error::{FileError, FileProblem, Problems};
use crate::node::Node;
use crate::schema::{DEVIATION, DEVIATION_OF_ANGLE, WEIGHT};
use crate::source::{Sources, Span};

/// What a file says of a design.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignTable {
    /// What may change, by paths.
    pub vary: Vec<String>,
    /// Holes by which a cable may move from a disk to the next.
    pub max_jump: Option<usize>,
    /// Whether no two cables may share a hole.
    pub distinct: bool,
    /// Whether cables may cross.
    pub crossing: Option<bool>,
    /// Holes that are given.
    pub fixed: Vec<FixedHoleEntry>,
    /// Objectives and constraints.
    pub criteria: Vec<Criterion>,
    /// Least and greatest diameter in m.
    pub diameter: Option<[f64; 2]>,
    /// Degree of polynomials.
    pub degree: Option<usize>,
    /// Places along the backbone.
    pub places: Option<usize>,
    /// Starts of least squares.
    pub starts: Option<usize>,
    /// Steps of least squares from each start.
    pub iterations: Option<usize>,
    /// Solves that the search may take.
    pub solves: Option<usize>,
    /// Shapes that the robot is to take.
    pub targets: Vec<DesignTarget>,
    /// Standard deviations of manufacture.
    pub tolerances: ToleranceTable,
}

/// A hole that a cable goes through in any case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FixedHoleEntry {
    /// Name of the cable.
    pub cable: String,
    /// Number of the disk from 1.
    pub disk: usize,
    /// Number of the hole from 1.
    pub hole: usize,
}

/// A shape that the robot is to take.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignTarget {
    /// The shape.
    pub shape: DesignShape,
    /// Tension of each cable in N, where it is that of this target.
    pub tension: Option<Vec<f64>>,
    /// How much it counts.
    pub weight: Option<f64>,
}

/// The shape of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignShape {
    /// A curve by its name.
    Curve(NamedCurve),
    /// Points for disks, by their numbers from 0, and the file they were read from.
    Points(Vec<(usize, Vec3)>, PathBuf),
    /// Points for the tip, each of them with tensions of its own, and the file they were read from.
    Path(Vec<Vec3>, PathBuf),
    /// A point for the tip in m.
    Tip(Vec3),
    /// The disks that were measured.
    Measured,
}

/// Standard deviations that a file gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToleranceTable {
    /// Of the radius of hole circles in m.
    pub hole_radius: Option<f64>,
    /// Of the angle of a hole in rad.
    pub hole_angle: Option<f64>,
    /// Of the arc length of a disk in m.
    pub disk_position: Option<f64>,
    /// Of the stiffness, as a part of it.
    pub stiffness: Option<f64>,
    /// Of a tension, as a part of it.
    pub tension: Option<f64>,
    /// Robots.
    pub samples: Option<usize>,
    /// Of the random numbers.
    pub seed: Option<usize>,
}

/// Reads the table of a robot with so many disks and cables of these names.
pub(crate) fn design(
    table: &Fields,
    disks: Option<usize>,
    cables: &[String],
    document: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> DesignTable {
    let mut reader = Reader { document, problems };
    let texts = |key: &str| -> Vec<String> {
        let list = table.list(key).unwrap_or_default().iter();
        list.filter_map(|data| data.as_text().map(str::to_owned)).collect()
    };
    let mut design = DesignTable {
        vary: texts("vary"),
        max_jump: table.count("max_jump"),
        distinct: table.flag("distinct"),
        crossing: table.truth("crossing"),
        degree: table.count("degree"),
        places: table.count("places"),
        starts: table.count("starts"),
        iterations: table.count("iterations"),
        solves: table.count("solves"),
        ..DesignTable::default()
    };
    for (k, fixed) in table.tables("fixed").iter().enumerate() {
        let (Some(cable), Some(disk), Some(hole)) =
            (fixed.text("cable"), fixed.count("disk"), fixed.count("hole"))
        else {
            continue;
        };
        if !cables.iter().any(|name| name == cable) {
            let message = format!("there is no cable `{cable}`");
            let help = format!("the cables are {}", cables.join(", "));
            reader.wrong(&format!("design.fixed[{k}].cable"), message, help);
        }
        if disks.is_some_and(|disks| disk > disks) {
            let message = format!("there is no disk {disk}");
            reader.wrong(
                &format!("design.fixed[{k}].disk"),
                message,
                "disks count from 1, the base disk".to_owned(),
            );
        }
        design.fixed.push(FixedHoleEntry { cable: cable.to_owned(), disk, hole });
    }
    for (k, text) in texts("criteria").iter().enumerate() {
        match parse_criterion(text) {
            Ok(criterion) => {
                if let Quantity::Stiffness { disk, .. } = criterion.quantity
                    && disks.is_some_and(|disks| disk >= disks)
                {
                    let help = "disks count from 1, the base disk".to_owned();
                    let message = format!("there is no disk {}", disk + 1);
                    reader.wrong(&format!("design.criteria[{k}]"), message, help);
                }
                design.criteria.push(criterion);
            }
            Err(message) => {
                reader.wrong_text(&format!("design.criteria[{k}]"), &message, CRITERION)
            }
        }
    }
    if let Some([least, greatest]) = table.vector("diameter") {
        let is_within = [(0, least), (1, greatest)]
            .iter()
            .all(|(k, value)| reader.within(*value, LENGTH, &format!("design.diameter[{k}]")));
        if is_within && least > greatest {
            reader.refuse("design.diameter", Problem::NotAscending { least, greatest });
        }
        design.diameter = Some([least, greatest]);
    }
    for (k, target) in table.tables("targets").iter().enumerate() {
        let path = format!("design.targets[{k}]");
        if let Some(target) = reader.target(target, &path, (disks, cables.len()), sources) {
            design.targets.push(target);
        }
    }
    if let Some(table) = table.table("tolerances") {
        design.tolerances = reader.tolerances(table);
    }
    design
}

/// Checks what only the whole robot decides: what the paths of `vary` name.
pub(crate) fn check_design(
    design: &DesignTable,
    robot: &Robot,
    has_measured: bool,
    document: &Node,
    problems: &mut Problems,
) {
    for (k, path) in design.vary.iter().enumerate() {
        if let Err(error) = Vary::parse(path, robot) {
            let span = document.locate(&format!("design.vary[{k}]")).span;
            let message = format!("`{path}` is nothing that can be varied{}", error.reason);
            problems.push(span, || problem(message, format!("give {}", error.known)));
        }
    }
    for (k, target) in design.targets.iter().enumerate() {
        if matches!(target.shape, DesignShape::Measured) && !has_measured {
            let span = document.locate(&format!("design.targets[{k}].measured")).span;
            let help = "add [measured] with the positions of disks in the last step";
            problems.push(span, || problem("no disks were measured", help));
        }
    }
}

const CURVE: &str = "give a curve such as \"arc, angle = 90 deg\"";
const CRITERION: &str = "give a criterion such as \"clearance, at_least = 5 mm\"";

/// Points for the tip that a design takes.
const MOST_POINTS: usize = 500;

/// Reads the points of a path from a CSV or Parquet file.
///
/// # Errors
/// [`FileError`] with what is wrong and where.
pub fn load_tip_path(path: &Path) -> Result<Vec<Vec3>, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match tip_path(path, None, &mut sources, &mut problems) {
        Some(points) if problems.is_empty() => Ok(points),
        _ => Err(problems.into_error(sources)),
    }
}

/// The places of a path in a file that another one may name at `named`.
fn tip_path(
    file: &Path,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<Vec3>> {
    let points = path(file, named, sources, problems)?;
    let place = |point: &PathPoint| match point.target {
        Target::Tip(place) => Some(place),
        _ => None,
    };
    let places: Option<Vec<Vec3>> = points.iter().map(place).collect();
    let refused = match &places {
        None => (
            "a design takes places of the tip, but this path has orientations",
            "leave out their columns",
        ),
        Some(places) if places.is_empty() => ("a path without points", "give at least one"),
        Some(places) if places.len() > MOST_POINTS => {
            ("a path with more than 500 points", "give fewer: each has tensions of its own")
        }
        Some(_) => return places,
    };
    let span = named.unwrap_or_default();
    problems.push(span, || problem(refused.0, refused.1));
    None
}

struct Reader<'a> {
    document: &'a Node,
    problems: &'a mut Problems,
}

impl Reader<'_> {
    fn wrong(&mut self, path: &str, message: String, help: String) {
        let span = self.document.locate(path).span;
        self.problems.push(span, || problem(message, help));
    }

    /// A text that is wrong: what is, and what to give where the message says it or by an example.
    fn wrong_text(&mut self, path: &str, message: &str, example: &str) {
        let (message, help) = message.split_once(": ").unwrap_or((message, example));
        self.wrong(path, message.to_owned(), help.to_owned());
    }

    fn refuse(&mut self, path: &str, problem: Problem) {
        let span = self.document.locate(path).span;
        let path = path.to_owned();
        self.problems.push(span, || FileProblem::Physical { path, problem });
    }

    fn within(&mut self, value: f64, range: whipcord::robot::limits::Range, path: &str) -> bool {
        let found = range.problem(value);
        let is_within = found.is_none();
        if let Some(found) = found {
            self.refuse(path, found);
        }
        is_within
    }

    fn target(
        &mut self,
        table: &Fields,
        path: &str,
        (disks, cables): (Option<usize>, usize),
        sources: &mut Sources,
    ) -> Option<DesignTarget> {
        let tension = table.list("tension").map(vector_quantities);
        if let Some(given) = &tension {
            if given.len() != cables {
                let at = self.document.locate(&format!("{path}.tension")).span;
                let (expected, given) = (cables, given.len());
                self.problems.push(at, || FileProblem::WrongCount {
                    key: "tension",
                    expected,
                    given,
                });
            }
            for (k, value) in given.iter().enumerate() {
                self.within(*value, TENSION, &format!("{path}.tension[{k}]"));
            }
        }
        let weight = table.number("weight");
        if let Some(weight) = weight {
            self.within(weight, WEIGHT, &format!("{path}.weight"));
        }
        let shape = if let Some(text) = table.text("curve") {
            match parse_curve(text) {
                Ok(curve) => DesignShape::Curve(curve),
                Err(message) => {
                    self.wrong_text(&format!("{path}.curve"), &message, CURVE);
                    return None;
                }
            }
        } else if let Some(named) = table.text("shape") {
            let span = self.document.locate(&format!("{path}.shape")).span;
            let file = sources.resolve(span.file, named);
            let points = shape(&file, Some(span), disks, sources, self.problems)?;
            DesignShape::Points(points, file.canonicalize().unwrap_or(file))
        } else if let Some(named) = table.text("path") {
            let span = self.document.locate(&format!("{path}.path")).span;
            let file = sources.resolve(span.file, named);
            let points = tip_path(&file, Some(span), sources, self.problems)?;
            DesignShape::Path(points, file.canonicalize().unwrap_or(file))
        } else if let Some(point) = vec3(table, "tip") {
            for (k, value) in point.to_array().into_iter().enumerate() {
                self.within(value, COORDINATE, &format!("{path}.tip[{k}]"));
            }
            DesignShape::Tip(point)
        } else {
            if table.truth("measured") == Some(false) {
                let help = "leave out this target, or say measured = true".to_owned();
                self.wrong(&format!("{path}.measured"), "a target of nothing".to_owned(), help);
            }
            DesignShape::Measured
        };
        Some(DesignTarget { shape, tension, weight })
    }

    fn tolerances(&mut self, table: &Fields) -> ToleranceTable {
        let mut number = |key: &str, range| {
            let value = table.number(key)?;
            self.within(value, range, &format!("design.tolerances.{key}")).then_some(value)
        };
        ToleranceTable {
            hole_radius: number("hole_radius", whipcord::robot::limits::DISTANCE),
            hole_angle: number("hole_angle", DEVIATION_OF_ANGLE),
            disk_position: number("disk_position", whipcord::robot::limits::DISTANCE),
            stiffness: number("stiffness", DEVIATION),
            tension: number("tension", DEVIATION),
            samples: table.count("samples"),
            seed: table.count("seed"),
        }
    }
}
