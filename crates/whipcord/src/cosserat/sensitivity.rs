//! What arrives at the tip of the loaded rod, differentiated by base moment, force of the followers
//! and tensions.
//!
//! In the body frame, with `η` the rotation, `μ` the change of `Mᵦ` and `δG` that of the followers'
//! force in the base frame, a change of shape obeys
//!
//! ```text
//! H (δv, δu) = (δN, μ) − Σ qⱼ δτⱼ,   δN = N × η + Rᵀ δG
//! η′ = δu − u × η,   μ′ = −δu × Mᵦ − u × μ − δv × N − v × δN            (5)
//! ```
//!
//! where `qⱼ = (tⱼ, rⱼ × tⱼ)`. The classical Runge–Kutta method takes it from start, middle and end
//! of each step: to order 4, as fine as Newton's method needs it.

use whipcord_numerics::{Mat3, Pose, Vec3};

use super::grid::Grid;
use super::loaded::{SAMPLED_NODES, Sample};
use super::loads::AppliedLoads;
use super::section::{BodyWrench, Strain};
use crate::shape::Wrench;

/// Derivatives of a shot.
#[derive(Clone, Debug, Default)]
pub(super) struct Sensitivity {
    /// Of what is left over at the tip, base frame, by each unknown: base moment (3), base force of
    /// the followers (3, where there are any), then the tensions.
    pub excess: Vec<Wrench>,
    /// `∂ℓᵢ` by each unknown, by rows of cables; empty unless tensions are among the unknowns.
    pub lengths: Vec<f64>,
    columns: Vec<Column>,
}

/// Change of rotation and moment with one unknown, in the body frame, and of the followers' force in
/// the base frame.
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    turn: Vec3,
    moment: Vec3,
    follower_force: Vec3,
}

impl Column {
    #[inline]
    fn plus(self, f: f64, slope: Self) -> Self {
        let (turn, moment) = (self.turn + f * slope.turn, self.moment + f * slope.moment);
        Self { turn, moment, ..self }
    }
}

/// Stages of the classical Runge–Kutta method: the sample each uses, how far along the slope before
/// it lies, and its weight.
const STAGES: [(usize, f64, f64); 4] =
    [(0, 0.0, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 0.5, 1.0 / 3.0), (2, 1.0, 1.0 / 6.0)];

/// `[[∂η/∂η, ∂η/∂μ], [∂μ/∂η, ∂μ/∂μ]]` from the start of a step to its end, body frames.
pub(super) type Transition = [[Mat3; 2]; 2];

impl Sensitivity {
    /// The transition over step `k` and across the dead moment at its end, given in the body frame.
    pub fn transition(
        &mut self,
        grid: &Grid,
        k: usize,
        samples: &[Sample],
        applied: Vec3,
    ) -> Transition {
        self.columns.clear();
        self.columns.resize(6, Column::default());
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.columns[j].turn = axis;
            self.columns[3 + j].moment = axis;
        }
        self.step(grid, k, samples, 0);
        let turn = |c: usize| self.columns[c].turn;
        let moment = |c: usize| self.columns[c].moment - applied.cross(self.columns[c].turn);
        let blocks = |of: &dyn Fn(usize) -> Vec3| {
            [Mat3::from_columns(of(0), of(1), of(2)), Mat3::from_columns(of(3), of(4), of(5))]
        };
        [blocks(&turn), blocks(&moment)]
    }

    /// Differentiates a sampled shot by the unknowns at the base and the first `tensions` tensions.
    pub fn compute(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        samples: &[Sample],
        poses: &[Pose],
        tensions: usize,
    ) {
        let at_base = if loads.any_follower_force() { 6 } else { 3 };
        let unknowns = at_base + tensions;
        self.columns.clear();
        self.columns.resize(unknowns, Column::default());
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.columns[j].moment = axis;
            if at_base == 6 {
                self.columns[3 + j].follower_force = axis;
            }
        }
        self.lengths.clear();
        self.lengths.resize(tensions * unknowns, 0.0);
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            self.step(grid, k, triple, tensions);
            if k + 1 < grid.len() {
                self.jump(loads, load, k + 1, &poses[k + 1]);
            }
        }
        let tip = poses[grid.len()].rotation;
        let last = samples[samples.len() - 1].wrench.angular;
        let follower = loads.follower(grid.len());
        self.excess.clear();
        self.excess.extend(self.columns.iter().map(|c| Wrench {
            force: c.follower_force - load * tip.rotate(c.turn.cross(follower.force)),
            moment: tip.rotate(c.moment + c.turn.cross(last - load * follower.moment)),
        }));
    }

    /// Across the loads between two steps: a dead moment turns in the body frame, a follower force
    /// in the base frame.
    fn jump(&mut self, loads: &AppliedLoads, load: f64, k: usize, pose: &Pose) {
        let dead = load * loads.moment(k);
        if dead != Vec3::ZERO {
            let body = pose.rotation.conjugate().rotate(dead);
            for column in &mut self.columns {
                column.moment -= body.cross(column.turn);
            }
        }
        let force = load * loads.follower(k).force;
        if force != Vec3::ZERO {
            for column in &mut self.columns {
                column.follower_force -= pose.rotation.rotate(column.turn.cross(force));
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
                let push = sample.force_change(&stage);
                let mut wrench = BodyWrench { linear: push, angular: stage.moment };
                if tensions == 0 {
                    slope = rate(sample, &stage, push, &sample.tangent.solve(wrench));
                } else {
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    if let Some(crossing) =
                        c.checked_sub(unknowns - tensions).and_then(|j| crossings.get(j))
                    {
                        wrench = wrench - crossing.pull(&sample.strain).0;
                    }
                    let change = sample.tangent.solve(wrench);
                    slope = rate(sample, &stage, push, &change);
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

impl Sample {
    /// `δN`.
    #[inline]
    fn force_change(&self, at: &Column) -> Vec3 {
        let turned = self.wrench.linear.cross(at.turn);
        if at.follower_force == Vec3::ZERO {
            turned
        } else {
            turned + self.rotation.conjugate().rotate(at.follower_force)
        }
    }
}

/// Eq. (5), with `push` = `δN`.
#[inline]
fn rate(sample: &Sample, at: &Column, push: Vec3, change: &Strain) -> Column {
    let Sample { strain, wrench, .. } = sample;
    let (n, m) = (wrench.linear, wrench.angular);
    let (v, u) = (strain.linear, strain.angular);
    Column {
        turn: change.angular - u.cross(at.turn),
        moment: m.cross(change.angular) - u.cross(at.moment) + n.cross(change.linear)
            - v.cross(push),
        follower_force: Vec3::ZERO,
    }
}

/// Rate of a cable's length: what a unit tension does on a change of strain.
#[inline]
pub(super) fn work(pull: &BodyWrench, change: &Strain) -> f64 {
    pull.linear.dot(change.linear) + pull.angular.dot(change.angular)
}
