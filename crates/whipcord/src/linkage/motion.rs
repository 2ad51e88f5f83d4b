//! How a section moves: from its coordinates to the frame of the disk at its end, with two derivatives.

use core::array;

use whipcord_numerics::{Mat3, Pose, UnitQuaternion, Vec3};

use super::division::{Bend, Division};
use super::swing::{Swing, arc_over_chord};

/// Coordinates of a section at most: its twist, and two bends of each joint.
pub(super) const MOST: usize = 7;
const JOINTS: usize = (MOST - 1) / 2;

/// Coordinates of a section in rad: the twist `ψ`, then `(b_x, b_y)` of each joint. Unused ones are zero.
pub(super) type Coordinates = [f64; MOST];

/// A section at some coordinates, in the frame of the disk at its start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    /// How the disk at the end is turned.
    pub rotation: Mat3,
    /// Where it is, in m.
    pub end: Vec3,
    /// By what each coordinate turns it, `ω_a`.
    pub turn: [Vec3; MOST],
    /// By what each coordinate moves it, `p_a = ∂p/∂q_a`, in m.
    pub shift: [Vec3; MOST],
    /// The part of the section's length at which it ends, 1 for the whole section.
    reach: f64,
    /// Each joint: the frame before it, its rotation, and from where on what it bends is rigid.
    joints: [(Mat3, Swing, Vec3); JOINTS],
}

/// The rotation about z.
fn about_z(angle: f64) -> Mat3 {
    let (sin, cos) = angle.sin_cos();
    Mat3::from_rows(Vec3::new(cos, -sin, 0.0), Vec3::new(sin, cos, 0.0), Vec3::Z)
}

impl Motion {
    /// Of a section of this length, eq. (1).
    pub fn new(division: &Division, length: f64, q: &Coordinates) -> Self {
        Self::up_to(division, length, q, 1.0)
    }

    /// Of the cross-section at a fraction `t` of a section of this length, eq. (9).
    pub fn up_to(division: &Division, length: f64, q: &Coordinates, t: f64) -> Self {
        let half = about_z(0.5 * q[0]);
        let mut motion = Self { reach: t, ..Self::default() };
        let mut frame = half;
        let whole = t >= 1.0;
        let mut left = if whole { f64::INFINITY } else { t };
        let mut place = Vec3::Z * (left.min(division.first) * length);
        left -= division.first;
        for (k, joint) in division.joints.iter().enumerate() {
            if left <= 0.0 {
                break;
            }
            let part = (left / joint.link).min(1.0);
            let (x, y) = (q[1 + 2 * k], q[2 + 2 * k]);
            let swing = match division.bend {
                Bend::Point => Swing::new(x, y),
                Bend::Arc => Swing::new(part * x, part * y).of_part(part),
                Bend::Chord => Swing::new(part * x, part * y).of_part(part).with_chord(x, y),
            };
            let reached = part * joint.link * length;
            left -= joint.link;
            let before = frame;
            frame = frame * swing.rotation;
            let link = joint.link * length;
            // What a joint moves is rigid beyond its place, what an arc does beyond its end.
            let rigid = if division.is_arc() { place + before * swing.arc * link } else { place };
            place = if division.is_arc() { rigid } else { place + frame.column(2) * reached };
            motion.joints[k] = (before, swing, rigid);
        }
        motion.end = place;
        motion.rotation = frame * if whole { half } else { about_z((t - 0.5) * q[0]) };
        for k in 0..division.joints.len() {
            let (before, swing, rigid) = motion.joints[k];
            for c in 0..2 {
                let turn = before * swing.turn[c];
                let mut shift = turn.cross(place - rigid);
                if division.is_arc() {
                    shift += before * swing.arc_by[c] * (division.joints[k].link * length);
                }
                (motion.turn[1 + 2 * k + c], motion.shift[1 + 2 * k + c]) = (turn, shift);
            }
        }
        motion.turn[0] = Vec3::Z * 0.5 + frame.column(2) * (t - 0.5);
        motion.shift[0] = Vec3::Z.cross(place) * 0.5;
        motion
    }

