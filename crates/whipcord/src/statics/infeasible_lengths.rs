//! Which prescribed cable lengths contradict one another, and by how much.
//!
//! Eq. (6) of [`super::lengths`] has no answer where its objective falls without bound: the lengths of some
//! cables then cannot be had together, whatever pulls at them. With cables that give, `cᵢ → cᵢ + c`, it
//! always has one, in which cable i is `eᵢ = c τᵢ` too long. That is the least of
//!
//! ```text
//! ½ Σ eᵢ²/c + the energy of the rod        over the shapes of the rod
//! ```
//!
//! so that with `c → 0` the `eᵢ` tend to the least squares by which the lengths must be missed: to nothing
//! where they can be had, and for cables that take part in a contradiction to what each of them would have
//! to give.

use super::command::Command;
use super::length_newton::{LengthScratch, attempt};
use super::length_problem::{Given, TensionResponse, release};

/// `c` of the first attempt, relative to what the rod itself gives, and what it falls by.
const FIRST_COMPLIANCE: f64 = 1.0;
const COMPLIANCE_RATIO: f64 = 0.5;
const ATTEMPTS: usize = 32;
/// The limit counts as converged when it changes by less than this of its largest entry.
const SETTLED: f64 = 1e-6;
/// Where the rod does not bear the tensions of a smaller `c`, what is known to this must do.
const ROUGHLY_SETTLED: f64 = 1e-2;
/// A cable takes part when it misses its length by more than this of the largest miss.
const TAKES_PART: f64 = 1e-2;

/// By how much in m each cable misses its length at the best compromise, 0 for those that take no part;
/// `None` where no two are found to contradict one another. Overwrites the tensions.
pub(crate) fn misses(
    given: &Given<'_>,
    tensions: &mut [f64],
    rod: &mut impl TensionResponse,
    scratch: &mut LengthScratch,
) -> Option<Vec<f64>> {
    let cables = tensions.len();
    release(given.commands, tensions);
    rod.respond(tensions, false).ok()?;
    let softest =
        (0..cables).map(|i| -rod.length_by_tension()[i * cables + i]).fold(0.0_f64, f64::max);
    let mut commands = given.commands.to_vec();
    let mut spring = FIRST_COMPLIANCE * softest;
    let mut missed: Option<Vec<f64>> = None;
    let mut limit: Option<Vec<f64>> = None;
    let mut change = f64::INFINITY;
    for _ in 0..ATTEMPTS {
        for (command, given) in commands.iter_mut().zip(given.commands) {
            if let Command::Length { target, compliance } = *given {
                *command = Command::Length { target, compliance: compliance + spring };
            }
        }
        let relaxed = Given { commands: &commands, ..*given };
        if attempt(&relaxed, tensions, rod, scratch).is_err() {
            break;
        }
        let miss = |(tension, command): (&f64, &Command)| match command {
            Command::Length { .. } => spring * tension,
            Command::Tension(_) => 0.0,
        };
        let now: Vec<f64> = tensions.iter().zip(given.commands).map(miss).collect();
        if let Some(before) = &missed {
            // They differ from their limit by a multiple of `c`, and more beyond.
            let ahead = COMPLIANCE_RATIO / (1.0 - COMPLIANCE_RATIO);
            let next: Vec<f64> =
                now.iter().zip(before).map(|(now, before)| now - ahead * (before - now)).collect();
            if let Some(limit) = &limit {
                let moved = next.iter().zip(limit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                change = moved / largest(&next);
            }
            limit = Some(next);
        }
        missed = Some(now);
        if change <= SETTLED {
            break;
        }
        spring *= COMPLIANCE_RATIO;
    }
    let mut limit = limit.filter(|_| change <= ROUGHLY_SETTLED)?;
    let least = TAKES_PART * largest(&limit);
    limit.iter_mut().filter(|miss| **miss <= least).for_each(|miss| *miss = 0.0);
    (limit.iter().filter(|&&miss| miss > 0.0).count() >= 2).then_some(limit)
}

fn largest(misses: &[f64]) -> f64 {
    misses.iter().fold(0.0, |largest, miss| miss.max(largest))
}
