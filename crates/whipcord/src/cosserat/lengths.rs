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
//! `gᵢ = ℓᵢ* + cᵢ τᵢ − ℓᵢ`; a projected Newton method solves it. Where several cables all but depend on
//! one another a projected step may climb; then the quadratic model is minimised within `τ ≥ 0`,
//! damped as far as the model holds.

use whipcord_numerics::{BoundedQuadratic, DenseLu};

use super::command::Command;
use super::contradiction;
use super::independent::Independent;
use super::outcome::Failure;
use super::unloaded::Fault;

/// A rod that answers tensions with the lengths of its cables.
pub(crate) trait Responds {
    /// Finds its shape under these tensions in N, starting from the last one when `warm`.
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault>;
    /// `ℓᵢ` in m.
    fn lengths(&self) -> &[f64];
    /// `∂ℓᵢ/∂τⱼ` by rows in m/N.
    fn length_by_tension(&self) -> &[f64];
    /// Is told of each iteration that led to these tensions.
    fn note(&mut self, note: &Note, tensions: &[f64]);
}

/// An iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Note {
    /// Its number, from 1 on.
    pub iteration: usize,
    /// Largest length left over, relative to the backbone's length.
    pub residual: f64,
    /// Fraction of the step that was taken.
    pub step: f64,
}

/// Why no tensions were found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LengthFault {
    /// A section fault that no tension brought about.
    Section(Fault),
    /// This cable cannot get as short as it should: `length` is the least it reaches.
    Unreachable { cable: usize, length: f64 },
    /// These lengths cannot be had together: what each cable is too long by in m at the best compromise,
    /// 0 where it takes no part.
    Contradictory { misses: Vec<f64> },
    /// The iteration limit, or no step that improves anything.
    Stalled,
}

impl LengthFault {
    /// As the failure of a solve; `of_section` says what a fault of a section is.
    pub fn failure(self, of_section: impl FnOnce(Fault) -> Failure) -> Failure {
        match self {
            Self::Section(fault) => of_section(fault),
            Self::Unreachable { cable, length } => Failure::Unreachable { cable, length },
            Self::Contradictory { misses } => Failure::Contradictory { misses },
            Self::Stalled => Failure::TensionsNotFound,
        }
    }
}

/// Scratch memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct LengthScratch {
    free: Vec<usize>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    /// Lengths at the last point at which no section had folded.
    reached: Vec<f64>,
    gradient: Vec<f64>,
    least: Vec<f64>,
    quadratic: BoundedQuadratic,
    independent: Independent,
    lu: DenseLu,
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// Length of the backbone in m.
    pub length: f64,
    pub commands: &'a [Command],
    /// Whether it is worth finding out how far cables go that do not go as far as they should.
    pub bracket: bool,
}

/// Effort and quality of an answer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    pub iterations: usize,
    /// Largest length left over, relative to the backbone's length.
    pub residual: f64,
}

/// Lengths are met to this fraction of the backbone's length.
const LENGTH_TOLERANCE: f64 = 2e-14;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e3 * LENGTH_TOLERANCE;
pub(crate) const MAX_ITERATIONS: usize = 100;
/// Of the largest diagonal entry: keeps the step defined where more straight cables are taut than
/// lengths are independent, and picks tensions of least change there.
const REGULARISATION: f64 = 1e-13;

/// How closely the limit of what can be reached is bracketed, relative to it.
const LIMIT_TOLERANCE: f64 = 1e-4;

/// Least damping of the quadratic model, relative to its diagonal, and what it grows and falls by.
const LEAST_DAMPING: f64 = 1e-10;
const DAMPING_RATIO: f64 = 100.0;

/// Solves eq. (6), starting from `tensions`; `rod` ends with the answer.
pub(crate) fn solve(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl Responds,
    scratch: &mut LengthScratch,
) -> Result<Effort, LengthFault> {
    let fault = match attempt(given, tensions, rod, scratch) {
        Err(fault @ LengthFault::Stalled) => fault,
        Err(fault @ LengthFault::Unreachable { .. }) if given.bracket => fault,
        other => return other,
    };
    if let Some(misses) = contradiction::misses(given, tensions, rod, scratch) {
        return Err(LengthFault::Contradictory { misses });
    }
    Err(match fault {
        LengthFault::Unreachable { .. } => limit(given, tensions, rod, scratch),
        other => other,
    })
}

