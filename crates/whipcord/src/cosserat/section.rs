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
//!
//! `K` is diagonal, or has terms beside its diagonal ([`Coupling`]). An axis of `v` may be *held*: the
//! rod does not stretch, or does not shear. Its compliance is zero, its strain stays what it is at
//! rest, and its equation in (1) only says what the reaction is. In the Hessian it has an infinite
//! pivot, whose inverse is the zero that is wanted.

use whipcord_numerics::{Ldlt3, Mat3, Twist, Vec3};

use super::one_cable;

/// Diagonal of a section's stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stiffness {
    /// Of `K_se`: GA, GA, EA in N.
    pub shear: Vec3,
    /// Of `K_bt`: EI_x, EI_y, GJ in N·m².
    pub bending: Vec3,
}

/// A section's stiffness beside its diagonal; the diagonals of the symmetric blocks are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coupling {
    /// Between shears and extension, in N.
    pub shear: Mat3,
    /// Forces by curvature and twist, in N·m; moments by shear and extension are its transpose.
    pub mixed: Mat3,
    /// Between bendings and twist, in N·m².
    pub bending: Mat3,
}

/// A cross-section of the rod at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Section {
    /// Diagonal of the stiffness; zero on an axis that is held, whose reaction is no elastic force.
    pub stiffness: Stiffness,
    /// Inverse of that diagonal; zero on an axis that is held.
    pub compliance: Stiffness,
    /// `u*` in 1/m.
    pub rest_curvature: Vec3,
    /// Whether x and y are alike and nothing is coupled.
    pub isotropic: bool,
    /// Where the stiffness is not diagonal. Apart from the rest, so that a section stays small.
    pub coupling: Option<Box<Coupling>>,
}

/// How a cable crosses a section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Crossing {
    /// `r` in m; its z component is zero.
    pub offset: Vec3,
    /// `r′`.
    pub slope: Vec3,
}

/// Strains as a twist per unit of arc length: `linear` is `v`, `angular` is `u`.
pub(crate) type Strain = Twist;

/// Force and moment at a cut in the body frame: `linear` is `N`, `angular` is `M`.
pub(crate) type BodyWrench = Twist;

/// Why a section has no equilibrium in the regular range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SectionFault {
    /// The stretch `‖p′‖` of this cable has gone to zero: the section has folded.
    Folded { cable: usize },
    /// The wrench is not finite, or beyond what Newton's method can resolve.
    Diverged,
}

/// The Hessian of the potential, factored: `[A B; Bᵀ C]` by its Schur complement `S = C − BᵀA⁻¹B`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tangent {
    force: Ldlt3,
    /// `A⁻¹B`.
    coupling: Mat3,
    moment: Ldlt3,
    /// `S`: the bending stiffness when forces are held.
    pub reduced: Mat3,
}

/// Below this stretch, from 1 at rest, a cable counts as folded.
pub(crate) const FOLDED: f64 = 1e-4;
/// A Newton step this small, as a strain, leaves an error of its square.
const STEP_TOLERANCE: f64 = 2e-7;
const MAX_ITERATIONS: usize = 200;
/// Undamped steps that are tried before the potential is watched.
const UNDAMPED: usize = 5;

impl Section {
    /// A section of this stiffness, all of it positive; an infinite one of `K_se` holds its axis.
    pub fn new(stiffness: Stiffness, rest_curvature: Vec3) -> Self {
        let Stiffness { shear, bending } = stiffness;
        let inverse = |k: Vec3| Vec3::new(1.0 / k.x, 1.0 / k.y, 1.0 / k.z);
        let elastic = |k: f64| if k.is_finite() { k } else { 0.0 };
        let spring = Vec3::new(elastic(shear.x), elastic(shear.y), elastic(shear.z));
        Self {
            stiffness: Stiffness { shear: spring, bending },
            compliance: Stiffness { shear: inverse(shear), bending: inverse(bending) },
            rest_curvature,
            isotropic: shear.x == shear.y && bending.x == bending.y,
            coupling: None,
        }
    }

    /// The same with stiffness beside the diagonal; what it has on a held axis is of no effect.
    pub fn coupled(self, coupling: Coupling) -> Self {
        let Coupling { mut shear, mut mixed, bending } = coupling;
        for i in (0..3).filter(|&i| self.compliance.shear[i] == 0.0) {
            mixed.rows[i] = Vec3::ZERO;
            shear.rows[i] = Vec3::ZERO;
            for row in &mut shear.rows {
                row[i] = 0.0;
            }
        }
        let coupling = Coupling { shear, mixed, bending };
        if coupling == Coupling::default() {
            return self;
        }
        Self { isotropic: false, coupling: Some(Box::new(coupling)), ..self }
    }

