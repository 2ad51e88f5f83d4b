//! How a place of the arc moves with the commands.

use whipcord_numerics::{GAUSS_5, Pose, Twist, Vec3};

use super::arc::{Arc, Elasticity};
use super::{ConstantCurvature, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::kinematics::{ComplianceUnknown, Local};
use crate::solution::Solution;
use crate::statics::local::{Column, local_of};

/// Pieces of a quadrature that leaves rounding alone for arcs of a few turns.
const PIECES: usize = 16;

impl ConstantCurvature {
    /// The answer, and how the place at an arc length in m moves: eq. (5). It takes no loads, so that nothing says how it
    /// yields.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_at(
        &self,
        case: &Case,
        arc_length: f64,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Local), SolveError> {
        let (arc, effort) = self.solve_arc(case, workspace)?;
        let mut solution = Solution::empty(ModelKind::ConstantCurvature);
        self.write(case.base, &arc, effort, workspace, &mut solution);
        let Elasticity { bending, axial } = self.elasticity_or_unit();
        let columns = self.offsets.iter().enumerate().map(|(cable, [x, y])| {
            let strain = Twist {
                linear: Vec3::Z * -axial,
                angular: Vec3::new(-bending[0] * y, bending[1] * x, 0.0),
            };
            let lengths = (0..self.offsets.len())
                .map(|i| workspace.length_by_tension[i * self.offsets.len() + cable])
                .collect();
            Column { twist: arc.twist(arc_length, strain), lengths }
        });
        let by_tension: Vec<Column> = columns.collect();
        let Workspace { commands, tensions, .. } = &*workspace;
        let is_taut = |i: usize| tensions[i] > 0.0;
        let compliance = |i: usize| self.robot.cable_compliance(i, self.rest_lengths[i]);
        let unknown = Err(ComplianceUnknown::NoLoads);
        let length = self.robot.backbone().length;
        let local = local_of(commands, (is_taut, compliance), &by_tension, unknown, length)?;
        Ok((solution, local))
    }
}

impl Arc {
    /// How the frame at an arc length moves with a change of the constant strain `ξ`,
    ///
    /// ```text
    /// V = ∫ Ad(exp(σ ξ)) δξ dσ    from base to place                                      (5)
    /// ```
    ///
    /// and its point with `V × p` beside.
    fn twist(&self, arc_length: f64, change: Twist) -> Twist {
        let mut sum = Twist::default();
        let piece = arc_length / PIECES as f64;
        for k in 0..PIECES {
            for (node, weight) in GAUSS_5.nodes.into_iter().zip(GAUSS_5.weights) {
                let Pose { position, rotation } = self.pose((k as f64 + node) * piece);
                let angular = rotation.rotate(change.angular);
                let linear = rotation.rotate(change.linear) + position.cross(angular);
                sum = sum + Twist { linear, angular } * (weight * piece);
            }
        }
        let at = self.pose(arc_length).position;
        Twist { linear: sum.linear + sum.angular.cross(at), ..sum }
    }
}
