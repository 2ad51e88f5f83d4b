//! The equations of the holes beside the linearised stage, for derivatives over motions, section "Gradients" of the page on motion.

use whipcord::HoleEquation;
use whipcord_numerics::Twist;

use crate::block::{add, sum};
use crate::conserving::along;
use crate::rod::Rod;
use crate::stage::Stage;

/// The linearised equations of all holes of a stage that is solved, in the cases that hold there.
pub(crate) struct HoleRows {
    pub equations: Vec<HoleEquation>,
    /// The cable of each passage.
    pub cables: Vec<usize>,
    /// The passages of its cable from each passage on.
    pub from: Vec<Vec<usize>>,
    /// The cables on motors with inertia, each with its passage between motor and base.
    pub outside: Vec<(usize, usize)>,
    /// What a tension of 1 N in each passage exerts on the strains of the stage, times the weights of the points.
    pub pulls: Vec<Vec<Twist>>,
    /// Gradient by the strains at the end of the step of the length of each cable from the near hole of each passage on.
    pub beyond: Vec<Vec<Twist>>,
    /// The same of the angle in that hole.
    pub turns: Vec<Vec<Twist>>,
    /// How far in m a tension of 1 N stretches the cable in each passage.
    pub yielding: Vec<f64>,
}

impl HoleRows {
    pub fn count(&self) -> usize {
        self.equations.len()
    }

    /// Gradient by the strains at the end of the step of what an equation contains of lengths and angles.
    pub fn gradient(&self, row: usize) -> Vec<Twist> {
        let equation = &self.equations[row];
        match equation.keeps_length {
            true => self.beyond[row].clone(),
            false => self.turns[row].iter().map(|of| *of * equation.by_turn).collect(),
        }
    }

    /// What an equation has for changes of the strains at the end of the step.
    pub fn by_strains(&self, row: usize, end: &[Twist]) -> f64 {
        let equation = &self.equations[row];
        match equation.keeps_length {
            true => sum(&self.beyond[row], end),
            false => sum(&self.turns[row], end) * equation.by_turn,
        }
    }

    /// What a tension of 1 N in each passage does on multipliers.
    pub fn tension_work(&self, rod: &Rod, stage: &Stage, on: &[Twist]) -> Vec<f64> {
        let mut of_points = vec![Twist::default(); rod.points.len()];
        along(rod, &stage.strains, on, &mut of_points);
        self.pulls.iter().map(|pull| sum(pull, &of_points)).collect()
    }

    /// Changes of the unstretched lengths beyond all holes at the end of a step, by those of strains and tensions.
    pub fn beyond_changes(&self, end: &[Twist], tensions: &[f64]) -> Vec<f64> {
        let of_passage = |p: usize| {
            let stretch: f64 = self.from[p].iter().map(|&k| self.yielding[k] * tensions[k]).sum();
            sum(&self.beyond[p], end) - stretch
        };
        (0..self.count()).map(of_passage).collect()
    }

    /// Transpose of [`Self::beyond_changes`]: derivatives by strains at the end of the step and by tensions.
    pub fn by_beyond(&self, beyond: &[f64]) -> (Vec<Twist>, Vec<f64>) {
        let points = self.beyond.first().map_or(0, Vec::len);
        let mut strains = vec![Twist::default(); points];
        let mut tensions = vec![0.0; self.count()];
        for (p, by) in beyond.iter().enumerate() {
            add(&mut strains, &self.beyond[p], *by);
            for &k in &self.from[p] {
                tensions[k] -= self.yielding[k] * by;
            }
        }
        (strains, tensions)
    }
}
