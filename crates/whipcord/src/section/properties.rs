//! A cross-section of the rod: stiffness and rest curvature.

use whipcord_numerics::{Mat3, Vec3};

use super::crossing::{BodyWrench, Strain};

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

    /// Strain of the section at rest.
    #[inline]
    pub fn rest_strain(&self) -> Strain {
        Strain { linear: Vec3::Z, angular: self.rest_curvature }
    }
}