/// How far the cables go when all are shortened in proportion: by bisection between no tension and
/// what was asked.
fn limit(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl Responds,
    scratch: &mut LengthScratch,
) -> LengthFault {
    let commands = given.commands;
    release(commands, tensions);
    if let Err(fault) = rod.respond(tensions, false) {
        return LengthFault::Section(fault);
    }
    let loose = rod.lengths().to_vec();
    // What each cable driven by length lacks at no tension, in m.
    let lack = |i: usize| match commands[i] {
        Command::Length { target, .. } => (loose[i] - target).max(0.0),
        Command::Tension(_) => 0.0,
    };
    let by_length = |&i: &usize| matches!(commands[i], Command::Length { .. });
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
    // Where nothing can be had, halving what is asked for would not come to an end.
    while missed - reached > LIMIT_TOLERANCE * missed && missed > LIMIT_TOLERANCE {
        let middle = 0.5 * (reached + missed);
        tensions.copy_from_slice(&good);
        let part = Given { commands: &scaled(middle), ..*given };
        match attempt(&part, tensions, rod, scratch) {
            Ok(_) => {
                reached = middle;
                good.copy_from_slice(tensions);
            }
            Err(_) => missed = middle,
        }
    }
    // Where next to nothing can be had, it is no cable's own limit but all of them together.
    if reached < LIMIT_TOLERANCE && (0..commands.len()).filter(by_length).count() > 1 {
        return LengthFault::Stalled;
    }
    let relative = |i: usize| lack(i) / loose[i];
    match (0..commands.len()).max_by(|&a, &b| relative(a).total_cmp(&relative(b))) {
        Some(cable) => {
            LengthFault::Unreachable { cable, length: loose[cable] - reached * lack(cable) }
        }
        None => LengthFault::Stalled,
    }
}

/// Takes the tension off the cables that are driven by length.
pub(crate) fn release(commands: &[Command], tensions: &mut [f64]) {
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if matches!(command, Command::Length { .. }) {
            *tension = 0.0;
        }
    }
}

