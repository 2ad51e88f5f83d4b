//! [`crate::section::one_cable`] in lanes.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneMask, LaneTwist, LaneVec3, Lanes};

use crate::section::one_cable::{MAX_ITERATIONS, MET, NEAR, Reduced};
use crate::section::{Crossing, FOLDED, Section};
use crate::statics::section_table::Row;

/// [`Reduced`] in each lane.
#[derive(Clone, Copy)]
pub(crate) struct LaneReduced<S: Simd> {
    linear: LaneVec3<S>,
    angular: LaneVec3<S>,
    offset: LaneVec3<S>,
    radial: [Lanes<S>; 2],
    w: LaneVec3<S>,
    c: LaneVec3<S>,
    size: Lanes<S>,
    per_size: Lanes<S>,
    mean: Lanes<S>,
    spread: Lanes<S>,
    skew: Lanes<S>,
    shear: LaneVec3<S>,
    bending: LaneVec3<S>,
}

/// [`crate::section::one_cable::OneCable`] in each lane.
pub(crate) struct LaneOneCable<S: Simd> {
    pub strain: LaneTwist<S>,
    pub stretch: Lanes<S>,
    pub stretch_by_tension: Lanes<S>,
    /// In which lanes there is an answer.
    pub is_solved: LaneMask<S>,
}

/// A section in each lane that one cable crosses and that is equally stiff about x and y.
#[derive(Clone, Copy)]
pub(crate) struct LaneCrossed<S: Simd> {
    /// Compliances.
    pub shear: LaneVec3<S>,
    pub bending: LaneVec3<S>,
    pub rest_curvature: LaneVec3<S>,
    /// Of the cable, without a z component, and the unit vector along it.
    pub offset: LaneVec3<S>,
    pub slope: LaneVec3<S>,
    pub radial: [Lanes<S>; 2],
}

impl<S: Simd> LaneCrossed<S> {
    /// The same in each lane.
    #[inline(always)]
    pub fn splat(simd: S, section: &Section, crossing: &Crossing) -> Self {
        let vector = |v: Vec3| LaneVec3::splat(simd, v);
        let Crossing { offset, slope, radial } = *crossing;
        Self {
            shear: vector(section.compliance.shear),
            bending: vector(section.compliance.bending),
            rest_curvature: vector(section.rest_curvature),
            offset: vector(offset),
            slope: vector(slope),
            radial: [Lanes::splat(simd, radial.x), Lanes::splat(simd, radial.y)],
        }
    }
}

impl<S: Simd> LaneReduced<S> {
    /// The same section in each lane.
    #[inline(always)]
    pub fn splat(simd: S, at: &Reduced) -> Self {
        let vector = |v: Vec3| LaneVec3::splat(simd, v);
        let number = |x: f64| Lanes::splat(simd, x);
        Self {
            linear: vector(at.linear),
            angular: vector(at.angular),
            offset: vector(at.offset),
            radial: [number(at.radial.x), number(at.radial.y)],
            w: vector(at.w),
            c: vector(at.c),
            size: number(at.size),
            per_size: number(at.per_size),
            mean: number(at.mean),
            spread: number(at.spread),
            skew: number(at.skew),
            shear: vector(at.soft.shear),
            bending: vector(at.soft.bending),
        }
    }

    /// The sections of as many slots as there are lanes, from one of these rows on.
    #[inline(always)]
    pub fn load(simd: S, rows: &[Row; Reduced::NUMBERS], first: usize) -> Self {
        let number = |i: usize| Lanes::load(simd, &rows[i], first);
        let vector = |i: usize| LaneVec3::new(number(i), number(i + 1), number(i + 2));
        Self {
            linear: vector(0),
            angular: vector(3),
            offset: vector(6),
            radial: [number(9), number(10)],
            w: vector(11),
            c: vector(14),
            size: number(17),
            per_size: number(18),
            mean: number(19),
            spread: number(20),
            skew: number(21),
            shear: vector(22),
            bending: vector(25),
        }
    }

