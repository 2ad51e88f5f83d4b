//! Equilibrium on one grid, of any cables.

use super::problem::Problem;
use super::redundant_cables;
use super::scratch::{Scratch, Start};
use super::statics::solve_independent;
use crate::statics::outcome::{Failure, Found};

/// Solves the problem; the answer is left in `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    scratch.applied.gather(problem.grid, problem.loads, problem.base);
    scratch.slackened.clear();
    if problem.redundant_cables && scratch.applied.any() {
        redundant_cables::solve(problem, start, scratch)
    } else {
        solve_independent(problem, start, scratch)
    }
}
