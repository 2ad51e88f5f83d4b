//! Where the upper disk of a section stands relative to the lower one.

use whipcord_numerics::{Jet, Pose, Sym3, Twist, UnitQuaternion, Vec3, asin_ratio};

use super::options::Chord;
use super::plane::Vec2;

/// The three coordinates of a section (`docs/theory/four-bar.md`, eq. (1)): the chord of the
/// backbone has the direction (p, √(1−‖p‖²)), and ψ is the twist.
///
/// They are another chart of the rotation than the rotation vector ω: the bend between the two
/// tangents is φ = 2 asin ‖p‖, and every rotation with φ < 180° has one p. The constraint on a
/// cable's length is a polynomial in p, so Newton's method has little left to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bend {
    pub p: Vec2,
    pub twist: f64,
}

/// A bend with the functions of it that everything else is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub p: Vec2,
    /// `‖p‖² = sin²(φ/2)`.
    pub bend: f64,
    /// Cosine and sine of half the twist.
    pub half: (f64, f64),
    /// Cosine and sine of the twist.
    pub full: (f64, f64),
}

impl Bend {
    pub const STRAIGHT: Self = Self { p: Vec2::new(0.0, 0.0), twist: 0.0 };

    /// The bend with this rotation; `None` where it turns the normal right over, which no bend does.
    pub fn of(rotation: UnitQuaternion) -> Option<Self> {
        const LEAST: f64 = 1e-3;
        let UnitQuaternion { w, v } = rotation;
        // Of the two quaternions of a rotation the one with the lesser angle.
        let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
        let half = v.z.atan2(w);
        let (sin, cos) = half.sin_cos();
        let p = Vec2::new(v.x * sin + v.y * cos, v.y * sin - v.x * cos);
        (w.hypot(v.z) > LEAST).then_some(Self { p, twist: 2.0 * half })
    }

    /// The bend with these coordinates added.
    #[inline]
    pub fn moved(self, step: Vec3) -> Self {
        Self { p: self.p + Vec2::new(step.x, step.y), twist: self.twist + step.z }
    }

    /// Whether the coordinates describe a pose: less than half a turn of bend and of twist.
    #[inline]
    pub fn is_valid(self) -> bool {
        self.p.dot(self.p) < 1.0 && self.twist.abs() < core::f64::consts::PI
    }

    #[inline]
    pub fn turn(self) -> Turn {
        let (sin, cos) = sin_cos(0.5 * self.twist);
        Turn {
            p: self.p,
            bend: self.p.dot(self.p),
            half: (cos, sin),
            full: (1.0 - 2.0 * sin * sin, 2.0 * sin * cos),
        }
    }

    /// Pose of the upper disk in the frame of the lower one, eqs. (1) and (2).
    #[inline]
    pub fn pose(self, length: f64, chord: Chord) -> Pose {
        let turn = self.turn();
        let up = (1.0 - turn.bend).sqrt();
        Pose {
            position: self.p.with(up) * (length * chord.ratio(turn.bend)[0]),
            rotation: turn.rotation(up),
        }
    }

    /// Pose of the cross-section at the fraction `t` of a section: on the circular arc that
    /// touches the normals of both disks, with the twist growing uniformly.
    pub fn pose_at(self, t: f64, length: f64, chord: Chord) -> Pose {
        let sine = self.p.norm();
        let reach = length * chord.ratio(sine * sine)[0];
        // Half the bend up to t; with sin(tφ/2)/sin(φ/2) → t where the section is straight.
        let half = t * sine.min(1.0).asin();
        let ratio = if sine < 1e-150 { t } else { half.sin() / sine };
        let part = Self { p: self.p * ratio, twist: t * self.twist };
        let up = half.cos();
        Pose { position: part.p.with(up) * (reach * ratio), rotation: part.turn().rotation(up) }
    }

