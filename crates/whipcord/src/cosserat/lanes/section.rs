//! One cross-section without load of many robots in each lane.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::one_cable::{self, MET, Reduced};
use crate::section::reach;
use crate::section::{Crossing, FOLDED, Section, Stiffness};
use crate::statics::lanes::section::{
    InLanes, LaneBare, LaneCrossing, equilibrium, reduced, response_at_rest,
};
use crate::statics::section_runs::WaveStart;

/// A section of many robots that any number of cables cross: [`crate::section`] in lanes.
#[derive(Clone, Debug)]
pub(super) struct Several {
    stiffness: Stiffness,
    pivots: Vec3,
    rest_curvature: Vec3,
    compliance: Stiffness,
    crossings: Vec<Crossing>,
    /// Unit tangent of each cable at rest, and `1/‖p′‖`.
    at_rest: Vec<(Vec3, f64)>,
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
    /// At its response to the tensions, and at what other sections of its run depart from theirs.
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

    /// Some robot in the lanes pulls it.
    #[inline(always)]
    fn is_slack(&self, _: usize) -> bool {
        false
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

    #[inline(always)]
    fn compliances(&self, simd: S) -> [LaneVec3<S>; 2] {
        let Stiffness { shear, bending } = self.section.compliance;
        [LaneVec3::splat(simd, shear), LaneVec3::splat(simd, bending)]
    }

    #[inline(always)]
    fn direction_at_rest(&self, simd: S, cable: usize) -> (LaneVec3<S>, Lanes<S>) {
        let (unit, per_stretch) = self.section.at_rest[cable];
        (LaneVec3::splat(simd, unit), Lanes::splat(simd, per_stretch))
    }
}

/// A section that was solved.
pub(super) struct Solved<S: Simd> {
    pub strain: LaneTwist<S>,
    /// From its response to the tensions, where it started there.
    pub departure: LaneTwist<S>,
    /// In which lanes there is a strain.
    pub is_solved: LaneMask<S>,
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
            compliance: section.compliance,
            crossings: crossings.to_vec(),
            at_rest: crossings.iter().map(|at| at.direction(&section.rest_strain())).collect(),
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

    /// The strain from those of the last three sections before, and from the departures of those of its run.
    #[inline(always)]
    pub fn solve<S: Simd>(
        &self,
        simd: S,
        before: &[LaneTwist<S>; 3],
        departures: &[LaneTwist<S>],
        tensions: &[Lanes<S>],
    ) -> Solved<S> {
        let [a, b, c] = *before;
        let pulled = Pulled { section: self, tensions };
        let mut response = c;
        let start = match &self.guess {
            Guess::Rest => LaneTwist {
                linear: LaneVec3::splat(simd, Vec3::Z),
                angular: LaneVec3::splat(simd, self.rest_curvature),
            },
            Guess::Last => c,
            Guess::Beyond([wa, wb]) => c + (a - c) * *wa + (b - c) * *wb,
            Guess::InRun(start) => {
                response = response_at_rest(&pulled, simd);
                match *start {
                    WaveStart::Response => response,
                    WaveStart::Between { nodes: [a, b, c, d], weights: [wb, wc, wd] } => {
                        let (of, a) = (departures, departures[a]);
                        let beside = (of[b] - a) * wb + (of[c] - a) * wc + (of[d] - a) * wd;
                        response + (a + beside)
                    }
                }
            }
        };
        let (strain, is_solved) = equilibrium(&pulled, simd, start);
        Solved { strain, departure: strain - response, is_solved }
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
