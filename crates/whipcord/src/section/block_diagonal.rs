//! The Hessian of a section's potential by blocks, for sections that forces hardly strain.
//!
//! To the elastic stiffness `diag(K_se, K_bt)` a cable adds `W = k (I − ttᵀ)`, `−W r̂` and `r̂ᵀ W r̂` with `k = τ/‖p′‖`. Where `Σ k` is a small part `ε` of
//! `K_se`, the first two of these change a step of Newton's method by `ε` of it: with `diag(K_se, K_bt + Σ r̂ᵀ W r̂)` there is one 3×3 system to a step,
//! and what the step leaves is of first order in `ε`.

use whipcord_numerics::{Ldlt3, Sym3, Vec3};

use super::crossing::{BodyWrench, Crossing, Strain};
use super::properties::Section;

/// The greatest `ε` as a multiple of the tolerance, and the greatest of all: beyond it the whole Hessian leads there sooner.
const MOST_OF_TOLERANCE: f64 = 100.0;
const MOST: f64 = 0.01;

/// Diagonal blocks of the Hessian, factored.
pub(super) struct BlockDiagonal {
    /// Inverse of `K_se`.
    shear: Vec3,
    moment: Ldlt3,
    left: Left<f64>,
}

/// What a step leaves, about, as parts of it: in `v` of the whole step, in `u` of its part in `v` and of what it leaves there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Left<T> {
    /// `ε`.
    pub by_force: T,
    /// `Σ k` by the greatest compliance of bending and twist, at the reach of the cables.
    pub by_moment: T,
}

/// The greatest `ε` for a last step of this size.
#[inline(always)]
pub(crate) fn most_strain_by_force(tolerance: f64) -> f64 {
    (MOST_OF_TOLERANCE * tolerance).min(MOST)
}

impl BlockDiagonal {
    /// Whether these tensions hardly strain a section.
    #[inline(always)]
    pub fn applies(tolerance: f64, section: &Section, tensions: &[f64]) -> bool {
        let sum = tensions.iter().fold(0.0, |sum, tension| sum + tension);
        let strain = section.compliance.shear.max_abs() * sum;
        section.beside.is_none() && strain <= most_strain_by_force(tolerance)
    }

    /// With what is not borne at a strain.
    #[inline(always)]
    pub fn at(
        section: &Section,
        crossings: &[Crossing],
        tensions: &[f64],
        wrench: BodyWrench,
        reach: f64,
        strain: &Strain,
    ) -> Option<(Self, BodyWrench)> {
        let mut out = wrench - section.wrench(strain);
        let mut c = Sym3::diagonal(section.stiffness.bending);
        let mut sum = 0.0;
        for (crossing, &tension) in crossings.iter().zip(tensions) {
            if tension == 0.0 {
                continue;
            }
            let (unit, per_stretch) = crossing.direction(strain);
            let BodyWrench { linear: t, angular: n } = crossing.wrench(unit);
            out.linear -= t * tension;
            out.angular -= n * tension;
            // r̂ᵀ W r̂ = k (r̂ᵀr̂ − n nᵀ) with n = r × t.
            let k = tension * per_stretch;
            sum += k;
            let r = crossing.offset;
            let (kx, ky, kn) = (k * r.x, k * r.y, n * k);
            let (xx, yy) = (kx * r.x, ky * r.y);
            c.xx += yy - kn.x * n.x;
            c.yx -= kx * r.y + kn.y * n.x;
            c.yy += xx - kn.y * n.y;
            c.zx -= kn.z * n.x;
            c.zy -= kn.z * n.y;
            c.zz += (xx + yy) - kn.z * n.z;
        }
        let (shear, bending) = (section.compliance.shear, section.compliance.bending);
        let left = Left {
            by_force: shear.max_abs() * sum,
            by_moment: bending.max_abs() * reach * reach * sum,
        };
        Some((Self { shear, moment: c.ldlt()?, left }, out))
    }

    /// The step of Newton's method.
    #[inline(always)]
    pub fn solve(&self, out: BodyWrench) -> Strain {
        Strain { linear: self.shear.scale(out.linear), angular: self.moment.solve(out.angular) }
    }

    /// Whether what a step leaves, as a strain, is the square of the tolerance at most, beside what any step of Newton's method leaves.
    #[inline(always)]
    pub fn leaves_square(&self, tolerance: f64, step: &Strain, size: f64) -> bool {
        let Left { by_force, by_moment } = self.left;
        let in_force = by_force * size;
        let left = in_force.max(by_moment * (step.linear.max_abs() + in_force));
        left <= tolerance * tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::{Stiffness, equilibrium, equilibrium_within, reach};

    /// A thin rod with two cables far from it, which are slanted.
    fn thin() -> (Section, [Crossing; 2], [f64; 2]) {
        let (young, radius) = (60e9, 0.5e-3_f64);
        let (area, inertia) =
            (core::f64::consts::PI * radius.powi(2), core::f64::consts::PI * radius.powi(4) / 4.0);
        let shear = young / 2.6;
        let stiffness = Stiffness {
            shear: Vec3::new(0.9 * shear * area, 0.9 * shear * area, young * area),
            bending: Vec3::new(young * inertia, young * inertia, 2.0 * shear * inertia),
        };
        let (sin, cos) = 1.0_f64.sin_cos();
        let crossings = [
            Crossing::new(Vec3::new(0.01, 0.0, 0.0), Vec3::new(0.5, 0.0, 0.0)),
            Crossing::new(Vec3::new(0.01 * cos, 0.01 * sin, 0.0), Vec3::new(0.0, 0.5, 0.0)),
        ];
        (Section::new(stiffness, Vec3::ZERO), crossings, [1.615, 0.692])
    }

    /// From starts that are off in bending alone, extension and shear follow one step behind.
    #[test]
    fn steps_leave_no_more_than_the_square_of_the_tolerance() {
        let (section, crossings, tensions) = thin();
        let none = BodyWrench::default();
        let mut exact = section.rest_strain();
        equilibrium(&section, &crossings, &tensions, none, &mut exact).unwrap();
        // The last step of the whole Hessian leaves less than rounding.
        equilibrium(&section, &crossings, &tensions, none, &mut exact).unwrap();
        let reach = reach(&crossings);
        let size = |off: Strain| off.linear.max_abs().max(reach * off.angular.max_abs());
        for tolerance in [1.42e-6, 5e-6, 3.2e-5] {
            assert!(BlockDiagonal::applies(tolerance, &section, &tensions));
            for k in 0..200 {
                let (sin, cos) = (0.7 * f64::from(k)).sin_cos();
                let off = 10.0_f64.powf(-5.5 + 0.01 * f64::from(k)) / reach;
                let angular = Vec3::new(off * cos, off * sin, 0.3 * off * (cos - sin));
                let mut strain = Strain { angular: exact.angular + angular, ..exact };
                let cables = (&crossings[..], &[][..]);
                equilibrium_within(tolerance, &section, cables, &tensions, none, &mut strain)
                    .unwrap();
                let left = size(strain - exact);
                let square = tolerance * tolerance;
                assert!(left <= 2.0 * square, "{tolerance}, {k}: {}", left / square);
            }
        }
    }
}
