//! One cross-section without load in each lane.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneLdlt3, LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::equilibrium::{STEP_TOLERANCE, UNDAMPED, reach};
use crate::section::one_cable::{self, MET, Reduced};
use crate::section::{Crossing, FOLDED, Section, Stiffness};

/// A section that any number of cables cross: [`crate::section`] in lanes.
#[derive(Clone, Debug)]
pub(super) struct Several {
    stiffness: Stiffness,
    /// Diagonal of the Hessian's block of forces without cables: infinite on an axis that is held.
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
    /// Beyond the three before, of which the first two have these weights, see [`super::super::unloaded::extrapolation`].
    Beyond([f64; 2]),
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

#[inline(always)]
fn stretched<S: Simd>(simd: S, crossing: &Crossing, strain: &LaneTwist<S>) -> LaneVec3<S> {
    let (r, slope) = (crossing.offset, crossing.slope);
    let (v, u) = (strain.linear, strain.angular);
    LaneVec3::new(v.x - u.z * r.y, v.y + u.z * r.x, v.z + (u.x * r.y - u.y * r.x))
        + LaneVec3::splat(simd, slope)
}

#[inline(always)]
fn pull<S: Simd>(simd: S, crossing: &Crossing, strain: &LaneTwist<S>) -> LanePull<S> {
    let tangent = stretched(simd, crossing, strain);
    let stretch = tangent.norm();
    let t = tangent * (Lanes::splat(simd, 1.0) / stretch);
    let r = crossing.offset;
    let angular = LaneVec3::new(t.z * r.y, -(t.z * r.x), t.y * r.x - t.x * r.y);
    LanePull { linear: t, angular, stretch }
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

    /// The strain from those of the three sections before, and in which lanes there is one; adds the stretches of the
    /// cables.
    #[inline(always)]
    pub fn solve<S: Simd>(
        &self,
        simd: S,
        before: &[LaneTwist<S>; 3],
        tensions: &[Lanes<S>],
        stretches: &mut Vec<Lanes<S>>,
    ) -> (LaneTwist<S>, LaneMask<S>) {
        let [a, b, c] = *before;
        let mut strain = match self.guess {
            Guess::Rest => LaneTwist {
                linear: LaneVec3::splat(simd, Vec3::Z),
                angular: LaneVec3::splat(simd, self.rest_curvature),
            },
            Guess::Last => c,
            Guess::Beyond([wa, wb]) => c + (a - c) * wa + (b - c) * wb,
        };
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let tolerance = Lanes::splat(simd, STEP_TOLERANCE);
        let mut running = zero.at_most(one);
        let mut met = one.at_most(zero);
        for _ in 0..UNDAMPED {
            let (step, definite) = self.newton_step(simd, tensions, &strain);
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
            let size = step.linear.max_abs().max(step.angular.max_abs() * self.reach);
            running = running.and(definite);
            met = met.or(running.and(size.at_most(tolerance)));
            running = running.and(tolerance.below(size)).and(size.at_most(one));
            if !running.any() {
                break;
            }
        }
        for crossing in &self.crossings {
            stretches.push(stretched(simd, crossing, &strain).norm());
        }
        (strain, met)
    }

    #[inline(always)]
    fn newton_step<S: Simd>(
        &self,
        simd: S,
        tensions: &[Lanes<S>],
        strain: &LaneTwist<S>,
    ) -> (LaneTwist<S>, LaneMask<S>) {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        let dv = strain.linear - LaneVec3::splat(simd, Vec3::Z);
        let du = strain.angular - LaneVec3::splat(simd, self.rest_curvature);
        let Stiffness { shear, bending } = self.stiffness;
        let mut force = null - LaneVec3::splat(simd, shear).scale(dv);
        let mut moment = null - LaneVec3::splat(simd, bending).scale(du);
        let mut hessian = LaneHessian::of(simd, self);
        for (crossing, &tension) in self.crossings.iter().zip(tensions) {
            let pull = pull(simd, crossing, strain);
            force = force - pull.linear * tension;
            moment = moment - pull.angular * tension;
            hessian.add(crossing.offset, &pull, tension / pull.stretch);
        }
        let tangent = hessian.factor(simd);
        (tangent.solve(force, moment), tangent.definite)
    }

    /// Bending stiffness at a strain when forces are held, and in which lanes there is one.
    #[inline(always)]
    pub fn reduced<S: Simd>(
        &self,
        simd: S,
        tensions: &[Lanes<S>],
        strain: &LaneTwist<S>,
    ) -> (LaneSym3<S>, LaneMask<S>) {
        let mut hessian = LaneHessian::of(simd, self);
        for (crossing, &tension) in self.crossings.iter().zip(tensions) {
            let pull = pull(simd, crossing, strain);
            hessian.add(crossing.offset, &pull, tension / pull.stretch);
        }
        let tangent = hessian.factor(simd);
        (tangent.reduced, tangent.definite)
    }
}

impl<S: Simd> LaneHessian<S> {
    #[inline(always)]
    fn of(simd: S, section: &Several) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        let diagonal = |d: Vec3| LaneSym3 {
            xx: Lanes::splat(simd, d.x),
            yx: zero,
            yy: Lanes::splat(simd, d.y),
            zx: zero,
            zy: zero,
            zz: Lanes::splat(simd, d.z),
        };
        Self { a: diagonal(section.pivots), b: [null; 3], c: diagonal(section.stiffness.bending) }
    }

    #[inline(always)]
    fn add(&mut self, r: Vec3, pull: &LanePull<S>, k: Lanes<S>) {
        let (t, m) = (pull.linear, pull.angular);
        let (kt, km) = (t * k, m * k);
        let (krx, kry) = (k * r.x, k * r.y);
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
        let rr = krx * r.x + kry * r.y;
        let c = &mut self.c;
        c.xx = c.xx + (rr - krx * r.x - km.x * m.x);
        c.yx = c.yx - (kry * r.x + km.y * m.x);
        c.yy = c.yy + (rr - kry * r.y - km.y * m.y);
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
