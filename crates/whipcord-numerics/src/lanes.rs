//! Several numbers at once, one to each lane of the processor's vectors.
//!
//! What is here does to each lane what its scalar namesake does to a number: the same operations in
//! the same order, none of them fused, so that the results are the same to the last bit. Tests hold
//! it to that.

use core::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

/// One number to each lane.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    /// The numbers as the instruction set has them.
    pub value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// How many lanes there are.
    pub const COUNT: usize = S::F64_LANES;

    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// The first of these numbers, and zeros where there are fewer than lanes.
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, values: &[f64]) -> Self {
        Self { simd, value: simd.partial_load_f64s(&values[..values.len().min(Self::COUNT)]) }
    }

    /// The numbers in order.
    #[inline(always)]
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        pulp::bytemuck::cast_slice(core::slice::from_ref(&self.value))
    }

    /// Square roots.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.value))
    }

    /// The larger of each number and a bound.
    #[inline(always)]
    #[must_use]
    pub fn at_least(self, bound: f64) -> Self {
        self.with(self.simd.max_f64s(self.value, self.simd.splat_f64s(bound)))
    }

    /// The larger of two numbers in each lane.
    #[inline(always)]
    #[must_use]
    pub fn max(self, b: Self) -> Self {
        self.with(self.simd.max_f64s(self.value, b.value))
    }

    /// In each lane `then` where this number is at most `bound`, else `otherwise`, as for a NaN.
    #[inline(always)]
    #[must_use]
    pub fn where_at_most(self, bound: f64, then: Self, otherwise: Self) -> Self {
        let mask = self.simd.less_than_or_equal_f64s(self.value, self.simd.splat_f64s(bound));
        self.with(self.simd.select_f64s(mask, then.value, otherwise.value))
    }

    /// Whether no number is greater than `bound`; a NaN is not.
    #[inline(always)]
    #[must_use]
    pub fn none_above(&self, bound: f64) -> bool {
        self.as_slice().iter().fold(true, |all, &x| {
            all & !matches!(x.partial_cmp(&bound), Some(core::cmp::Ordering::Greater))
        })
    }

    #[inline(always)]
    fn with(self, value: S::f64s) -> Self {
        Self { simd: self.simd, value }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(self.simd.add_f64s(self.value, b.value))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(self.simd.sub_f64s(self.value, b.value))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(self.simd.mul_f64s(self.value, b.value))
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.with(self.simd.div_f64s(self.value, b.value))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<S: Simd> Add<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: f64) -> Self {
        self.with(self.simd.add_f64s(self.value, self.simd.splat_f64s(b)))
    }
}

impl<S: Simd> Sub<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: f64) -> Self {
        self.with(self.simd.sub_f64s(self.value, self.simd.splat_f64s(b)))
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: f64) -> Self {
        self.with(self.simd.mul_f64s(self.value, self.simd.splat_f64s(b)))
    }
}

/// [`crate::Vec3`] in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneVec3<S: Simd> {
    /// First component.
    pub x: Lanes<S>,
    /// Second component.
    pub y: Lanes<S>,
    /// Third component.
    pub z: Lanes<S>,
}

impl<S: Simd> LaneVec3<S> {
    /// The vector (x, y, z).
    #[inline(always)]
    #[must_use]
    pub fn new(x: Lanes<S>, y: Lanes<S>, z: Lanes<S>) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, v: crate::Vec3) -> Self {
        Self::new(Lanes::splat(simd, v.x), Lanes::splat(simd, v.y), Lanes::splat(simd, v.z))
    }

    /// Scalar product.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, b: Self) -> Lanes<S> {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// Vector product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, b: Self) -> Self {
        Self::new(
            self.y * b.z - self.z * b.y,
            self.z * b.x - self.x * b.z,
            self.x * b.y - self.y * b.x,
        )
    }

    /// Component-wise product.
    #[inline(always)]
    #[must_use]
    pub fn scale(self, b: Self) -> Self {
        Self::new(self.x * b.x, self.y * b.y, self.z * b.z)
    }
}

impl<S: Simd> Add for LaneVec3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<S: Simd> Sub for LaneVec3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<S: Simd> Mul<Lanes<S>> for LaneVec3<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, a: Lanes<S>) -> Self {
        Self::new(self.x * a, self.y * a, self.z * a)
    }
}

