//! Steps of actuation of sections whose joints have friction against bending.

use super::{Linkage, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::shape::Solution;

impl Linkage {
    /// Whether the answer to a step depends on the steps before it by friction against bending.
    pub(crate) const fn keeps_history(&self) -> bool {
        self.robot.has_bending_friction()
    }

    /// The answers to all steps of a case in order, from the robot at rest: each starts from what the friction of the joints holds
    /// after the one before.
    pub(super) fn bend_in_steps(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        let mut chain = self.clone();
        let mut last: Option<Solution> = None;
        for (n, step) in case.single_steps().enumerate() {
            let mut solution = Solution::empty(self.kind);
            let status =
                chain.solve_from_here(&step, last.as_ref().into(), workspace, &mut solution);
            let solved = status.and_then(|status| workspace.answered(status, solution));
            let mut solution = solved.map_err(|error| (n, error))?;
            for (section, q) in chain.sections.iter_mut().zip(&workspace.scratch.chain.q) {
                section.keep_plastic(&self.division, q);
            }
            let at = |&s: &f64| chain.sections[chain.locate(s).0].plastic_curvature();
            solution.plastic_curvature = solution.shape.arc_length.iter().map(at).collect();
            each(last.insert(solution).clone());
        }
        Ok(())
    }
}
