//! Which measurement would help most.

use std::collections::BTreeMap;

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::linear::{Linear, fitted, values};
use super::outcome::Identified;
use super::rows::{Row, rows};
use super::settings::Settings;
use crate::observation::{Observation, Place, Seen};
use whipcord::robot::Robot;
use whipcord_numerics::{DenseLu, Vec3};

/// What one more measurement of a disk in a row would be worth, eq. (i11).
#[derive(Clone, Debug, PartialEq)]
pub struct Worth {
    /// The row.
    pub row: Row,
    /// The disk, from 0.
    pub disk: usize,
    /// Its arc length in m.
    pub arc_length: f64,
    /// Of each unknown, the part by which its variance would fall.
    pub variances: Vec<f64>,
    /// Logarithm of the factor by which the volume of the region of confidence of all unknowns would shrink.
    pub volume: f64,
}

/// More rows than this are thinned out.
const MOST: usize = 400;
/// So many measurements are said to help most.
const BEST: usize = 5;
/// What is not seen at all is as uncertain as this many times the most uncertain of what is.
const UNSEEN: f64 = 1e-12;

/// The worth of measuring the position of each disk once more, as exactly as the other positions, in each row of a fit.
///
/// # Errors
/// [`IdentifyError`] where the model has no answer at the estimate.
pub fn sensitivity(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    found: &Identified,
) -> Result<Vec<Worth>, IdentifyError> {
    let kept = fitted(experiments, found, true);
    let x = values(found);
    let linear = Linear::at(robot, &kept, unknowns, settings, &x)?;
    let n = unknowns.len();
    let free: Vec<usize> = (0..n).filter(|&j| !found.estimates[j].is_at_bound).collect();
    // In units in which each column has length 1.
    let sizes: Vec<f64> = (0..n)
        .map(|j| linear.column(j).iter().map(|x| x * x).sum::<f64>().sqrt())
        .map(|size| if size > 0.0 { size } else { 1.0 })
        .collect();
    let count = free.len();
    let mut information = vec![0.0; count * count];
    for row in linear.jacobian.chunks_exact(n) {
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                information[a * count + b] += row[i] / sizes[i] * row[j] / sizes[j];
            }
        }
    }
    for a in 0..count {
        information[a * count + a] += UNSEEN;
    }
    let mut factors = DenseLu::default();
    if count == 0 || factors.factor(count, &information).is_err() {
        return Ok(Vec::new());
    }
    let covariance = factors.inverse_columns(count);
    let all = rows(&kept);
    let all: Vec<Row> = all.iter().step_by(all.len().div_ceil(MOST).max(1)).copied().collect();
    let deviation = deviation(&kept);
    let disks: Vec<usize> = (1..robot.disks().count()).collect();
    let mut asked = kept.clone();
    for (experiment, of) in asked.iter_mut().enumerate() {
        let steps = all.iter().filter(|row| row.experiment == experiment).map(|row| row.step);
        let at_disks = steps.flat_map(|step| {
            disks.iter().map(move |disk| Observation {
                step,
                place: Place::Disk(*disk),
                offset: Vec3::ZERO,
                seen: Seen::Position(Vec3::ZERO),
                deviation: Some(deviation),
            })
        });
        of.observations = at_disks.collect();
    }
    let more = Linear::at(robot, &asked, unknowns, settings, &x)?;
    let mut worths = Vec::new();
    let blocks = more.jacobian.chunks_exact(3 * n);
    for ((row, disk), block) in
        all.iter().flat_map(|row| disks.iter().map(move |disk| (row, disk))).zip(blocks)
    {
        let rows: Vec<Vec<f64>> = block
            .chunks_exact(n)
            .map(|row| free.iter().map(|&j| row[j] / sizes[j]).collect())
            .collect();
        let (fallen, volume) = updated(&covariance, &rows);
        let mut variances = vec![0.0; n];
        for (a, &j) in free.iter().enumerate() {
            variances[j] = (1.0 - fallen[a] / covariance[a][a]).clamp(0.0, 1.0);
        }
        let arc_length = robot.disks().arc_lengths[*disk];
        worths.push(Worth { row: *row, disk: *disk, arc_length, variances, volume });
    }
    Ok(worths)
}

/// The measurements that would help most, the best one first, each of another row.
#[must_use]
pub fn best_measurements(worths: &[Worth]) -> Vec<&Worth> {
    let mut all: Vec<&Worth> = worths.iter().collect();
    all.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    let mut best: Vec<&Worth> = Vec::new();
    for worth in all {
        if best.len() < BEST && best.iter().all(|other| other.row != worth.row) {
            best.push(worth);
        }
    }
    best
}

/// The mean worth of each disk over all rows, by arc length.
#[must_use]
pub fn worth_by_disk(worths: &[Worth]) -> Vec<Worth> {
    let mut by_disk: BTreeMap<usize, (Worth, f64)> = BTreeMap::new();
    for worth in worths {
        let Some((sum, count)) = by_disk.get_mut(&worth.disk) else {
            by_disk.insert(worth.disk, (worth.clone(), 1.0));
            continue;
        };
        sum.volume += worth.volume;
        sum.variances.iter_mut().zip(&worth.variances).for_each(|(sum, of)| *sum += of);
        *count += 1.0;
    }
    let mean = |(mut sum, count): (Worth, f64)| {
        sum.volume /= count;
        sum.variances.iter_mut().for_each(|variance| *variance /= count);
        sum
    };
    by_disk.into_values().map(mean).collect()
}

/// The usual deviation of a position.
fn deviation(experiments: &[Experiment]) -> f64 {
    let all = experiments.iter().flat_map(|of| &of.observations);
    let of = |seen: &Observation| seen.deviation.filter(|_| seen.seen.is_position());
    let mut all: Vec<f64> = all.filter_map(of).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(1e-3)
}

/// The variances after measurements with these derivatives and a deviation of 1, one after the other, and the logarithm of the
/// factor by which the volume shrinks.
fn updated(covariance: &[Vec<f64>], rows: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let mut c = covariance.to_vec();
    let mut volume = 0.0;
    for row in rows {
        let along: Vec<f64> =
            c.iter().map(|of| of.iter().zip(row).map(|(a, b)| a * b).sum()).collect();
        let size = 1.0 + along.iter().zip(row).map(|(a, b)| a * b).sum::<f64>();
        for (i, of) in c.iter_mut().enumerate() {
            for (j, entry) in of.iter_mut().enumerate() {
                *entry -= along[i] * along[j] / size;
            }
        }
        volume += 0.5 * size.max(1.0).ln();
    }
    ((0..c.len()).map(|i| c[i][i]).collect(), volume)
}
