use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use crate::Vec3;
use crate::lanes::LaneSym3;

/// A 3×3 matrix, stored by rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Mat3 {
    /// The three rows.
    pub rows: [Vec3; 3],
}

impl Mat3 {
    /// The null matrix.
    pub const ZERO: Self = Self::from_rows(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    /// The identity.
    pub const IDENTITY: Self = Self::from_rows(Vec3::X, Vec3::Y, Vec3::Z);

    /// The matrix with these rows.
    #[inline]
    #[must_use]
    pub const fn from_rows(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self { rows: [a, b, c] }
    }

    /// The matrix with these columns.
    #[inline]
    #[must_use]
    pub const fn from_columns(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self::from_rows(
            Vec3::new(a.x, b.x, c.x),
            Vec3::new(a.y, b.y, c.y),
            Vec3::new(a.z, b.z, c.z),
        )
    }

    /// The diagonal matrix with this diagonal.
    #[inline]
    #[must_use]
    pub const fn diagonal(d: Vec3) -> Self {
        Self::from_rows(
            Vec3::new(d.x, 0.0, 0.0),
            Vec3::new(0.0, d.y, 0.0),
            Vec3::new(0.0, 0.0, d.z),
        )
    }

    /// The skew-symmetric matrix `â` with `â b = a × b`.
    #[inline]
    #[must_use]
    pub const fn skew(a: Vec3) -> Self {
        Self::from_rows(
            Vec3::new(0.0, -a.z, a.y),
            Vec3::new(a.z, 0.0, -a.x),
            Vec3::new(-a.y, a.x, 0.0),
        )
    }

    /// The dyad `a bᵀ`.
    #[inline]
    #[must_use]
    pub fn outer(a: Vec3, b: Vec3) -> Self {
        Self::from_rows(b * a.x, b * a.y, b * a.z)
    }

    /// Column `j`.
    #[inline]
    #[must_use]
    pub fn column(&self, j: usize) -> Vec3 {
        Vec3::new(self.rows[0][j], self.rows[1][j], self.rows[2][j])
    }

    /// The transpose.
    #[inline]
    #[must_use]
    pub fn transpose(&self) -> Self {
        Self::from_columns(self.rows[0], self.rows[1], self.rows[2])
    }

    /// `selfᵀ b`.
    #[inline]
    #[must_use]
    pub fn transpose_mul(&self, b: Vec3) -> Vec3 {
        self.rows[0] * b.x + self.rows[1] * b.y + self.rows[2] * b.z
    }

    /// The determinant.
    #[inline]
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.rows[0].dot(self.rows[1].cross(self.rows[2]))
    }

