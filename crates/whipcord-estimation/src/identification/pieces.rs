//! What is computed by itself: experiments, or rows of them where no answer depends on another row.

use std::collections::BTreeSet;

use super::experiment::Experiment;
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
}

impl Piece {
    /// All in which something was seen, in the order of the experiments and of their steps.
    pub(super) fn all(experiments: &[Experiment]) -> Vec<Self> {
        let mut pieces = Vec::new();
        for (experiment, of) in experiments.iter().enumerate() {
            let steps: BTreeSet<usize> = of.observations.iter().map(|seen| seen.step).collect();
            let Some(&last) = steps.last() else { continue };
            if of.case.independent && !of.case.before.is_empty() {
                let steps: Vec<usize> = steps.into_iter().collect();
                let piece = |steps: &[usize]| {
                    let case = of.case.independent_steps(steps)?;
                    Some(Self { experiment, case, steps: steps.to_vec(), differs: false })
                };
                pieces.extend(steps.chunks(ROWS).filter_map(piece));
            } else {
                let case = of.case.step(last).unwrap_or_else(|| of.case.clone());
                pieces.push(Self { experiment, case, steps: (0..=last).collect(), differs: false });
            }
        }
        pieces
    }
}
