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

/// Butcher's method of order 6 with seven stages, which sit at only five places of the step
/// (J. C. Butcher, *On Runge–Kutta processes of high order*, J. Austral. Math. Soc. 4, 1964).
pub const BUTCHER_6: ExplicitTableau<7> = ExplicitTableau {
    a: [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 2.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0 / 12.0, 1.0 / 3.0, -1.0 / 12.0, 0.0, 0.0, 0.0, 0.0],
        [-1.0 / 16.0, 9.0 / 8.0, -3.0 / 16.0, -3.0 / 8.0, 0.0, 0.0, 0.0],
        [0.0, 9.0 / 8.0, -3.0 / 8.0, -3.0 / 4.0, 1.0 / 2.0, 0.0, 0.0],
        [9.0 / 44.0, -9.0 / 11.0, 63.0 / 44.0, 18.0 / 11.0, 0.0, -16.0 / 11.0, 0.0],
    ],
    b: [11.0 / 120.0, 0.0, 27.0 / 40.0, 27.0 / 40.0, -4.0 / 15.0, -4.0 / 15.0, 11.0 / 120.0],
    c: [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0, 0.5, 0.5, 1.0],
};

#[cfg(test)]
mod tests {
    use super::*;

    /// `y′ = 2 x y²` from `y(0) = 1/2`, whose solution is `1/(2 − x²)`.
    fn error(steps: usize) -> f64 {
        let t = &BUTCHER_6;
        let h = 1.0 / steps as f64;
        let mut y = 0.5;
        for k in 0..steps {
            let mut slopes = [0.0; 7];
            for i in 0..7 {
                let stage = y + h * (0..i).map(|j| t.a[i][j] * slopes[j]).sum::<f64>();
                slopes[i] = 2.0 * (k as f64 + t.c[i]) * h * stage * stage;
            }
            y += h * (0..7).map(|i| t.b[i] * slopes[i]).sum::<f64>();
        }
        (y - 1.0).abs()
    }

    #[test]
    fn sixth_order_and_consistent() {
        for i in 0..7 {
            assert!((BUTCHER_6.a[i].iter().sum::<f64>() - BUTCHER_6.c[i]).abs() < 1e-15);
        }
        let order = (error(16) / error(32)).log2();
        assert!((5.7..6.5).contains(&order), "{order}");
    }
}
