//! What is minimised in a section.

use whipcord_numerics::{Jet, UnitQuaternion, Vec3, asin_ratio};

use super::bend::Turn;
use super::plane::Vec2;

/// How far a section is from its rest shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Measure {
    /// Eq. (4), the mean over these directions of holes in the upper disk.
    CouplerAngle(Vec<Vec2>),
    /// Eq. (5), with the weights of ω_x², ω_y² and ω_z².
    StrainEnergy([f64; 3]),
    /// [`Self::CouplerAngle`] of a section that stands so at rest, eq. (13).
    CouplerAngleFrom(Vec<Vec2>, UnitQuaternion),
    /// [`Self::StrainEnergy`] of a section with this rotation vector at rest, eq. (13).
    StrainEnergyFrom([f64; 3], Vec3),
}

impl Measure {
    /// The same from another shape at rest than the straight one.
    pub fn from(self, rest: UnitQuaternion) -> Self {
        match self {
            Self::CouplerAngle(directions) => Self::CouplerAngleFrom(directions, rest),
            Self::StrainEnergy(weights) => Self::StrainEnergyFrom(weights, rest.log()),
            curved => curved,
        }
    }

    /// Its value in rad² with derivatives.
    #[inline]
    pub fn at(&self, turn: &Turn) -> Jet {
        match self {
            Self::CouplerAngle(directions) => {
                let twist = turn.twist_share();
                let mut sum = Jet::default();
                for &e in directions {
                    // sin²(∠/2) = ‖v × e‖² is what v has along z and along the other direction.
                    let (across, along) = turn.bend_shares(e);
                    sum = sum + squared_angle(&(twist + across)) + squared_angle(&(twist + along));
                }
                mean(sum, directions)
            }
            Self::StrainEnergy([x, y, z]) => {
                // ω = 2 v asin‖v‖/‖v‖
                let twist = turn.twist_share();
                let (v_y, v_x) = turn.bend_shares(Vec2::X);
                let squared_sine = twist + v_x + v_y;
                let [a, da, dda] = asin_ratio(squared_sine.value.min(MOST));
                let factor = [4.0 * a * a, 8.0 * a * da, 8.0 * (da * da + a * dda)];
                squared_sine.compose(factor) * (v_x * *x + v_y * *y + twist * *z)
            }
            Self::CouplerAngleFrom(directions, rest) => {
                let [x, y, z] = since(rest, &turn.quaternion());
                let twist = z * z;
                let mut sum = Jet::default();
                for e in directions {
                    let (along, across) = (x * e.x + y * e.y, y * e.x + x * -e.y);
                    sum = sum
                        + squared_angle(&(twist + across * across))
                        + squared_angle(&(twist + along * along));
                }
                mean(sum, directions)
            }
            Self::StrainEnergyFrom(weights, rest) => {
                let [_, x, y, z] = turn.quaternion();
                let squared_sine = x * x + y * y + z * z;
                let [a, da, dda] = asin_ratio(squared_sine.value.min(MOST));
                let factor = squared_sine.compose([2.0 * a, 2.0 * da, 2.0 * dda]);
                let mut sum = Jet::default();
                for ((v, rest), weight) in [x, y, z].into_iter().zip(rest.to_array()).zip(weights) {
                    let change = factor * v + Jet::linear(-rest, Vec3::ZERO);
                    sum = sum + change * change * *weight;
                }
                sum
            }
        }
    }
}

fn mean(sum: Jet, directions: &[Vec2]) -> Jet {
    if directions.len() > 1 { sum * (1.0 / directions.len() as f64) } else { sum }
}

/// The vector part of `q*⁻¹ q`: by how much a section has turned since it was at rest.
fn since(rest: &UnitQuaternion, [w, x, y, z]: &[Jet; 4]) -> [Jet; 3] {
    let UnitQuaternion { w: c, v: r } = rest;
    [
        *x * *c + *w * -r.x + *z * -r.y + *y * r.z,
        *y * *c + *w * -r.y + *x * -r.z + *z * r.x,
        *z * *c + *w * -r.z + *y * -r.x + *x * r.y,
    ]
}

/// Keeps the derivatives finite at an angle of exactly 180°.
const MOST: f64 = 1.0 - 1e-12;

/// `∠²` from `x = sin²(∠/2)`: `h(x) = 4 asin²√x`, analytic at zero, where arccos is not.
#[inline]
fn squared_angle(x: &Jet) -> Jet {
    let t = x.value.min(MOST);
    let [a, da, _] = asin_ratio(t);
    let inverse = 1.0 / (1.0 - t);
    let root = inverse.sqrt();
    x.compose([4.0 * t * a * a, 4.0 * a * root, 4.0 * da * root + 2.0 * a * root * inverse])
}
