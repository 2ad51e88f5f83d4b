//! What a controller knows of a robot: an extended Kalman filter over a bias of the commands and a force on the tip.

use whipcord_numerics::DenseLu;

/// How much is believed of model and measurement, as standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorOptions {
    /// Of a measured position, in m.
    pub position: f64,
    /// Of a measured direction, in rad.
    pub angle: f64,
    /// Of the bias of a command, as a part of the command that bends the robot by half a turn.
    pub bias: f64,
    /// Of the force on the tip, in N.
    pub force: f64,
    /// Time in s in which bias and force are forgotten where nothing is measured of them.
    pub memory: f64,
}

/// A residual that is farther than this from what is expected, in standard deviations, corrects by a part alone, and says nothing of the covariance: so far the derivatives
/// do not hold.
const FARTHEST: f64 = 1.0;

/// Estimated is `z = (b, f)`: biases of the commands, in units of half a turn, and the force on the tip in N. With the residual `r` of a measurement at the model's answer and its
/// derivatives `H` by `z` the filter predicts and corrects
///
/// ```text
/// z ← φ z,   P ← φ² P + (1 − φ²) Q,   φ = e^(−T/m)                                       (14)
/// K = P Hᵀ (H P Hᵀ + R)⁻¹,   z ← z − K r,   P ← (I − K H) P
/// ```
///
/// with the variances `Q` of a Gauss–Markov process and its memory `m`, which keeps what cannot be seen near zero. Because every cycle solves the model at the new estimate, the filter is iterated from cycle to cycle.
#[derive(Clone, Debug)]
pub(crate) struct Estimator {
    pub state: Vec<f64>,
    covariance: Vec<f64>,
    variances: Vec<f64>,
    memory: f64,
    lu: DenseLu,
}

impl Estimator {
    /// For so many commands, with nothing known yet but their deviations.
    pub fn new(commands: usize, options: &EstimatorOptions) -> Self {
        let n = commands + 3;
        let variances: Vec<f64> = (0..n)
            .map(|k| if k < commands { options.bias } else { options.force }.powi(2))
            .collect();
        let mut covariance = vec![0.0; n * n];
        for k in 0..n {
            covariance[k * n + k] = variances[k];
        }
        let memory = options.memory;
        Self { state: vec![0.0; n], covariance, variances, memory, lu: DenseLu::default() }
    }

    /// Corrects the state by a residual with its derivatives, by rows, and the variances of its rows; `seconds` after the correction
    /// before. Returns the change of the state.
    pub fn correct(
        &mut self,
        residual: &[f64],
        derivatives: &[f64],
        variances: &[f64],
        seconds: f64,
    ) -> Vec<f64> {
        let (n, m) = (self.state.len(), residual.len());
        let kept = (-seconds / self.memory).exp();
        for entry in &mut self.covariance {
            *entry *= kept * kept;
        }
        for k in 0..n {
            self.covariance[k * n + k] += (1.0 - kept * kept) * self.variances[k];
        }
        let before = self.state.clone();
        for value in &mut self.state {
            *value *= kept;
        }
        // P Hᵀ, by rows of P.
        let mut cross = vec![0.0; n * m];
        for a in 0..n {
            for i in 0..m {
                cross[a * m + i] =
                    (0..n).map(|b| self.covariance[a * n + b] * derivatives[i * n + b]).sum();
            }
        }
        let mut innovation = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..m {
                let of = (0..n).map(|a| derivatives[i * n + a] * cross[a * m + j]).sum::<f64>();
                innovation[i * m + j] = of + if i == j { variances[i] } else { 0.0 };
            }
        }
        let mut change = vec![0.0; n];
        // Positive definite by its diagonal; where rounding says otherwise nothing is learned.
        if self.lu.factor(m, &innovation).is_err() {
            return change;
        }
        let mut weighted = residual.to_vec();
        self.lu.solve(&mut weighted);
        let distance =
            residual.iter().zip(&weighted).map(|(r, w)| r * w).sum::<f64>().max(0.0).sqrt();
        let part = (FARTHEST / distance).min(1.0);
        for a in 0..n {
            self.state[a] -= part * (0..m).map(|i| cross[a * m + i] * weighted[i]).sum::<f64>();
            change[a] = self.state[a] - before[a];
        }
        if part < 1.0 {
            return change;
        }
        for b in 0..n {
            let mut column: Vec<f64> = (0..m).map(|i| cross[b * m + i]).collect();
            self.lu.solve(&mut column);
            for a in 0..n {
                let of: f64 = (0..m).map(|i| cross[a * m + i] * column[i]).sum();
                self.covariance[a * n + b] -= of;
            }
        }
        for a in 0..n {
            for b in 0..a {
                let mean = 0.5 * (self.covariance[a * n + b] + self.covariance[b * n + a]);
                (self.covariance[a * n + b], self.covariance[b * n + a]) = (mean, mean);
            }
        }
        change
    }

    /// Standard deviations of the state.
    pub fn deviations(&self) -> impl Iterator<Item = f64> + '_ {
        let n = self.state.len();
        (0..n).map(move |k| self.covariance[k * n + k].max(0.0).sqrt())
    }
}
