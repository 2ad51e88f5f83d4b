//! How well a fit says what it has not seen.

use std::collections::{BTreeMap, BTreeSet};

use super::check::{check, check_observations};
use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::forward::{Forward, measured};
use super::identify::identify;
use super::noise::median;
use super::registered::placed;
use super::rows::{OverDetermined, Row, Skipped, only, rows, without};
use super::settings::Settings;
use crate::observation::Observation;
use whipcord::robot::Robot;
use whipcord_numerics::random::SplitMix64;

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
    /// The experiment, from 0; that of the first row, where there are several.
    pub experiment: usize,
    /// The step that was held out of it, from 0, where that is a single one; else the whole of it, or [`Self::rows`].
    pub step: Option<usize>,
    /// The group of rows that was held out, where rows have groups.
    pub group: Option<String>,
    /// The rows that were held out.
    pub rows: Vec<Row>,
    /// The estimates without it.
    pub values: Vec<f64>,
    /// Root mean square distance in m of its markers from where the fit without them has them.
    pub rms_distance: Option<f64>,
    /// The same in pixels.
    pub rms_pixels: Option<f64>,
    /// The rows of it to which the model has no answer.
    pub skipped: Vec<Skipped>,
}

/// How far off a fit is from measurements that it has not seen.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// The rows that were predicted, each with the root mean square distance of its markers in m; none of those in images.
    pub rows: Vec<(Row, Option<f64>)>,
    /// Root mean square distance in m over all markers whose position was seen.
    pub rms_distance: Option<f64>,
    /// The same in pixels of those that were seen in images.
    pub rms_pixels: Option<f64>,
    /// The rows to which the model has no answer.
    pub skipped: Vec<Skipped>,
    /// The rows whose cable lengths contradict each other, which are met in the least-squares sense.
    pub over_determined: Vec<OverDetermined>,
}

impl HeldOut {
    /// Median in m of the rows' root mean square distances, which a few jumps of a tracker do not change.
    #[must_use]
    pub fn median_distance(&self) -> Option<f64> {
        let mut all: Vec<f64> = self.rows.iter().filter_map(|(_, distance)| *distance).collect();
        median(&mut all)
    }
}

/// Sums of squares, of distances and of pixels, and their counts.
#[derive(Clone, Copy, Default)]
struct Misses([(f64, usize); 2]);

