//! One step of the search for the tensions that give prescribed cable lengths, eq. (6): projected Newton, or damped within the
//! bounds. `lengths` are those of the cables at `tensions`, and `length_by_tension` their derivatives by these, row by row.

use whipcord_numerics::{BoundedQuadratic, DenseLu};

use super::command::Command;
use super::rank::IndependentCables;

/// Of the largest diagonal entry: keeps the step defined where more straight cables are taut than
/// lengths are independent, and picks tensions of least change there.
const REGULARISATION: f64 = 1e-13;

/// Scratch memory of a step, and its end.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepScratch {
    free: Vec<usize>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    /// The tensions at the end of the step.
    pub trial: Vec<f64>,
    gradient: Vec<f64>,
    least: Vec<f64>,
    quadratic: BoundedQuadratic,
    independent: IndependentCables,
    lu: DenseLu,
}

/// Writes the end of the projected Newton step into `scratch.trial`; `false` when no cable is free
/// to move.
pub(crate) fn newton_step(
    commands: &[Command],
    tensions: &[f64],
    lengths: &[f64],
    length_by_tension: &[f64],
    scratch: &mut StepScratch,
) -> bool {
    let cables = commands.len();
    let slackness = |i: usize| commands[i].slackness(tensions[i], lengths[i]);
    scratch.free.clear();
    scratch.free.extend((0..cables).filter(|&i| {
        matches!(commands[i], Command::Length { .. }) && (tensions[i] > 0.0 || slackness(i) < 0.0)
    }));
    scratch.trial.clear();
    scratch.trial.extend_from_slice(tensions);
    let StepScratch { free, independent, .. } = &mut *scratch;
    let effect =
        |i: usize, j: usize| length_by_tension[i * cables + j] + Command::stretch(commands, i, j);
    independent.retain(free, REGULARISATION, |j| tensions[j], cables, effect);
    // A cable without tension whose Newton step would pull it below zero only holds the others
    // back: it stays slack, and the step is made again without it.
    loop {
        let n = scratch.free.len();
        if n == 0 {
            return false;
        }
        let stiffest =
            scratch.free.iter().map(|&i| -length_by_tension[i * cables + i]).fold(0.0, f64::max);
        scratch.matrix.clear();
        scratch.step.clear();
        for &i in &scratch.free {
            for &j in &scratch.free {
                let mut entry = -length_by_tension[i * cables + j];
                if i == j {
                    entry += REGULARISATION * stiffest;
                    if let Command::Length { compliance, .. } = commands[i] {
                        entry += compliance;
                    }
                }
                scratch.matrix.push(entry);
            }
            scratch.step.push(-slackness(i));
        }
        if scratch.lu.factor(n, &scratch.matrix).is_err() {
            return false;
        }
        scratch.lu.solve(&mut scratch.step);
        let held = (0..n).find(|&k| tensions[scratch.free[k]] == 0.0 && scratch.step[k] < 0.0);
        match held {
            Some(k) => {
                scratch.free.remove(k);
            }
            None => break,
        }
    }
    let largest = scratch.step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    let present = tensions.iter().fold(0.0_f64, |m, t| m.max(*t));
    // Where lengths contradict one another the matrix is all but singular and the step huge: go as
    // far as the first cable that falls slack.
    let fraction = if largest > 1e4 * present && present > 0.0 {
        let to_bound = |(&i, &d): (&usize, &f64)| if d < 0.0 { -tensions[i] / d } else { 1.0 };
        scratch.free.iter().zip(&scratch.step).map(to_bound).fold(1.0, f64::min)
    } else {
        1.0
    };
    for (&i, &d) in scratch.free.iter().zip(&scratch.step) {
        scratch.trial[i] = (tensions[i] + fraction * d).max(0.0);
    }
    true
}

/// Writes into `scratch.trial` where the quadratic model of the objective is least within `τ ≥ 0`, with
/// `damping` of the diagonal added to it: a way down, always.
pub(crate) fn damped_step(
    commands: &[Command],
    tensions: &[f64],
    lengths: &[f64],
    length_by_tension: &[f64],
    damping: f64,
    scratch: &mut StepScratch,
) -> bool {
    let cables = commands.len();
    let StepScratch { free, matrix, step, trial, gradient, least, quadratic, .. } = scratch;
    free.clear();
    free.extend((0..cables).filter(|&i| matches!(commands[i], Command::Length { .. })));
    let compliance = |i: usize| match commands[i] {
        Command::Length { compliance, .. } => compliance,
        Command::Tension(_) => 0.0,
    };
    let curvature = |i: usize, j: usize| {
        let own = if i == j { compliance(i) } else { 0.0 };
        own - length_by_tension[i * cables + j]
    };
    let stiffest = free.iter().map(|&i| curvature(i, i)).fold(0.0, f64::max);
    matrix.clear();
    for &i in &*free {
        for &j in &*free {
            let damped = if i == j { damping * stiffest } else { 0.0 };
            matrix.push(curvature(i, j) + damped);
        }
    }
    gradient.clear();
    gradient.extend(free.iter().map(|&i| commands[i].slackness(tensions[i], lengths[i])));
    least.clear();
    least.extend(free.iter().map(|&i| -tensions[i]));
    if quadratic.minimise(matrix, gradient, least, step).is_err() {
        return false;
    }
    trial.clear();
    trial.extend_from_slice(tensions);
    for (&i, &d) in free.iter().zip(&*step) {
        trial[i] = (tensions[i] + d).max(0.0);
    }
    true
}
