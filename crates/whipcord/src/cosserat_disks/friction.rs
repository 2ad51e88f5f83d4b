//! Friction of the cables at their holes.
//!
//! A cable enters the base disk along the base's z axis and turns by `φᵢ` in the hole of disk i, from
//! one chord to the next. By Eytelwein's law its tension on the two sides obeys
//!
//! ```text
//! e^(−μφᵢ) Tᵢ₋₁ ≤ Tᵢ ≤ e^(μφᵢ) Tᵢ₋₁                                                             (5)
//! ```
//!
//! and lies at the lower bound where the cable slides towards the base, at the upper one where it
//! slides towards the tip. With `Dᵢ = Σ_{k≥i} (ℓₖ − Tₖ ℓₖ⁰/EA)`, what there is of the cable beyond the
//! hole when nothing stretches it, it has slid by `gᵢ = Dᵢ(before) − Dᵢ` in a step of actuation, and
//!
//! ```text
//! gᵢ − max(0, gᵢ − κ(Tᵢ − e^(−μφᵢ)Tᵢ₋₁)) − min(0, gᵢ + κ(e^(μφᵢ)Tᵢ₋₁ − Tᵢ)) = 0,   κ > 0        (6)
//! ```
//!
//! says all of this in one equation for each hole; where a length is given, `D₀` takes the place of
//! the one at the base. [`super::friction_newton`] solves them together with the shape. Where that does not converge, a semismooth
//! Newton method solves them here for the tension of every piece of cable, with the angles of the last iterate.

use whipcord_numerics::{DenseLu, Pose, Vec3};

use super::friction_newton::Law;
use super::layout::Frame;
use super::span::Chord;
use super::statics::{Closed, Rod};
use crate::shape::SlipState;
use crate::statics::command::Command;
use crate::statics::lengths::{Effort, TensionResponse as _};
use crate::statics::outcome::{Failure, Found};

/// What the holes remember of the steps before.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct History {
    /// `Dᵢ` of every passage, in m; empty before the first step.
    pub beyond: Vec<f64>,
    /// Tension of every passage in N.
    pub tensions: Vec<f64>,
    /// Tension below the base disk, by cable.
    pub base: Vec<f64>,
    /// How the cable came to stand in the near hole of every passage.
    pub slip_states: Vec<SlipState>,
}

/// What does not change from step to step.
#[derive(Clone, Debug)]
pub(super) struct Holes {
    /// Passages of each cable from the base on.
    pub of_cable: Vec<Vec<usize>>,
    /// Friction coefficients.
    pub coefficients: Vec<f64>,
    /// `ℓ⁰/EA` of every passage in m/N.
    pub yielding: Vec<f64>,
    /// `Dᵢ` of the robot at rest.
    pub at_rest: Vec<f64>,
}

const MAX_ITERATIONS: usize = 120;
/// A step that gains nothing is shortened to no less than this.
const LEAST_FRACTION: f64 = 1.0 / 16.0;
/// A step that leads to no equilibrium is shortened to no less than this.
const LEAST_STEP: f64 = 1.0 / 1024.0;
/// Of the backbone's length: slips and tensions, in terms of κ, are met to this.
const TOLERANCE: f64 = 1e-13;
/// Of the backbone's length: less is no sliding.
const SLIDES: f64 = 1e-11;
/// What rounding may leave where nothing improves any more.
const ROUNDING: f64 = 1e-10;
/// The step of actuation is divided into at most so many parts.
const MOST_PARTS: usize = 64;
const STUCK: &str =
    "the cables find no state of sticking and sliding: go there in smaller steps of actuation";

impl Holes {
    /// `Dᵢ` of every passage at these lengths and tensions of passages.
    pub(super) fn beyond(&self, lengths: &[f64], tensions: &[f64], beyond: &mut [f64]) {
        for passages in &self.of_cable {
            let mut sum = 0.0;
            for &p in passages.iter().rev() {
                sum += lengths[p] - tensions[p] * self.yielding[p];
                beyond[p] = sum;
            }
        }
    }
}

/// `φ` at the near hole of every passage, in rad, from the poses of the spans relative to the disk
/// before.
pub(super) fn turns(frame: &Frame, holes: &Holes, spans: &[Pose], chords: &[Chord]) -> Vec<f64> {
    let mut turns = vec![0.0; frame.passages];
    for passages in &holes.of_cable {
        for (k, &p) in passages.iter().enumerate() {
            let coming = match k.checked_sub(1) {
                None => Vec3::Z,
                Some(before) => {
                    spans[before].rotation.conjugate().rotate(chords[passages[before]].along)
                }
            };
            let going = chords[p].along;
            turns[p] = coming.cross(going).norm().atan2(coming.dot(going));
        }
    }
    turns
}

