//! What a step does to small changes: of where it starts, of the force it carries, of its tensions
//! and of anything else that enters its sections.
//!
//! With `e` the explicit change of the left-hand sides of eqs. (1) and (2) and `δF` that of the
//! force, a stage maps the changes `δq` of its quaternion and `δM` of its moment to
//!
//! ```text
//! (δv, δu) = H⁻¹ ((δN, δMᵦ) − e),   δN = ∂N/∂q δq + Rᵀ δF,   δMᵦ = ∂Mᵦ/∂q δq + Rᵀ δM     (d1)
//! δq′ = ∂q′/∂q δq + ∂q′/∂u δu,   δp′ = ∂p′/∂q δq + R δv,   δM′ = F × δp′ + δF × p′         (d2)
//! ```
//!
//! to which followers that are spread along the rod add what they turn ([`super::replay::Spread`]);
//! and the tableau of the method combines them as it does the slopes themselves.

use whipcord_numerics::{BUTCHER_5, Mat3, Vec3};

use super::lanes::{LANES, Lane, LaneVec, cross, times, transpose_times};
use super::replay::{AXES, Replay, Stage};
use crate::cosserat::grid::Step;
use crate::cosserat::loaded::STAGES;

/// Turn (3), moment (3) and force (3) at the start of a step, base frame.
pub(super) const STATES: usize = 9;

/// How the end of a step moves with its start, base frame: by turn, moment and force there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepMap {
    pub turn: [Mat3; 3],
    pub moment: [Mat3; 3],
    /// Of the displacement over the step.
    pub shift: [Mat3; 3],
    /// Of the followers' force, which stays as it is where none are spread.
    pub force: Option<[Mat3; 3]>,
}

/// How the end of a step moves with something that acts within it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effect {
    pub turn: Vec3,
    pub moment: Vec3,
    pub shift: Vec3,
    pub force: Vec3,
}

/// What acts within a stage: the explicit change `e` of the section equations, and of the force.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Forcing {
    pub force_balance: Vec3,
    pub moment_balance: Vec3,
    pub force: Vec3,
}

impl Forcing {
    /// What a forcing is worth where the other is a sensitivity.
    pub fn dot(&self, other: &Self) -> f64 {
        self.force_balance.dot(other.force_balance)
            + self.moment_balance.dot(other.moment_balance)
            + self.force.dot(other.force)
    }
}

/// The maps of all steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Maps {
    pub steps: Vec<StepMap>,
    /// Effects on the ends: by steps, then inputs.
    pub effects: Vec<Effect>,
    /// Rates of the cables' lengths with the state at the start of a step, as (turn, moment, force):
    /// by steps, then cables.
    pub length_by_state: Vec<[Vec3; 3]>,
    /// The same with the inputs: by steps, then inputs, then cables.
    pub length_by_input: Vec<f64>,
    pub inputs: usize,
}

/// The columns of one pass.
#[derive(Clone, Copy, Debug, Default)]
struct Pass {
    quaternion: [Lane; 4],
    moment: LaneVec,
    force: LaneVec,
}

/// What a pass ends with.
#[derive(Clone, Copy, Debug, Default)]
struct Ended {
    turn: LaneVec,
    moment: LaneVec,
    shift: LaneVec,
    force: LaneVec,
}

/// `e` and `δF` at a stage, for each column of a pass.
#[derive(Clone, Copy, Debug, Default)]
struct Push {
    force_balance: LaneVec,
    moment_balance: LaneVec,
    force: LaneVec,
}

