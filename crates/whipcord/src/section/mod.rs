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
//! `K` is diagonal, or has terms beside its diagonal (`Coupling`). An axis of `v` may be *held*: the
//! rod does not stretch, or does not shear. Its compliance is zero, its strain stays what it is at
//! rest, and its equation in (1) only says what the reaction is. In the Hessian it has an infinite
//! pivot, whose inverse is the zero that is wanted.

pub(crate) mod equilibrium;
pub(crate) mod lanes;
pub(crate) mod of_robot;
pub(crate) mod one_cable;
mod tangent;
#[cfg(test)]
mod tests;

use whipcord_numerics::{Mat3, Twist, Vec3};

pub(crate) use equilibrium::equilibrium;
pub use of_robot::material_stiffness;
use tangent::Hessian;
pub(crate) use tangent::Tangent;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// `r` in m; its z component is zero.
    pub offset: Vec3,
    /// `r′`.
    pub slope: Vec3,
    /// Unit vector along `r`; along x where there is none.
    pub radial: Vec3,
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

/// A fault and where it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fault {
    pub kind: SectionFault,
    /// Arc length in m.
    pub arc_length: f64,
}

/// Below this stretch, from 1 at rest, a cable counts as folded.
pub(crate) const FOLDED: f64 = 1e-4;

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

    /// Diagonal of the Hessian's block of forces without cables: infinite on a held axis.
    #[inline]
    pub(crate) fn pivots(&self) -> Vec3 {
        let (k, soft) = (self.stiffness.shear, self.compliance.shear);
        let pivot = |k: f64, soft: f64| if soft == 0.0 { f64::INFINITY } else { k };
        Vec3::new(pivot(k.x, soft.x), pivot(k.y, soft.y), pivot(k.z, soft.z))
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
    #[inline(always)]
    pub fn bare_strain(&self, wrench: BodyWrench) -> Strain {
        self.rest_strain() + self.yielding(wrench)
    }

    /// What the rod alone adds to its strain under an additional wrench, `K⁻¹ w`.
    #[inline(always)]
    pub fn yielding(&self, wrench: BodyWrench) -> Strain {
        if self.coupling.is_some() {
            return self.yielding_coupled(wrench);
        }
        Strain {
            linear: self.compliance.shear.scale(wrench.linear),
            angular: self.compliance.bending.scale(wrench.angular),
        }
    }

    #[cold]
    fn yielding_coupled(&self, wrench: BodyWrench) -> Strain {
        // A stiffness that a robot may have is positive definite.
        Hessian::of(self).factor().map_or_else(Strain::default, |h| h.solve(wrench))
    }

    /// Strain of the section at rest.
    #[inline]
    pub fn rest_strain(&self) -> Strain {
        Strain { linear: Vec3::Z, angular: self.rest_curvature }
    }
}

impl Default for Crossing {
    fn default() -> Self {
        Self::new(Vec3::ZERO, Vec3::ZERO)
    }
}

impl Crossing {
    /// From `r` and `r′`.
    pub fn new(offset: Vec3, slope: Vec3) -> Self {
        let radius = offset.norm();
        let radial = if radius > 0.0 { offset * (1.0 / radius) } else { Vec3::X };
        Self { offset, slope, radial }
    }

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
