//! The numbers that are searched: what must be positive is sought by its logarithm, in which a product that
//! alone is seen, as `E d⁴`, is a straight valley.

use super::experiment::Unknown;

/// Between the unknowns `x` and what is searched, `y = 1 + ln(x/x₀)` of those that must be positive, and
/// `y = x` of the others.
pub(super) struct Logarithms(Vec<Option<f64>>);

impl Logarithms {
    pub(super) fn new(unknowns: &[Unknown], start: &[f64]) -> Self {
        let of = |(unknown, start): (&Unknown, &f64)| {
            (unknown.is_above_zero() && *start > 0.0).then_some(*start)
        };
        Self(unknowns.iter().zip(start).map(of).collect())
    }

    /// What is searched, of one unknown; at −∞ where it is not positive.
    pub(super) fn searched(&self, j: usize, x: f64) -> f64 {
        match self.0[j] {
            Some(start) if x > 0.0 => 1.0 + (x / start).ln(),
            Some(_) => f64::NEG_INFINITY,
            None => x,
        }
    }

    /// The unknowns.
    pub(super) fn unknowns(&self, y: &[f64], x: &mut [f64]) {
        for ((x, y), start) in x.iter_mut().zip(y).zip(&self.0) {
            *x = match start {
                Some(start) => start * (y - 1.0).exp(),
                None => *y,
            };
        }
    }

    /// One unknown, of what is searched.
    pub(super) fn value(&self, j: usize, y: f64) -> f64 {
        match self.0[j] {
            Some(start) => start * (y - 1.0).exp(),
            None => y,
        }
    }

    /// How unknown `j` changes with what is searched, where it is `x`.
    pub(super) fn slope(&self, j: usize, x: f64) -> f64 {
        if self.0[j].is_some() { x } else { 1.0 }
    }

    /// The interval that is this wide to both sides of `x` in what is searched.
    pub(super) fn interval(&self, j: usize, x: f64, half: f64) -> [f64; 2] {
        match self.0[j] {
            // Wider than any number it says nothing more.
            Some(_) => {
                let factor = (half / x).min(600.0).exp();
                [x / factor, (x * factor).min(f64::MAX)]
            }
            None => [x - half, x + half],
        }
    }
}
