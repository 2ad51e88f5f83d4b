//! Cases in which forces decide on the shape, and what the strain energy says of given lengths.

use super::model::FourBar;
use super::refusal::case as of_case;
use super::workspace::Workspace;
use crate::case::{Actuation, Case};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::linkage::{self, Linkage};
use crate::refusal;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::path::branches::{BranchOptions, Branches};

impl FourBar {
    /// Whether the answer to a case is an equilibrium of given forces, and not only of given lengths.
    pub(super) fn is_under_forces(&self, case: &Case) -> bool {
        let is_pulled = || match self.options.actuation {
            Actuation::Tension => true,
            Actuation::Shortening => false,
            Actuation::Natural => case.commands.iter().any(|c| c.shortening.is_none()),
        };
        let is_elastic =
            || (0..self.robot.cables().len()).any(|cable| self.robot.is_elastic(cable));
        !case.loads.is_none() || is_pulled() || is_elastic()
    }

    /// The chain in equilibrium, where the model knows the forces, and its memory.
    pub(crate) fn chain<'a>(
        &'a self,
        workspace: &'a mut Workspace,
    ) -> Option<(&'a Linkage, &'a mut linkage::Workspace)> {
        let chain = self.chain.as_ref().filter(|chain| chain.knows_forces());
        chain.map(|chain| (chain, &mut workspace.chain))
    }

    /// Whether the answer to a step depends on the steps before it.
    pub(crate) fn has_memory(&self) -> bool {
        let keeps = |chain: &Linkage| chain.has_friction() || chain.keeps_history();
        self.chain.as_ref().is_some_and(keeps)
    }

    /// The answers to all steps of a case in order with friction, as [`Linkage::solve_steps`] finds them.
    pub(crate) fn solve_steps(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        let Some(chain) = &self.chain else { return Ok(()) };
        for (n, step) in case.single_steps().enumerate() {
            let takes = chain.knows_forces() && self.is_under_forces(&step);
            of_case(&self.robot, &self.options, &step, takes).map_err(|error| (n, error))?;
        }
        chain.solve_steps(case, &mut workspace.chain, each)
    }

    /// All equilibria under the load of a case, as [`Linkage::branches`] finds them.
    ///
    /// # Errors
    /// As [`Linkage::branches`]; [`SolveError::Unsupported`] where the model knows no forces.
    pub fn branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        match self.chain(workspace) {
            Some((chain, memory)) => chain.branches(case, options, memory),
            None => Err(refusal::branches(ModelKind::FourBar)),
        }
    }

    /// Completes an answer of given lengths by what the strain energy says of it: nothing but the cables loads the base, and
    /// whether it is stable.
    pub(super) fn judge(&self, case: &Case, workspace: &mut Workspace, solution: &mut Solution) {
        if let Some((chain, memory)) = self.chain(workspace) {
            let verdict = chain.judge(case, solution, memory);
            let diagnostics = core::mem::take(&mut solution.diagnostics);
            solution.diagnostics = diagnostics.with_stability(verdict);
            solution.base_wrench = Some(Wrench::default());
        }
    }
}
