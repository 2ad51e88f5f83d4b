use core::f64::consts::PI;

use whipcord_numerics::DenseLu;

/// Highest harmonic, as in the paper.
const ORDER: usize = 8;
const TERMS: usize = 2 * ORDER + 1;

/// A Fourier series of order 8 through given values.
///
/// The paper approximates the cable's course by such a series to make it smooth. Its period is
/// taken as twice the cable's extent, so that a course need not end where it began. Ten disks do
/// not determine seventeen coefficients: of all series through the holes the one of least mean
/// square second derivative over its period is taken. With more than seventeen disks the holes
/// are met in the least-squares sense, with the same measure as a vanishing regularisation.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fourier {
    frequency: f64,
    /// Constant, then cosine and sine of each harmonic in turn.
    coefficients: [f64; TERMS],
}

impl Fourier {
    /// The series through `values` at the increasing `knots`, of which the first is 0.
    pub(crate) fn through(knots: &[f64], values: &[f64]) -> Self {
        let extent = knots[knots.len() - 1];
        let frequency = PI / extent;
        let basis: Vec<[f64; TERMS]> = knots.iter().map(|&s| basis(frequency * s)).collect();
        let coefficients = if knots.len() <= TERMS {
            smoothest_interpolant(&basis, values)
        } else {
            least_squares(&basis, values)
        };
        Self { frequency, coefficients }
    }

    /// Value and first two derivatives.
    pub(crate) fn evaluate(&self, s: f64) -> [f64; 3] {
        let w = self.frequency;
        let b = basis(w * s);
        let mut out = [self.coefficients[0], 0.0, 0.0];
        for k in 1..=ORDER {
            let (c, d) = (self.coefficients[2 * k - 1], self.coefficients[2 * k]);
            let (cos, sin) = (b[2 * k - 1], b[2 * k]);
            let rate = w * k as f64;
            out[0] += c * cos + d * sin;
            out[1] += rate * (d * cos - c * sin);
            out[2] -= rate * rate * (c * cos + d * sin);
        }
        out
    }
}

fn basis(phase: f64) -> [f64; TERMS] {
    let mut b = [1.0; TERMS];
    for k in 1..=ORDER {
        let (sin, cos) = (phase * k as f64).sin_cos();
        b[2 * k - 1] = cos;
        b[2 * k] = sin;
    }
    b
}

/// Mean square second derivative of the basis functions, relative to that of the first harmonic.
fn roughness(term: usize) -> f64 {
    (term.div_ceil(2) as f64).powi(4)
}

/// Least roughness subject to the values: one saddle-point system.
fn smoothest_interpolant(basis: &[[f64; TERMS]], values: &[f64]) -> [f64; TERMS] {
    let n = TERMS + values.len();
    let mut a = vec![0.0; n * n];
    let mut x = vec![0.0; n];
    for term in 0..TERMS {
        a[term * n + term] = roughness(term);
        for (i, row) in basis.iter().enumerate() {
            a[term * n + TERMS + i] = row[term];
            a[(TERMS + i) * n + term] = row[term];
        }
    }
    x[TERMS..].copy_from_slice(values);
    solved(n, &a, x, values)
}

fn least_squares(basis: &[[f64; TERMS]], values: &[f64]) -> [f64; TERMS] {
    const REGULARISATION: f64 = 1e-10;
    let n = TERMS;
    let mut a = vec![0.0; n * n];
    let mut x = vec![0.0; n];
    for i in 0..n {
        a[i * n + i] = REGULARISATION * values.len() as f64 * roughness(i);
        for (row, value) in basis.iter().zip(values) {
            x[i] += row[i] * value;
            for j in 0..n {
                a[i * n + j] += row[i] * row[j];
            }
        }
    }
    solved(n, &a, x, values)
}

fn solved(n: usize, a: &[f64], mut x: Vec<f64>, values: &[f64]) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let mut lu = DenseLu::default();
    if lu.factor(n, a).is_ok() {
        lu.solve(&mut x);
        coefficients.copy_from_slice(&x[..TERMS]);
    } else {
        // Disks so close that rounding makes their rows equal: their mean is all there is to say.
        coefficients[0] = values.iter().sum::<f64>() / values.len() as f64;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_the_values_and_stays_calm_between_them() {
        let knots: Vec<f64> = (0..10).map(|i| f64::from(i) * 0.02).collect();
        let values: Vec<f64> = knots.iter().map(|s| (8.0 * s).sin()).collect();
        let series = Fourier::through(&knots, &values);
        for i in 0..181 {
            let s = f64::from(i) * 0.001;
            assert!((series.evaluate(s)[0] - (8.0 * s).sin()).abs() < 1e-2, "{s}");
        }
    }

    #[test]
    fn many_disks_are_met_in_the_mean() {
        let knots: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0).collect();
        let values: Vec<f64> = knots.iter().map(|s| s * s).collect();
        let series = Fourier::through(&knots, &values);
        for (&s, value) in knots.iter().zip(&values) {
            assert!((series.evaluate(s)[0] - value).abs() < 1e-4);
        }
    }
}
