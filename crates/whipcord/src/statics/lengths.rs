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

use super::command::Command;
use super::infeasible_lengths;
use super::length_step::{StepScratch, damped_step, newton_step};
use super::outcome::Failure;
use crate::budget::Meter;
use crate::section::Fault;

/// A rod that answers tensions with the lengths of its cables.
pub(crate) trait TensionResponse {
    /// Finds its shape under these tensions in N, starting from the last one when `warm`.
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault>;
    /// `ℓᵢ` in m.
    fn lengths(&self) -> &[f64];
    /// `∂ℓᵢ/∂τⱼ` by rows in m/N.
    fn length_by_tension(&self) -> &[f64];
    /// Allows as much effort from now on as this stage of a search deserves.
    fn allow(&mut self, _stage: Stage) {}
    /// Whether the effort that was allowed last is used up: the search then ends with what it has found.
    fn is_spent(&self) -> bool {
        false
    }
    /// How many steps in a row may end before a fold until it is taken for the limit.
    fn patience(&self) -> usize {
        20
    }
    /// Is told of each iteration that led to these tensions.
    fn note(&mut self, note: &Note, tensions: &[f64]);
}

/// The stages of a search for tensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Tensions that give the lengths.
    Tensions,
    /// Whether the lengths contradict one another.
    Contradiction,
    /// Whether the cables get as short as a part of the lengths says, from a neighbouring part.
    Part,
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
    steps: StepScratch,
    /// Tensions and lengths at the last point at which no section had folded.
    from: Vec<f64>,
    reached: Vec<f64>,
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// Length of the backbone in m.
    pub length: f64,
    pub commands: &'a [Command],
    /// Whether it is worth finding out how far cables go that do not go as far as they should.
    pub bracket: bool,
    pub meter: &'a Meter,
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

/// How closely the limit of what can be reached is bracketed, relative to it.
const LIMIT_TOLERANCE: f64 = 1e-4;

/// The first part of the lengths that is tried where they cannot be had at once.
const FIRST_PART: f64 = 0.25;
/// How many parts are tried at most.
const MOST_PARTS: usize = 20;

/// Least damping of the quadratic model, relative to its diagonal, and what it grows and falls by.
const LEAST_DAMPING: f64 = 1e-10;
const DAMPING_RATIO: f64 = 100.0;

/// Solves eq. (6), starting from `tensions`; `rod` ends with the answer.
pub(crate) fn solve(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl TensionResponse,
    scratch: &mut LengthScratch,
) -> Result<Effort, LengthFault> {
    rod.allow(Stage::Tensions);
    let fault = match attempt(given, tensions, rod, scratch) {
        Err(fault @ LengthFault::Stalled) => fault,
        Err(fault @ LengthFault::Unreachable { .. }) if given.bracket => fault,
        other => return other,
    };
    // One length contradicts no other.
    if given.commands.iter().filter(|command| command.is_length()).count() > 1 {
        rod.allow(Stage::Contradiction);
        if let Some(misses) = infeasible_lengths::misses(given, tensions, rod, scratch) {
            return Err(LengthFault::Contradictory { misses });
        }
    }
    match fault {
        LengthFault::Unreachable { .. } => bring_on(given, tensions, rod, scratch),
        other => Err(other),
    }
}

