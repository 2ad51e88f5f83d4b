//! Whether what is left changes with time: a cable that creeps, a base that moves, a tracker that warms up.

use super::experiment::Experiment;
use super::outcome::Identified;
use super::rows::Row;
use std::collections::BTreeMap;
use whipcord_numerics::student_quantile;

/// The straight line through what is left of the rows against time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Rows with a time.
    pub rows: usize,
    /// From the first to the last of them, in s.
    pub duration: f64,
    /// Slope of the mean residual of a row, model less measurement, in m/s.
    pub slope: [f64; 3],
    /// Its standard deviation.
    pub deviation: [f64; 3],
    /// Whether one of the slopes is not zero with a probability of 99 %.
    pub is_significant: bool,
}

/// The drift of what is left; none where fewer than four rows have times that differ.
#[must_use]
pub fn drift(experiments: &[Experiment], found: &Identified) -> Option<Drift> {
    let mut rows: BTreeMap<Row, ([f64; 3], f64)> = BTreeMap::new();
    for residual in found.residuals.iter().filter(|residual| !residual.is_negligible()) {
        let seen = &experiments[residual.experiment].observations[residual.observation];
        if !seen.seen.is_position() {
            continue;
        }
        let row = Row { experiment: residual.experiment, step: seen.step };
        let (sum, count) = rows.entry(row).or_default();
        for (sum, difference) in sum.iter_mut().zip(residual.difference) {
            *sum += difference;
        }
        *count += 1.0;
    }
    let points: Vec<(f64, [f64; 3])> = rows
        .iter()
        .filter_map(|(row, (sum, count))| {
            let time = experiments[row.experiment].labels.get(row.step)?.time?;
            Some((time, sum.map(|sum| sum / count)))
        })
        .collect();
    let n = points.len() as f64;
    let times = || points.iter().map(|(time, _)| *time);
    let mean = times().sum::<f64>() / n;
    let spread: f64 = times().map(|time| (time - mean) * (time - mean)).sum();
    if points.len() < 4 || spread <= 0.0 {
        return None;
    }
    let (mut slope, mut deviation) = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        let level = points.iter().map(|(_, left)| left[axis]).sum::<f64>() / n;
        let along = points.iter().map(|(time, left)| (time - mean) * (left[axis] - level));
        slope[axis] = along.sum::<f64>() / spread;
        let off =
            points.iter().map(|(time, left)| left[axis] - level - slope[axis] * (time - mean));
        deviation[axis] = (off.map(|off| off * off).sum::<f64>() / (n - 2.0) / spread).sqrt();
    }
    // Three tests at 1 % together.
    let limit = student_quantile(1.0 - 0.01 / 6.0, n - 2.0);
    let (first, last) =
        times().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    Some(Drift {
        rows: points.len(),
        duration: last - first,
        slope,
        deviation,
        is_significant: slope.iter().zip(deviation).any(|(slope, of)| slope.abs() > limit * of),
    })
}