/// [`solve`], with the first sign that a section folds as the reason of a failure.
pub(crate) fn attempt(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl Responds,
    scratch: &mut LengthScratch,
) -> Result<Effort, LengthFault> {
    let Given { length, commands, .. } = *given;
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if let Command::Tension(given) = command {
            *tension = *given;
        }
    }
    if let Err(fault) = rod.respond(tensions, false) {
        // A start that folds, from a neighbour or a guess, says nothing: start from no tension.
        release(commands, tensions);
        rod.respond(tensions, false).map_err(|_| LengthFault::Section(fault))?;
    }
    let mut residual = f64::INFINITY;
    let mut blocked = 0;
    let mut damping = 0.0_f64;
    for iteration in 0..MAX_ITERATIONS {
        let before = residual;
        residual = residual_of(commands, tensions, rod.lengths()) / length;
        if residual <= LENGTH_TOLERANCE || before <= residual && residual <= ROUNDING {
            return Ok(Effort { iterations: iteration, residual });
        }
        if let Some(cable) = rigid_and_long(given, tensions, rod) {
            return Err(LengthFault::Unreachable { cable, length: rod.lengths()[cable] });
        }
        let mut descent = 0.0;
        if damping == 0.0 {
            if !newton_step(commands, tensions, rod, scratch) {
                break;
            }
            descent = slope(commands, tensions, &scratch.trial, tensions, rod.lengths());
        }
        if descent >= 0.0 {
            damping = damping.max(LEAST_DAMPING);
            if !damped_step(commands, tensions, rod, damping, scratch) {
                break;
            }
            descent = slope(commands, tensions, &scratch.trial, tensions, rod.lengths());
        }
        let mut fraction = 1.0;
        let before = residual;
        let mut folded = false;
        scratch.step.clear();
        scratch.step.extend_from_slice(tensions);
        scratch.reached.clear();
        scratch.reached.extend_from_slice(rod.lengths());
        loop {
            for (i, tension) in tensions.iter_mut().enumerate() {
                *tension = scratch.step[i] + fraction * (scratch.trial[i] - scratch.step[i]);
            }
            match rod.respond(tensions, true) {
                Err(_) => {
                    folded = true;
                    fraction *= 0.5;
                }
                Ok(()) => {
                    let now = residual_of(commands, tensions, rod.lengths()) / length;
                    let ahead =
                        slope(commands, &scratch.step, &scratch.trial, tensions, rod.lengths());
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
        let left = residual_of(commands, tensions, rod.lengths()) / length;
        rod.note(&Note { iteration: iteration + 1, residual: left, step: fraction }, tensions);
        if folded {
            blocked += 1;
        } else if fraction < 0.1 {
            damping = LEAST_DAMPING.max(DAMPING_RATIO * damping);
        } else if fraction >= 0.9 {
            damping /= DAMPING_RATIO;
            if damping < LEAST_DAMPING {
                damping = 0.0;
            }
        }
        // Twenty halvings against a fold: what is left of the way to it does not matter.
        if folded && (fraction < 1e-3 || blocked > 20) {
            return Err(unreachable(commands, scratch));
        }
    }
    if residual <= ROUNDING {
        return Ok(Effort { iterations: MAX_ITERATIONS, residual });
    }
    Err(LengthFault::Stalled)
}

/// A cable that is too long and that no tension shortens: on the axis of a rod that does not give.
fn rigid_and_long(given: &Given<'_>, tensions: &[f64], rod: &impl Responds) -> Option<usize> {
    let Given { length, commands, .. } = *given;
    let cables = commands.len();
    (0..cables).find(|&i| {
        let Command::Length { compliance, .. } = commands[i] else { return false };
        let gives = compliance - rod.length_by_tension()[i * cables + i];
        let slack = commands[i].slackness(tensions[i], rod.lengths()[i]);
        gives <= 0.0 && slack < -LENGTH_TOLERANCE * length
    })
}

/// The cable that lacks most at the last point short of the fold, and how short it is there.
fn unreachable(commands: &[Command], scratch: &LengthScratch) -> LengthFault {
    let (tensions, lengths) = (&scratch.step, &scratch.reached);
    let lacking = |i: usize| commands[i].slackness(tensions[i], lengths[i]);
    match (0..commands.len()).min_by(|&a, &b| lacking(a).total_cmp(&lacking(b))) {
        Some(cable) => LengthFault::Unreachable { cable, length: lengths[cable] },
        None => LengthFault::Stalled,
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
    rod: &impl Responds,
    scratch: &mut LengthScratch,
) -> bool {
    let cables = commands.len();
    let slackness = |i: usize| commands[i].slackness(tensions[i], rod.lengths()[i]);
    scratch.free.clear();
    scratch.free.extend((0..cables).filter(|&i| {
        matches!(commands[i], Command::Length { .. }) && (tensions[i] > 0.0 || slackness(i) < 0.0)
    }));
    scratch.trial.clear();
    scratch.trial.extend_from_slice(tensions);
    let LengthScratch { free, independent, .. } = &mut *scratch;
    let effect = |i: usize, j: usize| {
        rod.length_by_tension()[i * cables + j] + Command::stretch(commands, i, j)
    };
    independent.retain(free, REGULARISATION, |j| tensions[j], cables, effect);
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
            .map(|&i| -rod.length_by_tension()[i * cables + i])
            .fold(0.0, f64::max);
        scratch.matrix.clear();
        scratch.step.clear();
        for &i in &scratch.free {
            for &j in &scratch.free {
                let mut entry = -rod.length_by_tension()[i * cables + j];
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
fn damped_step(
    commands: &[Command],
    tensions: &[f64],
    rod: &impl Responds,
    damping: f64,
    scratch: &mut LengthScratch,
) -> bool {
    let cables = commands.len();
    let LengthScratch { free, matrix, step, trial, gradient, least, quadratic, .. } = scratch;
    free.clear();
    free.extend((0..cables).filter(|&i| matches!(commands[i], Command::Length { .. })));
    let compliance = |i: usize| match commands[i] {
        Command::Length { compliance, .. } => compliance,
        Command::Tension(_) => 0.0,
    };
    let curvature = |i: usize, j: usize| {
        let own = if i == j { compliance(i) } else { 0.0 };
        own - rod.length_by_tension()[i * cables + j]
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
    gradient.extend(free.iter().map(|&i| commands[i].slackness(tensions[i], rod.lengths()[i])));
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