    /// How the cross-section at the fraction `t` of a section moves with each coordinate, in the frame of the
    /// lower disk: velocity of its centre and angular velocity. Eq. (12).
    pub fn motion_at(self, t: f64, length: f64, chord: Chord) -> [Twist; 3] {
        let turn = self.turn();
        let y = turn.bend;
        let [ratio, slope, _] = chord.ratio(y);
        let (reach, reach_y) = (length * ratio, length * slope);
        // `r = sin(tφ/2)/sin(φ/2)` and `c = cos(tφ/2)` with their derivatives by y = sin²(φ/2).
        let (r, r_y, c, c_y) = part_of_bend(y, t);
        let (sin, cos) = sin_cos(0.5 * t * self.twist);
        let p = self.p * r;
        let w = c * cos;
        let v = Vec3::new(p.x * sin - p.y * cos, p.x * cos + p.y * sin, c * sin);
        // `ω = 2 vec(q̇ q*)`
        let spin = |w_rate: f64, v_rate: Vec3| (v_rate * w - v * w_rate - v_rate.cross(v)) * 2.0;
        let by_p = |along: Vec2, y_rate: f64| {
            let p_rate = along * r + self.p * (r_y * y_rate);
            let c_rate = c_y * y_rate;
            let v_rate = Vec3::new(
                p_rate.x * sin - p_rate.y * cos,
                p_rate.x * cos + p_rate.y * sin,
                c_rate * sin,
            );
            let arm_rate = (reach_y * r + reach * r_y) * y_rate;
            Twist {
                linear: p.with(c) * arm_rate + p_rate.with(c_rate) * (reach * r),
                angular: spin(c_rate * cos, v_rate),
            }
        };
        let v_by_twist =
            Vec3::new(p.x * cos + p.y * sin, p.y * cos - p.x * sin, c * cos) * (0.5 * t);
        let by_twist = Twist { linear: Vec3::ZERO, angular: spin(-0.5 * t * c * sin, v_by_twist) };
        let Vec2 { x, y } = self.p;
        [by_p(Vec2::X, 2.0 * x), by_p(Vec2::X.quarter(), 2.0 * y), by_twist]
    }
}

/// `r = sin(tφ/2)/sin(φ/2)` and `c = cos(tφ/2)`, each with its derivative by `y = sin²(φ/2)`.
fn part_of_bend(y: f64, t: f64) -> (f64, f64, f64, f64) {
    let up = (1.0 - y).sqrt();
    let (r, r_y, c) = if y < 1e-3 {
        // The series of sin(t asin x)/x in x², which the quotients below lose.
        let t2 = t * t;
        let (a, b) = (t * (1.0 - t2), 9.0 - t2);
        let d = b * (25.0 - t2);
        let e = d * (49.0 - t2);
        let r = t + a * y * (1.0 / 6.0 + y * (b / 120.0 + y * (d / 5040.0 + y * e / 362_880.0)));
        let r_y = a * (1.0 / 6.0 + y * (b / 60.0 + y * (d / 1680.0 + y * e / 90_720.0)));
        (r, r_y, (1.0 - y * r * r).sqrt())
    } else {
        let sine = y.sqrt();
        let (sin, c) = (t * sine.min(1.0).asin()).sin_cos();
        let r = sin / sine;
        (r, (t * c / up - r) / (2.0 * y), c)
    };
    (r, r_y, c, -0.5 * r * t / up)
}

/// `r = sin(tφ/2)/sin(φ/2)`, the chord up to the fraction t of a section beside the whole, with its first two
/// derivatives by `y = sin²(φ/2)`.
pub(super) fn share_of_chord(y: f64, t: f64) -> [f64; 3] {
    let (r, r_y, c, c_y) = part_of_bend(y, t);
    let r_yy = if y < 1e-3 {
        let t2 = t * t;
        let (a, b) = (t * (1.0 - t2), 9.0 - t2);
        let d = b * (25.0 - t2);
        let e = d * (49.0 - t2);
        a * (b / 60.0 + y * (d / 840.0 + y * e / 30_240.0))
    } else {
        let rest = 1.0 - y;
        (t * (c_y + 0.5 * c / rest) / rest.sqrt() - 3.0 * r_y) / (2.0 * y)
    };
    [r, r_y, r_yy]
}

impl Turn {
    /// The rotation R of the upper disk, as the unit quaternion of eq. (1).
    #[inline]
    fn rotation(&self, up: f64) -> UnitQuaternion {
        let (cos, sin) = self.half;
        let Vec2 { x, y } = self.p;
        let v = Vec3::new(x * sin - y * cos, x * cos + y * sin, up * sin);
        UnitQuaternion { w: up * cos, v }.renormalized()
    }

