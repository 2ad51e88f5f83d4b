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

use super::one_cable;

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
    /// Inverse of the stiffness.
    pub compliance: Stiffness,
    /// `u*` in 1/m.
    pub rest_curvature: Vec3,
    /// Whether x and y are alike.
    pub isotropic: bool,
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
pub(super) const FOLDED: f64 = 1e-4;
/// A Newton step this small, as a strain, leaves an error of its square.
const STEP_TOLERANCE: f64 = 2e-7;
const MAX_ITERATIONS: usize = 200;
/// Undamped steps that are tried before the potential is watched.
const UNDAMPED: usize = 5;

impl Section {
    /// A section of this stiffness, all of it positive.
    pub fn new(stiffness: Stiffness, rest_curvature: Vec3) -> Self {
        let Stiffness { shear, bending } = stiffness;
        let inverse = |k: Vec3| Vec3::new(1.0 / k.x, 1.0 / k.y, 1.0 / k.z);
        Self {
            stiffness,
            compliance: Stiffness { shear: inverse(shear), bending: inverse(bending) },
            rest_curvature,
            isotropic: shear.x == shear.y && bending.x == bending.y,
        }
    }

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
    /// The Hessian at a strain.
    #[inline]
    pub fn at(
        section: &Section,
        crossings: &[Crossing],
        tensions: &[f64],
        strain: &Strain,
    ) -> Result<Self, SectionFault> {
        let mut hessian = Hessian::of(section);
        for (crossing, &tension) in crossings.iter().zip(tensions) {
            if tension != 0.0 {
                let (pull, stretch) = crossing.pull(strain);
                hessian.add(crossing.offset, &pull, tension / stretch);
            }
        }
        hessian.factor().ok_or(SectionFault::Diverged)
    }

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
/// same cables.
#[inline]
pub(super) fn equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    if let ([crossing], [tension], true) = (crossings, tensions, section.isotropic) {
        *strain = one_cable::equilibrium(section, crossing, *tension, wrench)?.strain;
        return Ok(());
    }
    newton_equilibrium(section, crossings, tensions, wrench, strain)
}

/// [`equilibrium`] by Newton's method, for any number of cables and any stiffness.
pub(super) fn newton_equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    let reach = reach(crossings);
    for _ in 0..UNDAMPED {
        let Some(step) = newton_step(section, crossings, tensions, wrench, strain) else {
            break;
        };
        *strain = *strain + step;
        let size = step.linear.max_abs().max(reach * step.angular.max_abs());
        if size <= STEP_TOLERANCE {
            return Ok(());
        }
        if size.is_nan() || size > 1.0 {
            break;
        }
    }
    *strain = damped_equilibrium(section, crossings, tensions, wrench, reach)?;
    Ok(())
}

/// Distance at which a curvature counts as a strain.
#[inline]
fn reach(crossings: &[Crossing]) -> f64 {
    let widest = |widest: f64, c: &Crossing| widest.max(c.offset.norm_squared());
    crossings.iter().fold(1e-8, widest).sqrt()
}

/// The Newton step; `None` where the potential is not smooth.
#[inline]
fn newton_step(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &Strain,
) -> Option<Strain> {
    let Stiffness { shear, bending } = section.stiffness;
    let mut force = wrench.linear - shear.scale(strain.linear - Vec3::Z);
    let mut moment = wrench.angular - bending.scale(strain.angular - section.rest_curvature);
    let mut hessian = Hessian::of(section);
    for (crossing, &tension) in crossings.iter().zip(tensions) {
        if tension == 0.0 {
            continue;
        }
        let (pull, stretch) = crossing.pull(strain);
        force -= tension * pull.linear;
        moment -= tension * pull.angular;
        hessian.add(crossing.offset, &pull, tension / stretch);
    }
    Some(hessian.factor()?.solve(BodyWrench { linear: force, angular: moment }))
}

/// Blocks of the Hessian of the potential. `A` and `C` are symmetric: only their lower triangles
/// are kept up.
struct Hessian {
    a: Mat3,
    b: Mat3,
    c: Mat3,
}

