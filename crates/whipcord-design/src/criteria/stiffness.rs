//! How stiff a disk is, and how that changes.
//!
//! With the compliance `c = n·∂x/∂f` along a force `f n`, it is `∂c/∂θ = ∂(n·∂x/∂θ)/∂f`: the motion by an unknown is exact, so that of second derivatives only
//! the one along the force is a difference, of order six, and the solves of its few forces serve all unknowns.

use whipcord::derivatives::{Hold, Place};
use whipcord::kinematics::principal_axes;
use whipcord::{Case, LoadFrame, PointLoad, Robot, Solution, SolveError, Vec3};
use whipcord_numerics::Mat3;
use whipcord_numerics::derivative;

use super::Criteria;
use crate::error::DesignError;
use crate::unknown::{Unknown, Varied};

/// How far the greatest force of the difference moves its disk, as a part of the length: so little that what a difference of order six leaves is below rounding, and so much that rounding is
/// small beside it.
const MOVED: f64 = 4e-3;

impl Criteria {
    /// The force on the centre of a disk by how far it moves.
    pub(super) fn stiffness(
        &self,
        robot: &Robot,
        case: &Case,
        disk: usize,
        direction: Option<Vec3>,
    ) -> Result<f64, DesignError> {
        self.stiffness_along(robot, case, disk, direction).map(|(stiffness, ..)| stiffness)
    }

    /// A stiffness and its direction in the world, and the answer that has it.
    fn stiffness_along(
        &self,
        robot: &Robot,
        case: &Case,
        disk: usize,
        direction: Option<Vec3>,
    ) -> Result<(f64, Vec3, Solution), DesignError> {
        if !self.model.has_derivatives(robot) {
            let what = format!(
                "the model {} has no compliance for this robot, so that no stiffness can be a criterion: choose cosserat or cosserat-disks",
                self.model.kind().name()
            );
            return Err(DesignError::Criterion { what });
        }
        let mut prepared = self.model.prepare(robot, &case.loads)?;
        let (solution, derivatives) = prepared.solve_with_derivatives(case, None, &[])?;
        let matrix = derivatives.compliance(Place::Disk(disk), Hold::Commands)?;
        let row = |i: usize| Vec3::from([0, 1, 2].map(|j| matrix.at(i, j)));
        let matrix = Mat3::from_rows(row(0), row(1), row(2));
        let (compliance, direction) = match direction {
            Some(direction) => {
                // Compliances are in the frame of the base.
                let n = case.base.rotation.conjugate().rotate(direction);
                (n.dot(matrix * n), direction)
            }
            None => {
                let principal = principal_axes(&matrix);
                (principal.values[2], case.base.rotation.rotate(principal.directions[2]))
            }
        };
        let stiffness = if compliance > 0.0 { 1.0 / compliance } else { 0.0 };
        Ok((stiffness, direction, solution))
    }

    /// A stiffness and its rates by the unknowns.
    pub(super) fn stiffness_rates(
        &self,
        number: usize,
        disk: usize,
        direction: Option<Vec3>,
        of: Varied<'_>,
    ) -> Result<(f64, Vec<f64>), DesignError> {
        let case = &of.cases[number];
        let (stiffness, n, solution) = self.stiffness_along(of.robot, case, disk, direction)?;
        let length = of.robot.backbone().length;
        let force = MOVED * length * stiffness;
        let base = case.base.rotation;
        let speeds = |force: f64| -> Result<Vec<f64>, SolveError> {
            let force = match case.loads.frame {
                LoadFrame::Base => base.conjugate().rotate(n) * force,
                LoadFrame::World => n * force,
            };
            let mut pushed = case.clone();
            let at = of.robot.disks().arc_lengths[disk];
            pushed.loads.points.push(PointLoad { at, force, ..PointLoad::default() });
            let mut prepared = self.model.prepare(of.robot, &pushed.loads)?;
            // The force is added to the robot as it stands.
            let (_, derivatives) =
                prepared.solve_last_with_derivatives(&pushed, Some(&solution), of.parameters)?;
            let derivatives = (&derivatives, of.parameters);
            let speed = |unknown: &Unknown| {
                let at = [Place::Disk(disk)];
                unknown.velocities(number, &pushed, length, derivatives, &at)[0].dot(n)
            };
            Ok(of.unknowns.iter().map(speed).collect())
        };
        let of_compliance = derivative(|part| speeds(part * force), 1.0)?;
        let rate = |of: f64| -stiffness * stiffness * of / force;
        Ok((stiffness, of_compliance.into_iter().map(rate).collect()))
    }
}
