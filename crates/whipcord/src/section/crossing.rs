//! How a cable crosses a section, and the strains and wrenches of one.

use whipcord_numerics::{Twist, Vec3};

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
        // The offset has no z component: what would be multiplied by it is left out, which changes no bits.
        let (v, u, r) = (strain.linear, strain.angular, self.offset);
        Vec3::new(v.x - u.z * r.y, v.y + u.z * r.x, v.z + (u.x * r.y - u.y * r.x)) + self.slope
    }

    /// Unit tangent `t`, and `1/‖p′‖`.
    #[inline]
    pub fn direction(&self, strain: &Strain) -> (Vec3, f64) {
        let tangent = self.tangent(strain);
        let per_stretch = 1.0 / tangent.norm();
        (tangent * per_stretch, per_stretch)
    }

    /// What a force along the cable exerts on the section: itself, and its moment.
    #[inline]
    pub fn wrench(&self, force: Vec3) -> BodyWrench {
        let (f, r) = (force, self.offset);
        let angular = Vec3::new(r.y * f.z, -(r.x * f.z), r.x * f.y - r.y * f.x);
        BodyWrench { linear: force, angular }
    }

    /// Unit tangent `t`, moment `r × t` and stretch `‖p′‖`: what a unit tension exerts.
    #[inline]
    pub fn pull(&self, strain: &Strain) -> (BodyWrench, f64) {
        let tangent = self.tangent(strain);
        let stretch = tangent.norm();
        (self.wrench(tangent * (1.0 / stretch)), stretch)
    }
}
