//! The equilibrium of a section crossed by one cable, in closed form but for one scalar.
//!
//! Elimination of `v` and `u` from eqs. (1)–(3) of [`super::section`] leaves
//!
//! ```text
//! (λ I + τ C) t = w,   ‖t‖ = 1,   λ = ‖p′‖                                        (9)
//! w = e₃ + K_se⁻¹ N + (u* + K_bt⁻¹ M) × r + r′,   C = K_se⁻¹ + r̂ᵀ K_bt⁻¹ r̂
//! ```
//!
//! For a section that is equally stiff about x and y, `C` is diagonal in the axes along `r`, around
//! the backbone, and along it; λ is the positive root of `Σ wₖ²/(λ + τ cₖ)² = 1`.

use whipcord_numerics::Vec3;

use super::crossing::{BodyWrench, Crossing, Strain};
use super::fault::{FOLDED, SectionFault};
use super::properties::{Section, Stiffness};

/// The answer, with what a quadrature needs of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneCable {
    pub strain: Strain,
    /// `λ = ‖p′‖`.
    pub stretch: f64,
    /// `∂λ/∂τ` in 1/N, not positive.
    pub stretch_by_tension: f64,
}

/// Newton's method on `1/‖t‖` is all but linear; this many steps are never needed.
pub(crate) const MAX_ITERATIONS: usize = 30;

/// Where `‖t‖` is this close to 1, a last step of order 3 leaves an error of the order of its cube.
pub(crate) const MET: f64 = 1e-5;

/// Where `‖t‖²` is this close to 1, two terms of the series of its root leave less than rounding does.
pub(crate) const NEAR: f64 = 2.0 * MET;

/// Eq. (9) at one section: all of it that does not depend on the tension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reduced {
    /// `v` and `u` under the wrench alone.
    pub linear: Vec3,
    pub angular: Vec3,
    /// `r`, and the unit vector along it.
    pub offset: Vec3,
    pub radial: Vec3,
    /// `w` and the diagonal of `C` in the axes along `r`, around the backbone, and along it.
    pub w: Vec3,
    pub c: Vec3,
    /// `‖w‖` and its inverse, and mean and central moments of order 2 and 3 of `c` weighted by `w²`.
    pub size: f64,
    pub per_size: f64,
    pub mean: f64,
    pub spread: f64,
    pub skew: f64,
    /// Of the section.
    pub soft: Stiffness,
}

/// Solves eq. (9) for a section that is equally stiff about x and y ([`Section::isotropic`]).
#[inline(always)]
pub(crate) fn equilibrium(
    section: &Section,
    crossing: &Crossing,
    tension: f64,
    wrench: BodyWrench,
) -> Result<OneCable, SectionFault> {
    Reduced::of(section, crossing, wrench).solve(tension)
}

// Left to itself the compiler keeps these apart and passes `Reduced` through memory, which costs the
// sweep of an unloaded robot an eighth of its time.
impl Reduced {
    #[inline(always)]
    pub fn of(section: &Section, crossing: &Crossing, wrench: BodyWrench) -> Self {
        let soft = section.compliance;
        let Crossing { offset: r, slope, radial } = *crossing;
        let linear = Vec3::Z + soft.shear.scale(wrench.linear);
        let angular = section.rest_curvature + soft.bending.scale(wrench.angular);
        let free = linear + angular.cross(r) + slope;
        let radius_squared = r.x * r.x + r.y * r.y;
        let w = Vec3::new(
            free.x * radial.x + free.y * radial.y,
            free.y * radial.x - free.x * radial.y,
            free.z,
        );
        let c = Vec3::new(
            soft.shear.x,
            soft.shear.x + radius_squared * soft.bending.z,
            soft.shear.z + radius_squared * soft.bending.x,
        );
        // Raw moments first: they wait for nothing but `w`, and the sections of a shot for one another.
        let squares = w.scale(w);
        let c_squared = c.scale(c);
        let size_squared = squares.x + squares.y + squares.z;
        let (size, share) = (size_squared.sqrt(), 1.0 / size_squared);
        let mean = squares.dot(c) * share;
        let second = squares.dot(c_squared) * share;
        let third = squares.dot(c_squared.scale(c)) * share;
        let mean_squared = mean * mean;
        Self {
            linear,
            angular,
            offset: r,
            radial,
            w,
            c,
            size,
            per_size: size * share,
            mean,
            spread: second - mean_squared,
            skew: third - mean * (3.0 * second - 2.0 * mean_squared),
            soft,
        }
    }

