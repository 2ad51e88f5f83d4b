//! Several numbers at once, one to each lane of the processor's vectors.
//!
//! What is here does to each lane what its scalar namesake does to a number: the same operations in
//! the same order, none of them fused, so that the results are the same to the last bit. Tests hold
//! it to that.
//!
//! Only what is inlined into [`Width::dispatch`] is compiled for the vectors: elsewhere each operation is a call.
//! Functions of lanes are `#[inline(always)]`, and work goes through loops rather than through closures that an
//! iterator or an `Option` calls, unless they are a few operations long.

mod mat3;
mod pose;
#[cfg(test)]
mod tests;
mod vec3;
mod width;

use core::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

pub use mat3::{LaneLdlt3, LaneSym3};
pub use pose::{LanePose, LaneTwist, magnus_6_exponent};
pub use vec3::LaneVec3;
pub use width::Width;

/// One number to each lane.
// On a line of the cache: a vector across two is stored and loaded in two halves.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
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

    /// As many of these numbers as there are lanes, from a place on.
    ///
    /// # Panics
    /// Where there are fewer.
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, values: &[f64], first: usize) -> Self {
        let (vectors, _) = S::as_simd_f64s(&values[first..first + Self::COUNT]);
        Self { simd, value: vectors[0] }
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

    /// Where this number is at most another; nowhere for a NaN.
    #[inline(always)]
    #[must_use]
    pub fn at_most(self, b: Self) -> LaneMask<S> {
        let value = self.simd.less_than_or_equal_f64s(self.value, b.value);
        LaneMask { simd: self.simd, value }
    }

    /// Where this number is below another; nowhere for a NaN.
    #[inline(always)]
    #[must_use]
    pub fn below(self, b: Self) -> LaneMask<S> {
        LaneMask { simd: self.simd, value: self.simd.less_than_f64s(self.value, b.value) }
    }

    /// Magnitudes.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.with(self.simd.abs_f64s(self.value))
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

/// A choice of lanes.
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<S: Simd> {
    simd: S,
    value: S::m64s,
}

impl<S: Simd> LaneMask<S> {
    /// The lanes of both choices.
    #[inline(always)]
    #[must_use]
    pub fn and(self, b: Self) -> Self {
        Self { simd: self.simd, value: self.simd.and_m64s(self.value, b.value) }
    }

    /// The lanes of either choice.
    #[inline(always)]
    #[must_use]
    pub fn or(self, b: Self) -> Self {
        Self { simd: self.simd, value: self.simd.or_m64s(self.value, b.value) }
    }

    /// The lanes of this choice that are not of the other.
    #[inline(always)]
    #[must_use]
    pub fn without(self, b: Self) -> Self {
        let either = self.simd.xor_m64s(self.value, b.value);
        Self { simd: self.simd, value: self.simd.and_m64s(self.value, either) }
    }

    /// `then` in the lanes of the choice, `otherwise` in the others.
    #[inline(always)]
    #[must_use]
    pub fn select(self, then: Lanes<S>, otherwise: Lanes<S>) -> Lanes<S> {
        then.with(self.simd.select_f64s(self.value, then.value, otherwise.value))
    }

    /// Whether every lane is chosen.
    #[inline(always)]
    #[must_use]
    pub fn all(self) -> bool {
        self.simd.first_true_m64s(self.simd.not_m64s(self.value)) >= Lanes::<S>::COUNT
    }

    /// Whether any lane is chosen.
    #[inline(always)]
    #[must_use]
    pub fn any(self) -> bool {
        self.simd.first_true_m64s(self.value) < Lanes::<S>::COUNT
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