/// Goes one step of actuation on from `history`, in parts where that is needed; the tensions of all
/// passages end in `history`. The iteration starts from `guess`, or from the tensions before.
pub(super) fn step(
    rod: &mut Rod<'_>,
    holes: &Holes,
    commands: &[Command],
    history: &mut History,
    guess: Option<&[f64]>,
) -> Result<Found, Failure> {
    if history.beyond.is_empty() {
        history.beyond.clone_from(&holes.at_rest);
        history.tensions = vec![0.0; holes.at_rest.len()];
        history.base = vec![0.0; commands.len()];
        history.slip_states = vec![SlipState::Sticks; holes.at_rest.len()];
    }
    if let Some(guess) = guess
        && let Ok(found) = newton(rod, holes, commands, history, guess)
    {
        return Ok(found);
    }
    let before = history.clone();
    let mut parts = 1;
    loop {
        *history = before.clone();
        let gone = (1..=parts).try_fold(Found::default(), |found, part| {
            let fraction = part as f64 / parts as f64;
            let commands = between(&before, holes, commands, fraction);
            let start = history.tensions.clone();
            let next = newton(rod, holes, &commands, history, &start)
                .map_err(|failure| failure.reached((part - 1) as f64 / parts as f64))?;
            Ok(Found { iterations: found.iterations + next.iterations, ..next })
        });
        match gone {
            Err(_) if parts < MOST_PARTS && !rod.has_ended() => parts *= 4,
            Ok(found) => {
                history.compare(&before, SLIDES * rod.length());
                return Ok(found);
            }
            Err(failure) => return Err(failure),
        }
    }
}

/// The commands at a fraction of the way from the state before.
fn between(before: &History, holes: &Holes, commands: &[Command], fraction: f64) -> Vec<Command> {
    let part = |(cable, command): (usize, &Command)| match *command {
        Command::Tension(tension) => {
            let start = before.base[cable];
            Command::Tension(start + fraction * (tension - start))
        }
        Command::Length { target, compliance } => {
            let start = before.beyond[holes.of_cable[cable][0]];
            Command::Length { target: start + fraction * (target - start), compliance }
        }
    };
    commands.iter().enumerate().map(part).collect()
}

/// The semismooth Newton method on eq. (6); `history` moves on only where it converges.
fn newton(
    rod: &mut Rod<'_>,
    holes: &Holes,
    commands: &[Command],
    history: &mut History,
    start: &[f64],
) -> Result<Found, Failure> {
    let n = holes.at_rest.len();
    let length = rod.length();
    let kappa = rod.compliance_scale();
    let mut tensions = start.to_vec();
    // A first guess that slides everywhere: without tension no piece of cable could take any.
    for (cable, command) in commands.iter().enumerate() {
        if let Command::Tension(given) = *command {
            for &p in &holes.of_cable[cable] {
                if tensions[p] == 0.0 {
                    tensions[p] = given;
                }
            }
        }
    }
    let law = Law { holes, commands, before: &history.beyond, kappa, length };
    if let Some(closed) = rod.close_with_friction(&law, &tensions) {
        let Closed { tensions, beyond, turns, found } = closed;
        history.advance(holes, commands, (tensions, beyond, &turns), SLIDES * length);
        return Ok(found);
    }
    let (mut beyond, mut lu) = (vec![0.0; n], DenseLu::default());
    let (mut matrix, mut right) = (vec![0.0; n * n], vec![0.0; n]);
    let mut last = f64::INFINITY;
    let (mut kept, mut change) = (tensions.clone(), vec![0.0; n]);
    let (mut fraction, mut size) = (1.0, f64::INFINITY);
    for iteration in 0..MAX_ITERATIONS {
        if rod.has_ended() {
            break;
        }
        rod.iterate();
        if let Err(fault) = rod.respond(&tensions, true) {
            // An iterate that the robot does not bear says nothing of the answer: back towards the last
            // one that it did. Under loads each attempt costs a path of loads, and smaller steps of
            // actuation cost less.
            fraction *= 0.5;
            if iteration == 0 || fraction < LEAST_STEP || rod.is_loaded() || rod.has_ended() {
                return Err(rod.failure(fault, &tensions));
            }
            advance(&mut tensions, &kept, &change, fraction);
            continue;
        }
        let turns = rod.turns(holes);
        holes.beyond(rod.lengths(), &tensions, &mut beyond);
        matrix.fill(0.0);
        let mut worst: f64 = 0.0;
        for (cable, passages) in holes.of_cable.iter().enumerate() {
            for (i, &p) in passages.iter().enumerate() {
                let wrap = holes.coefficients[cable] * turns[p];
                let (least, most) = ((-wrap).exp(), wrap.exp());
                let incoming = match (i, commands[cable]) {
                    (0, Command::Tension(given)) => Some((None, given)),
                    (0, Command::Length { .. }) => None,
                    _ => Some((Some(passages[i - 1]), tensions[passages[i - 1]])),
                };
                let row = &mut matrix[p * n..(p + 1) * n];
                let Some((before, tension)) = incoming else {
                    // D₀ is given; the cable is slack where it would have to push.
                    let Command::Length { target, .. } = commands[cable] else { continue };
                    let lack = beyond[p] - target;
                    if lack + tensions[p] * kappa <= 0.0 {
                        row[p] = kappa;
                        right[p] = -kappa * tensions[p];
                    } else {
                        by_material(rod, holes, &passages[i..], row);
                        right[p] = -lack;
                    }
                    worst = worst.max(right[p].abs());
                    continue;
                };
                let slip = history.beyond[p] - beyond[p];
                let (above, below) = (tensions[p] - least * tension, most * tension - tensions[p]);
                let slip_state = if slip - kappa * above > 0.0 {
                    SlipState::Pulled
                } else if slip + kappa * below < 0.0 {
                    SlipState::Released
                } else {
                    SlipState::Sticks
                };
                let factor = if slip_state == SlipState::Pulled { least } else { most };
                if slip_state == SlipState::Sticks {
                    by_material(rod, holes, &passages[i..], row);
                    right[p] = slip;
                } else {
                    row[p] = kappa;
                    if let Some(before) = before {
                        row[before] = -kappa * factor;
                    }
                    right[p] = kappa * (factor * tension - tensions[p]);
                }
                worst = worst.max(right[p].abs());
            }
        }
        let rounded = worst <= ROUNDING * length && worst > 0.3 * last;
        if worst <= TOLERANCE * length || rounded {
            history.advance(holes, commands, (tensions, beyond, &turns), SLIDES * length);
            let (iterations, residual) = (iteration + 1, worst / length);
            return Ok(Found::with(Effort { iterations, residual }));
        }
        last = worst;
        // From one state of the holes to the next and back: shorter steps find what is between them.
        let now = right.iter().map(|x| x * x).sum::<f64>();
        if now >= size && fraction > LEAST_FRACTION {
            fraction *= 0.5;
        } else {
            if lu.factor(n, &matrix).is_err() {
                break;
            }
            change.clone_from(&right);
            lu.solve(&mut change);
            if !change.iter().all(|x| x.is_finite()) {
                break;
            }
            kept.clone_from(&tensions);
            (fraction, size) = (1.0, now);
        }
        advance(&mut tensions, &kept, &change, fraction);
    }
    Err(Failure::NotConverged {
        iterations: MAX_ITERATIONS,
        residual: last / length,
        last_load: 0.0,
        advice: STUCK,
    })
}

