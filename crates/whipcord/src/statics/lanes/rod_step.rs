//! A step of a rod under dead forces in each lane: eqs. (4) of [`crate::cosserat`] by Butcher's method.

use pulp::Simd;
use whipcord_numerics::BUTCHER_5;
use whipcord_numerics::lanes::{LanePose, LaneTwist, LaneVec3, Lanes};

use crate::statics::runge_kutta::STAGES;

/// A rod at a place in each lane.
#[derive(Clone, Copy)]
pub(crate) struct LaneState<S: Simd> {
    pub pose: LanePose<S>,
    /// In the base frame.
    pub moment: LaneVec3<S>,
}

/// The sections of a step in each lane.
pub(crate) trait StepSections<S: Simd> {
    /// The dead force at a stage, in the base frame.
    fn force(&self, simd: S, stage: usize) -> LaneVec3<S>;

    /// The strain at a stage, which is turned like this, under a force and a moment in the body frame.
    fn strain(
        &mut self,
        simd: S,
        stage: usize,
        rotation: &LanePose<S>,
        wrench: [LaneVec3<S>; 2],
    ) -> LaneTwist<S>;
}

/// The state at the end of a step of this length.
#[inline(always)]
pub(crate) fn advance<S: Simd>(
    simd: S,
    length: Lanes<S>,
    start: LaneState<S>,
    sections: &mut impl StepSections<S>,
) -> LaneState<S> {
    let zero = Lanes::splat(simd, 0.0);
    let null = LaneVec3::new(zero, zero, zero);
    let at_rest = LaneState { pose: LanePose { position: null, w: zero, v: null }, moment: null };
    let mut slopes = [at_rest; STAGES];
    for i in 0..STAGES {
        let mut stage = start;
        for (slope, &weight) in slopes[..i].iter().zip(&BUTCHER_5.a[i]) {
            if weight != 0.0 {
                stage = stage.plus(slope, length * weight);
            }
        }
        let rotation = stage.pose.unit();
        let force = sections.force(simd, i);
        let wrench = [rotation.to_body(force), rotation.to_body(stage.moment)];
        let strain = sections.strain(simd, i, &rotation, wrench);
        let velocity = rotation.to_base(strain.linear);
        let (w, v) = rotation.rate(strain.angular);
        let pose = LanePose { position: velocity, w, v };
        slopes[i] = LaneState { pose, moment: force.cross(velocity) };
    }
    let mut end = start;
    for (slope, &weight) in slopes.iter().zip(&BUTCHER_5.b) {
        if weight != 0.0 {
            end = end.plus(slope, length * weight);
        }
    }
    LaneState { pose: end.pose.unit(), ..end }
}

impl<S: Simd> LaneState<S> {
    /// The state this far along a slope.
    #[inline(always)]
    fn plus(self, slope: &Self, f: Lanes<S>) -> Self {
        let pose = LanePose {
            position: self.pose.position + slope.pose.position * f,
            w: self.pose.w + slope.pose.w * f,
            v: self.pose.v + slope.pose.v * f,
        };
        Self { pose, moment: self.moment + slope.moment * f }
    }
}
