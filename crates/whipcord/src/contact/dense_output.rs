//! The frames of a rod between the ends of its integration steps.

use core::ops::RangeInclusive;

use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use crate::derivatives::Caused;
use crate::section::Strain;

/// A rod as its steps leave it: frames at their ends, and strains at start, middle and end of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct DenseOutput {
    /// Arc lengths of the ends of all steps in m, one more than there are steps.
    pub ends: Vec<f64>,
    /// In the frame of the base.
    pub poses: Vec<Pose>,
    /// Of each step.
    pub strains: Vec<[Strain; 3]>,
}

impl DenseOutput {
    /// The frame of a cross-section: at the end of a step what integration has found, within it the polynomial of degree five
    /// through position, tangent and its derivative at both ends, and of degree three for the rotation vector.
    pub fn pose(&self, arc_length: f64) -> Pose {
        match self.find(arc_length) {
            Place::End(k) => self.poses.get(k).copied().unwrap_or_default(),
            Place::Within(inside) => {
                Pose { position: inside.position(), rotation: inside.rotation() }
            }
        }
    }

    /// The centre of a cross-section.
    pub fn centre(&self, arc_length: f64) -> Vec3 {
        match self.find(arc_length) {
            Place::End(k) => self.poses.get(k).map_or(Vec3::ZERO, |pose| pose.position),
            Place::Within(inside) => inside.position(),
        }
    }

    /// The centres of cross-sections at increasing arc lengths.
    pub fn centres(&self, arc_lengths: &[f64], into: &mut Vec<Vec3>) {
        into.clear();
        let (mut k, mut step) = (0, None);
        for &s in arc_lengths {
            while self.ends.get(k + 1).is_some_and(|&end| end < s) {
                (k, step) = (k + 1, None);
            }
            match (self.strains.get(k), self.poses.get(k..k + 2), self.ends.get(k..k + 2)) {
                (Some(strains), Some([start, end]), Some(&[from, to])) if from < s && s < to => {
                    let curve =
                        step.get_or_insert_with(|| Curve::new(start, end, strains, to - from));
                    into.push(curve.position((s - from) / (to - from)));
                }
                _ => into.push(self.centre(s)),
            }
        }
    }

    /// The ends of steps whose frames that of a cross-section hangs on.
    pub fn ends_beside(&self, arc_length: f64) -> RangeInclusive<usize> {
        match self.find(arc_length) {
            Place::End(k) => k..=k,
            Place::Within(Inside { k, .. }) => k..=k + 1,
        }
    }

    /// How a cross-section moves with what a cause changes, in the frame of the base; `None` within a step whose strains are not known.
    pub fn motion(&self, arc_length: f64, caused: &Caused<'_>) -> Option<Twist> {
        Some(match self.find(arc_length) {
            Place::End(k) => caused.node(k),
            Place::Within(inside) => {
                let k = inside.k;
                let ends = [k, k + 1].map(|node| caused.node(node));
                inside.motion(&ends, &caused.strains(k)?)
            }
        })
    }

    fn find(&self, arc_length: f64) -> Place<'_> {
        let after = self.ends.partition_point(|&end| end < arc_length);
        if after == 0 || self.ends.get(after) == Some(&arc_length) {
            return Place::End(after);
        }
        let k = after - 1;
        match (self.strains.get(k), self.poses.get(k..k + 2)) {
            (Some(strains), Some([start, end])) => {
                let length = self.ends[k + 1] - self.ends[k];
                let part = (arc_length - self.ends[k]) / length;
                Place::Within(Inside { k, start, end, strains, length, part })
            }
            // Beyond the tip.
            _ => Place::End(self.poses.len().saturating_sub(1)),
        }
    }
}

/// Where a cross-section is.
enum Place<'a> {
    /// At the end of a step.
    End(usize),
    Within(Inside<'a>),
}

/// A cross-section within step `k`, at a part of its length in m.
struct Inside<'a> {
    k: usize,
    start: &'a Pose,
    end: &'a Pose,
    strains: &'a [Strain; 3],
    length: f64,
    part: f64,
}

/// The curve of a step: positions at its ends, and the first and second derivatives there by the part of the step.
struct Curve {
    positions: [Vec3; 2],
    firsts: [Vec3; 2],
    seconds: [Vec3; 2],
}

impl Curve {
    fn new(start: &Pose, end: &Pose, strains: &[Strain; 3], h: f64) -> Self {
        let [first, _, last] = strains;
        // `p′ = R v` and `p″ = R (u × v + v′)`.
        let slopes = slopes(strains, h);
        let first_of = |pose: &Pose, strain: &Strain| pose.rotation.rotate(strain.linear * h);
        let second_of = |pose: &Pose, strain: &Strain, slope: Vec3| {
            pose.rotation.rotate((strain.angular.cross(strain.linear) + slope) * (h * h))
        };
        Self {
            positions: [start.position, end.position],
            firsts: [first_of(start, first), first_of(end, last)],
            seconds: [second_of(start, first, slopes[0]), second_of(end, last, slopes[1])],
        }
    }

