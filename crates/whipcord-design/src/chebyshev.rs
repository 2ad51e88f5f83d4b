//! Polynomials in the arc length by their values at the zeros of a Chebyshev polynomial, which lie densely at the ends.

use core::f64::consts::PI;

/// Where the values are given, as parts of the length from 0 to 1, in descending order.
pub(crate) fn places(count: usize) -> impl Iterator<Item = f64> {
    angles(count).map(|angle| 0.5 * (1.0 + angle.cos()))
}

fn angles(count: usize) -> impl Iterator<Item = f64> {
    #[allow(clippy::cast_precision_loss, reason = "low degrees")]
    (0..count).map(move |k| (k as f64 + 0.5) * PI / count as f64)
}

/// The coefficients of the interpolant in ascending powers of the arc length.
pub(crate) fn powers(values: &[f64], length: f64) -> Vec<f64> {
    let n = values.len();
    #[allow(clippy::cast_precision_loss, reason = "low degrees")]
    let coefficients: Vec<f64> = (0..n)
        .map(|order| {
            let sum: f64 = angles(n)
                .zip(values)
                .map(|(angle, value)| value * (order as f64 * angle).cos())
                .sum();
            let factor = if order == 0 { 1.0 } else { 2.0 };
            factor * sum / n as f64
        })
        .collect();
    // T₀ = 1, T₁ = x, Tₙ₊₁ = 2 x Tₙ − Tₙ₋₁ with x = 2 s/L − 1, in powers of s/L.
    let times_x = |of: &[f64]| {
        let mut out = vec![0.0; of.len() + 1];
        for (k, c) in of.iter().enumerate() {
            out[k] -= c;
            out[k + 1] += 2.0 * c;
        }
        out
    };
    let mut sum = vec![0.0; n];
    let (mut before, mut now) = (vec![1.0], vec![-1.0, 2.0]);
    for (order, coefficient) in coefficients.iter().enumerate() {
        let of = if order == 0 { &before } else { &now };
        sum.iter_mut().zip(of).for_each(|(sum, c)| *sum += coefficient * c);
        if order > 0 {
            let mut next: Vec<f64> = times_x(&now).iter().map(|c| 2.0 * c).collect();
            next.iter_mut().zip(&before).for_each(|(next, c)| *next -= c);
            before = core::mem::replace(&mut now, next);
        }
    }
    let mut power = 1.0;
    for c in &mut sum {
        *c /= power;
        power *= length;
    }
    sum
}

/// The coefficients of the interpolant that is one at a node and zero at the others.
pub(crate) fn of_node(node: usize, nodes: usize, length: f64) -> Vec<f64> {
    let mut unit = vec![0.0; nodes];
    unit[node] = 1.0;
    powers(&unit, length)
}

/// The value of a polynomial in ascending powers.
pub(crate) fn value(powers: &[f64], at: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, c| sum * at + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_powers_are_those_of_one_polynomial() {
        let exact = [0.3, -2.0, 5.0, 1.0, -7.0];
        let length = 0.2;
        let values: Vec<f64> = places(5).map(|part| value(&exact, part * length)).collect();
        let found = powers(&values, length);
        for (found, exact) in found.iter().zip(exact) {
            assert!((found - exact).abs() < 1e-9, "{found} {exact}");
        }
    }
}
