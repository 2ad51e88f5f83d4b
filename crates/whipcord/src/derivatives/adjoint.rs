//! The transpose of [`super::forward`]: from the sensitivity of something to the end of each step
//! and to the cables' lengths, its sensitivity to what acts within each stage.

use whipcord_numerics::{BUTCHER_5, UnitQuaternion, Vec3};

use super::effect::Forcing;
use super::elimination::StepPull;
use super::replay::{Ends, Replay, Spread, Stage, Swing};
use crate::statics::grid::Step;
use crate::statics::runge_kutta::STAGES;

/// Sensitivities of one scalar to the forcing of every stage; six to a step.
pub(super) fn stage_pulls(
    steps: &[Step],
    replay: &Replay,
    pulls: &[StepPull],
    (cables, rows): (usize, &dyn Fn(usize, usize) -> f64),
    out: &mut Vec<Forcing>,
) {
    out.clear();
    out.resize(STAGES * steps.len(), Forcing::default());
    for (k, (at, pull)) in steps.iter().zip(pulls).enumerate() {
        step(at, replay, k, pull, (cables, rows), &mut out[STAGES * k..STAGES * (k + 1)]);
    }
}

/// Sensitivity to quaternion and moment, or to their slopes.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    quaternion: [f64; 4],
    moment: Vec3,
}

impl Pull {
    fn add(&mut self, f: f64, other: &Self) {
        for (a, b) in self.quaternion.iter_mut().zip(&other.quaternion) {
            *a += f * b;
        }
        self.moment += f * other.moment;
    }
}

fn step(
    step: &Step,
    replay: &Replay,
    k: usize,
    pull: &StepPull,
    (cables, rows): (usize, &dyn Fn(usize, usize) -> f64),
    out: &mut [Forcing],
) {
    let table = &BUTCHER_5;
    let h = step.length;
    let ends = &replay.ends[k];
    let end = Pull { quaternion: end_pull(ends, pull.effect.turn), moment: pull.effect.moment };
    let mut slopes = [Pull::default(); STAGES];
    let spread = replay.spread(k);
    // To the rate of the force at each stage.
    let mut rates = [Vec3::ZERO; STAGES];
    for i in (0..STAGES).rev() {
        let weight = h * table.b[i];
        slopes[i].add(weight, &end);
        let stage = &replay.stages[STAGES * k + i];
        let (mut strain, mut curvature) = (Vec3::ZERO, Vec3::ZERO);
        let pulls = replay.pulls_at(STAGES * k + i, cables, step.active);
        for (cable, (exerted, _)) in pulls.iter().enumerate() {
            let length = rows(k, cable);
            strain += weight * length * exerted.linear;
            curvature += weight * length * exerted.angular;
        }
        let mut turned = TurnPull::default();
        for turn in replay.turns_at(k, i) {
            let worth = rows(k, turn.row);
            strain += worth * turn.by.strain;
            curvature += worth * turn.by.curvature;
            turned.y += worth * turn.by.y;
            turned.s += worth * turn.by.s;
        }
        let velocity = weight * pull.effect.shift;
        let (mut at, forcing) = transpose(stage, &slopes[i], velocity, (strain, curvature), turned);
        rates[i] += weight * pull.effect.force;
        out[i] = Forcing { torque: slopes[i].moment, rate: rates[i], ..forcing };
        if let Some(spread) = spread {
            let Spread { force, moment } = &spread[i];
            let mut turn = TurnPull::default();
            turn.of_body(stage, force, -rates[i]);
            turn.of_body(stage, moment, -slopes[i].moment);
            for (q, by_turn) in at.quaternion.iter_mut().zip(turn.quaternion(stage)) {
                *q += by_turn;
            }
        }
        for (rate, f) in rates[..i].iter_mut().zip(table.a[i]) {
            *rate += h * f * forcing.force;
        }
        for j in 0..i {
            let f = h * table.a[i][j];
            if f != 0.0 {
                slopes[j].add(f, &at);
            }
        }
    }
}

/// The transpose of eqs. (d1) and (d2).
fn transpose(
    stage: &Stage,
    slope: &Pull,
    velocity: Vec3,
    (mut strain, mut curvature): (Vec3, Vec3),
    mut turn: TurnPull,
) -> (Pull, Forcing) {
    let velocity = velocity + slope.moment.cross(stage.force);
    let swung = stage.rotation.transpose_mul(velocity);
    strain += swung;
    let turned = &stage.turned;
    turn.of_body(stage, &stage.velocity_swing, velocity);
    // Of the bracket that q multiplies in q′.
    let q = turned.quaternion;
    let [w, x, y, z] = slope.quaternion;
    let spin = q.conjugate() * UnitQuaternion { w, v: Vec3::new(x, y, z) };
    let (u, ratio) = (stage.strain.angular, 0.5 * turned.ratio);
    turn.y += ratio * (u.cross(spin.v) - spin.w * u);
    turn.s += (ratio - 0.5) * u.dot(spin.v);
    curvature += (0.5 * turned.scale) * spin.v;
    let [vn, vm, um] = &stage.compliance;
    let n = *vn * strain + *vm * curvature;
    let m = vm.transpose_mul(strain) + *um * curvature;
    turn.of_base(&stage.force_swing, n);
    turn.of_base(&stage.moment_swing, m);
    let at = Pull { quaternion: turn.quaternion(stage), moment: stage.rotation * m };
    let force = stage.rotation * n + stage.velocity.cross(slope.moment);
    (at, Forcing { force_balance: -n, moment_balance: -m, force, ..Forcing::default() })
}

/// Sensitivity to `(s, y)` of [`super::replay::Turned`].
#[derive(Clone, Copy, Debug, Default)]
struct TurnPull {
    s: f64,
    y: Vec3,
}

impl TurnPull {
    /// From that to a vector of the base frame, seen in the body frame.
    fn of_base(&mut self, swing: &Swing, pull: Vec3) {
        self.y += pull.cross(swing.arm);
        self.s += swing.rest.dot(pull);
    }

    /// From that to a vector of the body, seen in the base frame.
    fn of_body(&mut self, stage: &Stage, swing: &Swing, pull: Vec3) {
        let arm = stage.rotation.transpose_mul(pull) - stage.turned.short * pull;
        self.y += swing.arm.cross(arm);
        self.s += swing.rest.dot(pull);
    }

    /// To the quaternion of the stage before it is scaled back.
    fn quaternion(&self, stage: &Stage) -> [f64; 4] {
        (stage.turned.quaternion * UnitQuaternion { w: self.s, v: self.y }).wxyz()
    }
}

/// From the sensitivity to the turn of the end of a step to that to its quaternion.
fn end_pull(ends: &Ends, turn: Vec3) -> [f64; 4] {
    let q = ends.quaternion;
    let t = ends.turn * turn;
    let v = q.w * t + t.cross(q.v);
    [-q.v.dot(t), v.x, v.y, v.z]
}
