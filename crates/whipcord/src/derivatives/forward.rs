//! What a step does to small changes: of where it starts, of the force it carries, of its tensions
//! and of anything else that enters its sections.
//!
//! With `e` the explicit change of the left-hand sides of eqs. (1) and (2) and `δF` that of the
//! force, a stage maps the changes `δq` of its quaternion and `δM` of its moment to
//!
//! ```text
//! (δv, δu) = H⁻¹ ((δN, δMᵦ) − e),   δN = ∂N/∂q δq + Rᵀ δF,   δMᵦ = ∂Mᵦ/∂q δq + Rᵀ δM     (d1)
//! δq′ = ½ (δq̂ ∘ u + q̂ ∘ δu),   δp′ = ∂p′/∂q δq + R δv,   δM′ = F × δp′ + δF × p′           (d2)
//! ```
//!
//! to which followers that are spread along the rod add what they turn ([`super::replay::Spread`]);
//! and the tableau of the method combines them as it does the slopes themselves.

use whipcord_numerics::{BUTCHER_5, Mat3, Vec3};

use pulp::{Arch, Simd, WithSimd};

use super::effect::{Effect, Forcing};
use super::replay::{AXES, Replay, Spread, Stage, Swing};
use crate::section::Strain;
use crate::section::lanes::{LANES, Lane, LaneVec, along, cross, times, transpose_times};
use crate::statics::grid::Step;
use crate::statics::runge_kutta::STAGES;

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

impl StepMap {
    /// Of a step of no length.
    pub const IDENTITY: Self = Self {
        turn: [Mat3::IDENTITY, Mat3::ZERO, Mat3::ZERO],
        moment: [Mat3::ZERO, Mat3::IDENTITY, Mat3::ZERO],
        shift: [Mat3::ZERO; 3],
        force: None,
    };

    /// The end by turn, moment and force at the start.
    pub fn apply(&self, start: [Vec3; 3]) -> Effect {
        let by = |row: &[Mat3; 3]| row[0] * start[0] + row[1] * start[1] + row[2] * start[2];
        Effect {
            turn: by(&self.turn),
            moment: by(&self.moment),
            shift: by(&self.shift),
            force: self.force.as_ref().map_or(start[2], by),
        }
    }

    /// What acts before the step, at its end.
    pub fn carry(&self, before: &Effect) -> Effect {
        let end = self.apply([before.turn, before.moment, before.force]);
        Effect { shift: before.shift + end.shift, ..end }
    }

    /// This step and the next.
    pub fn then(&self, next: &Self) -> Self {
        let force = self.force.unwrap_or(NO_FOLLOWERS);
        let by = |row: &[Mat3; 3]| -> [Mat3; 3] {
            core::array::from_fn(|j| {
                row[0] * self.turn[j] + row[1] * self.moment[j] + row[2] * force[j]
            })
        };
        let shift = by(&next.shift);
        Self {
            turn: by(&next.turn),
            moment: by(&next.moment),
            shift: core::array::from_fn(|j| self.shift[j] + shift[j]),
            force: match &next.force {
                Some(row) => Some(by(row)),
                None => self.force,
            },
        }
    }

    /// With what turns with the section at the end: `follower` says what a turn adds to moment and force.
    pub fn with_follower(mut self, [by_moment, by_force]: &[Mat3; 2]) -> Self {
        let mut force = self.force.unwrap_or(NO_FOLLOWERS);
        for j in 0..3 {
            self.moment[j] += *by_moment * self.turn[j];
            force[j] += *by_force * self.turn[j];
        }
        self.force = Some(force);
        self
    }

    /// With what acts at the end: moment and force there by the turn of the start and by the end.
    pub fn with(mut self, acting: impl Fn(Vec3, &Effect) -> [Vec3; 2]) -> Self {
        self.force = Some(self.force.unwrap_or(NO_FOLLOWERS));
        let before = self;
        for column in 0..STATES {
            let mut start = [Vec3::ZERO; 3];
            start[column / 3] = AXES[column % 3];
            let mut end = before.apply(start);
            let [moment, force] = acting(start[0], &end);
            end.moment += moment;
            end.force += force;
            self.set(column, &end);
        }
        self
    }

    /// Sets the column of one component of turn, moment and force, in this order.
    pub fn set(&mut self, column: usize, end: &Effect) {
        set_column(&mut self.turn[column / 3], column % 3, end.turn);
        set_column(&mut self.moment[column / 3], column % 3, end.moment);
        set_column(&mut self.shift[column / 3], column % 3, end.shift);
        if let Some(force) = &mut self.force {
            set_column(&mut force[column / 3], column % 3, end.force);
        }
    }
}

