//! What arrives at the tip of the loaded rod, differentiated by base moment and tensions.
//!
//! In the body frame, with `η` the rotation and `μ` the change of `Mᵦ`, a change of shape obeys
//!
//! ```text
//! H (δv, δu) = (N × η, μ) − Σ qⱼ δτⱼ
//! η′ = δu − u × η,   μ′ = −δu × Mᵦ − u × μ − δv × N − v × (N × η)            (5)
//! ```
//!
//! where `qⱼ = (tⱼ, rⱼ × tⱼ)`. The classical Runge–Kutta method takes it from start, middle and end
//! of each step: to order 4, as fine as Newton's method needs it.

use whipcord_numerics::{Pose, Vec3};

use super::grid::Grid;
use super::loaded::{SAMPLED_NODES, Sample};
use super::loads::DeadLoads;
use super::section::{BodyWrench, Strain};

/// Derivatives of a shot.
#[derive(Clone, Debug, Default)]
pub(super) struct Sensitivity {
    /// Of the moment left over at the tip, base frame, by each unknown: base moment (3), then the
    /// tensions.
    pub excess: Vec<Vec3>,
    /// `∂ℓᵢ` by each unknown, by rows of cables; empty unless tensions are among the unknowns.
    pub lengths: Vec<f64>,
    columns: Vec<Column>,
}

/// Change of rotation and moment with one unknown, in the body frame.
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    turn: Vec3,
    moment: Vec3,
}

impl Column {
    #[inline]
    fn plus(self, f: f64, slope: Self) -> Self {
        Self { turn: self.turn + f * slope.turn, moment: self.moment + f * slope.moment }
    }
}

/// Stages of the classical Runge–Kutta method: the sample each uses, how far along the slope before
/// it lies, and its weight.
const STAGES: [(usize, f64, f64); 4] =
    [(0, 0.0, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 0.5, 1.0 / 3.0), (2, 1.0, 1.0 / 6.0)];

impl Sensitivity {
    /// Differentiates a sampled shot by the base moment and the first `tensions` tensions.
    pub fn compute(
        &mut self,
        grid: &Grid,
        loads: &DeadLoads,
        load: f64,
        samples: &[Sample],
        poses: &[Pose],
        tensions: usize,
    ) {
        let unknowns = 3 + tensions;
        self.columns.clear();
        self.columns.resize(unknowns, Column::default());
        for (column, axis) in self.columns.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
            column.moment = axis;
        }
        self.lengths.clear();
        self.lengths.resize(tensions * unknowns, 0.0);
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            self.jump(loads.moment(k) * load, &poses[k]);
            self.step(grid, k, triple, tensions);
        }
        let tip = &poses[grid.len()];
        let last = samples[samples.len() - 1].wrench.angular;
        self.excess.clear();
        self.excess.extend(
            self.columns.iter().map(|c| tip.rotation.rotate(c.moment + c.turn.cross(last))),
        );
    }

    /// A dead moment is fixed in the base frame, so that it turns in the body frame.
    fn jump(&mut self, moment: Vec3, pose: &Pose) {
        if moment != Vec3::ZERO {
            let body = pose.rotation.conjugate().rotate(moment);
            for column in &mut self.columns {
                column.moment -= body.cross(column.turn);
            }
        }
    }

    fn step(&mut self, grid: &Grid, k: usize, samples: &[Sample], tensions: usize) {
        let step = grid.steps[k];
        let unknowns = self.columns.len();
        let h = step.length;
        for c in 0..unknowns {
            let start = self.columns[c];
            let mut end = start;
            let mut slope = Column::default();
            for (q, reach, weight) in STAGES {
                let sample = &samples[q];
                let stage = start.plus(reach * h, slope);
                let mut wrench = BodyWrench {
                    linear: sample.wrench.linear.cross(stage.turn),
                    angular: stage.moment,
                };
                if tensions == 0 {
                    slope = rate(sample, &stage, &sample.tangent.solve(wrench));
                } else {
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    if let Some(crossing) = c.checked_sub(3).and_then(|j| crossings.get(j)) {
                        wrench = wrench - crossing.pull(&sample.strain).0;
                    }
                    let change = sample.tangent.solve(wrench);
                    slope = rate(sample, &stage, &change);
                    for (i, crossing) in crossings.iter().enumerate() {
                        let pull = crossing.pull(&sample.strain).0;
                        self.lengths[i * unknowns + c] += weight * h * work(&pull, &change);
                    }
                }
                end = end.plus(weight * h, slope);
            }
            self.columns[c] = end;
        }
    }
}

/// Eq. (5).
#[inline]
fn rate(sample: &Sample, at: &Column, change: &Strain) -> Column {
    let Sample { strain, wrench, .. } = sample;
    let (n, m) = (wrench.linear, wrench.angular);
    let (v, u) = (strain.linear, strain.angular);
    Column {
        turn: change.angular - u.cross(at.turn),
        moment: m.cross(change.angular) - u.cross(at.moment) + n.cross(change.linear)
            - v.cross(n.cross(at.turn)),
    }
}

/// Rate of a cable's length: what a unit tension does on a change of strain.
#[inline]
pub(super) fn work(pull: &BodyWrench, change: &Strain) -> f64 {
    pull.linear.dot(change.linear) + pull.angular.dot(change.angular)
}
