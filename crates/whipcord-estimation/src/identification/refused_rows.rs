//! Rows to which a model has no answer.

use std::collections::BTreeSet;

use super::error::NoAnswerReason;
use super::experiment::Unknown;
use super::forward::Forward;
use super::quantity::Quantity;
use super::rows::{Row, Skipped};
use whipcord::robot::{Cable, Robot};
use whipcord::shape::Solution;

/// Whether answers depend on the steps before them.
pub(super) fn has_history(forward: &Forward<'_>, experiment: usize) -> bool {
    let of = &forward.experiments[experiment].case;
    let rubs = |unknown: &Unknown| matches!(unknown.quantity, Quantity::Friction { .. });
    let remembers = remembers(forward.robot) || forward.unknowns.iter().any(rubs);
    !of.independent && (remembers || !of.obstacles.is_empty())
}

/// Whether the shape of a robot depends on how it came there.
pub(super) fn remembers(robot: &Robot) -> bool {
    robot.cables().iter().any(Cable::has_friction) || robot.backbone().bending_friction.is_some()
}

impl Forward<'_> {
    /// The rows to which the model has no answer with these values. Where answers depend on the steps before them, these are all
    /// rows from the first such step on; else steps in which nothing was seen are among them.
    pub(super) fn refused(&mut self, x: &[f64]) -> Vec<Skipped> {
        let mut refused = Vec::new();
        for experiment in 0..self.experiments.len() {
            self.add_refused(experiment, x, &mut refused);
        }
        refused
    }

    fn add_refused(&mut self, experiment: usize, x: &[f64], refused: &mut Vec<Skipped>) {
        let (solutions, without) = self.answers(experiment, x);
        refused.extend(without);
        for (step, solution) in solutions.iter().enumerate() {
            let Some(solution) = solution else { continue };
            if let Err(reason) = self.see(experiment, step, solution, |_, _, _| {}) {
                refused.push(Skipped { row: Row { experiment, step }, reason });
            }
        }
    }

    /// The answers to the steps of an experiment up to the last in which something was seen, and the rows without.
    pub(super) fn answers(
        &mut self,
        experiment: usize,
        x: &[f64],
    ) -> (Vec<Option<Solution>>, Vec<Skipped>) {
        let mut refused = Vec::new();
        let observed: BTreeSet<usize> =
            self.experiments[experiment].observations.iter().map(|seen| seen.step).collect();
        let Some(&last) = observed.last() else { return (Vec::new(), refused) };
        let has_history = has_history(self, experiment);
        let all = |reason: NoAnswerReason, from: usize| {
            let steps = observed.iter().filter(move |step| **step >= from);
            let skipped = |step: &usize| Skipped {
                row: Row { experiment, step: *step },
                reason: reason.clone(),
            };
            steps.map(skipped).collect::<Vec<_>>()
        };
        let (prepared, case) = match self.prepare(experiment, x) {
            Ok(prepared) => prepared,
            Err(reason) => return (Vec::new(), all(reason, 0)),
        };
        let mut solutions = vec![None; last + 1];
        if has_history {
            let mut step = 0;
            let answered = prepared.solve_steps(&case, |solution| {
                solutions[step] = Some(solution);
                step += 1;
            });
            if let Err((step, error)) = answered {
                refused.extend(all(error.into(), step));
            }
        } else {
            let mut before = None;
            for (step, single) in case.single_steps().enumerate() {
                // What is independent starts from rest.
                let near = before.as_ref().filter(|_| !case.independent);
                match prepared.solve(&single, near) {
                    Ok(solution) => solutions[step] = Some(before.insert(solution).clone()),
                    Err(error) => {
                        let row = Row { experiment, step };
                        refused.push(Skipped { row, reason: error.into() });
                    }
                }
            }
        }
        (solutions, refused)
    }
}
