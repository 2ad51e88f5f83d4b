//! Minima at corners: where a cable with friction begins or ceases to slide in a row, what would be seen has a corner, beyond which the derivatives no longer
//! hold. A search that follows them can then stop short of the minimum. It goes on from a lower point beyond, where there is one.

use whipcord_numerics::SingularValues;
use whipcord_numerics::least_squares::{
    NoResiduals, Options, Outcome, Status, Workspace, minimise,
};

use super::error::NoAnswer;
use super::problem::Problem;

/// How far from the end of a search lower points are looked for along each principal axis, in standard deviations. Where there is none,
/// the end is a minimum to the last of these: beyond what is known of the estimates.
const REACHES: [f64; 5] = [1.0, 0.3, 0.1, 0.03, 0.01];
/// A lower point counts if it is lower by this part of what a parabola would be higher there.
const GAIN: f64 = 0.01;
/// So often a search goes on.
const ROUNDS: usize = 30;

/// [`minimise`], from where it stops at a corner too.
pub(super) fn search(
    problem: &mut Problem<'_, '_>,
    searched: &mut [f64],
    options: &Options,
    workspace: &mut Workspace,
) -> Result<Outcome<NoAnswer>, NoResiduals<NoAnswer>> {
    let mut outcome = minimise(problem, searched, options, workspace)?;
    for _ in 0..ROUNDS {
        if !matches!(outcome.status, Status::Stalled | Status::Refused) {
            break;
        }
        let Some(lower) = lower_beside(problem, searched, options, workspace, &mut outcome) else {
            // To what is known of the estimates nothing is lower.
            if outcome.status == Status::Stalled {
                outcome.status = Status::Step;
            }
            break;
        };
        searched.copy_from_slice(&lower);
        let again = minimise(problem, searched, options, workspace)?;
        outcome = Outcome {
            iterations: outcome.iterations + again.iterations,
            evaluations: outcome.evaluations + again.evaluations,
            ..again
        };
    }
    Ok(outcome)
}

/// The lowest of the points along the principal axes at the farthest reach at which one is lower than the end of a search.
fn lower_beside(
    problem: &Problem<'_, '_>,
    searched: &[f64],
    options: &Options,
    workspace: &Workspace,
    outcome: &mut Outcome<NoAnswer>,
) -> Option<Vec<f64>> {
    let n = searched.len();
    let jacobian = workspace.jacobian();
    let norms: Vec<f64> = (0..n)
        .map(|j| jacobian.iter().skip(j).step_by(n).map(|x| x * x).sum::<f64>().sqrt())
        .collect();
    let kept: Vec<usize> = (0..n).filter(|j| norms[*j] > 0.0).collect();
    let scaled: Vec<f64> =
        jacobian.chunks_exact(n).flat_map(|row| kept.iter().map(|&j| row[j] / norms[j])).collect();
    let axes = SingularValues::of(kept.len(), &scaled);
    let freedom = workspace.residuals().len().saturating_sub(n).max(1) as f64;
    let deviation = (2.0 * outcome.cost / freedom).sqrt();
    for reach in REACHES {
        // A parabola is half the square of the reach higher, in units of the variance.
        let least = GAIN * 0.5 * (reach * deviation).powi(2);
        let mut best: Option<(Vec<f64>, f64)> = None;
        for (k, &value) in axes.values.iter().enumerate().filter(|(_, value)| **value > 0.0) {
            for sign in [-1.0, 1.0] {
                let mut trial = searched.to_vec();
                for (&j, part) in kept.iter().zip(axes.direction(k)) {
                    let moved = trial[j] + sign * reach * deviation * part / (value * norms[j]);
                    let (low, high) = (options.lower.get(j), options.upper.get(j));
                    let moved = moved.max(*low.unwrap_or(&f64::NEG_INFINITY));
                    trial[j] = moved.min(*high.unwrap_or(&f64::INFINITY));
                }
                outcome.evaluations += 1;
                let Some(cost) = problem.cost(&trial, options.loss) else { continue };
                let lowest = best.as_ref().map_or(outcome.cost - least, |(_, cost)| *cost);
                if cost < lowest {
                    best = Some((trial, cost));
                }
            }
        }
        if let Some((trial, _)) = best {
            return Some(trial);
        }
    }
    None
}
