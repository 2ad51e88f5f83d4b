//! 6×6 matrices in 3×3 blocks.

use whipcord_numerics::{Mat3, Twist, Vec3};

/// A 6×6 matrix `[a b; c d]` that acts on twists or on wrenches: `a` from translational to translational parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Block {
    pub a: Mat3,
    pub b: Mat3,
    pub c: Mat3,
    pub d: Mat3,
}

impl Block {
    /// The matrix of a linear map.
    pub fn of(map: impl Fn(Twist) -> Twist) -> Self {
        let column = |k: usize| {
            let mut unit = Twist::default();
            let part = if k < 3 { &mut unit.linear } else { &mut unit.angular };
            part[k % 3] = 1.0;
            map(unit)
        };
        let columns: [Twist; 6] = core::array::from_fn(column);
        let part = |first: usize, of: fn(&Twist) -> Vec3| {
            let [x, y, z] = [0, 1, 2].map(|k| of(&columns[first + k]));
            Mat3::from_columns(x, y, z)
        };
        let (linear, angular) = (|x: &Twist| x.linear, |x: &Twist| x.angular);
        Self { a: part(0, linear), b: part(3, linear), c: part(0, angular), d: part(3, angular) }
    }

    /// `self x`.
    #[inline]
    pub fn apply(&self, x: &Twist) -> Twist {
        Twist {
            linear: self.a * x.linear + self.b * x.angular,
            angular: self.c * x.linear + self.d * x.angular,
        }
    }

    /// `selfᵀ x`.
    #[inline]
    pub fn apply_transposed(&self, x: &Twist) -> Twist {
        Twist {
            linear: self.a.transpose_mul(x.linear) + self.c.transpose_mul(x.angular),
            angular: self.b.transpose_mul(x.linear) + self.d.transpose_mul(x.angular),
        }
    }

    /// `self b`.
    #[inline]
    pub fn times(&self, b: &Self) -> Self {
        Self {
            a: self.a * b.a + self.b * b.c,
            b: self.a * b.b + self.b * b.d,
            c: self.c * b.a + self.d * b.c,
            d: self.c * b.b + self.d * b.d,
        }
    }

    /// `self −= p q`.
    #[inline]
    pub fn subtract_product(&mut self, p: &Self, q: &Self) {
        let product = p.times(q);
        self.a = self.a - product.a;
        self.b = self.b - product.b;
        self.c = self.c - product.c;
        self.d = self.d - product.d;
    }

    /// `f` times the matrix.
    pub fn scaled(&self, f: f64) -> Self {
        let mut out = Self::default();
        out.add_scaled(f, self);
        out
    }

    /// `self += f m`.
    #[inline]
    pub fn add_scaled(&mut self, f: f64, m: &Self) {
        self.a += m.a * f;
        self.b += m.b * f;
        self.c += m.c * f;
        self.d += m.d * f;
    }

    /// `self + m`.
    #[inline]
    pub fn plus(&self, m: &Self) -> Self {
        Self { a: self.a + m.a, b: self.b + m.b, c: self.c + m.c, d: self.d + m.d }
    }

    /// The inverse, by the Schur complement of `a`; `None` where a pivot block is singular to working precision.
    #[inline]
    pub fn inverse(&self) -> Option<Self> {
        let a = self.a.inverse()?;
        let (left, right) = (self.c * a, a * self.b);
        let d = (self.d - self.c * right).inverse()?;
        let (up, down) = (right * d, d * left);
        Some(Self { a: a + right * down, b: -up, c: -down, d })
    }
}

/// `r̂ m`.
#[inline]
pub(crate) fn skew_times(r: Vec3, m: &Mat3) -> Mat3 {
    let [x, y, z] = m.rows;
    Mat3::from_rows(z * r.y - y * r.z, x * r.z - z * r.x, y * r.x - x * r.y)
}

/// `m r̂`.
#[inline]
pub(crate) fn times_skew(m: &Mat3, r: Vec3) -> Mat3 {
    let [x, y, z] = m.rows;
    Mat3::from_rows(x.cross(r), y.cross(r), z.cross(r))
}

/// Scalar product of a wrench and a twist.
#[inline]
pub(crate) fn dot(a: &Twist, b: &Twist) -> f64 {
    a.linear.dot(b.linear) + a.angular.dot(b.angular)
}

/// Sum of the scalar products of wrenches and twists.
pub(crate) fn sum(a: &[Twist], b: &[Twist]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// `out += factor by`.
pub(crate) fn add(out: &mut [Twist], by: &[Twist], factor: f64) {
    for (out, by) in out.iter_mut().zip(by) {
        *out = *out + *by * factor;
    }
}

/// `ad_ξᵀ W` = (n × u, n × v + m × u): what a wrench `W = (n, m)` at a section exerts on the velocities, eq. (4) of the page on motion.
#[inline]
pub(crate) fn transposed_bracket(strain: &Twist, wrench: &Twist) -> Twist {
    Twist {
        linear: wrench.linear.cross(strain.angular),
        angular: wrench.linear.cross(strain.linear) + wrench.angular.cross(strain.angular),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(seed: f64) -> Mat3 {
        let entry = |i: usize| (seed + 1.7 * (i * i) as f64).sin();
        let row = |i: usize| Vec3::new(entry(i), entry(i + 1), entry(i + 2));
        Mat3::from_rows(row(0), row(3), row(6))
    }

    #[test]
    fn the_inverse_undoes_the_matrix() {
        let block = Block { a: matrix(0.1), b: matrix(1.0), c: matrix(2.3), d: matrix(3.1) };
        let x = Twist { linear: Vec3::new(1.0, -2.0, 0.5), angular: Vec3::new(0.3, 4.0, -1.0) };
        let back = block.inverse().unwrap().apply(&block.apply(&x));
        assert!((back.linear - x.linear).max_abs() < 1e-12, "{back:?}");
        assert!((back.angular - x.angular).max_abs() < 1e-12, "{back:?}");
        let unit = block.inverse().unwrap().times(&block);
        assert!((unit.apply(&x).linear - x.linear).max_abs() < 1e-12);
        let flat =
            Block { a: Mat3::IDENTITY, b: Mat3::IDENTITY, c: Mat3::IDENTITY, d: Mat3::IDENTITY };
        assert!(flat.inverse().is_none());
    }

    #[test]
    fn products_with_skew_matrices_and_the_transposed_bracket() {
        let (m, r) = (matrix(0.4), Vec3::new(0.3, -1.0, 2.0));
        let near = |a: Mat3, b: Mat3| (a - b).rows.iter().all(|row| row.max_abs() < 1e-14);
        assert!(near(skew_times(r, &m), Mat3::skew(r) * m));
        assert!(near(times_skew(&m, r), m * Mat3::skew(r)));
        let strain = Twist { linear: Vec3::new(0.1, 0.2, 1.1), angular: Vec3::new(2.0, -1.0, 0.4) };
        let wrench = Twist { linear: Vec3::new(3.0, 0.5, -1.0), angular: Vec3::new(0.2, 0.1, 0.7) };
        let velocity =
            Twist { linear: Vec3::new(1.0, -0.4, 0.6), angular: Vec3::new(0.9, 0.8, -2.0) };
        let power = dot(&wrench, &strain.bracket(velocity));
        assert!((power - dot(&transposed_bracket(&strain, &wrench), &velocity)).abs() < 1e-14);
    }
}
