//! [`crate::section::equilibrium`] in lanes: Newton's method without damping.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneLdlt3, LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use super::section::{InLanes, LaneBare, LaneHessian, LaneTangent, moved, step_size};
use crate::section::block_diagonal::{Left, most_strain_by_force};
use crate::section::equilibrium::{MORE_STEPS, PART_OF_SQUARE, UNDAMPED};

/// What a step of Newton's method is computed by, as [`crate::section::equilibrium`] has it.
trait LaneNewtonTangent<S: Simd>: Sized {
    /// With the force and moment that are not borne.
    fn at(
        of: &impl InLanes<S>,
        bare: &LaneBare<S>,
        simd: S,
        strain: &LaneTwist<S>,
    ) -> (Self, LaneVec3<S>, LaneVec3<S>);
    fn step(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S>;
    /// Where it is positive definite.
    fn is_definite(&self) -> LaneMask<S>;
    /// Where what a step leaves beside what any step of Newton's method leaves is the square of the tolerance at most, of these lanes.
    fn leaves_square(
        &self,
        lanes: LaneMask<S>,
        square: Lanes<S>,
        step: &LaneTwist<S>,
        size: Lanes<S>,
    ) -> LaneMask<S>;
}

/// [`crate::section::block_diagonal`] in lanes.
struct LaneBlockDiagonal<S: Simd> {
    shear: LaneVec3<S>,
    moment: LaneLdlt3<S>,
    definite: LaneMask<S>,
    left: Left<Lanes<S>>,
}

/// The strain of sections from these, and in which lanes there is one, where a Newton step of `tolerance`, as a strain, is the last.
#[inline(always)]
pub(crate) fn equilibrium_within<S: Simd>(
    tolerance: f64,
    of: &impl InLanes<S>,
    simd: S,
    start: LaneTwist<S>,
) -> (LaneTwist<S>, LaneMask<S>) {
    let bare = of.bare(simd);
    let mut sum = Lanes::splat(simd, 0.0);
    for cable in 0..of.cables() {
        sum = sum + of.crossing(simd, cable).1;
    }
    let strain_by_force = of.compliances(simd)[0].max_abs() * sum;
    let hardly_strained =
        strain_by_force.at_most(Lanes::splat(simd, most_strain_by_force(tolerance)));
    // Each lane goes its own way, whatever those beside it do.
    if hardly_strained.all() {
        return within::<S, LaneBlockDiagonal<S>>(
            tolerance,
            of,
            &bare,
            simd,
            hardly_strained,
            start,
        );
    }
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let others = zero.at_most(one).without(hardly_strained);
    let (strain, met) = within::<S, LaneTangent<S>>(tolerance, of, &bare, simd, others, start);
    if !hardly_strained.any() {
        return (strain, met);
    }
    let (strain, also) =
        within::<S, LaneBlockDiagonal<S>>(tolerance, of, &bare, simd, hardly_strained, strain);
    (strain, met.or(also))
}

/// The same by one kind of tangent in the lanes that are `running`; the others stay where they are.
#[inline(always)]
fn within<S: Simd, T: LaneNewtonTangent<S>>(
    tolerance: f64,
    of: &impl InLanes<S>,
    bare: &LaneBare<S>,
    simd: S,
    mut running: LaneMask<S>,
    mut strain: LaneTwist<S>,
) -> (LaneTwist<S>, LaneMask<S>) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let whole = Lanes::splat(simd, tolerance * tolerance);
    let square = Lanes::splat(simd, PART_OF_SQUARE * (tolerance * tolerance));
    let tolerance = Lanes::splat(simd, tolerance);
    let mut met = one.at_most(zero);
    for _ in 0..UNDAMPED {
        let (tangent, force, moment) = T::at(of, bare, simd, &strain);
        let step = tangent.step(force, moment);
        strain = moved(running, &strain, &step);
        let first = step_size(&step, bare.reach);
        running = running.and(tangent.is_definite());
        let is_met = tangent.leaves_square(first.at_most(tolerance), whole, &step, first);
        met = met.or(running.and(is_met));
        running = running.without(is_met).and(first.at_most(one));
        if !running.any() {
            break;
        }
        // The lanes that go on by this tangent; the others wait for the next.
        let mut by_this = running;
        let mut last = first;
        for _ in 0..MORE_STEPS {
            let (force, moment) = imbalance(of, bare, simd, &strain);
            let step = tangent.step(force, moment);
            strain = moved(by_this, &strain, &step);
            let size = step_size(&step, bare.reach);
            let again = size * size;
            let is_met = (first * size).at_most(square).and(again.at_most(square * last));
            let is_met = tangent.leaves_square(is_met, whole, &step, size);
            met = met.or(by_this.and(is_met));
            running = running.without(by_this.and(is_met));
            let before = last * last;
            let promises = (again * again).at_most(square * (before * last));
            by_this = by_this.and(running).and(size.at_most(first)).and(promises);
            if !by_this.any() {
                break;
            }
            last = size;
        }
        if !running.any() {
            break;
        }
    }
    (strain, met)
}

