//! Several derivatives at once: a number for each of a few columns, so that one pass over a stage
//! serves them all and the compiler has independent operations to put side by side.

use core::ops::{Add, AddAssign, Mul, Sub};

use whipcord_numerics::{Mat3, Vec3};

/// Columns that are carried together.
pub(super) const LANES: usize = 4;

/// One number of each column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lane(pub [f64; LANES]);

/// One vector of each column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LaneVec {
    pub x: Lane,
    pub y: Lane,
    pub z: Lane,
}

impl Add for Lane {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + b.0[i]))
    }
}

impl Sub for Lane {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] - b.0[i]))
    }
}

impl AddAssign for Lane {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl Mul<Lane> for f64 {
    type Output = Lane;
    #[inline(always)]
    fn mul(self, b: Lane) -> Lane {
        Lane(core::array::from_fn(|i| self * b.0[i]))
    }
}

impl LaneVec {
    /// The vector of one column.
    #[inline]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x.0[lane], self.y.0[lane], self.z.0[lane])
    }

    /// Sets the vector of one column.
    #[inline]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        (self.x.0[lane], self.y.0[lane], self.z.0[lane]) = (v.x, v.y, v.z);
    }

    /// `a · v` of each column.
    #[inline(always)]
    pub fn dot(&self, a: Vec3) -> Lane {
        a.x * self.x + a.y * self.y + a.z * self.z
    }
}

impl Add for LaneVec {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl Sub for LaneVec {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

impl AddAssign for LaneVec {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl Mul<LaneVec> for f64 {
    type Output = LaneVec;
    #[inline(always)]
    fn mul(self, b: LaneVec) -> LaneVec {
        LaneVec { x: self * b.x, y: self * b.y, z: self * b.z }
    }
}

/// `m v` of each column.
#[inline(always)]
pub(super) fn times(m: &Mat3, v: &LaneVec) -> LaneVec {
    LaneVec { x: v.dot(m.rows[0]), y: v.dot(m.rows[1]), z: v.dot(m.rows[2]) }
}

/// `mᵀ v` of each column.
#[inline(always)]
pub(super) fn transpose_times(m: &Mat3, v: &LaneVec) -> LaneVec {
    let [a, b, c] = m.rows;
    LaneVec {
        x: a.x * v.x + b.x * v.y + c.x * v.z,
        y: a.y * v.x + b.y * v.y + c.y * v.z,
        z: a.z * v.x + b.z * v.y + c.z * v.z,
    }
}

/// `a × v` of each column.
#[inline(always)]
pub(super) fn cross(a: Vec3, v: &LaneVec) -> LaneVec {
    LaneVec { x: a.y * v.z - a.z * v.y, y: a.z * v.x - a.x * v.z, z: a.x * v.y - a.y * v.x }
}
