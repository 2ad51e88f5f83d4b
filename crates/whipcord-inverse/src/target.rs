//! What a robot is to reach, and how far an answer is from it.

use core::ops::ControlFlow;

use whipcord::derivatives::Place;
use whipcord::{Pose, Solution, Twist, Vec3};

use crate::error::{InverseError, TargetProblem};
use crate::linear::Linear;

/// What a robot is to reach, in the world frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A point for the tip, in m.
    Tip(Vec3),
    /// Position and orientation of the tip.
    Pose(Pose),
    /// The direction of the backbone's axis at the tip, and a point for the tip where one is given.
    Axis {
        /// A point for the tip, in m.
        point: Option<Vec3>,
        /// Along the tangent of the backbone, of any length.
        direction: Vec3,
    },
    /// Points for the centres of disks, by their numbers from 0 at the base, in m.
    Shape(Vec<(usize, Vec3)>),
}

/// How far an answer may be from its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Distance in m of every point.
    pub position: f64,
    /// Angle in rad.
    pub angle: f64,
}

impl Tolerance {
    /// 1e-5 of the length of a robot, and the angle that moves the tip so far at a third of that length.
    #[must_use]
    pub fn of_length(length: f64) -> Self {
        Self { position: 1e-5 * length, angle: 3e-5 }
    }
}

/// How far an answer is from a target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Miss {
    /// Largest distance of a point in m; 0 where no point is asked for.
    pub position: f64,
    /// Angle in rad; 0 where no direction is asked for.
    pub angle: f64,
}

impl Miss {
    /// Whether it is within a tolerance.
    #[must_use]
    pub fn is_within(&self, tolerance: Tolerance) -> bool {
        self.position <= tolerance.position && self.angle <= tolerance.angle
    }

    /// The greater of its parts, each as a multiple of its tolerance.
    #[must_use]
    pub fn relative(&self, tolerance: Tolerance) -> f64 {
        (self.position / tolerance.position).max(self.angle / tolerance.angle)
    }
}

impl Target {
    /// # Errors
    /// [`InverseError::Target`].
    pub(crate) fn check(&self, disks: usize) -> Result<(), InverseError> {
        let finite = |v: Vec3| v.to_array().iter().all(|x| x.is_finite());
        let (all_finite, problem) = match self {
            Self::Tip(point) => (finite(*point), None),
            Self::Pose(pose) => {
                let rotation = pose.rotation.wxyz().iter().all(|x| x.is_finite());
                (finite(pose.position) && rotation, None)
            }
            Self::Axis { point, direction } => {
                let is_zero = direction.norm() == 0.0;
                let problem = is_zero.then_some(TargetProblem::NoDirection);
                (point.is_none_or(finite) && finite(*direction), problem)
            }
            Self::Shape(points) => {
                let beyond = points.iter().find(|(disk, _)| *disk >= disks);
                let problem = match beyond {
                    _ if points.is_empty() => Some(TargetProblem::NoPoints),
                    Some(&(disk, _)) => {
                        Some(TargetProblem::NoSuchDisk { disk, last: disks.saturating_sub(1) })
                    }
                    None => None,
                };
                (points.iter().all(|(_, point)| finite(*point)), problem)
            }
        };
        match problem {
            _ if !all_finite => Err(InverseError::Target(TargetProblem::NotFinite)),
            Some(problem) => Err(InverseError::Target(problem)),
            None => Ok(()),
        }
    }

    /// The places whose motion its residuals depend on.
    pub(crate) fn places(&self) -> Vec<Place> {
        match self {
            Self::Shape(points) => points.iter().map(|(disk, _)| Place::Disk(*disk)).collect(),
            Self::Tip(_) | Self::Pose(_) | Self::Axis { .. } => vec![Place::Tip],
        }
    }

