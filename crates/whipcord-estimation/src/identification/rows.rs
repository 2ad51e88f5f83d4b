//! Rows: the steps of experiments in which something was seen, and measurements without some of them.

use std::collections::BTreeSet;

use super::error::NoAnswerReason;
use super::experiment::Experiment;
use whipcord::LengthMiss;
use whipcord::case::Case;

/// A step of an experiment, both counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Row {
    /// The experiment.
    pub experiment: usize,
    /// The step of its case.
    pub step: usize,
}

/// A row that is left out because the model has no answer to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// The row.
    pub row: Row,
    /// Why it has none.
    pub reason: NoAnswerReason,
}

/// A row whose cable lengths contradict each other: they are met in the least-squares sense.
#[derive(Clone, Debug, PartialEq)]
pub struct OverDetermined {
    /// The row.
    pub row: Row,
    /// The cables that take part, and how much longer than prescribed each is at the estimates.
    pub misses: Vec<LengthMiss>,
}

/// The same experiments, where the lengths of these rows are met in the least-squares sense.
pub(super) fn marked(experiments: &[Experiment], rows: &[OverDetermined]) -> Vec<Experiment> {
    let mut all = experiments.to_vec();
    for of in rows {
        all[of.row.experiment].over_determined.insert(of.row.step);
    }
    all
}

/// The rows in which something was seen, in order.
#[must_use]
pub fn rows(experiments: &[Experiment]) -> Vec<Row> {
    let all = experiments.iter().enumerate().flat_map(|(experiment, of)| {
        of.observations.iter().map(move |seen| Row { experiment, step: seen.step })
    });
    all.collect::<BTreeSet<_>>().into_iter().collect()
}

/// The same experiments with what was seen in these rows, or in all others.
pub(super) fn only(
    experiments: &[Experiment],
    rows: &BTreeSet<Row>,
    kept: bool,
) -> Vec<Experiment> {
    let mut all = experiments.to_vec();
    for (experiment, of) in all.iter_mut().enumerate() {
        of.observations.retain(|seen| rows.contains(&Row { experiment, step: seen.step }) == kept);
    }
    all
}

/// The same experiments without what was seen in these rows, and without their commands: as if the robot had stayed where the step
/// before left it.
pub(super) fn without(experiments: &[Experiment], rows: &BTreeSet<Row>) -> Vec<Experiment> {
    let mut all = only(experiments, rows, false);
    for (experiment, of) in all.iter_mut().enumerate() {
        let left_out = |step: usize| rows.contains(&Row { experiment, step });
        of.over_determined.retain(|step| !left_out(*step));
        without_commands(&mut of.case, left_out);
    }
    all
}

/// Takes these steps out of a case: as if the robot had stayed where the step before left it, or started in the one after.
pub(super) fn without_commands(case: &mut Case, left_out: impl Fn(usize) -> bool) {
    let steps = case.before.len() + 1;
    let is_kept = |step: &usize| !left_out(*step);
    let earlier = case.motors.len().saturating_sub(steps);
    for step in (0..steps).filter(|step| !is_kept(step)) {
        let before = (0..step).rev().find(is_kept);
        let Some(other) = before.or_else(|| (step..steps).find(is_kept)) else { break };
        let commands = case.before.get(other).unwrap_or(&case.commands).clone();
        match case.before.get_mut(step) {
            Some(place) => *place = commands,
            None => case.commands = commands,
        }
        let loads = case.loads_before.get(other).unwrap_or(&case.loads).clone();
        match case.loads_before.get_mut(step) {
            Some(place) => *place = loads,
            None if step + 1 == steps => case.loads = loads,
            None => {}
        }
        if case.motors.len() >= steps {
            case.motors[earlier + step] = case.motors[earlier + other].clone();
        }
    }
}