impl Hessian {
    #[inline]
    fn of(section: &Section) -> Self {
        let Stiffness { shear, bending } = section.stiffness;
        Self { a: Mat3::diagonal(shear), b: Mat3::ZERO, c: Mat3::diagonal(bending) }
    }

    /// Adds a cable with `k = τ/‖p′‖`: `k (I − ttᵀ)`, `−k (r̂ + t mᵀ)` and
    /// `k (|r|² I − rrᵀ − mmᵀ)`, where `m = r × t`.
    #[inline]
    fn add(&mut self, r: Vec3, pull: &BodyWrench, k: f64) {
        let (t, m) = (pull.linear, pull.angular);
        let (kt, km, kr) = (k * t, k * m, k * r);
        let [a0, a1, a2] = &mut self.a.rows;
        a0.x += k - kt.x * t.x;
        a1.x -= kt.y * t.x;
        a1.y += k - kt.y * t.y;
        a2.x -= kt.z * t.x;
        a2.y -= kt.z * t.y;
        a2.z += k - kt.z * t.z;
        let [b0, b1, b2] = &mut self.b.rows;
        b0.x -= kt.x * m.x;
        b0.y -= kt.x * m.y;
        b0.z -= kr.y + kt.x * m.z;
        b1.x -= kt.y * m.x;
        b1.y -= kt.y * m.y;
        b1.z += kr.x - kt.y * m.z;
        b2.x += kr.y - kt.z * m.x;
        b2.y -= kr.x + kt.z * m.y;
        b2.z -= kt.z * m.z;
        let rr = kr.x * r.x + kr.y * r.y;
        let [c0, c1, c2] = &mut self.c.rows;
        c0.x += rr - kr.x * r.x - km.x * m.x;
        c1.x -= kr.y * r.x + km.y * m.x;
        c1.y += rr - kr.y * r.y - km.y * m.y;
        c2.x -= km.z * m.x;
        c2.y -= km.z * m.y;
        c2.z += rr - km.z * m.z;
    }

    /// `None` where it is not positive definite to working precision.
    #[inline]
    fn factor(&self) -> Option<Tangent> {
        let force = self.a.ldlt()?;
        let coupling = force.solve_matrix(&self.b);
        let (b0, b1, b2) = (self.b.column(0), self.b.column(1), self.b.column(2));
        let (w0, w1, w2) = (coupling.column(0), coupling.column(1), coupling.column(2));
        let [c0, c1, c2] = self.c.rows;
        let (s10, s20, s21) = (c1.x - b1.dot(w0), c2.x - b2.dot(w0), c2.y - b2.dot(w1));
        let reduced = Mat3::from_rows(
            Vec3::new(c0.x - b0.dot(w0), s10, s20),
            Vec3::new(s10, c1.y - b1.dot(w1), s21),
            Vec3::new(s20, s21, c2.z - b2.dot(w2)),
        );
        Some(Tangent { force, coupling, moment: reduced.ldlt()?, reduced })
    }
}

/// Newton's method with backtracking on the potential, from the section at rest: it converges
/// always, or finds that the section folds.
#[cold]
fn damped_equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    reach: f64,
) -> Result<Strain, SectionFault> {
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
        let Some(step) = newton_step(section, crossings, tensions, wrench, &x) else {
            break;
        };
        let size = step.linear.max_abs().max(reach * step.angular.max_abs());
        if size <= STEP_TOLERANCE {
            let folded = least_stretch(&x).filter(|(_, stretch)| *stretch < FOLDED);
            if let Some((cable, _)) = folded {
                return Err(SectionFault::Folded { cable });
            }
            return Ok(x + step);
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
        Section::new(
            Stiffness {
                shear: Vec3::new(3000.0, 3000.0, 8000.0),
                bending: Vec3::new(4.4e-3, 5.0e-3, 3.4e-3),
            },
            Vec3::new(1.0, -2.0, 0.5),
        )
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
        for tensions in [[4.0, 2.0, 1.0], [0.0, 60.0, 0.0], [40.0, 20.0, 10.0], [0.0; 3]] {
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
            equilibrium(&section(), &crossings(), &tensions, wrench + direction * h, &mut x)
                .unwrap();
            (x, Tangent::at(&section(), &crossings(), &tensions, &x).unwrap())
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
