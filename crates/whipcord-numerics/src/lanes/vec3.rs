use core::ops::{Add, Mul, Sub};

use pulp::Simd;

use super::Lanes;
use crate::{Mat3, Vec3};

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
    pub fn splat(simd: S, v: Vec3) -> Self {
        Self::new(Lanes::splat(simd, v.x), Lanes::splat(simd, v.y), Lanes::splat(simd, v.z))
    }

    /// The vector in one lane.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, lane: usize) -> Vec3 {
        let at = |component: &Lanes<S>| component.as_slice()[lane];
        Vec3::new(at(&self.x), at(&self.y), at(&self.z))
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

    /// `a · v` with the same vector in every lane.
    #[inline(always)]
    #[must_use]
    pub fn along(self, a: Vec3) -> Lanes<S> {
        self.x * a.x + self.y * a.y + self.z * a.z
    }

    /// `m v` with the same matrix in every lane.
    #[inline(always)]
    #[must_use]
    pub fn times(self, m: &Mat3) -> Self {
        let [x, y, z] = m.rows;
        Self::new(self.along(x), self.along(y), self.along(z))
    }

    /// `mᵀ v` likewise.
    #[inline(always)]
    #[must_use]
    pub fn transpose_times(self, m: &Mat3) -> Self {
        let [a, b, c] = m.rows;
        let at = |a: f64, b: f64, c: f64| self.x * a + self.y * b + self.z * c;
        Self::new(at(a.x, b.x, c.x), at(a.y, b.y, c.y), at(a.z, b.z, c.z))
    }

    /// Euclidean norm.
    #[inline(always)]
    #[must_use]
    pub fn norm(self) -> Lanes<S> {
        self.dot(self).sqrt()
    }

    /// Largest magnitude of a component; a NaN may or may not be passed over.
    #[inline(always)]
    #[must_use]
    pub fn max_abs(self) -> Lanes<S> {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
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
