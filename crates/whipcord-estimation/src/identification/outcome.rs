//! What is said of a fit.

use whipcord_numerics::least_squares::{NoResiduals, Status, Workspace};
use whipcord_numerics::student_quantile;

use super::columns::DerivativeMethod;
use super::error::{IdentifyError, NoAnswer};
use super::forward::Forward;
use super::logarithm::Logarithms;
use super::noise::Fitted;
use super::unresolved::Unresolved;
use super::{Settings, Unknown};
use crate::uncertainty::Spread;
use whipcord::case::Case;
use whipcord::kind::ModelKind;
use whipcord::robot::Robot;

/// What was found.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The model.
    pub model: ModelKind,
    /// How the search ended. Where it has not converged, the estimates are the best that were met.
    pub status: Status,
    /// Steps of the search.
    pub iterations: usize,
    /// How often all shapes were computed, not counting those for differences.
    pub evaluations: usize,
    /// What kept the last step that was shortened from an answer.
    pub refusal: Option<NoAnswer>,
    /// The unknowns, in their order.
    pub estimates: Vec<Estimate>,
    /// Correlation of each estimate with each, by rows; none where one of them is not sure at all.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// How large the noise is.
    pub noise: Noise,
    /// What is left of each observation, in their order.
    pub residuals: Vec<Residual>,
    /// How many answers, one for each step in which something was seen, the measurements are compared with.
    pub answers: usize,
    /// Which of these answers are unstable equilibria at the estimates: a real robot leaves them, so that it was
    /// hardly measured in them.
    pub unstable: Vec<Unstable>,
    /// Root mean square distance in m of the markers whose position was seen from where the model has them.
    pub rms_distance: Option<f64>,
    /// The same in pixels of those that were seen in images.
    pub rms_pixels: Option<f64>,
    /// What the measurements cannot tell apart.
    pub unresolved: Vec<Unresolved>,
    /// Akaike's criterion, up to a constant of the measurements; none where nothing is left of the noise.
    pub aic: Option<f64>,
    /// The Bayesian criterion, up to the same constant.
    pub bic: Option<f64>,
    /// The robot with the estimates that all experiments share.
    pub robot: Robot,
    /// Its case in each experiment.
    pub cases: Vec<Case>,
}

/// An estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// What it is.
    pub unknown: Unknown,
    /// Its value in SI.
    pub value: f64,
    /// Standard deviation; none where the measurements say nothing of it, and at a bound.
    pub deviation: Option<f64>,
    /// Interval that holds the true value with the probability asked for; of what must be positive it is
    /// symmetric in the logarithm.
    pub interval: Option<[f64; 2]>,
    /// Whether it lies at a bound.
    pub is_at_bound: bool,
    /// Whether derivatives by it were differences of answers, else exact.
    pub by_differences: bool,
}

/// How large the noise is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of each number, in m or pixels, where it is estimated; else how many times as large
    /// as they say the deviations of the observations turn out to be.
    pub level: f64,
    /// Whether it is estimated.
    pub is_estimated: bool,
    /// Degrees of freedom: numbers and priors less unknowns.
    pub freedom: usize,
}

/// An unstable equilibrium that measurements are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unstable {
    /// The experiment, from 0.
    pub experiment: usize,
    /// The step, from 0.
    pub step: usize,
    /// [`whipcord::Diagnostics::stability`], which is negative.
    pub stability: f64,
}

/// What is left of one observation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The experiment, from 0.
    pub experiment: usize,
    /// The observation, from 0 within it.
    pub observation: usize,
    /// What the model says less what was seen: x, y and z in m, or column and row in pixels and 0.
    pub difference: [f64; 3],
    /// Weight that a robust loss gave it, from 0 to 1.
    pub weight: f64,
}

impl Residual {
    /// How far off, in m or pixels.
    #[must_use]
    pub fn distance(&self) -> f64 {
        let [x, y, z] = self.difference;
        x.hypot(y).hypot(z)
    }
}

