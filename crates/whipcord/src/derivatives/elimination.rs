//! The linear problem between base and tip.
//!
//! With `φₖ` the turn, `νₖ = (δM, δG)` the change of moment and force at the start of step k, base
//! frame, the maps of the steps and what acts within and between them give
//!
//! ```text
//! φₖ₊₁ = A φₖ + B νₖ + b,   νₖ₊₁ = C φₖ + D νₖ + d + K φₖ₊₁ − j,   φ₀ = 0,   νₙ = 0     (d3)
//! ```
//!
//! where `K` turns the followers at node k+1 and `j` is the wrench that is added there; the rows of `C`
//! and `D` for the force are those of the identity, but where followers are spread. Elimination
//! from the base carries `φₖ = Pₖ νₖ + qₖ`, with `Pₖ` the compliance of the part before node k. It
//! does not magnify errors as a single shot does, and costs one 3×3 inverse to a step where loads
//! are dead. [`Elimination::pull_back`] is the same run backwards, operation by operation.

use whipcord_numerics::{Mat3, Vec3};

use super::effect::Effect;
use super::forward::{Maps, StepMap};
use super::node_change::NodeChange;
use crate::shape::Wrench;
use crate::statics::hold::Critical;

/// The eliminated chain.
#[derive(Clone, Debug, Default)]
pub(super) struct Elimination {
    maps: Vec<StepMap>,
    steps: Vec<Eliminated>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Eliminated {
    /// `P` at the start of the step and at its end.
    before: [Mat3; 2],
    after: [Mat3; 2],
    /// `V⁻¹` of `νₖ₊₁ = V νₖ + w`, by (moment, force).
    gain: [[Mat3; 2]; 2],
    /// `K`: what a turn of the end adds to moment and force there; none under dead loads.
    follower: Option<[Mat3; 2]>,
    /// Whether the change of the force differs between start and end: where followers are.
    coupled: bool,
}

/// The sensitivity of something to what acts within a step and at its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepPull {
    /// To turn, moment, displacement and force at the end.
    pub effect: Effect,
    /// To the wrench added at the node at its end.
    pub added: Wrench,
}

impl Elimination {
    /// The map of a step, or of a span.
    pub fn map(&self, k: usize) -> &StepMap {
        &self.maps[k]
    }

    /// Turns moment and force just behind a node to those just in front of it, but for what is
    /// added there.
    pub fn arriving(&self, change: &mut NodeChange, node: usize) {
        if let Some(Eliminated { follower: Some([by_moment, by_force]), .. }) =
            node.checked_sub(1).and_then(|k| self.steps.get(k))
        {
            change.moment -= *by_moment * change.turn;
            change.force -= *by_force * change.turn;
        }
    }

    /// Eliminates from the base; `follower` is what turns with the section at the end of each step, base frame. Keeps the
    /// maps of the steps.
    pub fn eliminate(
        &mut self,
        maps: &mut Maps,
        follower: impl Fn(usize) -> Wrench,
    ) -> Result<(), Critical> {
        // What was kept before gives its memory to the next maps.
        core::mem::swap(&mut self.maps, &mut maps.steps);
        self.steps.clear();
        self.steps.reserve(self.maps.len());
        let mut before = [Mat3::ZERO; 2];
        for (k, map) in self.maps.iter().enumerate() {
            let [a, b_moment, b_force] = map.turn;
            let [c, d_moment, d_force] = map.moment;
            let turn = [a * before[0] + b_moment, a * before[1] + b_force];
            let mut moment = [c * before[0] + d_moment, c * before[1] + d_force];
            let wrench = follower(k);
            let follower = (wrench != Wrench::default())
                .then(|| [wrench.moment, wrench.force].map(Mat3::skew));
            let coupled = follower.is_some() || map.force.is_some();
            let (gain, after) = if coupled {
                let mut force = match map.force {
                    None => [Mat3::ZERO, Mat3::IDENTITY],
                    Some([e, f_moment, f_force]) => {
                        [e * before[0] + f_moment, e * before[1] + f_force]
                    }
                };
                if let Some([by_moment, by_force]) = follower {
                    moment = [moment[0] + by_moment * turn[0], moment[1] + by_moment * turn[1]];
                    force = [force[0] + by_force * turn[0], force[1] + by_force * turn[1]];
                }
                let gain = invert([moment, force]).ok_or(Critical)?;
                let column = |j: usize| turn[0] * gain[0][j] + turn[1] * gain[1][j];
                (gain, [column(0), column(1)])
            } else {
                let inverse = moment[0].inverse().ok_or(Critical)?;
                let gain = [[inverse, -(inverse * moment[1])], [Mat3::ZERO, Mat3::IDENTITY]];
                (gain, [turn[0] * gain[0][0], turn[0] * gain[0][1] + turn[1]])
            };
            self.steps.push(Eliminated { before, after, gain, follower, coupled });
            before = after;
        }
        Ok(())
    }

    /// The map of a step.
    pub fn step(&self, k: usize) -> &StepMap {
        &self.maps[k]
    }