impl<S: Simd> Mul<f64> for LaneVec3<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, a: f64) -> Self {
        Self::new(self.x * a, self.y * a, self.z * a)
    }
}

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

    /// The squared angle up to which [`Self::exp`] is the same as [`crate::Pose::exp`], which goes on with
    /// other formulas.
    pub const SERIES_LIMIT: f64 = 0.249;

    /// The motion `self` and then `b`.
    #[inline(always)]
    #[must_use]
    pub fn then(self, b: Self) -> Self {
        let turned = self.v.cross(b.position) * 2.0;
        let rotated = b.position + turned * self.w + self.v.cross(turned);
        let w = self.w * b.w - self.v.dot(b.v);
        let v = b.v * self.w + self.v * b.w + self.v.cross(b.v);
        let f = -((w * w + v.dot(v)) * 0.5) + 1.5;
        Self { position: self.position + rotated, w: w * f, v: v * f }
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
    // The innermost quotient of the scalar series is a quotient here, too.
    let mut value = x / Lanes::splat(x.simd, highest);
    for (i, c) in coefficients.into_iter().enumerate() {
        value = if i == 0 { value + c } else { x * value + c };
    }
    value
}

#[inline(always)]
fn b_c<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let b = horner(
        x,
        87_178_291_200.0,
        [-1.0 / 479_001_600.0, 1.0 / 3_628_800.0, -1.0 / 40_320.0, 1.0 / 720.0, -1.0 / 24.0, 0.5],
    );
    let c = horner(
        x,
        1_307_674_368_000.0,
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
        6_227_020_800.0,
        [-1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0],
    );
    let cos = horner(
        x,
        479_001_600.0,
        [-1.0 / 3_628_800.0, 1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5, 1.0],
    );
    (sinc, cos)
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::{Pose, Twist, Vec3, magnus_6};

    /// Twists whose parts are between -0.2 and 0.2.
    fn twists(count: usize) -> Vec<[Twist; 3]> {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 0.4 - 0.2
        };
        let mut vector = || Vec3::new(next(), next(), next());
        let mut twist = || Twist { linear: vector(), angular: vector() };
        (0..count).map(|_| [twist(), twist(), twist()]).collect()
    }

    struct Motions<'a>(&'a [[Twist; 3]]);

    impl WithSimd for Motions<'_> {
        type Output = Vec<[f64; 7]>;

        /// Each motion made twice, in the order given.
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Vec<[f64; 7]> {
            let mut out = Vec::new();
            for chunk in self.0.chunks_exact(8) {
                for group in chunk.chunks_exact(Lanes::<S>::COUNT) {
                    let part = |f: &dyn Fn(&[Twist; 3]) -> f64| {
                        let values: Vec<f64> = group.iter().map(f).collect();
                        Lanes::load(simd, &values)
                    };
                    let vector = |f: &dyn Fn(&[Twist; 3]) -> Vec3| {
                        LaneVec3::new(part(&|t| f(t).x), part(&|t| f(t).y), part(&|t| f(t).z))
                    };
                    let twist = |i: usize| LaneTwist {
                        linear: vector(&|t| t[i].linear),
                        angular: vector(&|t| t[i].angular),
                    };
                    let motion = LanePose::exp(magnus_6_exponent(&[twist(0), twist(1), twist(2)]));
                    let pose = LanePose::identity(simd).then(motion).then(motion);
                    for lane in 0..Lanes::<S>::COUNT {
                        let p = [
                            pose.position.x,
                            pose.position.y,
                            pose.position.z,
                            pose.w,
                            pose.v.x,
                            pose.v.y,
                            pose.v.z,
                        ];
                        out.push(p.map(|lanes| lanes.as_slice()[lane]));
                    }
                }
            }
            out
        }
    }

    #[test]
    fn lanes_do_what_scalars_do_to_the_last_bit() {
        let twists = twists(8 * 500);
        let expected: Vec<[f64; 7]> = twists
            .iter()
            .map(|twists| {
                let motion = magnus_6(twists);
                let pose = Pose::IDENTITY * motion * motion;
                let ([x, y, z], [w, a, b, c]) = (pose.position.to_array(), pose.rotation.wxyz());
                [x, y, z, w, a, b, c]
            })
            .collect();
        assert!(Arch::new().dispatch(Motions(&twists)) == expected);
        assert!(Motions(&twists).with_simd(pulp::Scalar) == expected);
    }
}
