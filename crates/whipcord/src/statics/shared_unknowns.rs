//! The small linear system of what all parts of a robot share: the tensions of cables that are driven by their
//! length, and the load factor where it is an unknown.
//!
//! The elimination of a chain leaves how the lengths answer to the tensions, to the load factor and to the
//! residuals, `δℓ = L δτ + ℓ_λ δλ + δℓ₀`. With the slackness `g = ℓ* + c τ − ℓ` of a cable, not negative and zero where
//! the cable is taut,
//!
//! ```text
//! δℓᵢ − cᵢ δτᵢ = gᵢ   where it is taut,      τᵢ + δτᵢ = 0   where it is slack                  (8)
//! ```
//!
//! and which of the two is decided for all cables together by [`super::active_set`], or where that has
//! no answer, or the load is free, by what is the greater, the tension or the slackness, each on its scale. A free load
//! has one equation more: the product of the step with a direction.

use whipcord_numerics::DenseLu;

use super::active_set::ActiveSetPrediction;
use super::command::{Command, LENGTH_REGULARISATION};
use super::path::Step;
use super::scales::Scales;

/// The system, and memory. Its columns are the load factor where it is free, then the tension of each of the
/// cables, and last the answer to the residuals.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharedUnknowns {
    /// The cables whose tensions are columns: those that are driven by their length among them.
    pub cables: Vec<usize>,
    /// What each column does to the length of each of those cables, by rows.
    pub lengths: Vec<f64>,
    /// Product of each column with the direction of the step, where the load is free.
    pub along: Vec<f64>,
    /// The step: the change of the load where it is free, then of the tension of each of those cables.
    pub theta: Vec<f64>,
    /// Which of the cables a step makes pull.
    taut: Vec<usize>,
    /// The cables that are driven by their length, by their place among the cables.
    driven: Vec<usize>,
    matrix: Vec<f64>,
    right: Vec<f64>,
    lu: DenseLu,
    prediction: ActiveSetPrediction,
    /// Sign of the determinant of the last system.
    negative: bool,
}

/// What drives the cables, and where they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cables<'a> {
    pub commands: &'a [Command],
    pub tensions: &'a [f64],
    /// In m.
    pub lengths: &'a [f64],
}

impl SharedUnknowns {
    /// Finds the cables that are driven by their length.
    pub fn find(&mut self, commands: &[Command]) {
        self.cables.clear();
        self.cables.extend((0..commands.len()).filter(|&i| commands[i].is_length()));
        self.theta.clear();
    }

    /// Change of the tension of a cable; zero of one that is driven by its tension.
    pub fn change_of(&self, cable: usize) -> f64 {
        let load = self.theta.len() - self.cables.len().min(self.theta.len());
        let at = self.cables.iter().position(|&of| of == cable);
        at.and_then(|at| self.theta.get(load + at)).copied().unwrap_or(0.0)
    }

    /// Whether the determinant of the last system at fixed load leaves an odd number of unstable directions: each taut
    /// cable shortens with its own tension.
    pub const fn is_negative(&self) -> bool {
        self.negative
    }

    /// Finds which cables pull after a step at this load; `false` where that is not to be known.
    fn predict(&mut self, of: &Cables<'_>, units: [f64; 2]) -> bool {
        let Cables { commands, tensions, lengths: measured } = *of;
        let wide = self.cables.len() + 1;
        let Self { cables, lengths, driven, prediction, .. } = self;
        let gives = |row: usize, column: usize| {
            let (i, j) = (driven[row], driven[column]);
            let by = lengths[i * wide + j];
            let own = if i == j { LENGTH_REGULARISATION * by.min(0.0) } else { 0.0 };
            -(by + own + Command::stretch(commands, cables[i], cables[j]))
        };
        let slack = |row: usize| {
            let (i, closing) = (cables[driven[row]], lengths[(driven[row] + 1) * wide - 1]);
            commands[i].slackness(tensions[i], measured[i]) - closing
        };
        let tension = |row: usize| tensions[cables[driven[row]]];
        prediction.solve(driven.len(), tension, gives, slack, units)
    }

    /// Solves (8), and the load factor with it where it is free; `false` where it is singular.
    pub fn solve<C>(&mut self, step: Step<'_, C>, of: &Cables<'_>, scales: &Scales) -> bool {
        let Cables { commands, tensions, lengths: measured } = *of;
        let units = scales.of_cables();
        let load = usize::from(step.frees_load());
        let wide = load + self.cables.len() + 1;
        self.driven.clear();
        let driven = (0..self.cables.len()).filter(|&at| commands[self.cables[at]].is_length());
        self.driven.extend(driven);
        let is_close = matches!(step, Step::Close);
        let known = is_close && !self.driven.is_empty() && self.predict(of, units);
        let Self { cables, lengths, along, theta, taut, driven, matrix, right, lu, .. } = self;
        theta.clear();
        theta.resize(load + cables.len(), 0.0);
        taut.clear();
        for (row, &at) in driven.iter().enumerate() {
            let i = cables[at];
            let led = if known {
                self.prediction.is_pulling(row)
            } else {
                commands[i].is_active(i, tensions, measured, units)
            };
            if led {
                taut.push(at);
            } else if step.closes() {
                theta[load + at] = -tensions[i];
            }
        }
        let unit = |j: usize| if j < load { 1.0 } else { scales.force };
        let unknowns = || (0..load).chain(taut.iter().map(|&at| load + at));
        let released = |of: &[f64]| -> f64 {
            of[load..wide - 1].iter().zip(&theta[load..]).map(|(by, change)| by * change).sum()
        };
        matrix.clear();
        right.clear();
        if step.frees_load() {
            matrix.extend(unknowns().map(|j| along[j] * unit(j)));
            let given = if step.closes() { 0.0 } else { 1.0 };
            right.push(given - along[wide - 1] - released(along));
        }
        for &at in &*taut {
            let i = cables[at];
            let Command::Length { compliance, .. } = commands[i] else { continue };
            let of = &lengths[at * wide..(at + 1) * wide];
            matrix.extend(unknowns().map(|j| {
                let own = if j == load + at {
                    compliance - LENGTH_REGULARISATION * of[j].min(0.0)
                } else {
                    0.0
                };
                (of[j] - own) * unit(j) / scales.length
            }));
            let slack =
                if step.closes() { commands[i].slackness(tensions[i], measured[i]) } else { 0.0 };
            right.push((slack - of[wide - 1] - released(of)) / scales.length);
        }
        self.negative = false;
        if right.is_empty() {
            return true;
        }
        if lu.factor(right.len(), matrix).is_err() {
            return false;
        }
        self.negative = lu.is_determinant_negative() != (taut.len() % 2 == 1);
        lu.solve(right);
        for (j, &x) in unknowns().zip(&*right) {
            theta[j] = x * unit(j);
        }
        theta.iter().all(|x| x.is_finite())
    }
}
