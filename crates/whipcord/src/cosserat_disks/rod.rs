//! The rod of one span as an initial value problem, and its linearisation.
//!
//! In the frame of the disk it starts from, with the force `f` and the moment `m` that everything
//! beyond a cut exerts on the *rod* there,
//!
//! ```text
//! R′ = R û,   p′ = R v,   m′ = −p′ × f − l,   f′ = −(loads)      (v, u) = ξ* + K⁻¹ (Rᵀf, Rᵀm)   (1)
//! ```
//!
//! where `l` is the moment spread along the rod. The force of dead loads is known beforehand; that of
//! followers, `R f` of each where it acts, is summed up on the way.
//!
//! No cable is in its sections: cables pull at the disks alone. Butcher's Runge–Kutta method of
//! order 5 integrates; the classical one takes the variations
//!
//! ```text
//! η′ = δu − u × η,   ζ′ = η × v + δv − u × ζ,   μ′ = −δu × M − u × μ − δv × N − v × δN          (2)
//! (δv, δu) = K⁻¹ (δN, μ),   δN = N × η + Rᵀ δf
//! ```
//!
//! (body frame: rotation, displacement, moment) from start, middle and end of each step.

use whipcord_numerics::{BUTCHER_5, Pose, Twist, UnitQuaternion, Vec3};

use super::anchors::{Anchors, ChordChange, Varied};
use super::chord::Chord;
use super::layout::{Frame, Mesh};
use super::span::Taut;
use super::unloaded_span;
use super::variation::End;
use super::variation::Sample;
use super::variation::Variation;
use crate::section::BodyWrench;
use crate::shape::Wrench;
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::runge_kutta::{NODE_OF_STAGE, STAGES, advance, pack, unpack};
use whipcord_numerics::weighted_sum;

/// How many of the grid's nodes lie in a step, its ends included.
const NODES: usize = 5;

/// Loads inside a span, as seen from the disk it starts from.
#[derive(Clone, Copy, Debug)]
pub(super) struct InSpan<'a> {
    pub applied: &'a AppliedLoads,
    /// Factor on all loads.
    pub load: f64,
    /// From the base frame to that of the disk.
    pub to_disk: UnitQuaternion,
    /// Dead force at the start of the span, base frame.
    pub at_start: Vec3,
}

