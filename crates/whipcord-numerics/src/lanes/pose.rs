use core::ops::{Add, Mul, Sub};

use pulp::Simd;

use super::{LaneVec3, Lanes};
use crate::{Pose, UnitQuaternion, Vec3};

/// [`crate::Twist`] in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneTwist<S: Simd> {
    /// Translational part.
    pub linear: LaneVec3<S>,
    /// Rotational part.
    pub angular: LaneVec3<S>,
}

impl<S: Simd> LaneTwist<S> {
    /// The Lie bracket of se(3).
    #[inline(always)]
    #[must_use]
    pub fn bracket(self, b: Self) -> Self {
        Self {
            linear: self.angular.cross(b.linear) + self.linear.cross(b.angular),
            angular: self.angular.cross(b.angular),
        }
    }
}

impl<S: Simd> Add for LaneTwist<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { linear: self.linear + b.linear, angular: self.angular + b.angular }
    }
}

impl<S: Simd> Sub for LaneTwist<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { linear: self.linear - b.linear, angular: self.angular - b.angular }
    }
}

impl<S: Simd> Mul<f64> for LaneTwist<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, a: f64) -> Self {
        Self { linear: self.linear * a, angular: self.angular * a }
    }
}

/// [`crate::Pose`] in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LanePose<S: Simd> {
    /// Position of the origin.
    pub position: LaneVec3<S>,
    /// Real part of the rotation's quaternion.
    pub w: Lanes<S>,
    /// Imaginary part of the rotation's quaternion.
    pub v: LaneVec3<S>,
}

impl<S: Simd> LanePose<S> {
    /// The frame itself.
    #[inline(always)]
    #[must_use]
    pub fn identity(simd: S) -> Self {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let null = LaneVec3::new(zero, zero, zero);
        Self { position: null, w: one, v: null }
    }

    /// The same frame in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, pose: Pose) -> Self {
        let [w, x, y, z] = pose.rotation.wxyz();
        let v = LaneVec3::splat(simd, Vec3::new(x, y, z));
        Self { position: LaneVec3::splat(simd, pose.position), w: Lanes::splat(simd, w), v }
    }

    /// The frame in one lane.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, lane: usize) -> Pose {
        let rotation = UnitQuaternion { w: self.w.as_slice()[lane], v: self.v.of(lane) };
        Pose { position: self.position.of(lane), rotation }
    }

    /// The same with its quaternion, which is all but one of a rotation, scaled to one.
    #[inline(always)]
    #[must_use]
    pub fn unit(self) -> Self {
        let f = -((self.w * self.w + self.v.dot(self.v)) * 0.5) + 1.5;
        Self { position: self.position, w: self.w * f, v: self.v * f }
    }

    /// A vector turned into the frame that this one is given in.
    #[inline(always)]
    #[must_use]
    pub fn to_base(self, a: LaneVec3<S>) -> LaneVec3<S> {
        let turned = self.v.cross(a) * 2.0;
        a + turned * self.w + self.v.cross(turned)
    }

    /// A vector turned into this frame.
    #[inline(always)]
    #[must_use]
    pub fn to_body(self, a: LaneVec3<S>) -> LaneVec3<S> {
        let turned = a.cross(self.v) * 2.0;
        a + turned * self.w + turned.cross(self.v)
    }

    /// [`UnitQuaternion::log`] of the rotation from another frame to this one, where its series is exact to rounding in each lane.
    #[inline(always)]
    #[must_use]
    pub fn turn_from(&self, from: &Self) -> Option<LaneVec3<S>> {
        let w = from.w * self.w + from.v.dot(self.v);
        let v = self.v * from.w - from.v * self.w - from.v.cross(self.v);
        let zero = w * 0.0;
        let squared = v.dot(v);
        if !squared.below(zero + UnitQuaternion::LOG_SERIES_LIMIT).all() {
            return None;
        }
        let norm = squared + w * w;
        let x = squared * ((zero + 1.0) / norm);
        let [first, rest @ ..] = UnitQuaternion::LOG_SERIES;
        let series = horner(x, first, rest);
        let factor = series * ((zero + 2.0) / norm.sqrt());
        Some(v * w.below(zero).select(-factor, factor))
    }

    /// The rate of the quaternion at this angular velocity in the frame itself.
    #[inline(always)]
    #[must_use]
    pub fn rate(self, angular: LaneVec3<S>) -> (Lanes<S>, LaneVec3<S>) {
        let half = angular * 0.5;
        (-self.v.dot(half), half * self.w + self.v.cross(half))
    }

    /// The exponential of SE(3) for an angle whose square is below [`Self::SERIES_LIMIT`].
    #[inline(always)]
    #[must_use]
    pub fn exp(twist: LaneTwist<S>) -> Self {
        let LaneTwist { linear, angular } = twist;
        let x = angular.dot(angular);
        let (b, c) = b_c(x);
        let once = angular.cross(linear);
        let twice = angular.cross(once);
        let half = angular * 0.5;
        let (sinc, cos) = sinc_cos(half.dot(half));
        Self { position: linear + once * b + twice * c, w: cos, v: half * sinc }
    }

    /// The squared angle up to which [`Self::exp`] is the same as [`Pose::exp`], which goes on with
    /// other formulas.
    pub const SERIES_LIMIT: f64 = 0.249;

    /// The motion `self` and then `b`.
    #[inline(always)]
    #[must_use]
    pub fn then(self, b: Self) -> Self {
        let position = self.position + self.to_base(b.position);
        let w = self.w * b.w - self.v.dot(b.v);
        let v = b.v * self.w + self.v * b.w + self.v.cross(b.v);
        Self { position, w, v }.unit()
    }
}

