//! Newton's method with a line search, for models that have none of their own.

use super::{DirectionOf, EquilibriumPath, Step};

const MAX_ITERATIONS: usize = 40;
const LEAST_FRACTION: f64 = 1.0 / 1024.0;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e-9;

/// From the state of a path, at its load or across a direction, to a residual of at most `tolerance`; the iterations and
/// what is left. `residual` evaluates the state; `None` where it cannot.
pub(crate) fn newton<P: EquilibriumPath>(
    path: &mut P,
    across: Option<&DirectionOf<P>>,
    tolerance: f64,
    residual: impl Fn(&mut P) -> Option<f64>,
) -> Option<(usize, f64)> {
    let step = across.map_or(Step::Close, Step::Across);
    let mut left = residual(path)?;
    for iteration in 0..MAX_ITERATIONS {
        if left <= tolerance {
            return Some((iteration, left));
        }
        if path.has_ended() {
            return None;
        }
        let from = path.state();
        let direction = path.direction(step)?;
        let mut fraction = 1.0;
        loop {
            path.step_from(&from, fraction, &direction);
            match residual(path) {
                Some(now) if now < (1.0 - 1e-4 * fraction) * left => {
                    left = now;
                    break;
                }
                Some(now) if fraction == 1.0 && now.max(left) <= ROUNDING => {
                    return Some((iteration + 1, now));
                }
                _ => {
                    fraction *= 0.5;
                    if fraction < LEAST_FRACTION {
                        return None;
                    }
                }
            }
        }
    }
    (left <= tolerance).then_some((MAX_ITERATIONS, left))
}