/// Shortens all cables in proportion, step by step, from no tension on: to the lengths, or as far as they go.
fn bring_on(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl TensionResponse,
    scratch: &mut LengthScratch,
) -> Result<Effort, LengthFault> {
    let commands = given.commands;
    release(commands, tensions);
    rod.respond(tensions, false).map_err(LengthFault::Section)?;
    let loose = rod.lengths().to_vec();
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
    // No cable gets shorter than nothing: from there on there is nothing to try.
    let least = (0..commands.len())
        .map(|i| if lack(i) > 0.0 { loose[i] / lack(i) } else { f64::INFINITY })
        .fold(f64::INFINITY, f64::min);
    let (mut reached, mut missed) = (0.0, None);
    let mut good = tensions.to_vec();
    // Where nothing can be had, halving what is asked for would not come to an end.
    for _ in 0..MOST_PARTS {
        if given.meter.has_ended() {
            return Err(LengthFault::Stalled);
        }
        let beyond = missed.unwrap_or(f64::min(least, 1.0));
        let near = beyond - reached <= LIMIT_TOLERANCE * beyond || beyond <= LIMIT_TOLERANCE;
        if missed.is_some() && near {
            break;
        }
        let next = match missed {
            None if least > 1.0 => f64::min(2.0 * reached + FIRST_PART, 1.0),
            _ => 0.5 * (reached + beyond),
        };
        tensions.copy_from_slice(&good);
        rod.allow(Stage::Part);
        let part = match next {
            1.0 => attempt(given, tensions, rod, scratch),
            _ => attempt(&Given { commands: &scaled(next), ..*given }, tensions, rod, scratch),
        };
        match part {
            Ok(effort) if next == 1.0 => return Ok(effort),
            Ok(_) => {
                reached = next;
                good.copy_from_slice(tensions);
            }
            Err(_) => missed = Some(next),
        }
        if missed.is_none() && least <= 1.0 {
            missed = Some(least);
        }
    }
    // Where next to nothing can be had, it is no cable's own limit but all of them together.
    let several = commands.iter().filter(|command| command.is_length()).count() > 1;
    if reached < LIMIT_TOLERANCE && several {
        return Err(LengthFault::Stalled);
    }
    let relative = |i: usize| lack(i) / loose[i];
    let most = (0..commands.len()).max_by(|&a, &b| relative(a).total_cmp(&relative(b)));
    Err(most.map_or(LengthFault::Stalled, |cable| LengthFault::Unreachable {
        cable,
        length: loose[cable] - reached * lack(cable),
    }))
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
    rod: &mut impl TensionResponse,
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
        if given.meter.has_ended() {
            return Err(LengthFault::Stalled);
        }
        given.meter.iterate();
        let before = residual;
        residual = residual_of(commands, tensions, rod.lengths()) / length;
        if residual <= LENGTH_TOLERANCE || before <= residual && residual <= ROUNDING {
            return Ok(Effort { iterations: iteration, residual });
        }
        if rod.is_spent() {
            break;
        }
        if let Some(cable) = rigid_and_long(given, tensions, rod) {
            return Err(LengthFault::Unreachable { cable, length: rod.lengths()[cable] });
        }
        let mut descent = 0.0;
        if damping == 0.0 {
            if !newton_step(
                commands,
                tensions,
                rod.lengths(),
                rod.length_by_tension(),
                &mut scratch.steps,
            ) {
                break;
            }
            descent = slope(commands, tensions, &scratch.steps.trial, tensions, rod.lengths());
        }
        if descent >= 0.0 {
            damping = damping.max(LEAST_DAMPING);
            if !damped_step(
                commands,
                tensions,
                rod.lengths(),
                rod.length_by_tension(),
                damping,
                &mut scratch.steps,
            ) {
                break;
            }
            descent = slope(commands, tensions, &scratch.steps.trial, tensions, rod.lengths());
        }
        let mut fraction = 1.0;
        let before = residual;
        let mut folded = false;
        scratch.from.clear();
        scratch.from.extend_from_slice(tensions);
        scratch.reached.clear();
        scratch.reached.extend_from_slice(rod.lengths());
        loop {
            for (i, tension) in tensions.iter_mut().enumerate() {
                *tension = scratch.from[i] + fraction * (scratch.steps.trial[i] - scratch.from[i]);
            }
            match rod.respond(tensions, true) {
                Err(_) => {
                    folded = true;
                    fraction *= 0.5;
                }
                Ok(()) => {
                    let now = residual_of(commands, tensions, rod.lengths()) / length;
                    let ahead = slope(
                        commands,
                        &scratch.from,
                        &scratch.steps.trial,
                        tensions,
                        rod.lengths(),
                    );
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
        // After as many halvings against a fold what is left of the way to it does not matter.
        if folded && (fraction < 1e-3 || blocked > rod.patience()) {
            return Err(unreachable(commands, scratch));
        }
    }
    if residual <= ROUNDING {
        return Ok(Effort { iterations: MAX_ITERATIONS, residual });
    }
    Err(LengthFault::Stalled)
}

/// A cable that is too long and that no tension shortens: on the axis of a rod that does not give.
fn rigid_and_long(
    given: &Given<'_>,
    tensions: &[f64],
    rod: &impl TensionResponse,
) -> Option<usize> {
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
    let (tensions, lengths) = (&scratch.from, &scratch.reached);
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
