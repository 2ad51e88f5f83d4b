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

    /// The same matrix in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, a: &Mat3) -> Self {
        let entry = |i: usize, j: usize| Lanes::splat(simd, a.rows[i][j]);
        let (xx, yx, yy) = (entry(0, 0), entry(1, 0), entry(1, 1));
        Self { xx, yx, yy, zx: entry(2, 0), zy: entry(2, 1), zz: entry(2, 2) }
    }

    /// The adjugate: the inverse times the determinant.
    #[inline(always)]
    #[must_use]
    pub fn adjugate(&self) -> Self {
        let Self { xx, yx, yy, zx, zy, zz } = *self;
        Self {
            xx: yy * zz - zy * zy,
            yx: zy * zx - yx * zz,
            yy: xx * zz - zx * zx,
            zx: yx * zy - yy * zx,
            zy: yx * zx - xx * zy,
            zz: xx * yy - yx * yx,
        }
    }

    /// `tr(self b)`.
    #[inline(always)]
    fn trace_with(&self, b: &Self) -> Lanes<S> {
        let across = self.yx * b.yx + self.zx * b.zx + self.zy * b.zy;
        self.xx * b.xx + self.yy * b.yy + self.zz * b.zz + across * 2.0
    }

    /// The least `μ` with `det(self − μ metric) = 0`, of a matrix without negative eigenvalues relative
    /// to a metric that is positive definite.
    ///
    /// Laguerre's method goes from below all roots to the least without passing it, at order 3 where
    /// that is simple. What rounding makes negative counts as zero.
    #[inline(always)]
    #[must_use]
    pub fn least_relative(&self, metric: &Self, simd: S) -> Lanes<S> {
        const STEPS: usize = 5;
        // After a step of this part of the root its error is the third power of that.
        const LAST: f64 = 1e-6;
        let (zero, three) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 3.0));
        let (own, of_metric) = (self.adjugate(), metric.adjugate());
        // p(μ) = c₀ − c₁ μ + c₂ μ² − c₃ μ³; tr(a adj a) = 3 det a.
        let third = Lanes::splat(simd, 1.0 / 3.0);
        let c0 = self.trace_with(&own) * third;
        let c1 = own.trace_with(metric);
        let c2 = self.trace_with(&of_metric);
        let c3 = metric.trace_with(&of_metric) * third;
        let mut root = zero;
        let mut running = zero.at_most(three);
        for _ in 0..STEPS {
            let value = c0 - root * (c1 - root * (c2 - root * c3));
            let fall = c1 - root * (c2 * 2.0 - root * c3 * three);
            let bend = c2 * 2.0 - root * c3 * 6.0;
            let under_root = (fall * fall * 2.0 - value * bend * three) * 2.0;
            let step = value * three / (fall + under_root.at_least(0.0).sqrt());
            // At the root rounding alone decides the sign; 0/0 is no step either.
            running = running.and(zero.below(value)).and(zero.below(step));
            root = root + running.select(step, zero);
            running = running.and((root * LAST).below(step));
            if !running.any() {
                break;
            }
        }
        root
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