impl<S: Simd> LaneNewtonTangent<S> for LaneTangent<S> {
    #[inline(always)]
    fn at(
        of: &impl InLanes<S>,
        bare: &LaneBare<S>,
        simd: S,
        strain: &LaneTwist<S>,
    ) -> (Self, LaneVec3<S>, LaneVec3<S>) {
        let (mut force, mut moment) = beside_bare(bare, simd, strain);
        let mut hessian = LaneHessian::of(simd, bare);
        for cable in 0..of.cables() {
            if of.is_slack(cable) {
                continue;
            }
            let (crossing, tension) = of.crossing(simd, cable);
            let (unit, per_stretch) = crossing.direction(simd, strain);
            let pull = unit * tension;
            force = force - pull;
            moment = moment - crossing.moment(pull);
            hessian.add(crossing.offset, unit, tension * per_stretch);
        }
        (hessian.factor(simd), force, moment)
    }

    #[inline(always)]
    fn step(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S> {
        self.solve(force, moment)
    }

    #[inline(always)]
    fn is_definite(&self) -> LaneMask<S> {
        Self::is_definite(self)
    }

    #[inline(always)]
    fn leaves_square(
        &self,
        lanes: LaneMask<S>,
        _: Lanes<S>,
        _: &LaneTwist<S>,
        _: Lanes<S>,
    ) -> LaneMask<S> {
        lanes
    }
}

impl<S: Simd> LaneNewtonTangent<S> for LaneBlockDiagonal<S> {
    #[inline(always)]
    fn at(
        of: &impl InLanes<S>,
        bare: &LaneBare<S>,
        simd: S,
        strain: &LaneTwist<S>,
    ) -> (Self, LaneVec3<S>, LaneVec3<S>) {
        let (mut force, mut moment) = beside_bare(bare, simd, strain);
        let zero = Lanes::splat(simd, 0.0);
        let diagonal = bare.bending;
        let mut c = LaneSym3 {
            xx: diagonal.x,
            yx: zero,
            yy: diagonal.y,
            zx: zero,
            zy: zero,
            zz: diagonal.z,
        };
        let mut sum = zero;
        for cable in 0..of.cables() {
            if of.is_slack(cable) {
                continue;
            }
            let (crossing, tension) = of.crossing(simd, cable);
            let (t, per_stretch) = crossing.direction(simd, strain);
            let n = crossing.moment(t);
            force = force - t * tension;
            moment = moment - n * tension;
            let k = tension * per_stretch;
            sum = sum + k;
            let [x, y] = crossing.offset;
            let (kx, ky, kn) = (k * x, k * y, n * k);
            let (xx, yy) = (kx * x, ky * y);
            c.xx = c.xx + (yy - kn.x * n.x);
            c.yx = c.yx - (kx * y + kn.y * n.x);
            c.yy = c.yy + (xx - kn.y * n.y);
            c.zx = c.zx - kn.z * n.x;
            c.zy = c.zy - kn.z * n.y;
            c.zz = c.zz + ((xx + yy) - kn.z * n.z);
        }
        let [shear, bending] = of.compliances(simd);
        let left = Left {
            by_force: shear.max_abs() * sum,
            by_moment: bending.max_abs() * bare.reach * bare.reach * sum,
        };
        let (factors, definite) = c.ldlt(simd);
        (Self { shear, moment: factors, definite, left }, force, moment)
    }

    #[inline(always)]
    fn step(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S> {
        LaneTwist { linear: self.shear.scale(force), angular: self.moment.solve(moment) }
    }

    #[inline(always)]
    fn is_definite(&self) -> LaneMask<S> {
        self.definite
    }

    #[inline(always)]
    fn leaves_square(
        &self,
        lanes: LaneMask<S>,
        square: Lanes<S>,
        step: &LaneTwist<S>,
        size: Lanes<S>,
    ) -> LaneMask<S> {
        let Left { by_force, by_moment } = self.left;
        let in_force = by_force * size;
        let left = in_force.max(by_moment * (step.linear.max_abs() + in_force));
        lanes.and(left.at_most(square))
    }
}

/// What the sections alone do not bear: force and moment.
#[inline(always)]
fn beside_bare<S: Simd>(
    bare: &LaneBare<S>,
    simd: S,
    strain: &LaneTwist<S>,
) -> (LaneVec3<S>, LaneVec3<S>) {
    let [force, moment] = bare.wrench;
    let dv = strain.linear - LaneVec3::splat(simd, Vec3::Z);
    let du = strain.angular - bare.rest_curvature;
    (force - bare.shear.scale(dv), moment - bare.bending.scale(du))
}

/// The force and moment that neither the sections nor their cables bear.
#[inline(always)]
fn imbalance<S: Simd>(
    of: &impl InLanes<S>,
    bare: &LaneBare<S>,
    simd: S,
    strain: &LaneTwist<S>,
) -> (LaneVec3<S>, LaneVec3<S>) {
    let (mut force, mut moment) = beside_bare(bare, simd, strain);
    for cable in 0..of.cables() {
        if of.is_slack(cable) {
            continue;
        }
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = crossing.direction(simd, strain).0 * tension;
        force = force - pull;
        moment = moment - crossing.moment(pull);
    }
    (force, moment)
}
