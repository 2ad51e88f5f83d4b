//! What a solve may spend, and what it has spent.

use core::sync::atomic::{AtomicUsize, Ordering};

use crate::cancel::Cancel;
use crate::error::SolveError;
use crate::warm_start::Status;

/// What a solve may spend at most, counted in work and not in time: the same on every machine.
///
/// It is part of a model's options ([`Model::with_budget`](crate::Model::with_budget)). A solve that has spent it ends with
/// [`SolveError::BudgetSpent`], or where it is asked for by [`Prepared::solve_into`](crate::Prepared::solve_into) with the best
/// shape so far, but among obstacles with none. As long as it is not spent, it changes no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Newton iterations, those at parts of the load and those in vain among them.
    pub iterations: usize,
    /// Integration steps of all shapes that are tried: of a model of sections, its sections.
    pub integration_steps: usize,
}

impl Budget {
    /// No limit.
    pub const UNLIMITED: Self = Self { iterations: usize::MAX, integration_steps: usize::MAX };
}

/// Integration steps of an iteration of a rod that is divided finely.
const STEPS_OF_ITERATION: usize = 400;

impl Budget {
    /// So many iterations, and as many integration steps as they take, by default at least.
    #[must_use]
    pub fn of_iterations(iterations: usize) -> Self {
        let integration_steps = iterations.saturating_mul(STEPS_OF_ITERATION);
        Self {
            iterations,
            integration_steps: integration_steps.max(Self::default().integration_steps),
        }
    }
}

/// About two seconds on a common processor for the rods, less for models of sections.
impl Default for Budget {
    fn default() -> Self {
        Self { iterations: 100_000, integration_steps: 2_000_000 }
    }
}

/// What a solve has spent of its budget, and whether it is ended from outside: its loops look at it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    cancel: Cancel,
    budget: Budget,
    iterations: Counter,
    integration_steps: Counter,
    /// Integration steps at which the attempt at hand ends; 0 where it has no end of its own.
    attempt: Counter,
    /// How often the budget was granted beyond the first time.
    granted: Counter,
}

/// An integration step takes about as long as the elimination of a dense matrix takes for so much of the cube of its rows.
const ELIMINATION: usize = 10_000;
/// The same of a solve with factors that are known, of the square of its rows.
const SUBSTITUTION: usize = 600;
/// The same of the response of a rod, of the product of its unknowns and its nodes.
const RESPONSE: usize = 320;

/// A count that can be raised through a shared reference: of a solve, which is the work of one thread.
#[derive(Debug, Default)]
struct Counter(AtomicUsize);

impl Clone for Counter {
    fn clone(&self) -> Self {
        Self(AtomicUsize::new(self.get()))
    }
}

impl Counter {
    fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }

    fn set(&self, count: usize) {
        self.0.store(count, Ordering::Relaxed);
    }

    fn add(&self, count: usize) {
        self.set(self.get().saturating_add(count));
    }
}

impl Meter {
    /// Of a solve that begins.
    pub fn start(&mut self, cancel: &Cancel, budget: Budget) {
        self.cancel.clone_from(cancel);
        self.budget = budget;
        self.iterations.set(0);
        self.integration_steps.set(0);
        self.attempt.set(0);
        self.granted.set(0);
    }

    /// A solve of several steps of actuation has come to that of this number, from 0: each has the budget of one, however often the solve begins anew.
    pub fn grant_step(&self, number: usize) {
        self.granted.set(self.granted.get().max(number));
    }

    /// Holds half of what is left back, for what follows the search at hand; gives the budget to [`Self::allow`] again then.
    pub fn hold_back_half(&mut self) -> Budget {
        let (whole, left) = (self.budget, self.left());
        self.budget = Budget {
            iterations: whole.iterations.saturating_sub(left.iterations.div_ceil(2)),
            integration_steps: whole
                .integration_steps
                .saturating_sub(left.integration_steps.div_ceil(2)),
        };
        whole
    }

    /// Lets the solve spend this much in all.
    pub const fn allow(&mut self, budget: Budget) {
        self.budget = budget;
    }

    /// What is left of the budget.
    pub fn left(&self) -> Budget {
        let Budget { iterations, integration_steps } = self.all();
        Budget {
            iterations: iterations.saturating_sub(self.iterations.get()),
            integration_steps: integration_steps.saturating_sub(self.integration_steps.get()),
        }
    }

    /// The budget as often as it was granted.
    fn all(&self) -> Budget {
        let times = self.granted.get().saturating_add(1);
        Budget {
            iterations: self.budget.iterations.saturating_mul(times),
            integration_steps: self.budget.integration_steps.saturating_mul(times),
        }
    }

    /// Counts what a solve within this one has spent.
    pub fn charge(&self, within: &Self) {
        self.iterations.add(within.iterations.get());
        self.integration_steps.add(within.integration_steps.get());
    }

    /// Begins an attempt that ends after so many integration steps, after which the solve goes on otherwise.
    pub fn attempt(&self, steps: usize) {
        self.attempt.set(self.integration_steps.get().saturating_add(steps).max(1));
    }

