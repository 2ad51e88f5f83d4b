use core::ops::{Add, Mul};

use crate::{Ldlt3, Mat3, Vec3};

/// A symmetric 3×3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym3 {
    /// Row 1, column 1.
    pub xx: f64,
    /// Row 2, column 1.
    pub yx: f64,
    /// Row 2, column 2.
    pub yy: f64,
    /// Row 3, column 1.
    pub zx: f64,
    /// Row 3, column 2.
    pub zy: f64,
    /// Row 3, column 3.
    pub zz: f64,
}

impl Sym3 {
    /// The diagonal matrix with this diagonal.
    #[inline]
    #[must_use]
    pub const fn diagonal(d: Vec3) -> Self {
        Self { xx: d.x, yx: 0.0, yy: d.y, zx: 0.0, zy: 0.0, zz: d.z }
    }

    /// The dyad `a aᵀ`.
    #[inline]
    #[must_use]
    pub fn square(a: Vec3) -> Self {
        Self {
            xx: a.x * a.x,
            yx: a.y * a.x,
            yy: a.y * a.y,
            zx: a.z * a.x,
            zy: a.z * a.y,
            zz: a.z * a.z,
        }
    }

    /// The symmetric dyad `a bᵀ + b aᵀ`.
    #[inline]
    #[must_use]
    pub fn twin(a: Vec3, b: Vec3) -> Self {
        Self {
            xx: 2.0 * a.x * b.x,
            yx: a.y * b.x + b.y * a.x,
            yy: 2.0 * a.y * b.y,
            zx: a.z * b.x + b.z * a.x,
            zy: a.z * b.y + b.z * a.y,
            zz: 2.0 * a.z * b.z,
        }
    }

    /// The same as a general matrix.
    #[inline]
    #[must_use]
    pub const fn to_mat3(self) -> Mat3 {
        Mat3::from_rows(
            Vec3::new(self.xx, self.yx, self.zx),
            Vec3::new(self.yx, self.yy, self.zy),
            Vec3::new(self.zx, self.zy, self.zz),
        )
    }

    /// The factors, or `None` when the matrix is not positive definite to working precision.
    #[inline]
    #[must_use]
    pub fn ldlt(self) -> Option<Ldlt3> {
        self.to_mat3().ldlt()
    }
}

impl Add for Sym3 {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self {
            xx: self.xx + b.xx,
            yx: self.yx + b.yx,
            yy: self.yy + b.yy,
            zx: self.zx + b.zx,
            zy: self.zy + b.zy,
            zz: self.zz + b.zz,
        }
    }
}

impl Mul<f64> for Sym3 {
    type Output = Self;
    #[inline]
    fn mul(self, f: f64) -> Self {
        Self {
            xx: self.xx * f,
            yx: self.yx * f,
            yy: self.yy * f,
            zx: self.zx * f,
            zy: self.zy * f,
            zz: self.zz * f,
        }
    }
}

impl Mul<Vec3> for Sym3 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        Vec3::new(
            self.xx * v.x + self.yx * v.y + self.zx * v.z,
            self.yx * v.x + self.yy * v.y + self.zy * v.z,
            self.zx * v.x + self.zy * v.y + self.zz * v.z,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dyads_are_those_of_general_matrices() {
        let (a, b) = (Vec3::new(1.0, -2.0, 3.0), Vec3::new(0.5, 4.0, -1.0));
        assert_eq!(Sym3::square(a).to_mat3(), Mat3::outer(a, a));
        assert_eq!(Sym3::twin(a, b).to_mat3(), Mat3::outer(a, b) + Mat3::outer(b, a));
        let sum = Sym3::square(a) * 2.0 + Sym3::diagonal(b);
        assert_eq!(sum * b, sum.to_mat3() * b);
    }

    #[test]
    fn factors_solve() {
        let a = Sym3::diagonal(Vec3::new(1.0, 2.0, 3.0)) + Sym3::square(Vec3::new(1.0, 1.0, -1.0));
        let b = Vec3::new(3.0, -1.0, 2.0);
        let x = a.ldlt().unwrap().solve(b);
        assert!((a * x - b).max_abs() < 1e-14);
        assert!((Sym3::diagonal(Vec3::new(1.0, -1.0, 1.0))).ldlt().is_none());
    }
}
