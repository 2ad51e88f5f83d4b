//! The shape under a case, by given lengths or under forces.

use super::model::FourBar;
use super::refusal;
use super::workspace::Workspace;
use crate::case::Case;
use crate::derivatives::CoordinateDerivatives;
use crate::error::SolveError;
use crate::kind::ModelKind;
#[cfg(doc)]
use crate::linkage::Linkage;
use crate::parameter::Parameter;
use crate::solution::Solution;
use crate::warm_start::{Status, WarmStart};

impl FourBar {
    /// The shape under a case. Of given lengths it starts from its own guess, which is close, and a warm start changes
    /// nothing, but for the contacts with obstacles that it has.
    ///
    /// # Errors
    /// Where the model knows no forces [`SolveError::Unsupported`] for loads and [`SolveError::Missing`] for a cable without a
    /// shortening; else what [`Linkage::solve`] says of tensions and loads; [`SolveError::SectionOutOfReach`], [`SolveError::UnreachableLength`] (length
    /// rule `free`) and [`SolveError::CablesConflict`] for lengths that cannot be had,
    /// [`SolveError::NoLever`] for a cable through the centre of a section,
    /// [`SolveError::Invalid`] for a case that does not fit the robot.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::FourBar);
        let status = self.solve_into(case, warm_start.into(), workspace, &mut solution)?;
        workspace.chain.answered(status, solution)
    }

    /// [`Self::solve`] into memory that is at hand: without obstacles and after the first call nothing is allocated where at most
    /// one cable passes each section.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_into(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        if let Some(chain) = &self.chain {
            let takes = chain.knows_forces() && self.is_under_forces(case);
            let remembers = chain.has_friction() || self.robot.has_bending_friction();
            if takes || remembers || !case.obstacles.is_empty() {
                refusal::case(&self.robot, &self.options, case, takes)?;
                return chain.solve_into(case, from, &mut workspace.chain, solution);
            }
        }
        let outcome = self.solve_and_tell(case, workspace, solution).map(|compromise| {
            if !compromise {
                self.judge(case, workspace, solution);
            }
        });
        workspace.several.meter.checked(outcome).map(|()| Status::Converged)
    }

    /// [`Self::solve`], with the derivatives of the answer: by the commands, by tensions, by loads at any place, and by these
    /// parameters.
    ///
    /// # Errors
    /// As [`Linkage::solve_with_derivatives`]; [`SolveError::Unsupported`] without a strain energy that decides on the shape.
    pub fn solve_and_linearize(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        let (chain, memory) = self.chain(workspace).ok_or_else(|| self.no_linearization())?;
        chain.solve_with_derivatives(case, warm_start, parameters, memory)
    }
}