impl Maps {
    /// Maps of every step by its start, by the tensions, which are the first inputs, and by `more`
    /// inputs, whose `forcing` at a stage is given by step, stage and input.
    pub fn compute(
        &mut self,
        steps: &[Step],
        replay: &Replay,
        cables: usize,
        more: usize,
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
    ) {
        self.inputs = cables + more;
        self.steps.clear();
        self.effects.clear();
        self.length_by_state.clear();
        self.length_by_input.clear();
        self.length_by_input.resize(steps.len() * self.inputs * cables, 0.0);
        let columns = STATES + self.inputs;
        let mut lengths = vec![Lane::default(); cables];
        for (k, step) in steps.iter().enumerate() {
            let active = step.active;
            let force = replay.spread(k).map(|_| Default::default());
            let pass_of = if force.is_some() { pass::<true> } else { pass::<false> };
            let mut map = StepMap { force, ..StepMap::default() };
            let (effects, by_state) = (self.effects.len(), self.length_by_state.len());
            self.effects.resize(effects + self.inputs, Effect::default());
            self.length_by_state.resize(by_state + cables, Default::default());
            for first in (0..columns).step_by(LANES) {
                let pushes = self.pushes(replay, k, cables, active, first, forcing);
                lengths.fill(Lane::default());
                let start = start(replay, k, first);
                let ended = pass_of(step, replay, k, cables, &start, pushes.as_ref(), &mut lengths);
                for lane in 0..LANES.min(columns - first) {
                    let c = first + lane;
                    let (turn, moment) = (ended.turn.get(lane), ended.moment.get(lane));
                    let (shift, force) = (ended.shift.get(lane), ended.force.get(lane));
                    if c < STATES {
                        set_column(&mut map.turn[c / 3], c % 3, turn);
                        set_column(&mut map.moment[c / 3], c % 3, moment);
                        set_column(&mut map.shift[c / 3], c % 3, shift);
                        if let Some(map) = &mut map.force {
                            set_column(&mut map[c / 3], c % 3, force);
                        }
                        for (i, length) in lengths.iter().enumerate() {
                            self.length_by_state[by_state + i][c / 3][c % 3] = length.0[lane];
                        }
                    } else {
                        let input = c - STATES;
                        self.effects[effects + input] = Effect { turn, moment, shift, force };
                        let place = (k * self.inputs + input) * cables;
                        for (i, length) in lengths.iter().enumerate() {
                            self.length_by_input[place + i] = length.0[lane];
                        }
                    }
                }
            }
            self.steps.push(map);
        }
    }

    /// What acts on the columns of a pass; `None` where nothing does.
    fn pushes(
        &self,
        replay: &Replay,
        k: usize,
        cables: usize,
        active: usize,
        first: usize,
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
    ) -> Option<[Push; STAGES]> {
        if first + LANES <= STATES {
            return None;
        }
        let mut pushes = [Push::default(); STAGES];
        for (i, push) in pushes.iter_mut().enumerate() {
            let pulls = replay.pulls_at(STAGES * k + i, cables, active);
            for lane in 0..LANES {
                let Some(input) = (first + lane).checked_sub(STATES) else { continue };
                let forced = if input < cables {
                    let Some((pull, _)) = pulls.get(input) else { continue };
                    Forcing {
                        force_balance: pull.linear,
                        moment_balance: pull.angular,
                        force: Vec3::ZERO,
                    }
                } else if input < self.inputs {
                    forcing(k, i, input - cables)
                } else {
                    continue;
                };
                push.force_balance.set(lane, forced.force_balance);
                push.moment_balance.set(lane, forced.moment_balance);
                push.force.set(lane, forced.force);
            }
        }
        Some(pushes)
    }

    /// Effects of all inputs on the end of a step.
    pub fn effects_of(&self, k: usize) -> &[Effect] {
        &self.effects[k * self.inputs..(k + 1) * self.inputs]
    }
}

fn set_column(m: &mut Mat3, column: usize, v: Vec3) {
    for (row, value) in m.rows.iter_mut().zip([v.x, v.y, v.z]) {
        row[column] = value;
    }
}

/// The columns from `first` on at the start of a step: units of the state, nothing of the inputs.
fn start(replay: &Replay, k: usize, first: usize) -> Pass {
    let mut pass = Pass::default();
    for lane in 0..LANES {
        let c = first + lane;
        match c / 3 {
            0 => {
                for (q, value) in pass.quaternion.iter_mut().zip(replay.ends[k].start_by_turn[c]) {
                    q.0[lane] = value;
                }
            }
            1 => pass.moment.set(lane, AXES[c % 3]),
            2 => pass.force.set(lane, AXES[c % 3]),
            _ => {}
        }
    }
    pass
}