    /// So many numbers it has.
    pub const NUMBERS: usize = 28;

    /// Its numbers in order.
    pub fn numbers(&self) -> [f64; Self::NUMBERS] {
        let Self {
            linear,
            angular,
            offset,
            radial,
            w,
            c,
            size,
            per_size,
            mean,
            spread,
            skew,
            soft,
        } = *self;
        let Stiffness { shear, bending } = soft;
        let ([px, py, pz], [qx, qy, qz]) = (linear.to_array(), angular.to_array());
        let ([rx, ry, rz], [wx, wy, wz]) = (offset.to_array(), w.to_array());
        let ([cx, cy, cz], [sx, sy, sz]) = (c.to_array(), shear.to_array());
        let [bx, by, bz] = bending.to_array();
        [
            px, py, pz, qx, qy, qz, rx, ry, rz, radial.x, radial.y, wx, wy, wz, cx, cy, cz, size,
            per_size, mean, spread, skew, sx, sy, sz, bx, by, bz,
        ]
    }

    /// From its numbers in order.
    pub fn of_numbers(numbers: [f64; Self::NUMBERS]) -> Self {
        let vector = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        Self {
            linear: vector(0),
            angular: vector(3),
            offset: vector(6),
            radial: Vec3::new(numbers[9], numbers[10], 0.0),
            w: vector(11),
            c: vector(14),
            size: numbers[17],
            per_size: numbers[18],
            mean: numbers[19],
            spread: numbers[20],
            skew: numbers[21],
            soft: Stiffness { shear: vector(22), bending: vector(25) },
        }
    }

    /// The strain under this tension in N. [`crate::statics::lanes::one_cable`] does the same to many at once.
    #[inline(always)]
    pub fn solve(&self, tension: f64) -> Result<OneCable, SectionFault> {
        let (t, inverse, stretch) = self.root(tension)?;
        // From the derivative of (9) along ‖t‖ = 1.
        let scaled = t.scale(inverse);
        let stretch_by_tension = -scaled.dot(t.scale(self.c)) / scaled.dot(t);
        let radial = self.radial;
        let pull = Vec3::new(t.x * radial.x - t.y * radial.y, t.x * radial.y + t.y * radial.x, t.z)
            * tension;
        let strain = Strain {
            linear: self.linear - self.soft.shear.scale(pull),
            angular: self.angular - self.soft.bending.scale(self.offset.cross(pull)),
        };
        Ok(OneCable { strain, stretch, stretch_by_tension })
    }