/// Integrates eqs. (1) over the steps of a span from the wrench at its start. `poses` takes the
/// poses at the ends of the steps, `samples` three of them to each step, and the chords those of the anchors.
#[inline(always)]
pub(super) fn integrate(
    grid: &Grid,
    steps: core::ops::Range<usize>,
    wrench: BodyWrench,
    span: &InSpan<'_>,
    (anchors, chords): (&Anchors<'_>, &mut [Chord]),
    poses: &mut [Pose],
    samples: &mut [Sample],
) -> End {
    if !span.acts(steps.clone()) {
        let (pose, wrench) =
            unloaded_span::integrate(grid, steps, wrench, (anchors, chords), poses, samples);
        let moment = wrench.angular - pose.position.cross(wrench.linear);
        return End { pose, moment, followers: Vec3::ZERO };
    }
    let mut pulled = wrench.linear;
    let table = &BUTCHER_5;
    let (first, last) = (steps.start, steps.end);
    let mut state = pack(UnitQuaternion::IDENTITY, Vec3::ZERO, wrench.angular);
    let mut followers = Vec3::ZERO;
    for k in steps {
        let h = grid.steps[k].length;
        let mut slopes = [[0.0; 10]; STAGES];
        let line = span.applied.line(k);
        let mut pushes = [Vec3::ZERO; STAGES];
        for i in 0..STAGES {
            let at = advance(&state, &slopes[..i], &table.a[i], h);
            let (rotation, position, moment) = unpack(&at);
            let (node, _) = grid.shooting.at(k, NODE_OF_STAGE[i], 0);
            let dead = span.dead(k, NODE_OF_STAGE[i]);
            let mut force = pulled + dead - followers;
            if line.is_some() {
                force -= h * weighted_sum(&pushes[..i], &table.a[i]);
            }
            let to_body = rotation.conjugate();
            let local =
                BodyWrench { linear: to_body.rotate(force), angular: to_body.rotate(moment) };
            let strain = node.section.bare_strain(local);
            let slot = match i {
                0 => Some(0),
                3 => Some(1),
                5 => Some(2),
                _ => None,
            };
            if let Some(sample) = slot.and_then(|j| samples.get_mut(3 * (k - first) + j)) {
                *sample = Sample { strain, wrench: local, rotation, position, dead };
            }
            let velocity = rotation.rotate(strain.linear);
            let mut moment_rate = force.cross(velocity);
            if let Some(line) = line {
                let t = table.c[i];
                pushes[i] = span.load * rotation.rotate(line.follower_force(t));
                let turned = rotation.rotate(line.follower_moment(t));
                moment_rate -= span.load * (span.to_disk.rotate(line.moment(t)) + turned);
            }
            slopes[i] = pack(
                rotation * UnitQuaternion { w: 0.0, v: strain.angular * 0.5 },
                velocity,
                moment_rate,
            );
        }
        if line.is_some() {
            followers += h * weighted_sum(&pushes, &table.b);
        }
        let (rotation, position, mut moment) = unpack(&advance(&state, &slopes, &table.b, h));
        if k + 1 < last {
            let follower = span.applied.follower(k + 1);
            followers += span.load * rotation.rotate(follower.force);
            moment -= span.load
                * (span.to_disk.rotate(span.applied.moment(k + 1))
                    + rotation.rotate(follower.moment));
        }
        let pose = Pose { position, rotation };
        if !anchors.at.is_empty() {
            let pull = anchors.pull(k + 1, &pose, chords);
            pulled += pull.linear;
            moment += pull.angular - position.cross(pull.linear);
        }
        state = pack(rotation, position, moment);
        poses[k - first] = pose;
    }
    let (rotation, position, moment) = unpack(&state);
    End { pose: Pose { position, rotation }, moment, followers }
}

/// Samples of all spans from the wrenches at their starts and the loads inside them, with these tensions of all passages;
/// `chords` takes those of the anchors.
pub(super) fn sample<'a>(
    (frame, mesh): (&Frame, &Mesh),
    tensions: &[f64],
    chords: &mut [Chord],
    wrench: impl Fn(usize) -> BodyWrench,
    inside: impl Fn(usize) -> Option<InSpan<'a>>,
    samples: &mut Vec<Sample>,
    poses: &mut Vec<Pose>,
) {
    samples.clear();
    samples.resize(3 * mesh.grid.len(), Sample::default());
    poses.clear();
    poses.resize(mesh.grid.len(), Pose::IDENTITY);
    for (k, steps) in mesh.spans.iter().enumerate() {
        let slots = &mut samples[3 * steps.start..3 * steps.end];
        let poses = &mut poses[steps.clone()];
        let (grid, span, steps) = (&mesh.grid, &frame.spans[k], steps.clone());
        let passages = span.first..span.first + span.passages.len();
        let (at, tensions) = (mesh.anchors_of(span), &tensions[passages.clone()]);
        let anchors = Anchors { at, passages: &span.passages, tensions };
        let anchors = (&anchors, &mut chords[passages]);
        match inside(k) {
            Some(loads) => {
                integrate(grid, steps, wrench(k), &loads, anchors, poses, slots);
            }
            None => {
                unloaded_span::integrate(grid, steps, wrench(k), anchors, poses, slots);
            }
        }
    }
}

impl<'a> InSpan<'a> {
    /// Of the span that starts with step `first` from a disk turned so.
    pub fn at(applied: &'a AppliedLoads, load: f64, disk: UnitQuaternion, first: usize) -> Self {
        Self { applied, load, to_disk: disk.conjugate(), at_start: applied.force(first, 0) }
    }

    /// Whether any load acts between the ends of these steps.
    #[inline]
    pub fn acts(&self, steps: core::ops::Range<usize>) -> bool {
        let Self { applied, at_start, .. } = *self;
        let within = steps.start + 1..steps.end;
        steps.clone().any(|k| applied.line(k).is_some())
            || steps.clone().any(|k| (0..NODES).any(|node| applied.force(k, node) != at_start))
            || within.clone().any(|place| applied.moment(place) != Vec3::ZERO)
            || within.clone().any(|place| *applied.follower(place) != Wrench::default())
    }

    /// Dead load between the start of the span and a node, in the frame of the disk, negative: what
    /// it adds to the force at the node.
    fn dead(&self, k: usize, node: usize) -> Vec3 {
        self.load * self.unit_dead(k, node)
    }

    /// The same of all of the load.
    fn unit_dead(&self, k: usize, node: usize) -> Vec3 {
        self.to_disk.rotate(self.applied.force(k, node) - self.at_start)
    }
}

/// What [`linearise`] varies.
#[derive(Clone, Copy, Debug)]
pub(super) enum By {
    /// The wrench at the start.
    Wrench(BodyWrench),
    /// The direction of the dead loads, as when the disk turns about this axis under them.
    Turn(Vec3),
    /// The factor on all loads.
    Load,
    /// The tension of an anchor's cable.
    Tension(usize),
}

