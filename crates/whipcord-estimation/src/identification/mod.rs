//! What a robot is, from what was seen of it: estimates of its parameters with their uncertainty (see
//! `docs/theory/identification.md`, whose equations the code names).
//!
//! An [`Experiment`] is a case and what was seen of the robot in its steps; the robot is the same in all of
//! them. An [`Unknown`] is a number of the robot, which all experiments share, or one of a single case,
//! such as where its base was. [`identify`] finds the unknowns under which a model comes nearest to what was
//! seen, and says how sure they are and which of them the measurements cannot tell apart.
//!
//! `quantity` is what can be estimated, `forward` computes what a model says would be seen, `columns` how that
//! changes; `problem` is the least-squares problem, `noise` weighs it; `crate::uncertainty` and `unresolved` say what the
//! estimates are worth; `validation` and `selection` compare what was fitted with what was not.

mod build;
mod check;
mod columns;
mod error;
mod forward;
mod logarithm;
mod noise;
mod outcome;
mod problem;
mod quantity;
mod selection;
mod unresolved;
mod validation;

use whipcord_numerics::least_squares::{Loss, Options, Workspace};

use crate::camera::Camera;
use crate::observation::Observation;
use whipcord::case::Case;
use whipcord::model::Model;
use whipcord::robot::Robot;

pub use self::error::{IdentifyError, Misfit, NoAnswer, NoAnswerReason};
pub use self::outcome::{Estimate, Identified, Noise, Residual, Unstable};
pub use self::quantity::{Quantity, UnknownQuantity};
pub use self::selection::{Compared, compare_models};
pub use self::unresolved::{Share, Unresolved};
pub use self::validation::{Fold, Validated, cross_validate};
pub use whipcord_numerics::least_squares::Status;

/// A case, and what was seen of the robot in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// What was asked of the robot, in one or several steps ([`Case::steps`]).
    pub case: Case,
    /// The cameras that pixels are of.
    pub cameras: Vec<Camera>,
    /// What was seen.
    pub observations: Vec<Observation>,
}

/// A number that is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// What it is.
    pub quantity: Quantity,
    /// The number of the one experiment that it belongs to; else all share it.
    pub experiment: Option<usize>,
    /// Where to start; else where robot and case have it.
    pub start: Option<f64>,
    /// Least and greatest value; infinite where there are none.
    pub bounds: [f64; 2],
    /// What is known of it besides.
    pub prior: Option<Prior>,
}

impl Unknown {
    /// One that all experiments share, without bounds.
    #[must_use]
    pub const fn new(quantity: Quantity) -> Self {
        let bounds = [f64::NEG_INFINITY, f64::INFINITY];
        Self { quantity, experiment: None, start: None, bounds, prior: None }
    }

    /// One of a single experiment.
    #[must_use]
    pub const fn of(quantity: Quantity, experiment: usize) -> Self {
        Self { experiment: Some(experiment), ..Self::new(quantity) }
    }

    /// Whether it plays a part in an experiment.
    fn is_of(&self, experiment: usize) -> bool {
        self.experiment.is_none_or(|only| only == experiment)
    }
}

/// What is known of a number before anything is measured: the normal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// How much observations count that are far off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Robustness {
    /// All by their square.
    #[default]
    Squares,
    /// Those beyond the noise linearly: [`Loss::Huber`].
    Huber,
    /// The same, smoothly: [`Loss::SoftL1`].
    SoftL1,
    /// Those far beyond the noise hardly at all: [`Loss::Cauchy`].
    Cauchy,
}

impl Robustness {
    /// The loss of residuals whose deviation is 1. Of markers that only noise moves, it counts nearly all by
    /// nearly their square.
    const fn loss(self) -> Loss {
        match self {
            Self::Squares => Loss::Squares,
            Self::Huber => Loss::Huber { scale: 2.8 },
            Self::SoftL1 => Loss::SoftL1 { scale: 2.8 },
            Self::Cauchy => Loss::Cauchy { scale: 4.0 },
        }
    }
}

