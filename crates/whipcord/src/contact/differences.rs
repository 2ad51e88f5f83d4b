//! Differences by the motions of a cross-section or of an object.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

/// Of the differences, relative to the part that touches, and in rad.
const STEP: f64 = 1e-5;
/// Of differences from a value that is known.
const ONE_SIDED: f64 = 1e-6;

/// Central differences by the first so many motions of a cross-section, of something that is smooth and quick and does
/// not change with the others.
pub(super) fn differences<const N: usize>(
    motions: usize,
    pose: &Pose,
    reach: f64,
    value: impl Fn(&Pose) -> [Vec3; N],
) -> [[Vec3; N]; 6] {
    by_motions(motions, pose, reach, None, value)
}

/// [`differences`] from the value at the pose to one side: half of the work, and a relative error of 1e-6.
pub(super) fn one_sided<const N: usize>(
    motions: usize,
    pose: &Pose,
    reach: f64,
    known: [Vec3; N],
    value: impl Fn(&Pose) -> [Vec3; N],
) -> [[Vec3; N]; 6] {
    by_motions(motions, pose, reach, Some(known), value)
}

fn by_motions<const N: usize>(
    motions: usize,
    pose: &Pose,
    reach: f64,
    known: Option<[Vec3; N]>,
    value: impl Fn(&Pose) -> [Vec3; N],
) -> [[Vec3; N]; 6] {
    let step = if known.is_some() { ONE_SIDED } else { STEP };
    let size = reach.max(1e-9);
    core::array::from_fn(|b| {
        if b >= motions {
            return [Vec3::ZERO; N];
        }
        let mut axis = [0.0; 3];
        axis[b % 3] = 1.0;
        let h = if b < 3 { step * size } else { step };
        let at = |h: f64| {
            let change = Vec3::from(axis) * h;
            value(&if b < 3 {
                Pose { position: pose.position + change, ..*pose }
            } else {
                Pose { rotation: UnitQuaternion::exp(change) * pose.rotation, ..*pose }
            })
        };
        let after = at(h);
        let (before, h) = known.map_or_else(|| (at(-h), 2.0 * h), |known| (known, h));
        core::array::from_fn(|k| (after[k] - before[k]) / h)
    })
}