    /// How it changes with motions of its ends and changes of its strains.
    fn change(&self, inside: &Inside<'_>, ends: &[Twist; 2], changes: &[Strain; 3]) -> Self {
        let Inside { start, end, strains, length: h, .. } = *inside;
        let slopes = slopes(changes, h);
        let of_end = |at: usize, pose: &Pose| {
            let (Strain { linear: v, angular: u }, by) = (strains[2 * at], changes[2 * at]);
            let turn = ends[at].angular;
            let bent = by.angular.cross(v) + u.cross(by.linear) + slopes[at];
            let first = turn.cross(self.firsts[at]) + pose.rotation.rotate(by.linear * h);
            let second = turn.cross(self.seconds[at]) + pose.rotation.rotate(bent * (h * h));
            (first, second)
        };
        let (at_start, at_end) = (of_end(0, start), of_end(1, end));
        Self {
            positions: ends.map(|end| end.linear),
            firsts: [at_start.0, at_end.0],
            seconds: [at_start.1, at_end.1],
        }
    }

    fn position(&self, t: f64) -> Vec3 {
        let (t2, u) = (t * t, 1.0 - t);
        let (t3, u2) = (t2 * t, u * u);
        let u3 = u2 * u;
        self.positions[0] * (u3 * (1.0 + 3.0 * t + 6.0 * t2))
            + self.firsts[0] * (t * u3 * (1.0 + 3.0 * t))
            + self.seconds[0] * (0.5 * t2 * u3)
            + self.positions[1] * (t3 * (1.0 + 3.0 * u + 6.0 * u2))
            - self.firsts[1] * (u * t3 * (1.0 + 3.0 * u))
            + self.seconds[1] * (0.5 * u2 * t3)
    }
}

/// `v′` at start and end of a step, from the parabola through its three strains.
fn slopes([first, middle, last]: &[Strain; 3], h: f64) -> [Vec3; 2] {
    [
        (middle.linear * 4.0 - first.linear * 3.0 - last.linear) * (1.0 / h),
        (first.linear - middle.linear * 4.0 + last.linear * 3.0) * (1.0 / h),
    ]
}

