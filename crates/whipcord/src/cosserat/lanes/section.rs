//! One cross-section without load in each lane.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneLdlt3, LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::equilibrium::{STEP_TOLERANCE, UNDAMPED};
use crate::section::one_cable::{self, MET, Reduced};
use crate::section::reach;
use crate::section::{Crossing, FOLDED, Section, Stiffness};
use crate::statics::section_runs::WaveStart;

/// Sections in lanes, and what crosses them: one of many robots, or those of a run of one robot.
pub(super) trait InLanes<S: Simd> {
    /// How many cables cross.
    fn cables(&self) -> usize;
    /// What the sections are without cables.
    fn bare(&self, simd: S) -> LaneBare<S>;
    /// How a cable crosses, and its tension.
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>);
}

/// A section without cables in each lane, with a diagonal stiffness.
#[derive(Clone, Copy)]
pub(super) struct LaneBare<S: Simd> {
    pub shear: LaneVec3<S>,
    pub bending: LaneVec3<S>,
    /// Diagonal of the Hessian's block of forces without cables: infinite on an axis that is held.
    pub pivots: LaneVec3<S>,
    pub rest_curvature: LaneVec3<S>,
    /// [`reach`].
    pub reach: Lanes<S>,
}

/// [`Crossing`] in each lane. The offset has no z component.
#[derive(Clone, Copy)]
pub(super) struct LaneCrossing<S: Simd> {
    pub offset: [Lanes<S>; 2],
    pub slope: LaneVec3<S>,
}

/// A section of many robots that any number of cables cross: [`crate::section`] in lanes.
#[derive(Clone, Debug)]
pub(super) struct Several {
    stiffness: Stiffness,
    pivots: Vec3,
    rest_curvature: Vec3,
    crossings: Vec<Crossing>,
    reach: f64,
    guess: Guess,
}

/// Where Newton's method starts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Guess {
    /// At rest.
    Rest,
    /// At the strain of the section before.
    Last,
    /// Beyond the three before, of which the first two have these weights, see [`super::super::strain_guess::extrapolation`].
    Beyond([f64; 2]),
    /// Between sections of its run.
    InRun(WaveStart),
}

/// A section of many robots under their tensions.
struct Pulled<'a, S: Simd> {
    section: &'a Several,
    tensions: &'a [Lanes<S>],
}

impl<S: Simd> InLanes<S> for Pulled<'_, S> {
    #[inline(always)]
    fn cables(&self) -> usize {
        self.section.crossings.len().min(self.tensions.len())
    }

    #[inline(always)]
    fn bare(&self, simd: S) -> LaneBare<S> {
        let Several { stiffness, pivots, rest_curvature, reach, .. } = self.section;
        LaneBare {
            shear: LaneVec3::splat(simd, stiffness.shear),
            bending: LaneVec3::splat(simd, stiffness.bending),
            pivots: LaneVec3::splat(simd, *pivots),
            rest_curvature: LaneVec3::splat(simd, *rest_curvature),
            reach: Lanes::splat(simd, *reach),
        }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>) {
        let Crossing { offset, slope, .. } = &self.section.crossings[cable];
        let offset = [Lanes::splat(simd, offset.x), Lanes::splat(simd, offset.y)];
        let crossing = LaneCrossing { offset, slope: LaneVec3::splat(simd, *slope) };
        (crossing, self.tensions[cable])
    }
}

/// [`crate::section::Tangent`] in each lane.
struct LaneTangent<S: Simd> {
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
struct LanePull<S: Simd> {
    linear: LaneVec3<S>,
    angular: LaneVec3<S>,
    stretch: Lanes<S>,
}

impl<S: Simd> LaneCrossing<S> {
    #[inline(always)]
    fn tangent(&self, strain: &LaneTwist<S>) -> LaneVec3<S> {
        let [x, y] = self.offset;
        let (v, u) = (strain.linear, strain.angular);
        LaneVec3::new(v.x - u.z * y, v.y + u.z * x, v.z + (u.x * y - u.y * x)) + self.slope
    }