/// The exponent of [`crate::magnus_6`] in each lane.
#[inline(always)]
#[must_use]
pub fn magnus_6_exponent<S: Simd>(twists: &[LaneTwist<S>; 3]) -> LaneTwist<S> {
    let [a, b, c] = *twists;
    let alpha_1 = b;
    let alpha_2 = (c - a) * (15.0_f64.sqrt() / 3.0);
    let alpha_3 = (c + a - b * 2.0) * (10.0 / 3.0);
    let inner = alpha_1.bracket(alpha_2);
    let outer = alpha_1.bracket(alpha_3 * 2.0 - inner) * (1.0 / 60.0);
    let series = (alpha_1 * 20.0 + alpha_3 + inner).bracket(alpha_2 + outer) * (1.0 / 240.0);
    alpha_1 + alpha_3 * (1.0 / 12.0) + series
}

/// Horner's scheme, the highest coefficient first.
#[inline(always)]
fn horner<S: Simd, const N: usize>(x: Lanes<S>, highest: f64, coefficients: [f64; N]) -> Lanes<S> {
    let first = x * highest;
    coefficients
        .into_iter()
        .enumerate()
        .fold(first, |value, (i, c)| if i == 0 { value + c } else { x * value + c })
}

#[inline(always)]
fn b_c<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let b = horner(
        x,
        1.0 / 87_178_291_200.0,
        [-1.0 / 479_001_600.0, 1.0 / 3_628_800.0, -1.0 / 40_320.0, 1.0 / 720.0, -1.0 / 24.0, 0.5],
    );
    let c = horner(
        x,
        1.0 / 1_307_674_368_000.0,
        [
            -1.0 / 6_227_020_800.0,
            1.0 / 39_916_800.0,
            -1.0 / 362_880.0,
            1.0 / 5040.0,
            -1.0 / 120.0,
            1.0 / 6.0,
        ],
    );
    (b, c)
}

#[inline(always)]
fn sinc_cos<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let sinc = horner(
        x,
        1.0 / 6_227_020_800.0,
        [-1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0],
    );
    let cos = horner(
        x,
        1.0 / 479_001_600.0,
        [-1.0 / 3_628_800.0, 1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5, 1.0],
    );
    (sinc, cos)
}