pub(super) fn tell(
    forward: &mut Forward<'_>,
    x: &[f64],
    (scales, logarithms): (&[f64], &Logarithms),
    fitted: &Fitted,
    settings: &Settings,
    workspace: &Workspace,
) -> Result<Identified, IdentifyError> {
    let (answers, unstable) = forward.stability(x);
    let forward = &*forward;
    let unknowns = forward.unknowns;
    let n = unknowns.len();
    // What is sought by its logarithm is at a bound to rounding.
    let meets =
        |value: f64, bound: f64| bound.is_finite() && (value - bound).abs() <= 1e-14 * bound.abs();
    let at_bound = |(unknown, value): (&Unknown, &f64)| {
        meets(*value, unknown.least()) || meets(*value, unknown.greatest())
    };
    let is_at_bound: Vec<bool> = unknowns.iter().zip(x).map(at_bound).collect();
    let by_differences = |j: usize| {
        forward.methods.iter().any(|means| means[j] == Some(DerivativeMethod::Differences))
    };
    let any = (0..n).any(by_differences);
    let free: Vec<bool> = is_at_bound.iter().map(|bound| !bound).collect();
    let mut jacobian = workspace.jacobian().to_vec();
    for row in jacobian.chunks_exact_mut(n) {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry /= logarithms.slope(j, x[j]);
        }
    }
    let spread = Spread::of(&jacobian, &free, fitted.spread, any);
    let quantile = student_quantile(0.5 + 0.5 * settings.confidence, fitted.freedom);
    let estimates = (0..n)
        .map(|j| Estimate {
            unknown: unknowns[j].clone(),
            value: x[j],
            deviation: spread.deviations[j],
            interval: spread.deviations[j]
                .map(|deviation| logarithms.interval(j, x[j], quantile * deviation)),
            is_at_bound: is_at_bound[j],
            by_differences: by_differences(j),
        })
        .collect();
    let sizes: Vec<f64> = (0..n)
        .map(|j| if unknowns[j].quantity.is_positive() && x[j] > 0.0 { x[j] } else { scales[j] })
        .collect();
    let unresolved = spread.weak.iter().map(|weak| Unresolved::of(weak, unknowns, x, &sizes));
    let count = forward.count();
    let residuals = residuals(forward, fitted, workspace);
    let rms = |pixels: bool| {
        let of = residuals.iter().filter(|residual| {
            let experiment = &forward.experiments[residual.experiment];
            let seen = experiment.observations[residual.observation].seen;
            seen.is_in_image() == pixels
        });
        let (sum, count) =
            of.fold((0.0, 0.0), |(sum, count), of| (sum + of.distance().powi(2), count + 1.0));
        (count > 0.0).then(|| (sum / count).sqrt())
    };
    let priors = unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
    let freedom = count + priors - n;
    let level = match fitted.is_estimated {
        true => fitted.noise,
        false => {
            let sum: f64 = workspace.residuals().iter().map(|r| r * r).sum();
            (sum / freedom.max(1) as f64).sqrt()
        }
    };
    let numbers = (n + usize::from(fitted.is_estimated)) as f64;
    let mut cases = Vec::with_capacity(forward.experiments.len());
    let mut robot = None;
    for experiment in 0..forward.experiments.len() {
        let built = forward
            .built(experiment, x)
            .map_err(|reason| IdentifyError::NoAnswerAtStart(NoAnswer { experiment, reason }))?;
        robot.get_or_insert(built.0);
        cases.push(built.1);
    }
    Ok(Identified {
        model: forward.kind(),
        status: fitted.outcome.status,
        iterations: fitted.outcome.iterations,
        evaluations: fitted.outcome.evaluations,
        refusal: match &fitted.outcome.refusal {
            Some(NoResiduals::Refused(answer)) => Some(answer.clone()),
            _ => None,
        },
        estimates,
        correlations: spread.correlations,
        noise: Noise { level, is_estimated: fitted.is_estimated, freedom },
        rms_distance: rms(false),
        rms_pixels: rms(true),
        unresolved: unresolved.collect(),
        aic: fitted.deviance.map(|deviance| deviance + 2.0 * numbers),
        bic: fitted.deviance.map(|deviance| deviance + (count as f64).ln() * numbers),
        robot: robot.unwrap_or_else(|| forward.robot.clone()),
        cases,
        residuals,
        answers,
        unstable,
    })
}

fn residuals(forward: &Forward<'_>, fitted: &Fitted, workspace: &Workspace) -> Vec<Residual> {
    let mut row = 0;
    let mut residuals = Vec::new();
    for (experiment, of) in forward.experiments.iter().enumerate() {
        for (observation, seen) in of.observations.iter().enumerate() {
            let mut difference = [0.0; 3];
            let scale = seen.deviation.unwrap_or(fitted.unit);
            for (to, from) in
                difference.iter_mut().zip(&workspace.residuals()[row..row + seen.numbers()])
            {
                *to = from * scale;
            }
            let weight = workspace.weights()[row];
            residuals.push(Residual { experiment, observation, difference, weight });
            row += seen.numbers();
        }
    }
    residuals
}
