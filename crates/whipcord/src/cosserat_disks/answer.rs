//! What a solve leaves in its memory, as a solution.

use whipcord_numerics::Pose;

use super::layout::Mesh;
use super::model::CosseratDisks;
use super::scratch::Scratch;
use super::stability_check;
use super::workspace::Workspace;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::solution::{CableState, NoStability, Solution};
use crate::statics::command::Command;
use crate::statics::outcome::Found;

impl CosseratDisks {
    /// The answer that the workspace holds.
    pub(super) fn solution(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        workspace: &mut Workspace,
        found: Found,
        discretization_error: Option<f64>,
    ) -> Solution {
        let mut solution = Solution::empty(ModelKind::CosseratDisks);
        self.write(mesh, cases, workspace, (found, discretization_error), &mut solution);
        solution
    }

    /// Writes the answer that the workspace holds.
    pub(super) fn write(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        workspace: &mut Workspace,
        (found, discretization_error): (Found, Option<f64>),
        solution: &mut Solution,
    ) {
        let case = cases.last();
        let base = case.map_or(Pose::IDENTITY, |case| case.base);
        let verdict = case.map_or(Err(NoStability::NotAsked), |case| {
            // The meshes that it takes were made for the answer.
            let problem = self.problem(mesh, (&workspace.commands, &workspace.meter), case);
            let problem = problem.map_err(|_| NoStability::Undetermined)?;
            stability_check::stability(&problem, &mut workspace.scratch)
        });
        self.write_iterate(mesh, base, workspace, solution);
        let history = &workspace.scratch.history;
        for (i, cable) in solution.cables.iter_mut().enumerate() {
            if let Some(holes) = &self.holes {
                holes.of(i, &history.tensions, &mut cable.span_tensions);
                holes.of(i, &history.slip_states, &mut cable.slip_states);
            }
        }
        solution.diagnostics =
            found.diagnostics(mesh.grid.len(), discretization_error).with_stability(verdict);
    }

    /// Writes the shape that the workspace holds, and what its cables do.
    fn write_iterate(
        &self,
        mesh: &Mesh,
        base: Pose,
        workspace: &Workspace,
        solution: &mut Solution,
    ) {
        let Scratch { poses, tensions, lengths, base_wrench, .. } = &workspace.scratch;
        let at = |k: &usize| poses[*k];
        let Mesh { grid, .. } = mesh;
        solution.shape.set(self.stations(), grid.stations.iter().map(at), base);
        let disks = &self.robot.disks().arc_lengths;
        solution.disks.set(disks, grid.disks.iter().map(at), base);
        self.write_cables(&workspace.commands, tensions, lengths, solution);
        solution.base_wrench = Some(*base_wrench);
    }

    /// Writes what became of the cables; and that nothing touches.
    fn write_cables(
        &self,
        commands: &[Command],
        tensions: &[f64],
        lengths: &[f64],
        solution: &mut Solution,
    ) {
        solution.model = ModelKind::CosseratDisks;
        solution.contacts.clear();
        solution.internal.clear();
        solution.objects.clear();
        let cables = self.robot.cables();
        let backbone = self.robot.backbone().length;
        solution.cables.resize_with(cables.len(), CableState::default);
        for (i, state) in solution.cables.iter_mut().enumerate() {
            let length = [lengths[i], self.frame.rest_lengths[i]];
            commands[i].answer(&cables[i].name, tensions[i], length, backbone, state);
        }
    }

    /// Writes the best shape that a solve has found whose budget is spent: the answer on coarser steps, or the last iterate; `false`
    /// where there is none.
    pub(super) fn write_best(
        &self,
        case: &Case,
        workspace: &Workspace,
        solution: &mut Solution,
    ) -> Result<bool, SolveError> {
        let Workspace { scratch, commands, coarse, coarse_tensions, progress, .. } = workspace;
        let (found, steps) = if let Some(found) = progress.coarser {
            let disks = &self.robot.disks().arc_lengths;
            let (at_disks, at_stations) = coarse.poses().split_at(disks.len());
            solution.shape.set(self.stations(), at_stations.iter().copied(), case.base);
            solution.disks.set(disks, at_disks.iter().copied(), case.base);
            self.write_cables(commands, coarse_tensions, coarse.lengths(), solution);
            solution.base_wrench = Some(workspace.coarse_base_wrench);
            (found, self.mesh(progress.level.saturating_sub(1))?.grid.len())
        } else if let Some(effort) = scratch.open {
            let mesh = self.mesh(progress.level)?;
            self.write_iterate(&mesh, case.base, workspace, solution);
            (Found::with(effort), mesh.grid.len())
        } else {
            return Ok(false);
        };
        solution.diagnostics =
            found.diagnostics(steps, None).with_stability(Err(NoStability::NotAsked));
        Ok(true)
    }
}
