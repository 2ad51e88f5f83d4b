//! The paper's eqs. (1) and (2) as they are printed.
//!
//! They compare the couplers of disk i with those of disk i−1, and leave the chord of the backbone
//! free. Their minimum has a closed form (`docs/theory/four-bar.md`, "Why not eq. (1) literally"):
//! the disk turns until its hole is in the plane of the hole below and the backbone, and the
//! section is a planar four-bar linkage at the least rotation φ of its coupler,
//! `a₀² + a₁² − 2a₀a₁ cos φ = (l_a − l₀)²`.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::length::Passage;
use super::plane::Vec2;

/// Why the equations have no solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unsolvable {
    /// A hole lies in the centre, so that a coupler has no direction.
    Centre,
    /// Lengths from the first to the second can be had.
    Length(f64, f64),
}

/// Pose of the upper disk in the frame of the lower one, for a section whose backbone has the
/// length `l0` and whose cable is to have the length `target`.
pub(super) fn solve(l0: f64, passage: &Passage, target: f64) -> Result<Pose, Unsolvable> {
    let (a0, a1) = (passage.from.norm(), passage.to.norm());
    if a0.min(a1) <= 1e-9 * passage.initial {
        return Err(Unsolvable::Centre);
    }
    let (e0, e1) = (passage.from * (1.0 / a0), passage.to * (1.0 / a1));
    let change = target - l0;
    let (least, most) = ((a1 - a0).abs(), a0 + a1);
    if change.abs() > most || target < 0.0 {
        return Err(Unsolvable::Length((l0 - most).max(0.0), l0 + most));
    }
    // Twist that brings the hole above that of the lower disk.
    let cos_sin = (e0.dot(e1), e1.quarter().dot(e0));
    let twist = Vec3::Z * cos_sin.1.atan2(cos_sin.0);
    let across = Vec3::new(e0.y, -e0.x, 0.0);
    let (angle, link) = if change.abs() <= least {
        // The couplers stay parallel; the link tilts as the length demands. Couplers of the same
        // length leave the tilt open, and upright is nearest to the shape before actuation.
        let difference = a1 - a0;
        let tilt = if difference == 0.0 {
            0.0
        } else {
            let squares = target * target - l0 * l0 - difference * difference;
            (squares / (2.0 * l0 * difference)).clamp(-1.0, 1.0)
        };
        (0.0, (e0 * tilt).with((1.0 - tilt * tilt).sqrt()))
    } else {
        // sin²(φ/2), without the cancellation that cos φ would suffer.
        let share = (change * change - least * least) / (4.0 * a0 * a1);
        let angle = 2.0 * share.min(1.0).sqrt().asin() * change.signum();
        // The link is in line with the cable: l₀d + w has the length l₀ ± ‖w‖.
        let (sin, cos) = angle.sin_cos();
        let w: Vec3 = (e0 * (a1 * cos - a0)).with(a1 * sin);
        (angle, w * (change.signum() / w.norm()))
    };
    Ok(Pose {
        position: link * l0,
        rotation: UnitQuaternion::exp(across * angle) * UnitQuaternion::exp(twist),
    })
}

/// Pose at the fraction `t` of the rigid link, with the rotation growing uniformly.
pub(super) fn part(pose: Pose, t: f64) -> Pose {
    Pose { position: pose.position * t, rotation: UnitQuaternion::exp(pose.rotation.log() * t) }
}