/// How to estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The model, with its options; where it gives the shape is of no effect.
    pub model: Model,
    /// How much observations count that are far off.
    pub robustness: Robustness,
    /// Probability that an interval of confidence holds the true value.
    pub confidence: f64,
    /// Steps that the iteration may take.
    pub iterations: usize,
}

impl Settings {
    /// Least squares with a model, 95 % confidence.
    #[must_use]
    pub const fn new(model: Model) -> Self {
        Self { model, robustness: Robustness::Squares, confidence: 0.95, iterations: 100 }
    }
}

/// Estimates the unknowns.
///
/// ```
/// use whipcord_estimation::identification::{Experiment, Quantity, Settings, Unknown, identify};
/// use whipcord::{
///     Backbone, Cable, Case, Disks, Material, Model, ModelKind, Parameter, Robot, Routing,
///     Section, Statics, Vec3,
/// };
/// use whipcord_estimation::{Observation, Place, Seen};
/// # let robot = |young: f64| {
/// #     let backbone = Backbone {
/// #         section: Some(Section::circle(0.003)),
/// #         material: Material { young_modulus: Some(young), poisson_ratio: Some(0.3), ..Default::default() },
/// #         ..Backbone::new(0.18)
/// #     };
/// #     let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// #     Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])
/// # };
/// // The real robot is stiffer than its file says: 1.3 GPa.
/// let (real, file) = (robot(1.3e9)?, robot(1.1e9)?);
/// let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
/// let case = Case::with_tensions(&[3.0]);
/// let seen = model.solve(&real, &case)?;
/// let observations = (0..10).map(|disk| Observation {
///     step: 0,
///     place: Place::Disk(disk),
///     offset: Vec3::ZERO,
///     // Seen to 0.1 mm.
///     seen: Seen::Position(seen.disks.poses[disk].position + Vec3::new(1e-4, 0.0, 0.0) * (-1f64).powi(disk as i32)),
///     deviation: None,
/// });
/// let experiment = Experiment { case, cameras: Vec::new(), observations: observations.collect() };
/// let unknown = Unknown::new(Quantity::Parameter(Parameter::YoungModulus));
/// let found = identify(&file, &[experiment], &[unknown], &Settings::new(model))?;
/// let young = &found.estimates[0];
/// assert!((young.value - 1.3e9).abs() < 5e6);
/// assert!(young.interval.is_some_and(|[low, high]| low < 1.3e9 && 1.3e9 < high));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentifyError`] where the measurements are not enough or contradict robot and case, where an unknown is
/// none of the robot's, and where the model has no answer at the start.
pub fn identify(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Identified, IdentifyError> {
    let found = search(robot, experiments, unknowns, settings);
    // What a search that was broken off says is of no use.
    if settings.model.cancel().is_cancelled() { Err(IdentifyError::Cancelled) } else { found }
}

fn search(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Identified, IdentifyError> {
    check::check(robot, experiments, unknowns, settings)?;
    let mut forward = forward::Forward::new(robot, experiments, unknowns, settings)?;
    let mut x = forward.start()?;
    let scales = forward.scales(&x);
    let mut workspace = Workspace::default();
    let logarithms = logarithm::Logarithms::new(unknowns, &x);
    let bound = |of: fn(&Unknown) -> f64| {
        unknowns
            .iter()
            .enumerate()
            .map(|(j, unknown)| logarithms.searched(j, of(unknown)))
            .collect()
    };
    let options = Options {
        lower: bound(Unknown::least),
        upper: bound(Unknown::greatest),
        iterations: settings.iterations,
        ..Options::default()
    };
    let mut problem = problem::Problem::new(&mut forward, &logarithms, &scales);
    let fitted = noise::fit(&mut problem, &mut x, &options, settings.robustness, &mut workspace)?;
    outcome::tell(&mut forward, &x, (&scales, &logarithms), &fitted, settings, &workspace)
}

impl Unknown {
    fn least(&self) -> f64 {
        self.bounds[0].max(self.quantity.range()[0])
    }

    fn greatest(&self) -> f64 {
        self.bounds[1].min(self.quantity.range()[1])
    }
}