    /// How far a solution is from it.
    #[must_use]
    pub fn miss(&self, solution: &Solution) -> Miss {
        let Some(tip) = solution.disks.poses.last() else { return Miss::default() };
        match self {
            Self::Tip(point) => Miss { position: (tip.position - *point).norm(), angle: 0.0 },
            Self::Pose(pose) => Miss {
                position: (tip.position - pose.position).norm(),
                angle: (tip.rotation * pose.rotation.conjugate()).log().norm(),
            },
            Self::Axis { point, direction } => {
                let axis = tip.rotation.rotate(Vec3::new(0.0, 0.0, 1.0));
                let angle = axis.cross(*direction).norm().atan2(axis.dot(*direction));
                let position = point.map_or(0.0, |point| (tip.position - point).norm());
                Miss { position, angle }
            }
            Self::Shape(points) => {
                let distance = |(disk, point): &(usize, Vec3)| {
                    (solution.disks.poses[*disk].position - *point).norm()
                };
                Miss { position: points.iter().map(distance).fold(0.0, f64::max), angle: 0.0 }
            }
        }
    }

    /// The sum of the squares of the residuals in m², or what it is at least once it has got beyond `most`.
    pub(crate) fn squares(&self, solution: &Solution, lever: f64, most: f64) -> f64 {
        let poses = &solution.disks.poses;
        let Some(tip) = poses.last() else { return 0.0 };
        let mut sum = 0.0;
        let _ = self.each_residual(
            tip,
            |disk| poses[disk].position,
            lever,
            |residual| {
                sum += residual.norm_squared();
                if sum > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        );
        sum
    }

    /// Whether the residuals of another target are the same quantities.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Tip(_), Self::Tip(_)) | (Self::Pose(_), Self::Pose(_)) => true,
            (Self::Axis { point: a, .. }, Self::Axis { point: b, .. }) => {
                a.is_some() == b.is_some()
            }
            (Self::Shape(a), Self::Shape(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0)
            }
            _ => false,
        }
    }

    /// The variances of the residuals, from the standard deviations of positions, and of angles times the lever, in m.
    pub(crate) fn variances(&self, position: f64, angle: f64) -> Vec<f64> {
        let (position, angle) = (position * position, angle * angle);
        match self {
            Self::Tip(_) => vec![position; 3],
            Self::Pose(_) => [[position; 3], [angle; 3]].concat(),
            Self::Axis { point: None, .. } => vec![angle; 3],
            Self::Axis { .. } => [[position; 3], [angle; 3]].concat(),
            #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ points")]
            Self::Shape(points) => vec![position / points.len() as f64; 3 * points.len()],
        }
    }

    /// Writes the residuals of a solution.
    pub(crate) fn residual(&self, solution: &Solution, lever: f64, into: &mut Vec<f64>) {
        let poses = &solution.disks.poses;
        let Some(tip) = poses.last() else { return into.clear() };
        self.residual_at(tip, |disk| poses[disk].position, lever, into);
    }

    /// Writes the residuals in m: distances of points, over the root of their number, and angles times `lever`.
    pub(crate) fn residual_at(
        &self,
        tip: &Pose,
        disk: impl Fn(usize) -> Vec3,
        lever: f64,
        into: &mut Vec<f64>,
    ) {
        into.clear();
        let _ = self.each_residual(tip, disk, lever, |residual| {
            into.extend(residual.to_array());
            ControlFlow::Continue(())
        });
    }

    /// Gives `each` the residuals, three at a time, until it has enough.
    fn each_residual(
        &self,
        tip: &Pose,
        disk: impl Fn(usize) -> Vec3,
        lever: f64,
        mut each: impl FnMut(Vec3) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        match self {
            Self::Tip(point) => each(tip.position - *point),
            Self::Pose(pose) => {
                each(tip.position - pose.position)?;
                let turn = (tip.rotation * pose.rotation.conjugate()).log();
                each(turn * lever)
            }
            Self::Axis { point, direction } => {
                if let Some(point) = point {
                    each(tip.position - *point)?;
                }
                let axis = tip.rotation.rotate(Vec3::new(0.0, 0.0, 1.0));
                let goal = *direction * (1.0 / direction.norm());
                each((axis - goal) * lever)
            }
            Self::Shape(points) => {
                #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ points")]
                let weight = 1.0 / (points.len() as f64).sqrt();
                for (number, point) in points {
                    each((disk(*number) - *point) * weight)?;
                }
                ControlFlow::Continue(())
            }
        }
    }

    /// Writes residuals and Jacobian at the poses of all disks, from the motions of [`Self::places`] by each unknown.
    pub(crate) fn linearize(
        &self,
        poses: &[Pose],
        motions: &[Vec<Twist>],
        lever: f64,
        into: &mut Linear,
    ) {
        into.residual.clear();
        into.jacobian.clear();
        let Some(tip) = poses.last() else { return };
        self.residual_at(tip, |disk| poses[disk].position, lever, &mut into.residual);
        let (rows, n) = (into.residual.len(), motions.len());
        into.jacobian.resize(rows * n, 0.0);
        let mut column = Vec::with_capacity(rows);
        let places = self.places().len();
        // Of the rotation from the target, which is the same for all unknowns.
        let turn = match self {
            Self::Pose(pose) => (tip.rotation * pose.rotation.conjugate()).log(),
            _ => Vec3::ZERO,
        };
        for (k, of) in motions.iter().enumerate() {
            self.residual_rate((tip, turn), &of[..places], lever, &mut column);
            for (i, rate) in column.iter().enumerate() {
                into.jacobian[i * n + k] = *rate;
            }
        }
    }

    /// Writes the derivatives of the residuals by one unknown, from the tip, how it is turned from the target, and the motions of [`Self::places`].
    fn residual_rate(
        &self,
        (tip, turn): (&Pose, Vec3),
        motions: &[Twist],
        lever: f64,
        into: &mut Vec<f64>,
    ) {
        into.clear();
        let Some(motion) = motions.last() else { return };
        match self {
            Self::Tip(_) => into.extend(motion.linear.to_array()),
            Self::Pose(_) => {
                into.extend(motion.linear.to_array());
                into.extend((rate_of_log(turn, motion.angular) * lever).to_array());
            }
            Self::Axis { point, .. } => {
                if point.is_some() {
                    into.extend(motion.linear.to_array());
                }
                let axis = tip.rotation.rotate(Vec3::new(0.0, 0.0, 1.0));
                into.extend((motion.angular.cross(axis) * lever).to_array());
            }
            Self::Shape(points) => {
                #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ points")]
                let weight = 1.0 / (points.len() as f64).sqrt();
                for motion in motions {
                    into.extend((motion.linear * weight).to_array());
                }
            }
        }
    }
}

