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
pub(crate) use super::length_newton::{LengthScratch, attempt};
pub(crate) use super::length_problem::{Given, LengthFault, Note, Stage, TensionResponse, release};
pub(crate) use super::outcome::Effort;

/// How closely the limit of what can be reached is bracketed, relative to it.
const LIMIT_TOLERANCE: f64 = 1e-4;

/// The first part of the lengths that is tried where they cannot be had at once.
const FIRST_PART: f64 = 0.25;
/// How many parts are tried at most.
const MOST_PARTS: usize = 20;

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
