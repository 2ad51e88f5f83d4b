//! Steps of actuation of sections whose joints have friction against bending.

use super::motion::Coordinates;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::section::BENDING_AXES;
use crate::solution::Solution;
use crate::statics::loads::check as check_loads;

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
        if self.has_friction() && !case.obstacles.is_empty() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            check_loads(&self.robot, &case.loads).map_err(|error| (0, error.of(self.kind)))?;
            return self.rub_among_obstacles(case, workspace, each);
        }
        let mut chain = self.clone();
        let mut last: Option<Solution> = None;
        for (n, step) in case.leading_steps().enumerate() {
            // What the holes remember of the steps before stays in the workspace.
            workspace.friction.taken = 0;
            let mut solution = Solution::empty(self.kind);
            let status =
                chain.solve_from_here(&step, last.as_ref().into(), workspace, &mut solution);
            let solved = status.and_then(|status| workspace.answered(status, solution));
            let mut solution = solved.map_err(|error| (n, error))?;
            chain.keep_plastic(&workspace.scratch.chain.q);
            solution.plastic_curvature = chain.plastic_curvature(&solution.shape.arc_length);
            each(last.insert(solution).clone());
        }
        Ok(())
    }

    /// Lets its joints keep what their friction holds at these coordinates.
    pub(super) fn keep_plastic(&mut self, q: &[Coordinates]) {
        let Self { sections, friction, division, .. } = self;
        let rubbing = friction.iter_mut().flat_map(|of| [&mut of.sections, &mut of.strands]);
        for sections in core::iter::once(sections).chain(rubbing) {
            for (section, q) in sections.iter_mut().zip(q) {
                section.keep_plastic(division, q);
            }
        }
    }

    /// The mean plastic curvature in 1/m of the sections at these arc lengths in m.
    pub(super) fn plastic_curvature(&self, arc_lengths: &[f64]) -> Vec<[f64; BENDING_AXES]> {
        let at = |&s: &f64| self.sections[self.locate(s).0].plastic_curvature();
        arc_lengths.iter().map(at).collect()
    }
}
