//! One cross-section without load in each lane: [`crate::section`] in lanes.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneLdlt3, LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::Crossing;

/// Sections in lanes, and what crosses them: one of many robots, or those of a run of one robot.
pub(crate) trait InLanes<S: Simd> {
    /// How many cables cross.
    fn cables(&self) -> usize;
    /// What the sections are without cables.
    fn bare(&self, simd: S) -> LaneBare<S>;
    /// Whether a cable pulls in no lane.
    fn is_slack(&self, cable: usize) -> bool;
    /// How a cable crosses, and its tension.
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>);
    /// Inverse of the diagonals of the stiffness, for forces and for moments.
    fn compliances(&self, simd: S) -> [LaneVec3<S>; 2];
    /// How a cable runs at rest: its unit tangent, and `1/‖p′‖`.
    fn direction_at_rest(&self, simd: S, cable: usize) -> (LaneVec3<S>, Lanes<S>);
}

/// A section without cables in each lane, with a diagonal stiffness.
#[derive(Clone, Copy)]
pub(crate) struct LaneBare<S: Simd> {
    pub shear: LaneVec3<S>,
    pub bending: LaneVec3<S>,
    /// Diagonal of the Hessian's block of forces without cables: infinite on an axis that is held.
    pub pivots: LaneVec3<S>,
    pub rest_curvature: LaneVec3<S>,
    /// [`crate::section::reach`].
    pub reach: Lanes<S>,
    /// Total force and moment that act there, in the body frame.
    pub wrench: [LaneVec3<S>; 2],
}

/// [`crate::section::Crossing`] in each lane. The offset has no z component.
#[derive(Clone, Copy)]
pub(crate) struct LaneCrossing<S: Simd> {
    pub offset: [Lanes<S>; 2],
    pub slope: LaneVec3<S>,
}

/// [`crate::section::Tangent`] in each lane.
pub(crate) struct LaneTangent<S: Simd> {
    force: LaneLdlt3<S>,
    /// Columns of `A⁻¹B`.
    coupling: [LaneVec3<S>; 3],
    moment: LaneLdlt3<S>,
    reduced: LaneSym3<S>,
    definite: LaneMask<S>,
}

/// [`crate::section::Hessian`] in each lane; `b` by columns.
pub(super) struct LaneHessian<S: Simd> {
    a: LaneSym3<S>,
    b: [LaneVec3<S>; 3],
    c: LaneSym3<S>,
}

/// What a cable under unit tension exerts, and its stretch. The offset has no z component: what would
/// be multiplied by it is left out, which changes no bits.
pub(crate) struct LanePull<S: Simd> {
    pub linear: LaneVec3<S>,
    pub angular: LaneVec3<S>,
    pub stretch: Lanes<S>,
}

/// No force and no moment in any lane.
#[inline(always)]
pub(crate) fn no_wrench<S: Simd>(simd: S) -> [LaneVec3<S>; 2] {
    [LaneVec3::splat(simd, Vec3::ZERO), LaneVec3::splat(simd, Vec3::ZERO)]
}

impl<S: Simd> LaneCrossing<S> {
    /// The same in each lane.
    #[inline(always)]
    pub fn splat(simd: S, Crossing { offset, slope, .. }: &Crossing) -> Self {
        let offset = [Lanes::splat(simd, offset.x), Lanes::splat(simd, offset.y)];
        Self { offset, slope: LaneVec3::splat(simd, *slope) }
    }

    #[inline(always)]
    fn tangent(&self, strain: &LaneTwist<S>) -> LaneVec3<S> {
        self.moved(strain) + self.slope
    }

    /// What a strain adds to the tangent, `v + u × r`.
    #[inline(always)]
    fn moved(&self, strain: &LaneTwist<S>) -> LaneVec3<S> {
        let [x, y] = self.offset;
        let (v, u) = (strain.linear, strain.angular);
        LaneVec3::new(v.x - u.z * y, v.y + u.z * x, v.z + (u.x * y - u.y * x))
    }

    /// Unit tangent, and `1/‖p′‖`.
    #[inline(always)]
    pub fn direction(&self, simd: S, strain: &LaneTwist<S>) -> (LaneVec3<S>, Lanes<S>) {
        let tangent = self.tangent(strain);
        let per_stretch = Lanes::splat(simd, 1.0) / tangent.norm();
        (tangent * per_stretch, per_stretch)
    }

    /// The moment of a force along the cable.
    #[inline(always)]
    pub fn moment(&self, f: LaneVec3<S>) -> LaneVec3<S> {
        let [x, y] = self.offset;
        LaneVec3::new(f.z * y, -(f.z * x), f.y * x - f.x * y)
    }

