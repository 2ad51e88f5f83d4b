//! The rod of a span inside which no load acts.
//!
//! Its force `f` is then the same at every section, and the last two of eqs. (1) of [`super::rod`]
//! and of eqs. (2) have integrals,
//!
//! ```text
//! m = m₀ − p × f,      μ = M × η − ζ × N + Rᵀ(δm₀ − p × δf)                                     (9)
//! ```
//!
//! so that only the pose is left to integrate, and of the variations the two of the pose.

use core::ops::Range;

use whipcord_numerics::{BUTCHER_5, Pose, Twist, UnitQuaternion, Vec3};

use super::anchors::{Anchors, ChordChange, Varied};
use super::chord::Chord;
use super::span::Taut;
use super::variation::{Sample, Variation};
use crate::section::{BodyWrench, Section};
use crate::statics::grid::Grid;

/// Quaternion and position, or their derivatives; the last is nothing and fills a vector register.
type State = [f64; 8];

const A: [[f64; 6]; 6] = BUTCHER_5.a;

#[inline(always)]
fn pack(q: [f64; 4], p: Vec3) -> State {
    let [w, x, y, z] = q;
    [w, x, y, z, p.x, p.y, p.z, 0.0]
}

#[inline(always)]
fn unpack(&[w, x, y, z, px, py, pz, _]: &State) -> Pose {
    let rotation = UnitQuaternion { w, v: Vec3::new(x, y, z) }.renormalized();
    Pose { position: Vec3::new(px, py, pz), rotation }
}

#[inline(always)]
fn advance<const N: usize>(start: &State, slopes: [&State; N], weights: &[f64], h: f64) -> State {
    let mut out = *start;
    for (slope, &weight) in slopes.into_iter().zip(weights) {
        let f = h * weight;
        for (x, rate) in out.iter_mut().zip(slope) {
            *x += f * rate;
        }
    }
    out
}

/// The derivative of a state, and what a sample has of it.
#[inline(always)]
fn slope(section: &Section, at: &State, wrench: &BodyWrench) -> (State, Sample) {
    let Pose { position, rotation } = unpack(at);
    let turn = rotation.to_matrix();
    let moment = wrench.angular - position.cross(wrench.linear);
    let local = BodyWrench {
        linear: turn.transpose_mul(wrench.linear),
        angular: turn.transpose_mul(moment),
    };
    let strain = section.bare_strain(local);
    let rate = pack(rotation.rate(strain.angular), turn * strain.linear);
    (rate, Sample { strain, wrench: local, rotation, position, dead: Vec3::ZERO })
}

/// Integrates the pose over the steps of a span from the wrench at its start; the pose at the end, and the wrench beyond the last
/// anchor. `poses` takes the poses at the ends of the steps, `samples` three of them to each step, where there is room for any,
/// and the chords those of the anchors.
#[inline(always)]
pub(super) fn integrate(
    grid: &Grid,
    steps: Range<usize>,
    mut wrench: BodyWrench,
    (anchors, chords): (&Anchors<'_>, &mut [Chord]),
    poses: &mut [Pose],
    samples: &mut [Sample],
) -> (Pose, BodyWrench) {
    let mut state = pack([1.0, 0.0, 0.0, 0.0], Vec3::ZERO);
    let mut pose = Pose::IDENTITY;
    for (i, k) in steps.enumerate() {
        let h = grid.steps[k].length;
        let of =
            |node: usize, at: &State| slope(&grid.shooting.at(k, node, 0).0.section, at, &wrench);
        let (k0, first) = of(0, &state);
        let (k1, _) = of(1, &advance(&state, [&k0], &A[1], h));
        let (k2, _) = of(1, &advance(&state, [&k0, &k1], &A[2], h));
        let (k3, middle) = of(2, &advance(&state, [&k1, &k2], &A[3][1..], h));
        let (k4, _) = of(3, &advance(&state, [&k0, &k3], &[A[4][0], A[4][3]], h));
        let (k5, last) = of(4, &advance(&state, [&k0, &k1, &k2, &k3, &k4], &A[5], h));
        let [b0, _, b2, b3, b4, b5] = BUTCHER_5.b;
        state = advance(&state, [&k0, &k2, &k3, &k4, &k5], &[b0, b2, b3, b4, b5], h);
        pose = unpack(&state);
        state = pack(pose.rotation.wxyz(), pose.position);
        poses[i] = pose;
        if let Some(triple) = samples.get_mut(3 * i..3 * i + 3) {
            triple.copy_from_slice(&[first, middle, last]);
        }
        if !anchors.at.is_empty() {
            wrench = wrench + anchors.pull(k + 1, &pose, chords);
        }
    }
    (pose, wrench)
}

/// A section as eqs. (2) need it, and the changes of the wrench there at an unmoved section.
struct Place<'a, const N: usize> {
    section: &'a Section,
    strain: Twist,
    wrench: BodyWrench,
    pushes: [BodyWrench; N],
}