/// Eqs. (2) over a span: the variation at its end, with the change of the force less that by the anchors. `changes` takes those
/// of the anchors' chords.
#[inline(always)]
pub(super) fn linearise(
    grid: &Grid,
    steps: core::ops::Range<usize>,
    taut: &Taut<'_>,
    span: &InSpan<'_>,
    by: By,
    changes: &mut [ChordChange],
) -> Variation {
    const STAGES: [(usize, f64, f64); 4] =
        [(0, 0.0, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 0.5, 1.0 / 3.0), (2, 1.0, 1.0 / 6.0)];
    let (axis, start) = match by {
        By::Turn(axis) => (axis, BodyWrench::default()),
        By::Wrench(wrench) => (Vec3::ZERO, wrench),
        By::Load | By::Tension(_) => (Vec3::ZERO, BodyWrench::default()),
    };
    let pulled = if let By::Tension(anchor) = by { Some(anchor) } else { None };
    let anchors = taut.anchors();
    // Of the force by the anchors.
    let mut of_anchors = Vec3::ZERO;
    let by_load = matches!(by, By::Load);
    let (force, moment) = (start.linear, start.angular);
    let mut at = Variation { force, moment, ..Variation::default() };
    let (first, last) = (steps.start, steps.end);
    for k in steps {
        let h = grid.steps[k].length;
        let triple = &taut.samples[3 * (k - first)..3 * (k - first) + 3];
        let line = span.applied.line(k);
        let start = at;
        let mut slope = Variation::default();
        for (q, reach, weight) in STAGES {
            let (node, _) = grid.shooting.at(k, 2 * q, 0);
            let sample = &triple[q];
            let stage = start.plus(reach * h, &slope);
            let Sample { strain, wrench, rotation, dead, .. } = *sample;
            let Twist { linear: v, angular: u } = strain;
            let (n, m) = (wrench.linear, wrench.angular);
            let turned = if by_load {
                span.unit_dead(k, 2 * q)
            } else if axis == Vec3::ZERO {
                Vec3::ZERO
            } else {
                dead.cross(axis)
            };
            let push = n.cross(stage.turn) + rotation.conjugate().rotate(stage.force + turned);
            let change = node
                .section
                .yielding(&sample.strain, BodyWrench { linear: push, angular: stage.moment });
            let (dv, du) = (change.linear, change.angular);
            slope = Variation {
                turn: du - u.cross(stage.turn),
                shift: stage.turn.cross(v) + dv - u.cross(stage.shift),
                moment: m.cross(du) - u.cross(stage.moment) + n.cross(dv) - v.cross(push),
                force: Vec3::ZERO,
            };
            if let Some(line) = line {
                let follower = span.load * line.follower_force(reach);
                slope.force -= rotation.rotate(stage.turn.cross(follower));
                let dead = span.to_disk.rotate(span.load * line.moment(reach));
                let to_body = rotation.conjugate();
                slope.moment -= to_body.rotate(dead).cross(stage.turn);
                slope.moment -= to_body.rotate(dead.cross(axis));
                if by_load {
                    slope.force -= rotation.rotate(line.follower_force(reach));
                    let moment = span.to_disk.rotate(line.moment(reach));
                    slope.moment -= to_body.rotate(moment) + line.follower_moment(reach);
                }
            }
            at = at.plus(weight * h, &slope);
        }
        if k + 1 < last {
            let rotation = triple[2].rotation;
            let dead = span.to_disk.rotate(span.load * span.applied.moment(k + 1));
            let to_body = rotation.conjugate();
            at.moment -= to_body.rotate(dead).cross(at.turn) + to_body.rotate(dead.cross(axis));
            let follower = span.load * span.applied.follower(k + 1).force;
            at.force -= rotation.rotate(at.turn.cross(follower));
            if by_load {
                let follower = span.applied.follower(k + 1);
                let moment = span.to_disk.rotate(span.applied.moment(k + 1));
                at.moment -= to_body.rotate(moment) + follower.moment;
                at.force -= rotation.rotate(follower.force);
            }
        }
        if anchors.at.iter().any(|anchor| anchor.node == k + 1) {
            let Sample { rotation, position, .. } = triple[2];
            let moved = Twist { linear: at.shift, angular: at.turn };
            let mut varied = Varied { chords: taut.chords, pulled, changes: &mut *changes };
            let change = anchors.change(k + 1, rotation, &moved, &mut varied);
            let pull = anchors.pull_of(k + 1, taut.chords);
            let to_body = rotation.conjugate();
            let moment = pull.angular - position.cross(pull.linear);
            let change_of_moment = change.angular
                - position.cross(change.linear)
                - rotation.rotate(at.shift).cross(pull.linear);
            at.moment += to_body.rotate(change_of_moment) + to_body.rotate(moment).cross(at.turn);
            at.force += change.linear;
            of_anchors += change.linear;
        }
    }
    at.force -= of_anchors;
    at
}