/// Length of the cable between the two disks.
pub(super) fn length(pose: Pose, passage: &Passage) -> f64 {
    let flat = |hole: Vec2| hole.with(0.0);
    (pose.transform(flat(passage.to)) - flat(passage.from)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(a: Vec3, b: Vec3) -> f64 {
        a.cross(b).norm().atan2(a.dot(b))
    }

    /// The sum of the paper's eq. (1) for the six variables x₀ and x_a, with x_b from its eq. (2).
    fn printed(passage: &Passage, x0: Vec3, xa: Vec3) -> f64 {
        let below = passage.from.with(0.0);
        let b = |arm: Vec3, chord: Vec3| arm.cross(chord);
        let (a, c) = (below, b(below, Vec3::Z));
        angle(a, xa - x0).powi(2) + angle(c, b(xa - x0, x0)).powi(2)
    }

    /// A point of the sphere of radius 1 from two numbers in [0, 1].
    fn sphere(u: f64, v: f64) -> Vec3 {
        let (z, angle) = (2.0 * u - 1.0, core::f64::consts::TAU * v);
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * angle.cos(), r * angle.sin(), z)
    }

    /// Least value of it over couplers on a grid and, for each, the chords that meet the
    /// constraints.
    fn least_on_grid(l0: f64, passage: &Passage, target: f64) -> f64 {
        let a1 = passage.to.norm();
        let mut best = f64::INFINITY;
        let n = 60;
        for i in 0..=n {
            for j in 0..n {
                let coupler = sphere(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)) * a1;
                // ‖l₀d + w‖ = l_a is a circle of directions d about w.
                let w = coupler - passage.from.with(0.0);
                let cos = (target * target - l0 * l0 - w.norm_squared()) / (2.0 * l0 * w.norm());
                if w.norm() == 0.0 || cos.abs() > 1.0 {
                    continue;
                }
                let axis = w / w.norm();
                let other = if axis.x.abs() < 0.8 { Vec3::X } else { Vec3::Y };
                let u = axis.cross(other);
                let (u, v) = (u / u.norm(), axis.cross(u / u.norm()));
                let sin = (1.0 - cos * cos).sqrt();
                for k in 0..n {
                    let t = core::f64::consts::TAU * f64::from(k) / f64::from(n);
                    let d = axis * cos + (u * t.cos() + v * t.sin()) * sin;
                    best = best.min(printed(passage, d * l0, d * l0 + coupler));
                }
            }
        }
        best
    }

    fn passage(a0: f64, a1: f64, turn: f64) -> Passage {
        let to = Vec2::new(a1 * turn.cos(), a1 * turn.sin());
        Passage::new(0, 1.0, Vec2::new(a0, 0.0), to, 1.0)
    }

    #[test]
    fn meets_the_constraints_and_no_point_of_a_grid_is_better() {
        for (a0, a1, turn) in [(0.4, 0.4, 0.0), (0.4, 0.4, 0.5), (0.5, 0.3, -0.9), (0.2, 0.6, 2.0)]
        {
            let passage = passage(a0, a1, turn);
            for shortening in [0.0, 0.1, 0.3, 0.45, -0.1] {
                let target = passage.initial * (1.0 - shortening);
                let pose = solve(1.0, &passage, target).unwrap();
                assert!((length(pose, &passage) - target).abs() < 1e-14);
                assert!((pose.position.norm() - 1.0).abs() < 1e-14);
                let (x0, xa) = (pose.position, pose.transform(passage.to.with(0.0)));
                let least = printed(&passage, x0, xa);
                let grid = least_on_grid(1.0, &passage, target);
                assert!(least <= grid + 1e-12, "{a0} {a1} {turn} {shortening}: {least} {grid}");
                // A grid of 6° comes near.
                assert!(grid <= least + 0.05 + 0.2 * least.sqrt(), "{least} {grid}");
                // The disk is the frame of its two couplers.
                let b = pose.rotation.rotate(passage.to.quarter().with(0.0) * -1.0);
                assert!(angle(b, (xa - x0).cross(x0)) < 1e-7);
            }
        }
    }

    #[test]
    fn lengths_out_of_reach_and_central_holes_are_refused() {
        let section = passage(0.2, 0.3, 0.4);
        assert_eq!(solve(1.0, &section, 0.49), Err(Unsolvable::Length(0.5, 1.5)));
        assert!(solve(1.0, &section, 0.51).is_ok());
        assert_eq!(solve(1.0, &passage(0.0, 0.3, 0.4), 1.0), Err(Unsolvable::Centre));
    }
}
