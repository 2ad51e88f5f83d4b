//! The rod on the way to a branch off its load path, led there by small dead moments.

use super::continuation::{is_stable, newton, raise_load};
use super::problem::Problem;
use super::scratch::Scratch;
use super::shooting::finish_chain;
use super::state::State;
use crate::statics::lengths::Effort;
use crate::statics::loads::AppliedLoads;
use crate::statics::outcome::Found;
use crate::statics::perturbation::{self, Perturbation, Perturbed};
use crate::statics::scales::Scales;

/// The moments act at so many places.
const PLACES: usize = 8;

/// A stable equilibrium under all of the load; the answer is left in `scratch`.
pub(super) fn stable_equilibrium(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    let loads = scratch.applied.clone();
    let mut rod = PerturbedRod { problem, scratch, loads: &loads, kept: State::default() };
    let found = perturbation::stable_equilibrium(&mut rod);
    scratch.applied.clone_from(&loads);
    found.map(|effort| finish_chain(problem, scratch, effort))
}

struct PerturbedRod<'a> {
    problem: &'a Problem<'a>,
    scratch: &'a mut Scratch,
    /// Those of the case.
    loads: &'a AppliedLoads,
    kept: State,
}

impl Perturbed for PerturbedRod<'_> {
    fn perturb(&mut self, by: Perturbation) {
        let Problem { grid, length, .. } = *self.problem;
        let unit = Scales::of(grid, length).moment;
        let applied = &mut self.scratch.applied;
        applied.clone_from(self.loads);
        let steps = grid.len();
        let places = PLACES.min(steps);
        for k in 0..places {
            applied.add_moment((k + 1) * steps / places, by.moment(k, places, unit));
        }
    }

    fn raise(&mut self) -> Option<Effort> {
        let Found { iterations, residual, .. } = raise_load(self.problem, self.scratch, 0).ok()?;
        Some(Effort { iterations, residual })
    }

    fn converge(&mut self) -> Option<Effort> {
        let (iterations, residual) = newton(self.problem, self.scratch).ok()?;
        Some(Effort { iterations, residual })
    }

    fn keep(&mut self) {
        self.kept.clone_from(&self.scratch.chain.state);
    }

    fn restore(&mut self) {
        self.scratch.chain.state.clone_from(&self.kept);
    }

    fn has_ended(&self) -> bool {
        self.problem.meter.has_ended()
    }

    fn is_stable(&mut self) -> bool {
        is_stable(self.problem, self.scratch)
    }
}
