//! The strain of a section without cables under a wrench, and how it yields.

use whipcord_numerics::{Mat3, Vec3};

use super::bending_friction::BENDING_AXES;
use super::crossing::{BodyWrench, Strain};
use super::equilibrium::newton_equilibrium;
use super::properties::{Section, Stiffness};
use super::tangent::Hessian;

impl Section {
    /// Elastic stiffness against bending and twist of the section alone when forces are held: `K_bt`, less
    /// what a coupling with shear and extension takes of it.
    pub fn bending_stiffness(&self) -> Mat3 {
        let diagonal = Mat3::diagonal(self.stiffness.bending);
        if self.coupling().is_none() {
            return diagonal;
        }
        Hessian::elastic(self).factor().map_or(diagonal, |tangent| tangent.reduced)
    }

    /// Strain of the rod alone, without cables, under a wrench.
    #[inline(always)]
    pub fn bare_strain(&self, wrench: BodyWrench) -> Strain {
        if self.beside.is_some() {
            return self.bare_strain_beside(wrench);
        }
        let Stiffness { shear, bending } = self.compliance;
        self.rest_strain()
            + Strain { linear: shear.scale(wrench.linear), angular: bending.scale(wrench.angular) }
    }

    #[cold]
    fn bare_strain_beside(&self, wrench: BodyWrench) -> Strain {
        let Some(friction) = self.friction() else {
            return self.rest_strain() + self.yielding_beside(&self.rest_strain(), wrench);
        };
        if self.coupling().is_none() {
            let Stiffness { shear, bending } = self.compliance;
            let mut bend = bending.scale(wrench.angular);
            for axis in 0..BENDING_AXES {
                let (elastic, moment) = (self.stiffness.bending[axis], wrench.angular[axis]);
                bend[axis] = friction.bend(axis, elastic, moment);
            }
            let strain = Strain { linear: shear.scale(wrench.linear), angular: bend };
            return self.rest_strain() + strain;
        }
        // The energy is convex: this ends short of the answer for wrenches only that are not finite.
        let mut strain = self.rest_strain();
        match newton_equilibrium(self, &[], &[], wrench, &mut strain) {
            Ok(()) => strain,
            Err(_) => {
                let unknown = Vec3::new(f64::NAN, f64::NAN, f64::NAN);
                Strain { linear: unknown, angular: unknown }
            }
        }
    }

    /// What the rod alone adds to a strain under an additional wrench, to first order.
    #[inline(always)]
    pub fn yielding(&self, strain: &Strain, wrench: BodyWrench) -> Strain {
        if self.beside.is_some() {
            return self.yielding_beside(strain, wrench);
        }
        Strain {
            linear: self.compliance.shear.scale(wrench.linear),
            angular: self.compliance.bending.scale(wrench.angular),
        }
    }

    #[cold]
    fn yielding_beside(&self, strain: &Strain, wrench: BodyWrench) -> Strain {
        // A stiffness that a robot may have is positive definite.
        Hessian::at(self, strain).factor().map_or_else(Strain::default, |h| h.solve(wrench))
    }
}
