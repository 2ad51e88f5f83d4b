//! One cross-section without load in each lane: [`crate::section`] in lanes.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneLdlt3, LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::equilibrium::{STEP_TOLERANCE, UNDAMPED};

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
struct LaneHessian<S: Simd> {
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

impl<S: Simd> LaneCrossing<S> {
    #[inline(always)]
    fn tangent(&self, strain: &LaneTwist<S>) -> LaneVec3<S> {
        let [x, y] = self.offset;
        let (v, u) = (strain.linear, strain.angular);
        LaneVec3::new(v.x - u.z * y, v.y + u.z * x, v.z + (u.x * y - u.y * x)) + self.slope
    }

    #[inline(always)]
    pub fn pull(&self, simd: S, strain: &LaneTwist<S>) -> LanePull<S> {
        let tangent = self.tangent(strain);
        let stretch = tangent.norm();
        let t = tangent * (Lanes::splat(simd, 1.0) / stretch);
        let [x, y] = self.offset;
        let angular = LaneVec3::new(t.z * y, -(t.z * x), t.y * x - t.x * y);
        LanePull { linear: t, angular, stretch }
    }

    /// `‖p′‖`.
    #[inline(always)]
    pub fn stretch(&self, strain: &LaneTwist<S>) -> Lanes<S> {
        self.tangent(strain).norm()
    }
}

/// The strain of sections from these, and in which lanes there is one.
#[inline(always)]
pub(crate) fn equilibrium<S: Simd>(
    of: &impl InLanes<S>,
    simd: S,
    mut strain: LaneTwist<S>,
) -> (LaneTwist<S>, LaneMask<S>) {
    let bare = of.bare(simd);
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let tolerance = Lanes::splat(simd, STEP_TOLERANCE);
    let mut running = zero.at_most(one);
    let mut met = one.at_most(zero);
    for _ in 0..UNDAMPED {
        let (step, definite) = newton_step(of, &bare, simd, &strain);
        let moved = strain + step;
        let select = |to: LaneVec3<S>, from: LaneVec3<S>| {
            LaneVec3::new(
                running.select(to.x, from.x),
                running.select(to.y, from.y),
                running.select(to.z, from.z),
            )
        };
        // Lanes that are there stay where they are.
        strain = LaneTwist {
            linear: select(moved.linear, strain.linear),
            angular: select(moved.angular, strain.angular),
        };
        let size = step.linear.max_abs().max(step.angular.max_abs() * bare.reach);
        running = running.and(definite);
        met = met.or(running.and(size.at_most(tolerance)));
        running = running.and(tolerance.below(size)).and(size.at_most(one));
        if !running.any() {
            break;
        }
    }
    (strain, met)
}

#[inline(always)]
fn newton_step<S: Simd>(
    of: &impl InLanes<S>,
    bare: &LaneBare<S>,
    simd: S,
    strain: &LaneTwist<S>,
) -> (LaneTwist<S>, LaneMask<S>) {
    let zero = Lanes::splat(simd, 0.0);
    let null = LaneVec3::new(zero, zero, zero);
    let dv = strain.linear - LaneVec3::splat(simd, Vec3::Z);
    let du = strain.angular - bare.rest_curvature;
    let mut force = null - bare.shear.scale(dv);
    let mut moment = null - bare.bending.scale(du);
    let mut hessian = LaneHessian::of(simd, bare);
    for cable in 0..of.cables() {
        if of.is_slack(cable) {
            continue;
        }
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = crossing.pull(simd, strain);
        force = force - pull.linear * tension;
        moment = moment - pull.angular * tension;
        hessian.add(crossing.offset, &pull, tension / pull.stretch);
    }
    let tangent = hessian.factor(simd);
    (tangent.solve(force, moment), tangent.definite)
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
            hessian.add(crossing.offset, &pull, tension / pull.stretch);
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
    fn of(simd: S, bare: &LaneBare<S>) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        let diagonal =
            |d: LaneVec3<S>| LaneSym3 { xx: d.x, yx: zero, yy: d.y, zx: zero, zy: zero, zz: d.z };
        Self { a: diagonal(bare.pivots), b: [null; 3], c: diagonal(bare.bending) }
    }

    #[inline(always)]
    fn add(&mut self, [rx, ry]: [Lanes<S>; 2], pull: &LanePull<S>, k: Lanes<S>) {
        let (t, m) = (pull.linear, pull.angular);
        let (kt, km) = (t * k, m * k);
        let (krx, kry) = (k * rx, k * ry);
        let a = &mut self.a;
        a.xx = a.xx + (k - kt.x * t.x);
        a.yx = a.yx - kt.y * t.x;
        a.yy = a.yy + (k - kt.y * t.y);
        a.zx = a.zx - kt.z * t.x;
        a.zy = a.zy - kt.z * t.y;
        a.zz = a.zz + (k - kt.z * t.z);
        let [b0, b1, b2] = &mut self.b;
        b0.x = b0.x - kt.x * m.x;
        b1.x = b1.x - kt.x * m.y;
        b2.x = b2.x - (kry + kt.x * m.z);
        b0.y = b0.y - kt.y * m.x;
        b1.y = b1.y - kt.y * m.y;
        b2.y = b2.y + (krx - kt.y * m.z);
        b0.z = b0.z + (kry - kt.z * m.x);
        b1.z = b1.z - (krx + kt.z * m.y);
        b2.z = b2.z - kt.z * m.z;
        let rr = krx * rx + kry * ry;
        let c = &mut self.c;
        c.xx = c.xx + (rr - krx * rx - km.x * m.x);
        c.yx = c.yx - (kry * rx + km.y * m.x);
        c.yy = c.yy + (rr - kry * ry - km.y * m.y);
        c.zx = c.zx - km.z * m.x;
        c.zy = c.zy - km.z * m.y;
        c.zz = c.zz + (rr - km.z * m.z);
    }

    #[inline(always)]
    fn factor(&self, simd: S) -> LaneTangent<S> {
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

    #[inline(always)]
    fn solve(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S> {
        let [w0, w1, w2] = self.coupling;
        let coupled = LaneVec3::new(w0.dot(force), w1.dot(force), w2.dot(force));
        let u = self.moment.solve(moment - coupled);
        LaneTwist { linear: self.force.solve(force) - combined(self.coupling, u), angular: u }
    }
}
