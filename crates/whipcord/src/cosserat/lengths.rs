//! Tensions that give prescribed cable lengths on a rod without load.
//!
//! `W(τ) = ∫ min_ξ(…) ds` is concave in the tensions with gradient `ℓ(τ)`, so that finding
//! `τ ≥ 0` with `ℓᵢ(τ) ≤ ℓᵢ*`, slack where shorter, is the convex problem
//!
//! ```text
//! minimise  −W(τ) + Σ τᵢ ℓᵢ* + ½ Σ cᵢ τᵢ²   over τ ≥ 0        (6)
//! ```
//!
//! with `cᵢ = ℓ₀ᵢ/(E A)ᵢ` of an elastic cable, 0 otherwise. Its gradient is the slackness
//! `gᵢ = ℓᵢ* + cᵢ τᵢ − ℓᵢ`; a projected Newton method solves it.

use whipcord_numerics::DenseLu;

use super::grid::Grid;
use super::unloaded::{Fault, Unloaded, Wanted};

/// What drives one cable; in the order of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Command {
    /// Tension in N.
    Tension(f64),
    /// Unstretched length `ℓ*` inside the robot in m, and what a tension of 1 N adds to it.
    Length { target: f64, compliance: f64 },
}

impl Command {
    /// Slackness `g` of a cable whose path has this length.
    pub fn slackness(&self, tension: f64, length: f64) -> f64 {
        match *self {
            Self::Tension(_) => 0.0,
            Self::Length { target, compliance } => target + compliance * tension - length,
        }
    }
}

/// Why no tensions were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LengthFault {
    /// A section fault that no tension brought about.
    Section(Fault),
    /// This cable cannot get as short as it should: `length` is the least it reaches.
    Unreachable { cable: usize, length: f64 },
    /// The iteration limit.
    Stalled { residual: f64 },
}

/// Scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct LengthScratch {
    free: Vec<usize>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    /// Lengths at the last point at which no section had folded.
    reached: Vec<f64>,
    lu: DenseLu,
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given<'a> {
    pub grid: &'a Grid,
    /// Length of the backbone in m.
    pub length: f64,
    pub commands: &'a [Command],
}

/// Effort and quality of an answer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    pub iterations: usize,
    /// Largest length left over, relative to the backbone's length.
    pub residual: f64,
}

/// Lengths are met to this fraction of the backbone's length.
const LENGTH_TOLERANCE: f64 = 2e-14;
pub(super) const MAX_ITERATIONS: usize = 100;
/// Of the largest diagonal entry: keeps the step defined where more straight cables are taut than
/// lengths are independent, and picks tensions of least change there.
const REGULARISATION: f64 = 1e-13;

/// How closely the limit of what can be reached is bracketed, relative to it.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// Solves eq. (6), starting from `tensions`; `unloaded` ends with the sweep of the answer.
/// `wanted` is what that sweep computes beside.
pub(super) fn solve(
    given: &Given<'_>,
    tensions: &mut [f64],
    unloaded: &mut Unloaded,
    scratch: &mut LengthScratch,
    wanted: Wanted,
) -> Result<Effort, LengthFault> {
    match attempt(given, tensions, unloaded, scratch, wanted) {
        Err(LengthFault::Unreachable { .. }) => Err(limit(given, tensions, unloaded, scratch)),
        other => other,
    }
}

/// How far the cables go when all are shortened in proportion: by bisection between no tension and
/// what was asked.
fn limit(
    given: &Given<'_>,
    tensions: &mut [f64],
    unloaded: &mut Unloaded,
    scratch: &mut LengthScratch,
) -> LengthFault {
    let Given { grid, commands, .. } = *given;
    release(commands, tensions);
    if let Err(fault) = unloaded.sweep(grid, tensions, false, Wanted::default()) {
        return LengthFault::Section(fault);
    }
    let loose = unloaded.lengths.clone();
    // What each cable driven by length lacks at no tension, in m.
    let lack = |i: usize| match commands[i] {
        Command::Length { target, .. } => (loose[i] - target).max(0.0),
        Command::Tension(_) => 0.0,
    };
    let scaled = |fraction: f64| -> Vec<Command> {
        let of_cable = |(i, command): (usize, &Command)| match *command {
            Command::Length { compliance, .. } if lack(i) > 0.0 => {
                Command::Length { target: loose[i] - fraction * lack(i), compliance }
            }
            other => other,
        };
        commands.iter().enumerate().map(of_cable).collect()
    };
    // No cable gets shorter than nothing.
    let mut missed = (0..commands.len())
        .map(|i| if lack(i) > 0.0 { loose[i] / lack(i) } else { 1.0 })
        .fold(1.0, f64::min);
    let mut reached = 0.0;
    let mut good = tensions.to_vec();
    while missed - reached > LIMIT_TOLERANCE * missed {
        let middle = 0.5 * (reached + missed);
        tensions.copy_from_slice(&good);
        let wanted = Wanted::default();
        let part = Given { commands: &scaled(middle), ..*given };
        match attempt(&part, tensions, unloaded, scratch, wanted) {
            Ok(_) => {
                reached = middle;
                good.copy_from_slice(tensions);
            }
            Err(_) => missed = middle,
        }
    }
    let relative = |i: usize| lack(i) / loose[i];
    match (0..commands.len()).max_by(|&a, &b| relative(a).total_cmp(&relative(b))) {
        Some(cable) => {
            LengthFault::Unreachable { cable, length: loose[cable] - reached * lack(cable) }
        }
        None => LengthFault::Stalled { residual: f64::MAX },
    }
}

