//! Steps of actuation with friction at the holes, and what the holes do at the end of them.

use super::friction::{Memory, Rubbing, RubbingChain};
use super::held::HeldCable;
use super::statics::Effort;
use super::task::Task;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::solution::{NoStability, Solution, Verdict};
use crate::statics::command::Command;
use crate::statics::friction::{Course, History, Slides, step};
use crate::statics::loads::check as check_loads;
use crate::statics::outcome::Failure;
use crate::warm_start::WarmStart;

impl Linkage {
    /// Whether a cable rubs in its holes.
    pub(crate) const fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    /// The equilibrium at the end of all steps of a checked case; those that were taken already are not taken again.
    pub(super) fn find_with_friction(
        &self,
        rubbing: &Rubbing,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<Effort, SolveError> {
        let mut effort = Effort::default();
        for step in case.leading_steps().skip(workspace.friction.taken) {
            self.accept(&step, workspace)?;
            let found = self.take_step(rubbing, workspace);
            effort = found.map_err(|failure| self.explain(failure, &workspace.commands))?;
            workspace.friction.taken += 1;
        }
        Ok(effort)
    }

    /// One step of actuation under the commands of the workspace.
    fn take_step(
        &self,
        Rubbing { holes, sections, .. }: &Rubbing,
        workspace: &mut Workspace,
    ) -> Result<Effort, Failure> {
        let Workspace { scratch, loads, commands, tensions, meter, friction, .. } = workspace;
        let Memory { history, scratch: memory, course, before, step: next, turned, .. } = friction;
        let task = Task { sections, ..self.task(loads, &[], meter) };
        let mut chain = RubbingChain {
            task,
            holes,
            scratch,
            tolerance: self.options.residual,
            before,
            step: next,
            turned,
        };
        *course = Course::default();
        let found = step(&mut chain, holes, commands, history, course, memory);
        scratch.open = None;
        let found = found?;
        tensions.clone_from(&history.base);
        holes.cable_lengths(&memory.at.lengths, &mut scratch.chain.lengths);
        let (iterations, residual) = (found.iterations, found.residual);
        Ok(Effort { iterations, residual, lost_at: None })
    }

    /// The answers to all steps of a case in order. `each` gets them as they come.
    ///
    /// # Errors
    /// The number of the first step without an answer, from 0, and why it has none.
    pub(crate) fn solve_steps(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        workspace.forget();
        if self.keeps_history() {
            return self.bend_in_steps(case, workspace, each);
        }
        if self.has_friction() && !case.obstacles.is_empty() && !case.independent {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            check_loads(&self.robot, &case.loads).map_err(|error| (0, error.of(self.kind)))?;
            return self.rub_among_obstacles(case, workspace, each);
        }
        for (n, step) in case.single_steps().enumerate() {
            // The workspace remembers the steps before.
            workspace.friction.taken = 0;
            let solution = self.solve_on(&step, workspace).map_err(|error| (n, error))?;
            each(solution);
        }
        Ok(())
    }

    /// The answer to a step on from those that the workspace has taken.
    fn solve_on(&self, case: &Case, workspace: &mut Workspace) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(self.kind);
        let status = self.solve_from_here(case, WarmStart::None, workspace, &mut solution)?;
        workspace.answered(status, solution)
    }

    /// The stability of the answer that the workspace holds.
    pub(super) fn stability_with_friction(
        &self,
        Rubbing { holes, strands, .. }: &Rubbing,
        workspace: &mut Workspace,
    ) -> Result<Verdict, NoStability> {
        let Workspace { scratch, loads, commands, held, meter, friction, .. } = workspace;
        let Memory { history, scratch: memory, .. } = friction;
        held.clear();
        for (cable, command) in commands.iter().enumerate() {
            let first = holes.of_cable[cable][0];
            if let Command::Length { compliance, .. } = *command
                && holes.coefficients[cable] == 0.0
                && history.tensions[first] > 0.0
            {
                held.push(HeldCable::taut(first, compliance));
            }
        }
        let lock = |p: usize, compliance: f64| held.push(HeldCable::taut(p, compliance));
        holes
            .lock(commands, &memory.at.turns, history, lock)
            .map_err(|Slides| NoStability::Sliding)?;
        let task = Task { sections: strands, ..self.task(loads, &history.tensions, meter) };
        scratch.linearise(&task);
        let verdict = scratch.verdict(&task, held, self.options.stability);
        holes.cable_lengths(&memory.at.lengths, &mut scratch.chain.lengths);
        verdict
    }

    /// Writes what the holes do.
    pub(super) fn write_holes(
        &self,
        rubbing: &Rubbing,
        workspace: &Workspace,
        solution: &mut Solution,
    ) {
        let History { tensions, slip_states, .. } = &workspace.friction.history;
        for (i, cable) in solution.cables.iter_mut().enumerate() {
            rubbing.holes.of(i, slip_states, &mut cable.slip_states);
            cable.span_tensions.clear();
            if self.knows_forces {
                rubbing.holes.of(i, tensions, &mut cable.span_tensions);
            }
        }
    }
}

impl Workspace {
    /// Forgets all steps of actuation.
    pub(super) fn forget(&mut self) {
        (self.friction.history, self.friction.taken) = (History::default(), 0);
    }
}
