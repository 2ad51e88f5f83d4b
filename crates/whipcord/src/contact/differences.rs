//! Differences by the motions of a cross-section or of an object.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

/// Of the differences, relative to the part that touches, and in rad.
const STEP: f64 = 1e-5;

/// Central differences by the first so many motions of a cross-section, of something that is smooth and quick and does
/// not change with the others.
pub(super) fn differences<const N: usize>(
    motions: usize,
    pose: &Pose,
    reach: f64,
    value: impl Fn(&Pose) -> [Vec3; N],
) -> [[Vec3; N]; 6] {
    let size = reach.max(1e-9);
    core::array::from_fn(|b| {
        if b >= motions {
            return [Vec3::ZERO; N];
        }
        let mut axis = [0.0; 3];
        axis[b % 3] = 1.0;
        let h = if b < 3 { STEP * size } else { STEP };
        let at = |h: f64| {
            let change = Vec3::from(axis) * h;
            value(&if b < 3 {
                Pose { position: pose.position + change, ..*pose }
            } else {
                Pose { rotation: UnitQuaternion::exp(change) * pose.rotation, ..*pose }
            })
        };
        let (after, before) = (at(h), at(-h));
        core::array::from_fn(|k| (after[k] - before[k]) / (2.0 * h))
    })
}