    /// What the strain exerts, `K (ξ − ξ*)`: nothing on a held axis.
    #[inline]
    pub fn elastic_wrench(&self, strain: &Strain) -> BodyWrench {
        let (dv, du) = (strain.linear - Vec3::Z, strain.angular - self.rest_curvature);
        let Stiffness { shear, bending } = self.stiffness;
        let mut wrench = BodyWrench { linear: shear.scale(dv), angular: bending.scale(du) };
        if let Some(beside) = &self.coupling {
            wrench.linear += beside.shear * dv + beside.mixed * du;
            wrench.angular += beside.mixed.transpose_mul(dv) + beside.bending * du;
        }
        wrench
    }

    /// Stiffness against bending and twist of the section alone when forces are held: `K_bt`, less
    /// what a coupling with shear and extension takes of it.
    pub fn bending_stiffness(&self) -> Mat3 {
        let diagonal = Mat3::diagonal(self.stiffness.bending);
        if self.coupling.is_none() {
            return diagonal;
        }
        Hessian::of(self).factor().map_or(diagonal, |tangent| tangent.reduced)
    }

    /// Strain of the rod alone, without cables, under a wrench.
    #[inline]
    pub fn bare_strain(&self, wrench: BodyWrench) -> Strain {
        self.rest_strain() + self.yielding(wrench)
    }

