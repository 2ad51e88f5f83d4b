//! What is computed by itself: experiments, or rows of them where no answer depends on another row.

use std::collections::BTreeSet;

use super::experiment::Experiment;
use super::rows::without_commands;
use whipcord::case::Case;

/// So many rows, whatever the number of threads, so that answers do not depend on it.
const ROWS: usize = 4;

/// Steps of an experiment that are solved one after the other.
pub(super) struct Piece {
    pub(super) experiment: usize,
    /// These steps; the last is one in which something was seen.
    pub(super) case: Case,
    /// Their numbers in the experiment.
    pub(super) steps: Vec<usize>,
    /// Whether what the model would differentiate comes by differences, since it once had no derivatives there.
    pub(super) differs: bool,
    /// Whether the lengths of its one step are met in the least-squares sense.
    pub(super) over_determined: bool,
}

impl Piece {
    /// All in which something was seen, in the order of the experiments and of their steps.
    pub(super) fn all(experiments: &[Experiment]) -> Vec<Self> {
        let mut pieces = Vec::new();
        for (experiment, of) in experiments.iter().enumerate() {
            let mut steps: BTreeSet<usize> = of.observations.iter().map(|seen| seen.step).collect();
            let alone: Vec<usize> = steps.intersection(&of.over_determined).copied().collect();
            steps.retain(|step| !of.over_determined.contains(step));
            if of.case.independent && !of.case.before.is_empty() {
                let steps: Vec<usize> = steps.into_iter().collect();
                let piece = |steps: &[usize]| {
                    Some(Self::of(experiment, of.case.independent_steps(steps)?, steps.to_vec()))
                };
                pieces.extend(steps.chunks(ROWS).filter_map(piece));
            } else if let Some(&last) = steps.last() {
                let mut case = of.case.step(last).unwrap_or_else(|| of.case.clone());
                if !alone.is_empty() {
                    without_commands(&mut case, |step| of.over_determined.contains(&step));
                }
                pieces.push(Self::of(experiment, case, (0..=last).collect()));
            }
            let piece = |step: usize| {
                let piece = Self::of(experiment, single_step(&of.case, step)?, vec![step]);
                Some(Self { over_determined: true, ..piece })
            };
            pieces.extend(alone.into_iter().filter_map(piece));
        }
        pieces
    }

    const fn of(experiment: usize, case: Case, steps: Vec<usize>) -> Self {
        Self { experiment, case, steps, differs: false, over_determined: false }
    }
}

/// A step of a case by itself.
pub(super) fn single_step(case: &Case, step: usize) -> Option<Case> {
    match case.independent {
        true => case.independent_step(step),
        false => case.single_steps().nth(step),
    }
}
