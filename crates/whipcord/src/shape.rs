//! Frames along the backbone.

use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use crate::robot::Route;

/// Frames along the backbone, in the frame that the pose of the base is given in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// Arc length of each station on the undeformed backbone in m.
    pub arc_length: Vec<f64>,
    /// Pose of the cross-section at each station. The sign of the quaternions is continuous along
    /// the backbone, from that of the base.
    pub poses: Vec<Pose>,
}

/// A force in N and a moment in N·m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force.
    pub force: Vec3,
    /// Moment.
    pub moment: Vec3,
}

impl Wrench {
    /// `self += f · other`.
    pub(crate) fn add(&mut self, f: f64, other: &Self) {
        self.force += other.force * f;
        self.moment += other.moment * f;
    }

    /// Product of the components.
    pub(crate) fn dot(&self, other: &Self) -> f64 {
        self.force.dot(other.force) + self.moment.dot(other.moment)
    }
}

impl Shape {
    /// Takes frames relative to a base, which has this pose, at these arc lengths; in the memory that it has.
    pub(crate) fn set(
        &mut self,
        arc_lengths: &[f64],
        poses: impl Iterator<Item = Pose>,
        base: Pose,
    ) {
        self.arc_length.clear();
        self.arc_length.extend_from_slice(arc_lengths);
        self.poses.clear();
        self.poses.extend(poses);
        self.turn(base);
    }

    /// Puts it on a base of this pose, when it is now given in the frame of its base.
    pub(crate) fn turn(&mut self, base: Pose) {
        // No rounding where there is nothing to do.
        if base != Pose::IDENTITY {
            self.poses.iter_mut().for_each(|pose| *pose = base * *pose);
        }
    }

    /// A straight backbone along z, unstretched and untwisted, at these arc lengths.
    #[must_use]
    pub fn straight(arc_lengths: &[f64]) -> Self {
        let pose = |&s: &f64| Pose { position: Vec3::new(0.0, 0.0, s), ..Pose::IDENTITY };
        Self { arc_length: arc_lengths.to_vec(), poses: arc_lengths.iter().map(pose).collect() }
    }

    /// The same shape on a base of this pose, when it is now given in the frame of its base.
    #[must_use]
    pub fn moved(mut self, base: Pose) -> Self {
        self.turn(base);
        self
    }

    /// Length in m of a cable that runs straight from station to station, as a real one does
    /// between the holes of the disks. `None` when it is anchored where there is no station.
    #[must_use]
    pub fn hole_to_hole_length(&self, route: &Route) -> Option<f64> {
        let anchor = self.arc_length.iter().position(|&s| s == route.end())?;
        let hole = |i: usize| self.poses[i].transform(route.at(self.arc_length[i]).offset);
        Some((1..=anchor).map(|i| (hole(i) - hole(i - 1)).norm()).sum())
    }

    /// Positions of the stations in m.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.poses.iter().map(|pose| pose.position)
    }

    /// The last pose, which is that of the tip when the stations reach it; the identity when
    /// there are no stations.
    #[must_use]
    pub fn tip(&self) -> Pose {
        self.poses.last().copied().unwrap_or_default()
    }

    /// Strains between each two stations, in the frame of the cross-section: the constant ones that lead
    /// from one frame to the next. Linear part: shear in x and y, and 1 plus the stretch; angular part:
    /// bending about x and y, and twist, in 1/m.
    pub fn strains(&self) -> impl Iterator<Item = Twist> + '_ {
        let lengths = self.arc_length.windows(2).map(|ends| ends[1] - ends[0]);
        let frames = self.poses.windows(2);
        frames.zip(lengths).map(|(ends, ds)| (ends[0].inverse() * ends[1]).log() * (1.0 / ds))
    }

    /// The shape from a base with constant strains along pieces of these lengths in m: the inverse of [`Self::strains`].
    #[must_use]
    pub fn of_strains(base: Pose, strains: &[Twist], lengths: &[f64]) -> Self {
        let (mut arc_length, mut poses) = (vec![0.0], vec![base]);
        let (mut s, mut pose) = (0.0, base);
        for (&strain, &length) in strains.iter().zip(lengths) {
            s += length;
            pose = pose * Pose::exp(strain * length);
            arc_length.push(s);
            poses.push(pose);
        }
        Self { arc_length, poses }
    }

    /// The frame at an arc length in m, clamped to the stations; the identity for a shape without stations.
    ///
    /// Between two stations the position follows the cubic whose end tangents are those of the strain between them
    /// ([`Self::strains`]): its error is of fourth order in the distance of the stations where stretch and shear vary slowly.
    /// The rotation turns about a fixed axis at a constant rate, with an error of second order.
    #[must_use]
    pub fn at(&self, arc_length: f64) -> Pose {
        let count = self.poses.len().min(self.arc_length.len());
        if count < 2 {
            return self.poses.first().copied().unwrap_or_default();
        }
        let i = self.arc_length[1..count - 1].partition_point(|&s| s <= arc_length);
        let cubic = Cubic::between([self.arc_length[i], self.arc_length[i + 1]], &self.poses[i..]);
        let t = cubic.part(arc_length);
        let turn = (cubic.start.rotation.conjugate() * cubic.end.rotation).log();
        let rotation = (cubic.start.rotation * UnitQuaternion::exp(turn * t)).renormalized();
        let position = cubic.position(t);
        Pose { position, rotation }
    }

    /// How the tangent at the last station leans from that at the first, seen from the first: the
    /// angle in rad from 0 to π, and the direction in rad from x towards y. For the disks that is the
    /// bend of the robot as its base sees it.
    #[must_use]
    pub fn bend(&self) -> (f64, f64) {
        let first = self.poses.first().copied().unwrap_or_default().rotation;
        let tangent = first.conjugate().rotate(self.tip().rotation.rotate(Vec3::Z));
        (tangent.x.hypot(tangent.y).atan2(tangent.z), tangent.y.atan2(tangent.x))
    }

    /// Distance between corresponding stations of two shapes in m.
    pub fn distances<'a>(&'a self, other: &'a Self) -> impl ExactSizeIterator<Item = f64> + 'a {
        self.poses.iter().zip(&other.poses).map(|(a, b)| (a.position - b.position).norm())
    }

    /// Root mean square of the distances in m, without the first station, which is fixed to the
    /// base: the paper's measure over disks 2 to 10.
    #[must_use]
    pub fn rms_distance(&self, other: &Self) -> f64 {
        let (count, sum) =
            self.distances(other).skip(1).fold((0_usize, 0.0), |(n, sum), d| (n + 1, sum + d * d));
        if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
    }
}

