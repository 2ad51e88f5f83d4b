//! Several starts of a search, for fits that end in different minima.

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::forward::Forward;
use super::outcome::{Identified, Starts};
use super::settings::Settings;
use whipcord::robot::Robot;

/// A positive number starts between a third and three times of where it is.
const FACTOR: f64 = 3.0;
/// Others start so much of what matters beside where they are.
const BESIDE: f64 = 0.1;
/// Of the estimates, in units of what matters: ends that are no further apart are one minimum.
const SAME: f64 = 1e-3;

/// What a search from where the unknowns start finds.
type Found = Result<Identified, IdentifyError>;

/// The best of several searches: the first from where the unknowns start, the others from places around it, or between the bounds.
pub(super) fn best_of(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    search: impl Fn(&[Unknown]) -> Found,
) -> Found {
    let first = search(unknowns);
    if settings.starts <= 1 {
        return first;
    }
    let forward = match Forward::new(robot, experiments, unknowns, settings) {
        Ok(forward) => forward,
        Err(error) => return first.and(Err(error)),
    };
    let start = forward.start()?;
    let scales = forward.scales(&start);
    let mut all = vec![first];
    for number in 1..settings.starts {
        if settings.model.cancel().is_cancelled() {
            return Err(IdentifyError::Cancelled);
        }
        let moved: Vec<Unknown> = unknowns
            .iter()
            .enumerate()
            .map(|(j, unknown)| {
                let at = beside(unknown, start[j], scales[j], quasi_random(number, j));
                Unknown { start: Some(at), ..unknown.clone() }
            })
            .collect();
        all.push(search(&moved));
    }
    let (mut found, mut errors): (Vec<Identified>, Vec<IdentifyError>) = (Vec::new(), Vec::new());
    for one in all {
        match one {
            Ok(one) => found.push(one),
            Err(error) => errors.push(error),
        }
    }
    let ends: Vec<Vec<f64>> = found
        .iter()
        .filter(|one| one.status.is_converged())
        .map(|one| one.estimates.iter().map(|estimate| estimate.value).collect())
        .collect();
    // The first of those that are alike.
    let best = found
        .into_iter()
        .min_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(core::cmp::Ordering::Equal));
    let Some(mut best) = best else {
        return Err(errors.swap_remove(0));
    };
    let is_same = |end: &&Vec<f64>| {
        best.estimates.iter().zip(end.iter()).zip(&scales).all(|((estimate, end), scale)| {
            let own = estimate.deviation.map_or(0.0, |deviation| 0.1 * deviation);
            (estimate.value - end).abs() <= (SAME * scale).max(own)
        })
    };
    let agree = ends.iter().filter(is_same).count();
    best.starts = Starts { tried: settings.starts, agree };
    // The unknowns start where they were said to.
    for (estimate, unknown) in best.estimates.iter_mut().zip(unknowns) {
        estimate.unknown = unknown.clone();
    }
    Ok(best)
}

/// What makes a fit better: that it has converged, that fewer rows are left out, that it is more likely.
fn rank(of: &Identified) -> (bool, usize, f64) {
    (!of.status.is_converged(), of.skipped.len(), of.aic.unwrap_or(f64::NEG_INFINITY))
}

/// A start beside another, by a number from 0 to 1.
fn beside(unknown: &Unknown, start: f64, scale: f64, at: f64) -> f64 {
    if unknown.quantity.is_of_frame() {
        return start;
    }
    let (least, greatest) = (unknown.least(), unknown.greatest());
    let [low, high] = unknown.bounds;
    let moved = if low.is_finite() && high.is_finite() {
        low + at * (high - low)
    } else if unknown.is_positive() && start > 0.0 {
        start * FACTOR.powf(2.0 * at - 1.0)
    } else {
        start + BESIDE * scale * (2.0 * at - 1.0)
    };
    moved.max(least).min(greatest)
}

/// Numbers that fill the space evenly (Roberts, The unreasonable effectiveness of quasirandom sequences, 2018: an additive
/// recurrence, here by the roots of primes).
fn quasi_random(number: usize, coordinate: usize) -> f64 {
    let prime = nth_prime(coordinate) as f64;
    (0.5 + number as f64 * prime.sqrt()).fract()
}

fn nth_prime(n: usize) -> usize {
    let is_prime = |k: &usize| (2..).take_while(|d| d * d <= *k).all(|d| !k.is_multiple_of(d));
    (2..).filter(is_prime).nth(n).unwrap_or(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_fill_the_space() {
        assert_eq!([0, 1, 2, 5].map(nth_prime), [2, 3, 5, 13]);
        for coordinate in 0..6 {
            let mut halves = [0; 2];
            for number in 1..=20 {
                halves[usize::from(quasi_random(number, coordinate) >= 0.5)] += 1;
            }
            assert!(halves.iter().all(|count| *count >= 7), "{halves:?}");
        }
    }
}
