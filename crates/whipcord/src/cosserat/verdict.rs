//! Stability of the answer that a solve leaves in its memory.

use super::problem::{Problem, StabilityCheck};
use super::scratch::Scratch;
use super::shooting::sample;
use super::unloaded::Unloaded;
use crate::solution::{NoStability, Verdict};
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::Failure;

/// Whether the equilibrium in `scratch` is the answer on this grid.
pub(super) fn is_accepted(problem: &Problem<'_>, scratch: &mut Scratch) -> bool {
    if problem.stability == StabilityCheck::AtAnswer {
        scratch.unverified = true;
        return true;
    }
    is_stable(problem, scratch)
}

/// Whether the answer in `scratch` is stable, where that is asked for and defined.
pub(super) fn is_stable(problem: &Problem<'_>, scratch: &mut Scratch) -> bool {
    if problem.stability == StabilityCheck::Off
        || scratch.applied.any_follower()
        || problem.is_only(&scratch.applied)
    {
        return true;
    }
    if problem.is_clearly_stable(&scratch.applied, &scratch.tensions) {
        return true;
    }
    let sampled = sample(problem, scratch).is_ok();
    let Scratch { stability, trajectory, tensions, lengths, applied, .. } = scratch;
    let at = problem.equilibrium(&trajectory.samples, tensions, lengths, applied, 1.0);
    sampled && stability.is_stable(&at)
}

/// Stability of the answer in `scratch`, see [`super::stability`], or why it is not known.
pub(super) fn stability(
    problem: &Problem<'_>,
    analysis: StabilityAnalysis,
    scratch: &mut Scratch,
) -> Result<Result<Verdict, NoStability>, Failure> {
    if problem.stability == StabilityCheck::Off {
        return Ok(Err(NoStability::NotAsked));
    }
    if !scratch.applied.any() {
        let Scratch { unloaded, tensions, .. } = scratch;
        if analysis == StabilityAnalysis::Verdict {
            return Ok(Ok(Unloaded::verdict(problem.grid, tensions)));
        }
        let least = unloaded.stability(problem.grid, tensions);
        return least
            .map(|least| Ok(Verdict::of_eigenvalue(least)))
            .map_err(|fault| Failure::of_section(fault, tensions, 0.0));
    }
    if scratch.applied.any_follower() {
        return Ok(Err(NoStability::Followers));
    }
    if analysis == StabilityAnalysis::Verdict
        && problem.is_clearly_stable(&scratch.applied, &scratch.tensions)
    {
        return Ok(Ok(Verdict::STABLE));
    }
    sample(problem, scratch).map_err(|fault| Failure::of_section(fault, &scratch.tensions, 1.0))?;
    let Scratch { stability, trajectory, tensions, lengths, applied, .. } = scratch;
    let at = problem.equilibrium(&trajectory.samples, tensions, lengths, applied, 1.0);
    Ok(stability.verdict(&at, analysis))
}
