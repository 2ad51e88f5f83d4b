//! The frames of a rod between the ends of its integration steps.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

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
                Place::Within(Inside { start, end, strains, length, part })
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

/// A cross-section within a step, at a part of its length in m.
struct Inside<'a> {
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
    fn new(start: &Pose, end: &Pose, [first, middle, last]: &[Strain; 3], h: f64) -> Self {
        // `p′ = R v` and `p″ = R (u × v + v′)`, with v′ from the parabola through the three strains.
        let slopes = [
            (middle.linear * 4.0 - first.linear * 3.0 - last.linear) * (1.0 / h),
            (first.linear - middle.linear * 4.0 + last.linear * 3.0) * (1.0 / h),
        ];
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

impl Inside<'_> {
    fn position(&self) -> Vec3 {
        Curve::new(self.start, self.end, self.strains, self.length).position(self.part)
    }

    fn rotation(&self) -> UnitQuaternion {
        let Self { start, end, strains: [first, _, last], length: h, part: t } = *self;
        let turn = (start.rotation.conjugate() * end.rotation).log();
        // The rate of the rotation vector at the end: the inverse of the right Jacobian.
        let across = turn.cross(last.angular);
        let rates = [
            first.angular * h,
            (last.angular + across * 0.5 + turn.cross(across) * (1.0 / 12.0)) * h,
        ];
        let (t2, u) = (t * t, 1.0 - t);
        let vector = rates[0] * (t * u * u) + turn * (t2 * (3.0 - 2.0 * t)) - rates[1] * (t2 * u);
        (start.rotation * UnitQuaternion::exp(vector)).renormalized()
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
    fn ends_of_steps_are_themselves() {
        let dense = rod(5);
        for (&end, pose) in dense.ends.iter().zip(&dense.poses) {
            assert_eq!(dense.pose(end), *pose);
        }
    }
}
