//! How the tip moves with the commands of the cables, without the other derivatives of an answer: for control loops.

use whipcord_numerics::{Pose, Twist};

use super::places::carried;
use super::task::Right;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::derivatives::{DrivenCables, TensionRatesMemory};
use crate::error::SolveError;
use crate::solution::Solution;

impl Linkage {
    /// The motion of the tip, base frame, with the command of each cable of the robot at an answer to a case without friction and obstacles: as
    /// [`crate::derivatives::CoordinateDerivatives::actuation_jacobian`] of [`Self::solve_with_derivatives`] from that answer has it, but by one
    /// elimination, eq. (11), in memory that the workspace keeps.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub(crate) fn tip_by_commands(
        &self,
        case: &Case,
        solution: &Solution,
        workspace: &mut Workspace,
        out: &mut Vec<Twist>,
    ) -> Result<(), SolveError> {
        let mut memory = core::mem::take(&mut workspace.tip_rates);
        let answer = memory.answer.get_or_insert_with(|| Solution::empty(self.kind));
        let solved = self.solve_into(case, Some(solution).into(), workspace, answer);
        let found = solved
            .and_then(|status| workspace.meter.answered((status, ())))
            .and_then(|()| self.rates_of_answer(workspace, &mut memory, out));
        workspace.tip_rates = memory;
        found
    }

    /// Of the answer that the workspace is at.
    fn rates_of_answer(
        &self,
        workspace: &mut Workspace,
        memory: &mut TensionRatesMemory,
        out: &mut Vec<Twist>,
    ) -> Result<(), SolveError> {
        let Workspace { scratch, loads, commands, tensions, meter, .. } = workspace;
        let TensionRatesMemory { rates, order, taut, .. } = memory;
        let cables = tensions.len();
        let task = self.task(loads, tensions, meter);
        let chain = &mut scratch.chain;
        chain.evaluate(&task);
        chain.linearise(&task);
        let eliminated = chain.eliminate_with(&task, 0.0, cables, Right::Tension);
        eliminated.ok_or(SolveError::NoDerivatives)?;
        rates.clear();
        for cable in 0..cables {
            let mut tip = Twist::default();
            let mut disk = Pose::IDENTITY;
            for (k, end) in self.disks(&chain.q).skip(1).enumerate() {
                let response = chain.response(&task, cable, k);
                tip = carried(tip, disk, chain.motion(k), end.position, response);
                disk = end;
            }
            let lengths = rates.push(tip, cables);
            chain.add_lengths(&task, cable, |other, change| lengths[other] += change);
        }
        order.clear();
        order.extend(0..cables);
        taut.clear();
        taut.extend(tensions.iter().map(|&tension| tension > 0.0));
        let driven = DrivenCables {
            robot: &self.robot,
            order,
            rest_lengths: &self.rest_lengths,
            commands,
            taut,
        };
        rates.by_commands(driven, out).map_err(|_| SolveError::NoDerivatives)
    }
}