    /// The inverse, or `None` when the matrix is singular to working precision.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let [a, b, c] = self.rows;
        let (u, v, w) = (b.cross(c), c.cross(a), a.cross(b));
        let det = a.dot(u);
        let scale = a.norm() * b.norm() * c.norm();
        if det.abs() <= 4.0 * f64::EPSILON * scale {
            return None;
        }
        let d = 1.0 / det;
        Some(Self::from_columns(u * d, v * d, w * d))
    }

    /// The factors of a symmetric positive definite matrix, of which only the lower triangle is
    /// read; `None` when it is not positive definite to working precision. An infinite diagonal
    /// entry holds its unknown: solutions are zero there.
    #[inline]
    #[must_use]
    pub fn ldlt(&self) -> Option<Ldlt3> {
        Ldlt3::new(self)
    }

    /// `I + self`.
    #[inline]
    #[must_use]
    pub fn plus_identity(mut self) -> Self {
        self.rows[0].x += 1.0;
        self.rows[1].y += 1.0;
        self.rows[2].z += 1.0;
        self
    }

    /// The eigenvalues of a symmetric matrix in ascending order, by Jacobi's rotations: each is
    /// accurate to rounding relative to the largest.
    #[must_use]
    pub fn symmetric_eigenvalues(&self) -> [f64; 3] {
        let mut values = self.diagonalized(|_, _, _, _| ());
        values.sort_by(f64::total_cmp);
        values
    }

    /// The eigenvalues of a symmetric matrix in ascending order, and their unit eigenvectors.
    #[must_use]
    pub fn symmetric_eigen(&self) -> ([f64; 3], [Vec3; 3]) {
        let mut vectors = [Vec3::X, Vec3::Y, Vec3::Z];
        let values = self.diagonalized(|i, j, cos, sin| {
            let (a, b) = (vectors[i], vectors[j]);
            vectors[i] = cos * a - sin * b;
            vectors[j] = sin * a + cos * b;
        });
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        (order.map(|i| values[i]), order.map(|i| vectors[i]))
    }

    /// The diagonal that Jacobi's rotations leave of a symmetric matrix; `rotated` is told the plane
    /// of each, its cosine and its sine.
    fn diagonalized(&self, mut rotated: impl FnMut(usize, usize, f64, f64)) -> [f64; 3] {
        const SWEEPS: usize = 12;
        let mut a = *self;
        for _ in 0..SWEEPS {
            let off = a.rows[0].y.abs() + a.rows[0].z.abs() + a.rows[1].z.abs();
            let size = a.rows[0].x.abs() + a.rows[1].y.abs() + a.rows[2].z.abs();
            // Written so that a NaN ends the loop as well.
            if off.is_nan() || off <= 0.25 * f64::EPSILON * size {
                break;
            }
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                if let Some((cos, sin)) = a.annihilate(i, j) {
                    rotated(i, j, cos, sin);
                }
            }
        }
        [a.rows[0].x, a.rows[1].y, a.rows[2].z]
    }

    /// The eigenvalues of a symmetric matrix relative to a symmetric positive definite one, the
    /// roots of `det(self − λ metric)`, in ascending order; `None` where the metric is not positive
    /// definite to working precision.
    #[must_use]
    pub fn eigenvalues_relative_to(&self, metric: &Self) -> Option<[f64; 3]> {
        let factors = metric.ldlt()?;
        let d = factors.inv_d;
        let scale = Vec3::new(d.x.sqrt(), d.y.sqrt(), d.z.sqrt());
        // With metric = L D Lᵀ they are those of D^-½ L⁻¹ A L⁻ᵀ D^-½.
        let halved = |a: &Self| {
            let [r0, mut r1, mut r2] = a.rows;
            r1 -= r0 * factors.l10;
            r2 = r2 - r0 * factors.l20 - r1 * factors.l21;
            Self::from_rows(r0 * scale.x, r1 * scale.y, r2 * scale.z)
        };
        Some(halved(&halved(self).transpose()).symmetric_eigenvalues())
    }

    /// The least `μ` with `det(self − μ metric) = 0`, see [`LaneSym3::least_relative`].
    #[must_use]
    pub fn least_relative(&self, metric: &Self) -> f64 {
        let simd = pulp::Scalar::new();
        LaneSym3::splat(simd, self).least_relative(&LaneSym3::splat(simd, metric), simd).value
    }

    /// One Jacobi rotation in the plane of `i < j`: its cosine and sine, where one is needed.
    fn annihilate(&mut self, i: usize, j: usize) -> Option<(f64, f64)> {
        let off = self.rows[i][j];
        if off == 0.0 {
            return None;
        }
        let half = 0.5 * (self.rows[j][j] - self.rows[i][i]) / off;
        let tan = 1.0_f64.copysign(half) / (half.abs() + (1.0 + half * half).sqrt());
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let sin = tan * cos;
        let k = 3 - i - j;
        let (ki, kj) = (self.rows[k][i], self.rows[k][j]);
        self.rows[i][i] -= tan * off;
        self.rows[j][j] += tan * off;
        self.rows[i][j] = 0.0;
        self.rows[j][i] = 0.0;
        for (m, value) in [(i, cos * ki - sin * kj), (j, sin * ki + cos * kj)] {
            self.rows[k][m] = value;
            self.rows[m][k] = value;
        }
        Some((cos, sin))
    }
}

impl Add for Mat3 {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::from_rows(
            self.rows[0] + b.rows[0],
            self.rows[1] + b.rows[1],
            self.rows[2] + b.rows[2],
        )
    }
}

