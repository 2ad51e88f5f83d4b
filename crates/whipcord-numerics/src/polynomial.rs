//! Piecewise cubic interpolation.

/// Why no interpolant exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubicError {
    /// At least two knots are needed, and as many values as knots.
    Count {
        /// Knots given.
        knots: usize,
        /// Values given.
        values: usize,
    },
    /// Knot number `index`, from 0, does not exceed the one before it, or is not finite.
    NotIncreasing {
        /// Number of the offending knot.
        index: usize,
    },
}

/// A function made of one cubic polynomial between each two neighbouring knots.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseCubic {
    knots: Vec<f64>,
    /// Ascending powers of the distance from the left knot.
    pieces: Vec<[f64; 4]>,
}

impl PiecewiseCubic {
    /// The twice continuously differentiable cubic spline with the not-a-knot end condition: the
    /// third derivative, too, is continuous at the second and the last but one knot. Two knots give
    /// the straight line and three the parabola.
    ///
    /// # Errors
    /// [`CubicError`] when the knots do not increase or the counts do not fit.
    pub fn spline(knots: &[f64], values: &[f64]) -> Result<Self, CubicError> {
        check(knots, values)?;
        let slopes = match knots.len() {
            2 => vec![(values[1] - values[0]) / (knots[1] - knots[0]); 2],
            3 => parabola_slopes(knots, values),
            _ => not_a_knot_slopes(knots, values),
        };
        Ok(Self::hermite(knots, values, &slopes))
    }

    /// The monotone piecewise cubic of Fritsch and Carlson (SIAM J. Numer. Anal. 17, 1980) with
    /// the three-point end slopes of Moler: once continuously differentiable, and without overshoot.
    ///
    /// # Errors
    /// [`CubicError`] when the knots do not increase or the counts do not fit.
    pub fn pchip(knots: &[f64], values: &[f64]) -> Result<Self, CubicError> {
        check(knots, values)?;
        Ok(Self::hermite(knots, values, &pchip_slopes(knots, values)))
    }

    /// Derivative of [`Self::pchip`] through `values` where these change at the rates `changes`.
    /// Where the interpolant is not smooth in its values, at a knot where a slope just turns to
    /// zero, that of the side on which it is zero.
    ///
    /// # Errors
    /// [`CubicError`] when the knots do not increase or the counts do not fit.
    pub fn pchip_change(
        knots: &[f64],
        values: &[f64],
        changes: &[f64],
    ) -> Result<Self, CubicError> {
        check(knots, values)?;
        check(knots, changes)?;
        Ok(Self::hermite(knots, changes, &pchip_slope_changes(knots, values, changes)))
    }

    fn hermite(knots: &[f64], values: &[f64], slopes: &[f64]) -> Self {
        let pieces = (0..knots.len() - 1)
            .map(|i| {
                let h = knots[i + 1] - knots[i];
                let secant = (values[i + 1] - values[i]) / h;
                let (a, b) = (slopes[i], slopes[i + 1]);
                [values[i], a, (3.0 * secant - 2.0 * a - b) / h, (a + b - 2.0 * secant) / (h * h)]
            })
            .collect();
        Self { knots: knots.to_vec(), pieces }
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Value, first and second derivative at `x`. Beyond the ends the first or last cubic goes on;
    /// at a knot it is the piece on its right that answers.
    #[must_use]
    pub fn evaluate(&self, x: f64) -> [f64; 3] {
        self.evaluate_piece(self.piece(x), x)
    }

    /// The number of the cubic that answers at `x`, for those who ask several functions of the same knots.
    #[must_use]
    #[inline]
    pub fn piece(&self, x: f64) -> usize {
        let last = self.pieces.len() - 1;
        self.knots[1..=last].partition_point(|&k| k <= x)
    }

    /// Value, first and second derivative at `x` of the cubic of this number.
    #[must_use]
    #[inline]
    pub fn evaluate_piece(&self, piece: usize, x: f64) -> [f64; 3] {
        let [a, b, c, d] = self.pieces[piece];
        let t = x - self.knots[piece];
        [a + t * (b + t * (c + t * d)), b + t * (2.0 * c + 3.0 * t * d), 2.0 * c + 6.0 * t * d]
    }
}

fn check(knots: &[f64], values: &[f64]) -> Result<(), CubicError> {
    if knots.len() < 2 || knots.len() != values.len() {
        return Err(CubicError::Count { knots: knots.len(), values: values.len() });
    }
    match (1..knots.len()).find(|&i| !(knots[i] > knots[i - 1] && knots[i].is_finite())) {
        Some(index) => Err(CubicError::NotIncreasing { index }),
        None => Ok(()),
    }
}

fn parabola_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let (h0, h1) = (x[1] - x[0], x[2] - x[1]);
    let (d0, d1) = ((y[1] - y[0]) / h0, (y[2] - y[1]) / h1);
    let bend = (d1 - d0) / (h0 + h1);
    vec![d0 - bend * h0, d0 + bend * h0, d1 + bend * h1]
}

