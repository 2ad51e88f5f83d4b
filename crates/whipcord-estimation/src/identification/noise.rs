//! The fit, and how large the noise is.

use whipcord_numerics::least_squares::{
    Loss, Negligible, NoResiduals, Options, Outcome, Residuals, Status, Workspace,
};

use super::corners;
use super::error::{IdentifyError, NoAnswer, NoAnswerReason};
use super::problem::Problem;
use super::settings::Robustness;

/// How a fit ended.
pub(super) struct Fitted {
    pub(super) outcome: Outcome<NoAnswer>,
    /// In m or pixels where it is estimated, else 1.
    pub(super) noise: f64,
    pub(super) is_estimated: bool,
    /// What 1 is in the residuals of the workspace whose observations do not say their deviation, in m or
    /// pixels.
    pub(super) unit: f64,
    /// Degrees of freedom; infinite where the noise is known.
    pub(super) freedom: f64,
    /// What the covariance is of `(JᵀJ)⁻¹` in units of the noise, eq. (i6).
    pub(super) spread: f64,
    /// `−2 ln` of the likelihood, without what does not depend on the model; none where nothing is left
    /// of the noise.
    pub(super) deviance: Option<f64>,
}

/// How often noise and unknowns are estimated in turn, and how near two estimates of the noise are then.
const ROUNDS: usize = 30;
const NEAR: f64 = 1e-4;
/// As near to both a robust fit comes before its own loss counts, of the noise and of the deviation of the estimates.
const FIRST: f64 = 0.1;
/// Of what is normally distributed, the deviation is this many times the median of the sizes.
const MEDIAN: f64 = 1.482_602_218_505_602;

/// The search ends where the linearised problem moves no estimate by more than this part of its standard deviation. In a valley so curved
/// that steps are far shorter, it ends at `√CURVED` times as much.
const PART_OF_DEVIATION: f64 = 0.01;

/// Noise below this share of the numbers that were seen is lost in rounding.
const LEAST: f64 = 1e-13;

pub(super) fn fit(
    problem: &mut Problem<'_, '_>,
    x: &mut [f64],
    options: &Options,
    robustness: Robustness,
    workspace: &mut Workspace,
) -> Result<Fitted, IdentifyError> {
    let (seen, priors) = (problem.seen(), problem.priors());
    // Where the noise is not known there is at least one, which `check` sees to.
    let freedom = (seen + priors - problem.unknowns()) as f64;
    let loss = robustness.loss();
    let squares = robustness == Robustness::Squares;
    let squared = PART_OF_DEVIATION * PART_OF_DEVIATION;
    let of_noise = Options { negligible: Negligible::Cost(0.5 * squared), ..options.clone() };
    if problem.is_noise_known() {
        let outcome = run(problem, x, &of_noise, loss, workspace)?;
        let residuals = workspace.residuals();
        return Ok(Fitted {
            outcome,
            noise: 1.0,
            is_estimated: false,
            unit: 1.0,
            freedom: f64::INFINITY,
            spread: spread(problem, residuals, loss, seen as f64),
            deviance: Some(deviance(problem, residuals, loss)),
        });
    }
    let least = LEAST * problem.extent();
    if squares && priors == 0 {
        // Least squares do not depend on the noise.
        let negligible = Negligible::PartOfCost(squared / freedom);
        let options = Options { negligible, ..options.clone() };
        let outcome = run(problem, x, &options, Loss::Squares, workspace)?;
        let sum = 2.0 * outcome.cost;
        let noise = (sum / freedom).sqrt();
        let count = seen as f64;
        return Ok(Fitted {
            outcome,
            noise,
            is_estimated: true,
            unit: 1.0,
            freedom,
            spread: noise * noise,
            deviance: (noise > least).then(|| count * ((sum / count).ln() + 1.0)),
        });
    }
    let mut residuals = vec![0.0; problem.count()];
    let searched = problem.searched(x);
    problem.residuals(&searched, &mut residuals).map_err(IdentifyError::NoAnswerAtStart)?;
    let mut noise = level(&residuals[..seen], freedom, squares);
    // Least squares would be led away by what is far off, and a loss that hardly counts that may keep to the rows that are near at the start:
    // first it is Huber's, as near to the minimum as the noise is known.
    let near = Options { negligible: Negligible::Cost(0.5 * FIRST * FIRST), ..options.clone() };
    let mut is_first = !squares;
    let mut rounds = 0;
    loop {
        noise = noise.max(least);
        problem.set_noise(noise);
        let (own, options) = match is_first {
            true => (Robustness::Huber.loss(), &near),
            false => (loss, &of_noise),
        };
        let mut outcome = run(problem, x, options, own, workspace)?;
        let residuals = workspace.residuals();
        let next = (noise * level(&residuals[..seen], freedom, squares)).max(least);
        let is_settled = (next / noise - 1.0).abs() < NEAR;
        rounds += 1;
        if is_first {
            is_first = (next / noise - 1.0).abs() > FIRST && rounds < ROUNDS / 2;
            noise = next;
            continue;
        }
        if !is_settled && rounds < ROUNDS {
            noise = next;
            continue;
        }
        if !is_settled {
            outcome.status = Status::IterationLimit;
        }
        return Ok(Fitted {
            outcome,
            noise,
            is_estimated: true,
            unit: noise,
            freedom,
            spread: if squares { 1.0 } else { spread(problem, residuals, loss, freedom) },
            deviance: (noise > least)
                .then(|| 2.0 * seen as f64 * noise.ln() + deviance(problem, residuals, loss)),
        });
    }
}

