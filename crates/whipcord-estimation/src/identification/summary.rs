//! From the end of a search to what is said of it.

use whipcord_numerics::least_squares::{NoResiduals, Workspace};
use whipcord_numerics::student_quantile;

use super::error::{IdentifyError, NoAnswer};
use super::experiment::{Experiment, Unknown};
use super::forward::Forward;
use super::logarithm::Logarithms;
use super::noise::Fitted;
use super::outcome::{Estimate, Identified, Noise, Residual, Starts};
use super::settings::Settings;
use super::unresolved::Unresolved;
use crate::uncertainty::Spread;

/// What measurements tell of an unknown by itself with a deviation of more than so many times its size is rounding.
const UNTOLD: f64 = 10.0;

pub(super) fn tell(
    forward: &Forward<'_>,
    x: &[f64],
    (scales, logarithms): (&[f64], &Logarithms),
    fitted: &Fitted,
    settings: &Settings,
    workspace: &Workspace,
) -> Result<Identified, IdentifyError> {
    let (answers, unstable) = forward.stability(x);
    let frames = (0..forward.experiments.len()).map(|e| forward.view(e, x).frame).collect();
    let body = |(e, of): (usize, &Experiment)| {
        let turns = of.observations.iter().any(|seen| seen.seen.is_rotation());
        turns.then(|| forward.view(e, x).body)
    };
    let bodies = forward.experiments.iter().enumerate().map(body).collect();
    let unknowns = forward.unknowns;
    let n = unknowns.len();
    // What is sought by its logarithm is at a bound to rounding.
    let meets =
        |value: f64, bound: f64| bound.is_finite() && (value - bound).abs() <= 1e-14 * bound.abs();
    let at_bound = |(unknown, value): (&Unknown, &f64)| {
        meets(*value, unknown.least()) || meets(*value, unknown.greatest())
    };
    let is_at_bound: Vec<bool> = unknowns.iter().zip(x).map(at_bound).collect();
    let by_differences =
        |j: usize| forward.pieces.iter().any(|piece| forward.is_by_differences(piece, j, x[j]));
    let any = (0..n).any(by_differences);
    let free: Vec<bool> = is_at_bound.iter().map(|bound| !bound).collect();
    let mut jacobian = workspace.jacobian().to_vec();
    for row in jacobian.chunks_exact_mut(n) {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry /= logarithms.slope(j, x[j]);
        }
    }
    let sizes: Vec<f64> = (0..n)
        .map(|j| if unknowns[j].is_positive() && x[j] > 0.0 { x[j] } else { scales[j] })
        .collect();
    // Of what may be zero the value itself says no size.
    let seen = (0..n)
        .map(|j| if unknowns[j].is_above_zero() { sizes[j] } else { sizes[j].max(scales[j]) });
    forget_unseen(&mut jacobian, &seen.collect::<Vec<f64>>(), fitted.spread);
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
    let unresolved = |weak| Unresolved::of(weak, forward.experiments, unknowns, x, &sizes);
    let unresolved = spread.weak.iter().map(unresolved);
    let count = forward.count();
    let residuals = residuals(forward, fitted, workspace);
    let rms = |pixels: bool| {
        let of = residuals.iter().filter(|residual| {
            let experiment = &forward.experiments[residual.experiment];
            let seen = experiment.observations[residual.observation].seen;
            !seen.is_rotation() && seen.is_in_image() == pixels
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
        frames,
        bodies,
        starts: Starts { tried: 1, agree: 1 },
        residuals,
        skipped: Vec::new(),
        over_determined: forward.missed(&forward.over_determined_rows(), x),
        robustness: settings.robustness,
        answers,
        unstable,
    })
}

/// Unknowns of which the measurements tell nothing have no column in the Jacobian, by rows, where the covariance of what it was weighed to is `spread` times the unit
/// matrix.
fn forget_unseen(jacobian: &mut [f64], sizes: &[f64], spread: f64) {
    let n = sizes.len();
    for (j, size) in sizes.iter().enumerate() {
        let column = || jacobian.iter().skip(j).step_by(n);
        let norm = column().map(|x| x * x).sum::<f64>().sqrt();
        if spread.sqrt() > UNTOLD * size * norm {
            jacobian.iter_mut().skip(j).step_by(n).for_each(|x| *x = 0.0);
        }
    }
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
