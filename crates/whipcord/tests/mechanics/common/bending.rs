//! What studies of random robots by their bending share.

use core::f64::consts::PI;

use whipcord::{Case, InternalState, Model, Robot, Solution, Vec3, Wrench};

use super::{ball, bending_stiffness, samples};

/// Robots are sorted by how far they bend, of 180°, into so many classes.
pub const CLASSES: usize = 6;

/// How far the backbone turns from disk to disk, summed up, in rad.
pub fn turning(solution: &Solution) -> f64 {
    let tangent = |i: usize| solution.disks.poses[i].rotation.rotate(Vec3::Z);
    let angle = |i: usize| {
        let (a, b) = (tangent(i - 1), tangent(i));
        a.cross(b).norm().atan2(a.dot(b))
    };
    (1..solution.disks.poses.len()).map(angle).sum()
}

/// The class of a robot that bends like this.
pub fn class(alone: &Solution) -> usize {
    ((turning(alone) / PI * CLASSES as f64) as usize).min(CLASSES - 1)
}

/// How far robot number `n` is to be bent, in rad: every size of bending comes equally often.
pub fn target(n: usize) -> f64 {
    PI * ((n as f64 + 0.5) * 0.618_033_988_749_895).fract()
}

/// What tensions are multiplied by so that a robot bent like this comes nearer to the target.
pub fn towards(target: f64, solution: &Solution) -> f64 {
    (target / turning(solution).max(0.05)).clamp(0.3, 3.0)
}

/// Whether a model finds an equilibrium that the robot stays in, from any of so many wrenches at the base
/// of a shape.
pub fn stable_from_afar(
    model: &Model,
    robot: &Robot,
    case: &Case,
    shape: &Solution,
    starts: usize,
) -> bool {
    let mut prepared = model.prepare(robot, &case.loads).unwrap();
    let length = robot.backbone().length;
    let unit = bending_stiffness(robot) / length;
    samples((ball(), ball()), starts).any(|(moment, force)| {
        let wrench = Wrench { force: force * (5.0 * unit / length), moment: moment * (8.0 * unit) };
        let near = Solution {
            base_wrench: Some(wrench),
            internal: InternalState::default(),
            ..shape.clone()
        };
        prepared.solve(case, Some(&near)).is_ok_and(|found| !found.diagnostics.is_unstable())
    })
}