fn run(
    problem: &mut Problem<'_, '_>,
    x: &mut [f64],
    options: &Options,
    loss: Loss,
    workspace: &mut Workspace,
) -> Result<Outcome<NoAnswer>, IdentifyError> {
    let options = Options { loss, ..options.clone() };
    let mut searched = problem.searched(x);
    let outcome = corners::search(problem, &mut searched, &options, workspace);
    problem.found(&searched, x);
    outcome.map_err(|refusal| {
        IdentifyError::NoAnswerAtStart(match refusal {
            NoResiduals::Refused(answer) => answer,
            NoResiduals::NotFinite => NoAnswer { experiment: 0, reason: NoAnswerReason::NotFinite },
        })
    })
}

/// The deviation of residuals, eq. (i5): by their squares, or by the median of their sizes, which wrong ones
/// hardly move.
fn level(residuals: &[f64], freedom: f64, squares: bool) -> f64 {
    let count = residuals.len() as f64;
    if squares {
        return (residuals.iter().map(|r| r * r).sum::<f64>() / freedom).sqrt();
    }
    let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    let median = median(&mut sizes).unwrap_or_default();
    MEDIAN * median * (count / freedom).sqrt()
}

/// The median; `None` of nothing. Sorts the values.
pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let [below, above] = [values.len().checked_sub(1)? / 2, values.len() / 2];
    Some(0.5 * (values[below] + values[above]))
}

/// `Σ ρ` over what was seen.
fn deviance(problem: &Problem<'_, '_>, residuals: &[f64], loss: Loss) -> f64 {
    problem.blocks(residuals).map(|block| loss.of(square(block)).0).sum()
}

/// Eq. (i7), of an estimate by a loss (Huber and Ronchetti, Robust Statistics, 2nd ed. (2009), chapter 7); 1
/// for squares of residuals whose deviation is 1.
fn spread(problem: &Problem<'_, '_>, residuals: &[f64], loss: Loss, freedom: f64) -> f64 {
    if loss == Loss::Squares {
        return 1.0;
    }
    let (mut influence, mut slope) = (0.0, 0.0);
    for block in problem.blocks(residuals) {
        let square = square(block);
        let (_, weight) = loss.of(square);
        influence += weight * weight * square;
        slope += block.len() as f64 * weight + 2.0 * loss.curvature(square) * square;
    }
    let slope = slope / problem.seen() as f64;
    influence / freedom / (slope * slope)
}

fn square(block: &[f64]) -> f64 {
    block.iter().map(|r| r * r).sum()
}
