//! What a design is asked for, and what it is answered.

use core::fmt;

use whipcord::{Cancel, Case, ModelKind, Robot, Solution, SolveError, Vec3};

use crate::budget::Ended;
use crate::choices::HoleRules;
use crate::criterion::{Criterion, CriterionResult};
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::hole_design::{HoleSearchOptions, Proof};
use crate::named_curve::NamedCurve;

/// A shape, and the commands and loads under which the robot is to take it.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignGoal {
    /// Tensions or shortenings and loads.
    pub case: Case,
    /// The shape.
    pub target: TargetShape,
    /// How much the squares of its distances count beside those of other goals.
    pub weight: f64,
}

/// A shape that a robot is to take.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetShape {
    /// Numbers of disks, from 0, and where their centres are wanted, in m in the world.
    Points(Vec<(usize, Vec3)>),
    /// A curve that begins at the base of the robot, along it.
    Curve(NamedCurve),
}

impl DesignGoal {
    /// The points for the disks of a robot.
    ///
    /// # Errors
    /// [`DesignError::Curve`] for a curve with numbers that cannot be.
    pub fn points(&self, robot: &Robot) -> Result<Vec<(usize, Vec3)>, DesignError> {
        Ok(match &self.target {
            TargetShape::Points(points) => points.clone(),
            TargetShape::Curve(named) => {
                let curve = named.curve(robot.backbone().length)?;
                let points = curve.points(&robot.disks().arc_lengths);
                let points = points.into_iter().map(|point| self.case.base.transform(point));
                points.enumerate().skip(1).collect()
            }
        })
    }

    pub(crate) fn shape_goal(&self, robot: &Robot) -> Result<ShapeGoal, DesignError> {
        let points = self.points(robot)?;
        Ok(ShapeGoal { case: self.case.clone(), points, weight: self.weight })
    }
}

/// Rules, bounds and budgets of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignOptions {
    /// What counts beside the targets: objectives and hard constraints.
    pub criteria: Vec<Criterion>,
    /// What can be manufactured. Fixed holes are those of the cables of the robot by their numbers.
    pub rules: HoleRules,
    /// Solves of whole shapes that all searches may spend together, those of least squares included; without loads ten of a table count as one. Where they are spent the best robot so far is
    /// the answer, and says so ([`Design::ended`]).
    pub solves: usize,
    /// A flag that ends all searches likewise, as where a time is over: this crate reads no clock. Whereas the flag of the model ends them without an answer.
    pub stop: Cancel,
    /// What one search for holes may spend.
    pub search: HoleSearchOptions,
    /// Least and greatest diameter of the backbone in m; by default a quarter and four times of what it has.
    pub diameters: Option<[f64; 2]>,
    /// Least and greatest tension of each cable in N, where limited; of a cable that is not listed nothing is limited.
    pub tensions: Vec<Option<[f64; 2]>>,
    /// Least and greatest shortening of each cable in m, where limited: those of a workspace of cables without tensions.
    pub shortenings: Vec<Option<[f64; 2]>>,
    /// Degree of the polynomials of a continuous routing.
    pub degree: usize,
    /// Places along the backbone at which a rest curvature or a diameter is given.
    pub places: usize,
    /// Starts of least squares.
    pub starts: usize,
    /// Steps of least squares from each start.
    pub iterations: usize,
    /// Of the random numbers that decide on the starts.
    pub seed: u64,
    /// How far, as a part of the length, a shape may be off that a number of cables is to take.
    pub shape_tolerance: f64,
}

impl Default for DesignOptions {
    fn default() -> Self {
        Self {
            criteria: Vec::new(),
            rules: HoleRules::default(),
            solves: 40_000,
            stop: Cancel::default(),
            search: HoleSearchOptions::default(),
            diameters: None,
            tensions: Vec::new(),
            shortenings: Vec::new(),
            degree: 5,
            places: 37,
            starts: 6,
            iterations: 200,
            seed: 1,
            shape_tolerance: 0.01,
        }
    }
}

