//! The Hessian of a section's potential in 3×3 blocks, and its inverse.

use whipcord_numerics::{Ldlt3, Mat3, Vec3};

use super::cable_sums::{CableGroup, CableSums};
use super::crossing::{BodyWrench, Crossing, Strain};
use super::fault::SectionFault;
use super::lanes::{LaneVec, times, transpose_times};
use super::properties::{Coupling, Section};

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

impl Tangent {
    /// The Hessian at a strain.
    #[inline(always)]
    pub fn at(
        section: &Section,
        crossings: &[Crossing],
        tensions: &[f64],
        strain: &Strain,
    ) -> Result<Self, SectionFault> {
        if crossings.is_empty() && section.beside.is_none() {
            return Ok(Self::of_bare(section));
        }
        let mut hessian = Hessian::at(section, strain);
        for (crossing, &tension) in crossings.iter().zip(tensions) {
            if tension != 0.0 {
                let (unit, per_stretch) = crossing.direction(strain);
                hessian.add(crossing.offset, unit, tension * per_stretch);
            }
        }
        hessian.factor().ok_or(SectionFault::Diverged)
    }

    /// [`Self::at`] by sums over groups of cables, where there are any; their rounding is another.
    #[inline(always)]
    pub fn by_groups(
        section: &Section,
        (crossings, groups): (&[Crossing], &[CableGroup]),
        tensions: &[f64],
        strain: &Strain,
    ) -> Result<Self, SectionFault> {
        if groups.is_empty() {
            return Self::at(section, crossings, tensions, strain);
        }
        let mut hessian = Hessian::at(section, strain);
        hessian.add_all(&CableSums::at(groups, tensions, strain));
        hessian.factor().ok_or(SectionFault::Diverged)
    }

    /// Of a section without cables whose stiffness is diagonal.
    #[inline(always)]
    fn of_bare(section: &Section) -> Self {
        Self {
            force: Ldlt3::diagonal(section.compliance.shear),
            coupling: Mat3::ZERO,
            moment: Ldlt3::diagonal(section.compliance.bending),
            reduced: Mat3::diagonal(section.stiffness.bending),
        }
    }

    /// The change of strain under a change of wrench, `H⁻¹ w`.
    #[inline(always)]
    pub fn solve(&self, wrench: BodyWrench) -> Strain {
        let angular =
            self.moment.solve(wrench.angular - self.coupling.transpose_mul(wrench.linear));
        Strain { linear: self.force.solve(wrench.linear) - self.coupling * angular, angular }
    }

    /// [`Self::solve`] for several columns: `∂v` and `∂u`.
    #[inline(always)]
    pub fn solve_lanes(&self, linear: &LaneVec, angular: &LaneVec) -> (LaneVec, LaneVec) {
        let solve = |factors: &Ldlt3, b: LaneVec| {
            let [x, y, z] = factors.solve_each([b.x, b.y, b.z]);
            LaneVec { x, y, z }
        };
        let du = solve(&self.moment, *angular - transpose_times(&self.coupling, linear));
        (solve(&self.force, *linear) - times(&self.coupling, &du), du)
    }

    /// `H⁻¹` as `∂v/∂N`, `∂v/∂M`, which is the transpose of `∂u/∂N`, and `∂u/∂M`.
    #[inline(always)]
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

/// Blocks of the Hessian of the potential. `A` and `C` are symmetric: only their lower triangles
/// are kept up.
pub(crate) struct Hessian {
    a: Mat3,
    b: Mat3,
    c: Mat3,
}

impl Hessian {
    /// Of the section at a strain, without cables.
    #[inline(always)]
    pub fn at(section: &Section, strain: &Strain) -> Self {
        let mut hessian = Self {
            a: Mat3::diagonal(section.pivots()),
            b: Mat3::ZERO,
            c: Mat3::diagonal(section.stiffness.bending),
        };
        if let Some(beside) = &section.beside {
            hessian.a += beside.coupling.shear;
            hessian.b = beside.coupling.mixed;
            hessian.c += beside.coupling.bending;
            if let Some(friction) = &beside.friction {
                hessian.c += friction.tangent_matrix(strain.angular - section.rest_curvature);
            }
        }
        hessian
    }

    /// Of its elastic part.
    pub fn elastic(section: &Section) -> Self {
        let mut hessian = Self {
            a: Mat3::diagonal(section.pivots()),
            b: Mat3::ZERO,
            c: Mat3::diagonal(section.stiffness.bending),
        };
        if let Some(Coupling { shear, mixed, bending }) = section.coupling() {
            hessian.a += *shear;
            hessian.b = *mixed;
            hessian.c += *bending;
        }
        hessian
    }

    /// Adds a cable along the unit vector `t` with `k = τ/‖p′‖`: `W = k (I − ttᵀ)`, `−W r̂` and `r̂ᵀ W r̂`. The offset `r` has no z component.
    #[inline(always)]
    pub fn add(&mut self, r: Vec3, t: Vec3, k: f64) {
        let kt = k * t;
        let (xx, yx, yy) = (k - kt.x * t.x, kt.y * t.x, k - kt.y * t.y);
        let (zx, zy, zz) = (kt.z * t.x, kt.z * t.y, k - kt.z * t.z);
        let [a0, a1, a2] = &mut self.a.rows;
        a0.x += xx;
        a1.x -= yx;
        a1.y += yy;
        a2.x -= zx;
        a2.y -= zy;
        a2.z += zz;
        // The last column of `−W r̂`, its first entry negated.
        let turned = Vec3::new(r.x * yx + r.y * xx, r.x * yy + r.y * yx, r.y * zx - r.x * zy);
        let [b0, b1, b2] = &mut self.b.rows;
        let (xzz, yzz) = (r.x * zz, r.y * zz);
        b0.x -= r.y * zx;
        b0.y += r.x * zx;
        b0.z -= turned.x;
        b1.x -= r.y * zy;
        b1.y += r.x * zy;
        b1.z += turned.y;
        b2.x += yzz;
        b2.y -= xzz;
        b2.z += turned.z;
        let [c0, c1, c2] = &mut self.c.rows;
        c0.x += r.y * yzz;
        c1.x -= r.x * yzz;
        c1.y += r.x * xzz;
        c2.x += r.y * turned.z;
        c2.y -= r.x * turned.z;
        c2.z += r.x * turned.y + r.y * turned.x;
    }

    /// Adds all cables of a section.
    #[inline(always)]
    pub fn add_all(&mut self, cables: &CableSums) {
        let ([w0, w1, w2], [b0, b1, b2]) = (cables.force, cables.mixed);
        let ([a0, a1, a2], [c0, c1, c2]) = (&mut self.a.rows, &mut self.c.rows);
        a0.x += w0.x;
        a1.x += w0.y;
        a1.y += w1.y;
        a2.x += w0.z;
        a2.y += w1.z;
        a2.z += w2.z;
        let [r0, r1, r2] = &mut self.b.rows;
        *r0 += Vec3::new(b0.x, b1.x, b2.x);
        *r1 += Vec3::new(b0.y, b1.y, b2.y);
        *r2 += Vec3::new(b0.z, b1.z, b2.z);
        let [m0, m1, m2] = cables.moment;
        c0.x += m0.x;
        c1.x += m0.y;
        c1.y += m1.y;
        c2.x += m0.z;
        c2.y += m1.z;
        c2.z += m2.z;
    }

    /// `None` where it is not positive definite to working precision.
    #[inline(always)]
    pub fn factor(&self) -> Option<Tangent> {
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
