//! Functions of three variables with their first two derivatives.

use core::ops::{Add, Mul};

use crate::sym3::Sym3;
use crate::vec3::Vec3;

/// The value of a function of three variables with its first two derivatives.
///
/// ```
/// use whipcord_numerics::{Jet, Vec3};
///
/// // (x + 2y)² at x = 1, y = 1.
/// let sum = Jet::linear(3.0, Vec3::new(1.0, 2.0, 0.0));
/// let square = sum * sum;
/// assert_eq!((square.value, square.gradient), (9.0, Vec3::new(6.0, 12.0, 0.0)));
/// assert_eq!((square.hessian.xx, square.hessian.yx, square.hessian.yy), (2.0, 4.0, 8.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// First derivatives.
    pub gradient: Vec3,
    /// Second derivatives.
    pub hessian: Sym3,
}

impl Jet {
    /// A linear function of the variables, or a constant.
    #[must_use]
    pub const fn linear(value: f64, gradient: Vec3) -> Self {
        let hessian = Sym3 { xx: 0.0, yx: 0.0, yy: 0.0, zx: 0.0, zy: 0.0, zz: 0.0 };
        Self { value, gradient, hessian }
    }

    /// `f(self)`, where `f` and its first two derivatives have these values.
    #[inline]
    #[must_use]
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