    /// `M·∂ω_a/∂q_b + F·∂p_a/∂q_b` by rows, eq. (5).
    pub fn second(
        &self,
        division: &Division,
        length: f64,
        moment: Vec3,
        force: Vec3,
    ) -> [[f64; MOST]; MOST] {
        let count = division.coordinates();
        let normal = self.rotation.column(2) * (self.reach - 0.5);
        let mut by = [[0.0; MOST]; MOST];
        for a in 0..count {
            for b in 0..count {
                let (turn, shift) = match (a, b) {
                    (0, 0) => {
                        (Vec3::Z.cross(normal) * 0.5, Vec3::Z.cross(Vec3::Z.cross(self.end)) * 0.25)
                    }
                    (0, b) => (self.turn[b].cross(normal), Vec3::Z.cross(self.shift[b]) * 0.5),
                    (a, 0) => {
                        (Vec3::Z.cross(self.turn[a]) * 0.5, Vec3::Z.cross(self.shift[a]) * 0.5)
                    }
                    (a, b) => self.of_joints(division, length, a - 1, b - 1),
                };
                by[a][b] = moment.dot(turn) + force.dot(shift);
            }
        }
        by
    }

    /// `∂ω_a/∂q_b` and `∂p_a/∂q_b` of bends, counted without the twist.
    fn of_joints(&self, division: &Division, length: f64, a: usize, b: usize) -> (Vec3, Vec3) {
        let (joint, other) = (a / 2, b / 2);
        let (turn_a, turn_b) = (self.turn[1 + a], self.turn[1 + b]);
        if other < joint {
            return (turn_b.cross(turn_a), turn_b.cross(self.shift[1 + a]));
        }
        if other > joint {
            return (Vec3::ZERO, turn_a.cross(self.shift[1 + b]));
        }
        let (before, swing, rigid) = &self.joints[joint];
        let beyond = self.end - *rigid;
        let turn = *before * swing.turn_by[a % 2][b % 2];
        let mut shift = turn.cross(beyond) + turn_a.cross(turn_b.cross(beyond));
        if division.is_arc() {
            let link = division.joints[joint].link * length;
            shift += *before * swing.arc_by_twice[a % 2][b % 2] * link;
        }
        (turn, shift)
    }
}

/// The frame at a fraction `t` of a section of this length. The twist grows evenly.
pub(super) fn pose_at(division: &Division, length: f64, q: &Coordinates, t: f64) -> Pose {
    let about_z = |angle: f64| UnitQuaternion::exp(Vec3::Z * angle);
    let half = 0.5 * q[0];
    let along = |reach: f64| Pose { position: Vec3::Z * reach, ..Pose::IDENTITY };
    let mut pose = Pose { rotation: about_z(half), ..Pose::IDENTITY };
    let mut left = t;
    if !division.is_arc() {
        let reach = left.min(division.first);
        pose = pose * along(reach * length);
        left -= reach;
    }
    for (k, joint) in division.joints.iter().enumerate() {
        if left <= 0.0 {
            break;
        }
        let bend = Vec3::new(q[1 + 2 * k], q[2 + 2 * k], 0.0);
        if division.is_arc() {
            let part = (left / joint.link).min(1.0);
            let stretch = match division.bend {
                Bend::Chord => arc_over_chord(bend.norm_squared())[0],
                Bend::Point | Bend::Arc => 1.0,
            };
            let linear = Vec3::Z * (part * joint.link * length * stretch);
            pose = pose * Pose::exp(whipcord_numerics::Twist { linear, angular: bend * part });
        } else {
            let swing = Pose { rotation: UnitQuaternion::exp(bend), ..Pose::IDENTITY };
            // The last link ends the section, whatever rounding has left of it.
            let last = k + 1 == division.joints.len();
            let reach = if last { left } else { left.min(joint.link) };
            pose = pose * swing * along(reach * length);
        }
        left -= joint.link;
    }
    let rotation = pose.rotation * about_z(half * (2.0 * t - 1.0));
    Pose { rotation: rotation.renormalized(), ..pose }
}

