//! The linearised problem at an estimate, in units of the noise.

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::forward::{Forward, measured};
use super::outcome::Identified;
use super::rows::{Row, marked, without};
use super::settings::Settings;
use std::collections::BTreeSet;
use whipcord::robot::Robot;
use whipcord_numerics::dot;

/// Residuals and their derivatives, by rows, in units of the noise; priors are the last rows.
pub(super) struct Linear {
    pub(super) residuals: Vec<f64>,
    pub(super) jacobian: Vec<f64>,
    pub(super) unknowns: usize,
}

/// The measurements that a fit took into account: without the rows that it skipped, each with its deviation; of a robust fit,
/// `weighed` makes those less exact that it counted less.
pub(super) fn fitted(
    experiments: &[Experiment],
    found: &Identified,
    weighed: bool,
) -> Vec<Experiment> {
    let mut all = marked(experiments, &found.over_determined);
    if found.noise.is_estimated && found.noise.level > 0.0 {
        for seen in all.iter_mut().flat_map(|of| &mut of.observations) {
            seen.deviation = Some(found.noise.level);
        }
    }
    for residual in found.residuals.iter().filter(|_| weighed) {
        let seen = &mut all[residual.experiment].observations[residual.observation];
        let weight = residual.weight.max(LEAST_WEIGHT);
        seen.deviation = seen.deviation.map(|deviation| deviation / weight.sqrt());
    }
    let skipped: BTreeSet<Row> = found.skipped.iter().map(|of| of.row).collect();
    without(&all, &skipped)
}

const LEAST_WEIGHT: f64 = 1e-9;

/// The values of a fit.
pub(super) fn values(found: &Identified) -> Vec<f64> {
    found.estimates.iter().map(|estimate| estimate.value).collect()
}

impl Linear {
    /// At these values, of measurements that say their deviations.
    pub(super) fn at(
        robot: &Robot,
        experiments: &[Experiment],
        unknowns: &[Unknown],
        settings: &Settings,
        x: &[f64],
    ) -> Result<Self, IdentifyError> {
        let mut forward = Forward::new(robot, experiments, unknowns, settings)?;
        let (n, scales) = (unknowns.len(), forward.scales(x));
        let mut predicted = vec![0.0; forward.count()];
        let mut columns = vec![0.0; forward.count() * n];
        forward
            .predict_with_columns(x, &mut predicted, &mut columns)
            .and_then(|()| forward.add_differences(x, &scales, &mut columns))
            .map_err(IdentifyError::NoAnswerAtStart)?;
        let (mut residuals, mut jacobian) = (Vec::new(), Vec::new());
        for seen in experiments.iter().flat_map(|of| &of.observations) {
            let deviation = seen.deviation.unwrap_or(1.0);
            for number in measured(seen).iter().take(seen.numbers()) {
                let row = residuals.len();
                residuals.push((predicted[row] - number) / deviation);
                jacobian.extend(columns[row * n..][..n].iter().map(|entry| entry / deviation));
            }
        }
        for (j, unknown) in unknowns.iter().enumerate() {
            let Some(prior) = unknown.prior else { continue };
            residuals.push((x[j] - prior.mean) / prior.deviation);
            jacobian.extend((0..n).map(|i| if i == j { 1.0 / prior.deviation } else { 0.0 }));
        }
        Ok(Self { residuals, jacobian, unknowns: n })
    }

    /// A column of the derivatives.
    pub(super) fn column(&self, j: usize) -> Vec<f64> {
        self.jacobian.iter().skip(j).step_by(self.unknowns).copied().collect()
    }
}

/// What is left of a column beside those of an orthonormal basis.
pub(super) fn beside(basis: &[Vec<f64>], mut column: Vec<f64>) -> Vec<f64> {
    // Twice is enough (Giraud, Langou and Rozložník, Comput. Math. Appl. 50 (2005) 1069).
    for _ in 0..2 {
        for direction in basis {
            let along = dot(direction, &column);
            for (entry, direction) in column.iter_mut().zip(direction) {
                *entry -= along * direction;
            }
        }
    }
    column
}