    #[inline(always)]
    fn pull(&self, simd: S, strain: &LaneTwist<S>) -> LanePull<S> {
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
pub(super) fn equilibrium<S: Simd>(
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
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = crossing.pull(simd, strain);
        force = force - pull.linear * tension;
        moment = moment - pull.angular * tension;
        hessian.add(crossing.offset, &pull, tension / pull.stretch);
    }
    let tangent = hessian.factor(simd);
    (tangent.solve(force, moment), tangent.definite)
}

/// The linear combination of strains that a section of a run starts from.
#[inline(always)]
fn between<S: Simd>(
    simd: S,
    start: &WaveStart,
    rest_curvature: Vec3,
    strain: impl Fn(usize) -> LaneTwist<S>,
) -> LaneTwist<S> {
    match *start {
        WaveStart::Rest => LaneTwist {
            linear: LaneVec3::splat(simd, Vec3::Z),
            angular: LaneVec3::splat(simd, rest_curvature),
        },
        WaveStart::Between { nodes: [a, b, c, d], weights: [wb, wc, wd] } => {
            let a = strain(a);
            a + (strain(b) - a) * wb + (strain(c) - a) * wc + (strain(d) - a) * wd
        }
    }
}

impl Several {
    /// `None` for a stiffness that is not diagonal.
    pub fn new(section: &Section, crossings: &[Crossing], guess: Guess) -> Option<Self> {
        if section.beside.is_some() {
            return None;
        }
        Some(Self {
            stiffness: section.stiffness,
            pivots: section.pivots(),
            rest_curvature: section.rest_curvature,
            crossings: crossings.to_vec(),
            reach: reach(crossings),
            guess,
        })
    }

    /// How many cables cross it.
    pub fn cables(&self) -> usize {
        self.crossings.len()
    }

    /// Bending stiffness of the section alone, diagonal.
    pub fn bending(&self) -> Vec3 {
        self.stiffness.bending
    }

    /// The strain from those of the sections before, the last three and all of its run, and in which lanes there is one.
    #[inline(always)]
    pub fn solve<S: Simd>(
        &self,
        simd: S,
        before: &[LaneTwist<S>; 3],
        strains: &[LaneTwist<S>],
        tensions: &[Lanes<S>],
    ) -> (LaneTwist<S>, LaneMask<S>) {
        let [a, b, c] = *before;
        let start = match &self.guess {
            Guess::Rest => between(simd, &WaveStart::Rest, self.rest_curvature, |_| c),
            Guess::Last => c,
            Guess::Beyond([wa, wb]) => c + (a - c) * *wa + (b - c) * *wb,
            Guess::InRun(start) => between(simd, start, self.rest_curvature, |at| strains[at]),
        };
        equilibrium(&Pulled { section: self, tensions }, simd, start)
    }

    /// Adds the stretches of the cables at a strain.
    #[inline(always)]
    pub fn add_stretches<S: Simd>(
        &self,
        simd: S,
        tensions: &[Lanes<S>],
        strain: &LaneTwist<S>,
        stretches: &mut Vec<Lanes<S>>,
    ) {
        let pulled = Pulled { section: self, tensions };
        for cable in 0..InLanes::<S>::cables(&pulled) {
            stretches.push(pulled.crossing(simd, cable).0.stretch(strain));
        }
    }

