//! Which cables pull at the end of a Newton step.
//!
//! Newton's method for `min(τ, g) = 0` may decide cable by cable, by what is greater now. Where the lengths of
//! more cables are given than are independent of one another, as on four straight cables or more, it then goes
//! round in circles: whether one of them pulls depends on which of the others do. The step `δ` of all tensions
//! together solves the linearised problem
//!
//! ```text
//! τ + δ ≥ 0  ⟂  g − δℓ₀ + (C − L) δ ≥ 0                                                       (13)
//! ```
//!
//! with `δℓ = L δ + δℓ₀` and the cables' own compliances `C` (Josephy's method for complementarity problems).
//! Where the robot is stable under its tensions `C − L` is positive semidefinite, and (13) says where a
//! quadratic function is least over `δ ≥ −τ`.

use whipcord_numerics::BoundedQuadratic;

/// The linearised problem, and memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct ActiveSetPrediction {
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    least: Vec<f64>,
    step: Vec<f64>,
    quadratic: BoundedQuadratic,
}

/// What rounding leaves of (13), relative to the greatest of its terms.
const ROUNDING: f64 = 1e-9;

impl ActiveSetPrediction {
    /// Solves (13) for so many cables that are driven by their length, with `τ` in N, the entries `gives(i, j)`
    /// of `C − L` in m/N, `g − δℓ₀` in m, and the units of tension and slackness in N and m; `false` where no
    /// solution was found.
    pub fn solve(
        &mut self,
        cables: usize,
        tension: impl Fn(usize) -> f64,
        gives: impl Fn(usize, usize) -> f64,
        slack: impl Fn(usize) -> f64,
        units: [f64; 2],
    ) -> bool {
        let Self { matrix, gradient, least, step, quadratic } = self;
        let entry = |n: usize| gives(n / cables, n % cables) * units[0] / units[1];
        matrix.clear();
        matrix.extend((0..cables * cables).map(entry));
        gradient.clear();
        gradient.extend((0..cables).map(|i| slack(i) / units[1]));
        least.clear();
        least.extend((0..cables).map(|i| -tension(i) / units[0]));
        quadratic.minimise(matrix, gradient, least, step).is_ok() && self.is_met()
    }

    /// Whether (13) is met, as it need not be where `C − L` is indefinite.
    fn is_met(&self) -> bool {
        let Self { matrix, gradient, least, step, .. } = self;
        let rows = matrix.chunks_exact(step.len().max(1));
        rows.zip(gradient).enumerate().all(|(i, (row, &slack))| {
            let terms = row.iter().zip(step).map(|(gives, step)| gives * step);
            let (after, size) = terms
                .fold((slack, slack.abs()), |(sum, size), term| (sum + term, size + term.abs()));
            let missed = if self.is_pulling(i) { after.abs() } else { -after };
            step[i] >= least[i] && missed <= ROUNDING * size
        })
    }

    /// Whether cable `i` of those asked for pulls at the end of the step.
    pub fn is_pulling(&self, i: usize) -> bool {
        self.step[i] > self.least[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three cables on a rod that gives way in two directions alone: with the lengths that the rod without
    /// load has, (13) has the tensions of any two of them, but only two that both pull.
    #[test]
    fn of_three_cables_for_two_lengths_those_two_pull_that_can() {
        let levers = [[1.0, 0.0], [-0.5, 0.8], [-0.5, -0.8]];
        let gives = |i: usize, j: usize| {
            let own = if i == j { 1e-8 } else { 0.0 };
            own + levers[i][0] * levers[j][0] + levers[i][1] * levers[j][1]
        };
        let mut prediction = ActiveSetPrediction::default();
        for pull in [[0.3, 1.0], [-1.0, 0.1], [0.5, -1.0]] {
            let slack = |i: usize| levers[i][0] * pull[0] + levers[i][1] * pull[1];
            assert!(prediction.solve(3, |_| 0.0, gives, slack, [1.0, 1.0]));
            // Cables that would be too loose however the others pull stay slack.
            for i in 0..3 {
                let after =
                    slack(i) + (0..3).map(|j| gives(i, j) * prediction.step[j]).sum::<f64>();
                assert!(prediction.step[i] >= 0.0 && after >= -1e-9, "{after}");
                assert!(prediction.is_pulling(i) == (prediction.step[i] > 0.0));
                assert!(!prediction.is_pulling(i) || after.abs() <= 1e-9);
            }
        }
    }

    #[test]
    fn no_tension_shortens_a_cable_that_gets_longer_by_pulling() {
        assert!(!ActiveSetPrediction::default().solve(
            1,
            |_| 0.0,
            |_, _| -1.0,
            |_| -2.0,
            [1.0, 1.0]
        ));
    }
}