impl Misses {
    fn add(&mut self, seen: &Observation, distance: f64) {
        // Turns are no distances.
        if seen.seen.is_rotation() {
            return;
        }
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

/// More single rows than this are held out in blocks of neighbouring ones.
const MOST_SINGLE: usize = 20;
/// How many blocks there are then.
const BLOCKS: usize = 10;

/// Fits again without each part of the measurements in turn, and says how far off that part is. The parts are the groups of rows
/// ([`super::RowLabel::group`]) where they are given; else the experiments, or, where there is only one or an unknown belongs to it
/// alone, its steps: each by itself, or ten blocks of neighbouring ones where there are more than twenty.
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
    let parts = parts(experiments, unknowns);
    if parts.len() < 2 {
        return Err(IdentifyError::NothingToHoldOut);
    }
    let (mut all, mut validated) = (Misses::default(), Vec::with_capacity(parts.len()));
    for Part { step, group, rows } in parts {
        let experiment = rows.first().map_or(0, |row| row.experiment);
        let held: BTreeSet<Row> = rows.iter().copied().collect();
        let found = identify(robot, &only(experiments, &held, false), unknowns, settings)?;
        if !found.status.is_converged() {
            return Err(IdentifyError::NotConverged { experiment, step });
        }
        let values: Vec<f64> = found.estimates.iter().map(|estimate| estimate.value).collect();
        let held = only(experiments, &held, true);
        let (misses, _, skipped, _) = predict(robot, &held, unknowns, settings, &values)?;
        let [rms_distance, rms_pixels] = misses.rms();
        all.add_all(misses);
        validated.push(Fold {
            experiment,
            step,
            group,
            rows,
            values,
            rms_distance,
            rms_pixels,
            skipped,
        });
    }
    let [rms_distance, rms_pixels] = all.rms();
    Ok(Validated { folds: validated, rms_distance, rms_pixels })
}

/// How far off a fit with these values is from what was seen in other experiments with the same robot, of which the unknowns that
/// belong to one experiment say nothing, or in other steps of the same experiments.
///
/// # Errors
/// [`IdentifyError`] where the measurements contradict robot and case.
pub fn hold_out(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    values: &[f64],
) -> Result<HeldOut, IdentifyError> {
    check_observations(robot, experiments)?;
    let (misses, rows, skipped, over_determined) =
        predict(robot, experiments, unknowns, settings, values)?;
    if settings.model.cancel().is_cancelled() {
        return Err(IdentifyError::Cancelled);
    }
    let [rms_distance, rms_pixels] = misses.rms();
    Ok(HeldOut { rows, rms_distance, rms_pixels, skipped, over_determined })
}

/// Measurements in two parts, to fit and to hold out: at least this fraction of the rows is held out, chosen at random by a seed.
/// Groups of rows, where they are given, stay together.
///
/// # Errors
/// [`IdentifyError::NothingToHoldOut`] where one part would be empty.
pub fn split(
    experiments: &[Experiment],
    fraction: f64,
    seed: u64,
) -> Result<[Vec<Experiment>; 2], IdentifyError> {
    let all = rows(experiments);
    let mut units = groups(experiments, &all).map_or_else(
        || all.iter().map(|row| vec![*row]).collect(),
        |groups| groups.into_values().collect::<Vec<_>>(),
    );
    let wanted = (fraction * all.len() as f64).ceil() as usize;
    let mut random = SplitMix64::new(seed);
    let mut held = BTreeSet::new();
    // The last unit is never held out.
    while held.len() < wanted && units.len() > 1 {
        let chosen = (random.next_u64() % units.len() as u64) as usize;
        held.extend(units.swap_remove(chosen));
    }
    if held.is_empty() {
        return Err(IdentifyError::NothingToHoldOut);
    }
    Ok([only(experiments, &held, false), only(experiments, &held, true)])
}

/// What is held out at once.
struct Part {
    step: Option<usize>,
    group: Option<String>,
    rows: Vec<Row>,
}

/// The rows of each group; none where no row has one. Rows without one are a group by themselves.
fn groups(experiments: &[Experiment], all: &[Row]) -> Option<BTreeMap<String, Vec<Row>>> {
    let group = |row: &Row| experiments[row.experiment].labels.get(row.step)?.group.clone();
    if !all.iter().any(|row| group(row).is_some()) {
        return None;
    }
    let mut groups: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for row in all {
        groups.entry(group(row).unwrap_or_default()).or_default().push(*row);
    }
    Some(groups)
}

/// What is held out in turn.
fn parts(experiments: &[Experiment], unknowns: &[Unknown]) -> Vec<Part> {
    let all = rows(experiments);
    if let Some(groups) = groups(experiments, &all) {
        let part = |(group, rows)| Part { step: None, group: Some(group), rows };
        return groups.into_iter().map(part).collect();
    }
    let own = |e: usize| all.iter().filter(move |row| row.experiment == e).copied();
    let seen: BTreeSet<usize> = all.iter().map(|row| row.experiment).collect();
    let mut parts = Vec::new();
    for &e in &seen {
        let rows: Vec<Row> = own(e).collect();
        // Without what was seen in it nothing would be known of what belongs to it.
        let has_own = unknowns.iter().any(|unknown| unknown.experiment == Some(e));
        if seen.len() > 1 && !has_own {
            parts.push(Part { step: None, group: None, rows });
        } else if rows.len() > MOST_SINGLE {
            let size = rows.len().div_ceil(BLOCKS);
            let block = |rows: &[Row]| Part { step: None, group: None, rows: rows.to_vec() };
            parts.extend(rows.chunks(size).map(block));
        } else if rows.len() > 1 {
            let single = |row: Row| Part { step: Some(row.step), group: None, rows: vec![row] };
            parts.extend(rows.into_iter().map(single));
        }
    }
    parts
}

/// What is said of rows: the misses of all, the distance of each, the rows without an answer, and those whose lengths contradict each other.
type Predicted = (Misses, Vec<(Row, Option<f64>)>, Vec<Skipped>, Vec<OverDetermined>);

/// How far off what was held out is.
fn predict(
    robot: &Robot,
    held: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    values: &[f64],
) -> Result<Predicted, IdentifyError> {
    let (marked, skipped) = Forward::new(robot, held, unknowns, settings)?.marked(values);
    let held = &placed(robot, &marked, (unknowns, values), settings)?[..];
    let left_out: BTreeSet<Row> = skipped.iter().map(|of| of.row).collect();
    let seen: BTreeSet<Row> = rows(held).into_iter().collect();
    let skipped = skipped.into_iter().filter(|of| seen.contains(&of.row)).collect();
    let held = without(held, &left_out);
    let forward = Forward::new(robot, &held, unknowns, settings)?;
    let mut predicted = vec![0.0; forward.count()];
    forward.predict(values, &mut predicted).map_err(IdentifyError::NoAnswerAtStart)?;
    let (mut all, mut of_rows) = (Misses::default(), BTreeMap::<Row, Misses>::new());
    for (experiment, of) in held.iter().enumerate().filter(|(_, of)| !of.observations.is_empty()) {
        let first = forward.first_rows[experiment];
        let mut row = first;
        for seen in &of.observations {
            let numbers = predicted[row..].iter().zip(measured(seen)).take(seen.numbers());
            let distance = numbers.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            all.add(seen, distance);
            of_rows.entry(Row { experiment, step: seen.step }).or_default().add(seen, distance);
            row += seen.numbers();
        }
    }
    let rows = of_rows.into_iter().map(|(row, misses)| (row, misses.rms()[0])).collect();
    let over_determined = forward.missed(&forward.over_determined_rows(), values);
    Ok((all, rows, skipped, over_determined))
}