/// Of the force, where nothing turns with the rod.
const NO_FOLLOWERS: [Mat3; 3] = [Mat3::ZERO, Mat3::ZERO, Mat3::IDENTITY];

/// The maps of all steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Maps {
    pub steps: Vec<StepMap>,
    /// Effects on the ends: by steps, then inputs.
    pub effects: Vec<Effect>,
    /// Rates of the outputs, such as the cables' lengths, with the state at the start of a step, as (turn, moment, force):
    /// by steps, then outputs.
    pub length_by_state: Vec<[Vec3; 3]>,
    /// The same with the inputs: by steps, then inputs, then outputs.
    pub length_by_input: Vec<f64>,
    pub inputs: usize,
    /// Number of the outputs of a step.
    pub rows: usize,
    /// Rates of the outputs of a step, of a few columns.
    outputs: Vec<Lane>,
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

/// [`Forcing`] at a stage for each column of a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Push {
    force_balance: LaneVec,
    moment_balance: LaneVec,
    force: LaneVec,
    torque: LaneVec,
    rate: LaneVec,
}

impl Push {
    #[inline(always)]
    fn set(&mut self, lane: usize, forced: &Forcing) {
        self.force_balance.set(lane, forced.force_balance);
        self.moment_balance.set(lane, forced.moment_balance);
        self.force.set(lane, forced.force);
        self.torque.set(lane, forced.torque);
        self.rate.set(lane, forced.rate);
    }
}

impl Maps {
    /// Maps of every step by its start, by `pulls` inputs that are tensions, which are the first inputs, and by `more`
    /// inputs, whose `forcing` at a stage is given by step, stage and input.
    pub fn compute(
        &mut self,
        steps: &[Step],
        replay: &Replay,
        (cables, rows): (usize, usize),
        (pulls, more): (usize, usize),
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
    ) {
        self.prepare(steps.len(), pulls, more, rows);
        Arch::new().dispatch(AllSteps { maps: self, steps, replay, cables, pulls, forcing });
    }

    /// Room for the maps of so many steps by tensions and `more` inputs, with so many outputs.
    pub fn prepare(&mut self, steps: usize, cables: usize, more: usize, rows: usize) {
        (self.inputs, self.rows) = (cables + more, rows);
        self.steps.clear();
        self.steps.reserve(steps);
        self.effects.clear();
        self.effects.resize(steps * self.inputs, Effect::default());
        self.length_by_state.clear();
        self.length_by_state.resize(steps * rows, Default::default());
        self.length_by_input.clear();
        self.length_by_input.resize(steps * self.inputs * rows, 0.0);
    }

    /// What acts on the columns of a pass; `None` where nothing does.
    #[inline(always)]
    fn pushes(
        &self,
        replay: &Replay,
        k: usize,
        (cables, tensions): (usize, usize),
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
            let weights = replay.weights_at(STAGES * k + i, tensions);
            // How many tensions of a cable there are.
            let near = tensions / cables.max(1);
            for lane in 0..LANES {
                let Some(input) = (first + lane).checked_sub(STATES) else { continue };
                let forced = if input < tensions {
                    let Some((pull, _)) = pulls.get(input / near) else { continue };
                    let weight = weights.map_or(1.0, |weights| weights[input]);
                    Forcing {
                        force_balance: weight * pull.linear,
                        moment_balance: weight * pull.angular,
                        ..Forcing::default()
                    }
                } else if input < self.inputs {
                    forcing(k, i, input - tensions)
                } else {
                    continue;
                };
                push.set(lane, &forced);
            }
        }
        Some(pushes)
    }

    /// Rates of the outputs of a step with an input.
    pub fn outputs_of(&self, k: usize, input: usize) -> &[f64] {
        let first = (k * self.inputs + input) * self.rows;
        &self.length_by_input[first..first + self.rows]
    }

    /// Effects of all inputs on the end of a step.
    pub fn effects_of(&self, k: usize) -> &[Effect] {
        &self.effects[k * self.inputs..(k + 1) * self.inputs]
    }
}

/// [`Maps::compute`], compiled for each set of vector instructions; none of them fuses operations, so
/// that all give the same bits.
struct AllSteps<'a> {
    maps: &'a mut Maps,
    steps: &'a [Step],
    replay: &'a Replay,
    cables: usize,
    /// Inputs that are tensions.
    pulls: usize,
    forcing: &'a dyn Fn(usize, usize, usize) -> Forcing,
}

