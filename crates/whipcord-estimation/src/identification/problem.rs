//! The least-squares problem: what the model says less what was seen, in units of the noise, and priors.

use whipcord_numerics::least_squares::{Loss, Residuals};

use super::error::{NoAnswer, NoAnswerReason};
use super::experiment::Unknown;
use super::forward::{Forward, measured};
use super::logarithm::Logarithms;
use super::settings::Progress;
use whipcord::model::Model;

/// Errors of the steps that are no greater than this part of what is left move the estimates by no more than so many times the root of the
/// count of numbers in their deviations: 3 % where ten thousand were measured.
const NEGLIGIBLE: f64 = 3e-4;

/// Eq. (i4). The rows are those of the observations in their order, and after them the priors.
pub(super) struct Problem<'f, 'a> {
    forward: &'f mut Forward<'a>,
    /// Deviation of every number whose observation does not say it, in m or pixels.
    noise: f64,
    scales: &'f [f64],
    logarithms: &'f Logarithms,
    /// The unknowns that were tried last.
    x: Vec<f64>,
    /// Count of the numbers of each observation, at its first row.
    blocks: Vec<usize>,
    /// Deviation of the number in each row.
    deviations: Vec<f64>,
    /// What was seen, in each row.
    seen: Vec<f64>,
    /// Who is told, and the evaluations so far.
    progress: &'f Progress,
    evaluations: usize,
    /// The exact columns at the numbers that were tried last.
    columns: Vec<f64>,
}

impl<'f, 'a> Problem<'f, 'a> {
    pub(super) fn new(
        forward: &'f mut Forward<'a>,
        logarithms: &'f Logarithms,
        scales: &'f [f64],
        progress: &'f Progress,
    ) -> Self {
        let (mut blocks, mut deviations, mut seen) = (Vec::new(), Vec::new(), Vec::new());
        for observation in forward.experiments.iter().flat_map(|of| &of.observations) {
            let count = observation.numbers();
            for (i, value) in measured(observation)[..count].iter().enumerate() {
                blocks.push(count - i);
                deviations.push(observation.deviation.unwrap_or(1.0));
                seen.push(*value);
            }
        }
        let columns = vec![0.0; seen.len() * forward.unknowns.len()];
        let x = vec![0.0; forward.unknowns.len()];
        Self {
            forward,
            noise: 1.0,
            scales,
            logarithms,
            x,
            blocks,
            deviations,
            seen,
            columns,
            progress,
            evaluations: 0,
        }
    }

    /// What is searched, of these unknowns.
    pub(super) fn searched(&self, x: &[f64]) -> Vec<f64> {
        x.iter().enumerate().map(|(j, x)| self.logarithms.searched(j, *x)).collect()
    }

    /// The unknowns, of what is searched.
    pub(super) fn found(&self, y: &[f64], x: &mut [f64]) {
        self.logarithms.unknowns(y, x);
    }

    /// Takes this deviation for the numbers whose observations do not say one.
    pub(super) fn set_noise(&mut self, noise: f64) {
        self.noise = noise;
    }

    /// Goes on with another model; that which it was.
    pub(super) fn replace_model(&mut self, model: Model) -> Model {
        core::mem::replace(&mut self.forward.model, model)
    }

    /// Whether the model leaves these residuals too, but for errors that are far below them.
    pub(super) fn confirms(&self, x: &[f64], residuals: &[f64]) -> bool {
        let mut predicted = vec![0.0; self.seen.len()];
        if self.forward.predict(x, &mut predicted).is_err() {
            return false;
        }
        let (mut off, mut all) = (0.0, 0.0);
        for (((value, seen), deviation), residual) in
            predicted.iter().zip(&self.seen).zip(&self.deviations).zip(residuals)
        {
            let own = (value - seen) / (deviation * self.noise);
            off += (own - residual) * (own - residual);
            all += residual * residual;
        }
        off <= NEGLIGIBLE * NEGLIGIBLE * all
    }

