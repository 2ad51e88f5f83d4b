//! One cross-section without load of many robots in each lane.

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneMask, LaneSym3, LaneTwist, LaneVec3, Lanes};

use crate::section::reach;
use crate::section::{Crossing, Section, Stiffness};
use crate::statics::lanes::equilibrium::equilibrium_within;
use crate::statics::lanes::section::{
    InLanes, LaneBare, LaneCrossing, no_wrench, reduced, response_at_rest,
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
    wrench: [LaneVec3<S>; 2],
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
            wrench: self.wrench,
        }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>) {
        (LaneCrossing::splat(simd, &self.section.crossings[cable]), self.tensions[cable])
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

    /// The strain from those of the last three sections before, and from the departures of those of its run, to a last step of `tolerance`.
    #[inline(always)]
    pub fn solve<S: Simd>(
        &self,
        simd: S,
        before: &[LaneTwist<S>; 3],
        departures: &[LaneTwist<S>],
        tensions: &[Lanes<S>],
        tolerance: f64,
    ) -> Solved<S> {
        let [a, b, c] = *before;
        let pulled = Pulled { section: self, tensions, wrench: no_wrench(simd) };
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
        let (strain, is_solved) = equilibrium_within(tolerance, &pulled, simd, start);
        Solved { strain, departure: strain - response, is_solved }
    }

    /// The strain under a wrench from another one, and in which lanes there is one, likewise.
    #[inline(always)]
    pub fn under<S: Simd>(
        &self,
        simd: S,
        wrench: [LaneVec3<S>; 2],
        start: LaneTwist<S>,
        tensions: &[Lanes<S>],
        tolerance: f64,
    ) -> (LaneTwist<S>, LaneMask<S>) {
        equilibrium_within(tolerance, &Pulled { section: self, tensions, wrench }, simd, start)
    }

    /// Writes the stretches of its cables at a strain.
    #[inline(always)]
    pub fn stretches<S: Simd>(&self, simd: S, strain: &LaneTwist<S>, stretches: &mut [Lanes<S>]) {
        self::stretches(simd, &self.crossings, strain, stretches);
    }

    /// Bending stiffness at a strain when forces are held, and in which lanes there is one.
    #[inline(always)]
    pub fn reduced<S: Simd>(
        &self,
        simd: S,
        tensions: &[Lanes<S>],
        strain: &LaneTwist<S>,
    ) -> (LaneSym3<S>, LaneMask<S>) {
        reduced(&Pulled { section: self, tensions, wrench: no_wrench(simd) }, simd, strain)
    }
}

/// Writes the stretches of cables that cross like this at a strain.
#[inline(always)]
pub(super) fn stretches<S: Simd>(
    simd: S,
    crossings: &[Crossing],
    strain: &LaneTwist<S>,
    stretches: &mut [Lanes<S>],
) {
    for (crossing, stretch) in crossings.iter().zip(stretches) {
        *stretch = LaneCrossing::splat(simd, crossing).stretch(strain);
    }
}