impl WithSimd for AllSteps<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { maps, steps, replay, cables, pulls, forcing } = self;
        let rows = maps.rows;
        let inputs = maps.inputs;
        let columns = STATES + inputs;
        let mut lengths = core::mem::take(&mut maps.outputs);
        lengths.clear();
        lengths.resize(rows, Lane::default());
        for (k, step) in steps.iter().enumerate() {
            let active = step.active;
            let force = replay.spread(k).map(|_| Default::default());
            let mut map = StepMap { force, ..StepMap::default() };
            for first in (0..columns).step_by(LANES) {
                let pushes = maps.pushes(replay, k, (cables, pulls), active, first, forcing);
                // Nothing moves where nothing acts: the effects stay zero.
                let rests = |push: &Push| *push == Push::default();
                if first >= STATES && pushes.is_some_and(|pushes| pushes.iter().all(rests)) {
                    continue;
                }
                lengths.fill(Lane::default());
                let start = start(replay, k, first);
                let pushes = pushes.as_ref();
                let ended = match replay.spread(k) {
                    Some(spread) => {
                        let acting = (pushes, Some(spread));
                        pass(step, replay, (k, cables), &start, acting, &mut lengths, |_, _| {})
                    }
                    None => {
                        let acting = (pushes, None);
                        pass(step, replay, (k, cables), &start, acting, &mut lengths, |_, _| {})
                    }
                };
                for lane in 0..LANES.min(columns - first) {
                    let c = first + lane;
                    let (turn, moment) = (ended.turn.get(lane), ended.moment.get(lane));
                    let (shift, force) = (ended.shift.get(lane), ended.force.get(lane));
                    if c < STATES {
                        map.set(c, &Effect { turn, moment, shift, force });
                        for (i, length) in lengths.iter().enumerate() {
                            maps.length_by_state[k * rows + i][c / 3][c % 3] = length.0[lane];
                        }
                    } else {
                        let input = c - STATES;
                        maps.effects[k * inputs + input] = Effect { turn, moment, shift, force };
                        let place = (k * inputs + input) * rows;
                        for (i, length) in lengths.iter().enumerate() {
                            maps.length_by_input[place + i] = length.0[lane];
                        }
                    }
                }
            }
            maps.steps.push(map);
        }
        maps.outputs = lengths;
    }
}

#[inline(always)]
pub(super) fn set_column(m: &mut Mat3, column: usize, v: Vec3) {
    for (row, value) in m.rows.iter_mut().zip([v.x, v.y, v.z]) {
        row[column] = value;
    }
}

/// The columns from `first` on at the start of a step: units of the state, nothing of the inputs.
#[inline(always)]
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

/// How the strains at the stages of step `k` change, whose start changes by turn, moment and force so, and in whose stages this acts
/// more; a step has so many outputs.
pub(super) fn stage_strains(
    step: &Step,
    replay: &Replay,
    (k, rows): (usize, usize),
    [turn, moment, force]: [Vec3; 3],
    forcing: impl Fn(usize) -> Forcing,
) -> [Strain; STAGES] {
    let mut start = Pass::default();
    for (axis, column) in replay.ends[k].start_by_turn.iter().enumerate() {
        for (q, value) in start.quaternion.iter_mut().zip(column) {
            q.0[0] += turn[axis] * value;
        }
    }
    start.moment.set(0, moment);
    start.force.set(0, force);
    let mut pushes = [Push::default(); STAGES];
    for (i, push) in pushes.iter_mut().enumerate() {
        push.set(0, &forcing(i));
    }
    let acting = (Some(&pushes), replay.spread(k));
    let mut strains = [Strain::default(); STAGES];
    let see = |i: usize, slopes: &Slopes| {
        let (linear, angular) = (slopes.strain.get(0), slopes.curvature.get(0));
        strains[i] = Strain { linear, angular };
    };
    // Of the outputs nothing is asked here.
    pass(step, replay, (k, 0), &start, acting, &mut vec![Lane::default(); rows], see);
    strains
}

