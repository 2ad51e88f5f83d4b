//! Where a solve into given memory starts, and how it ended.

use crate::solution::Solution;

/// Where [`Prepared::solve_into`](crate::Prepared::solve_into) starts.
#[derive(Clone, Copy, Debug, Default)]
pub enum WarmStart<'a> {
    /// From the robot without load.
    #[default]
    None,
    /// From what the solution holds that is written to: the answer of the cycle before.
    Output,
    /// From another solution of a neighbouring case.
    Solution(&'a Solution),
}

impl<'a> WarmStart<'a> {
    /// The solution it starts from; `output` is the one that is written to.
    pub(crate) const fn given(self, output: &'a Solution) -> Option<&'a Solution> {
        match self {
            Self::None => None,
            Self::Output => Some(output),
            Self::Solution(solution) => Some(solution),
        }
    }
}

impl<'a> From<Option<&'a Solution>> for WarmStart<'a> {
    fn from(solution: Option<&'a Solution>) -> Self {
        solution.map_or(Self::None, Self::Solution)
    }
}

/// How [`Prepared::solve_into`](crate::Prepared::solve_into) ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Status {
    /// With the answer.
    Converged,
    /// With the budget spent ([`crate::Budget`]), and the best shape so far: the answer on coarser steps, whose
    /// [`discretization_error`](crate::Diagnostics::discretization_error) is not known to be small enough, or the last iterate,
    /// which is out of equilibrium by the [`residual`](crate::Diagnostics::residual).
    BudgetSpent,
}