    /// `t`, `1/(λ + τ c)` and `λ`.
    #[inline(always)]
    fn root(&self, tension: f64) -> Result<(Vec3, Vec3, f64), SectionFault> {
        let Self { w, c, size, per_size, mean, spread, skew, .. } = *self;
        // To third order in τ.
        let relative = tension * per_size;
        let higher = tension * relative * (1.5 * spread - 2.0 * relative * skew);
        let mut stretch = (size - tension * mean + higher).max(FOLDED);
        for _ in 0..MAX_ITERATIONS {
            let inverse = Vec3::new(
                1.0 / (stretch + tension * c.x),
                1.0 / (stretch + tension * c.y),
                1.0 / (stretch + tension * c.z),
            );
            let t = w.scale(inverse);
            let squares = t.scale(t);
            let squared = squares.x + squares.y + squares.z;
            // The root is what all else would wait for.
            let excess = squared - 1.0;
            let error = match excess.abs() <= NEAR {
                true => excess * (0.5 - excess * 0.125),
                false => squared.sqrt() - 1.0,
            };
            if error < 0.0 && stretch <= FOLDED {
                return Err(SectionFault::Folded { cable: 0 });
            }
            // Moments of `1/(λ + τ c)` weighted by `t²`: the derivatives of `1/‖t‖`.
            let firsts = squares.scale(inverse);
            let first = firsts.x + firsts.y + firsts.z;
            let per_first = 1.0 / first;
            let change = squared * per_first * error;
            if error.abs() <= MET {
                let bend = firsts.dot(inverse) * per_first - first;
                let change = change + 1.5 * change * change * bend;
                // `1/(1 + x)` to third order.
                let factor = |x: f64| (1.0 - x) * (1.0 + x * x);
                let x = inverse * change;
                let factor = Vec3::new(factor(x.x), factor(x.y), factor(x.z));
                return Ok((t.scale(factor), inverse.scale(factor), stretch + change));
            }
            if change.is_nan() {
                return Err(SectionFault::Diverged);
            }
            // `1/‖t‖` is concave in λ: from right of the root the step may go too far left.
            stretch = (stretch + change).max(FOLDED);
        }
        Err(SectionFault::Diverged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::equilibrium::newton_equilibrium;

    #[test]
    fn agrees_with_newton_on_the_general_equations() {
        let give = Vec3::new(3000.0, 3000.0, 8000.0);
        let no_stretch = Vec3::new(3000.0, 3000.0, f64::INFINITY);
        let no_shear = Vec3::new(f64::INFINITY, f64::INFINITY, 8000.0);
        let rigid = Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let wrench =
            BodyWrench { linear: Vec3::new(0.3, -0.2, -1.0), angular: Vec3::new(0.02, 0.05, 0.01) };
        for shear in [give, no_stretch, no_shear, rigid] {
            let bending = Vec3::new(4.4e-3, 4.4e-3, 3.4e-3);
            let section = Section::new(Stiffness { shear, bending }, Vec3::new(1.0, -2.0, 0.5));
            assert!(section.isotropic);
            for offset in [Vec3::new(0.006, -0.005, 0.0), Vec3::new(-0.008, 0.0, 0.0), Vec3::ZERO] {
                for tension in [0.0, 0.1, 4.0, 40.0] {
                    let crossing = Crossing::new(offset, Vec3::new(0.1, 0.3, 0.0));
                    let one = equilibrium(&section, &crossing, tension, wrench).unwrap();
                    let mut general = section.rest_strain();
                    newton_equilibrium(&section, &[crossing], &[tension], wrench, &mut general)
                        .unwrap();
                    assert!((one.strain.linear - general.linear).norm() < 1e-14);
                    assert!((one.strain.angular - general.angular).norm() < 1e-12);
                    assert!((one.stretch - crossing.tangent(&general).norm()).abs() < 1e-14);
                    let h = 1e-4;
                    let more = equilibrium(&section, &crossing, tension + h, wrench).unwrap();
                    let slope = (more.stretch - one.stretch) / h;
                    assert!((slope - one.stretch_by_tension).abs() <= 1e-3 * slope.abs() + 1e-11);
                }
            }
        }
    }

    #[test]
    fn a_tension_that_uses_up_the_cable_folds() {
        let section = Section::new(
            Stiffness {
                shear: Vec3::new(3000.0, 3000.0, 8000.0),
                bending: Vec3::new(4.4e-3, 4.4e-3, 3.4e-3),
            },
            Vec3::ZERO,
        );
        let crossing = Crossing::new(Vec3::new(0.008, 0.0, 0.0), Vec3::ZERO);
        // 1 − τ (1/EA + r²/EI) = 0.
        let limit = 1.0 / (1.0 / 8000.0 + 0.008_f64.powi(2) / 4.4e-3);
        let at = |t| equilibrium(&section, &crossing, t, BodyWrench::default());
        assert!((at(0.99 * limit).unwrap().stretch - 0.01).abs() < 1e-12);
        assert_eq!(at(1.01 * limit).unwrap_err(), SectionFault::Folded { cable: 0 });
    }
}
