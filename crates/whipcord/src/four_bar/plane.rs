//! Vectors in the plane of a disk, and functions with their first two derivatives.

use core::ops::{Add, Mul, Sub};

use whipcord_numerics::{Sym3, Vec3};

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

/// A function of a section's coordinates (p_x, p_y, ψ) with its first two derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Jet {
    pub value: f64,
    pub gradient: Vec3,
    pub hessian: Sym3,
}

impl Jet {
    /// A linear function of the coordinates, or a constant.
    pub const fn linear(value: f64, gradient: Vec3) -> Self {
        let hessian = Sym3 { xx: 0.0, yx: 0.0, yy: 0.0, zx: 0.0, zy: 0.0, zz: 0.0 };
        Self { value, gradient, hessian }
    }

    /// `f(self)`, where `f` and its first two derivatives have these values.
    #[inline]
    pub fn compose(&self, [f, df, ddf]: [f64; 3]) -> Self {
        Self {
            value: f,
            gradient: self.gradient * df,
            hessian: self.hessian * df + Sym3::square(self.gradient) * ddf,
        }
    }
}

impl Add for Jet {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self {
            value: self.value + b.value,
            gradient: self.gradient + b.gradient,
            hessian: self.hessian + b.hessian,
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, f: f64) -> Self {
        Self { value: self.value * f, gradient: self.gradient * f, hessian: self.hessian * f }
    }
}

impl Mul for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self {
            value: self.value * b.value,
            gradient: self.gradient * b.value + b.gradient * self.value,
            hessian: self.hessian * b.value
                + b.hessian * self.value
                + Sym3::twin(self.gradient, b.gradient),
        }
    }
}
