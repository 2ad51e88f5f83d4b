//! One span with its cables: how the next disk stands on this one.
//!
//! A cable runs straight from the hole `h₀` of this disk to the hole `h₁` of the next one, which
//! stands at `(Q, p)`: with the chord `c = p + Q h₁ − h₀`, its length `ℓ` and direction `t = c/ℓ`, it
//! takes its share of the total wrench `(N, M)` at the cut just beyond this disk, and the rod has the
//! rest `w = (n, m)`:
//!
//! ```text
//! w + Σ τᵢ (tᵢ, h₀ᵢ × tᵢ) = (N, M),      (Q, p) = the rod's end under w, eqs. (1)          (3)
//! ```
//!
//! six equations for the six components of `w`: the conditions for a minimum of the rod's energy and
//! `Σ τᵢ ℓᵢ`, less the work of `(N, M)`.

use whipcord_numerics::{Mat3, Pose, UnitQuaternion, Vec3};

use super::anchors::{Anchors, ChordChange};
use super::between_disks::Span;
use super::chord::Chord;
use super::chord::along_cable;
use super::chord::unit_pull;
use super::variation::{End, Sample, Variation};
use crate::section::BodyWrench;
use crate::statics::passages::Anchor;

/// A cable's piece that has no length left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vanished {
    pub cable: usize,
}

/// Of the distance between the disks: below it a piece of cable counts as gone.
const LEAST_CHORD: f64 = 1e-3;

/// The chords of a span whose far disk stands at `pose`, but for those that end at anchors before it, which are known.
#[inline(always)]
pub(super) fn draw(span: &Span, pose: &Pose, chords: &mut [Chord]) -> Result<(), Vanished> {
    let way = pose.position.norm();
    for (passage, chord) in span.passages.iter().zip(chords) {
        if !passage.is_anchored_inside() {
            *chord = Chord::between(passage, pose);
        }
        let at_rest = (passage.far - passage.near).norm() + passage.reach * way;
        if chord.length.is_nan() || chord.length <= LEAST_CHORD * at_rest {
            return Err(Vanished { cable: passage.cable });
        }
    }
    Ok(())
}

/// The chords of a span whose far disk stands at `pose`, with anchors before it that stand where they would on an arc.
pub(super) fn estimate(span: &Span, pose: &Pose, chords: &mut [Chord]) -> Result<(), Vanished> {
    for (passage, chord) in span.passages.iter().zip(&mut *chords) {
        if passage.is_anchored_inside() {
            let part = passage.reach;
            let rotation = UnitQuaternion::exp(pose.rotation.log() * part);
            *chord = Chord::between(passage, &Pose { position: pose.position * part, rotation });
        }
    }
    draw(span, pose, chords)
}

/// `Σ τᵢ (tᵢ, h₀ᵢ × tᵢ)`.
#[inline(always)]
pub(super) fn pull(span: &Span, chords: &[Chord], tensions: &[f64]) -> BodyWrench {
    let mut sum = BodyWrench::default();
    for ((passage, chord), &tension) in span.passages.iter().zip(chords).zip(tensions) {
        sum = sum + unit_pull(passage.near, chord) * tension;
    }
    sum
}

/// What rod and cables exert together on the far disk's near side, as a moment in its frame.
pub(super) fn far_moment(span: &Span, end: &End, chords: &[Chord], tensions: &[f64]) -> Vec3 {
    let to_far = end.pose.rotation.conjugate();
    let mut moment = to_far.rotate(end.moment);
    for ((passage, chord), &tension) in span.passages.iter().zip(chords).zip(tensions) {
        if !passage.is_anchored_inside() {
            moment += passage.far.cross(to_far.rotate(chord.along)) * tension;
        }
    }
    moment
}

/// What a variation of the rod does to the span.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Answer {
    /// Rotation of the far disk relative to the near one, in the far frame.
    pub turn: Vec3,
    /// Total moment at the far disk, in its frame.
    pub moment: Vec3,
    /// Force of followers inside the span, in the near frame, negative.
    pub force: Vec3,
    /// Of the cables' share in eq. (3).
    pub pull: BodyWrench,
}

/// A span as it was last integrated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taut<'a> {
    pub span: &'a Span,
    pub anchors: &'a [Anchor],
    pub samples: &'a [Sample],
    /// Of the far disk.
    pub pose: Pose,
    pub chords: &'a [Chord],
    pub tensions: &'a [f64],
}