/// Takes the tension off the cables that are driven by length.
pub(super) fn release(commands: &[Command], tensions: &mut [f64]) {
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if matches!(command, Command::Length { .. }) {
            *tension = 0.0;
        }
    }
}

/// [`solve`], with the first sign that a section folds as the reason of a failure.
fn attempt(
    given: &Given<'_>,
    tensions: &mut [f64],
    unloaded: &mut Unloaded,
    scratch: &mut LengthScratch,
    wanted: Wanted,
) -> Result<Effort, LengthFault> {
    let Given { grid, length, commands } = *given;
    let wanted = Wanted { length_by_tension: true, ..wanted };
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if let Command::Tension(given) = command {
            *tension = *given;
        }
    }
    if let Err(fault) = unloaded.sweep(grid, tensions, false, wanted) {
        // A start that folds, from a neighbour or a guess, says nothing: start from no tension.
        release(commands, tensions);
        unloaded.sweep(grid, tensions, false, wanted).map_err(|_| LengthFault::Section(fault))?;
    }
    let mut residual = f64::INFINITY;
    let mut blocked = 0;
    for iteration in 0..MAX_ITERATIONS {
        residual = residual_of(commands, tensions, &unloaded.lengths) / length;
        if residual <= LENGTH_TOLERANCE {
            return Ok(Effort { iterations: iteration, residual });
        }
        if !newton_step(commands, tensions, unloaded, scratch) {
            break;
        }
        let descent = slope(commands, tensions, &scratch.trial, tensions, &unloaded.lengths);
        let mut fraction = 1.0;
        let before = residual;
        let mut folded = false;
        scratch.step.clear();
        scratch.step.extend_from_slice(tensions);
        scratch.reached.clone_from(&unloaded.lengths);
        loop {
            for (i, tension) in tensions.iter_mut().enumerate() {
                *tension = scratch.step[i] + fraction * (scratch.trial[i] - scratch.step[i]);
            }
            match unloaded.sweep(grid, tensions, true, wanted) {
                Err(_) => {
                    folded = true;
                    fraction *= 0.5;
                }
                Ok(()) => {
                    let now = residual_of(commands, tensions, &unloaded.lengths) / length;
                    let ahead =
                        slope(commands, &scratch.step, &scratch.trial, tensions, &unloaded.lengths);
                    // The objective is convex: as long as it still falls at the new point, or the
                    // residual does, the step was not too long.
                    if ahead <= 0.0 || now < before || fraction < 1e-8 {
                        break;
                    }
                    fraction *= (descent / (descent - ahead)).clamp(0.1, 0.7);
                }
            }
            if folded && fraction < 1e-9 {
                break;
            }
        }
        if folded {
            blocked += 1;
        }
        // Twenty halvings against a fold: what is left of the way to it does not matter.
        if folded && (fraction < 1e-3 || blocked > 20) {
            return Err(unreachable(commands, scratch));
        }
    }
    // Rounding may keep the last digits from settling.
    if residual <= 1e3 * LENGTH_TOLERANCE {
        return Ok(Effort { iterations: MAX_ITERATIONS, residual });
    }
    Err(LengthFault::Stalled { residual })
}

/// The cable that lacks most at the last point short of the fold, and how short it is there.
fn unreachable(commands: &[Command], scratch: &LengthScratch) -> LengthFault {
    let (tensions, lengths) = (&scratch.step, &scratch.reached);
    let lacking = |i: usize| commands[i].slackness(tensions[i], lengths[i]);
    match (0..commands.len()).min_by(|&a, &b| lacking(a).total_cmp(&lacking(b))) {
        Some(cable) => LengthFault::Unreachable { cable, length: lengths[cable] },
        None => LengthFault::Stalled { residual: f64::MAX },
    }
}

/// Largest violation of the complementarity conditions, in m.
fn residual_of(commands: &[Command], tensions: &[f64], lengths: &[f64]) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, command) in commands.iter().enumerate() {
        if matches!(command, Command::Length { .. }) {
            let g = command.slackness(tensions[i], lengths[i]);
            worst = worst.max(if tensions[i] > 0.0 { g.abs() } else { -g });
        }
    }
    worst
}

/// Derivative of the objective at `at` along the way from `from` to `to`.
fn slope(commands: &[Command], from: &[f64], to: &[f64], at: &[f64], lengths: &[f64]) -> f64 {
    (0..commands.len()).map(|i| commands[i].slackness(at[i], lengths[i]) * (to[i] - from[i])).sum()
}

/// Writes the end of the projected Newton step into `scratch.trial`; `false` when no cable is free
/// to move.
fn newton_step(
    commands: &[Command],
    tensions: &[f64],
    unloaded: &Unloaded,
    scratch: &mut LengthScratch,
) -> bool {
    let cables = commands.len();
    let slackness = |i: usize| commands[i].slackness(tensions[i], unloaded.lengths[i]);
    scratch.free.clear();
    scratch.free.extend((0..cables).filter(|&i| {
        matches!(commands[i], Command::Length { .. }) && (tensions[i] > 0.0 || slackness(i) < 0.0)
    }));
    scratch.trial.clear();
    scratch.trial.extend_from_slice(tensions);
    // A cable without tension whose Newton step would pull it below zero only holds the others
    // back: it stays slack, and the step is made again without it.
    loop {
        let n = scratch.free.len();
        if n == 0 {
            return false;
        }
        let stiffest = scratch
            .free
            .iter()
            .map(|&i| -unloaded.length_by_tension[i * cables + i])
            .fold(0.0, f64::max);
        scratch.matrix.clear();
        scratch.step.clear();
        for &i in &scratch.free {
            for &j in &scratch.free {
                let mut entry = -unloaded.length_by_tension[i * cables + j];
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
