//! Why there is no design.

use thiserror::Error;
use whipcord::batch::BatchError;
use whipcord::{RobotError, SolveError};

use crate::criterion::CriterionResult;

/// Why there is no design.
#[derive(Clone, Debug, Error)]
pub enum DesignError {
    /// There is nothing to come near to.
    #[error("a target without points: give points for some of the disks")]
    NoPoints,
    /// A target names a disk that the robot does not have.
    #[error("the target names disk {disk}, but the robot has disks 0 to {last}")]
    NoSuchDisk {
        /// Number of the disk, from 0.
        disk: usize,
        /// Number of the last one.
        last: usize,
    },
    /// A point or a weight is not a finite number, or a weight is negative.
    #[error(
        "the point or weight of disk {disk} of target {target} is not a number that can be used"
    )]
    NotFinite {
        /// Number of the target, from 0.
        target: usize,
        /// Number of the disk, from 0.
        disk: usize,
    },
    /// A cable to vary does not exist, or is given twice.
    #[error(
        "cable {cable} cannot be varied: the robot has {cables} cables, and each may be given once"
    )]
    NoSuchCable {
        /// Number of the cable, from 0.
        cable: usize,
        /// Number of cables.
        cables: usize,
    },
    /// No cable is to be varied.
    #[error("no cable to vary: give at least one")]
    NoCables,
    /// Nothing is to be varied.
    #[error(
        "nothing is varied: say what may change, such as cables[0].holes, cables[0].routing, cables[0].tension, backbone.rest_curvature or backbone.diameters"
    )]
    NothingVaried,
    /// A tension that is to be varied is not commanded.
    #[error(
        "the tension of cable `{name}` cannot be varied, as its shortening is commanded: give `tension` instead of `shortening`"
    )]
    DrivenByLength {
        /// Name of the cable.
        name: String,
    },
    /// A cable that is to bend the robot is not pulled.
    #[error(
        "cable `{name}` has no tension to bend the robot with: give `tension`, or vary it as well"
    )]
    NoTension {
        /// Name of the cable.
        name: String,
    },
    /// A hole is fixed of a cable whose holes are not varied.
    #[error("a hole of cable {cable} is fixed, but its holes are not varied")]
    FixedButNotVaried {
        /// Number of the cable, from 0.
        cable: usize,
    },
    /// The number of cables of a robot with motors is that of its motors.
    #[error(
        "the number of cables cannot be varied, as motors pull them: take out [[motors]], and add them for the cables of the design"
    )]
    Motors,
    /// The disks have no holes to choose from.
    #[error("the disks have no holes to choose from: give `holes` in [disks]")]
    NoHoles,
    /// A fixed hole or a largest jump that cannot be.
    #[error(
        "hole {hole} of disk {}, counted from 1 at the base, cannot be fixed: the disks have holes 1 to {holes}, and the cable passes {disks} disks",
        disk + 1
    )]
    NoSuchHole {
        /// Number of the hole, from 1.
        hole: usize,
        /// Number of the disk, from 0.
        disk: usize,
        /// Number of holes of a disk.
        holes: usize,
        /// Disks that the cable passes.
        disks: usize,
    },
    /// The rules leave no list of holes.
    #[error(
        "the rules leave no hole for disk {}, counted from 1 at the base: allow larger jumps or fix fewer holes",
        disk + 1
    )]
    NoChoice {
        /// Number of the disk, from 0.
        disk: usize,
    },
    /// More pairs of holes than can be tabulated.
    #[error(
        "{spans} pairs of neighbouring holes are more than the {most} that can be tabulated: allow smaller jumps, vary fewer cables, or give the disks fewer holes"
    )]
    TooManySpans {
        /// How many there are.
        spans: usize,
        /// How many may be.
        most: usize,
    },
    /// The model has no answer for any of the lists that were tried.
    #[error("the model has no answer for any list of holes that was tried; the first: {0}")]
    NoAnswer(SolveError),
    /// The budget was spent before there was any design.
    #[error(
        "the budget of the design was spent before any robot was found that could be one: give it more time or solves, or vary less"
    )]
    Ended,
    /// The batch of trials was stopped.
    #[error("the trials were stopped: {0}")]
    Stopped(String),
    /// The robot of the design is none.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The model refuses the design.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A curve without places, or with numbers that cannot be.
    #[error("{what}")]
    Curve {
        /// What is wrong and what to give instead.
        what: String,
    },
    /// The stiffness of the backbone is not given, or not that of a round section.
    #[error("{what}")]
    Backbone {
        /// What is wrong and what to give instead.
        what: String,
    },
    /// The curve takes a cable farther from the axis than it may be.
    #[error(
        "at {arc_length:.4} m the cable would have to be {radius:.5} m from the axis, and may be {largest:.5} m: a tension of {:.2} N or more brings it in", (tension * 100.0).ceil() / 100.0
    )]
    NotAttainable {
        /// Where in m.
        arc_length: f64,
        /// Needed distance from the axis in m.
        radius: f64,
        /// Largest distance in m.
        largest: f64,
        /// The tension in N that would do.
        tension: f64,
    },
    /// A criterion that robot, cases or model do not have.
    #[error("{what}")]
    Criterion {
        /// What is wrong and what to give instead.
        what: String,
    },
    /// No robot was found that keeps all constraints.
    #[error(
        "no robot was found within all constraints; of the nearest one {}: allow more to vary, or less strict limits. Whether one exists is not known",
        words(.0)
    )]
    NotMet(Vec<CriterionResult>),
    /// The iteration did not converge.
    #[error(
        "the {what} did not converge: after {iterations} steps a change of {change:.1e} is left; {advice}"
    )]
    NotConverged {
        /// What iterated.
        what: &'static str,
        /// Steps.
        iterations: usize,
        /// Last relative change.
        change: f64,
        /// What to try.
        advice: &'static str,
    },
}

impl DesignError {
    /// Whether a flag has ended the solves, so that no other of them has an answer.
    pub(crate) const fn is_cancelled(&self) -> bool {
        matches!(self, Self::Solve(SolveError::Cancelled { .. }))
    }
}

/// What constraints that are not met have for values.
fn words(results: &[CriterionResult]) -> String {
    let unmet = results.iter().filter(|result| !result.is_met());
    let texts = unmet.map(|of| {
        let unit = of.criterion.quantity.unit();
        let (limit, value) = (of.criterion.limit.unwrap_or(0.0), of.value);
        let bound = if of.criterion.quantity.is_limited_above() { "at most" } else { "at least" };
        format!("the {} is {value:.4e} {unit} instead of {bound} {limit:.4e} {unit}", of.criterion)
    });
    texts.collect::<Vec<_>>().join(", ")
}

impl From<BatchError> for DesignError {
    fn from(error: BatchError) -> Self {
        Self::Stopped(error.to_string())
    }
}
