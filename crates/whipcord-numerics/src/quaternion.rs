use core::ops::Mul;

use crate::{Mat3, Vec3};

/// A rotation as a unit quaternion (w, x, y, z); `q` and `-q` are the same rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct UnitQuaternion {
    /// Real part.
    pub w: f64,
    /// Imaginary part.
    pub v: Vec3,
}

impl Default for UnitQuaternion {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// Below this squared half-angle sine and cosine are taken from their series, which is then exact
/// to the last bit or two and faster than the library functions.
const SERIES_LIMIT: f64 = 0.0625;

impl UnitQuaternion {
    /// No rotation.
    pub const IDENTITY: Self = Self { w: 1.0, v: Vec3::ZERO };

    /// The rotation by `‖phi‖` radians about `phi`: `exp(φ̂)`.
    #[inline]
    #[must_use]
    pub fn exp(phi: Vec3) -> Self {
        let half = phi * 0.5;
        let x = half.norm_squared();
        let (sinc, cos) = if x < SERIES_LIMIT {
            sinc_cos_series(x)
        } else {
            let a = x.sqrt();
            (a.sin() / a, a.cos())
        };
        Self { w: cos, v: half * sinc }
    }

    /// Up to which square of its imaginary part [`Self::log`] takes the series of the arcsine, which is exact to rounding there.
    pub(crate) const LOG_SERIES_LIMIT: f64 = 1e-3;
    /// Of the arcsine of x over x by the square of x, the highest coefficient first.
    pub(crate) const LOG_SERIES: [f64; 6] =
        [63.0 / 2816.0, 35.0 / 1152.0, 5.0 / 112.0, 3.0 / 40.0, 1.0 / 6.0, 1.0];

    /// The rotation vector of length at most π with `exp(log(q)) = q`.
    #[must_use]
    pub fn log(self) -> Vec3 {
        let (w, v) = if self.w < 0.0 { (-self.w, -self.v) } else { (self.w, self.v) };
        let squared = v.norm_squared();
        if squared < Self::LOG_SERIES_LIMIT {
            let norm = squared + w * w;
            let x = squared * (1.0 / norm);
            let series = Self::LOG_SERIES.into_iter().fold(0.0, |series, c| series * x + c);
            return v * (series * (2.0 / norm.sqrt()));
        }
        let sin = squared.sqrt();
        v * (2.0 * sin.atan2(w) / sin)
    }

    /// The quaternion scaled to norm 1 by one Newton step: for products of unit quaternions, whose
    /// norm has drifted by rounding only.
    #[inline]
    #[must_use]
    pub fn renormalized(self) -> Self {
        self.scaled(self.renormalization())
    }

    /// The factor of [`Self::renormalized`].
    #[inline]
    #[must_use]
    pub fn renormalization(self) -> f64 {
        1.5 - 0.5 * (self.w * self.w + self.v.norm_squared())
    }

    /// All components times a number.
    #[inline]
    #[must_use]
    pub fn scaled(self, f: f64) -> Self {
        Self { w: self.w * f, v: self.v * f }
    }

    /// The unit quaternion along (w, x, y, z), or `None` when that is null or not finite. One that is
    /// a unit quaternion to rounding stays as it is.
    #[must_use]
    pub fn from_wxyz([w, x, y, z]: [f64; 4]) -> Option<Self> {
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        if (norm - 1.0).abs() <= 4.0 * f64::EPSILON {
            return Some(Self { w, v: Vec3::new(x, y, z) });
        }
        (norm > 0.0 && norm.is_finite()).then(|| Self { w: w / norm, v: Vec3::new(x, y, z) / norm })
    }

    /// The components (w, x, y, z).
    #[must_use]
    pub const fn wxyz(self) -> [f64; 4] {
        [self.w, self.v.x, self.v.y, self.v.z]
    }

    /// The inverse rotation.
    #[inline]
    #[must_use]
    pub fn conjugate(self) -> Self {
        Self { w: self.w, v: -self.v }
    }

    /// The rate `½ q (0, u)` of (w, x, y, z) while the frame turns at `u`, in its own axes.
    #[inline]
    #[must_use]
    pub fn rate(self, u: Vec3) -> [f64; 4] {
        let half = u * 0.5;
        let v = self.w * half + self.v.cross(half);
        [-self.v.dot(half), v.x, v.y, v.z]
    }

    /// The rotated vector.
    #[inline]
    #[must_use]
    pub fn rotate(self, a: Vec3) -> Vec3 {
        let t = 2.0 * self.v.cross(a);
        a + self.w * t + self.v.cross(t)
    }