impl<'a> Taut<'a> {
    /// The cables that are anchored before the far disk.
    #[inline(always)]
    pub fn anchors(&self) -> Anchors<'a> {
        let Self { span, anchors: at, tensions, .. } = *self;
        Anchors { at, passages: &span.passages, tensions }
    }
}

/// The answer to a variation of the rod, in which the chords of the anchors change so; `lengths` takes the changes of all chords.
#[inline(always)]
pub(super) fn answer(
    taut: &Taut<'_>,
    variation: &Variation,
    of_anchors: &[ChordChange],
    lengths: &mut [f64],
) -> Answer {
    let Taut { span, ref pose, chords, tensions, .. } = *taut;
    let Variation { turn, shift, moment, force } = *variation;
    let mut out = Answer { turn, moment, force, pull: BodyWrench::default() };
    let to_far = pose.rotation.conjugate();
    for (i, (passage, chord)) in span.passages.iter().zip(chords).enumerate() {
        if passage.is_anchored_inside() {
            continue;
        }
        // The chord's change, and its direction's, in the far frame and then in the near one.
        let t = to_far.rotate(chord.along);
        let way = shift + turn.cross(passage.far);
        let longer = t.dot(way);
        lengths[i] = longer;
        let tension = tensions[i];
        if tension == 0.0 {
            continue;
        }
        let tilt = (way - t * longer) * (tension / chord.length);
        out.moment += passage.far.cross(tilt + tension * t.cross(turn));
        let tilt = pose.rotation.rotate(tilt);
        out.pull.linear += tilt;
        out.pull.angular += passage.near.cross(tilt);
    }
    for (anchor, change) in taut.anchors.iter().zip(of_anchors) {
        let i = anchor.passage;
        lengths[i] = change.longer;
        let near = span.passages[i].near;
        out.pull = out.pull + along_cable(near, change.tilt * tensions[i]);
    }
    out
}

/// `I + ∂(Σ τ q)/∂w`, factored in 3×3 blocks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Factors {
    force: Mat3,
    /// Upper right block and lower left block.
    upper: Mat3,
    lower: Mat3,
    /// Inverse of the Schur complement of the force block.
    moment: Mat3,
    /// Whether the determinant is negative.
    pub is_negative: bool,
}

impl Factors {
    /// From the answers to the three forces and three moments; `None` where it is singular.
    #[inline(always)]
    pub fn new(by: &[Answer]) -> Option<Self> {
        let linear = |c: usize| by[c].pull.linear;
        let angular = |c: usize| by[c].pull.angular;
        let force = Mat3::IDENTITY + Mat3::from_columns(linear(0), linear(1), linear(2));
        let upper = Mat3::from_columns(linear(3), linear(4), linear(5));
        let lower = Mat3::from_columns(angular(0), angular(1), angular(2));
        let moment = Mat3::IDENTITY + Mat3::from_columns(angular(3), angular(4), angular(5));
        let of_force = force.determinant();
        let force = force.inverse()?;
        let moment = moment - lower * force * upper;
        let is_negative = (of_force < 0.0) != (moment.determinant() < 0.0);
        Some(Self { force, upper, lower, moment: moment.inverse()?, is_negative })
    }

    #[inline]
    pub fn solve(&self, right: BodyWrench) -> BodyWrench {
        let first = self.force * right.linear;
        let angular = self.moment * (right.angular - self.lower * first);
        BodyWrench { linear: first - self.force * (self.upper * angular), angular }
    }
}

/// Eq. (3) of a span without load, linearised and factored.
///
/// Where one cable crosses the span the rod bears what that takes, a force `n` along its line:
/// `w = (n, h₀ × n)`, and three equations are left.
#[derive(Clone, Copy, Debug)]
pub(super) enum Tangent {
    OneCable {
        /// Inverse of `I + ∂(τ t)/∂n`.
        force: Mat3,
        near: Vec3,
    },
    Cables(Factors),
}

impl Tangent {
    #[inline(always)]
    pub fn solve(&self, right: BodyWrench) -> BodyWrench {
        match self {
            Self::OneCable { force, near } => along_cable(*near, *force * right.linear),
            Self::Cables(factors) => factors.solve(right),
        }
    }
}
