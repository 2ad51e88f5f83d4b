//! The hot path: a section with one cable, by Newton's method on the four equations of its
//! minimum.

use whipcord_numerics::Sym3;

use super::bend::Bend;
use super::section::Section;

/// A solved section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    pub bend: Bend,
    /// Multiplier of the length in rad²/m, not negative: what the measure falls by per metre of
    /// cable given back.
    pub multiplier: f64,
    pub iterations: usize,
}

/// Steps allowed before the caller turns to the globalised method.
const MOST_STEPS: usize = 12;

/// Solves eq. (6) for the only cable of `section` at the length `target`, which is less than its
/// initial length. `None` when plain Newton steps from the guess do not lead to a minimum.
pub(super) fn solve(section: &Section, target: f64) -> Option<Solved> {
    let [passage] = &section.passages[..] else { return None };
    let (direction, rate) = section.guess?;
    if target <= 0.0 {
        return None;
    }
    let change = target - passage.initial;
    let mut bend = section.rest.moved(direction * change);
    let mut multiplier = rate * change;
    for iterations in 1..=MOST_STEPS {
        if !bend.is_valid() {
            return None;
        }
        let (measure, half) = section.with_one(passage, bend);
        // The constraint as ½(ℓ² − l²)/l = 0: near the solution it has the gradient of ℓ.
        let inverse = 1.0 / target;
        let g = half.gradient * inverse;
        let violation = half.value * inverse - 0.5 * target;
        // Adding the square of the constraint's gradient changes no solution, and makes the matrix
        // positive definite exactly when the solution is a minimum on the constraint.
        let scale = measure.hessian.xx + measure.hessian.yy;
        let square = g.norm_squared();
        if square == 0.0 {
            return None;
        }
        let penalty = scale / square;
        let matrix =
            measure.hessian + half.hessian * (multiplier * inverse) + Sym3::square(g) * penalty;
        let factors = matrix.ldlt()?;
        let residual = measure.gradient + g * multiplier;
        let (across, along) = (factors.solve(residual), factors.solve(g));
        let m = (violation - g.dot(across)) / g.dot(along);
        let step = -(across + along * m);
        multiplier += m - penalty * violation;
        bend = bend.moved(step);
        // The error after a Newton step is of the order of the step squared.
        if step.max_abs() < 2e-7 {
            let length = passage.length_only(&bend.turn(), section.length, section.chord);
            if (length - target).abs() <= 1e-13 * passage.initial && bend.is_valid() {
                return (multiplier >= 0.0).then_some(Solved { bend, multiplier, iterations });
            }
        }
    }
    None
}