    /// What the rotation adds to a vector, `R − I`, as a matrix. Of a quaternion that is not a unit it is
    /// that times the squared norm.
    #[inline]
    #[must_use]
    pub fn to_displacement(self) -> Mat3 {
        let Self { w, v } = self;
        let t = v + v;
        let (xx, yy, zz) = (t.x * v.x, t.y * v.y, t.z * v.z);
        let (xy, xz, yz) = (t.x * v.y, t.x * v.z, t.y * v.z);
        let (wx, wy, wz) = (w * t.x, w * t.y, w * t.z);
        Mat3::from_rows(
            Vec3::new(-yy - zz, xy - wz, xz + wy),
            Vec3::new(xy + wz, -xx - zz, yz - wx),
            Vec3::new(xz - wy, yz + wx, -xx - yy),
        )
    }

    /// The rotation matrix, whose columns are the rotated axes.
    #[inline]
    #[must_use]
    pub fn to_matrix(self) -> Mat3 {
        self.to_displacement().plus_identity()
    }
}

impl Mul for UnitQuaternion {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self {
            w: self.w * b.w - self.v.dot(b.v),
            v: self.w * b.v + b.w * self.v + self.v.cross(b.v),
        }
    }
}

/// `sin(√x)/√x` and `cos(√x)` for `0 ≤ x < SERIES_LIMIT`.
#[inline]
fn sinc_cos_series(x: f64) -> (f64, f64) {
    let sinc = 1.0
        + x * (-1.0 / 6.0
            + x * (1.0 / 120.0
                + x * (-1.0 / 5040.0
                    + x * (1.0 / 362_880.0
                        + x * (-1.0 / 39_916_800.0 + x * (1.0 / 6_227_020_800.0))))));
    let cos = 1.0
        + x * (-0.5
            + x * (1.0 / 24.0
                + x * (-1.0 / 720.0
                    + x * (1.0 / 40_320.0
                        + x * (-1.0 / 3_628_800.0 + x * (1.0 / 479_001_600.0))))));
    (sinc, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_matches_rodrigues_on_both_sides_of_the_series_limit() {
        for angle in [0.0, 1e-9, 1e-3, 0.3, 0.4999, 0.5001, 1.0, 3.0] {
            let axis = Vec3::new(0.36, 0.48, 0.8);
            let r = UnitQuaternion::exp(axis * angle).to_matrix();
            let k = Mat3::skew(axis);
            let expected = Mat3::IDENTITY + k * f64::sin(angle) + k * k * (1.0 - f64::cos(angle));
            for i in 0..3 {
                assert!((r.rows[i] - expected.rows[i]).max_abs() < 4e-16, "{angle}");
            }
        }
    }

    #[test]
    fn displacement_is_the_rotation_less_the_identity_and_grows_with_the_square() {
        let q = UnitQuaternion::exp(Vec3::new(0.7, -0.4, 0.2));
        let p = Vec3::new(1.0, -2.0, 0.5);
        assert!((p + q.to_displacement() * p - q.rotate(p)).max_abs() < 1e-15);
        let twice = q.scaled(2.0).to_displacement() * p;
        assert!((twice - 4.0 * (q.rotate(p) - p)).max_abs() < 1e-14);
    }

    #[test]
    fn rate_is_the_derivative_of_a_turn_about_own_axes() {
        let q = UnitQuaternion::exp(Vec3::new(0.7, -0.4, 0.2));
        let u = Vec3::new(3.0, 1.0, -2.0);
        let h = 1e-5;
        let at = |h: f64| (q * UnitQuaternion::exp(h * u)).wxyz();
        let (ahead, behind) = (at(h), at(-h));
        for (i, rate) in q.rate(u).into_iter().enumerate() {
            assert!((rate - (ahead[i] - behind[i]) / (2.0 * h)).abs() < 1e-9);
        }
    }

    #[test]
    fn log_inverts_exp() {
        // The series ends at an angle of 0.0632.
        for angle in [0.0, 1e-12, 1e-6, 1e-3, 0.0632, 0.0633, 0.5, 3.1] {
            let phi = Vec3::new(-0.6, 0.0, 0.8) * angle;
            let turn = UnitQuaternion::exp(phi);
            assert!((turn.log() - phi).max_abs() <= 4.0 * f64::EPSILON * (1.0 + angle) * angle);
            let opposite = UnitQuaternion { w: -turn.w, v: -turn.v };
            assert_eq!(opposite.log(), turn.log());
        }
    }

    #[test]
    fn product_rotates_in_turn() {
        let a = UnitQuaternion::exp(Vec3::new(0.3, -0.2, 0.9));
        let b = UnitQuaternion::exp(Vec3::new(-1.0, 0.4, 0.1));
        let p = Vec3::new(1.0, 2.0, 3.0);
        assert!(((a * b).rotate(p) - a.rotate(b.rotate(p))).max_abs() < 1e-15);
        assert!((a.to_matrix() * p - a.rotate(p)).max_abs() < 1e-15);
        assert!((a.conjugate().rotate(a.rotate(p)) - p).max_abs() < 1e-15);
    }
}