    /// Bending stiffness at a strain when forces are held, and in which lanes there is one.
    #[inline(always)]
    pub fn reduced<S: Simd>(
        &self,
        simd: S,
        tensions: &[Lanes<S>],
        strain: &LaneTwist<S>,
    ) -> (LaneSym3<S>, LaneMask<S>) {
        reduced(&Pulled { section: self, tensions }, simd, strain)
    }
}

/// Bending stiffness of sections at a strain when forces are held, and in which lanes there is one.
#[inline(always)]
pub(super) fn reduced<S: Simd>(
    of: &impl InLanes<S>,
    simd: S,
    strain: &LaneTwist<S>,
) -> (LaneSym3<S>, LaneMask<S>) {
    let mut hessian = LaneHessian::of(simd, &of.bare(simd));
    for cable in 0..of.cables() {
        let (crossing, tension) = of.crossing(simd, cable);
        let pull = crossing.pull(simd, strain);
        hessian.add(crossing.offset, &pull, tension / pull.stretch);
    }
    let tangent = hessian.factor(simd);
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

impl<S: Simd> LaneTangent<S> {
    #[inline(always)]
    fn solve(&self, force: LaneVec3<S>, moment: LaneVec3<S>) -> LaneTwist<S> {
        let [w0, w1, w2] = self.coupling;
        let coupled = LaneVec3::new(w0.dot(force), w1.dot(force), w2.dot(force));
        let u = self.moment.solve(moment - coupled);
        let given = w0 * u.x + w1 * u.y + w2 * u.z;
        LaneTwist { linear: self.force.solve(force) - given, angular: u }
    }
}

/// The strain of a section with one cable, [`Reduced::solve`], and in which lanes there is one; adds the stretch of the cable.
#[inline(always)]
pub(super) fn one_cable<S: Simd>(
    simd: S,
    at: &Reduced,
    tension: Lanes<S>,
    stretches: &mut Vec<Lanes<S>>,
) -> (LaneTwist<S>, LaneMask<S>) {
    let (w, c) = (LaneVec3::splat(simd, at.w), LaneVec3::splat(simd, at.c));
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (met, folded) = (Lanes::splat(simd, MET), Lanes::splat(simd, FOLDED));
    let size = Lanes::splat(simd, at.size);
    let relative = tension * at.per_size;
    let higher =
        tension * relative * (Lanes::splat(simd, 1.5 * at.spread) - relative * 2.0 * at.skew);
    let mut stretch = (size - tension * at.mean + higher).at_least(FOLDED);
    let mut iteration = 0;
    let (t, change, solved) = loop {
        let inverse = LaneVec3::new(
            one / (stretch + tension * c.x),
            one / (stretch + tension * c.y),
            one / (stretch + tension * c.z),
        );
        let t = w.scale(inverse);
        let squares = t.scale(t);
        let squared = squares.x + squares.y + squares.z;
        let error = squared.sqrt() - 1.0;
        let firsts = squares.scale(inverse);
        let first = firsts.x + firsts.y + firsts.z;
        let per_first = one / first;
        let change = squared * per_first * error;
        let there = error.abs().at_most(met);
        iteration += 1;
        if !met.below(error.abs()).any() || iteration == one_cable::MAX_ITERATIONS {
            let bend = firsts.dot(inverse) * per_first - first;
            // What folds has no tension left to pull the cable straight; a NaN is no answer.
            let solved = there.and(folded.below(stretch).or(zero.at_most(error)));
            let change = change + change * 1.5 * change * bend;
            let factor = |x: Lanes<S>| (one - x) * (one + x * x);
            let x = inverse * change;
            let factors = LaneVec3::new(factor(x.x), factor(x.y), factor(x.z));
            break (t.scale(factors), change, solved);
        }
        // Lanes that are there stay where they are.
        stretch = there.select(stretch, (stretch + change).at_least(FOLDED));
    };
    stretches.push(stretch + change);
    let (radial, r) = (at.radial, at.offset);
    let pull = LaneVec3::new(t.x * radial.x - t.y * radial.y, t.x * radial.y + t.y * radial.x, t.z)
        * tension;
    let moment = LaneVec3::splat(simd, r).cross(pull);
    let strain = LaneTwist {
        linear: LaneVec3::splat(simd, at.linear) - pull.scale(LaneVec3::splat(simd, at.soft.shear)),
        angular: LaneVec3::splat(simd, at.angular)
            - moment.scale(LaneVec3::splat(simd, at.soft.bending)),
    };
    (strain, solved)
}