    /// What is made least, without derivatives; none where there is no answer.
    pub(super) fn cost(&self, y: &[f64], loss: Loss) -> Option<f64> {
        let mut x = vec![0.0; y.len()];
        self.logarithms.unknowns(y, &mut x);
        let mut off = vec![0.0; self.seen.len()];
        self.forward.predict(&x, &mut off).ok()?;
        for ((value, seen), deviation) in off.iter_mut().zip(&self.seen).zip(&self.deviations) {
            *value = (*value - seen) / (deviation * self.noise);
        }
        let square = |block: &[f64]| block.iter().map(|r| r * r).sum::<f64>();
        let seen: f64 = self.blocks(&off).map(|block| loss.of(square(block)).0).sum();
        let priors = self.forward.unknowns.iter().zip(&x);
        let prior = |(unknown, value): (&Unknown, &f64)| {
            unknown.prior.map_or(0.0, |of| ((value - of.mean) / of.deviation).powi(2))
        };
        let cost = 0.5 * (seen + priors.map(prior).sum::<f64>());
        cost.is_finite().then_some(cost)
    }

    /// Count of the numbers that were seen.
    pub(super) fn seen(&self) -> usize {
        self.seen.len()
    }

    /// Count of the unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.forward.unknowns.len()
    }

    /// Count of the priors.
    pub(super) fn priors(&self) -> usize {
        self.forward.unknowns.iter().filter(|unknown| unknown.prior.is_some()).count()
    }

    /// The residuals of each observation.
    pub(super) fn blocks<'r>(&'r self, residuals: &'r [f64]) -> impl Iterator<Item = &'r [f64]> {
        let mut first = 0;
        core::iter::from_fn(move || {
            let count = *self.blocks.get(first)?;
            first += count;
            Some(&residuals[first - count..first])
        })
    }

    /// The largest number that was seen.
    pub(super) fn extent(&self) -> f64 {
        self.seen.iter().fold(0.0, |most, seen| seen.abs().max(most))
    }

    /// Whether every observation says how exact it is.
    pub(super) fn is_noise_known(&self) -> bool {
        let mut all = self.forward.experiments.iter().flat_map(|of| &of.observations);
        all.all(|seen| seen.deviation.is_some())
    }
}

impl Residuals for Problem<'_, '_> {
    type Refusal = NoAnswer;

    fn count(&self) -> usize {
        self.seen() + self.priors()
    }

    fn block(&self, first: usize) -> usize {
        self.blocks.get(first).copied().unwrap_or(1)
    }

    fn takes_loss(&self, first: usize) -> bool {
        first < self.seen()
    }

    fn residuals(&mut self, y: &[f64], into: &mut [f64]) -> Result<(), NoAnswer> {
        self.logarithms.unknowns(y, &mut self.x);
        let x = &self.x;
        let seen = &mut into[..self.seen.len()];
        self.forward.predict_with_columns(x, seen, &mut self.columns)?;
        for ((value, seen), deviation) in into.iter_mut().zip(&self.seen).zip(&self.deviations) {
            *value = (*value - seen) / (deviation * self.noise);
        }
        self.evaluations += 1;
        let count = self.seen.len();
        let sum: f64 = into[..count].iter().map(|r| r * r).sum();
        self.progress.tell(self.evaluations, self.noise * (sum / count as f64).sqrt());
        let priors = self.forward.unknowns.iter().zip(x);
        let priors = priors.filter_map(|(unknown, value)| Some((unknown.prior?, value)));
        for (row, (prior, value)) in into[self.seen.len()..].iter_mut().zip(priors) {
            *row = (value - prior.mean) / prior.deviation;
        }
        Ok(())
    }

    fn jacobian(&mut self, y: &[f64], into: &mut [f64]) -> Result<(), NoAnswer> {
        let (n, x) = (y.len(), &self.x);
        self.forward.add_differences(x, self.scales, &mut self.columns)?;
        into.fill(0.0);
        let rows = into.chunks_exact_mut(n).zip(self.columns.chunks_exact(n));
        for ((row, column), deviation) in rows.zip(&self.deviations) {
            for (entry, value) in row.iter_mut().zip(column) {
                *entry = value / (deviation * self.noise);
            }
        }
        let priors = self.forward.unknowns.iter().enumerate();
        let priors = priors.filter_map(|(j, unknown)| Some((j, unknown.prior?)));
        for (row, (j, prior)) in into.chunks_exact_mut(n).skip(self.seen.len()).zip(priors) {
            row[j] = 1.0 / prior.deviation;
        }
        for row in into.chunks_exact_mut(n) {
            for (j, (entry, x)) in row.iter_mut().zip(x).enumerate() {
                *entry *= self.logarithms.slope(j, *x);
            }
        }
        if into.iter().any(|entry| !entry.is_finite()) {
            return Err(NoAnswer { experiment: 0, reason: NoAnswerReason::NotFinite });
        }
        Ok(())
    }
}