/// Step `k` of a few columns on which `pushes` act, and of which followers spread along it make `spread`; `lengths` gathers what they
/// add to the cables, and `see` is shown what each stage returns.
#[inline(always)]
fn pass(
    step: &Step,
    replay: &Replay,
    (k, cables): (usize, usize),
    start: &Pass,
    (pushes, spread): (Option<&[Push; STAGES]>, Option<&[Spread; STAGES]>),
    lengths: &mut [Lane],
    mut see: impl FnMut(usize, &Slopes),
) -> Ended {
    let table = &BUTCHER_5;
    let h = step.length;
    let mut spins = [[Lane::default(); 4]; STAGES];
    let mut torques = [LaneVec::default(); STAGES];
    let mut end = *start;
    let mut shift = LaneVec::default();
    // Of the force.
    let mut rates = [LaneVec::default(); STAGES];
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
        if spread.is_some() || push.is_some() {
            for (rate, f) in rates[..i].iter().zip(table.a[i]) {
                force += (h * f) * *rate;
            }
        }
        let mut slopes = slopes(stage, &q, &moment, &force, push);
        if let Some(push) = push {
            slopes.torque += push.torque;
            rates[i] = push.rate;
        }
        if let Some(spread) = spread {
            rates[i] = rates[i] - to_base(stage, &spread[i].force, &slopes.turn);
            slopes.torque = slopes.torque - to_base(stage, &spread[i].moment, &slopes.turn);
        }
        if spread.is_some() || push.is_some() {
            end.force += (h * table.b[i]) * rates[i];
        }
        (spins[i], torques[i]) = (slopes.spin, slopes.torque);
        see(i, &slopes);
        for turn in replay.turns_at(k, i) {
            let by = &turn.by;
            lengths[turn.row] += slopes.strain.dot(by.strain)
                + slopes.curvature.dot(by.curvature)
                + slopes.turn.y.dot(by.y)
                + by.s * slopes.turn.s;
        }
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
        // The lengths are the first outputs.
        for (length, (pull, _)) in lengths.iter_mut().zip(pulls) {
            *length +=
                weight * (slopes.strain.dot(pull.linear) + slopes.curvature.dot(pull.angular));
        }
    }
    let ends = &replay.ends[k];
    // 2 f² (δq ∘ q*).
    let [w, x, y, z] = end.quaternion;
    let (change, q) = (LaneVec { x, y, z }, ends.quaternion);
    let turn = ends.turn * (q.w * change - along(q.v, w) + cross(q.v, &change));
    Ended { turn, moment: end.moment, shift, force: end.force }
}

/// What a stage returns for a few columns.
struct Slopes {
    turn: LaneTurn,
    spin: [Lane; 4],
    velocity: LaneVec,
    torque: LaneVec,
    strain: LaneVec,
    curvature: LaneVec,
}

/// `(s, y)` of [`super::replay::Turned`].
struct LaneTurn {
    s: Lane,
    y: LaneVec,
}

/// Eqs. (d1) and (d2).
#[inline(always)]
fn slopes(
    stage: &Stage,
    &[w, x, y, z]: &[Lane; 4],
    moment: &LaneVec,
    force: &LaneVec,
    push: Option<&Push>,
) -> Slopes {
    let turned = &stage.turned;
    let (q, change) = (turned.quaternion, LaneVec { x, y, z });
    let turn = LaneTurn {
        s: q.w * w + change.dot(q.v),
        y: q.w * change - along(q.v, w) - cross(q.v, &change),
    };
    let LaneTurn { s, y } = &turn;
    let to_body = |swing: &Swing| cross(swing.arm, y) + along(swing.rest, *s);
    let mut n = to_body(&stage.force_swing) + transpose_times(&stage.rotation, force);
    let mut m = to_body(&stage.moment_swing) + transpose_times(&stage.rotation, moment);
    if let Some(push) = push {
        n = n - push.force_balance;
        m = m - push.moment_balance;
    }
    let [vn, vm, um] = &stage.compliance;
    let strain = times(vn, &n) + times(vm, &m);
    let curvature = transpose_times(vm, &n) + times(um, &m);
    let swing = &stage.velocity_swing;
    // y × arm.
    let swung = -cross(swing.arm, y);
    let velocity =
        times(&stage.rotation, &(strain + swung)) - turned.short * swung + along(swing.rest, *s);
    // δF × p′ = −p′ × δF.
    let torque = cross(stage.force, &velocity) - cross(stage.velocity, force);
    let u = stage.strain.angular;
    let (half, ratio) = (0.5 * turned.scale, 0.5 * turned.ratio);
    let (b, a) = (
        along(u, (ratio - 0.5) * *s) - ratio * cross(u, y) + half * curvature,
        -(ratio * y.dot(u)),
    );
    let spun = q.w * b + along(q.v, a) + cross(q.v, &b);
    let spin = [q.w * a - b.dot(q.v), spun.x, spun.y, spun.z];
    Slopes { turn, spin, velocity, torque, strain, curvature }
}

/// `∂(R x)` of a vector of the body.
#[inline(always)]
fn to_base(stage: &Stage, swing: &Swing, turn: &LaneTurn) -> LaneVec {
    let swung = -cross(swing.arm, &turn.y);
    times(&stage.rotation, &swung) - stage.turned.short * swung + along(swing.rest, turn.s)
}
