//! The least eigenvalue of a quadratic form, by counting or following pivots.

use super::quadratic_form::{Element, symmetric};
use crate::solution::{Diagnostics, NoStability};

/// An eigenvalue this close to zero counts as zero.
pub(crate) const NEUTRAL: f64 = Diagnostics::NEUTRAL;
/// Relative accuracy of the eigenvalue.
pub(crate) const TOLERANCE: f64 = 1e-8;
/// Compliance added to each locked cable, relative to what the rod gives: it decides what counts as
/// zero where more cables are taut than lengths are independent.
pub(crate) const REGULARISATION: f64 = 1e-9;
/// Eigenvalues beyond this are not looked for.
pub(crate) const FAR: f64 = 1e12;
/// What dead moments may do to the least eigenvalue where they count as held.
pub(crate) const INSENSITIVE: f64 = 1e-6;
/// An eigenvalue greater than the greatest stiffness of the robot, relative to its metric, by this factor is
/// an artefact of rounding.
const IMPLAUSIBLE: f64 = 1e3;

/// An eigenvalue that the stiffness of the elements allows, or the reason why there is none. The least
/// eigenvalue cannot exceed the greatest one of fields that are zero but in the middle of one element.
pub(crate) fn plausible<'a>(
    value: f64,
    elements: impl Iterator<Item = &'a Element>,
) -> Result<f64, NoStability> {
    if value.abs() <= IMPLAUSIBLE {
        return Ok(value);
    }
    let ratio = |element: &Element| {
        let of_middle = symmetric(element.energy[1][1]);
        let [.., greatest] = of_middle.eigenvalues_relative_to(&symmetric(element.metric[1][1]))?;
        Some(greatest.abs())
    };
    let greatest = elements.filter_map(ratio).fold(1.0, f64::max);
    let is_possible = value.is_finite() && value <= IMPLAUSIBLE * greatest;
    if is_possible { Ok(value) } else { Err(NoStability::Undetermined) }
}

/// Bisection on whether there is an eigenvalue below a shift: monotone, so it cannot miss.
pub(crate) fn bisect(low: f64, high: f64, mut is_below: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut reach = high - low;
    while is_below(low) {
        (high, reach) = (low, 4.0 * reach);
        low -= reach;
        if low < -FAR {
            return f64::NEG_INFINITY;
        }
    }
    while !is_below(high) {
        (low, reach) = (high, 4.0 * reach);
        high += reach;
        if high > FAR {
            return f64::INFINITY;
        }
    }
    while high - low > TOLERANCE * (1.0 + low.abs().max(high.abs())) {
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// The zero of a function that falls, is concave, and has no value (`None`) from some place on, where it
/// counts as negative: a bracket is shrunk by chords that are kept from stalling (the Illinois
/// method), and halved where an end has no value.
pub(crate) fn falling_zero(low: f64, high: f64, mut f: impl FnMut(f64) -> Option<f64>) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut reach = high - low;
    let mut at_low = f(low);
    while at_low.is_none_or(|value| value < 0.0) {
        (high, reach) = (low, 4.0 * reach);
        low -= reach;
        if low < -FAR {
            return f64::NEG_INFINITY;
        }
        at_low = f(low);
    }
    let mut at_high = f(high);
    while at_high.is_some_and(|value| value >= 0.0) {
        (low, at_low, reach) = (high, at_high, 4.0 * reach);
        high += reach;
        if high > FAR {
            return f64::INFINITY;
        }
        at_high = f(high);
    }
    // Which end the last trial replaced: twice the same one, and the chord hangs on the other.
    let mut replaced_low = None;
    let tolerance = |low: f64, high: f64| TOLERANCE * (1.0 + low.abs().max(high.abs()));
    while high - low > tolerance(low, high) {
        let trial = match (at_low, at_high) {
            (Some(a), Some(b)) if a > 0.0 => {
                // A step beyond the zero closes the bracket from the other side.
                let chord = low + (high - low) * (a / (a - b));
                let margin = 0.5 * tolerance(low, high);
                chord.clamp(low + margin, high - margin)
            }
            _ => 0.5 * (low + high),
        };
        match f(trial) {
            Some(value) if value >= 0.0 => {
                if replaced_low == Some(true) {
                    at_high = at_high.map(|b| 0.5 * b);
                }
                (low, at_low, replaced_low) = (trial, Some(value), Some(true));
            }
            value => {
                if replaced_low == Some(false) {
                    at_low = at_low.map(|a| 0.5 * a);
                }
                (high, at_high, replaced_low) = (trial, value, Some(false));
            }
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use whipcord_numerics::Mat3;

    use super::*;

    fn element() -> Element {
        let mut element = Element::default();
        (element.energy[1][1], element.metric[1][1]) = (Mat3::IDENTITY * 3.0, Mat3::IDENTITY);
        element
    }

    /// Where no pivot ever turns negative the search for an eigenvalue ends beyond all of them.
    #[test]
    fn a_value_beyond_any_stiffness_is_none() {
        let elements = [element()];
        let of = |value: f64| plausible(value, elements.iter());
        assert_eq!(of(-2e5), Ok(-2e5));
        assert_eq!(of(2.5), Ok(2.5));
        assert_eq!(of(1.47e12), Err(NoStability::Undetermined));
        assert_eq!(of(bisect(0.0, 1.0, |_| false)), Err(NoStability::Undetermined));
        assert_eq!(of(falling_zero(0.0, 1.0, |_| Some(1.0))), Err(NoStability::Undetermined));
        assert_eq!(of(falling_zero(0.0, 1.0, |_| None)), Err(NoStability::Undetermined));
    }
}
