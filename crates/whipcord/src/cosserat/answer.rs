//! Solutions from what the workspace holds once a solve has ended.

use super::prepared::{Cosserat, Workspace};
use super::scratch::Scratch;
use super::verdict;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::solution::{CableState, NoStability, Solution, Verdict};
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::outcome::Found;

impl Cosserat {
    /// The answer that the workspace holds.
    pub(super) fn solution(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
        found: Found,
        discretization_error: Option<f64>,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::Cosserat);
        self.write(grid, case, workspace, (found, discretization_error), &mut solution)?;
        Ok(solution)
    }

    /// Writes the answer that the workspace holds.
    pub(super) fn write(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
        (found, discretization_error): (Found, Option<f64>),
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        let problem = self.problem(grid, case, (&workspace.commands, &workspace.meter));
        let verdict = verdict::stability(&problem, self.options.stability, &mut workspace.scratch)
            .map_err(|failure| self.explain(failure, &workspace.commands))?;
        self.write_answer(grid, case, workspace, (found, discretization_error), verdict, solution);
        Ok(())
    }

    /// Writes the answer that the workspace holds, of this stability.
    pub(super) fn write_answer(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &Workspace,
        (found, discretization_error): (Found, Option<f64>),
        verdict: Result<Verdict, NoStability>,
        solution: &mut Solution,
    ) {
        self.write_shape(grid, case, workspace, solution);
        solution.diagnostics =
            found.diagnostics(grid.len(), discretization_error).with_stability(verdict);
    }

    /// Writes the answer or iterate that the workspace holds, but not how it was found.
    pub(super) fn write_shape(
        &self,
        grid: &Grid,
        case: &Case,
        workspace: &Workspace,
        solution: &mut Solution,
    ) {
        let scratch = &workspace.scratch;
        let at = |k: &usize| scratch.poses[*k];
        solution.shape.set(self.layout.stations(), grid.stations.iter().map(at), case.base);
        let disks = &self.robot.disks().arc_lengths;
        solution.disks.set(disks, grid.disks.iter().map(at), case.base);
        let Scratch { tensions, lengths, base_wrench, .. } = scratch;
        self.write_cables(&workspace.commands, tensions, lengths, solution);
        solution.base_wrench = Some(*base_wrench);
        scratch.write_internal(grid, &mut solution.internal);
    }

    /// Writes what became of the cables, from tensions and lengths in the order of the grid; and that nothing touches.
    fn write_cables(
        &self,
        commands: &[Command],
        tensions: &[f64],
        lengths: &[f64],
        solution: &mut Solution,
    ) {
        solution.model = ModelKind::Cosserat;
        solution.contacts.clear();
        solution.internal.clear();
        solution.objects.clear();
        let cables = self.robot.cables();
        solution.cables.resize_with(cables.len(), CableState::default);
        for (place, &cable) in self.layout.order.iter().enumerate() {
            let length = [lengths[place], self.layout.rest_lengths[place]];
            let (name, backbone) = (&cables[cable].name, self.robot.backbone().length);
            let state = &mut solution.cables[cable];
            commands[place].answer(name, tensions[place], length, backbone, state);
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
        let Workspace { scratch, commands, coarse, from_coarser, progress, .. } = workspace;
        let (found, steps) = if let Some(found) = progress.coarser {
            let (stations, disks) = (self.layout.stations(), &self.robot.disks().arc_lengths);
            let poses = coarse.poses();
            let (at_disks, at_stations) = poses.split_at(disks.len());
            solution.shape.set(stations, at_stations.iter().copied(), case.base);
            solution.disks.set(disks, at_disks.iter().copied(), case.base);
            self.write_cables(commands, &from_coarser.tensions, coarse.lengths(), solution);
            solution.base_wrench = from_coarser.base_wrench;
            (found, self.grid(progress.level.saturating_sub(1))?.len())
        } else if let Some(effort) = scratch.open {
            let grid = self.grid(progress.level)?;
            self.write_shape(&grid, case, workspace, solution);
            (Found::with(effort), grid.len())
        } else {
            return Ok(false);
        };
        solution.diagnostics =
            found.diagnostics(steps, None).with_stability(Err(NoStability::NotAsked));
        Ok(true)
    }
}
