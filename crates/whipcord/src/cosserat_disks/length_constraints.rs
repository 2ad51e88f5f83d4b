//! Cables of the loaded robot that are driven by their length: their tensions are unknowns of the chain.
//!
//! Every step of Newton's method on eqs. (4) leaves how the lengths answer to the tensions and to the
//! gaps, `δℓ = L δτ + δℓ₀`. With the slackness `g = ℓ* + c τ − ℓ` of a cable, not negative and zero where
//! the cable is taut,
//!
//! ```text
//! δℓᵢ − cᵢ δτᵢ = gᵢ   where it is taut,      τᵢ + δτᵢ = 0   where it is slack                  (8)
//! ```
//!
//! and which of the two is decided for all cables together by [`crate::statics::active_set`], or where that has
//! no answer by what is the greater, the tension or the slackness, each on its scale.

use whipcord_numerics::DenseLu;

use super::chain::Task;
use crate::statics::active_set::ActiveSetPrediction;
use crate::statics::command::{Command, LENGTH_REGULARISATION};
use crate::statics::scales::Scales;

/// The step of the tensions, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct LengthConstraints {
    /// The cables that are driven by their length.
    pub cables: Vec<usize>,
    /// Their `(L, δℓ₀)` by rows.
    pub lengths: Vec<f64>,
    /// `δτ` of each.
    pub change: Vec<f64>,
    taut: Vec<usize>,
    matrix: Vec<f64>,
    right: Vec<f64>,
    lu: DenseLu,
    prediction: ActiveSetPrediction,
}

/// Greatest `min(τ, g)` without dimension.
pub(super) fn greatest_residual(
    task: &Task<'_>,
    tensions: &[f64],
    lengths: &[f64],
    scales: &Scales,
) -> f64 {
    let units = [scales.force, task.frame.rod.backbone().length];
    let lack = |(i, command): (usize, &Command)| {
        command.complementarity_residual(i, tensions, lengths, units)
    };
    let lacks = task.commands.iter().enumerate().map(lack);
    lacks.fold(0.0, |worst: f64, lack| if lack.is_nan() { f64::INFINITY } else { worst.max(lack) })
}

impl LengthConstraints {
    /// Finds the cables.
    pub fn find(&mut self, commands: &[Command]) {
        self.cables.clear();
        let by_length =
            |(_, command): &(usize, &Command)| matches!(command, Command::Length { .. });
        self.cables.extend(commands.iter().enumerate().filter(by_length).map(|(i, _)| i));
        self.change.clear();
    }

    /// Of a cable; zero of one that is driven by its tension.
    pub fn change_of(&self, cable: usize) -> f64 {
        let at = self.cables.iter().position(|&of| of == cable);
        at.and_then(|at| self.change.get(at)).copied().unwrap_or(0.0)
    }

    /// Whether the lengths of the taut cables leave an odd number of unstable directions: each taut cable shortens with its
    /// own tension.
    pub fn is_negative(&self) -> bool {
        !self.cables.is_empty() && self.lu.is_determinant_negative() != (self.taut.len() % 2 == 1)
    }

    /// Solves (8); `false` where it is singular.
    pub fn solve(&mut self, task: &Task<'_>, tensions: &[f64], lengths: &[f64]) -> bool {
        let scales = task.frame.scales(task.mesh);
        let backbone = task.frame.rod.backbone().length;
        let Self { cables, lengths: by, change, taut, matrix, right, lu, prediction } = self;
        let wide = cables.len() + 1;
        change.clear();
        change.resize(cables.len(), 0.0);
        taut.clear();
        let units = [scales.force, backbone];
        let gives = |row: usize, column: usize| {
            let by = by[row * wide + column];
            let own = if row == column { LENGTH_REGULARISATION * by.min(0.0) } else { 0.0 };
            -(by + own + Command::stretch(task.commands, cables[row], cables[column]))
        };
        let slack = |row: usize| {
            let i = cables[row];
            task.commands[i].slackness(tensions[i], lengths[i]) - by[(row + 1) * wide - 1]
        };
        let tension = |row: usize| tensions[cables[row]];
        let known = prediction.solve(cables.len(), tension, gives, slack, units);
        for (row, &i) in cables.iter().enumerate() {
            let led = if known {
                prediction.is_pulling(row)
            } else {
                task.commands[i].is_active(i, tensions, lengths, units)
            };
            if led {
                taut.push(row);
            } else {
                change[row] = -tensions[i];
            }
        }
        matrix.clear();
        right.clear();
        for &row in &*taut {
            let i = cables[row];
            let Command::Length { compliance, .. } = task.commands[i] else { continue };
            let of = &by[row * wide..(row + 1) * wide];
            for &column in &*taut {
                let own = if row == column {
                    compliance - LENGTH_REGULARISATION * of[column].min(0.0)
                } else {
                    0.0
                };
                matrix.push((of[column] - own) * scales.force / backbone);
            }
            let released: f64 = of.iter().zip(&*change).map(|(by, change)| by * change).sum();
            let slack = task.commands[i].slackness(tensions[i], lengths[i]);
            right.push((slack - of[wide - 1] - released) / backbone);
        }
        if lu.factor(taut.len(), matrix).is_err() {
            return false;
        }
        lu.solve(right);
        for (&row, &x) in taut.iter().zip(&*right) {
            change[row] = x * scales.force;
        }
        change.iter().all(|x| x.is_finite())
    }
}