    #[inline(always)]
    pub fn pull(&self, simd: S, strain: &LaneTwist<S>) -> LanePull<S> {
        let tangent = self.tangent(strain);
        let stretch = tangent.norm();
        let linear = tangent * (Lanes::splat(simd, 1.0) / stretch);
        LanePull { linear, angular: self.moment(linear), stretch }
    }

    /// `‖p′‖`.
    #[inline(always)]
    pub fn stretch(&self, strain: &LaneTwist<S>) -> Lanes<S> {
        self.tangent(strain).norm()
    }
}

/// The greatest first-order part of a response, as a strain, from which Newton's method starts.
const MOST_OF_SERIES: f64 = 0.25;

/// The response of sections at rest to the tensions, to the second order in these: `x₁` and `x₂` of `K x₁ = −g`, `K x₂ = −(∂g/∂x) x₁`, where `g` is what the
/// cables exert. Where `x₁` is greater than [`MOST_OF_SERIES`] it is the section at rest.
#[inline(always)]
pub(crate) fn response_at_rest<S: Simd>(of: &impl InLanes<S>, simd: S) -> LaneTwist<S> {
    let bare = of.bare(simd);
    let zero = Lanes::splat(simd, 0.0);
    let null = LaneVec3::new(zero, zero, zero);
    let [shear, bending] = of.compliances(simd);
    let rest = LaneTwist { linear: LaneVec3::splat(simd, Vec3::Z), angular: bare.rest_curvature };
    let (mut force, mut moment) = (null, null);
    for cable in 0..of.cables() {
        if of.is_slack(cable) {
            continue;
        }
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = of.direction_at_rest(simd, cable).0 * tension;
        force = force - pull;
        moment = moment - crossing.moment(pull);
    }
    let first = LaneTwist { linear: shear.scale(force), angular: bending.scale(moment) };
    (force, moment) = (null, null);
    for cable in 0..of.cables() {
        if of.is_slack(cable) {
            continue;
        }
        let (crossing, tension) = of.crossing(simd, cable);
        let (unit, per_stretch) = of.direction_at_rest(simd, cable);
        let moved = crossing.moved(&first);
        let turned = (moved - unit * unit.dot(moved)) * (tension * per_stretch);
        force = force - turned;
        moment = moment - crossing.moment(turned);
    }
    let second = LaneTwist { linear: shear.scale(force), angular: bending.scale(moment) };
    let is_small = step_size(&first, bare.reach).at_most(Lanes::splat(simd, MOST_OF_SERIES));
    moved(is_small, &rest, &(first + second))
}

/// Where a step leads; lanes that are not running stay where they are.
#[inline(always)]
pub(super) fn moved<S: Simd>(
    running: LaneMask<S>,
    strain: &LaneTwist<S>,
    step: &LaneTwist<S>,
) -> LaneTwist<S> {
    let select = |from: LaneVec3<S>, step: LaneVec3<S>| {
        let to = from + step;
        LaneVec3::new(
            running.select(to.x, from.x),
            running.select(to.y, from.y),
            running.select(to.z, from.z),
        )
    };
    LaneTwist {
        linear: select(strain.linear, step.linear),
        angular: select(strain.angular, step.angular),
    }
}

#[inline(always)]
pub(super) fn step_size<S: Simd>(step: &LaneTwist<S>, reach: Lanes<S>) -> Lanes<S> {
    step.linear.max_abs().max(step.angular.max_abs() * reach)
}

/// The factors of [`crate::section::Tangent`] at a strain, and what each cable exerts there, which `take` is given with its number.
#[inline(always)]
pub(crate) fn linearize<S: Simd>(
    of: &impl InLanes<S>,
    simd: S,
    strain: &LaneTwist<S>,
    mut take: impl FnMut(usize, &LanePull<S>),
) -> LaneTangent<S> {
    let mut hessian = LaneHessian::of(simd, &of.bare(simd));
    for cable in 0..of.cables() {
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = crossing.pull(simd, strain);
        if !of.is_slack(cable) {
            let per_stretch = Lanes::splat(simd, 1.0) / pull.stretch;
            hessian.add(crossing.offset, pull.linear, tension * per_stretch);
        }
        take(cable, &pull);
    }
    hessian.factor(simd)
}

/// Bending stiffness of sections at a strain when forces are held, and in which lanes there is one.
#[inline(always)]
pub(crate) fn reduced<S: Simd>(
    of: &impl InLanes<S>,
    simd: S,
    strain: &LaneTwist<S>,
) -> (LaneSym3<S>, LaneMask<S>) {
    let tangent = linearize(of, simd, strain, |_, _| {});
    (tangent.reduced, tangent.definite)
}

