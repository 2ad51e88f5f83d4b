//! The transpose of [`super::forward`]: from the sensitivity of something to the end of each step
//! and to the cables' lengths, its sensitivity to what acts within each stage.

use whipcord_numerics::{BUTCHER_5, Vec3};

use super::elimination::StepPull;
use super::forward::Forcing;
use super::replay::{Replay, Spread, Stage};
use crate::cosserat::grid::Step;
use crate::cosserat::loaded::STAGES;

/// Sensitivities of one scalar to the forcing of every stage; six to a step.
pub(super) fn stage_pulls(
    steps: &[Step],
    replay: &Replay,
    pulls: &[StepPull],
    lengths: &[f64],
    out: &mut Vec<Forcing>,
) {
    out.clear();
    out.resize(STAGES * steps.len(), Forcing::default());
    for (k, (at, pull)) in steps.iter().zip(pulls).enumerate() {
        step(at, replay, k, pull, lengths, &mut out[STAGES * k..STAGES * (k + 1)]);
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
    lengths: &[f64],
    out: &mut [Forcing],
) {
    let table = &BUTCHER_5;
    let h = step.length;
    let end = Pull {
        quaternion: replay.ends[k].turn_by_end.map(|column| column.dot(pull.effect.turn)),
        moment: pull.effect.moment,
    };
    let mut slopes = [Pull::default(); STAGES];
    let spread = replay.spread(k);
    // To what the followers exert at each stage.
    let mut pushed = [Vec3::ZERO; STAGES];
    for i in (0..STAGES).rev() {
        let weight = h * table.b[i];
        slopes[i].add(weight, &end);
        let stage = &replay.stages[STAGES * k + i];
        let (mut strain, mut curvature) = (Vec3::ZERO, Vec3::ZERO);
        let pulls = replay.pulls_at(STAGES * k + i, lengths.len(), step.active);
        for ((exerted, _), length) in pulls.iter().zip(lengths) {
            strain += weight * length * exerted.linear;
            curvature += weight * length * exerted.angular;
        }
        let velocity = weight * pull.effect.shift;
        let (mut at, forcing) = transpose(stage, &slopes[i], velocity, strain, curvature);
        out[i] = forcing;
        if let Some(spread) = spread {
            pushed[i] -= weight * pull.effect.force;
            let Spread { force_by_turn, moment_by_turn } = &spread[i];
            for (j, q) in at.quaternion.iter_mut().enumerate() {
                *q += force_by_turn[j].dot(pushed[i]) - moment_by_turn[j].dot(slopes[i].moment);
            }
            for (push, f) in pushed[..i].iter_mut().zip(table.a[i]) {
                *push -= h * f * forcing.force;
            }
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
    mut strain: Vec3,
    mut curvature: Vec3,
) -> (Pull, Forcing) {
    let velocity = velocity + slope.moment.cross(stage.force);
    strain += stage.rotation.transpose_mul(velocity);
    let along =
        |column: &[f64; 4]| column.iter().zip(&slope.quaternion).map(|(a, b)| a * b).sum::<f64>();
    let [a, b, c] = &stage.spin_by_curvature;
    curvature += Vec3::new(along(a), along(b), along(c));
    let [vn, vm, um] = &stage.compliance;
    let n = *vn * strain + *vm * curvature;
    let m = vm.transpose_mul(strain) + *um * curvature;
    let quaternion = core::array::from_fn(|j| {
        stage.force_by_turn[j].dot(n)
            + stage.moment_by_turn[j].dot(m)
            + stage.velocity_by_turn[j].dot(velocity)
            + along(&stage.spin_by_turn[j])
    });
    let at = Pull { quaternion, moment: stage.rotation * m };
    let force = stage.rotation * n + stage.velocity.cross(slope.moment);
    (at, Forcing { force_balance: -n, moment_balance: -m, force })
}