/// One step of a few columns; `lengths` gathers what they add to the cables. `SPREAD`: whether followers
/// are spread along it.
fn pass<const SPREAD: bool>(
    step: &Step,
    replay: &Replay,
    k: usize,
    cables: usize,
    start: &Pass,
    pushes: Option<&[Push; STAGES]>,
    lengths: &mut [Lane],
) -> Ended {
    let table = &BUTCHER_5;
    let h = step.length;
    let mut spins = [[Lane::default(); 4]; STAGES];
    let mut torques = [LaneVec::default(); STAGES];
    let mut end = *start;
    let mut shift = LaneVec::default();
    let spread = if SPREAD { replay.spread(k) } else { None };
    let mut pushed = [LaneVec::default(); STAGES];
    for i in 0..STAGES {
        let stage = &replay.stages[STAGES * k + i];
        let (mut q, mut moment) = (start.quaternion, start.moment);
        for j in 0..i {
            let f = h * table.a[i][j];
            if f != 0.0 {
                for (c, slope) in q.iter_mut().zip(&spins[j]) {
                    *c += f * *slope;
                }
                moment += f * torques[j];
            }
        }
        let push = pushes.map(|pushes| &pushes[i]);
        let mut force = match push {
            Some(push) => start.force + push.force,
            None => start.force,
        };
        if spread.is_some() {
            for (push, f) in pushed[..i].iter().zip(table.a[i]) {
                force += (-h * f) * *push;
            }
        }
        let mut slopes = slopes(stage, &q, &moment, &force, push);
        if let Some(spread) = spread {
            pushed[i] = combine(&spread[i].force_by_turn, &q);
            slopes.torque = slopes.torque - combine(&spread[i].moment_by_turn, &q);
            end.force += (-h * table.b[i]) * pushed[i];
        }
        (spins[i], torques[i]) = (slopes.spin, slopes.torque);
        let weight = h * table.b[i];
        if weight == 0.0 {
            continue;
        }
        for (c, slope) in end.quaternion.iter_mut().zip(&slopes.spin) {
            *c += weight * *slope;
        }
        end.moment += weight * slopes.torque;
        shift += weight * slopes.velocity;
        let pulls = replay.pulls_at(STAGES * k + i, cables, step.active);
        for (length, (pull, _)) in lengths.iter_mut().zip(pulls) {
            *length +=
                weight * (slopes.strain.dot(pull.linear) + slopes.curvature.dot(pull.angular));
        }
    }
    let mut turn = LaneVec::default();
    for (column, q) in replay.ends[k].turn_by_end.iter().zip(&end.quaternion) {
        turn += LaneVec { x: column.x * *q, y: column.y * *q, z: column.z * *q };
    }
    Ended { turn, moment: end.moment, shift, force: end.force }
}

/// What a stage returns for a few columns.
struct Slopes {
    spin: [Lane; 4],
    velocity: LaneVec,
    torque: LaneVec,
    strain: LaneVec,
    curvature: LaneVec,
}

/// Eqs. (d1) and (d2).
#[inline(always)]
fn slopes(
    stage: &Stage,
    q: &[Lane; 4],
    moment: &LaneVec,
    force: &LaneVec,
    push: Option<&Push>,
) -> Slopes {
    let mut n = combine(&stage.force_by_turn, q) + transpose_times(&stage.rotation, force);
    let mut m = combine(&stage.moment_by_turn, q) + transpose_times(&stage.rotation, moment);
    if let Some(push) = push {
        n = n - push.force_balance;
        m = m - push.moment_balance;
    }
    let [vn, vm, um] = &stage.compliance;
    let strain = times(vn, &n) + times(vm, &m);
    let curvature = transpose_times(vm, &n) + times(um, &m);
    let velocity = combine(&stage.velocity_by_turn, q) + times(&stage.rotation, &strain);
    // δF × p′ = −p′ × δF.
    let torque = cross(stage.force, &velocity) - cross(stage.velocity, force);
    let by_turn = &stage.spin_by_turn;
    let by_curvature = &stage.spin_by_curvature;
    let spin = core::array::from_fn(|r| {
        (by_turn[0][r] * q[0] + by_turn[1][r] * q[1])
            + (by_turn[2][r] * q[2] + by_turn[3][r] * q[3])
            + (by_curvature[0][r] * curvature.x
                + by_curvature[1][r] * curvature.y
                + by_curvature[2][r] * curvature.z)
    });
    Slopes { spin, velocity, torque, strain, curvature }
}

#[inline(always)]
fn combine(columns: &[Vec3; 4], q: &[Lane; 4]) -> LaneVec {
    let [a, b, c, d] = columns;
    LaneVec {
        x: (a.x * q[0] + b.x * q[1]) + (c.x * q[2] + d.x * q[3]),
        y: (a.y * q[0] + b.y * q[1]) + (c.y * q[2] + d.y * q[3]),
        z: (a.z * q[0] + b.z * q[1]) + (c.z * q[2] + d.z * q[3]),
    }
}
