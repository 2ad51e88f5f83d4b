//! Vectors in the plane of a disk.

use core::ops::{Add, Mul, Sub};

use whipcord_numerics::Vec3;

/// A vector in the plane of a disk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vec2 {
    pub x: f64,
    pub y: f64,
}

impl Vec2 {
    pub const X: Self = Self::new(1.0, 0.0);

    #[inline]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    #[inline]
    pub fn dot(self, b: Self) -> f64 {
        self.x * b.x + self.y * b.y
    }

    #[inline]
    pub fn norm(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Turned a quarter counter-clockwise.
    #[inline]
    pub const fn quarter(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// Turned counter-clockwise by an angle with this cosine and sine.
    #[inline]
    pub fn turned(self, cos: f64, sin: f64) -> Self {
        self * cos + self.quarter() * sin
    }

    /// With a third component.
    #[inline]
    pub const fn with(self, z: f64) -> Vec3 {
        Vec3::new(self.x, self.y, z)
    }
}

impl Add for Vec2 {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y)
    }
}

impl Sub for Vec2 {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y)
    }
}

impl Mul<f64> for Vec2 {
    type Output = Self;
    #[inline]
    fn mul(self, f: f64) -> Self {
        Self::new(self.x * f, self.y * f)
    }
}