impl Sub for Mat3 {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Neg for Mat3 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl AddAssign for Mat3 {
    #[inline]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl Mul<f64> for Mat3 {
    type Output = Self;
    #[inline]
    fn mul(self, a: f64) -> Self {
        Self::from_rows(self.rows[0] * a, self.rows[1] * a, self.rows[2] * a)
    }
}

impl Mul<Vec3> for Mat3 {
    type Output = Vec3;
    #[inline]
    fn mul(self, b: Vec3) -> Vec3 {
        Vec3::new(self.rows[0].dot(b), self.rows[1].dot(b), self.rows[2].dot(b))
    }
}

impl Mul for Mat3 {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        let row = |a: Vec3| b.rows[0] * a.x + b.rows[1] * a.y + b.rows[2] * a.z;
        Self::from_rows(row(self.rows[0]), row(self.rows[1]), row(self.rows[2]))
    }
}

/// `L D Lᵀ` factors of a symmetric positive definite 3×3 matrix.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ldlt3 {
    l10: f64,
    l20: f64,
    l21: f64,
    inv_d: Vec3,
}

impl Ldlt3 {
    #[inline]
    fn new(a: &Mat3) -> Option<Self> {
        let [r0, r1, r2] = a.rows;
        let d0 = r0.x;
        let inv0 = 1.0 / d0;
        let l10 = r1.x * inv0;
        let l20 = r2.x * inv0;
        let d1 = r1.y - l10 * r1.x;
        let inv1 = 1.0 / d1;
        let m21 = r2.y - l20 * r1.x;
        let l21 = m21 * inv1;
        let d2 = r2.z - l20 * r2.x - l21 * m21;
        // Written so that an infinite pivot passes, and one of zero does not.
        let least = |diagonal: f64| f64::EPSILON * diagonal + f64::MIN_POSITIVE;
        (d0 > 0.0 && d1 >= least(r1.y) && d2 >= least(r2.z)).then_some(Self {
            l10,
            l20,
            l21,
            inv_d: Vec3::new(inv0, inv1, 1.0 / d2),
        })
    }

    /// Of a diagonal matrix, by the inverses of its diagonal.
    #[inline]
    #[must_use]
    pub const fn diagonal(inverses: Vec3) -> Self {
        Self { l10: 0.0, l20: 0.0, l21: 0.0, inv_d: inverses }
    }

    /// Solves `A x = b`.
    #[inline]
    #[must_use]
    pub fn solve(&self, b: Vec3) -> Vec3 {
        let [x, y, z] = self.solve_each([b.x, b.y, b.z]);
        Vec3::new(x, y, z)
    }

    /// Solves `A x = b` for components that may hold a number of each of several columns.
    #[inline(always)]
    #[must_use]
    pub fn solve_each<T>(&self, [b0, b1, b2]: [T; 3]) -> [T; 3]
    where
        T: Copy + Sub<Output = T>,
        f64: Mul<T, Output = T>,
    {
        let y1 = b1 - self.l10 * b0;
        let y2 = b2 - self.l20 * b0 - self.l21 * y1;
        let x2 = self.inv_d.z * y2;
        let x1 = self.inv_d.y * y1 - self.l21 * x2;
        let x0 = self.inv_d.x * b0 - self.l10 * x1 - self.l20 * x2;
        [x0, x1, x2]
    }