    /// Lets the attempt at hand, if there is one, end only after so many integration steps more.
    pub fn extend_attempt(&self, steps: usize) {
        if self.is_attempt() {
            self.attempt(steps);
        }
    }

    /// Whether an attempt is at hand.
    pub fn is_attempt(&self) -> bool {
        self.attempt.get() > 0
    }

    /// Ends the attempt: what follows may spend the whole budget.
    pub fn end_attempt(&self) {
        self.attempt.set(0);
    }

    /// Counts a Newton iteration.
    pub fn iterate(&self) {
        self.iterations.add(1);
    }

    /// Counts integration steps.
    pub fn integrate(&self, steps: usize) {
        self.integration_steps.add(steps);
    }

    /// Counts so many eliminations of a dense matrix with so many rows, as the integration steps that take as long.
    pub fn eliminate(&self, rows: usize, eliminations: usize) {
        self.integrate(eliminations.saturating_mul(rows.saturating_pow(3)) / ELIMINATION);
    }

    /// Counts so many solves with a dense matrix of so many rows, likewise: each replaces some of its rows and substitutes.
    pub fn substitute(&self, rows: usize, solves: usize) {
        self.integrate(solves.saturating_mul(rows * rows) / SUBSTITUTION);
    }

    /// Counts the response of a rod in so many steps to so many unknowns, each of which acts in one of them, likewise.
    pub fn respond(&self, steps: usize, unknowns: usize) {
        self.integrate(unknowns.saturating_mul(4 * steps + unknowns) / RESPONSE);
    }

    /// Whether all of the budget is spent.
    pub fn is_spent(&self) -> bool {
        let Budget { iterations, integration_steps } = self.all();
        self.iterations.get() >= iterations || self.integration_steps.get() >= integration_steps
    }

    /// Whether the solve is ended from outside.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    /// Whether the solve, or its attempt at hand, goes no further.
    pub fn has_ended(&self) -> bool {
        let attempt = self.attempt.get();
        self.is_spent()
            || (attempt > 0 && self.integration_steps.get() >= attempt)
            || self.cancel.is_cancelled()
    }

    /// The answer of a solve; where its budget is spent that it is, though there is a shape.
    pub fn answered<T>(&self, (status, answer): (Status, T)) -> Result<T, SolveError> {
        match status {
            Status::Converged => Ok(answer),
            Status::BudgetSpent => Err(self.spent(None)),
        }
    }

    /// Why a solve goes no further.
    pub fn end(&self) -> SolveError {
        match self.cancel.is_cancelled() {
            true => SolveError::Cancelled { last_load: None },
            false => self.spent(None),
        }
    }

    /// That the budget is spent, where an equilibrium was found up to a part of the load or of the way.
    pub fn spent(&self, last_load: Option<f64>) -> SolveError {
        SolveError::BudgetSpent {
            iterations: self.iterations.get(),
            integration_steps: self.integration_steps.get(),
            last_load,
        }
    }

    /// What came of the solve: that it was cancelled, whatever the iterations that it broke off made of it; that its budget is
    /// spent where there is no answer; else its outcome.
    pub fn checked<T>(&self, outcome: Result<T, SolveError>) -> Result<T, SolveError> {
        match self.cancel.checked(outcome) {
            Err(error) if self.is_spent() && !matches!(error, SolveError::Cancelled { .. }) => {
                Err(self.spent(error.last_load()))
            }
            outcome => outcome,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meter(iterations: usize) -> Meter {
        let mut meter = Meter::default();
        meter.start(&Cancel::default(), Budget { iterations, ..Budget::UNLIMITED });
        meter
    }

    fn iterate(meter: &Meter, times: usize) {
        (0..times).for_each(|_| meter.iterate());
    }

    #[test]
    fn each_step_of_actuation_adds_a_budget_once() {
        let meter = meter(3);
        iterate(&meter, 3);
        assert!(meter.is_spent());
        meter.grant_step(1);
        assert_eq!(meter.left().iterations, 3);
        // The way begins anew.
        meter.grant_step(0);
        iterate(&meter, 2);
        meter.grant_step(1);
        assert!(!meter.is_spent() && meter.left().iterations == 1);
        iterate(&meter, 1);
        assert!(meter.is_spent());
        let SolveError::BudgetSpent { iterations, last_load, .. } = meter.spent(Some(0.5)) else {
            unreachable!()
        };
        assert_eq!((iterations, last_load), (6, Some(0.5)));
    }

    #[test]
    fn a_search_leaves_half_of_what_there_is() {
        let mut meter = meter(11);
        iterate(&meter, 2);
        let whole = meter.hold_back_half();
        assert_eq!(meter.left().iterations, 4);
        let within = Meter::default();
        iterate(&within, 4);
        meter.charge(&within);
        assert!(meter.is_spent());
        meter.allow(whole);
        assert_eq!(meter.left().iterations, 5);
    }

    #[test]
    fn more_iterations_may_take_more_steps() {
        let usual = Budget::default();
        assert_eq!(Budget::of_iterations(5), Budget { iterations: 5, ..usual });
        assert!(Budget::of_iterations(100_000).integration_steps > usual.integration_steps);
        assert_eq!(Budget::of_iterations(usize::MAX), Budget::UNLIMITED);
    }
}
