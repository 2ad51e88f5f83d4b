//! All that would be seen, computed by several threads: the same to the last bit for any number of them.

use core::sync::atomic::{AtomicUsize, Ordering};

use super::error::{NoAnswer, NoAnswerReason};
use super::forward::Forward;
use super::outcome::Unstable;
use super::pieces::Piece;
use super::solver::{Predicted, Solver};
use whipcord::error::SolveError;
use whipcord::jobs::share;

/// Whether there is an answer whose derivatives alone are not known.
const fn lacks_derivatives(reason: &NoAnswerReason) -> bool {
    matches!(
        reason,
        NoAnswerReason::Solve(SolveError::NoDerivatives | SolveError::NoDerivativesOfRest)
    )
}

impl Forward<'_> {
    /// Works off tasks, given by the numbers of their pieces and something of their own. After one that `ends` all, those after it may be
    /// left out.
    fn work_off<K: Copy + Send + Sync, T: Send>(
        &self,
        tasks: &[(usize, K)],
        ends: impl Fn(&NoAnswerReason) -> bool + Sync + Send,
        of: impl Fn(&mut Solver<'_, '_>, &Piece, K) -> Result<T, NoAnswerReason> + Sync + Send,
    ) -> Result<Vec<Option<Result<T, NoAnswerReason>>>, NoAnswerReason> {
        let mut found: Vec<Option<Result<T, NoAnswerReason>>> =
            tasks.iter().map(|_| None).collect();
        let first_failed = AtomicUsize::new(tasks.len());
        let jobs = tasks.iter().zip(&mut found).enumerate();
        let solver = || Solver::new(self);
        share(jobs, self.threads, solver, |(number, ((piece, key), found)), solver| {
            // Which tasks were done before one fails depends on the threads: of several that fail the first one counts.
            if number <= first_failed.load(Ordering::Relaxed) {
                let outcome = of(solver, &self.pieces[*piece], *key);
                if outcome.as_ref().is_err_and(&ends) {
                    first_failed.fetch_min(number, Ordering::Relaxed);
                }
                *found = Some(outcome);
            }
            true
        })?;
        Ok(found)
    }

    /// The same, where no task may fail.
    fn all_of<K: Copy + Send + Sync, T: Send>(
        &self,
        tasks: &[(usize, K)],
        of: impl Fn(&mut Solver<'_, '_>, &Piece, K) -> Result<T, NoAnswerReason> + Sync + Send,
    ) -> Result<Vec<T>, NoAnswer> {
        let threads = |reason| NoAnswer { experiment: 0, reason };
        let found = self.work_off(tasks, |_| true, of).map_err(threads)?;
        let with_piece = tasks.iter().zip(found);
        let found = with_piece.filter_map(|((piece, _), outcome)| Some((*piece, outcome?)));
        found
            .map(|(piece, outcome)| outcome.map_err(|reason| self.no_answer(piece, reason)))
            .collect()
    }

    fn no_answer(&self, piece: usize, reason: NoAnswerReason) -> NoAnswer {
        NoAnswer { experiment: self.pieces[piece].experiment, reason }
    }

    fn all_pieces(&self) -> Vec<(usize, ())> {
        (0..self.pieces.len()).map(|piece| (piece, ())).collect()
    }

    /// What would be seen, without derivatives.
    pub(super) fn predict(&self, x: &[f64], into: &mut [f64]) -> Result<(), NoAnswer> {
        let found =
            self.all_of(&self.all_pieces(), |solver, piece, ()| solver.predict(piece, x))?;
        for Predicted { rows, numbers, .. } in found {
            for (row, number) in rows.into_iter().zip(numbers) {
                into[row] = number;
            }
        }
        Ok(())
    }

    /// What would be seen, and how it changes with the unknowns as far as the model says so itself: rows × unknowns, the others zero.
    pub(super) fn predict_with_columns(
        &mut self,
        x: &[f64],
        into: &mut [f64],
        columns: &mut [f64],
    ) -> Result<(), NoAnswer> {
        let n = self.unknowns.len();
        columns.fill(0.0);
        let mut tasks = self.all_pieces();
        while !tasks.is_empty() {
            let found = self
                .work_off(
                    &tasks,
                    |reason| !lacks_derivatives(reason),
                    |solver, piece, ()| solver.predict_with_columns(piece, x),
                )
                .map_err(|reason| NoAnswer { experiment: 0, reason })?;
            let mut again = Vec::new();
            for ((piece, ()), outcome) in tasks.into_iter().zip(found) {
                match outcome {
                    Some(Ok(found)) => {
                        for (i, (row, number)) in
                            found.rows.into_iter().zip(found.numbers).enumerate()
                        {
                            into[row] = number;
                            columns[row * n..][..n].copy_from_slice(&found.columns[i * n..][..n]);
                        }
                    }
                    // There is an answer; only how it came about in a step is not known well enough.
                    Some(Err(reason))
                        if lacks_derivatives(&reason) && !self.pieces[piece].differs =>
                    {
                        self.pieces[piece].differs = true;
                        again.push((piece, ()));
                    }
                    Some(Err(reason)) => return Err(self.no_answer(piece, reason)),
                    None => {}
                }
            }
            tasks = again;
        }
        Ok(())
    }

    /// Adds the columns that come by differences.
    pub(super) fn add_differences(
        &self,
        x: &[f64],
        scales: &[f64],
        columns: &mut [f64],
    ) -> Result<(), NoAnswer> {
        let n = self.unknowns.len();
        let tasks: Vec<(usize, usize)> = (0..self.pieces.len())
            .flat_map(|piece| (0..n).map(move |j| (piece, j)))
            .filter(|(piece, j)| self.is_by_differences(&self.pieces[*piece], *j, x[*j]))
            .collect();
        let found =
            self.all_of(&tasks, |solver, piece, j| solver.difference(piece, (x, scales), j))?;
        for ((_, j), Predicted { rows, numbers, .. }) in tasks.into_iter().zip(found) {
            for (row, slope) in rows.into_iter().zip(numbers) {
                columns[row * n + j] = slope;
            }
        }
        Ok(())
    }

    /// How many answers there are, one for each step in which something was seen, and which of them are
    /// unstable.
    pub(super) fn stability(&self, x: &[f64]) -> (usize, Vec<Unstable>) {
        let of = |solver: &mut Solver<'_, '_>, piece: &Piece, ()| solver.stabilities(piece, x);
        let found = self.work_off(&self.all_pieces(), |_| false, of).unwrap_or_default();
        let (mut answers, mut unstable) = (0, Vec::new());
        for (count, of_piece) in found.into_iter().flatten().flatten() {
            answers += count;
            unstable.extend(of_piece);
        }
        (answers, unstable)
    }

    /// The outcome of each piece, whether others fail or not.
    pub(super) fn each_piece<T: Send>(
        &self,
        pieces: &[(usize, ())],
        of: impl Fn(&mut Solver<'_, '_>, &Piece) -> T + Sync + Send,
    ) -> Result<Vec<T>, NoAnswerReason> {
        let found = self.work_off(pieces, |_| false, |solver, piece, ()| Ok(of(solver, piece)))?;
        Ok(found.into_iter().flatten().flatten().collect())
    }
}
