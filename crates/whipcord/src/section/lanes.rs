//! Several derivatives at once: a number for each of a few columns, so that one pass over a stage
//! serves them all and the compiler has independent operations to put side by side.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use whipcord_numerics::{Mat3, Vec3};

/// Columns that are carried together.
pub(crate) const LANES: usize = 4;

/// One number of each column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub(crate) struct Lane(pub [f64; LANES]);

/// One vector of each column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LaneVec {
    pub x: Lane,
    pub y: Lane,
    pub z: Lane,
}

/// One 3×3 matrix of each column, by rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LaneMat {
    pub rows: [LaneVec; 3],
}

impl Lane {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// What a function has of each number.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self([f(self.0[0]), f(self.0[1]), f(self.0[2]), f(self.0[3])])
    }

    /// The sum of all numbers.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }

    /// What a function has of the numbers of each lane.
    #[inline(always)]
    pub fn with(self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let (a, b) = (self.0, b.0);
        Self([f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])])
    }
}

impl Add for Lane {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(b, |a, b| a + b)
    }
}

impl Sub for Lane {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(b, |a, b| a - b)
    }
}

impl Neg for Lane {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Lane {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl Mul for Lane {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(b, |a, b| a * b)
    }
}

impl Mul<Lane> for f64 {
    type Output = Lane;
    #[inline(always)]
    fn mul(self, b: Lane) -> Lane {
        b.map(|b| self * b)
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

    /// The sum of all vectors.
    #[inline(always)]
    pub fn sum(&self) -> Vec3 {
        Vec3::new(self.x.sum(), self.y.sum(), self.z.sum())
    }

    /// `a · v` of each column.
    #[inline(always)]
    pub fn dot(&self, a: Vec3) -> Lane {
        a.x * self.x + a.y * self.y + a.z * self.z
    }

    /// `a · b` of each column.
    #[inline(always)]
    pub fn inner(&self, b: &Self) -> Lane {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// `a × b` of each column.
    #[inline(always)]
    pub fn cross(&self, b: &Self) -> Self {
        Self {
            x: self.y * b.z - self.z * b.y,
            y: self.z * b.x - self.x * b.z,
            z: self.x * b.y - self.y * b.x,
        }
    }

    /// Each vector by the number of its column.
    #[inline(always)]
    pub fn scaled(&self, f: Lane) -> Self {
        Self { x: f * self.x, y: f * self.y, z: f * self.z }
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

impl Neg for LaneVec {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
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

/// `a` by the number of each column.
#[inline(always)]
pub(crate) fn along(a: Vec3, f: Lane) -> LaneVec {
    LaneVec { x: a.x * f, y: a.y * f, z: a.z * f }
}

/// `m v` of each column.
#[inline(always)]
pub(crate) fn times(m: &Mat3, v: &LaneVec) -> LaneVec {
    LaneVec { x: v.dot(m.rows[0]), y: v.dot(m.rows[1]), z: v.dot(m.rows[2]) }
}

/// `mᵀ v` of each column.
#[inline(always)]
pub(crate) fn transpose_times(m: &Mat3, v: &LaneVec) -> LaneVec {
    let [a, b, c] = m.rows;
    LaneVec {
        x: a.x * v.x + b.x * v.y + c.x * v.z,
        y: a.y * v.x + b.y * v.y + c.y * v.z,
        z: a.z * v.x + b.z * v.y + c.z * v.z,
    }
}

/// `a × v` of each column.
#[inline(always)]
pub(crate) fn cross(a: Vec3, v: &LaneVec) -> LaneVec {
    LaneVec { x: a.y * v.z - a.z * v.y, y: a.z * v.x - a.x * v.z, z: a.x * v.y - a.y * v.x }
}

impl LaneMat {
    /// The matrix of one column.
    #[inline]
    pub fn get(&self, lane: usize) -> Mat3 {
        let [a, b, c] = &self.rows;
        Mat3::from_rows(a.get(lane), b.get(lane), c.get(lane))
    }

    /// Sets the matrix of one column.
    #[inline]
    pub fn set(&mut self, lane: usize, m: &Mat3) {
        for (row, value) in self.rows.iter_mut().zip(m.rows) {
            row.set(lane, value);
        }
    }

    /// `â` with `â b = a × b`.
    #[inline(always)]
    pub fn skew(a: &LaneVec) -> Self {
        let none = Lane::default();
        Self {
            rows: [
                LaneVec { x: none, y: -a.z, z: a.y },
                LaneVec { x: a.z, y: none, z: -a.x },
                LaneVec { x: -a.y, y: a.x, z: none },
            ],
        }
    }

    /// The multiple of the identity.
    #[inline(always)]
    pub fn diagonal(f: Lane) -> Self {
        let none = Lane::default();
        Self {
            rows: [
                LaneVec { x: f, y: none, z: none },
                LaneVec { x: none, y: f, z: none },
                LaneVec { x: none, y: none, z: f },
            ],
        }
    }

    /// `â self`.
    #[inline(always)]
    pub fn crossed(&self, a: &LaneVec) -> Self {
        let [x, y, z] = &self.rows;
        Self {
            rows: [
                z.scaled(a.y) - y.scaled(a.z),
                x.scaled(a.z) - z.scaled(a.x),
                y.scaled(a.x) - x.scaled(a.y),
            ],
        }
    }

    /// `self b`.
    #[inline(always)]
    pub fn times(&self, b: &Self) -> Self {
        let row =
            |a: &LaneVec| b.rows[0].scaled(a.x) + b.rows[1].scaled(a.y) + b.rows[2].scaled(a.z);
        Self { rows: [row(&self.rows[0]), row(&self.rows[1]), row(&self.rows[2])] }
    }

    /// `self bᵀ`.
    #[inline(always)]
    pub fn times_transpose(&self, b: &Self) -> Self {
        let row = |a: &LaneVec| LaneVec {
            x: a.inner(&b.rows[0]),
            y: a.inner(&b.rows[1]),
            z: a.inner(&b.rows[2]),
        };
        Self { rows: [row(&self.rows[0]), row(&self.rows[1]), row(&self.rows[2])] }
    }

    /// Each matrix by the number of its column.
    #[inline(always)]
    pub fn scaled(&self, f: Lane) -> Self {
        let [a, b, c] = &self.rows;
        Self { rows: [a.scaled(f), b.scaled(f), c.scaled(f)] }
    }
}

impl Add for LaneMat {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        let ([a, c, e], [b, d, f]) = (self.rows, b.rows);
        Self { rows: [a + b, c + d, e + f] }
    }
}

impl Sub for LaneMat {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        let ([a, c, e], [b, d, f]) = (self.rows, b.rows);
        Self { rows: [a - b, c - d, e - f] }
    }
}

impl Mul<LaneMat> for f64 {
    type Output = LaneMat;
    #[inline(always)]
    fn mul(self, b: LaneMat) -> LaneMat {
        let [x, y, z] = b.rows;
        LaneMat { rows: [self * x, self * y, self * z] }
    }
}
