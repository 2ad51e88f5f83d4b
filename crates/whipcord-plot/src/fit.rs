//! Straight lines through data.

/// `y = intercept + slope · x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub intercept: f64,
    pub slope: f64,
}

impl Line {
    /// The least-squares line; `None` when all points have the same x.
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / n;
        let (x, y) = (mean(0), mean(1));
        let (mut xx, mut xy) = (0.0, 0.0);
        for p in points {
            xx += (p[0] - x).powi(2);
            xy += (p[0] - x) * (p[1] - y);
        }
        let slope = xy / xx;
        (xx > 0.0 && slope.is_finite()).then_some(Self { intercept: y - slope * x, slope })
    }

    pub fn at(self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again() {
        let line = Line { intercept: -2.0, slope: 0.25 };
        let points: Vec<_> = (0..7).map(|k| [f64::from(k), line.at(f64::from(k))]).collect();
        let found = Line::through(&points).unwrap();
        assert!((found.slope - line.slope).abs() < 1e-14);
        assert!((found.intercept - line.intercept).abs() < 1e-13);
        assert_eq!(Line::through(&[[1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(Line::through(&[]), None);
    }
}
