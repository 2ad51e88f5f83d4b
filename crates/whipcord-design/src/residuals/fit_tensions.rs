//! Tensions that suit what else was drawn, before draws of several goals are compared.

use whipcord_numerics::least_squares::{Options, Workspace, minimise};

use super::{Bounded, Problem, RefineOptions};
use crate::goal::ShapeGoal;
use crate::unknown::{Unknown, applied};

impl<'a> Problem<'a> {
    /// Fits the tensions of all goals by so many steps, all else held; they stay as they are where the model has no answer.
    pub fn fit_tensions(
        &self,
        values: &mut [f64],
        unknowns: &[Bounded],
        options: &RefineOptions<'a>,
        steps: usize,
    ) {
        let is_tension = |of: &Bounded| matches!(of.unknown, Unknown::Tension { .. });
        let places: Vec<usize> =
            (0..unknowns.len()).filter(|k| is_tension(&unknowns[*k])).collect();
        if places.is_empty() || places.len() == unknowns.len() {
            return;
        }
        let Ok((robot, cases)) = applied(self.robot, &self.cases, &self.unknowns, values) else {
            return;
        };
        let goals: Vec<ShapeGoal> = self
            .goals
            .iter()
            .zip(cases)
            .map(|(goal, case)| ShapeGoal { case, ..goal.clone() })
            .collect();
        let own: Vec<Bounded> = places.iter().map(|&k| unknowns[k]).collect();
        let minimiser = Options {
            lower: own.iter().map(|of| of.range[0]).collect(),
            upper: own.iter().map(|of| of.range[1]).collect(),
            iterations: steps,
            ..Options::default()
        };
        let mut fitted: Vec<f64> = places.iter().map(|&k| values[k]).collect();
        let options = RefineOptions { criteria: None, ..*options };
        let Ok(mut problem) = Problem::new(&self.model, &robot, &goals, &own, &options) else {
            return;
        };
        if minimise(&mut problem, &mut fitted, &minimiser, &mut Workspace::default()).is_ok() {
            places.iter().zip(fitted).for_each(|(&k, value)| values[k] = value);
        }
    }
}
