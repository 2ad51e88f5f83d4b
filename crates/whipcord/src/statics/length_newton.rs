//! The projected Newton method of eq. (6) in [`super::lengths`]: where several cables all but depend on
//! one another, the quadratic model within `τ ≥ 0`, damped as far as it holds.

use super::command::Command;
use super::length_problem::{Given, LengthFault, Note, TensionResponse, release};
use super::length_step::{StepScratch, damped_step, newton_step};
use super::outcome::Effort;

/// Scratch memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct LengthScratch {
    steps: StepScratch,
    /// Tensions and lengths at the last point at which no section had folded.
    from: Vec<f64>,
    reached: Vec<f64>,
}

/// Lengths are met to this fraction of the backbone's length.
const LENGTH_TOLERANCE: f64 = 2e-14;

/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e3 * LENGTH_TOLERANCE;

const MAX_ITERATIONS: usize = 100;

/// Least damping of the quadratic model, relative to its diagonal, and what it grows and falls by.
const LEAST_DAMPING: f64 = 1e-10;

const DAMPING_RATIO: f64 = 100.0;

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