/// Slopes from the continuity of the second derivative inside and of the third next to the ends
/// (de Boor, A Practical Guide to Splines, ch. IV), at four knots or more. The system is tridiagonal, and
/// from the second row on each pivot exceeds what stands beside it: it needs no exchange of rows.
fn not_a_knot_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let d: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / h[i]).collect();
    let (h0, h1) = (h[0], h[1]);
    let (hk, hl) = (h[n - 3], h[n - 2]);
    let mut slopes = vec![0.0; n];
    // What stands to the right of each pivot, over it.
    let mut right = vec![0.0; n];
    right[0] = (h0 + h1) / h1;
    slopes[0] = ((h0 + 2.0 * (h0 + h1)) * h1 * d[0] + h0 * h0 * d[1]) / (h0 + h1) / h1;
    for i in 1..n - 1 {
        let pivot = 2.0 * (h[i - 1] + h[i]) - h[i] * right[i - 1];
        right[i] = h[i - 1] / pivot;
        let wanted = 3.0 * (h[i] * d[i - 1] + h[i - 1] * d[i]);
        slopes[i] = (wanted - h[i] * slopes[i - 1]) / pivot;
    }
    let wanted = (hl * hl * d[n - 3] + (2.0 * (hl + hk) + hl) * hk * d[n - 2]) / (hl + hk);
    let pivot = hk - (hl + hk) * right[n - 2];
    slopes[n - 1] = (wanted - (hl + hk) * slopes[n - 2]) / pivot;
    for i in (0..n - 1).rev() {
        slopes[i] -= right[i] * slopes[i + 1];
    }
    // Only knots whose spacings differ by 10^16 leave no pivot; then the secants serve.
    if slopes.iter().all(|slope| slope.is_finite()) { slopes } else { pchip_slopes(x, y) }
}

fn pchip_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let d: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / h[i]).collect();
    if n == 2 {
        return vec![d[0]; 2];
    }
    let mut slopes = vec![0.0; n];
    for i in 1..n - 1 {
        if d[i - 1] * d[i] > 0.0 {
            let (w0, w1) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
            slopes[i] = (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
        }
    }
    slopes[0] = pchip_end_slope(h[0], h[1], d[0], d[1]);
    slopes[n - 1] = pchip_end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
    slopes
}

fn pchip_end_slope(h0: f64, h1: f64, d0: f64, d1: f64) -> f64 {
    let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if slope * d0 <= 0.0 {
        0.0
    } else if d0 * d1 <= 0.0 && slope.abs() > 3.0 * d0.abs() {
        3.0 * d0
    } else {
        slope
    }
}

