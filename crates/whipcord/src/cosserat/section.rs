//! The equilibrium of one cross-section (design of the total wrench).
//!
//! With `N` and `M` the force and moment that everything beyond a cut exerts on it, in the body
//! frame, the strains `v` (extension and shear) and `u` (curvature and twist) satisfy
//!
//! ```text
//! K_se (v − e₃) + Σ τᵢ tᵢ       = N          (1)
//! K_bt (u − u*) + Σ τᵢ rᵢ × tᵢ  = M          (2)
//! tᵢ = pᵢ′/‖pᵢ′‖,   pᵢ′ = v + u × rᵢ + rᵢ′   (3)
//! ```
//!
//! They are the stationarity conditions of the strictly convex potential
//! `½‖ξ − ξ*‖²_K + Σ τᵢ‖pᵢ′‖ − N·v − M·u`, so there is one answer, and Newton's method with the
//! exact Hessian — the block matrix of the paper's eq. (3) — finds it. All is written in 3×3 blocks.

use whipcord_numerics::{Ldlt3, Mat3, Twist, Vec3};

/// Diagonal section stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stiffness {
    /// `K_se`: GA, GA, EA in N.
    pub shear: Vec3,
    /// `K_bt`: EI_x, EI_y, GJ in N·m².
    pub bending: Vec3,
}

/// A cross-section of the rod at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Section {
    pub stiffness: Stiffness,
    /// `u*` in 1/m.
    pub rest_curvature: Vec3,
}

/// How a cable crosses a section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Crossing {
    /// `r` in m; its z component is zero.
    pub offset: Vec3,
    /// `r′`.
    pub slope: Vec3,
}

/// Strains as a twist per unit of arc length: `linear` is `v`, `angular` is `u`.
pub(super) type Strain = Twist;

/// Force and moment at a cut in the body frame: `linear` is `N`, `angular` is `M`.
pub(super) type BodyWrench = Twist;

/// Why a section has no equilibrium in the regular range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SectionFault {
    /// The stretch `‖p′‖` of this cable has gone to zero: the section has folded.
    Folded { cable: usize },
    /// The wrench is not finite, or beyond what Newton's method can resolve.
    Diverged,
}

/// The Hessian of the potential, factored: `[A B; Bᵀ C]` by its Schur complement `S = C − BᵀA⁻¹B`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tangent {
    force: Ldlt3,
    /// `A⁻¹B`.
    coupling: Mat3,
    moment: Ldlt3,
    /// `S`: the bending stiffness when forces are held.
    pub reduced: Mat3,
}

/// Below this stretch, from 1 at rest, a cable counts as folded.
const FOLDED: f64 = 1e-4;
/// A Newton step this small, as a strain, leaves an error of its square.
const STEP_TOLERANCE: f64 = 2e-7;
const MAX_ITERATIONS: usize = 60;
/// Undamped steps that are tried before the potential is watched.
const UNDAMPED: usize = 5;

impl Section {
    /// Strain of the section at rest.
    pub fn rest_strain(&self) -> Strain {
        Strain { linear: Vec3::Z, angular: self.rest_curvature }
    }
}

impl Crossing {
    /// `p′` of eq. (3).
    #[inline]
    pub fn tangent(&self, strain: &Strain) -> Vec3 {
        strain.linear + strain.angular.cross(self.offset) + self.slope
    }

    /// Unit tangent `t`, moment `r × t` and stretch `‖p′‖`: what a unit tension exerts.
    #[inline]
    pub fn pull(&self, strain: &Strain) -> (BodyWrench, f64) {
        let tangent = self.tangent(strain);
        let stretch = tangent.norm();
        let unit = tangent * (1.0 / stretch);
        (BodyWrench { linear: unit, angular: self.offset.cross(unit) }, stretch)
    }
}

impl Tangent {
    /// The change of strain under a change of wrench, `H⁻¹ w`.
    #[inline]
    pub fn solve(&self, wrench: BodyWrench) -> Strain {
        let angular =
            self.moment.solve(wrench.angular - self.coupling.transpose_mul(wrench.linear));
        Strain { linear: self.force.solve(wrench.linear) - self.coupling * angular, angular }
    }

    /// Blocks `∂v/∂N` (symmetric) and `∂v/∂u` at constant `N`, for the second variation.
    pub fn force_compliance(&self) -> (Mat3, Mat3) {
        (self.force.solve_matrix(&Mat3::IDENTITY), -self.coupling)
    }
}

