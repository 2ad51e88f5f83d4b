//! What an answer says of a target that is not reached: that it cannot be, or why that is not known.

use whipcord::{ModelKind, Solution, Vec3};

use crate::certificate::{Goal, NoProof, least_distance};
use crate::error::InverseError;
use crate::options::{ReachOptions, ReachStatus};
use crate::reach::Reached;
use crate::solver::InverseSolver;
use crate::target::{Target, Tolerance};

impl InverseSolver {
    /// Proves that a target cannot be reached, or says why there is no proof.
    pub(crate) fn prove(
        &mut self,
        answer: &mut Reached,
        target: &Target,
        tolerance: Tolerance,
        options: &ReachOptions,
        boxes: usize,
    ) -> Result<(), InverseError> {
        /// Part of the distance that was found at which a proof ends.
        const TIGHT: f64 = 0.9;
        let outcome = match self.provable(target, options, &answer.solution) {
            Err(reason) => Err(reason),
            Ok((mut goal, tensions)) => {
                goal.distance *= TIGHT;
                if goal.distance <= tolerance.position {
                    Err(NoProof::Near)
                } else {
                    let forward = self.forward();
                    // A robot that keeps clear of obstacles has the shape that it has without them.
                    least_distance(forward.robot(), forward.case.base, &goal, &tensions, boxes)?
                }
            }
        };
        match outcome {
            Ok(bound) => {
                answer.lower_bound = Some(bound);
                let is_proven = bound > tolerance.position;
                if is_proven {
                    answer.status = ReachStatus::UnreachableProven;
                } else {
                    answer.status = ReachStatus::Undecided;
                    answer.no_proof = Some(NoProof::Boxes);
                }
            }
            Err(reason) => {
                answer.status = ReachStatus::Undecided;
                answer.no_proof = Some(reason);
            }
        }
        Ok(())
    }

    /// The point and the tensions of a proof: of a shape the point that is farthest from where it should be.
    fn provable(
        &self,
        target: &Target,
        options: &ReachOptions,
        solution: &Solution,
    ) -> Result<(Goal, Vec<[f64; 2]>), NoProof> {
        let robot = self.forward().robot();
        let disks = &robot.disks().arc_lengths;
        let poses = &solution.disks.poses;
        let tip = poses.len() - 1;
        let points = match target {
            Target::Tip(point) => vec![(tip, *point)],
            Target::Pose(pose) => vec![(tip, pose.position)],
            Target::Axis { point, .. } => point.iter().map(|point| (tip, *point)).collect(),
            Target::Shape(points) => points.clone(),
        };
        let distance = |(disk, point): &(usize, Vec3)| (poses[*disk].position - *point).norm();
        let farthest = points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
        let &(disk, point) = farthest.ok_or(NoProof::NoPoint)?;
        if self.model().kind() != ModelKind::Cosserat {
            return Err(NoProof::Model);
        }
        if !self.case().loads.is_none() {
            return Err(NoProof::Loads);
        }
        if robot.has_history() {
            return Err(NoProof::History);
        }
        if !self.case().obstacles.is_empty() && options.clearance.is_none() {
            return Err(NoProof::Obstacles);
        }
        let tensions: Vec<[f64; 2]> = self.limits().cables.iter().map(|of| of.tension).collect();
        if tensions.iter().any(|[_, greatest]| !greatest.is_finite()) {
            return Err(NoProof::TensionLimits);
        }
        let distance = distance(&(disk, point));
        let cancel = self.model().cancel().clone();
        let of_answer = solution.cables.iter().map(|cable| cable.tension.unwrap_or(0.0)).collect();
        let goal = Goal {
            arc_length: disks[disk],
            point,
            distance,
            found: poses[disk].position,
            tensions: of_answer,
            cancel,
        };
        Ok((goal, tensions))
    }
}
