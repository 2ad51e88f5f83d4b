//! The small linear system of what all steps of a chain share: tensions, and the load where it is
//! an unknown.

use whipcord_numerics::{DenseLu, Vec3};

use super::chain::{Step, Task};
use super::loaded::Trajectory;
use super::state::{State, scaled, weight};
use crate::statics::active_set::ActiveSetPrediction;
use crate::statics::command::{Command, LENGTH_REGULARISATION};
use crate::statics::elimination::Elimination;
use crate::statics::scales::Scales;

/// The small system of what all steps share.
#[derive(Clone, Debug, Default)]
pub(super) struct Shared {
    free: Vec<usize>,
    /// `∂ℓᵢ` by `(θ, 1)`.
    lengths: Vec<f64>,
    matrix: Vec<f64>,
    right: Vec<f64>,
    /// The load where it is free, then the change of every tension.
    pub theta: Vec<f64>,
    lu: DenseLu,
    /// The cables that are driven by their length, and which of them a step makes pull.
    held: Vec<usize>,
    prediction: ActiveSetPrediction,
    /// Sign of the determinant of the last system at fixed load.
    pub negative: bool,
}

impl Shared {
    /// The change of each cable's length with `(θ, 1)`, node by node.
    pub fn lengths_by(
        &mut self,
        shared: usize,
        unknowns: usize,
        rows: &[f64],
        elimination: &Elimination,
        steps: usize,
    ) {
        let wide = shared + 1;
        let cables = rows.len() / (steps * unknowns).max(1);
        self.lengths.clear();
        self.lengths.resize(cables * wide, 0.0);
        for k in 0..steps {
            for j in 0..wide {
                let change = elimination.change(k, j);
                for i in 0..cables {
                    let row = &rows[(k * cables + i) * unknowns..][..unknowns];
                    let vector = |i: usize| Vec3::new(row[i], row[i + 1], row[i + 2]);
                    let mut sum = vector(0).dot(change.turn) + vector(3).dot(change.moment);
                    if unknowns - shared == 9 {
                        sum += vector(6).dot(change.force);
                    }
                    if j < shared {
                        sum += row[unknowns - shared + j];
                    }
                    self.lengths[i * wide + j] += sum;
                }
            }
        }
    }

    /// Finds which cables pull after a step at this load; `false` where that is not to be known.
    fn foresee(
        &mut self,
        commands: &[Command],
        state: &State,
        trajectory: &Trajectory,
        scales: &Scales,
    ) -> bool {
        let wide = commands.len() + 1;
        let Self { lengths, held, prediction, .. } = self;
        held.clear();
        held.extend((0..commands.len()).filter(|&i| commands[i].is_length()));
        let gives = |row: usize, column: usize| {
            let (i, j) = (held[row], held[column]);
            let by = lengths[i * wide + j];
            let own = if i == j { LENGTH_REGULARISATION * by.min(0.0) } else { 0.0 };
            -(by + own + Command::stretch(commands, i, j))
        };
        let slack = |row: usize| {
            let i = held[row];
            let closing = lengths[i * wide + commands.len()];
            commands[i].slackness(state.tensions[i], trajectory.lengths[i]) - closing
        };
        let tension = |row: usize| state.tensions[held[row]];
        prediction.solve(held.len(), tension, gives, slack, scales.of_cables())
    }

    /// The load factor, where it is free, and the tensions of eq. (7): cables that are slack go to
    /// no tension. `theta` holds the load where it is free, then the change of every tension.
    pub fn solve(
        &mut self,
        task: &Task<'_>,
        by: Step<'_>,
        state: &State,
        trajectory: &Trajectory,
        scales: &Scales,
        elimination: &Elimination,
    ) -> bool {
        let moves = matches!(by, Step::Close | Step::Across(_));
        let load = usize::from(by.frees_load());
        let cables = if self.lengths.is_empty() { 0 } else { task.commands.len() };
        let wide = load + cables + 1;
        self.theta.clear();
        self.theta.resize(load + cables, 0.0);
        self.free.clear();
        let prediction = matches!(by, Step::Close)
            && cables > 0
            && self.foresee(task.commands, state, trajectory, scales);
        for (i, command) in task.commands.iter().enumerate().take(cables) {
            let led = if prediction {
                self.held.binary_search(&i).is_ok_and(|at| self.prediction.is_pulling(at))
            } else {
                command.is_active(i, &state.tensions, &trajectory.lengths, scales.of_cables())
            };
            if led {
                self.free.push(load + i);
            } else if moves && matches!(command, Command::Length { .. }) {
                self.theta[load + i] = -state.tensions[i];
            }
        }
        let unit = |j: usize| if j < load { 1.0 } else { scales.force };
        let n = load + self.free.len();
        self.matrix.clear();
        self.right.clear();
        if let Step::Across(direction) | Step::Along(direction) = by {
            // The row that the free load needs: the product of the step with the direction.
            let along = |j: usize| -> f64 {
                let own = match (j < load, j + 1 < wide) {
                    (true, _) => direction.load,
                    (_, true) => direction.tensions[j - load] / (scales.force * scales.force),
                    _ => 0.0,
                };
                let nodes = direction.nodes.iter().enumerate();
                nodes
                    .map(|(k, node)| {
                        weight(task.grid, k) * scaled(node, &elimination.change(k, j), scales)
                    })
                    .sum::<f64>()
                    + own
            };
            for j in (0..load).chain(self.free.iter().copied()) {
                self.matrix.push(along(j) * unit(j));
            }
            let given = if moves { 0.0 } else { 1.0 };
            let released: f64 = (load..load + cables)
                .filter(|&j| self.theta[j] != 0.0)
                .map(|j| along(j) * self.theta[j])
                .sum();
            self.right.push(given - along(wide - 1) - released);
        }
        for &row in &self.free {
            let i = row - load;
            let of = &self.lengths[i * wide..(i + 1) * wide];
            let Command::Length { compliance, .. } = task.commands[i] else { continue };
            for j in (0..load).chain(self.free.iter().copied()) {
                let own = if j == row {
                    compliance - LENGTH_REGULARISATION * of[j].min(0.0)
                } else {
                    0.0
                };
                self.matrix.push((of[j] - own) * unit(j) / scales.length);
            }
            let slack = if moves {
                task.commands[i].slackness(state.tensions[i], trajectory.lengths[i])
            } else {
                0.0
            };
            let released: f64 = (load..load + cables).map(|j| of[j] * self.theta[j]).sum();
            self.right.push((slack - of[wide - 1] - released) / scales.length);
        }
        self.negative = false;
        if n == 0 {
            return true;
        }
        if self.lu.factor(n, &self.matrix).is_err() {
            return false;
        }
        // Each of them alone would have a negative derivative of its length.
        self.negative = self.lu.is_determinant_negative() != (self.free.len() % 2 == 1);
        self.lu.solve(&mut self.right);
        for (k, j) in (0..load).chain(self.free.iter().copied()).enumerate() {
            self.theta[j] = self.right[k] * unit(j);
        }
        true
    }
}
