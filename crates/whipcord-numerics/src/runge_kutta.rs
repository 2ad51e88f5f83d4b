use crate::Vec3;

/// An explicit Runge–Kutta method with `S` stages.
#[derive(Clone, Copy, Debug)]
pub struct ExplicitTableau<const S: usize> {
    /// Stage `i` builds on the slopes of stages `0..i` with these weights.
    pub a: [[f64; S]; S],
    /// Weights of the slopes in the step.
    pub b: [f64; S],
    /// Place of each stage as a fraction of the step.
    pub c: [f64; S],
}

/// Butcher's method of order 5 with six stages, which sit at five equally spaced places of the step
/// and are weighted by Boole's rule (J. C. Butcher, *On Runge–Kutta processes of high order*,
/// J. Austral. Math. Soc. 4, 1964).
pub const BUTCHER_5: ExplicitTableau<6> = ExplicitTableau {
    a: [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0 / 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0 / 8.0, 1.0 / 8.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, -1.0 / 2.0, 1.0, 0.0, 0.0, 0.0],
        [3.0 / 16.0, 0.0, 0.0, 9.0 / 16.0, 0.0, 0.0],
        [-3.0 / 7.0, 2.0 / 7.0, 12.0 / 7.0, -12.0 / 7.0, 8.0 / 7.0, 0.0],
    ],
    b: [7.0 / 90.0, 0.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0],
    c: [0.0, 0.25, 0.25, 0.5, 0.75, 1.0],
};

/// The weighted sum of the slopes of a step's stages.
#[inline]
#[must_use]
pub fn weighted_sum<const N: usize>(slopes: &[Vec3], weights: &[f64; N]) -> Vec3 {
    slopes.iter().zip(weights).fold(Vec3::ZERO, |sum, (&slope, &weight)| sum + weight * slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y′ = 2 x y²` from `y(0) = 1/2`, whose solution is `1/(2 − x²)`.
    fn error(steps: usize) -> f64 {
        let t = &BUTCHER_5;
        let h = 1.0 / steps as f64;
        let mut y = 0.5;
        for k in 0..steps {
            let mut slopes = [0.0; 6];
            for i in 0..6 {
                let stage = y + h * (0..i).map(|j| t.a[i][j] * slopes[j]).sum::<f64>();
                slopes[i] = 2.0 * (k as f64 + t.c[i]) * h * stage * stage;
            }
            y += h * (0..6).map(|i| t.b[i] * slopes[i]).sum::<f64>();
        }
        (y - 1.0).abs()
    }

    #[test]
    fn fifth_order_and_consistent() {
        for i in 0..6 {
            assert!((BUTCHER_5.a[i].iter().sum::<f64>() - BUTCHER_5.c[i]).abs() < 1e-15);
        }
        let order = (error(16) / error(32)).log2();
        assert!((4.7..5.5).contains(&order), "{order}");
    }
}
