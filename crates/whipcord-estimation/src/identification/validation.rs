//! How well a fit says what it has not seen.

use super::check::check;
use super::error::{IdentifyError, NoAnswer};
use super::experiment::{Experiment, Unknown};
use super::forward::{Forward, measured};
use super::identify::identify;
use super::settings::Settings;
use crate::observation::Observation;
use whipcord::robot::Robot;

/// What is held out in turn, and how far off it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Validated {
    /// One for each part that was held out.
    pub folds: Vec<Fold>,
    /// Root mean square distance in m of all markers whose position was seen from where fits that did not
    /// know them have them.
    pub rms_distance: Option<f64>,
    /// The same in pixels.
    pub rms_pixels: Option<f64>,
}

/// A part of the measurements that was held out.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// The experiment, from 0.
    pub experiment: usize,
    /// The step that was held out of it, from 0; else the whole of it.
    pub step: Option<usize>,
    /// The estimates without it.
    pub values: Vec<f64>,
    /// Root mean square distance in m of its markers from where the fit without them has them.
    pub rms_distance: Option<f64>,
    /// The same in pixels.
    pub rms_pixels: Option<f64>,
}

/// Sums of squares, of distances and of pixels, and their counts.
#[derive(Clone, Copy, Default)]
struct Misses([(f64, usize); 2]);

impl Misses {
    fn add(&mut self, seen: &Observation, distance: f64) {
        let (sum, count) = &mut self.0[usize::from(seen.seen.is_in_image())];
        *sum += distance * distance;
        *count += 1;
    }

    fn add_all(&mut self, other: Self) {
        for (to, from) in self.0.iter_mut().zip(other.0) {
            *to = (to.0 + from.0, to.1 + from.1);
        }
    }

    fn rms(self) -> [Option<f64>; 2] {
        self.0.map(|(sum, count)| (count > 0).then(|| (sum / count as f64).sqrt()))
    }
}

/// Fits again without each experiment in turn, or, where it is the only one or an unknown belongs to it alone,
/// without each of its steps, and says how far off the part that was held out is.
///
/// # Errors
/// As [`identify`]; [`IdentifyError::NothingToHoldOut`] where there are not two such parts, and
/// [`IdentifyError::NotConverged`] where the search without one does not converge.
pub fn cross_validate(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Validated, IdentifyError> {
    check(robot, experiments, unknowns, settings)?;
    let folds = parts(experiments, unknowns);
    if folds.len() < 2 {
        return Err(IdentifyError::NothingToHoldOut);
    }
    let (mut all, mut validated) = (Misses::default(), Vec::with_capacity(folds.len()));
    for (experiment, step) in folds {
        let is_held = |seen: &Observation| step.is_none_or(|step| seen.step == step);
        let (mut kept, mut held) = (experiments.to_vec(), experiments.to_vec());
        kept[experiment].observations.retain(|seen| !is_held(seen));
        for (e, of) in held.iter_mut().enumerate() {
            of.observations.retain(|seen| e == experiment && is_held(seen));
        }
        let found = identify(robot, &kept, unknowns, settings)?;
        if !found.status.is_converged() {
            return Err(IdentifyError::NotConverged { experiment, step });
        }
        let values: Vec<f64> = found.estimates.iter().map(|estimate| estimate.value).collect();
        let misses = misses(robot, &held, unknowns, settings, experiment, &values)?;
        all.add_all(misses);
        let [rms_distance, rms_pixels] = misses.rms();
        validated.push(Fold { experiment, step, values, rms_distance, rms_pixels });
    }
    let [rms_distance, rms_pixels] = all.rms();
    Ok(Validated { folds: validated, rms_distance, rms_pixels })
}

/// What is held out in turn.
fn parts(experiments: &[Experiment], unknowns: &[Unknown]) -> Vec<(usize, Option<usize>)> {
    let seen = |e: &usize| !experiments[*e].observations.is_empty();
    let experiments_seen: Vec<usize> = (0..experiments.len()).filter(seen).collect();
    let mut parts = Vec::new();
    for &e in &experiments_seen {
        // Without what was seen in it nothing would be known of what belongs to it.
        let has_own = unknowns.iter().any(|unknown| unknown.experiment == Some(e));
        if experiments_seen.len() > 1 && !has_own {
            parts.push((e, None));
            continue;
        }
        let mut steps: Vec<usize> =
            experiments[e].observations.iter().map(|seen| seen.step).collect();
        steps.sort_unstable();
        steps.dedup();
        if steps.len() > 1 {
            parts.extend(steps.into_iter().map(|step| (e, Some(step))));
        }
    }
    parts
}

/// How far off what was held out of an experiment is.
fn misses(
    robot: &Robot,
    held: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    experiment: usize,
    values: &[f64],
) -> Result<Misses, IdentifyError> {
    let mut forward = Forward::new(robot, held, unknowns, settings)?;
    let mut predicted = vec![0.0; forward.count()];
    forward
        .predict(experiment, values, &mut predicted)
        .map_err(|reason| IdentifyError::NoAnswerAtStart(NoAnswer { experiment, reason }))?;
    let mut misses = Misses::default();
    let mut row = 0;
    for seen in &held[experiment].observations {
        let numbers = predicted[row..].iter().zip(measured(seen)).take(seen.numbers());
        misses.add(seen, numbers.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt());
        row += seen.numbers();
    }
    Ok(misses)
}