/// Coordinates of a section whose end is turned like this; bends are shared out between the joints as one
/// moment would.
pub(super) fn coordinates_of(division: &Division, rotation: UnitQuaternion) -> Coordinates {
    let [w, x, y, z] = rotation.wxyz();
    let [w, x, y, z] = if w < 0.0 { [-w, -x, -y, -z] } else { [w, x, y, z] };
    // The half twists before and after leave the part of the quaternion across z as it is.
    let across = x.hypot(y);
    let bend = 2.0 * across.atan2(w.hypot(z));
    let scale = if across > 0.0 { bend / across } else { 2.0 };
    let shares = division.shares();
    array::from_fn(|a| match a {
        0 => 2.0 * z.atan2(w),
        a if a < division.coordinates() => {
            shares[(a - 1) / 2] * scale * if a % 2 == 1 { x } else { y }
        }
        _ => 0.0,
    })
}

/// A section that bends by more than this in rad has folded: its disks would have met.
pub(super) const MOST_BENT: f64 = core::f64::consts::PI;

/// By how much in rad the joints of a section bend together.
pub(super) fn bend(q: &Coordinates) -> f64 {
    q[1..].chunks_exact(2).map(|joint| joint[0].hypot(joint[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::piecewise_constant_curvature::ARC;
    use crate::pseudo_rigid_body::Coefficients;

    fn divisions() -> [Division; 3] {
        [ARC, Division { bend: Bend::Chord, ..ARC }, Coefficients::default().division()]
    }

    const Q: Coordinates = [0.4, 0.3, -0.2, 0.15, 0.5, -0.4, 0.1];

    fn first(division: &Division, q: &Coordinates) -> Coordinates {
        array::from_fn(|a| if a < division.coordinates() { q[a] } else { 0.0 })
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let (length, step) = (0.03, 1e-6);
        let (moment, force) = (Vec3::new(0.3, -0.8, 0.5), Vec3::new(20.0, 30.0, -10.0));
        let places = [0.07, 0.2, 0.6, 0.93, 1.0];
        for (division, t) in divisions().iter().flat_map(|d| places.map(|t| (*d, t))) {
            let q = first(&division, &Q);
            let at = |b: usize, step: f64| {
                let mut q = q;
                q[b] += step;
                Motion::up_to(&division, length, &q, t)
            };
            let motion = at(0, 0.0);
            let pose = pose_at(&division, length, &q, t);
            assert!((pose.position - motion.end).max_abs() < 1e-16);
            let off = pose.rotation.to_matrix() - motion.rotation;
            assert!(off.rows.iter().all(|row| row.max_abs() < 1e-15));
            let second = motion.second(&division, length, moment, force);
            for b in 0..division.coordinates() {
                let (ahead, behind) = (at(b, step), at(b, -step));
                let slope = (ahead.end - behind.end) / (2.0 * step);
                assert!((slope - motion.shift[b]).max_abs() < 1e-10);
                let spin = (ahead.rotation - behind.rotation) * (0.5 / step);
                let off = spin - Mat3::skew(motion.turn[b]) * motion.rotation;
                assert!(off.rows.iter().all(|row| row.max_abs() < 1e-9));
                for a in 0..division.coordinates() {
                    let virtual_work = |m: &Motion| moment.dot(m.turn[a]) + force.dot(m.shift[a]);
                    let slope = (virtual_work(&ahead) - virtual_work(&behind)) / (2.0 * step);
                    assert!((slope - second[a][b]).abs() < 1e-8, "{a} {b}: {slope} {second:?}");
                }
            }
        }
    }

    #[test]
    fn a_section_ends_where_its_last_station_is() {
        for division in divisions() {
            let q = first(&division, &Q);
            let motion = Motion::new(&division, 0.03, &q);
            let [start, end] = [0.0, 1.0].map(|t| pose_at(&division, 0.03, &q, t));
            assert!((end.position - motion.end).max_abs() < 1e-16);
            let off = end.rotation.to_matrix() - motion.rotation;
            assert!(off.rows.iter().all(|row| row.max_abs() < 1e-15));
            assert!(start.position == Vec3::ZERO && start.rotation.log().norm() < 1e-15);
        }
        let q = first(&ARC, &Q);
        let back = coordinates_of(&ARC, pose_at(&ARC, 0.03, &q, 1.0).rotation);
        assert!(q.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14), "{back:?}");
    }
}
