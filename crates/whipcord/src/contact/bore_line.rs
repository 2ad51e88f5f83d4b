//! The line from the base of a robot through the bore of a pipe and straight on, along which the robot can be laid.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use crate::obstacle::{Form, Obstacle, Pipe};

/// Into so many parts of equal length a robot is divided along the line.
const PARTS: usize = 240;

/// How the axis of a robot that is laid along the line turns from part to part.
#[derive(Clone, Debug)]
pub(super) struct BoreLine {
    /// Length in m of a part.
    part: f64,
    /// Rotation vectors in rad from each part to the next, in the axes of the first, without torsion.
    turns: Vec<Vec3>,
}

impl BoreLine {
    /// Of a robot of a length in m whose base is at the origin and points along z, in a pipe or before it; `None` of another obstacle.
    pub fn new(obstacle: &Obstacle, length: f64) -> Option<Self> {
        let Form::Pipe(pipe) = &obstacle.form else { return None };
        let line = ahead_of_base(pipe, &obstacle.pose);
        let part = length / PARTS as f64;
        let mut turns = Vec::with_capacity(PARTS);
        let (mut rotation, mut tangent) = (UnitQuaternion::IDENTITY, Vec3::Z);
        let (mut from, mut to) = (Vec3::ZERO, 0);
        let mut before = Vec3::ZERO;
        for _ in 0..PARTS {
            // To the next point of the line that is a part farther from here.
            let mut left = part;
            while let Some(&point) = line.get(to) {
                let way = (point - from).norm();
                if way > left {
                    from += (point - from) * (left / way);
                    left = 0.0;
                    break;
                }
                (from, left, to) = (point, left - way, to + 1);
            }
            from += tangent * left;
            let chord = from - before;
            before = from;
            let size = chord.norm();
            let next = if size > 0.0 { chord / size } else { tangent };
            let turn = rotation.conjugate().rotate(turn_between(tangent, next));
            turns.push(turn);
            rotation = rotation * UnitQuaternion::exp(turn);
            tangent = next;
        }
        Some(Self { part, turns })
    }

    /// Poses at these arc lengths in m, in ascending order, of a robot that is bent by this part of what the line is.
    pub fn poses(&self, bent: f64, arc_lengths: impl Iterator<Item = f64>) -> Vec<Pose> {
        let mut pose = Pose::IDENTITY;
        let mut parts = self.turns.iter();
        let mut passed = 0.0;
        let poses = arc_lengths.map(|s| {
            while passed + 0.5 * self.part < s
                && let Some(&turn) = parts.next()
            {
                let rotation = pose.rotation * UnitQuaternion::exp(turn * bent);
                let position = pose.position + rotation.rotate(Vec3::Z) * self.part;
                pose = Pose { position, rotation: rotation.renormalized() };
                passed += self.part;
            }
            let ahead = pose.rotation.rotate(Vec3::Z) * (s - passed);
            Pose { position: pose.position + ahead, ..pose }
        });
        poses.collect()
    }
}

/// The points of the middle of a pipe that are ahead of a base at the origin, as it comes to them.
fn ahead_of_base(pipe: &Pipe, pose: &Pose) -> Vec<Vec3> {
    let (samples, tangents) = pipe.middle();
    let mut points: Vec<Vec3> = samples.iter().map(|&point| pose.transform(point)).collect();
    let from_base = |&k: &usize| points[k].norm_squared();
    let nearest = (0..points.len()).min_by(|a, b| from_base(a).total_cmp(&from_base(b)));
    let nearest = nearest.unwrap_or(0);
    let is_last = nearest + 1 == points.len();
    let leads_back = pose.rotation.rotate(tangents[nearest]).z < 0.0;
    if is_last || nearest > 0 && leads_back {
        points.truncate(nearest + 1);
        points.reverse();
    } else {
        points.drain(..nearest);
    }
    // What is beside the base or behind it is passed already.
    let passed = points.iter().take_while(|point| point.z <= 0.0).count();
    points.drain(..passed);
    points
}

/// The rotation vector in rad of the shortest turn from a unit vector to another.
fn turn_between(from: Vec3, to: Vec3) -> Vec3 {
    let across = from.cross(to);
    let sin = across.norm();
    if sin == 0.0 {
        return Vec3::ZERO;
    }
    across * (sin.atan2(from.dot(to)) / sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obstacle::Bends;

    fn quarter() -> Obstacle {
        let radius = 0.08;
        let mut points = vec![Vec3::new(0.0, 0.0, -0.02), Vec3::ZERO];
        for k in 1..=9 {
            let (sin, cos) = (f64::from(k) * core::f64::consts::PI / 18.0).sin_cos();
            points.push(Vec3::new(radius * (1.0 - cos), 0.0, radius * sin));
        }
        let form = Form::Pipe(Pipe::new(0.003, &points, Bends::Smooth).unwrap());
        Obstacle {
            name: "bore".to_owned(),
            form,
            pose: Pose::IDENTITY,
            friction: 0.0,
            movable: None,
        }
    }

    #[test]
    fn a_robot_is_laid_along_the_middle_and_straight_on() {
        let (bore, length) = (quarter(), 0.2);
        let line = BoreLine::new(&bore, length).unwrap();
        let at: Vec<f64> = (0..=20).map(|k| length * f64::from(k) / 20.0).collect();
        let poses = line.poses(1.0, at.iter().copied());
        for pose in &poses[..13] {
            let off = 0.003 - bore.surface(pose.position).distance;
            assert!(off < 2e-5, "{off}");
        }
        let end = poses[20];
        assert!((end.rotation.rotate(Vec3::Z) - Vec3::X).norm() < 2e-2);
        for (pair, s) in poses.windows(2).zip(at.windows(2)) {
            let chord = (pair[1].position - pair[0].position).norm();
            assert!((chord / (s[1] - s[0]) - 1.0).abs() < 1e-3);
        }
        // Not bent at all, and by half.
        let tip = line.poses(0.0, core::iter::once(length))[0];
        assert!((tip.position - Vec3::Z * length).norm() < 1e-12);
        let half = line.poses(0.5, core::iter::once(length))[0];
        let turned = half.rotation.rotate(Vec3::Z).x.asin();
        assert!((turned - core::f64::consts::FRAC_PI_4).abs() < 1e-2, "{turned}");
    }

    #[test]
    fn a_line_that_is_given_from_its_far_end_is_the_same() {
        let bore = quarter();
        let Form::Pipe(pipe) = &bore.form else { unreachable!() };
        let mut points = pipe.points().to_vec();
        points.reverse();
        let form = Form::Pipe(Pipe::new(0.003, &points, Bends::Smooth).unwrap());
        let reversed = Obstacle { form, ..bore.clone() };
        let tip = |bore: &Obstacle| {
            BoreLine::new(bore, 0.15).unwrap().poses(1.0, core::iter::once(0.15))[0].position
        };
        assert!((tip(&bore) - tip(&reversed)).norm() < 1e-6);
        assert!(BoreLine::new(&Obstacle { form: Form::HalfSpace, ..bore }, 0.15).is_none());
    }
}