/// What is known of a part of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// Of lists of holes.
    Holes(Proof),
    /// A closed form, solved forward.
    ClosedForm,
    /// An iteration on the curve until its distance no longer fell.
    Iterated,
    /// All targets are met by continuous quantities, up to what rounding and tolerances leave: nothing can come nearer.
    Met,
    /// Least squares converged from some starts, of which some ended as near as this.
    LeastSquares {
        /// Starts with an answer.
        starts: usize,
        /// Those that ended as near as the best.
        agree: usize,
    },
    /// Of tensions that vary with holes: some tensions were compared by the lists of holes that suit them, and from the best of these, holes and tensions were chosen in turn
    /// until neither came nearer. That no other tension comes nearer is not proven.
    InTurn {
        /// Tensions that had an answer.
        compared: usize,
        /// Those from which holes and tensions were chosen in turn.
        improved: usize,
    },
    /// Least squares did not converge from the best start.
    Unconverged {
        /// Starts with an answer.
        starts: usize,
        /// Why not.
        reason: Unconverged,
    },
    /// The best that was found until the budget of the whole design was spent.
    Budget,
    /// The number of cables: this many at least, by the rank of the bending moments.
    AtLeast {
        /// The bound.
        cables: usize,
    },
}

/// Why least squares did not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unconverged {
    /// This many steps were spent while the error still fell.
    Steps(usize),
    /// No step lowers the error, though the derivatives promise it.
    Stalled,
    /// The model has no answer beyond.
    Refused,
    /// A constraint could not be kept.
    Constraints,
    /// The budget of the whole design was spent.
    Budget,
}

impl Unconverged {
    /// In words.
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Steps(steps) => format!(
                "its {steps} steps were spent while the error still fell, so that design.iterations or design.starts may be raised"
            ),
            Self::Stalled => "no step lowers the error, although the derivatives promise it, as at a slack cable or a contact".to_owned(),
            Self::Refused => "the model has no answer for what comes nearer".to_owned(),
            Self::Constraints => "not all constraints could be kept".to_owned(),
            Self::Budget => {
                "the budget of the design was spent while the error still fell".to_owned()
            }
        }
    }
}

impl Known {
    /// Whether no better one exists, as is proven.
    #[must_use]
    pub const fn is_proven(self) -> bool {
        matches!(self, Self::Holes(Proof::Optimal) | Self::ClosedForm | Self::Met)
    }

    /// A name for programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Holes(Proof::Optimal) => "optimal_proven",
            Self::Holes(Proof::Budget) => "budget_spent",
            Self::Holes(Proof::Local) => "local_optimum",
            Self::Holes(Proof::InTurn) => "in_turn",
            Self::ClosedForm => "closed_form",
            Self::Iterated => "iterated",
            Self::Met => "targets_met",
            Self::LeastSquares { .. } => "least_squares",
            Self::InTurn { .. } => "in_turn",
            Self::Budget => "budget_spent",
            Self::Unconverged { .. } => "not_converged",
            Self::AtLeast { .. } => "lower_bound",
        }
    }
}

impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Holes(Proof::Optimal) => {
                write!(f, "proven: {}", Proof::Optimal.words())
            }
            Self::Holes(proof) => write!(f, "not proven: {}", proof.words()),
            Self::ClosedForm => f.write_str(
                "closed form: the cable that bends this backbone to the curve, exact but for the shear of the sections",
            ),
            Self::Iterated => f.write_str(
                "corrected until the distance from the curve no longer fell; what is left is due to the linear interpolation between the places and to the bounds",
            ),
            Self::Met => f.write_str(
                "proven: the targets are met to 10⁻⁷ of the length, so that nothing comes nearer; other values may meet them as well",
            ),
            Self::LeastSquares { starts: 1, .. } => f.write_str(
                "not proven: no small change comes nearer, from one start; it may not be the best of all",
            ),
            Self::LeastSquares { starts, agree } => write!(
                f,
                "not proven: no small change comes nearer, and {agree} of {starts} starts ended as near; it may not be the best of all"
            ),
            Self::InTurn { compared: 1, .. } => f.write_str(
                "not proven: holes and tensions were chosen in turn until neither came nearer, from the tensions that were given; others may be better",
            ),
            Self::InTurn { compared, improved } => write!(
                f,
                "not proven: the best of {compared} tensions that were compared by the holes that suit them, of which {improved} were improved with their holes in turn until neither came nearer; another may be better"
            ),
            Self::Budget => f.write_str(
                "not proven: the best found until the budget of the design was spent, which may not be the best of all",
            ),
            Self::Unconverged { starts, reason } => {
                let from = if *starts == 1 { "one start" } else { &format!("{starts} starts") };
                write!(f, "not proven: the best found from {from}; {}", reason.words())
            }
            Self::AtLeast { cables } => write!(
                f,
                "the bending moments of the targets have rank {cables}: fewer cables cannot make them, up to the tolerance"
            ),
        }
    }
}

/// A part of a design and what is known of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What was varied, by its path.
    pub what: String,
    /// What is known of it.
    pub known: Known,
}

/// How near the robot of a design comes to one of its goals.
#[derive(Clone, Debug)]
pub struct GoalResult {
    /// The case with the commands of the design.
    pub case: Case,
    /// Wanted place of each disk that has one, by the number of the disk.
    pub points: Vec<(usize, Vec3)>,
    /// Distance of these disks in m.
    pub distances: Vec<f64>,
    /// The shape, by the model that was asked for.
    pub solution: Solution,
    /// The same robot solved by `cosserat-disks` at a fine resolution: distance of each of these disks in m, or why there is no answer. `None` for a
    /// robot without disks.
    pub check: Option<Result<Vec<f64>, SolveError>>,
}

/// The robot that was designed.
#[derive(Clone, Debug)]
pub struct Design {
    /// The robot.
    pub robot: Robot,
    /// The model that the shapes are those of.
    pub model: ModelKind,
    /// One for each goal.
    pub goals: Vec<GoalResult>,
    /// What is known of what was varied.
    pub findings: Vec<Finding>,
    /// What ended the searches before they came to their ends, if anything did.
    pub ended: Option<Ended>,
    /// Solves that the searches took, as [`DesignOptions::solves`] counts them.
    pub solves: usize,
    /// What became of the criteria; constraints are met.
    pub criteria: Vec<CriterionResult>,
    /// Limits of tension in N that were assumed because none were given.
    pub assumed_tension: Option<[f64; 2]>,
    /// Where holes vary: the error in m that no other list of them is below with these tensions, as far as that is known. It is the error itself where the list is proven to be the best.
    pub lower_bound: Option<f64>,
    /// Root of the weighted mean of the squares of all distances in m.
    pub error: f64,
    /// Greatest of these distances in m.
    pub largest: f64,
    /// The same two for the robot as it was given; `None` where it has no answer.
    pub before: Option<[f64; 2]>,
}

impl Design {
    /// Whether all that was varied is proven to be the best.
    #[must_use]
    pub fn is_proven(&self) -> bool {
        !self.findings.is_empty() && self.findings.iter().all(|finding| finding.known.is_proven())
    }
}

/// Root of the mean of squares, and the greatest, of some distances.
#[must_use]
pub fn spread(distances: &[f64]) -> [f64; 2] {
    #[allow(clippy::cast_precision_loss, reason = "few disks")]
    let count = distances.len().max(1) as f64;
    let square = distances.iter().map(|distance| distance * distance).sum::<f64>() / count;
    [square.sqrt(), distances.iter().copied().fold(0.0, f64::max)]
}
