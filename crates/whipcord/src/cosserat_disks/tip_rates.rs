//! How the tip moves with the commands of the cables, without the other derivatives of an answer: for control loops.

use whipcord_numerics::Twist;

use super::model::CosseratDisks;
use super::workspace::Workspace;
use crate::case::Case;
use crate::derivatives::{Answer, Driven, DrivenCables, TipRatesMemory};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::solution::Solution;

impl CosseratDisks {
    /// The motion of the tip, base frame, with the command of each cable of the robot at an answer to a case without friction and obstacles: as
    /// [`crate::derivatives::Derivatives::actuation_jacobian`] of [`Self::solve_with_derivatives`] from that answer has it, but in memory that the
    /// workspace keeps, so that it allocates nothing once it has that.
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
        workspace.meter.start(&self.options.cancel, self.options.budget);
        let mut memory = core::mem::take(&mut workspace.tip_rates);
        let answer = memory.answer.get_or_insert_with(|| Solution::empty(ModelKind::CosseratDisks));
        let cases = core::slice::from_ref(case);
        let solved = self.solve_from(cases, Some(solution).into(), workspace, answer);
        let found = workspace
            .meter
            .checked(solved)
            .and_then(|level| self.rates_of_answer(level, workspace, &mut memory, out));
        workspace.tip_rates = memory;
        found
    }

    /// Of the answer that the workspace holds, on the mesh of this level.
    fn rates_of_answer(
        &self,
        level: usize,
        workspace: &Workspace,
        memory: &mut TipRatesMemory,
        out: &mut Vec<Twist>,
    ) -> Result<(), SolveError> {
        let mesh = self.mesh(level)?;
        let Workspace { scratch, commands, .. } = workspace;
        let TipRatesMemory { rates, lists, order, .. } = memory;
        order.clear();
        order.extend(0..scratch.tensions.len());
        lists.set_taut(&scratch.tensions);
        scratch.starts_into(&self.frame, &mesh, &mut lists.starts);
        let driven = Driven {
            cables: DrivenCables {
                robot: &self.robot,
                order,
                rest_lengths: &self.frame.rest_lengths,
                commands,
                taut: &lists.taut,
            },
            answer: Answer {
                grid: &mesh.grid,
                loads: &scratch.applied,
                tensions: &scratch.tensions,
                poses: &scratch.poses,
                base_moment: scratch.base_wrench.moment,
                follower_force: scratch.applied.follower_share(scratch.base_wrench.force),
                starts: &lists.starts,
                strains: &[],
                are_strains_met: false,
                varying: None,
            },
        };
        let mut spans = self.frame.straight_spans(&mesh);
        // The sections of a rod without cables have no equilibrium to miss.
        rates.by_commands(&driven, Some(&mut spans), out).map_err(|_| SolveError::NoDerivatives)
    }
}