    /// [`Reduced::of`] sections under a wrench in each lane.
    #[inline(always)]
    pub fn under(simd: S, of: &LaneCrossed<S>, [force, moment]: [LaneVec3<S>; 2]) -> Self {
        let one = Lanes::splat(simd, 1.0);
        let LaneCrossed { shear, bending, rest_curvature, offset: r, slope, radial: [x, y] } = *of;
        let linear = LaneVec3::splat(simd, Vec3::Z) + shear.scale(force);
        let angular = rest_curvature + bending.scale(moment);
        let free = linear + angular.cross(r) + slope;
        let w = LaneVec3::new(free.x * x + free.y * y, free.y * x - free.x * y, free.z);
        let squared_radius = r.x * r.x + r.y * r.y;
        let c = LaneVec3::new(
            shear.x,
            shear.x + squared_radius * bending.z,
            shear.z + squared_radius * bending.x,
        );
        let squares = w.scale(w);
        let c_squared = c.scale(c);
        let size_squared = squares.x + squares.y + squares.z;
        let (size, share) = (size_squared.sqrt(), one / size_squared);
        let mean = squares.dot(c) * share;
        let second = squares.dot(c_squared) * share;
        let third = squares.dot(c_squared.scale(c)) * share;
        let mean_squared = mean * mean;
        Self {
            linear,
            angular,
            offset: r,
            radial: of.radial,
            w,
            c,
            size,
            per_size: size * share,
            mean,
            spread: second - mean_squared,
            skew: third - mean * (second * 3.0 - mean_squared * 2.0),
            shear,
            bending,
        }
    }

    /// [`Reduced::solve`].
    #[inline(always)]
    pub fn solve(&self, simd: S, tension: Lanes<S>) -> LaneOneCable<S> {
        let Self { w, c, size, .. } = *self;
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let (met, folded) = (Lanes::splat(simd, MET), Lanes::splat(simd, FOLDED));
        let near = Lanes::splat(simd, NEAR);
        let relative = tension * self.per_size;
        let higher = tension * relative * (self.spread * 1.5 - relative * 2.0 * self.skew);
        let mut stretch = (size - tension * self.mean + higher).at_least(FOLDED);
        let mut iteration = 0;
        let (t, inverse, change, is_solved) = loop {
            let inverse = LaneVec3::new(
                one / (stretch + tension * c.x),
                one / (stretch + tension * c.y),
                one / (stretch + tension * c.z),
            );
            let t = w.scale(inverse);
            let squares = t.scale(t);
            let squared = squares.x + squares.y + squares.z;
            let excess = squared - 1.0;
            let series = excess * (Lanes::splat(simd, 0.5) - excess * 0.125);
            let error = if near.below(excess.abs()).any() {
                excess.abs().at_most(near).select(series, squared.sqrt() - 1.0)
            } else {
                series
            };
            let firsts = squares.scale(inverse);
            let first = firsts.x + firsts.y + firsts.z;
            let per_first = one / first;
            let change = squared * per_first * error;
            let there = error.abs().at_most(met);
            iteration += 1;
            if !met.below(error.abs()).any() || iteration == MAX_ITERATIONS {
                let bend = firsts.dot(inverse) * per_first - first;
                // What folds has no tension left to pull the cable straight; a NaN is no answer.
                let is_solved = there.and(folded.below(stretch).or(zero.at_most(error)));
                let change = change + change * 1.5 * change * bend;
                let factor = |x: Lanes<S>| (one - x) * (one + x * x);
                let x = inverse * change;
                let factors = LaneVec3::new(factor(x.x), factor(x.y), factor(x.z));
                break (t.scale(factors), inverse.scale(factors), change, is_solved);
            }
            // Lanes that are there stay where they are.
            stretch = there.select(stretch, (stretch + change).at_least(FOLDED));
        };
        let scaled = t.scale(inverse);
        let stretch_by_tension = -scaled.dot(t.scale(c)) / scaled.dot(t);
        let ([x, y], r) = (self.radial, self.offset);
        let pull = LaneVec3::new(t.x * x - t.y * y, t.x * y + t.y * x, t.z) * tension;
        let moment = r.cross(pull);
        let strain = LaneTwist {
            linear: self.linear - pull.scale(self.shear),
            angular: self.angular - moment.scale(self.bending),
        };
        LaneOneCable { strain, stretch: stretch + change, stretch_by_tension, is_solved }
    }
}