    /// What the rod alone adds to its strain under an additional wrench, `K⁻¹ w`.
    #[inline]
    pub fn yielding(&self, wrench: BodyWrench) -> Strain {
        if self.coupling.is_some() {
            // A stiffness that a robot may have is positive definite.
            return Hessian::of(self).factor().map_or_else(Strain::default, |h| h.solve(wrench));
        }
        Strain {
            linear: self.compliance.shear.scale(wrench.linear),
            angular: self.compliance.bending.scale(wrench.angular),
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

    /// `H⁻¹` as `∂v/∂N`, `∂v/∂M`, which is the transpose of `∂u/∂N`, and `∂u/∂M`.
    #[inline]
    pub fn compliance(&self) -> [Mat3; 3] {
        let turn = self.moment.solve_matrix(&Mat3::IDENTITY);
        let mixed = -(self.coupling * turn);
        let stretch = self.force.solve_matrix(&Mat3::IDENTITY) - mixed * self.coupling.transpose();
        [stretch, mixed, turn]
    }

    /// Blocks `∂v/∂N` (symmetric) and `∂v/∂u` at constant `N`, for the second variation.
    pub fn force_compliance(&self) -> (Mat3, Mat3) {
        (self.force.solve_matrix(&Mat3::IDENTITY), -self.coupling)
    }
}

/// Finds the strain of a section, starting from `strain`; `tensions` and `crossings` belong to the
/// same cables.
#[inline]
pub(crate) fn equilibrium(
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
pub(crate) fn newton_equilibrium(
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
    let elastic = section.elastic_wrench(strain);
    let mut force = wrench.linear - elastic.linear;
    let mut moment = wrench.angular - elastic.angular;
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
        let soft = section.compliance.shear;
        let pivot = |k: f64, soft: f64| if soft == 0.0 { f64::INFINITY } else { k };
        let pivots =
            Vec3::new(pivot(shear.x, soft.x), pivot(shear.y, soft.y), pivot(shear.z, soft.z));
        let mut hessian =
            Self { a: Mat3::diagonal(pivots), b: Mat3::ZERO, c: Mat3::diagonal(bending) };
        if let Some(beside) = &section.coupling {
            hessian.a += beside.shear;
            hessian.b = beside.mixed;
            hessian.c += beside.bending;
        }
        hessian
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
        let (dv, du) = (x.linear - Vec3::Z, x.angular - section.rest_curvature);
        let spring = section.elastic_wrench(x);
        let elastic = 0.5 * (spring.linear.dot(dv) + spring.angular.dot(du));
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

    /// A section whose strains are all coupled.
    fn coupled() -> Section {
        section().coupled(Coupling {
            shear: Mat3::from_rows(
                Vec3::new(0.0, 300.0, -900.0),
                Vec3::new(300.0, 0.0, 500.0),
                Vec3::new(-900.0, 500.0, 0.0),
            ),
            mixed: Mat3::from_rows(
                Vec3::new(0.4, -0.7, 1.1),
                Vec3::new(0.3, 0.5, -0.6),
                Vec3::new(-1.5, 0.9, 0.8),
            ),
            bending: Mat3::from_rows(
                Vec3::new(0.0, 1e-3, -5e-4),
                Vec3::new(1e-3, 0.0, 7e-4),
                Vec3::new(-5e-4, 7e-4, 0.0),
            ),
        })
    }

    /// The same stiffness with these axes of shear and extension held.
    fn held(section: &Section, axes: [bool; 3]) -> Section {
        let mut stiffness = section.stiffness;
        for i in (0..3).filter(|&i| axes[i]) {
            stiffness.shear[i] = f64::INFINITY;
        }
        let coupling = section.coupling.as_deref().copied().unwrap_or_default();
        Section::new(stiffness, section.rest_curvature).coupled(coupling)
    }

    fn sections() -> Vec<Section> {
        let holds = [
            [false; 3],
            [false, false, true],
            [true, true, false],
            [false, true, false],
            [true; 3],
        ];
        let both = |axes| [held(&section(), axes), held(&coupled(), axes)];
        holds.into_iter().flat_map(both).collect()
    }

    /// What is left of eqs. (1) and (2), and of the strain of the axes that are held.
    fn residual(s: &Section, c: &[Crossing], tau: &[f64], w: BodyWrench, x: &Strain) -> f64 {
        let (dv, du) = (x.linear - Vec3::Z, x.angular - s.rest_curvature);
        let k = s.coupling.as_deref().copied().unwrap_or_default();
        let mut force = s.stiffness.shear.scale(dv) + k.shear * dv + k.mixed * du - w.linear;
        let mut moment =
            s.stiffness.bending.scale(du) + k.mixed.transpose() * dv + k.bending * du - w.angular;
        for (c, &t) in c.iter().zip(tau) {
            let tangent = x.linear + x.angular.cross(c.offset) + c.slope;
            let pull = tangent * (t / tangent.norm());
            force += pull;
            moment += c.offset.cross(pull);
        }
        let mut left = moment.norm();
        for i in 0..3 {
            let held = s.compliance.shear[i] == 0.0;
            left += if held { 1e3 * dv[i].abs() } else { force[i].abs() };
        }
        left
    }

    const WRENCH: BodyWrench =
        BodyWrench { linear: Vec3::new(0.3, -0.2, -1.0), angular: Vec3::new(0.02, 0.05, 0.01) };

    #[test]
    fn meets_equations_1_and_2_from_a_far_start() {
        for section in sections() {
            for tensions in [[4.0, 2.0, 1.0], [0.0, 30.0, 0.0], [20.0, 10.0, 5.0], [0.0; 3]] {
                let mut x = section.rest_strain();
                equilibrium(&section, &crossings(), &tensions, WRENCH, &mut x).unwrap();
                let left = residual(&section, &crossings(), &tensions, WRENCH, &x);
                let bound = 1e-11 * (1.0 + tensions[0] + tensions[1]);
                assert!(left < bound, "{section:?} {tensions:?}: {left}");
                let damped =
                    damped_equilibrium(&section, &crossings(), &tensions, WRENCH, 0.008).unwrap();
                assert!((damped.linear - x.linear).norm() < 1e-12);
                assert!((damped.angular - x.angular).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_strain() {
        let direction =
            BodyWrench { linear: Vec3::new(1.0, 0.5, -0.7), angular: Vec3::new(0.01, -0.02, 0.03) };
        let tensions = [4.0, 2.0, 1.0];
        for section in sections() {
            let solve = |h: f64| {
                let mut x = section.rest_strain();
                equilibrium(&section, &crossings(), &tensions, WRENCH + direction * h, &mut x)
                    .unwrap();
                (x, Tangent::at(&section, &crossings(), &tensions, &x).unwrap())
            };
            let h = 1e-4;
            let difference = (solve(h).0 - solve(-h).0) * (0.5 / h);
            let exact = solve(0.0).1.solve(direction);
            assert!((difference.angular - exact.angular).norm() < 1e-7 * exact.angular.norm());
            assert!((difference.linear - exact.linear).norm() <= 1e-7 * exact.linear.norm());
        }
    }

    #[test]
    fn a_great_stiffness_tends_to_a_held_axis() {
        let tensions = [4.0, 2.0, 1.0];
        for base in [section(), coupled()] {
            let strain = |section: &Section| {
                let mut x = section.rest_strain();
                equilibrium(section, &crossings(), &tensions, WRENCH, &mut x).unwrap();
                x
            };
            let limit = strain(&held(&base, [true; 3]));
            for factor in [1e3, 1e6, 1e9, 1e12, 1e15] {
                let mut stiff = base.clone();
                stiff.stiffness.shear *= factor;
                let off = (strain(&stiff).angular - limit.angular).norm();
                assert!(off < 10.0 / factor + 1e-12, "{factor:e}: {off:e}");
            }
        }
    }

    #[test]
    fn bending_stiffness_is_that_under_a_moment_alone() {
        for section in sections() {
            let stiffness = section.bending_stiffness();
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let moment = 1e-3 * axis;
                let mut x = section.rest_strain();
                let wrench = BodyWrench { linear: Vec3::ZERO, angular: moment };
                equilibrium(&section, &[], &[], wrench, &mut x).unwrap();
                let left = stiffness * (x.angular - section.rest_curvature) - moment;
                assert!(left.norm() < 1e-15);
            }
        }
    }

    #[test]
    fn too_much_tension_folds() {
        let tensions = [1000.0, 0.0, 0.0];
        let mut x = section().rest_strain();
        let fault = equilibrium(&section(), &crossings(), &tensions, BodyWrench::default(), &mut x);
        assert_eq!(fault.unwrap_err(), SectionFault::Folded { cable: 0 });
    }
}
