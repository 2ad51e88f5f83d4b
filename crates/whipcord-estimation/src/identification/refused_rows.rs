//! Rows to which a model has no answer.

use super::error::NoAnswerReason;
use super::experiment::{Experiment, Unknown};
use super::forward::Forward;
use super::pieces::{Piece, single_step};
use super::quantity::Quantity;
use super::rows::{OverDetermined, Row, Skipped, marked};
use super::solver::Solver;
use whipcord::jobs::share;
use whipcord::over_determined;
use whipcord::robot::{Cable, Robot};
use whipcord::solution::Solution;

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

/// The answers to steps, by their numbers, and the rows without.
type Answered = (Vec<(usize, Solution)>, Vec<Skipped>);

impl Forward<'_> {
    /// The rows to which the model has no answer with these values. Where answers depend on the steps before them, these are all
    /// rows from the first such step on; else steps in which nothing was seen are among them.
    pub(super) fn refused(&self, x: &[f64]) -> Vec<Skipped> {
        let mut refused = Vec::new();
        for experiment in 0..self.experiments.len() {
            let (solutions, without) = self.answers(experiment, x);
            refused.extend(without);
            let view = self.view(experiment, x);
            for (step, solution) in &solutions {
                let seen = self.see(experiment, *step, solution, &view, |_, _, _| {});
                if let Err(reason) = seen {
                    refused.push(Skipped { row: Row { experiment, step: *step }, reason });
                }
            }
        }
        refused
    }

    /// The answers to the steps of an experiment up to the last in which something was seen, and the rows without.
    pub(super) fn answers(&self, experiment: usize, x: &[f64]) -> Answered {
        let all = self.pieces.iter().enumerate();
        let own = all.filter(|(_, piece)| piece.experiment == experiment);
        let own: Vec<(usize, ())> = own.map(|(number, _)| (number, ())).collect();
        let found = self.each_piece(&own, |solver, piece| solver.answers(piece, x));
        let (mut solutions, mut refused) = (Vec::new(), Vec::new());
        match found {
            Ok(pieces) => {
                for (answered, without) in pieces {
                    solutions.extend(answered);
                    refused.extend(without);
                }
            }
            Err(reason) => {
                for (number, ()) in own {
                    self.pieces[number].skip(0, &reason, self, &mut refused);
                }
            }
        }
        (solutions, refused)
    }
}

impl Forward<'_> {
    /// Which of these rows, to which the model has no answer, have lengths that contradict each other, and by how much they are missed with these
    /// values. Where answers depend on the steps before, no step stands by itself, and there are none.
    fn over_determined(&self, refused: &[Skipped], x: &[f64]) -> Vec<OverDetermined> {
        let may_be = |of: &&Skipped| match &of.reason {
            NoAnswerReason::Solve(error) => over_determined::may_be(error),
            _ => false,
        };
        let rows = refused.iter().filter(may_be).map(|of| of.row);
        let rows: Vec<Row> = rows.filter(|row| self.is_seen(row.experiment, row.step)).collect();
        self.missed(&rows, x)
    }

    /// The experiments, with the rows marked whose lengths contradict each other with these values, and the other rows to which the model has no answer.
    pub(super) fn marked(&self, x: &[f64]) -> (Vec<Experiment>, Vec<Skipped>) {
        let mut refused = self.refused(x);
        let over_determined = self.over_determined(&refused, x);
        refused.retain(|of| !over_determined.iter().any(|solved| solved.row == of.row));
        (marked(self.experiments, &over_determined), refused)
    }

    /// The measured rows whose lengths are met in the least-squares sense.
    pub(super) fn over_determined_rows(&self) -> Vec<Row> {
        let of = |(experiment, of): (usize, &Experiment)| {
            let rows = of.over_determined.iter().map(move |&step| Row { experiment, step });
            rows.collect::<Vec<_>>()
        };
        let rows = self.experiments.iter().enumerate().flat_map(of);
        rows.filter(|row| self.is_seen(row.experiment, row.step)).collect()
    }

    /// By how much the lengths of these rows are missed with these values; without the rows whose lengths do not contradict each other.
    pub(super) fn missed(&self, rows: &[Row], x: &[f64]) -> Vec<OverDetermined> {
        let mut found: Vec<Option<OverDetermined>> = vec![None; rows.len()];
        let jobs = rows.iter().zip(&mut found);
        let work = |(row, found): (&Row, &mut Option<OverDetermined>), (): &mut ()| {
            *found = self.missed_in(*row, x);
            true
        };
        // Where no thread can be started, the fit says so.
        match share(jobs, self.threads, || (), work) {
            Ok(()) => found.into_iter().flatten().collect(),
            Err(_) => Vec::new(),
        }
    }

    fn missed_in(&self, row: Row, x: &[f64]) -> Option<OverDetermined> {
        let Row { experiment, step } = row;
        if has_history(self, experiment) {
            return None;
        }
        let (robot, case) = self.built(experiment, x).ok()?;
        let answer = over_determined::solve(&self.model, &robot, &single_step(&case, step)?)?;
        Some(OverDetermined { row, misses: answer.diagnostics.length_misses })
    }
}

impl Piece {
    /// Leaves out the rows in which something was seen, from a step of the piece on.
    fn skip(
        &self,
        from: usize,
        reason: &NoAnswerReason,
        forward: &Forward<'_>,
        refused: &mut Vec<Skipped>,
    ) {
        let experiment = self.experiment;
        let seen = self.steps[from..].iter().filter(|step| forward.is_seen(experiment, **step));
        let skipped =
            seen.map(|&step| Skipped { row: Row { experiment, step }, reason: reason.clone() });
        refused.extend(skipped);
    }
}

impl Solver<'_, '_> {
    /// The answers to the steps of a piece.
    fn answers(&mut self, piece: &Piece, x: &[f64]) -> Answered {
        let forward = self.forward;
        let (experiment, mut solutions, mut refused) = (piece.experiment, Vec::new(), Vec::new());
        let has_history = has_history(forward, experiment);
        let (prepared, case) = match self.prepare(piece, x) {
            Ok(prepared) => prepared,
            Err(reason) => {
                piece.skip(0, &reason, forward, &mut refused);
                return (solutions, refused);
            }
        };
        let numbers = &piece.steps;
        if has_history {
            let answered = prepared.solve_steps(&case, |solution| {
                solutions.push((numbers[solutions.len()], solution));
            });
            if let Err((step, error)) = answered {
                piece.skip(step, &error.into(), forward, &mut refused);
            }
            return (solutions, refused);
        }
        for (&step, single) in numbers.iter().zip(case.single_steps()) {
            // What is independent starts from rest.
            let near = solutions.last().map(|(_, solution)| solution);
            match prepared.solve(&single, near.filter(|_| !case.independent)) {
                Ok(solution) => solutions.push((step, solution)),
                Err(error) => {
                    let row = Row { experiment, step };
                    refused.push(Skipped { row, reason: error.into() });
                }
            }
        }
        (solutions, refused)
    }
}
