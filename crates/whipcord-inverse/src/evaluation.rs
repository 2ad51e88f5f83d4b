//! An answer with its derivatives by the unknowns of an inverse problem.

use std::sync::Arc;

use whipcord::{CableState, Solution, Twist, Wrench};

/// An answer of the model with its derivatives by the unknowns.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation {
    pub solution: Solution,
    /// Tension of each cable in N, where the model knows it.
    pub tensions: Vec<Option<f64>>,
    /// Command of each cable as a shortening in m.
    pub shortenings: Vec<f64>,
    /// Its derivatives, which the answers near it share.
    pub rates: Arc<Rates>,
}

/// The derivatives of an answer by the unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rates {
    /// The unknowns that they belong to.
    pub at: Vec<f64>,
    /// Motions of the places that were asked for in the world, of each unknown.
    pub motions: Vec<Vec<Twist>>,
    /// Rates of the tensions by the unknowns: of cable i by unknown k at `[k][i]`.
    pub tension_rates: Vec<Vec<f64>>,
    /// Rates of the commands as shortenings, likewise.
    pub shortening_rates: Vec<Vec<f64>>,
    /// Rates of the wrench at the base by the unknowns; none of a model without exact derivatives.
    pub base_rates: Vec<Wrench>,
}

impl Evaluation {
    /// Where a solve for commands that differ by these changes starts from: the solution, with the wrench at the base and the tensions
    /// extrapolated. That of a rod on few steps, which starts from these alone, has no shape.
    pub fn extrapolated(
        &self,
        changes: impl Iterator<Item = f64>,
        is_on_few_steps: bool,
    ) -> Solution {
        let Solution { model, cables, base_wrench, diagnostics, .. } = &self.solution;
        let mut near = match is_on_few_steps {
            true => {
                let of = |cable: &CableState| CableState {
                    tension: cable.tension,
                    ..CableState::default()
                };
                Solution {
                    cables: cables.iter().map(of).collect(),
                    base_wrench: *base_wrench,
                    diagnostics: diagnostics.clone(),
                    ..Solution::empty(*model)
                }
            }
            false => self.solution.clone(),
        };
        // What is told of the base is nearer than what was at the nodes.
        near.internal.clear();
        for (k, change) in changes.enumerate() {
            if let (Some(wrench), Some(rate)) =
                (&mut near.base_wrench, self.rates.base_rates.get(k))
            {
                wrench.force += rate.force * change;
                wrench.moment += rate.moment * change;
            }
            let rates = self.rates.tension_rates.get(k).into_iter().flatten();
            for (cable, rate) in near.cables.iter_mut().zip(rates) {
                cable.tension = cable.tension.map(|tension| tension + rate * change);
            }
        }
        for cable in &mut near.cables {
            cable.tension = cable.tension.map(|tension| tension.max(0.0));
        }
        near
    }

    /// The commands as shortenings for unknowns that differ by these changes, to first order.
    pub fn shortenings_after(&self, changes: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut shortenings = self.shortenings.clone();
        for (rates, change) in self.rates.shortening_rates.iter().zip(changes) {
            shortenings.iter_mut().zip(rates).for_each(|(of, rate)| *of += rate * change);
        }
        shortenings
    }
}
