//! Where the upper disk of a section stands relative to the lower one.

use whipcord_numerics::{Pose, Sym3, UnitQuaternion, Vec3, asin_ratio};

use super::options::Chord;
use super::plane::{Jet, Vec2};

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
