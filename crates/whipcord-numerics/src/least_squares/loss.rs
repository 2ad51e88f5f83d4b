/// How much residuals count: `ρ(s)` of the square `s` of a block's norm.
///
/// All count a small residual by its square. The others count one beyond their scale `c` less, so that a
/// few wrong measurements do not decide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// `s`: least squares.
    #[default]
    Squares,
    /// `s`, and `2 c √s − c²` beyond `c` (Huber, Ann. Math. Stat. 35 (1964) 73).
    Huber {
        /// `c`, in the unit of the residuals.
        scale: f64,
    },
    /// `2 c² (√(1 + s/c²) − 1)`: as Huber's, but smooth (Charbonnier et al., IEEE Trans. Image Process. 6
    /// (1997) 298).
    SoftL1 {
        /// `c`, in the unit of the residuals.
        scale: f64,
    },
    /// `c² ln(1 + s/c²)`: the likelihood of Cauchy's distribution. The influence of a residual far
    /// out goes to nought.
    Cauchy {
        /// `c`, in the unit of the residuals.
        scale: f64,
    },
}

impl Loss {
    /// `ρ` and `ρ′` at the square of a norm.
    #[must_use]
    pub fn of(self, square: f64) -> (f64, f64) {
        match self {
            Self::Squares => (square, 1.0),
            Self::Huber { scale } => {
                let norm = square.sqrt();
                if norm <= scale {
                    (square, 1.0)
                } else {
                    (scale * (2.0 * norm - scale), scale / norm)
                }
            }
            Self::SoftL1 { scale } => {
                let ratio = square / (scale * scale);
                let root = (1.0 + ratio).sqrt();
                // 2 c² (root − 1), without the difference.
                (2.0 * square / (root + 1.0), 1.0 / root)
            }
            Self::Cauchy { scale } => {
                let ratio = square / (scale * scale);
                (scale * scale * ratio.ln_1p(), 1.0 / (1.0 + ratio))
            }
        }
    }

    /// `ρ″` at the square of a norm.
    #[must_use]
    pub fn curvature(self, square: f64) -> f64 {
        match self {
            Self::Squares => 0.0,
            Self::Huber { scale } => {
                let norm = square.sqrt();
                if norm <= scale { 0.0 } else { -0.5 * scale / (norm * square) }
            }
            Self::SoftL1 { scale } => {
                let ratio = square / (scale * scale);
                -0.5 / (scale * scale) * (1.0 + ratio).powf(-1.5)
            }
            Self::Cauchy { scale } => {
                let below = 1.0 + square / (scale * scale);
                -1.0 / (scale * scale * below * below)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_the_losses() {
        let scale = 0.7;
        for loss in
            [Loss::Squares, Loss::Huber { scale }, Loss::SoftL1 { scale }, Loss::Cauchy { scale }]
        {
            for square in [1e-6, 0.1, 0.4, 0.6, 3.0, 1e4] {
                let h = 1e-5 * square;
                let slope = (loss.of(square + h).0 - loss.of(square - h).0) / (2.0 * h);
                let (value, exact) = loss.of(square);
                assert!((slope - exact).abs() < 1e-5 * exact, "{loss:?} {square}");
                assert!(value <= square && exact <= 1.0);
                let slope = (loss.of(square + h).1 - loss.of(square - h).1) / (2.0 * h);
                let exact = loss.curvature(square);
                assert!((slope - exact).abs() <= 1e-5 * exact.abs(), "{loss:?} {square}");
            }
            let (value, slope) = loss.of(1e-12);
            assert!((value / 1e-12 - 1.0).abs() < 1e-9 && (slope - 1.0).abs() < 1e-9);
        }
    }
}
