//! What is minimised in a section.

use whipcord_numerics::asin_ratio;

use super::bend::Turn;
use super::plane::{Jet, Vec2};

/// How far a section is from its rest shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Measure {
    /// Eq. (4), the mean over these directions of holes in the upper disk.
    CouplerAngle(Vec<Vec2>),
    /// Eq. (5), with the weights of ω_x², ω_y² and ω_z².
    StrainEnergy([f64; 3]),
}

impl Measure {
    /// Its value in rad² with derivatives.
    #[inline]
    pub fn at(&self, turn: &Turn) -> Jet {
        let twist = turn.twist_share();
        match self {
            Self::CouplerAngle(directions) => {
                let mut sum = Jet::default();
                for &e in directions {
                    // sin²(∠/2) = ‖v × e‖² is what v has along z and along the other direction.
                    let (across, along) = turn.bend_shares(e);
                    sum = sum + squared_angle(&(twist + across)) + squared_angle(&(twist + along));
                }
                if directions.len() > 1 { sum * (1.0 / directions.len() as f64) } else { sum }
            }
            Self::StrainEnergy([x, y, z]) => {
                // ω = 2 v asin‖v‖/‖v‖
                let (v_y, v_x) = turn.bend_shares(Vec2::X);
                let squared_sine = twist + v_x + v_y;
                let [a, da, dda] = asin_ratio(squared_sine.value.min(MOST));
                let factor = [4.0 * a * a, 8.0 * a * da, 8.0 * (da * da + a * dda)];
                squared_sine.compose(factor) * (v_x * *x + v_y * *y + twist * *z)
            }
        }
    }
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
