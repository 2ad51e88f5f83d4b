//! Newton's method on the gaps of the chain.

use super::chain::{Chain, Task};
use crate::statics::outcome::Open;

const MAX_ITERATIONS: usize = 40;
const LEAST_FRACTION: f64 = 1.0 / 64.0;
/// So many of Newton's steps are taken as they are where shorter ones gain nothing either.
const TRUSTED_STEPS: usize = 6;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e-9;
/// A step that leaves so little of the gaps, and a gap so small, leaves the linearisation good for the
/// next.
const NEAR: f64 = 0.05;

/// Newton's steps that are taken as they are.
#[derive(Clone, Copy, Debug)]
struct Trust {
    /// The gap that they have to fall below.
    gap: f64,
    steps: usize,
}

impl Chain {
    /// Newton's method; returns the iterations and the greatest gap left. With `linearised` the links
    /// that are kept are those of a coarser mesh, near enough to begin with.
    pub fn newton(&mut self, task: &Task<'_>, linearised: bool) -> Result<(usize, f64), Open> {
        let failed = |iterations, gap, fault| Open { iterations, gap, fault };
        let task = &mut Task { ..*task };
        let mut gap = self.measure(task).map_err(|f| failed(0, f64::INFINITY, Some(f)))?;
        let mut linearised = linearised && self.links.len() == task.frame.spans.len();
        let mut iteration = 0;
        let mut trust: Option<Trust> = None;
        while iteration < MAX_ITERATIONS && !task.meter.has_ended() {
            if gap <= task.tolerance {
                return self.finish(task, iteration, gap);
            }
            if trust.as_ref().is_some_and(|trust| gap < trust.gap) {
                trust = None;
            }
            let fresh = !linearised;
            if fresh && !self.linearise(task) {
                return Err(failed(iteration, gap, None));
            }
            let directed = self.direct(task);
            if !directed && fresh {
                return Err(failed(iteration, gap, None));
            }
            iteration += 1;
            task.meter.iterate();
            self.kept.clone_from(&self.nodes);
            self.kept_tensions.clone_from(&self.tensions);
            self.kept_load = task.load;
            let mut fraction = 1.0;
            loop {
                self.go(task, fraction);
                match self.measure(task) {
                    Ok(now) if fraction == 1.0 && now.max(gap) <= ROUNDING && now >= 0.5 * gap => {
                        self.trace.iteration(iteration, task.load, now, fraction, &self.tensions);
                        return self.finish(task, iteration, now);
                    }
                    // What is kept of a linearisation has to do better than a new one may.
                    Ok(now)
                        if directed
                            && now < (if fresh { 1.0 - 1e-4 * fraction } else { 0.5 }) * gap =>
                    {
                        linearised = fraction == 1.0 && now < NEAR * gap && now < NEAR;
                        gap = now;
                        self.trace.iteration(iteration, task.load, gap, fraction, &self.tensions);
                        break;
                    }
                    outcome => {
                        if fresh {
                            // Lengths change with the square of a turn, and a cable that does not give
                            // makes much of that: Newton's steps then find back what they lose at first.
                            let trusted = match &mut trust {
                                None if 0.5 * fraction < LEAST_FRACTION
                                    && !task.commands.is_empty() =>
                                {
                                    trust = Some(Trust { gap, steps: 1 });
                                    true
                                }
                                Some(trust) if fraction == 1.0 => {
                                    trust.steps += 1;
                                    trust.steps <= TRUSTED_STEPS
                                }
                                _ => false,
                            };
                            if trusted {
                                self.go(task, 1.0);
                                if let Ok(now) = self.measure(task)
                                    && now.is_finite()
                                {
                                    linearised = false;
                                    gap = now;
                                    self.trace.iteration(
                                        iteration,
                                        task.load,
                                        gap,
                                        1.0,
                                        &self.tensions,
                                    );
                                    break;
                                }
                            }
                            fraction *= 0.5;
                            if fraction < LEAST_FRACTION || trust.is_some() {
                                return Err(failed(iteration, gap, outcome.err()));
                            }
                            continue;
                        }
                        linearised = false;
                        self.go(task, 0.0);
                        gap = self
                            .measure(task)
                            .map_err(|fault| failed(iteration, gap, Some(fault)))?;
                        break;
                    }
                }
            }
        }
        Err(failed(MAX_ITERATIONS, gap, None))
    }

    fn finish(
        &mut self,
        task: &Task<'_>,
        iterations: usize,
        gap: f64,
    ) -> Result<(usize, f64), Open> {
        self.load = task.load;
        if task.derivatives && !(self.linearise(task) && self.differentiate(task)) {
            return Err(Open { iterations, gap, fault: None });
        }
        Ok((iterations, gap))
    }
}