/// Finds the strain of a section, starting from `strain`; `tensions` and `crossings` belong to the
/// same cables. Returns the Hessian at the last iterate, which is the exact one up to the last step.
#[inline]
pub(super) fn equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<Tangent, SectionFault> {
    let reach = reach(crossings);
    for _ in 0..UNDAMPED {
        let Some((step, tangent)) = newton_step(section, crossings, tensions, wrench, strain)
        else {
            break;
        };
        *strain = *strain + step;
        let size = step.linear.max_abs().max(reach * step.angular.max_abs());
        if size <= STEP_TOLERANCE {
            return Ok(tangent);
        }
        if size.is_nan() || size > 1.0 {
            break;
        }
    }
    damped_equilibrium(section, crossings, tensions, wrench, strain, reach)
}

/// Distance at which a curvature counts as a strain.
#[inline]
fn reach(crossings: &[Crossing]) -> f64 {
    let widest = |widest: f64, c: &Crossing| widest.max(c.offset.norm_squared());
    crossings.iter().fold(1e-8, widest).sqrt()
}

/// The Newton step and the Hessian it was made with; `None` where the potential is not smooth.
#[inline]
fn newton_step(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &Strain,
) -> Option<(Strain, Tangent)> {
    let Stiffness { shear, bending } = section.stiffness;
    let mut force = wrench.linear - shear.scale(strain.linear - Vec3::Z);
    let mut moment = wrench.angular - bending.scale(strain.angular - section.rest_curvature);
    let mut a = Mat3::diagonal(shear);
    let mut b = Mat3::ZERO;
    let mut c = Mat3::diagonal(bending);
    for (crossing, &tension) in crossings.iter().zip(tensions) {
        if tension == 0.0 {
            continue;
        }
        let (pull, stretch) = crossing.pull(strain);
        let (t, m, r) = (pull.linear, pull.angular, crossing.offset);
        force -= tension * t;
        moment -= tension * m;
        let k = tension / stretch;
        let (kt, km) = (k * t, k * m);
        // τ/‖p′‖ times I − ttᵀ, −(r̂ + t mᵀ) and |r|²I − rrᵀ − mmᵀ.
        a += Mat3::from_rows(
            Vec3::new(k - kt.x * t.x, -kt.x * t.y, -kt.x * t.z),
            Vec3::new(-kt.y * t.x, k - kt.y * t.y, -kt.y * t.z),
            Vec3::new(-kt.z * t.x, -kt.z * t.y, k - kt.z * t.z),
        );
        let kr = k * r;
        b += Mat3::from_rows(
            Vec3::new(-kt.x * m.x, -kt.x * m.y, -kr.y - kt.x * m.z),
            Vec3::new(-kt.y * m.x, -kt.y * m.y, kr.x - kt.y * m.z),
            Vec3::new(kr.y - kt.z * m.x, -kr.x - kt.z * m.y, -kt.z * m.z),
        );
        let rr = k * (r.x * r.x + r.y * r.y);
        c += Mat3::from_rows(
            Vec3::new(rr - kr.x * r.x - km.x * m.x, -kr.x * r.y - km.x * m.y, -km.x * m.z),
            Vec3::new(-kr.y * r.x - km.y * m.x, rr - kr.y * r.y - km.y * m.y, -km.y * m.z),
            Vec3::new(-km.z * m.x, -km.z * m.y, rr - km.z * m.z),
        );
    }
    let factors = a.ldlt()?;
    let coupling = factors.solve_matrix(&b);
    let reduced = c - b.transpose() * coupling;
    let tangent = Tangent { force: factors, coupling, moment: reduced.ldlt()?, reduced };
    let step = tangent.solve(BodyWrench { linear: force, angular: moment });
    Some((step, tangent))
}

