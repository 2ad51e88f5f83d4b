//! How the end of a step of [`whipcord_numerics::magnus_6`] moves with the twists it is made of.
//!
//! On se(3) a twist `(u, v)` is the dual vector `u + ε v`, `ε² = 0`, whose bracket is the cross product;
//! so a linear map that is made of brackets is a 3×3 matrix `A + ε B`: it takes `δu` to `A δu` and
//! `(δu, δv)` to the displacement `B δu + A δv`. The series is differentiated bracket by bracket; its
//! exponential by
//!
//! ```text
//! g⁻¹ δg = (1 − b φ̂ + c φ̂²) δφ,   b = (1 − cos |φ|)/|φ|²,   c = (|φ| − sin |φ|)/|φ|³
//! ```
//!
//! at the dual vector `φ`: the derivative of the exponential of SO(3) with dual numbers put in.

use crate::section::lanes::{LANES, Lane, LaneMat, LaneVec};

/// A twist of each column.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LaneTwist {
    pub angular: LaneVec,
    pub linear: LaneVec,
}

/// The matrix `turn + ε shift` of each column.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LaneMotion {
    pub turn: LaneMat,
    pub shift: LaneMat,
}

impl LaneTwist {
    #[inline(always)]
    fn plus(&self, f: f64, b: &Self) -> Self {
        Self { angular: self.angular + f * b.angular, linear: self.linear + f * b.linear }
    }

    #[inline(always)]
    fn times(&self, f: f64) -> Self {
        Self { angular: f * self.angular, linear: f * self.linear }
    }

    #[inline(always)]
    fn bracket(&self, b: &Self) -> Self {
        Self {
            angular: self.angular.cross(&b.angular),
            linear: self.angular.cross(&b.linear) + self.linear.cross(&b.angular),
        }
    }

    /// The bracket as a map of its second factor.
    #[inline(always)]
    fn brackets(&self) -> LaneMotion {
        LaneMotion { turn: LaneMat::skew(&self.angular), shift: LaneMat::skew(&self.linear) }
    }

    /// The bracket with what a map returns.
    #[inline(always)]
    fn bracket_of(&self, b: &LaneMotion) -> LaneMotion {
        LaneMotion {
            turn: b.turn.crossed(&self.angular),
            shift: b.shift.crossed(&self.angular) + b.turn.crossed(&self.linear),
        }
    }
}

impl LaneMotion {
    #[inline(always)]
    fn plus(&self, f: f64, b: &Self) -> Self {
        Self { turn: self.turn + f * b.turn, shift: self.shift + f * b.shift }
    }

    #[inline(always)]
    fn scaled(&self, f: Lane) -> Self {
        Self { turn: self.turn.scaled(f), shift: self.shift.scaled(f) }
    }

    /// Adds a multiple of the identity.
    #[inline(always)]
    fn plus_identity(&self, f: f64) -> Self {
        Self { turn: self.turn + LaneMat::diagonal(Lane::splat(f)), shift: self.shift }
    }

    /// The map after `b`.
    #[inline(always)]
    fn after(&self, b: &Self) -> Self {
        Self {
            turn: self.turn.times(&b.turn),
            shift: self.turn.times(&b.shift) + self.shift.times(&b.turn),
        }
    }
}

