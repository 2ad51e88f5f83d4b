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
//! where `qⱼ = (tⱼ, rⱼ × tⱼ)`. A dead moment `l` that is spread along the rod adds `−(Rᵀl) × η` to `μ′`;
//! followers `f` that are spread give `δG′ = −R (η × f)`. The classical Runge–Kutta method takes it from
//! start, middle and end of each step: to order 4, as fine as Newton's method needs it.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::elimination::Change;
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
    pub columns: Vec<Column>,
}

/// Change of rotation and moment with one unknown, in the body frame, and of the followers' force in
/// the base frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    turn: Vec3,
    moment: Vec3,
    follower_force: Vec3,
    /// Change of the load factor: 1 in the column of that unknown.
    load: f64,
}

impl Column {
    /// `LINE`: whether the followers' force changes within a step.
    #[inline]
    fn plus<const LINE: bool>(self, f: f64, slope: Self) -> Self {
        let (turn, moment) = (self.turn + f * slope.turn, self.moment + f * slope.moment);
        let mut follower_force = self.follower_force;
        if LINE {
            follower_force += f * slope.follower_force;
        }
        Self { turn, moment, follower_force, ..self }
    }
}

/// What is spread along the rod at a sample, per metre, at a load of 1.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    /// In the body frame.
    dead_moment: Vec3,
    follower: Wrench,
    load: f64,
}

impl Spread {
    /// What it adds to the rates of moment and followers' force.
    #[inline]
    fn change(&self, sample: &Sample, at: &Column, slope: &mut Column) {
        let (load, follower) = (self.load, &self.follower);
        slope.moment -=
            load * self.dead_moment.cross(at.turn) + at.load * (self.dead_moment + follower.moment);
        let pushed = load * at.turn.cross(follower.force) + at.load * follower.force;
        slope.follower_force = -sample.rotation.rotate(pushed);
    }
}

impl From<Column> for Change {
    fn from(column: Column) -> Self {
        Self { turn: column.turn, moment: column.moment, force: column.follower_force }
    }
}

/// Stages of the classical Runge–Kutta method: the sample each uses, how far along the slope before
/// it lies, and its weight.
const STAGES: [(usize, f64, f64); 4] =
    [(0, 0.0, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 0.5, 1.0 / 3.0), (2, 1.0, 1.0 / 6.0)];

/// Which unknowns a step of its own is differentiated by: rotation and moment at its start, then
/// the followers' force there, the load factor, and the first so many tensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unknowns {
    pub follower_force: bool,
    pub load: bool,
    pub tensions: usize,
}

impl Unknowns {
    /// Their number.
    pub fn count(&self) -> usize {
        6 + if self.follower_force { 3 } else { 0 } + usize::from(self.load) + self.tensions
    }
}

impl Sensitivity {
    /// The transition over step `k` and across the loads at its end, into [`Self::columns`] and
    /// [`Self::lengths`]; `end` is the rotation there.
    #[expect(clippy::too_many_arguments, reason = "a step, its samples, and what it is asked for")]
    pub fn transition(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        k: usize,
        samples: &[Sample],
        end: UnitQuaternion,
        by: Unknowns,
    ) {
        let unknowns = by.count();
        self.columns.clear();
        self.columns.resize(unknowns, Column::default());
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.columns[j].turn = axis;
            self.columns[3 + j].moment = axis;
            if by.follower_force {
                self.columns[6 + j].follower_force = axis;
            }
        }
        if by.load {
            self.columns[unknowns - by.tensions - 1].load = 1.0;
        }
        self.lengths.clear();
        self.lengths.resize(by.tensions * unknowns, 0.0);
        self.step(grid, loads, load, k, samples, by.tensions);
        self.jump(loads, load, k + 1, end);
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
            self.step(grid, loads, load, k, triple, tensions);
            if k + 1 < grid.len() {
                self.jump(loads, load, k + 1, poses[k + 1].rotation);
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
    fn jump(&mut self, loads: &AppliedLoads, load: f64, k: usize, rotation: UnitQuaternion) {
        let dead = loads.moment(k);
        if dead != Vec3::ZERO {
            let body = rotation.conjugate().rotate(dead);
            for column in &mut self.columns {
                column.moment -= load * body.cross(column.turn) + column.load * body;
            }
        }
        let follower = loads.follower(k);
        if *follower != Wrench::default() {
            for column in &mut self.columns {
                let force = load * column.turn.cross(follower.force) + column.load * follower.force;
                column.follower_force -= rotation.rotate(force);
                column.moment -= column.load * follower.moment;
            }
        }
    }

    #[inline]
    fn step(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        k: usize,
        samples: &[Sample],
        tensions: usize,
    ) {
        if let Some(line) = loads.line(k) {
            let spread = [0, 1, 2].map(|q: usize| {
                let t = 0.5 * q as f64;
                Spread {
                    dead_moment: samples[q].rotation.conjugate().rotate(line.moment(t)),
                    follower: Wrench {
                        force: line.follower_force(t),
                        moment: line.follower_moment(t),
                    },
                    load,
                }
            });
            self.step_of::<true>(grid, loads, k, samples, &spread, tensions);
        } else {
            self.step_of::<false>(grid, loads, k, samples, &[Spread::default(); 3], tensions);
        }
    }

    fn step_of<const LINE: bool>(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        k: usize,
        samples: &[Sample],
        spread: &[Spread; 3],
        tensions: usize,
    ) {
        let step = grid.steps[k];
        let unknowns = self.columns.len();
        let h = step.length;
        for c in 0..unknowns {
            let start = self.columns[c];
            let mut end = start;
            let mut slope = Column::default();
            for (q, reach, weight) in STAGES {
                let sample = &samples[q];
                let stage = start.plus::<LINE>(reach * h, slope);
                let mut push = sample.force_change(&stage);
                if start.load != 0.0 {
                    let force = loads.force(k, SAMPLED_NODES[q]);
                    push += start.load * sample.rotation.conjugate().rotate(force);
                }
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
                if LINE {
                    spread[q].change(sample, &stage, &mut slope);
                }
                end = end.plus::<LINE>(weight * h, slope);
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
        ..Column::default()
    }
}

/// Rate of a cable's length: what a unit tension does on a change of strain.
#[inline]
pub(super) fn work(pull: &BodyWrench, change: &Strain) -> f64 {
    pull.linear.dot(change.linear) + pull.angular.dot(change.angular)
}
