//! The length of a cable in a section.

use whipcord_numerics::{Jet, Sym3, Vec3};

use super::bend::{Bend, Turn, share_of_chord};
use super::options::Chord;
use super::plane::Vec2;

/// A cable's straight run through one section: from its hole in the lower disk to that in the
/// upper one, or to where it is fastened between the two, each in the frame of its own cross-section.
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
    /// The fraction of the section that it passes: 1, but where it is fastened between the disks.
    pub part: f64,
}

impl Passage {
    pub fn new(cable: usize, length: f64, from: Vec2, to: Vec2, part: f64) -> Self {
        let (across, along) = (to - from, part * length);
        Self { cable, from, to, initial: (along * along + across.dot(across)).sqrt(), part }
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
        if self.part < 1.0 {
            return self.half_square_of_part(turn, length, chord);
        }
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

    /// The same to a place between the disks, eq. (17): a cross-section there stands as the upper disk of a
    /// section of its own does, whose chord is `r p` long beside its own and whose twist is `tψ`.
    fn half_square_of_part(&self, turn: &Turn, length: f64, chord: Chord) -> Jet {
        let (px, py) = (Jet::linear(turn.p.x, Vec3::X), Jet::linear(turn.p.y, Vec3::Y));
        let bend = px * px + py * py;
        let ratio = bend.compose(share_of_chord(turn.bend, self.part));
        let reach = bend.compose(chord.ratio(turn.bend)) * ratio * length;
        let (px, py) = (px * ratio, py * ratio);
        let twist = 2.0 * turn.half.1.atan2(turn.half.0);
        let twist = Jet::linear(self.part * twist, Vec3::Z * self.part);
        let (sin, cos) = twist.value.sin_cos();
        let (sin, cos) = (twist.compose([sin, cos, -sin]), twist.compose([cos, -sin, -cos]));
        let (x, y) = (cos * self.to.x + sin * -self.to.y, sin * self.to.x + cos * self.to.y);
        let apart = self.to.dot(self.to) + self.from.dot(self.from);
        let along = x * self.from.x + y * self.from.y;
        let upper = reach + (px * x + py * y) * -2.0;
        let lower = reach + (px * self.from.x + py * self.from.y) * -2.0;
        Jet::linear(0.5 * apart, Vec3::ZERO) + along * -1.0 + upper * lower * 0.5
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
        if self.part < 1.0 {
            let half = self.half_square_of_part(turn, length, chord);
            return (2.0 * half.value.max(0.0)).sqrt();
        }
        let a = self.to.turned(turn.full.0, turn.full.1);
        let reach = length * chord.ratio(turn.bend)[0];
        let across = a - self.from;
        let product = (reach - 2.0 * turn.p.dot(a)) * (reach - 2.0 * turn.p.dot(self.from));
        (across.dot(across) + product).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cable that ends between two disks is as long as the way to where the cross-section there has it, and
    /// its derivatives are those of that length.
    #[test]
    fn a_part_of_a_section_is_where_the_cross_section_is() {
        for chord in [Chord::Bisector, Chord::Arc] {
            for (part, p, twist) in [
                (0.3, Vec2::new(0.2, -0.4), 0.7),
                (0.85, Vec2::new(-0.5, 0.1), -1.2),
                (0.5, Vec2::new(0.01, 0.02), 0.3),
                (0.5, Vec2::new(0.0, 0.0), 0.0),
            ] {
                let (from, to) = (Vec2::new(0.008, 0.001), Vec2::new(0.003, 0.007));
                let passage = Passage::new(0, 0.02, from, to, part);
                let bend = Bend { p, twist };
                let length = |bend: Bend| {
                    let there = bend.pose_at(part, 0.02, chord);
                    (there.transform(to.with(0.0)) - from.with(0.0)).norm()
                };
                let found = passage.length(&bend.turn(), 0.02, chord);
                assert!((found.value - length(bend)).abs() < 1e-15);
                let h = 1e-4;
                for (k, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
                    let [after, before] = [h, -h].map(|h| bend.moved(axis * h));
                    let slope = (length(after) - length(before)) / (2.0 * h);
                    assert!((found.gradient[k] - slope).abs() < 1e-8, "{chord}: {found:?}");
                    let [after, before] =
                        [after, before].map(|b| passage.length(&b.turn(), 0.02, chord).gradient);
                    let row = found.hessian * axis;
                    assert!(
                        ((after - before) / (2.0 * h) - row).norm() < 1e-7,
                        "{chord}: {found:?}"
                    );
                }
            }
        }
    }
}