/// How the end of a step moves in the frame `end`, given by its rotation, with the twist at each of the
/// three nodes of a step of each column: `twists` are those times `length`.
#[inline(always)]
pub(super) fn end_by_twists(
    twists: &[LaneTwist; 3],
    length: Lane,
    end: &LaneMat,
) -> [LaneMotion; 3] {
    let [first, middle, last] = twists;
    let kappa = 15.0_f64.sqrt() / 3.0;
    let a1 = *middle;
    let a2 = last.plus(-1.0, first).times(kappa);
    let a3 = last.plus(1.0, first).plus(-2.0, middle).times(10.0 / 3.0);
    let inner = a1.bracket(&a2);
    let rest = a3.times(2.0).plus(-1.0, &inner);
    let left = a1.times(20.0).plus(1.0, &a3).plus(1.0, &inner);
    let right = a2.plus(1.0 / 60.0, &a1.bracket(&rest));
    let exponent = a1.plus(1.0 / 12.0, &a3).plus(1.0 / 240.0, &left.bracket(&right));
    // By each of the three: δ inner = X δa₂ − Y δa₁, then δ right and what they make together.
    let (x, y) = (a1.brackets(), a2.brackets());
    let sixtieth = |m: LaneMotion| LaneMotion::default().plus(1.0 / 60.0, &m);
    let right_1 = sixtieth(a1.bracket_of(&y).plus(-1.0, &rest.brackets()));
    let right_2 = sixtieth(a1.bracket_of(&x).plus(-2.0, &a1.bracket_of(&x)));
    let right_3 = LaneMotion::default().plus(1.0 / 30.0, &x);
    let turned = right.brackets();
    let series_1 = left.bracket_of(&right_1).plus(-20.0, &turned).plus(1.0, &right.bracket_of(&y));
    let series_2 = left.bracket_of(&right_2.plus_identity(1.0)).plus(-1.0, &right.bracket_of(&x));
    let series_3 = left.bracket_of(&right_3).plus(-1.0, &turned);
    let whole = |m: &LaneMotion| LaneMotion::default().plus(1.0 / 240.0, m);
    let by_1 = whole(&series_1).plus_identity(1.0);
    let by_2 = whole(&series_2);
    let by_3 = whole(&series_3).plus_identity(1.0 / 12.0);
    let exponential = exponential(&exponent, end);
    let by_1 = exponential.after(&by_1).scaled(length);
    let by_2 = exponential.after(&by_2).scaled(length);
    let by_3 = exponential.after(&by_3).scaled(length);
    let even = LaneMotion::default().plus(10.0 / 3.0, &by_3);
    [even.plus(-kappa, &by_2), by_1.plus(-20.0 / 3.0, &by_3), even.plus(kappa, &by_2)]
}

/// `R (1 − b φ̂ + c φ̂²)` at a dual vector.
#[inline(always)]
fn exponential(twist: &LaneTwist, end: &LaneMat) -> LaneMotion {
    let LaneTwist { angular: u, linear: v } = twist;
    let (squared, mixed) = (u.inner(u), 2.0 * u.inner(v));
    let [b, c, b_rate, c_rate] = coefficients(squared);
    let (hat, hat_rate) = (LaneMat::skew(u), LaneMat::skew(v));
    let (twice, crossed) = (hat.crossed(u), hat.crossed(v));
    let turn = LaneMat::diagonal(Lane::splat(1.0)) - hat.scaled(b) + twice.scaled(c);
    // v̂ û + û v̂.
    let twice_rate = crossed + hat_rate.crossed(u);
    let shift = twice_rate.scaled(c) + twice.scaled(c_rate * mixed)
        - hat_rate.scaled(b)
        - hat.scaled(b_rate * mixed);
    LaneMotion { turn: end.times(&turn), shift: end.times(&shift) }
}

/// Squared angle below which the series are taken.
const SERIES: f64 = 0.25;

/// `b`, `c` and their derivatives by `x = |φ|²`.
#[inline(always)]
fn coefficients(x: Lane) -> [Lane; 4] {
    if x.0.iter().all(|&x| x < SERIES) {
        return series(x);
    }
    let mut out = [Lane::default(); 4];
    for lane in 0..LANES {
        let x = x.0[lane];
        let values = if x < SERIES { series(Lane::splat(x)).map(|v| v.0[lane]) } else { closed(x) };
        for (out, value) in out.iter_mut().zip(values) {
            out.0[lane] = value;
        }
    }
    out
}

