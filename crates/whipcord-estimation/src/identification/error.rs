//! Why nothing is estimated.

use crate::camera::ViewError;
use crate::registration::RegistrationError;
use whipcord::error::SolveError;
use whipcord::jobs::NoThreads;
use whipcord::kind::ModelKind;
use whipcord::robot::RobotError;

/// Why nothing is estimated. Experiments, observations and steps are numbered from 0 in the fields, from 1 in
/// the messages.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Nothing was measured.
    #[error("nothing was measured: give the places of disks or markers that were seen")]
    NoMeasurements,
    /// Nothing is to be estimated.
    #[error("nothing is to be estimated: name the parameters that are not known")]
    NoUnknowns,
    /// More unknowns than numbers that were measured, so that nothing would be known of the noise.
    #[error(
        "{numbers} numbers were measured, too few for {unknowns} unknowns: measure more, estimate less, or say what else is known of them (priors and deviations)"
    )]
    TooFewNumbers {
        /// Numbers that were measured, and priors.
        numbers: usize,
        /// Unknowns.
        unknowns: usize,
    },
    /// An unknown that robot and case do not have.
    #[error(transparent)]
    Absent(RobotError),
    /// The same number is estimated twice.
    #[error("{first} and {second} change the same numbers: estimate one of them")]
    Overlap {
        /// Path of the one.
        first: String,
        /// Path of the other.
        second: String,
    },
    /// An unknown of an experiment that there is not.
    #[error("{path} is to be estimated for case {}, but there are {experiments}", experiment + 1)]
    NoExperiment {
        /// Path of the unknown.
        path: String,
        /// The experiment.
        experiment: usize,
        /// How many there are.
        experiments: usize,
    },
    /// A measurement that cannot be moved onto the robot.
    #[error("{}", not_moved(&numbered(*experiment), error))]
    Frame {
        /// The experiment.
        experiment: usize,
        /// Why.
        error: RegistrationError,
    },
    /// Bounds, start or prior of an unknown that cannot be.
    #[error("{path}: {problem}")]
    Setting {
        /// Path of the unknown.
        path: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A probability that is none.
    #[error("the confidence must lie between 0 and 1, but is {value}")]
    Confidence {
        /// What was given.
        value: f64,
    },
    /// An observation that robot, case or cameras do not fit.
    #[error("{}", misfit(&numbered(*experiment), *observation, problem))]
    Observation {
        /// The experiment.
        experiment: usize,
        /// The observation.
        observation: usize,
        /// What is wrong.
        problem: Misfit,
    },
    /// Some observations say how exact they are and others do not.
    #[error(
        "some observations have a deviation and others have none, so that they cannot be weighed: give it for all or for none"
    )]
    SomeDeviations,
    /// Positions and pixels without a word on how exact they are.
    #[error(
        "metres and pixels were measured without a deviation, so that they cannot be weighed: give the deviation of each"
    )]
    MixedUnits,
    /// Friction is estimated with a model that has none.
    #[error(
        "{path} cannot be estimated with the {model} model, which has no friction: use cosserat, cosserat-disks, piecewise-constant-curvature or pseudo-rigid-body"
    )]
    NoFriction {
        /// Path of the unknown.
        path: String,
        /// The model.
        model: ModelKind,
    },
    /// An offset of a command that does not drive the cable.
    #[error("{}", not_driven(&numbered(*experiment), path))]
    NotDriven {
        /// Path of the unknown.
        path: String,
        /// The experiment.
        experiment: usize,
    },
    /// The model has no answer where the search starts.
    #[error("with the values to start from, {0}")]
    NoAnswerAtStart(NoAnswer),
    /// The search was ended from outside ([`Cancel`](whipcord::Cancel)).
    #[error("the fit was cancelled before it had converged")]
    Cancelled,
    /// Nothing that could be held out.
    #[error(
        "nothing can be held out: what is fitted is a single group of rows, or a single case with a single step, or each case has an unknown of its own and a single step"
    )]
    NothingToHoldOut,
    /// A search without a part of the measurements did not converge.
    #[error("{}", not_converged(&numbered(*experiment), *step))]
    NotConverged {
        /// The experiment that was held out.
        experiment: usize,
        /// The step of it; else all of it.
        step: Option<usize>,
    },
}

