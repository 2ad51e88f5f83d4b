//! The length of a cable in a section.

use whipcord_numerics::{Sym3, Vec3};

use super::bend::{Bend, Turn};
use super::options::Chord;
use super::plane::{Jet, Vec2};

/// A cable's straight run through one section: from its hole in the lower disk to that in the
/// upper one, each in the frame of its own disk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Which cable of the robot.
    pub cable: usize,
    /// `a₀ e(θ₀)`.
    pub from: Vec2,
    /// `a₁ e(θ₁)`.
    pub to: Vec2,
    /// Length before actuation, `√(l₀² + ‖a₁e(θ₁) − a₀e(θ₀)‖²)` where the section is straight.
    pub initial: f64,
}

impl Passage {
    pub fn new(cable: usize, length: f64, from: Vec2, to: Vec2) -> Self {
        let across = to - from;
        Self { cable, from, to, initial: (length * length + across.dot(across)).sqrt() }
    }

    /// The same in a section that stands so at rest.
    pub fn at_rest(self, rest: Bend, length: f64, chord: Chord) -> Self {
        if rest == Bend::STRAIGHT {
            return self;
        }
        Self { initial: self.length_only(&rest.turn(), length, chord), ..self }
    }

    /// Half the squared length, eq. (3), of a section whose backbone has this length:
    /// `½‖ã − a₀‖² + ½(κl₀ − 2p·ã)(κl₀ − 2p·a₀)`, where ã is the upper hole turned by the twist.
    #[inline]
    pub fn half_square(&self, turn: &Turn, length: f64, chord: Chord) -> Jet {
        let a = self.to.turned(turn.full.0, turn.full.1);
        let a_turned = a.quarter(); // ∂ã/∂ψ
        let p = turn.p;
        let [ratio, slope, bend] = chord.ratio(turn.bend);
        let reach = length * ratio;
        // κ depends on ‖p‖², so κ_p = 2κ′p and κ_pp = 2κ′I + 4κ″ppᵀ.
        let (first, second) = (2.0 * length * slope, 4.0 * length * bend);
        let upper = reach - 2.0 * p.dot(a);
        let lower = reach - 2.0 * p.dot(self.from);
        let upper_p = p * first - a * 2.0;
        let lower_p = p * first - self.from * 2.0;
        let upper_twist = -2.0 * p.dot(a_turned);
        let along = self.from.dot(a);
        let across = a - self.from;
        let sum = upper + lower;
        let mixed = lower_p * (0.5 * upper_twist) - a_turned * lower;
        let diagonal = 0.5 * sum * first;
        let shear = 0.5 * sum * second;
        Jet {
            value: 0.5 * (across.dot(across) + upper * lower),
            gradient: ((upper_p * lower + lower_p * upper) * 0.5)
                .with(0.5 * upper_twist * lower - self.from.dot(a_turned)),
            hessian: Sym3 {
                xx: upper_p.x * lower_p.x + diagonal + shear * p.x * p.x,
                yx: 0.5 * (upper_p.x * lower_p.y + upper_p.y * lower_p.x) + shear * p.x * p.y,
                yy: upper_p.y * lower_p.y + diagonal + shear * p.y * p.y,
                zx: mixed.x,
                zy: mixed.y,
                zz: along + p.dot(a) * lower,
            },
        }
    }

    /// The length itself; its derivatives are zero where the length is.
    #[inline]
    pub fn length(&self, turn: &Turn, length: f64, chord: Chord) -> Jet {
        let half = self.half_square(turn, length, chord);
        let value = (2.0 * half.value.max(0.0)).sqrt();
        if value == 0.0 {
            return Jet::default();
        }
        let inverse = 1.0 / value;
        let gradient: Vec3 = half.gradient * inverse;
        let hessian = (half.hessian + Sym3::square(gradient) * -1.0) * inverse;
        Jet { value, gradient, hessian }
    }

    /// The length without derivatives.
    #[inline]
    pub fn length_only(&self, turn: &Turn, length: f64, chord: Chord) -> f64 {
        let a = self.to.turned(turn.full.0, turn.full.1);
        let reach = length * chord.ratio(turn.bend)[0];
        let across = a - self.from;
        let product = (reach - 2.0 * turn.p.dot(a)) * (reach - 2.0 * turn.p.dot(self.from));
        (across.dot(across) + product).max(0.0).sqrt()
    }
}