/// The positions between two stations, see [`Shape::at`].
struct Cubic {
    start: Pose,
    end: Pose,
    /// Arc length at the start, and from there to the end, in m.
    span: [f64; 2],
    /// Tangents at both ends, times the length between them.
    tangents: [Vec3; 2],
}

impl Cubic {
    /// Between the first two of these poses.
    fn between([from, to]: [f64; 2], poses: &[Pose]) -> Self {
        let (start, end) = (poses[0], poses[1]);
        let tangent = (start.inverse() * end).log().linear;
        let tangents = [start, end].map(|pose| pose.rotation.rotate(tangent));
        Self { start, end, span: [from, to - from], tangents }
    }

    /// The part of the way from start to end at an arc length, from 0 to 1.
    fn part(&self, arc_length: f64) -> f64 {
        let [from, ds] = self.span;
        if ds > 0.0 { ((arc_length - from) / ds).clamp(0.0, 1.0) } else { 0.0 }
    }

    fn position(&self, t: f64) -> Vec3 {
        let [from, to] = self.tangents;
        let (t2, t3) = (t * t, t * t * t);
        self.start.position * (2.0 * t3 - 3.0 * t2 + 1.0)
            + from * (t3 - 2.0 * t2 + t)
            + self.end.position * (3.0 * t2 - 2.0 * t3)
            + to * (t3 - t2)
    }
}