/// A part of a Newton step, to tensions that pull.
fn advance(tensions: &mut [f64], from: &[f64], change: &[f64], fraction: f64) {
    for ((tension, start), d) in tensions.iter_mut().zip(from).zip(change) {
        *tension = (start + fraction * d).max(0.0);
    }
}

/// `∂Dᵢ/∂T` into a row.
fn by_material(rod: &Rod<'_>, holes: &Holes, passages: &[usize], row: &mut [f64]) {
    let n = row.len();
    for &k in passages {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += rod.length_by_tension()[k * n + j];
        }
        row[k] -= holes.yielding[k];
    }
}

impl History {
    /// Moves on to these tensions, `Dᵢ` and `φᵢ` of all passages; a slip of less than `least` in m is none.
    fn advance(
        &mut self,
        holes: &Holes,
        commands: &[Command],
        (tensions, beyond, turns): (Vec<f64>, Vec<f64>, &[f64]),
        least: f64,
    ) {
        let slips = self.beyond.iter().zip(&beyond).map(|(before, now)| before - now);
        for (slip_state, slip) in self.slip_states.iter_mut().zip(slips) {
            *slip_state = SlipState::after(slip, least);
        }
        for (cable, command) in commands.iter().enumerate() {
            let first = holes.of_cable[cable][0];
            let (wrap, tension) = (holes.coefficients[cable] * turns[first], tensions[first]);
            let (least, most) = (tension * (-wrap).exp(), tension * wrap.exp());
            self.base[cable] = match (*command, self.slip_states[first]) {
                (Command::Tension(given), _) => given,
                // Pulled in, the base bears more than the first piece.
                (Command::Length { .. }, SlipState::Pulled) => most,
                (Command::Length { .. }, SlipState::Released) => least,
                (Command::Length { .. }, SlipState::Sticks) => self.base[cable].clamp(least, most),
            };
        }
        (self.beyond, self.tensions) = (beyond, tensions);
    }

    /// What the holes did since `before`.
    fn compare(&mut self, before: &Self, least: f64) {
        let beyond = before.beyond.iter().zip(&self.beyond);
        for (slip_state, (before, now)) in self.slip_states.iter_mut().zip(beyond) {
            *slip_state = SlipState::after(before - now, least);
        }
    }
}

impl SlipState {
    fn after(slip: f64, least: f64) -> Self {
        if slip > least {
            Self::Pulled
        } else if slip < -least {
            Self::Released
        } else {
            Self::Sticks
        }
    }
}
