//! A cross-section of the rod: stiffness and rest curvature.

use whipcord_numerics::{Mat3, Vec3};

use super::bending_friction::BendingFriction;
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

/// What a section has beside the diagonal of its stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Beside {
    /// Stiffness beside the diagonal; zero where nothing is coupled.
    pub coupling: Coupling,
    /// Friction against bending.
    pub friction: Option<BendingFriction>,
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
    /// Whether x and y are alike, nothing is coupled and bending has no friction.
    pub isotropic: bool,
    /// Where the stiffness is not diagonal or bending has friction. Apart from the rest, so that a section stays small.
    pub beside: Option<Box<Beside>>,
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
            beside: None,
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
        let beside = Beside { coupling, friction: self.friction().copied() };
        Self { isotropic: false, beside: Some(Box::new(beside)), ..self }
    }

    /// The same with friction against bending.
    pub fn with_friction(self, friction: BendingFriction) -> Self {
        let coupling = self.coupling().copied().unwrap_or_default();
        let beside = Beside { coupling, friction: Some(friction) };
        Self { isotropic: false, beside: Some(Box::new(beside)), ..self }
    }

    /// Friction against bending, where there is any.
    #[inline]
    pub fn friction(&self) -> Option<&BendingFriction> {
        self.beside.as_ref()?.friction.as_ref()
    }

    /// The same, to be changed.
    pub fn friction_mut(&mut self) -> Option<&mut BendingFriction> {
        self.beside.as_mut()?.friction.as_mut()
    }

    /// Stiffness beside the diagonal, where any strain is coupled with another one.
    #[inline]
    pub fn coupling(&self) -> Option<&Coupling> {
        self.beside.as_ref().map(|beside| &beside.coupling).filter(|k| **k != Coupling::default())
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
        if let Some(beside) = &self.beside {
            let Coupling { shear, mixed, bending } = &beside.coupling;
            wrench.linear += *shear * dv + *mixed * du;
            wrench.angular += mixed.transpose_mul(dv) + *bending * du;
        }
        wrench
    }

    /// What the strain exerts together with the friction against bending.
    #[inline]
    pub fn wrench(&self, strain: &Strain) -> BodyWrench {
        let mut wrench = self.elastic_wrench(strain);
        if let Some(friction) = self.friction() {
            wrench.angular += friction.moment(strain.angular - self.rest_curvature);
        }
        wrench
    }

    /// The energy of a strain, that of eq. (1) of [`super::bending_friction`] included: what [`Self::wrench`] is the slope of.
    pub fn energy(&self, strain: &Strain) -> f64 {
        let (dv, du) = (strain.linear - Vec3::Z, strain.angular - self.rest_curvature);
        let spring = self.elastic_wrench(strain);
        let elastic = 0.5 * (spring.linear.dot(dv) + spring.angular.dot(du));
        match self.friction() {
            Some(friction) => elastic + friction.energy(du),
            None => elastic,
        }
    }

    /// Strain of the section at rest.
    #[inline]
    pub fn rest_strain(&self) -> Strain {
        Strain { linear: Vec3::Z, angular: self.rest_curvature }
    }
}