/// Newton's method with backtracking on the potential, from wherever the fast loop ended: it
/// converges from anywhere, or finds that the section folds.
#[cold]
fn damped_equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
    reach: f64,
) -> Result<Tangent, SectionFault> {
    let potential = |x: &Strain| {
        let Stiffness { shear, bending } = section.stiffness;
        let (dv, du) = (x.linear - Vec3::Z, x.angular - section.rest_curvature);
        let elastic = 0.5 * (shear.scale(dv).dot(dv) + bending.scale(du).dot(du));
        let pulled: f64 =
            crossings.iter().zip(tensions).map(|(c, t)| t * c.tangent(x).norm()).sum();
        elastic + pulled - wrench.linear.dot(dv) - wrench.angular.dot(du)
    };
    let least_stretch = |x: &Strain| {
        crossings
            .iter()
            .zip(tensions)
            .enumerate()
            .filter(|(_, (_, tension))| **tension > 0.0)
            .map(|(i, (c, _))| (i, c.tangent(x).norm()))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let mut x = section.rest_strain();
    let mut value = potential(&x);
    if !value.is_finite() {
        return Err(SectionFault::Diverged);
    }
    for _ in 0..MAX_ITERATIONS {
        let Some((step, tangent)) = newton_step(section, crossings, tensions, wrench, &x) else {
            break;
        };
        let size = step.linear.max_abs().max(reach * step.angular.max_abs());
        if size <= STEP_TOLERANCE {
            let folded = least_stretch(&x).filter(|(_, stretch)| *stretch < FOLDED);
            if let Some((cable, _)) = folded {
                return Err(SectionFault::Folded { cable });
            }
            *strain = x + step;
            return Ok(tangent);
        }
        let mut fraction = 1.0;
        loop {
            let trial = x + step * fraction;
            let trial_value = potential(&trial);
            if trial_value < value {
                (x, value) = (trial, trial_value);
                break;
            }
            fraction *= 0.5;
            if fraction < 1e-12 {
                // The potential is flat to rounding here; the step decides below whether that is
                // the minimum.
                x = x + step * fraction;
                break;
            }
        }
    }
    match least_stretch(&x) {
        Some((cable, stretch)) if stretch < 0.05 => Err(SectionFault::Folded { cable }),
        _ => Err(SectionFault::Diverged),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section() -> Section {
        Section {
            stiffness: Stiffness {
                shear: Vec3::new(3000.0, 3000.0, 8000.0),
                bending: Vec3::new(4.4e-3, 5.0e-3, 3.4e-3),
            },
            rest_curvature: Vec3::new(1.0, -2.0, 0.5),
        }
    }

    fn crossings() -> [Crossing; 3] {
        [
            Crossing { offset: Vec3::new(0.008, 0.0, 0.0), slope: Vec3::new(0.0, 0.2, 0.0) },
            Crossing { offset: Vec3::new(-0.004, 0.006, 0.0), slope: Vec3::new(0.1, -0.1, 0.0) },
            Crossing { offset: Vec3::ZERO, slope: Vec3::ZERO },
        ]
    }

    fn residual(s: &Section, c: &[Crossing], tau: &[f64], w: BodyWrench, x: &Strain) -> f64 {
        let mut force = s.stiffness.shear.scale(x.linear - Vec3::Z) - w.linear;
        let mut moment = s.stiffness.bending.scale(x.angular - s.rest_curvature) - w.angular;
        for (c, &t) in c.iter().zip(tau) {
            let tangent = x.linear + x.angular.cross(c.offset) + c.slope;
            let pull = tangent * (t / tangent.norm());
            force += pull;
            moment += c.offset.cross(pull);
        }
        force.norm() + moment.norm()
    }

    #[test]
    fn meets_equations_1_and_2_from_a_far_start() {
        let wrench =
            BodyWrench { linear: Vec3::new(0.3, -0.2, -1.0), angular: Vec3::new(0.02, 0.05, 0.01) };
        for tensions in [[4.0, 2.0, 1.0], [0.0, 60.0, 0.0], [200.0, 50.0, 10.0], [0.0; 3]] {
            let mut x = section().rest_strain();
            equilibrium(&section(), &crossings(), &tensions, wrench, &mut x).unwrap();
            let left = residual(&section(), &crossings(), &tensions, wrench, &x);
            assert!(left < 1e-11 * (1.0 + tensions[0] + tensions[1]), "{tensions:?}: {left}");
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_strain() {
        let wrench =
            BodyWrench { linear: Vec3::new(0.3, -0.2, -1.0), angular: Vec3::new(0.02, 0.05, 0.01) };
        let direction =
            BodyWrench { linear: Vec3::new(1.0, 0.5, -0.7), angular: Vec3::new(0.01, -0.02, 0.03) };
        let tensions = [4.0, 2.0, 1.0];
        let solve = |h: f64| {
            let mut x = section().rest_strain();
            let tangent =
                equilibrium(&section(), &crossings(), &tensions, wrench + direction * h, &mut x)
                    .unwrap();
            (x, tangent)
        };
        let h = 1e-4;
        let difference = (solve(h).0 - solve(-h).0) * (0.5 / h);
        let exact = solve(0.0).1.solve(direction);
        assert!((difference.angular - exact.angular).norm() < 1e-7 * exact.angular.norm());
        assert!((difference.linear - exact.linear).norm() < 1e-7 * exact.linear.norm());
    }

    #[test]
    fn too_much_tension_folds() {
        let tensions = [1000.0, 0.0, 0.0];
        let mut x = section().rest_strain();
        let fault = equilibrium(&section(), &crossings(), &tensions, BodyWrench::default(), &mut x);
        assert_eq!(fault.unwrap_err(), SectionFault::Folded { cable: 0 });
    }
}
