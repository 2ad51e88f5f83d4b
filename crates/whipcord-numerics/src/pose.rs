use core::ops::{Add, Mul, Sub};

use crate::{UnitQuaternion, Vec3};

/// A frame: where its origin is and how its axes are turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Position of the origin.
    pub position: Vec3,
    /// Rotation from this frame to the frame it is given in.
    pub rotation: UnitQuaternion,
}

/// An element of se(3), in the body frame: strains times length, or a displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Translational part.
    pub linear: Vec3,
    /// Rotational part.
    pub angular: Vec3,
}

impl Pose {
    /// The frame itself.
    pub const IDENTITY: Self = Self { position: Vec3::ZERO, rotation: UnitQuaternion::IDENTITY };

    /// The frame reached by moving with a constant body twist for unit time: the exponential of
    /// SE(3).
    #[inline]
    #[must_use]
    pub fn exp(twist: Twist) -> Self {
        let Twist { linear, angular } = twist;
        let x = angular.norm_squared();
        // V = I + b φ̂ + c φ̂², b = (1 − cos φ)/φ², c = (φ − sin φ)/φ³.
        let (b, c) = if x < 0.25 { series_b_c(x) } else { closed_b_c(x) };
        let once = angular.cross(linear);
        let twice = angular.cross(once);
        Self { position: linear + b * once + c * twice, rotation: UnitQuaternion::exp(angular) }
    }

    /// The body twist with `exp(log(g)) = g` whose rotation is at most π.
    #[must_use]
    pub fn log(&self) -> Twist {
        let angular = self.rotation.log();
        let x = angular.norm_squared();
        // V⁻¹ = I − φ̂/2 + d φ̂², d = (1 − (φ/2) cot(φ/2))/φ².
        let d = if x < 0.25 {
            1.0 / 12.0
                + x * (1.0 / 720.0
                    + x * (1.0 / 30_240.0
                        + x * (1.0 / 1_209_600.0
                            + x * (1.0 / 47_900_160.0
                                + x * (691.0 / 1_307_674_368_000.0
                                    + x * (1.0 / 74_724_249_600.0))))))
        } else {
            let half = 0.5 * x.sqrt();
            (1.0 - half / half.tan()) / x
        };
        let once = angular.cross(self.position);
        let linear = self.position - 0.5 * once + d * angular.cross(once);
        Twist { linear, angular }
    }

    /// The point, given in this frame, in the frame this one is given in.
    #[inline]
    #[must_use]
    pub fn transform(&self, point: Vec3) -> Vec3 {
        self.position + self.rotation.rotate(point)
    }

    /// The inverse motion.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { position: -rotation.rotate(self.position), rotation }
    }
}

impl Mul for Pose {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self {
            position: self.transform(b.position),
            rotation: (self.rotation * b.rotation).renormalized(),
        }
    }
}

impl Twist {
    /// The Lie bracket of se(3).
    #[inline]
    #[must_use]
    pub fn bracket(self, b: Self) -> Self {
        Self {
            linear: self.angular.cross(b.linear) + self.linear.cross(b.angular),
            angular: self.angular.cross(b.angular),
        }
    }
}

impl Add for Twist {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self { linear: self.linear + b.linear, angular: self.angular + b.angular }
    }
}

impl Sub for Twist {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self { linear: self.linear - b.linear, angular: self.angular - b.angular }
    }
}

impl Mul<f64> for Twist {
    type Output = Self;
    #[inline]
    fn mul(self, a: f64) -> Self {
        Self { linear: self.linear * a, angular: self.angular * a }
    }
}

fn series_b_c(x: f64) -> (f64, f64) {
    let b = 0.5
        + x * (-1.0 / 24.0
            + x * (1.0 / 720.0
                + x * (-1.0 / 40_320.0
                    + x * (1.0 / 3_628_800.0
                        + x * (-1.0 / 479_001_600.0 + x * (1.0 / 87_178_291_200.0))))));
    let c = 1.0 / 6.0
        + x * (-1.0 / 120.0
            + x * (1.0 / 5040.0
                + x * (-1.0 / 362_880.0
                    + x * (1.0 / 39_916_800.0
                        + x * (-1.0 / 6_227_020_800.0 + x * (1.0 / 1_307_674_368_000.0))))));
    (b, c)
}

fn closed_b_c(x: f64) -> (f64, f64) {
    let phi = x.sqrt();
    let (sin, cos) = phi.sin_cos();
    ((1.0 - cos) / x, (phi - sin) / (x * phi))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_follows_a_circle() {
        // A body that moves along its z axis while it turns about y describes a circle of radius
        // 1/ω in the x–z plane.
        for turn in [0.1, 0.499, 0.501, 2.0] {
            let pose = Pose::exp(Twist { linear: Vec3::Z, angular: Vec3::Y * turn });
            let sagitta = 2.0 * f64::sin(0.5 * turn).powi(2);
            let expected = Vec3::new(sagitta / turn, 0.0, f64::sin(turn) / turn);
            assert!((pose.position - expected).max_abs() < 4e-16, "{turn}");
        }
    }

    #[test]
    fn log_undoes_exp() {
        for turn in [0.0, 1e-12, 0.1, 0.499, 0.501, 2.0, 3.1] {
            let axis = Vec3::new(2.0, -1.0, 2.0) / 3.0;
            let twist = Twist { linear: Vec3::new(0.3, -0.2, 1.1), angular: axis * turn };
            let back = Pose::exp(twist).log();
            assert!((back.linear - twist.linear).max_abs() < 4e-15, "{turn}: {back:?}");
            assert!((back.angular - twist.angular).max_abs() < 2e-15, "{turn}");
        }
    }

    #[test]
    fn inverse_undoes() {
        let pose = Pose::exp(Twist {
            linear: Vec3::new(1.0, 2.0, 3.0),
            angular: Vec3::new(0.4, -0.3, 0.2),
        });
        let identity = pose * pose.inverse();
        assert!(identity.position.max_abs() < 1e-15);
        assert!(identity.rotation.log().max_abs() < 1e-15);
    }

    #[test]
    fn series_and_closed_forms_meet() {
        let (b, c) = series_b_c(0.25);
        let (b2, c2) = closed_b_c(0.25);
        assert!((b - b2).abs() < 2e-16 && (c - c2).abs() < 2e-15);
    }
}