impl<'a, const N: usize> Place<'a, N> {
    #[inline(always)]
    fn new(section: &'a Section, sample: &Sample, by: &[BodyWrench; N]) -> Self {
        let Sample { strain, wrench, rotation, position, .. } = *sample;
        let to_body = rotation.to_matrix();
        let mut pushes = [BodyWrench::default(); N];
        for (push, by) in pushes.iter_mut().zip(by) {
            push.linear = to_body.transpose_mul(by.linear);
            push.angular = to_body.transpose_mul(by.angular - position.cross(by.linear));
        }
        Self { section, strain, wrench, pushes }
    }

    /// `η′` and `ζ′` of a variation by one of the changes.
    #[inline(always)]
    fn slope(&self, column: usize, at: &Twist) -> Twist {
        let Twist { linear: shift, angular: turn } = *at;
        let Twist { linear: v, angular: u } = self.strain;
        let change = self.section.yielding(&self.strain, self.push(column, at));
        Twist {
            linear: turn.cross(v) + change.linear - u.cross(shift),
            angular: change.angular - u.cross(turn),
        }
    }

    /// `δN` and `μ`.
    #[inline(always)]
    fn push(&self, column: usize, at: &Twist) -> BodyWrench {
        let Twist { linear: shift, angular: turn } = *at;
        let (n, m, push) = (self.wrench.linear, self.wrench.angular, &self.pushes[column]);
        BodyWrench {
            linear: n.cross(turn) + push.linear,
            angular: m.cross(turn) - shift.cross(n) + push.angular,
        }
    }
}

/// Eqs. (2) over a span: the variations at its end by changes of the wrench at its start, with this anchor's cable pulling by
/// 1 N more where one is given. `changes` takes those of the anchors' chords, variation after variation.
#[inline(always)]
pub(super) fn linearise<const N: usize>(
    grid: &Grid,
    steps: Range<usize>,
    taut: &Taut<'_>,
    by: &[BodyWrench; N],
    pulled: Option<usize>,
    changes: &mut [ChordChange],
) -> [Variation; N] {
    let anchors = taut.anchors();
    let mut acting = *by;
    let mut at = [Twist::default(); N];
    let mut moments = [Vec3::ZERO; N];
    for (k, triple) in steps.zip(taut.samples.chunks_exact(3)) {
        let h = grid.steps[k].length;
        let section = |q: usize| &grid.shooting.at(k, 2 * q, 0).0.section;
        let place = |q: usize| Place::new(section(q), &triple[q], &acting);
        let (start, middle, end) = (place(0), place(1), place(2));
        for (column, at) in at.iter_mut().enumerate() {
            let k0 = start.slope(column, at);
            let k1 = middle.slope(column, &(*at + k0 * (0.5 * h)));
            let k2 = middle.slope(column, &(*at + k1 * (0.5 * h)));
            let k3 = end.slope(column, &(*at + k2 * h));
            *at = *at + (k0 + (k1 + k2) * 2.0 + k3) * (h / 6.0);
            moments[column] = end.push(column, at).angular;
        }
        if anchors.at.iter().any(|anchor| anchor.node == k + 1) {
            let Sample { rotation, .. } = triple[2];
            let of_variation = changes.chunks_exact_mut(anchors.at.len());
            for ((acting, at), changes) in acting.iter_mut().zip(&at).zip(of_variation) {
                let mut varied = Varied { chords: taut.chords, pulled, changes };
                *acting = *acting + anchors.change(k + 1, rotation, at, &mut varied);
            }
        }
    }
    let mut out = [Variation::default(); N];
    for (c, out) in out.iter_mut().enumerate() {
        let Twist { linear: shift, angular: turn } = at[c];
        *out = Variation { turn, shift, moment: moments[c], force: by[c].linear };
    }
    out
}

/// The six unit wrenches, forces first.
pub(super) fn units() -> [BodyWrench; 6] {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    core::array::from_fn(|c| {
        let axis = axes[c % 3];
        if c < 3 {
            BodyWrench { linear: axis, angular: Vec3::ZERO }
        } else {
            BodyWrench { linear: Vec3::ZERO, angular: axis }
        }
    })
}