    /// The unit quaternion of eq. (1): `w`, then `v`.
    pub fn quaternion(&self) -> [Jet; 4] {
        let (cos, sin) = self.half;
        let (px, py) = (Jet::linear(self.p.x, Vec3::X), Jet::linear(self.p.y, Vec3::Y));
        let half = |value: f64, slope: f64| Jet {
            value,
            gradient: Vec3::Z * (0.5 * slope),
            hessian: Sym3 { zz: -0.25 * value, ..Sym3::default() },
        };
        let (cos, sin) = (half(cos, -sin), half(sin, cos));
        let rest = (px * px + py * py) * -1.0 + Jet::linear(1.0, Vec3::ZERO);
        let root = (1.0 - self.bend).sqrt();
        let up = rest.compose([root, 0.5 / root, -0.25 / (root * root * root)]);
        [up * cos, px * sin + py * cos * -1.0, px * cos + py * sin, up * sin]
    }

    /// `ζ = v_z² = (1 − ‖p‖²) sin²(ψ/2)`, the share of the twist in the quaternion (w, v).
    #[inline]
    pub fn twist_share(&self) -> Jet {
        let (_, sin) = self.half;
        let (cos2, sin2) = self.full;
        let (share, rest) = (sin * sin, 1.0 - self.bend);
        Jet {
            value: rest * share,
            gradient: (self.p * (-2.0 * share)).with(0.5 * rest * sin2),
            hessian: Sym3 {
                xx: -2.0 * share,
                yx: 0.0,
                yy: -2.0 * share,
                zx: -sin2 * self.p.x,
                zy: -sin2 * self.p.y,
                zz: 0.5 * rest * cos2,
            },
        }
    }

    /// `(v·e⊥)²` and `(v·e)²` for a unit vector e in the plane of the disk, e⊥ being e turned by a
    /// quarter: the shares of the bend in the quaternion (w, v). With m = e turned by ψ/2 they
    /// are (p·m)² and (p·m⊥)².
    #[inline]
    pub fn bend_shares(&self, e: Vec2) -> (Jet, Jet) {
        let m = e.turned(self.half.0, self.half.1);
        let n = m.quarter();
        let (a, b) = (self.p.dot(m), self.p.dot(n));
        // ∂m/∂ψ = n/2 and ∂n/∂ψ = −m/2.
        let mixed = m * b + n * a;
        let first = Jet {
            value: a * a,
            gradient: (m * (2.0 * a)).with(a * b),
            hessian: Sym3 {
                xx: 2.0 * m.x * m.x,
                yx: 2.0 * m.y * m.x,
                yy: 2.0 * m.y * m.y,
                zx: mixed.x,
                zy: mixed.y,
                zz: 0.5 * (b * b - a * a),
            },
        };
        let second = Jet {
            value: b * b,
            gradient: (n * (2.0 * b)).with(-a * b),
            hessian: Sym3 {
                xx: 2.0 * n.x * n.x,
                yx: 2.0 * n.y * n.x,
                yy: 2.0 * n.y * n.y,
                zx: -mixed.x,
                zy: -mixed.y,
                zz: 0.5 * (a * a - b * b),
            },
        };
        (first, second)
    }
}

impl Chord {
    /// Length of the chord over that of the backbone, and its first two derivatives, as a function
    /// of ‖p‖² = sin²(φ/2): 1, or sin(φ/2)/(φ/2) (eq. (2)).
    #[inline]
    pub(super) fn ratio(self, bend: f64) -> [f64; 3] {
        match self {
            Self::Bisector => [1.0, 0.0, 0.0],
            Self::Arc => {
                let [a, da, dda] = asin_ratio(bend);
                let k = 1.0 / a;
                [k, -da * k * k, (2.0 * da * da * k - dda) * k * k]
            }
        }
    }
}

/// Sine and cosine, by their series where the angle is as small as the twist of a section is.
#[inline]
fn sin_cos(x: f64) -> (f64, f64) {
    let y = x * x;
    if y < 0.04 {
        let sin = 1.0
            + y * (-1.0 / 6.0
                + y * (1.0 / 120.0
                    + y * (-1.0 / 5040.0 + y * (1.0 / 362_880.0 - y / 39_916_800.0))));
        let cos = 1.0
            + y * (-0.5
                + y * (1.0 / 24.0
                    + y * (-1.0 / 720.0
                        + y * (1.0 / 40_320.0 + y * (-1.0 / 3_628_800.0 + y / 479_001_600.0)))));
        (x * sin, cos)
    } else {
        x.sin_cos()
    }
}