/// The rate of the rotation vector `φ` of a rotation that turns with the angular velocity `ω` of the fixed frame:
/// `ω − ½ φ×ω + (1/θ² − cot(θ/2)/(2θ)) φ×(φ×ω)` with `θ = ‖φ‖`, the inverse of the left Jacobian of SO(3).
fn rate_of_log(turn: Vec3, angular: Vec3) -> Vec3 {
    let angle = turn.norm();
    let factor = if angle < 1e-3 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half * half.cos() / half.sin()) / (angle * angle)
    };
    let once = turn.cross(angular);
    angular - once * 0.5 + turn.cross(once) * factor
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::UnitQuaternion;

    #[test]
    fn the_rate_of_a_rotation_vector_is_that_of_differences() {
        let angular = Vec3::new(0.3, -0.8, 0.5);
        for turn in
            [Vec3::new(1e-5, 0.0, 2e-5), Vec3::new(0.4, 1.2, -0.6), Vec3::new(-1.9, 0.7, 1.4)]
        {
            let rotation = UnitQuaternion::exp(turn);
            let at = |h: f64| (UnitQuaternion::exp(angular * h) * rotation).log();
            let h = 1e-5;
            let difference = (at(h) - at(-h)) * (0.5 / h);
            assert!((rate_of_log(turn, angular) - difference).norm() < 1e-8);
        }
    }
}