impl IdentifyError {
    /// The message with these names of the experiments in place of their numbers.
    #[must_use]
    pub fn named(&self, names: &[String]) -> String {
        let name = |experiment: usize| {
            names.get(experiment).cloned().unwrap_or_else(|| numbered(experiment))
        };
        match self {
            Self::NoAnswerAtStart(NoAnswer { experiment, reason }) => {
                format!("{}: no answer with the values to start from: {reason}", name(*experiment))
            }
            Self::Frame { experiment, error } => not_moved(&name(*experiment), error),
            Self::Observation { experiment, observation, problem } => {
                misfit(&name(*experiment), *observation, problem)
            }
            Self::NotDriven { path, experiment } => not_driven(&name(*experiment), path),
            Self::NotConverged { experiment, step } => not_converged(&name(*experiment), *step),
            other => other.to_string(),
        }
    }

    pub(super) const fn no_answer(experiment: usize, reason: NoAnswerReason) -> Self {
        Self::NoAnswerAtStart(NoAnswer { experiment, reason })
    }
}

fn numbered(experiment: usize) -> String {
    format!("case {}", experiment + 1)
}

fn not_moved(name: &str, error: &RegistrationError) -> String {
    format!("{name}: the measurement cannot be moved onto the robot: {error}")
}

fn misfit(name: &str, observation: usize, problem: &Misfit) -> String {
    format!("{name}: measurement {}: {problem}", observation + 1)
}

fn not_driven(name: &str, path: &str) -> String {
    format!("{name}: {path}: the cable is not driven by that in every step")
}

fn not_converged(name: &str, step: Option<usize>) -> String {
    let step = step.map(|step| format!(", step {},", step + 1)).unwrap_or_default();
    format!(
        "without {name}{step} the fit does not converge: estimate less, or say what else is known"
    )
}

/// What does not fit about an observation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Misfit {
    /// A step that there is not.
    #[error("there is no step {}; the case has {steps}", step + 1)]
    Step {
        /// The step, from 0.
        step: usize,
        /// How many there are.
        steps: usize,
    },
    /// A disk that there is not.
    #[error("there is no disk {}; the robot has {disks}", disk + 1)]
    Disk {
        /// The disk, from 0.
        disk: usize,
        /// How many there are.
        disks: usize,
    },
    /// A place that is not on the backbone.
    #[error("arc length {value} m is not on the backbone, which is {length} m long")]
    ArcLength {
        /// What was given, in m.
        value: f64,
        /// Length of the backbone in m.
        length: f64,
    },
    /// A camera that there is not.
    #[error("there is no camera {}; the case has {cameras}", camera + 1)]
    Camera {
        /// The camera, from 0.
        camera: usize,
        /// How many there are.
        cameras: usize,
    },
    /// A number that is none, or a deviation that is not positive.
    #[error("{what} must be {must}, but is {value}")]
    Number {
        /// Which number.
        what: &'static str,
        /// What it must be.
        must: &'static str,
        /// What it is.
        value: f64,
    },
}

/// Where a model does not say what would be seen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("case {} has no answer: {reason}", experiment + 1)]
pub struct NoAnswer {
    /// The experiment, from 0.
    pub experiment: usize,
    /// Why.
    pub reason: NoAnswerReason,
}

/// Why a model does not say what would be seen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoAnswerReason {
    /// The model has no answer.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A camera does not see the marker.
    #[error("observation {}: {error}", observation + 1)]
    View {
        /// The observation, from 0.
        observation: usize,
        /// Why.
        error: ViewError,
    },
    /// The threads that were asked for could not be started.
    #[error(transparent)]
    Threads(#[from] NoThreads),
    /// A number is not finite.
    #[error("a residual is not finite")]
    NotFinite,
}