/// Derivatives of [`pchip_slopes`], branch by branch.
fn pchip_slope_changes(x: &[f64], y: &[f64], dy: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let secants =
        |y: &[f64]| -> Vec<f64> { (0..n - 1).map(|i| (y[i + 1] - y[i]) / h[i]).collect() };
    let (d, dd) = (secants(y), secants(dy));
    if n == 2 {
        return vec![dd[0]; 2];
    }
    let mut changes = vec![0.0; n];
    for i in 1..n - 1 {
        if d[i - 1] * d[i] > 0.0 {
            let (w0, w1) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
            let slope = (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
            let rate = w0 * dd[i - 1] / (d[i - 1] * d[i - 1]) + w1 * dd[i] / (d[i] * d[i]);
            changes[i] = slope * slope * rate / (w0 + w1);
        }
    }
    changes[0] = pchip_end_slope_change([h[0], h[1]], [d[0], d[1]], [dd[0], dd[1]]);
    changes[n - 1] =
        pchip_end_slope_change([h[n - 2], h[n - 3]], [d[n - 2], d[n - 3]], [dd[n - 2], dd[n - 3]]);
    changes
}

fn pchip_end_slope_change(h: [f64; 2], d: [f64; 2], dd: [f64; 2]) -> f64 {
    let end = |d: [f64; 2]| ((2.0 * h[0] + h[1]) * d[0] - h[0] * d[1]) / (h[0] + h[1]);
    let slope = end(d);
    if slope * d[0] <= 0.0 {
        0.0
    } else if d[0] * d[1] <= 0.0 && slope.abs() > 3.0 * d[0].abs() {
        3.0 * dd[0]
    } else {
        end(dd)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_reproduces_a_cubic() {
        let f = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x - 0.25 * x * x * x;
        let knots = [0.0, 0.3, 1.0, 1.2, 2.0];
        let spline = PiecewiseCubic::spline(&knots, &knots.map(f)).unwrap();
        for x in [0.0, 0.1, 0.5, 1.1, 1.9, 2.0] {
            let [y, dy, ddy] = spline.evaluate(x);
            assert!((y - f(x)).abs() < 1e-14);
            assert!((dy - (-2.0 + x - 0.75 * x * x)).abs() < 1e-13);
            assert!((ddy - (1.0 - 1.5 * x)).abs() < 1e-12);
        }
    }

    /// Values of `scipy.interpolate.CubicSpline(x, y)` and `PchipInterpolator(x, y)` (SciPy 1.16).
    #[test]
    fn agrees_with_scipy() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0];
        let y = [0.0, 1.0, 1.0, 0.0, 2.0, 2.5];
        let spline = PiecewiseCubic::spline(&x, &y).unwrap();
        let pchip = PiecewiseCubic::pchip(&x, &y).unwrap();
        for (at, s, p) in SCIPY {
            assert!((spline.evaluate(at)[0] - s).abs() < 1e-12, "spline at {at}");
            assert!((pchip.evaluate(at)[0] - p).abs() < 1e-12, "pchip at {at}");
        }
    }

    const SCIPY: [(f64, f64, f64); 4] = [
        (0.5, 0.530_761_718_75, 0.687_5),
        (2.4, 0.478_75, 0.648),
        (3.5, 0.661_621_093_75, 0.939_189_189_189_189_3),
        (5.2, 4.496_25, 2.417_405_405_405_405_7),
    ];

    #[test]
    fn pchip_changes_as_its_values_do() {
        let x = [0.0, 1.0, 2.5, 3.0, 4.0, 6.0];
        let y = [0.0, 1.0, 1.2, 0.0, 2.0, 2.5];
        let dy = [0.3, -1.0, 0.5, 0.2, -0.4, 1.0];
        let change = PiecewiseCubic::pchip_change(&x, &y, &dy).unwrap();
        let h = 1e-6;
        let moved = |f: f64| {
            let values: Vec<f64> = y.iter().zip(&dy).map(|(y, d)| y + f * d).collect();
            PiecewiseCubic::pchip(&x, &values).unwrap()
        };
        let (a, b) = (moved(-h), moved(h));
        for at in [0.1, 0.9, 1.7, 2.8, 3.5, 5.9] {
            for k in 0..2 {
                let expected = (b.evaluate(at)[k] - a.evaluate(at)[k]) / (2.0 * h);
                assert!((change.evaluate(at)[k] - expected).abs() < 1e-8, "{at}");
            }
        }
    }

    #[test]
    fn few_knots_and_bad_knots() {
        let line = PiecewiseCubic::spline(&[0.0, 2.0], &[1.0, 5.0]).unwrap();
        assert_eq!(line.evaluate(1.0), [3.0, 2.0, 0.0]);
        let parabola = PiecewiseCubic::spline(&[0.0, 1.0, 3.0], &[0.0, 1.0, 9.0]).unwrap();
        assert!((parabola.evaluate(2.0)[0] - 4.0).abs() < 1e-14);
        assert_eq!(
            PiecewiseCubic::spline(&[0.0, 1.0, 1.0], &[0.0; 3]),
            Err(CubicError::NotIncreasing { index: 2 })
        );
        assert_eq!(
            PiecewiseCubic::pchip(&[0.0], &[0.0]),
            Err(CubicError::Count { knots: 1, values: 1 })
        );
    }
}
