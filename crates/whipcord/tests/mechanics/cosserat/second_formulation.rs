//! The Cosserat model, which carries the total wrench along the rod, against the paper's eq. (3) in
//! strains and curvatures ([`oracle`]), on random robots.

use crate::common;
use crate::common::{Wildness, bending_stiffness};
use crate::oracle::{Answer, Frame, Oracle};
use whipcord::{Case, Pose, Robot, Shape, Vec3};

/// Of the length; of the scale of moments; in rad.
const TOLERANCE: f64 = 1e-8;

/// The oracle takes 20 times as long without optimisation.
const ROBOTS: usize = if cfg!(debug_assertions) { 8 } else { 40 };

/// The frame of the oracle at an arc length.
fn frame_at(answer: &Answer, arc_length: f64) -> &Frame {
    let away = |f: &&Frame| (f.arc_length - arc_length).abs();
    answer.frames.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
}

/// Distance in m and size of the difference of the rotation matrices.
fn pose_error(pose: &Pose, frame: &Frame) -> (f64, f64) {
    let rotation = pose.rotation.to_matrix() - frame.rotation;
    let size = rotation.rows.iter().map(|row| row.norm_squared()).sum::<f64>().sqrt();
    ((pose.position - frame.position).norm(), size)
}

struct Deviation {
    position: f64,
    rotation: f64,
    cable: f64,
    moment: f64,
    force: f64,
}

fn deviation(robot: &Robot, case: &Case) -> Deviation {
    let solution = common::solve(robot, case);
    let length = robot.backbone().length;
    let answer = Oracle::new(robot, case, &solution.shape.arc_length).solve(1e-10);
    let mut out = Deviation { position: 0.0, rotation: 0.0, cable: 0.0, moment: 0.0, force: 0.0 };
    let shapes: [&Shape; 2] = [&solution.shape, &solution.disks];
    for (s, pose) in shapes.iter().flat_map(|shape| shape.arc_length.iter().zip(&shape.poses)) {
        let (position, rotation) = pose_error(pose, frame_at(&answer, *s));
        out.position = out.position.max(position / length);
        out.rotation = out.rotation.max(rotation);
    }
    for (cable, expected) in solution.cables.iter().zip(&answer.lengths) {
        out.cable = out.cable.max((cable.length - expected).abs() / length);
    }
    let base = solution.base_wrench.unwrap();
    let moment = bending_stiffness(robot) / length;
    let relative = |a: Vec3, b: Vec3, scale: f64| (a - b).norm() / (scale + b.norm());
    out.moment = relative(base.moment, answer.base_moment, moment);
    out.force = relative(base.force, answer.base_force, moment / length);
    out
}

/// Solves `count` random robots both ways; the message has every one that differs.
fn compare(wild: Wildness, count: usize) {
    let mut failures = String::new();
    let mut worst: f64 = 0.0;
    for (i, (robot, case)) in common::samples(common::robot(wild), count).enumerate() {
        let off = deviation(&robot, &case);
        let Deviation { position, rotation, cable, moment, force } = off;
        let largest = [position, rotation, cable, moment, force].into_iter().fold(0.0, f64::max);
        worst = worst.max(largest);
        if largest.is_nan() || largest >= TOLERANCE {
            failures += &format!(
                "robot {i}: positions {position:.1e} L, frames {rotation:.1e}, lengths {cable:.1e} L, \
                 base moment {moment:.1e}, base force {force:.1e}\n"
            );
        }
    }
    assert!(failures.is_empty(), "the formulations differ:\n{failures}");
    println!("{count} robots: they differ by {worst:.1e} at most");
}

#[test]
fn both_formulations_agree_without_load() {
    compare(Wildness::UNLOADED, ROBOTS);
}

#[test]
fn both_formulations_agree_under_loads() {
    compare(Wildness::LOADED, ROBOTS);
}