    /// Solves `A X = B`, column by column.
    #[inline]
    #[must_use]
    pub fn solve_matrix(&self, b: &Mat3) -> Mat3 {
        Mat3::from_columns(
            self.solve(b.column(0)),
            self.solve(b.column(1)),
            self.solve(b.column(2)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spd() -> Mat3 {
        Mat3::from_rows(
            Vec3::new(4.0, 1.0, -0.5),
            Vec3::new(1.0, 3.0, 0.25),
            Vec3::new(-0.5, 0.25, 2.0),
        )
    }

    #[test]
    fn ldlt_solves() {
        let b = Vec3::new(1.0, -2.0, 3.0);
        let x = spd().ldlt().unwrap().solve(b);
        assert!((spd() * x - b).max_abs() < 1e-15);
        let inverse = spd().inverse().unwrap();
        assert!((inverse * b - x).max_abs() < 1e-15);
    }

    #[test]
    fn indefinite_and_singular_are_refused() {
        assert!(Mat3::diagonal(Vec3::new(1.0, -1.0, 1.0)).ldlt().is_none());
        assert!(Mat3::ZERO.ldlt().is_none());
        assert!(Mat3::outer(Vec3::X, Vec3::Y).inverse().is_none());
    }

    #[test]
    fn an_infinite_pivot_holds_its_unknown() {
        let b = Vec3::new(1.0, -2.0, 3.0);
        for held in 0..3 {
            let mut a = spd();
            a.rows[held][held] = f64::INFINITY;
            let x = a.ldlt().unwrap().solve(b);
            let (i, j) = ((held + 1) % 3, (held + 2) % 3);
            assert_eq!(x[held], 0.0);
            for k in [i, j] {
                let left = spd().rows[k][i] * x[i] + spd().rows[k][j] * x[j] - b[k];
                assert!(left.abs() < 1e-15, "{held}: {left}");
            }
        }
        let rigid = Mat3::diagonal(Vec3::new(1.0, 1.0, 1.0) * f64::INFINITY);
        assert_eq!(rigid.ldlt().unwrap().solve(b), Vec3::ZERO);
        assert!(Mat3::diagonal(Vec3::new(1.0, 0.0, 1.0)).ldlt().is_none());
    }

    #[test]
    fn relative_eigenvalues_make_the_difference_singular() {
        let metric = Mat3::from_rows(
            Vec3::new(2.0, -0.3, 0.1),
            Vec3::new(-0.3, 0.5, 0.2),
            Vec3::new(0.1, 0.2, 7.0),
        );
        let values = spd().eigenvalues_relative_to(&metric).unwrap();
        assert!(values[0] < values[1] && values[1] < values[2]);
        for value in values {
            assert!((spd() - metric * value).determinant().abs() < 1e-12);
        }
        let relative = spd().eigenvalues_relative_to(&Mat3::IDENTITY).unwrap();
        for (a, b) in relative.iter().zip(spd().symmetric_eigenvalues()) {
            assert!((a - b).abs() < 1e-14);
        }
        assert!(spd().eigenvalues_relative_to(&Mat3::ZERO).is_none());
    }

    #[test]
    fn the_least_relative_eigenvalue_is_the_least_of_all() {
        let metric = Mat3::from_rows(
            Vec3::new(2.0, -0.3, 0.1),
            Vec3::new(-0.3, 0.5, 0.2),
            Vec3::new(0.1, 0.2, 7.0),
        );
        let flat = Mat3::outer(Vec3::new(1.0, 2.0, -0.3), Vec3::new(1.0, 2.0, -0.3));
        let flatter = flat + Mat3::outer(Vec3::new(0.1, 0.0, 0.2), Vec3::new(0.1, 0.0, 0.2));
        for (matrix, accuracy) in [
            (spd(), 1e-14),
            (spd() * 1e-6, 1e-20),
            (metric * 0.7, 1e-5),
            (Mat3::ZERO, 0.0),
            // One root at zero, and two.
            (flatter, 1e-14),
            (flat, 1e-7),
        ] {
            let least = matrix.eigenvalues_relative_to(&metric).unwrap()[0];
            let got = matrix.least_relative(&metric);
            assert!((got - least).abs() <= accuracy, "{got} {least}");
        }
    }

    #[test]
    fn eigenvalues_satisfy_the_invariants() {
        let [a, b, c] = spd().symmetric_eigenvalues();
        assert!(a <= b && b <= c);
        assert!((a + b + c - 9.0).abs() < 1e-13);
        assert!((a * b * c - spd().determinant()).abs() < 1e-12);
        assert_eq!(Mat3::IDENTITY.symmetric_eigenvalues(), [1.0; 3]);
    }

    #[test]
    fn eigenvectors_are_unit_vectors_that_keep_their_direction() {
        let (values, vectors) = spd().symmetric_eigen();
        assert_eq!(values, spd().symmetric_eigenvalues());
        for (value, vector) in values.iter().zip(vectors) {
            assert!((vector.norm() - 1.0).abs() < 1e-15);
            assert!((spd() * vector - *value * vector).max_abs() < 1e-14);
        }
    }
}