#[inline(always)]
fn series(x: Lane) -> [Lane; 4] {
    // Σ (−x)ᵏ/(2k + 2)! and Σ (−x)ᵏ/(2k + 3)!, and their derivatives.
    const B: [f64; 8] = [
        0.5,
        -1.0 / 24.0,
        1.0 / 720.0,
        -1.0 / 40_320.0,
        1.0 / 3_628_800.0,
        -1.0 / 479_001_600.0,
        1.0 / 87_178_291_200.0,
        -1.0 / 20_922_789_888_000.0,
    ];
    const C: [f64; 8] = [
        1.0 / 6.0,
        -1.0 / 120.0,
        1.0 / 5040.0,
        -1.0 / 362_880.0,
        1.0 / 39_916_800.0,
        -1.0 / 6_227_020_800.0,
        1.0 / 1_307_674_368_000.0,
        -1.0 / 355_687_428_096_000.0,
    ];
    let value = |list: &[f64; 8]| {
        (0..7).rev().fold(Lane::splat(list[7]), |sum, i| x * sum + Lane::splat(list[i]))
    };
    let rate = |list: &[f64; 8]| {
        (1..7)
            .rev()
            .fold(Lane::splat(7.0 * list[7]), |sum, i| x * sum + Lane::splat(i as f64 * list[i]))
    };
    [value(&B), value(&C), rate(&B), rate(&C)]
}

fn closed(x: f64) -> [f64; 4] {
    let angle = x.sqrt();
    let (sin, cos) = angle.sin_cos();
    let (b, c) = ((1.0 - cos) / x, (angle - sin) / (x * angle));
    [b, c, (sin / angle - 2.0 * b) / (2.0 * x), (b - 3.0 * c) / (2.0 * x)]
}

#[cfg(test)]
mod tests {
    use whipcord_numerics::{Mat3, Pose, Twist, Vec3, magnus_6};

    use super::*;

    /// Differences of the step itself, extrapolated, for small steps and for those that turn far.
    #[test]
    fn the_end_moves_as_differences_have_it() {
        for size in [0.1, 0.4, 1.3] {
            let twist = |i: usize| {
                let t = i as f64;
                let linear = Vec3::new(0.2 * t, 0.3 - 0.1 * t, 1.0);
                let angular = Vec3::new(1.0 - 0.4 * t * t, 0.3 * t, 0.5 + 0.2 * t);
                Twist { linear, angular }
            };
            let step = |i: usize, by: Twist| -> Pose {
                magnus_6(
                    &[0, 1, 2].map(|j| (twist(j) + by * if i == j { 1.0 } else { 0.0 }) * size),
                )
            };
            let at = step(3, Twist::default());
            let lanes = [0, 1, 2].map(|i| {
                let Twist { linear, angular } = twist(i) * size;
                let mut out = LaneTwist::default();
                for lane in 0..LANES {
                    out.linear.set(lane, linear);
                    out.angular.set(lane, angular);
                }
                out
            });
            let mut end = LaneMat::default();
            (0..LANES).for_each(|lane| end.set(lane, &at.rotation.to_matrix()));
            let maps = end_by_twists(&lanes, Lane::splat(size), &end);
            for (i, map) in maps.iter().enumerate() {
                for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
                    let column = |m: &LaneMat| -> Vec3 { Mat3::column(&m.get(2), j) };
                    for (by, turn, shift) in [
                        (
                            Twist { angular: axis, linear: Vec3::ZERO },
                            column(&map.turn),
                            column(&map.shift),
                        ),
                        (
                            Twist { angular: Vec3::ZERO, linear: axis },
                            Vec3::ZERO,
                            column(&map.turn),
                        ),
                    ] {
                        let difference = |h: f64| {
                            let (a, b) = (step(i, by * h), step(i, by * -h));
                            let f = 0.5 / h;
                            let turn = (a.rotation * b.rotation.conjugate()).log();
                            [turn * f, (a.position - b.position) * f]
                        };
                        let (near, far) = (difference(1e-3), difference(2e-3));
                        let exact = [0, 1].map(|k| near[k] * (4.0 / 3.0) - far[k] * (1.0 / 3.0));
                        let off = (exact[0] - turn).norm() + (exact[1] - shift).norm();
                        assert!(off < 1e-10, "{size}, node {i}, {j}: {off:.1e}");
                    }
                }
            }
        }
    }

    #[test]
    fn series_and_closed_forms_meet() {
        let near = series(Lane::splat(SERIES)).map(|v| v.0[0]);
        for (a, b) in near.into_iter().zip(closed(SERIES)) {
            assert!((a - b).abs() < 2e-14 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}