impl Inside<'_> {
    fn curve(&self) -> Curve {
        Curve::new(self.start, self.end, self.strains, self.length)
    }

    fn position(&self) -> Vec3 {
        self.curve().position(self.part)
    }

    /// The rotation from start to end.
    fn turned(&self) -> UnitQuaternion {
        self.start.rotation.conjugate() * self.end.rotation
    }

    /// The rotation vector of the cross-section, as seen from the start.
    fn rotation_vector(&self) -> Vec3 {
        let turn = self.turned().log();
        let [first, _, last] = self.strains.map(|strain| strain.angular * self.length);
        // The rate of the rotation vector at the end: the inverse of the right Jacobian.
        let across = turn.cross(last);
        self.mix(turn, [first, last + across * 0.5 + turn.cross(across) * (1.0 / 12.0)])
    }

    fn rotation(&self) -> UnitQuaternion {
        (self.start.rotation * UnitQuaternion::exp(self.rotation_vector())).renormalized()
    }

    /// The polynomial of degree three from nothing to a value, with these rates at both ends.
    fn mix(&self, value: Vec3, rates: [Vec3; 2]) -> Vec3 {
        let t = self.part;
        let (t2, u) = (t * t, 1.0 - t);
        rates[0] * (t * u * u) + value * (t2 * (3.0 - 2.0 * t)) - rates[1] * (t2 * u)
    }

    /// How the cross-section moves with motions of the ends of the step and changes of its strains.
    fn motion(&self, ends: &[Twist; 2], changes: &[Strain; 3]) -> Twist {
        let linear = self.curve().change(self, ends, changes).position(self.part);
        let (turned, to_start) = (self.turned(), self.start.rotation.conjugate());
        let turn = turned.log();
        // `V⁻¹` and `V` of the logarithm and exponential of SE(3) are the Jacobians of those of SO(3).
        let against = to_start.rotate(ends[1].angular - ends[0].angular);
        let by_turn = Pose { position: against, rotation: turned }.log().linear;
        let [first, _, last] = changes.map(|change| change.angular * self.length);
        let at_end = self.strains[2].angular * self.length;
        let across = turn.cross(at_end);
        let by_across = by_turn.cross(at_end) + turn.cross(last);
        let twice = by_turn.cross(across) + turn.cross(by_across);
        let rates = [first, last + by_across * 0.5 + twice * (1.0 / 12.0)];
        let vector = Twist { linear: self.mix(by_turn, rates), angular: self.rotation_vector() };
        let angular = ends[0].angular + self.start.rotation.rotate(Pose::exp(vector).position);
        Twist { linear, angular }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::{Twist, magnus_6};

    /// A rod whose strains vary along it, in so many steps.
    fn rod(steps: usize) -> DenseOutput {
        let strain = |s: f64| Strain {
            linear: Vec3::new(0.01 * s, -0.02 * (1.0 - s), 1.0 - 0.03 * s * s),
            angular: Vec3::new(0.7 * (2.0 * s).cos(), 1.1 - s, 0.4 * s * s),
        };
        let h = 1.0 / steps as f64;
        let mut dense =
            DenseOutput { ends: vec![0.0], poses: vec![Pose::IDENTITY], ..Default::default() };
        for k in 0..steps {
            let start = k as f64 * h;
            let mut pose = dense.poses[k];
            let fine = h / 16.0;
            for j in 0..16 {
                let from = start + j as f64 * fine;
                let nodes = whipcord_numerics::GAUSS_3.nodes.map(|node| {
                    let Strain { linear, angular } = strain(from + node * fine);
                    Twist { linear: linear * fine, angular: angular * fine }
                });
                pose = pose * magnus_6(&nodes);
            }
            dense.poses.push(pose);
            dense.ends.push(start + h);
            dense.strains.push([0.0, 0.5, 1.0].map(|t| strain(start + t * h)));
        }
        dense
    }

    #[test]
    fn it_is_exact_to_the_sixth_order() {
        let exact = rod(240);
        let off = |steps: usize| {
            let dense = rod(steps);
            let apart = |&s: &f64| {
                let (a, b) = (dense.pose(s), exact.pose(s));
                let turn = (a.rotation.conjugate() * b.rotation).log().norm();
                [(a.position - b.position).norm(), turn]
            };
            let places = exact.ends.iter().map(apart);
            places.fold([0.0, 0.0], |worst, [p, r]| [f64::max(worst[0], p), f64::max(worst[1], r)])
        };
        let (coarse, fine) = (off(6), off(12));
        assert!(fine[0] < 2e-8 && fine[1] < 1e-5, "{fine:?}");
        // v′ is known to the second order, and the rotation vector to the fourth.
        assert!(coarse[0] / fine[0] > 12.0 && coarse[1] / fine[1] > 12.0, "{coarse:?} {fine:?}");
    }

    #[test]
    fn centres_are_those_of_the_frames() {
        let dense = rod(5);
        let places: Vec<f64> = (0..=64).map(|k| f64::from(k) / 64.0).chain([1.0]).collect();
        let mut centres = Vec::new();
        dense.centres(&places, &mut centres);
        let of_frames: Vec<Vec3> = places.iter().map(|&s| dense.pose(s).position).collect();
        assert_eq!(centres, of_frames);
    }

    #[test]
    fn motions_are_those_of_differences() {
        let dense = rod(3);
        let vector = |seed: f64| Vec3::new(seed.sin(), (2.3 * seed).cos(), (3.1 * seed).sin());
        let twist = |seed: f64| Twist { linear: vector(seed), angular: vector(seed + 0.4) };
        let (ends, changes) = ([twist(1.0), twist(2.0)], [twist(3.0), twist(4.0), twist(5.0)]);
        let moved = |h: f64| {
            let mut dense = dense.clone();
            for (pose, by) in dense.poses[1..].iter_mut().zip(&ends) {
                pose.position += by.linear * h;
                pose.rotation = UnitQuaternion::exp(by.angular * h) * pose.rotation;
            }
            for (strain, by) in dense.strains[1].iter_mut().zip(&changes) {
                *strain = *strain + *by * h;
            }
            dense
        };
        let h = 1e-4;
        for part in [0.01, 0.3, 0.5, 0.8, 0.99] {
            let s = (1.0 + part) / 3.0;
            assert_eq!(dense.ends_beside(s), 1..=2);
            let Place::Within(inside) = dense.find(s) else { panic!("{s} is within a step") };
            let found = inside.motion(&ends, &changes);
            let [after, before] = [h, -h].map(|h| moved(h).pose(s));
            let linear = (after.position - before.position) / (2.0 * h);
            let turn = after.rotation * before.rotation.conjugate();
            let off = [found.linear - linear, found.angular - turn.log() / (2.0 * h)];
            assert!(off.iter().all(|off| off.norm() < 1e-7), "{part}: {off:?}");
        }
    }

    #[test]
    fn ends_of_steps_are_themselves() {
        let dense = rod(5);
        for (&end, pose) in dense.ends.iter().zip(&dense.poses) {
            assert_eq!(dense.pose(end), *pose);
        }
    }
}
