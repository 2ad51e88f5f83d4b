//! What a design is to come near to.

use whipcord::{Case, Pose, Robot, Solution, Vec3};

use crate::error::DesignError;

/// A shape that the robot is to take under a case: points for some of its disks.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeGoal {
    /// Tensions or shortenings and loads.
    pub case: Case,
    /// Number of a disk, from 0, and where its centre is wanted, in m in the world.
    pub points: Vec<(usize, Vec3)>,
    /// How much the squares of its distances count beside those of other goals.
    pub weight: f64,
}

impl ShapeGoal {
    /// The points of a goal that counts once.
    #[must_use]
    pub const fn new(case: Case, points: Vec<(usize, Vec3)>) -> Self {
        Self { case, points, weight: 1.0 }
    }

    /// The weighted sum of the squares of the distances in m².
    pub(crate) fn cost(&self, poses: &[Pose]) -> f64 {
        let square = |(disk, point): &(usize, Vec3)| {
            let off = poses[*disk].position - *point;
            off.dot(off)
        };
        self.weight * self.points.iter().map(square).sum::<f64>()
    }

    /// Distance of each point in m.
    pub(crate) fn misses(&self, solution: &Solution) -> Vec<(usize, f64)> {
        let poses = &solution.disks.poses;
        let miss = |(disk, point): &(usize, Vec3)| (*disk, (poses[*disk].position - *point).norm());
        self.points.iter().map(miss).collect()
    }
}

/// Refuses goals without any points.
pub(crate) fn check_points(goals: &[ShapeGoal]) -> Result<(), DesignError> {
    match goals.iter().all(|goal| goal.points.is_empty()) {
        true => Err(DesignError::NoPoints),
        false => Ok(()),
    }
}

/// Checks goals of a robot.
pub(crate) fn check(robot: &Robot, goals: &[ShapeGoal]) -> Result<(), DesignError> {
    let last = robot.disks().count() - 1;
    for (target, goal) in goals.iter().enumerate() {
        for &(disk, point) in &goal.points {
            if disk > last {
                return Err(DesignError::NoSuchDisk { disk, last });
            }
            let is_usable = point.norm().is_finite() && goal.weight.is_finite();
            if !is_usable || goal.weight < 0.0 {
                return Err(DesignError::NotFinite { target, disk });
            }
        }
    }
    Ok(())
}

/// The root of the mean of the squares behind a cost, in m.
pub(crate) fn root_mean_square(goals: &[ShapeGoal], cost: f64) -> f64 {
    #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ points")]
    let weights = goals.iter().map(|goal| goal.weight * goal.points.len() as f64).sum::<f64>();
    if weights > 0.0 { (cost / weights).sqrt() } else { 0.0 }
}
