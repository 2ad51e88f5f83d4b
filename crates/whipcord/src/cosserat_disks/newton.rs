//! Newton's method on the gaps of the chain.

use whipcord_numerics::{Equations, NewtonOptions, Reuse, Solved, newton};

use super::chain::Chain;
use super::task::Task;
use crate::section::Fault;
use crate::statics::outcome::Open;

const NEWTON: NewtonOptions = NewtonOptions {
    tolerance: 0.0,
    iterations: 40,
    least_fraction: 1.0 / 64.0,
    decrease: 1e-4,
    rounding: 1e-9,
    reuse: Some(Reuse { at_start: false, near: 0.05, ratio: 0.5 }),
    trusted: 0,
};
/// Lengths change with the square of a turn, and a cable that does not give makes much of that: Newton's steps then find
/// back what they lose at first.
const TRUSTED_WITH_LENGTHS: usize = 6;

/// A chain whose gaps are closed.
struct Closing<'a> {
    chain: &'a mut Chain,
    task: Task<'a>,
}

impl Equations for Closing<'_> {
    type Fault = Fault;

    fn residual(&mut self) -> Result<f64, Fault> {
        self.chain.measure(&self.task)
    }

    fn step(&mut self, fresh: bool) -> Option<f64> {
        let Self { chain, task } = self;
        if fresh && !chain.linearise(task) || !chain.direct(task) {
            return None;
        }
        task.meter.iterate();
        chain.kept.clone_from(&chain.nodes);
        chain.kept_tensions.clone_from(&chain.tensions);
        chain.kept_load = task.load;
        Some(1.0)
    }

    fn go(&mut self, fraction: f64) {
        self.chain.go(&mut self.task, fraction);
    }

    fn has_ended(&self) -> bool {
        self.task.meter.has_ended()
    }

    fn note(&mut self, iteration: usize, residual: f64, fraction: f64) {
        let Chain { trace, tensions, .. } = &mut *self.chain;
        trace.iteration(iteration, self.task.load, residual, fraction, tensions);
    }
}

impl Chain {
    /// Newton's method; returns the iterations and the greatest gap left. With `linearised` the links
    /// that are kept are those of a coarser mesh, near enough to begin with.
    pub fn newton(&mut self, task: &Task<'_>, linearised: bool) -> Result<(usize, f64), Open> {
        let at_start = linearised && self.links.len() == task.frame.spans.len();
        let options = NewtonOptions {
            tolerance: task.tolerance,
            reuse: NEWTON.reuse.map(|reuse| Reuse { at_start, ..reuse }),
            trusted: if task.commands.is_empty() { 0 } else { TRUSTED_WITH_LENGTHS },
            ..NEWTON
        };
        let mut closing = Closing { chain: self, task: Task { ..*task } };
        let Solved { iterations, residual: gap } = newton(&mut closing, &options)?;
        let Closing { chain, task } = closing;
        chain.load = task.load;
        if task.derivatives && !(chain.linearise(&task) && chain.differentiate(&task)) {
            return Err(Open { iterations, gap, fault: None });
        }
        Ok((iterations, gap))
    }
}