/// Positions at increasing arc lengths in m of a shape with poses at these ends of steps, as [`Shape::at`] has them.
pub(crate) fn positions_at(
    ends: &[f64],
    poses: &[Pose],
    arc_lengths: &[f64],
    into: &mut Vec<Vec3>,
) {
    into.clear();
    let mut next = 0;
    for k in 1..ends.len().min(poses.len()) {
        let is_last = k + 1 == ends.len().min(poses.len());
        let is_within = |s: &&f64| is_last || **s < ends[k];
        let within = arc_lengths[next..].iter().take_while(is_within).count();
        if within > 0 {
            let cubic = Cubic::between([ends[k - 1], ends[k]], &poses[k - 1..]);
            let of_step = &arc_lengths[next..next + within];
            into.extend(of_step.iter().map(|&s| cubic.position(cubic.part(s))));
            next += within;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Backbone, Cable, Disks, Robot, Routing};

    #[test]
    fn positions_along_a_shape_are_those_of_its_frames() {
        let strain =
            Twist { linear: Vec3::new(0.0, 0.1, 1.02), angular: Vec3::new(8.0, -5.0, 3.0) };
        let arc_length = vec![0.0, 0.01, 0.07, 0.2];
        let poses = arc_length.iter().map(|&s| Pose::exp(strain * s)).collect();
        let shape = Shape { arc_length, poses };
        let places = [0.0, 0.002, 0.01, 0.011, 0.0699, 0.07, 0.1, 0.2];
        let mut positions = vec![Vec3::X];
        positions_at(&shape.arc_length, &shape.poses, &places, &mut positions);
        let frames: Vec<Vec3> = places.iter().map(|&s| shape.at(s).position).collect();
        assert_eq!(positions, frames);
    }

    #[test]
    fn strains_of_a_helix_are_its_own() {
        let strain =
            Twist { linear: Vec3::new(0.0, 0.0, 1.02), angular: Vec3::new(8.0, -5.0, 3.0) };
        let base = Pose::exp(Twist { linear: Vec3::X, angular: Vec3::new(0.3, 1.0, -0.4) });
        let arc_length = vec![0.0, 0.01, 0.07, 0.2];
        let poses = arc_length.iter().map(|&s| base * Pose::exp(strain * s)).collect();
        let shape = Shape { arc_length, poses };
        assert_eq!(shape.strains().count(), 3);
        let strains: Vec<Twist> = shape.strains().collect();
        let again = Shape::of_strains(base, &strains, &[0.01, 0.06, 0.13]);
        for (found, expected) in again.poses.iter().zip(&shape.poses) {
            assert!((found.position - expected.position).norm() < 1e-15);
        }
        for found in shape.strains() {
            assert!((found.linear - strain.linear).max_abs() < 1e-13);
            assert!((found.angular - strain.angular).max_abs() < 1e-12);
        }
    }

    /// The greatest errors of position in m and rotation in rad between so many equal pieces of a helix.
    fn errors(pieces: usize, strain: Twist) -> [f64; 2] {
        let (base, length) = (Pose::exp(Twist { linear: Vec3::Y, angular: Vec3::X }), 0.2);
        let exact = |s: f64| base * Pose::exp(strain * s);
        let arc_length: Vec<f64> =
            (0..=pieces).map(|k| length * k as f64 / pieces as f64).collect();
        let poses = arc_length.iter().map(|&s| exact(s)).collect();
        let shape = Shape { arc_length, poses };
        (0..=1000).map(|k| length * f64::from(k) / 1000.0).fold([0.0, 0.0], |[p, r], s| {
            let (found, exact) = (shape.at(s), exact(s));
            let turn = (found.rotation.conjugate() * exact.rotation).log();
            [f64::max(p, (found.position - exact.position).norm()), f64::max(r, turn.norm())]
        })
    }

    #[test]
    fn between_stations_the_position_is_of_fourth_order() {
        let straight = Twist { linear: Vec3::new(0.0, 0.0, 1.05), angular: Vec3::ZERO };
        assert!(errors(3, straight)[0] < 1e-15);
        let arc = Twist { linear: Vec3::Z, angular: Vec3::new(5.0, 0.0, 0.0) };
        let helix = Twist { linear: Vec3::new(0.1, 0.0, 1.2), angular: Vec3::new(8.0, -5.0, 3.0) };
        for strain in [arc, helix] {
            let ([coarse, turned], [fine, _]) = (errors(5, strain), errors(10, strain));
            assert!(coarse < 2e-5 && turned < 1e-14, "{coarse:e} {turned:e}");
            assert!((coarse / fine - 16.0).abs() < 3.0, "{coarse:e} {fine:e}");
        }
    }

    #[test]
    fn beyond_its_ends_the_shape_is_at_them() {
        let shape = Shape::of_strains(
            Pose::IDENTITY,
            &[Twist { linear: Vec3::Z, angular: Vec3::X }; 4],
            &[0.1, 0.2, 0.0, 0.1],
        );
        assert_eq!(shape.at(-1.0), shape.poses[0]);
        let (tip, found) = (shape.tip(), shape.at(7.0));
        assert!((found.position - tip.position).norm() < 1e-16);
        assert!((found.rotation.conjugate() * tip.rotation).log().norm() < 1e-15);
        assert_eq!(Shape::default().at(0.1), Pose::IDENTITY);
        let single = Shape { arc_length: vec![0.0], poses: vec![tip] };
        assert_eq!(single.at(0.3), tip);
    }

    #[test]
    fn a_cable_through_holes_is_as_long_as_its_chords() {
        let disks = Disks::equally_spaced(0.09, 4, 0.01).with_holes(4);
        let cables = vec![
            Cable::new("turning", Routing::holes(vec![1, 2, 2, 3])),
            Cable::new("short", Routing::holes(vec![1, 1, 1])),
            Cable {
                ends_at: Some(0.05),
                ..Cable::new("between", Routing::Straight { angle: 0.0, radius: 0.01 })
            },
        ];
        let robot = Robot::new(Backbone::new(0.09), disks, cables).unwrap();
        let shape = Shape::straight(&robot.disks().arc_lengths);
        let length = |i: usize| shape.hole_to_hole_length(&robot.routes()[i]);
        // A quarter of a turn on a circle of 10 mm has a chord of √2 · 10 mm.
        let expected = 0.03 + 2.0 * (0.03_f64.powi(2) + 2.0 * 0.01_f64.powi(2)).sqrt();
        assert!((length(0).unwrap() - expected).abs() < 1e-15);
        assert!((length(1).unwrap() - 0.06).abs() < 1e-15);
        assert_eq!(length(2), None);
    }
}
