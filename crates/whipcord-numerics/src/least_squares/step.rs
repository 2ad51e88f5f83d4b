use crate::orthogonal::{norm, triangularise};

/// Damping below which directions that nothing is seen of would drift by rounding.
const LEAST_DAMPING: f64 = 1e-12;
/// How near the length of a step is brought to the radius, as a fraction of it.
const NEARNESS: f64 = 0.1;
const TRIALS: usize = 12;

/// A step within a radius and within bounds, and what it needs.
#[derive(Clone, Debug, Default)]
pub(super) struct Step {
    /// The step.
    pub(super) change: Vec<f64>,
    /// Its length in scaled unknowns.
    pub(super) length: f64,
    /// By how much the linearised problem's cost is lower after it.
    pub(super) promised: f64,
    /// Whether the radius did not hold it back.
    pub(super) is_full: bool,
    /// Unknowns that are not at a bound after the step.
    free: Vec<usize>,
    block: Vec<f64>,
    target: Vec<f64>,
    trial: Vec<f64>,
    turned: Vec<f64>,
    scratch: Vec<f64>,
}

/// The linearised problem: the reduced Jacobian by rows, the reduced residuals, the scale of each unknown.
#[derive(Clone, Copy)]
pub(super) struct Linear<'a> {
    pub(super) jacobian: &'a [f64],
    pub(super) residuals: &'a [f64],
    pub(super) scale: &'a [f64],
}

/// How far each unknown may still go, down (not positive) and up (not negative).
pub(super) struct Room<'a> {
    pub(super) down: &'a [f64],
    pub(super) up: &'a [f64],
}

impl Step {
    /// Minimises `½‖J δ + r‖²` with `‖D δ‖` near or within `radius`, and no unknown beyond its room: one that
    /// would be stays at its bound, and the others are sought anew.
    pub(super) fn find(
        &mut self,
        linear: Linear<'_>,
        gradient: &[f64],
        room: &Room<'_>,
        radius: f64,
    ) {
        let n = linear.scale.len();
        self.change.clear();
        self.change.resize(n, 0.0);
        self.free.clear();
        self.free.extend((0..n).filter(|&j| !is_held(gradient[j], room, j)));
        loop {
            let damping = self.seek(linear, radius);
            self.is_full = damping == LEAST_DAMPING;
            for (&j, &value) in self.free.iter().zip(&self.trial) {
                self.change[j] = value;
            }
            let before = self.free.len();
            let change = &mut self.change;
            self.free.retain(|&j| {
                let within = change[j] >= room.down[j] && change[j] <= room.up[j];
                change[j] = change[j].clamp(room.down[j], room.up[j]);
                within
            });
            if self.free.len() == before {
                break;
            }
        }
        self.length = norm(self.change.iter().zip(linear.scale).map(|(x, d)| x * d));
        self.promised = promised(linear, &self.change);
    }

    /// Seeks the free unknowns, given the others, into `self.trial`; the damping it took.
    fn seek(&mut self, linear: Linear<'_>, radius: f64) -> f64 {
        let mut damping = LEAST_DAMPING;
        for _ in 0..TRIALS {
            self.solve(linear, damping);
            let scaled = self.free.iter().zip(&self.trial).map(|(&j, x)| x * linear.scale[j]);
            let length = norm(scaled);
            if length <= (1.0 + NEARNESS) * radius {
                break;
            }
            // Newton's method on 1/radius − 1/length, which is nearly linear in the damping and nears
            // the root from below.
            let slope = self.slope(linear, length);
            damping += (length - radius) / radius / slope;
        }
        damping
    }

    /// Minimises `‖J δ + r‖² + λ‖D δ‖²` over the free unknowns.
    fn solve(&mut self, linear: Linear<'_>, damping: f64) {
        let Self { change, free, block, target, trial, scratch, .. } = self;
        let (n, m, rows) = (linear.scale.len(), free.len(), linear.residuals.len());
        block.clear();
        target.clear();
        for (row, residual) in linear.jacobian.chunks_exact(n).zip(linear.residuals) {
            let held = row.iter().zip(&*change).enumerate().filter(|(j, _)| !free.contains(j));
            target.push(-residual - held.map(|(_, (a, x))| a * x).sum::<f64>());
            block.extend(free.iter().map(|&j| row[j]));
        }
        target.resize(rows + m, 0.0);
        block.resize((rows + m) * m, 0.0);
        for (k, &j) in free.iter().enumerate() {
            block[(rows + k) * m + k] = damping.sqrt() * linear.scale[j];
        }
        triangularise(m, block, target, scratch);
        trial.clear();
        trial.extend_from_slice(&target[..m]);
        for i in (0..m).rev() {
            for j in i + 1..m {
                trial[i] -= block[i * m + j] * trial[j];
            }
            trial[i] /= block[i * m + i];
        }
    }

    /// `‖R⁻ᵀ D² δ‖² / ‖D δ‖²`, with the factor and the step of the last [`Self::solve`]: the relative
    /// shortening of the step by damping.
    fn slope(&mut self, linear: Linear<'_>, length: f64) -> f64 {
        let m = self.free.len();
        self.turned.clear();
        self.turned.extend(
            self.free
                .iter()
                .zip(&self.trial)
                .map(|(&j, x)| linear.scale[j] * linear.scale[j] * x / length),
        );
        for i in 0..m {
            for j in 0..i {
                self.turned[i] -= self.block[j * m + i] * self.turned[j];
            }
            self.turned[i] /= self.block[i * m + i];
        }
        self.turned.iter().map(|x| x * x).sum()
    }
}

/// Whether the unknown is at a bound that the cost falls towards.
pub(super) fn is_held(slope: f64, room: &Room<'_>, j: usize) -> bool {
    (room.down[j] >= 0.0 && slope >= 0.0) || (room.up[j] <= 0.0 && slope <= 0.0)
}

/// By how much `½‖J δ + r‖²` is below `½‖r‖²`.
fn promised(linear: Linear<'_>, change: &[f64]) -> f64 {
    let rows = linear.jacobian.chunks_exact(change.len()).zip(linear.residuals);
    -rows
        .map(|(row, residual)| {
            let by: f64 = row.iter().zip(change).map(|(a, x)| a * x).sum();
            by * (residual + 0.5 * by)
        })
        .sum::<f64>()
}