    /// How every node moves with what acts on the end of each step and what is added at each node; nothing does in the
    /// steps before `first`.
    pub fn solve(
        &self,
        first: usize,
        effect: impl Fn(usize) -> Effect,
        added: impl Fn(usize) -> Wrench,
        nodes: &mut Vec<NodeChange>,
    ) {
        // On the way out a node holds `q` and the offset `w` of the step before it.
        nodes.clear();
        nodes.reserve(self.steps.len() + 1);
        nodes.resize(first + 1, NodeChange::default());
        let mut free = Vec3::ZERO;
        for (k, (step, map)) in self.steps.iter().zip(&self.maps).enumerate().skip(first) {
            let Effect { turn, moment, force, .. } = effect(k);
            let turn = map.turn[0] * free + turn;
            let Wrench { force: added_force, moment: added_moment } = added(k + 1);
            let mut moment = map.moment[0] * free + moment - added_moment;
            let mut force = force - added_force;
            if let Some([by_turn, ..]) = &map.force {
                force += *by_turn * free;
            }
            if let Some([by_moment, by_force]) = &step.follower {
                moment += *by_moment * turn;
                force += *by_force * turn;
            }
            free = turn - (step.after[0] * moment + step.after[1] * force);
            nodes.push(NodeChange { turn: free, position: Vec3::ZERO, moment, force });
        }
        let (mut moment, mut force) = (Vec3::ZERO, Vec3::ZERO);
        for (k, step) in self.steps.iter().enumerate().rev() {
            let offset = nodes[k + 1];
            (nodes[k + 1].moment, nodes[k + 1].force) = (moment, force);
            let (m, f) = (moment - offset.moment, force - offset.force);
            moment = step.gain[0][0] * m + step.gain[0][1] * f;
            force = if step.coupled { step.gain[1][0] * m + step.gain[1][1] * f } else { f };
            nodes[k].turn += step.before[0] * moment + step.before[1] * force;
        }
        (nodes[0].moment, nodes[0].force) = (moment, force);
        for (k, map) in self.maps.iter().enumerate() {
            let NodeChange { turn, moment, force, position } = nodes[k];
            let [by_turn, by_moment, by_force] = &map.shift;
            let shift = *by_turn * turn + *by_moment * moment + *by_force * force + effect(k).shift;
            nodes[k + 1].position = position + shift;
        }
    }

    /// The transpose of [`Self::solve`]: from the sensitivity of something to every node, and to the
    /// state at the start of each step by `extra`, its sensitivity to what acts.
    pub fn pull_back(
        &self,
        cotangents: &[NodeChange],
        extra: impl Fn(usize) -> [Vec3; 3],
        pulls: &mut Vec<StepPull>,
    ) {
        let n = self.steps.len();
        // Positions first: what a step adds moves every node behind it.
        pulls.clear();
        pulls.resize(n, StepPull::default());
        let mut behind = Vec3::ZERO;
        for k in (0..n).rev() {
            behind += cotangents[k + 1].position;
            pulls[k].effect.shift = behind;
        }
        // Backwards through the substitution: `offset` of each step in `added`, with its sign.
        let mut turns = Vec::with_capacity(n + 1);
        let (mut moment, mut force) = (Vec3::ZERO, Vec3::ZERO);
        for (k, (step, map)) in self.steps.iter().zip(&self.maps).enumerate() {
            let shift = pulls[k].effect.shift;
            let [by_turn, by_moment, by_force] = &map.shift;
            let [extra_turn, extra_moment, extra_force] = extra(k);
            let turn = cotangents[k].turn + by_turn.transpose_mul(shift) + extra_turn;
            moment += cotangents[k].moment + by_moment.transpose_mul(shift) + extra_moment;
            force += cotangents[k].force + by_force.transpose_mul(shift) + extra_force;
            turns.push(turn);
            moment += step.before[0].transpose_mul(turn);
            force += step.before[1].transpose_mul(turn);
            let gain = &step.gain;
            let mut next_force = gain[0][1].transpose_mul(moment);
            let mut next_moment = gain[0][0].transpose_mul(moment);
            next_force += gain[1][1].transpose_mul(force);
            if step.coupled {
                next_moment += gain[1][0].transpose_mul(force);
            }
            (moment, force) = (next_moment, next_force);
            pulls[k].added = Wrench { moment: -moment, force: -force };
        }
        turns.push(cotangents[n].turn);
        // Backwards through the elimination.
        let mut free = turns[n];
        for (k, (step, map)) in self.steps.iter().zip(&self.maps).enumerate().rev() {
            let Wrench { mut moment, mut force } = pulls[k].added;
            moment -= step.after[0].transpose_mul(free);
            force -= step.after[1].transpose_mul(free);
            let mut turn = free;
            if let Some([by_moment, by_force]) = &step.follower {
                turn += by_moment.transpose_mul(moment) + by_force.transpose_mul(force);
            }
            pulls[k].effect.turn = turn;
            pulls[k].effect.moment = moment;
            pulls[k].effect.force = force;
            pulls[k].added = Wrench { moment: -moment, force: -force };
            free = turns[k] + map.turn[0].transpose_mul(turn) + map.moment[0].transpose_mul(moment);
            if let Some([by_turn, ..]) = &map.force {
                free += by_turn.transpose_mul(force);
            }
        }
    }
}

/// The inverse of a matrix of four blocks; `None` when it is singular to working precision.
pub(super) fn invert([[a, b], [c, d]]: [[Mat3; 2]; 2]) -> Option<[[Mat3; 2]; 2]> {
    // The lower right block is the identity but for what followers turn.
    let d_inverse = d.inverse()?;
    let upper = b * d_inverse;
    let lower = d_inverse * c;
    let first = (a - b * lower).inverse()?;
    let corner = first * upper;
    Some([[first, -corner], [-(lower * first), d_inverse + lower * corner]])
}
