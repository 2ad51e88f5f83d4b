//! The state of a rod under loads, and the stages of the method that integrates it.

use whipcord_numerics::{UnitQuaternion, Vec3};

/// Of the Runge–Kutta method, Butcher's of order 5.
pub(crate) const STAGES: usize = 6;
/// Which of the places of [`crate::statics::grid::SHOOTING_NODES`] each stage uses.
pub(crate) const NODE_OF_STAGE: [usize; STAGES] = [0, 1, 1, 2, 3, 4];
/// Stages at the start, in the middle and at the end of a step.
pub(crate) const SAMPLED_STAGES: [usize; 3] = [0, 3, 5];

/// Which of the places of [`crate::statics::grid::SHOOTING_NODES`] they sit at.
pub(crate) const SAMPLED_NODES: [usize; 3] = [0, 2, 4];

/// Quaternion (w, x, y, z), position and moment, all in one frame; or their derivatives.
pub(crate) type State = [f64; 10];

#[inline(always)]
pub(crate) fn pack(rotation: UnitQuaternion, position: Vec3, moment: Vec3) -> State {
    let (q, p, m) = (rotation, position, moment);
    [q.w, q.v.x, q.v.y, q.v.z, p.x, p.y, p.z, m.x, m.y, m.z]
}

/// Rotation, scaled back to a unit quaternion, position and moment.
#[inline(always)]
pub(crate) fn unpack(
    &[w, x, y, z, px, py, pz, mx, my, mz]: &State,
) -> (UnitQuaternion, Vec3, Vec3) {
    let rotation = UnitQuaternion { w, v: Vec3::new(x, y, z) }.renormalized();
    (rotation, Vec3::new(px, py, pz), Vec3::new(mx, my, mz))
}

/// The state after the step `h` along the weighted slopes.
#[inline(always)]
pub(crate) fn advance(start: &State, slopes: &[State], weights: &[f64; STAGES], h: f64) -> State {
    let mut out = *start;
    for (slope, &weight) in slopes.iter().zip(weights) {
        if weight != 0.0 {
            let f = h * weight;
            for (x, rate) in out.iter_mut().zip(slope) {
                *x += f * rate;
            }
        }
    }
    out
}