impl<S: Simd> LaneHessian<S> {
    #[inline(always)]
    pub fn of(simd: S, bare: &LaneBare<S>) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        let diagonal =
            |d: LaneVec3<S>| LaneSym3 { xx: d.x, yx: zero, yy: d.y, zx: zero, zy: zero, zz: d.z };
        Self { a: diagonal(bare.pivots), b: [null; 3], c: diagonal(bare.bending) }
    }

    #[inline(always)]
    pub fn add(&mut self, [rx, ry]: [Lanes<S>; 2], t: LaneVec3<S>, k: Lanes<S>) {
        let kt = t * k;
        let (xx, yx, yy) = (k - kt.x * t.x, kt.y * t.x, k - kt.y * t.y);
        let (zx, zy, zz) = (kt.z * t.x, kt.z * t.y, k - kt.z * t.z);
        let a = &mut self.a;
        a.xx = a.xx + xx;
        a.yx = a.yx - yx;
        a.yy = a.yy + yy;
        a.zx = a.zx - zx;
        a.zy = a.zy - zy;
        a.zz = a.zz + zz;
        let turned = LaneVec3::new(rx * yx + ry * xx, rx * yy + ry * yx, ry * zx - rx * zy);
        let [b0, b1, b2] = &mut self.b;
        let (xzz, yzz) = (rx * zz, ry * zz);
        *b0 = LaneVec3::new(b0.x - ry * zx, b0.y - ry * zy, b0.z + yzz);
        *b1 = LaneVec3::new(b1.x + rx * zx, b1.y + rx * zy, b1.z - xzz);
        *b2 = LaneVec3::new(b2.x - turned.x, b2.y + turned.y, b2.z + turned.z);
        let c = &mut self.c;
        c.xx = c.xx + ry * yzz;
        c.yx = c.yx - rx * yzz;
        c.yy = c.yy + rx * xzz;
        c.zx = c.zx + ry * turned.z;
        c.zy = c.zy - rx * turned.z;
        c.zz = c.zz + (rx * turned.y + ry * turned.x);
    }

    #[inline(always)]
    pub fn factor(&self, simd: S) -> LaneTangent<S> {
        let (force, definite) = self.a.ldlt(simd);
        let [b0, b1, b2] = self.b;
        let (w0, w1, w2) = (force.solve(b0), force.solve(b1), force.solve(b2));
        let c = self.c;
        let reduced = LaneSym3 {
            xx: c.xx - b0.dot(w0),
            yx: c.yx - b1.dot(w0),
            yy: c.yy - b1.dot(w1),
            zx: c.zx - b2.dot(w0),
            zy: c.zy - b2.dot(w1),
            zz: c.zz - b2.dot(w2),
        };
        let (moment, stiff) = reduced.ldlt(simd);
        let definite = definite.and(stiff);
        LaneTangent { force, coupling: [w0, w1, w2], moment, reduced, definite }
    }
}

/// A matrix of these columns by a vector.
#[inline(always)]
fn combined<S: Simd>([a, b, c]: [LaneVec3<S>; 3], v: LaneVec3<S>) -> LaneVec3<S> {
    a * v.x + b * v.y + c * v.z
}

impl<S: Simd> LaneTangent<S> {
    /// Where the Hessian is positive definite.
    #[inline(always)]
    pub fn is_definite(&self) -> LaneMask<S> {
        self.definite
    }

    /// [`crate::section::Tangent::compliance`]: the columns of each block.
    #[inline(always)]
    pub fn compliance(&self, simd: S) -> [[LaneVec3<S>; 3]; 3] {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let x = LaneVec3::new(one, zero, zero);
        let y = LaneVec3::new(zero, one, zero);
        let z = LaneVec3::new(zero, zero, one);
        let null = LaneVec3::new(zero, zero, zero);
        let [w0, w1, w2] = self.coupling;
        let (ux, uy, uz) = (self.moment.solve(x), self.moment.solve(y), self.moment.solve(z));
        let mx = null - combined(self.coupling, ux);
        let my = null - combined(self.coupling, uy);
        let mz = null - combined(self.coupling, uz);
        let mixed = [mx, my, mz];
        let stretch = [
            self.force.solve(x) - combined(mixed, LaneVec3::new(w0.x, w1.x, w2.x)),
            self.force.solve(y) - combined(mixed, LaneVec3::new(w0.y, w1.y, w2.y)),
            self.force.solve(z) - combined(mixed, LaneVec3::new(w0.z, w1.z, w2.z)),
        ];
        [stretch, mixed, [ux, uy, uz]]
    }

    /// Newton's step.
    #[inline(always)]
    pub fn solve(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S> {
        let [w0, w1, w2] = self.coupling;
        let coupled = LaneVec3::new(w0.dot(force), w1.dot(force), w2.dot(force));
        let u = self.moment.solve(moment - coupled);
        LaneTwist { linear: self.force.solve(force) - combined(self.coupling, u), angular: u }
    }
}
