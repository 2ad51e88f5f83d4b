use pulp::Simd;

use super::{LaneMask, LaneVec3, Lanes};
use crate::Mat3;

/// The lower triangle of a symmetric 3×3 matrix in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneSym3<S: Simd> {
    /// Row 1, column 1.
    pub xx: Lanes<S>,
    /// Row 2, column 1.
    pub yx: Lanes<S>,
    /// Row 2, column 2.
    pub yy: Lanes<S>,
    /// Row 3, column 1.
    pub zx: Lanes<S>,
    /// Row 3, column 2.
    pub zy: Lanes<S>,
    /// Row 3, column 3.
    pub zz: Lanes<S>,
}

/// [`crate::Ldlt3`] in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneLdlt3<S: Simd> {
    l10: Lanes<S>,
    l20: Lanes<S>,
    l21: Lanes<S>,
    inv_d: LaneVec3<S>,
}

impl<S: Simd> LaneSym3<S> {
    /// The factors of [`Mat3::ldlt`], and in which lanes there are any.
    #[inline(always)]
    #[must_use]
    pub fn ldlt(&self, simd: S) -> (LaneLdlt3<S>, LaneMask<S>) {
        let one = Lanes::splat(simd, 1.0);
        let inv0 = one / self.xx;
        let l10 = self.yx * inv0;
        let l20 = self.zx * inv0;
        let d1 = self.yy - l10 * self.yx;
        let inv1 = one / d1;
        let m21 = self.zy - l20 * self.yx;
        let l21 = m21 * inv1;
        let d2 = self.zz - l20 * self.zx - l21 * m21;
        let least =
            |diagonal: Lanes<S>| Lanes::splat(simd, f64::EPSILON) * diagonal + f64::MIN_POSITIVE;
        let definite = Lanes::splat(simd, 0.0)
            .below(self.xx)
            .and(least(self.yy).at_most(d1))
            .and(least(self.zz).at_most(d2));
        let inv_d = LaneVec3::new(inv0, inv1, one / d2);
        (LaneLdlt3 { l10, l20, l21, inv_d }, definite)
    }

    /// The matrix of one lane.
    #[must_use]
    pub fn lane(&self, lane: usize) -> Mat3 {
        let of = |entry: &Lanes<S>| entry.as_slice()[lane];
        let Self { xx, yx, yy, zx, zy, zz } = self;
        Mat3::from_rows(
            crate::Vec3::new(of(xx), of(yx), of(zx)),
            crate::Vec3::new(of(yx), of(yy), of(zy)),
            crate::Vec3::new(of(zx), of(zy), of(zz)),
        )
    }
}

impl<S: Simd> LaneLdlt3<S> {
    /// Solves `A x = b`.
    #[inline(always)]
    #[must_use]
    pub fn solve(&self, b: LaneVec3<S>) -> LaneVec3<S> {
        let y1 = b.y - self.l10 * b.x;
        let y2 = b.z - self.l20 * b.x - self.l21 * y1;
        let x2 = y2 * self.inv_d.z;
        let x1 = y1 * self.inv_d.y - self.l21 * x2;
        let x0 = b.x * self.inv_d.x - self.l10 * x1 - self.l20 * x2;
        LaneVec3::new(x0, x1, x2)
    }
}
