//! A step of actuation, in which all commands change in proportion, as the limit of ever smaller steps.
//!
//! As long as no hole changes the direction in which its cable slides, the state at the end of a substep does not depend
//! on its length: where a cable slides, the tensions hang on the angles alone, and where it sticks,
//! `Dᵢ` is that of before. The equations (2) of one substep are then exact. Only a hole in which the cable slides first
//! and then sticks remembers where it came to rest. The rates `dDᵢ/dt` at both ends of a substep show such
//! holes, and how far they are from the limit: a hole that slid by g and slides back at the rate r at the end of a
//! substep of length h has gone back by
//!
//! ```text
//! r² h² / 4(g + r h)                                                                              (3)
//! ```
//!
//! if its rate has changed evenly. A substep in which that is too much is shortened.

use super::holes::{History, Holes};
use super::law::Law;
use super::newton::FrictionScratch;
use super::response::PassageResponse;
use crate::section::Fault;
use crate::shape::SlipState;
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Failure, Found, Open};

/// Of the backbone's length: less is no sliding.
const SLIDES: f64 = 1e-11;
/// Of the backbone's length: sliding back by less changes no tension by much.
const ROUNDED: f64 = 1e-8;
/// The error that a substep may leave, as a part of the tension of a cable.
const TOLERANCE: f64 = 2e-4;
/// A first short substep, of the step: it shows which holes slide from the start on.
const PROBE: f64 = 1.0 / 64.0;
/// Where a step that seems to need no substeps is looked at for holes that slide and stick again.
const PROBES: [f64; 2] = [PROBE, 0.5];
/// The longest substep, and by how much one is longer than the one before at most.
const LONGEST: f64 = 0.25;
const GROWTH: f64 = 3.0;
/// The first substep where the whole step finds no answer.
const FIRST: f64 = 0.25;
/// A substep that finds no answer is shortened to no less than this.
const LEAST: f64 = 1.0 / 4096.0;
/// Of substeps whose only fault is their error, the shortest.
const LEAST_ACCURATE: f64 = 1.0 / 256.0;
/// Where equilibria are looked for beyond the end of a path, as parts of what is left of the step.
const LEAPS: [f64; 4] = [1.0 / 16.0, 0.25, 0.5, 1.0];
const STUCK: &str =
    "the cables find no state of sticking and sliding: go there in smaller steps of actuation";

/// Goes one step of actuation on from `history`. The shape that the model stands at and the tensions of all passages in
/// `guess`, where they are near the answer, are tried first.
///
/// The ends of the substeps as fractions of the step go into `schedule`. Where it is not empty they are those to take, so
/// that answers on different meshes can be compared.
pub(crate) fn step<M: PassageResponse>(
    model: &mut M,
    holes: &Holes,
    to: &[Command],
    history: &mut History<M::Shape>,
    (guess, schedule): (Option<&[f64]>, &mut Vec<f64>),
    scratch: &mut FrictionScratch,
) -> Result<Found, Failure> {
    let near = guess.map(|guess| (model.shape(), guess));
    let is_first = history.is_empty();
    if is_first {
        *history = History::at_rest(holes);
    }
    let (commands, fault) = (to.to_vec(), None);
    let mut way = Way { holes, to, commands, iterations: 0, fault, scratch };
    if is_first && model.is_loaded() {
        way.load(model, history);
    }
    let at_once = match schedule.is_empty() || schedule.len() == 1 {
        true => way.at_once(model, history, near, is_first, schedule.is_empty()),
        false => None,
    };
    let residual = match at_once {
        Some(residual) => {
            if schedule.is_empty() {
                schedule.push(1.0);
            }
            residual
        }
        None => way.divided(model, history, schedule)?,
    };
    Ok(Found::with(Effort { iterations: way.iterations, residual }))
}

/// The way from one state to the commands of a step.
struct Way<'a> {
    holes: &'a Holes,
    to: &'a [Command],
    /// The commands of the substep.
    commands: Vec<Command>,
    iterations: usize,
    /// A fold that was met since the last state.
    fault: Option<Fault>,
    scratch: &'a mut FrictionScratch,
}

/// The commands at a fraction of the way from a state.
fn between<'a, S>(
    from: &'a History<S>,
    holes: &'a Holes,
    to: &'a [Command],
    fraction: f64,
) -> impl Iterator<Item = Command> + 'a {
    to.iter().enumerate().map(move |(cable, command)| match *command {
        Command::Tension(tension) => {
            let start = from.base[cable];
            Command::Tension(start + fraction * (tension - start))
        }
        Command::Length { target, compliance } => {
            let start = from.beyond[holes.of_cable[cable][0]];
            Command::Length { target: start + fraction * (target - start), compliance }
        }
    })
}

impl Way<'_> {
    /// Puts the loads on the robot at rest, with its cables as they are there.
    fn load<M: PassageResponse>(&mut self, model: &mut M, history: &mut History<M::Shape>) {
        let zero = vec![0.0; self.holes.count()];
        if model.settle(&zero).is_err() {
            return;
        }
        self.scratch.tensions.clone_from(&zero);
        self.set_commands(history, 0.0, 1.0);
        if self.converge(model, &history.beyond).is_ok() {
            self.advance(model, history);
        }
    }

    /// The commands at a fraction `at` of the way from a state that is `1 − left` of it.
    fn set_commands<S>(&mut self, from: &History<S>, part: f64, left: f64) {
        self.commands.clear();
        let fraction = if part >= left { 1.0 } else { part / left };
        self.commands.extend(between(from, self.holes, self.to, fraction));
    }

    /// Newton's method from where model and scratch are.
    fn converge<M: PassageResponse>(
        &mut self,
        model: &mut M,
        before: &[f64],
    ) -> Result<Effort, Open> {
        let law = Law { holes: self.holes, commands: &self.commands, before };
        let found = self.scratch.converge(model, &law);
        self.iterations += match &found {
            Ok(effort) => effort.iterations,
            Err(open) => {
                self.fault = open.fault.or(self.fault);
                open.iterations
            }
        };
        found
    }

    /// Takes the state of the scratch over.
    fn advance<M: PassageResponse>(&mut self, model: &M, history: &mut History<M::Shape>) {
        self.fault = None;
        let FrictionScratch { tensions, beyond, at, .. } = &*self.scratch;
        let state = (&tensions[..], &beyond[..], &at.turns[..]);
        let least = SLIDES * self.holes.length;
        history.advance(self.holes, &self.commands, state, least, model.shape());
    }

    /// All of the step at once, where that is exact.
    fn at_once<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &mut History<M::Shape>,
        near: Option<(M::Shape, &[f64])>,
        is_first: bool,
        is_checked: bool,
    ) -> Option<f64> {
        self.set_commands(history, 1.0, 1.0);
        let mut found = None;
        if let Some((shape, tensions)) = near {
            model.set_shape(&shape);
            self.scratch.tensions.clear();
            self.scratch.tensions.extend_from_slice(tensions);
            found = self.converge(model, &history.beyond).ok();
        }
        if found.is_none() && is_first {
            self.start_uniformly(model, history).ok()?;
            found = self.converge(model, &history.beyond).ok();
        }
        if found.is_none() && history.shape.is_some() {
            self.start_from(model, history);
            found = self.converge(model, &history.beyond).ok();
        }
        let residual = found?.residual;
        if is_checked && self.error(model, history, 1.0, None)? > 1.0 {
            return None;
        }
        if is_checked && (self.sticks() || self.several_change(history)) {
            let shape = model.shape();
            let FrictionScratch { tensions, beyond, at, slip_states, .. } = &*self.scratch;
            let end = (tensions.clone(), beyond.clone(), at.clone(), slip_states.clone());
            let is_monotone =
                PROBES.iter().all(|&at| self.goes_on_from(model, history, at, (&end.3, &end.1)));
            let scratch = &mut *self.scratch;
            (scratch.tensions, scratch.beyond, scratch.at, scratch.slip_states) = end;
            model.set_shape(&shape);
            // The model keeps more of a shape than its unknowns.
            model.measure(&scratch.tensions, &mut scratch.at).ok()?;
            self.set_commands(history, 1.0, 1.0);
            if !is_monotone {
                return None;
            }
        }
        self.advance(model, history);
        Some(residual)
    }

    /// Whether a taut cable sticks in a hole at the state of the scratch.
    fn sticks(&self) -> bool {
        let FrictionScratch { tensions, slip_states, .. } = &*self.scratch;
        slip_states.iter().zip(tensions).any(|(&s, &t)| s == SlipState::Sticks && t > 0.0)
    }

    /// Whether the commands of several cables change.
    fn several_change<S>(&self, history: &History<S>) -> bool {
        let start = between(history, self.holes, self.to, 0.0);
        start.zip(self.to).filter(|(start, end)| start != *end).count() > 1
    }

    /// Whether the holes go on in one direction from a fraction of the step to the end: what sticks there sticks already, and
    /// what slides has not slid farther.
    fn goes_on_from<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &History<M::Shape>,
        at: f64,
        (end, beyond_at_end): (&[SlipState], &[f64]),
    ) -> bool {
        self.set_commands(history, at, 1.0);
        if history.shape.is_some() {
            self.start_from(model, history);
        } else if self.start_uniformly(model, history).is_err() {
            return false;
        }
        if self.converge(model, &history.beyond).is_err() {
            return false;
        }
        let FrictionScratch { tensions, slip_states, beyond, .. } = &*self.scratch;
        let least = ROUNDED * self.holes.length;
        self.holes.all().all(|((cable, _), p)| {
            if tensions[p] == 0.0 || self.holes.coefficients[cable] == 0.0 {
                return true;
            }
            let so_far = history.beyond[p] - beyond[p];
            let rest = beyond[p] - beyond_at_end[p];
            match end[p] {
                SlipState::Sticks => slip_states[p] == SlipState::Sticks,
                SlipState::Pulled => so_far >= -least && rest >= -least,
                SlipState::Released => so_far <= least && rest <= least,
            }
        })
    }

    /// Starts from the state that was reached.
    fn start_from<M: PassageResponse>(&mut self, model: &mut M, history: &History<M::Shape>) {
        if let Some(shape) = &history.shape {
            model.set_shape(shape);
        }
        self.scratch.tensions.clone_from(&history.tensions);
    }

    /// Starts from cables that slide everywhere without friction.
    fn start_uniformly<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &History<M::Shape>,
    ) -> Result<(), Failure> {
        let tensions = &mut self.scratch.tensions;
        tensions.clone_from(&history.tensions);
        for (passages, command) in self.holes.of_cable.iter().zip(&self.commands) {
            if let Command::Tension(given) = *command {
                passages.iter().for_each(|&p| tensions[p] = given);
            }
        }
        model.settle(tensions)
    }

    /// How far the state of the scratch, found in a substep of this length from `before`, may be from the limit, in units of what
    /// it may be; `rates` are those at the start, where they are known. `None` where that cannot be told.
    fn error<M: PassageResponse>(
        &mut self,
        model: &mut M,
        before: &History<M::Shape>,
        length: f64,
        rates: Option<&[f64]>,
    ) -> Option<f64> {
        let from: Vec<Command> = between(before, self.holes, &self.commands, 0.0).collect();
        let law = Law { holes: self.holes, commands: &self.commands, before: &before.beyond };
        // At the rates of the whole step.
        if !self.scratch.differentiate(model, &law, &from) {
            return None;
        }
        self.scratch.rates.iter_mut().for_each(|rate| *rate /= length);
        let FrictionScratch { tensions, beyond, slip_states, rates: now, .. } = &*self.scratch;
        let mut worst: f64 = 0.0;
        for (cable, passages) in self.holes.of_cable.iter().enumerate() {
            if self.holes.coefficients[cable] == 0.0 {
                continue;
            }
            let greatest = |all: &[f64]| passages.iter().map(|&p| all[p]).fold(0.0, f64::max);
            let at_end = match self.to[cable] {
                Command::Tension(tension) => tension,
                Command::Length { .. } => 0.0,
            };
            let tension = greatest(tensions).max(greatest(&before.tensions)).max(at_end);
            let unit = TOLERANCE * tension * self.holes.compliance / passages.len() as f64;
            for &p in passages.iter().filter(|&&p| tensions[p] > 0.0) {
                let slip = before.beyond[p] - beyond[p];
                let error = match slip_states[p] {
                    SlipState::Sticks => rates.map_or(0.0, |rates| 0.25 * rates[p].abs() * length),
                    SlipState::Pulled | SlipState::Released => {
                        let back = now[p] * slip.signum() * length;
                        if back > 0.0 { back * back / (4.0 * (slip.abs() + back)) } else { 0.0 }
                    }
                };
                worst = worst.max(error / unit);
            }
        }
        worst.is_finite().then_some(worst)
    }

    /// The step in substeps, those of the schedule where there is one.
    fn divided<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &mut History<M::Shape>,
        schedule: &mut Vec<f64>,
    ) -> Result<f64, Failure> {
        let given = core::mem::take(schedule);
        let (mut at, mut length, mut residual, mut leaps) = (0.0, PROBE, 0.0, 0);
        let mut rates: Option<Vec<f64>> = None;
        if !given.is_empty() {
            length = 1.0;
        } else if history.shape.is_none() {
            length = FIRST;
        }
        while at < 1.0 {
            let left = 1.0 - at;
            if let Some(next) = given.iter().find(|&&next| next > at) {
                length = f64::min(length, next - at);
            } else if length > 0.75 * left {
                length = left;
            } else {
                length = length.min(LONGEST);
            }
            self.set_commands(history, length, left);
            if history.shape.is_some() {
                self.start_from(model, history);
            } else if let Err(failure) = self.start_uniformly(model, history) {
                length *= 0.25;
                if length < LEAST || model.meter().has_ended() {
                    return Err(failure.reached(at));
                }
                continue;
            }
            let found = self.converge(model, &history.beyond);
            let error = match &found {
                Ok(_) if !given.is_empty() => Some(0.0),
                // Where it cannot be told, no other length tells more.
                Ok(_) => Some(self.error(model, history, length, rates.as_deref()).unwrap_or(0.0)),
                Err(_) => None,
            };
            match (found, error) {
                // The last substep takes what is left, which is up to a third longer than it would be.
                (Ok(effort), Some(error)) if error <= 1.0 || 0.75 * length <= LEAST_ACCURATE => {
                    self.advance(model, history);
                    at = if length >= left { 1.0 } else { at + length };
                    residual = effort.residual;
                    schedule.push(at);
                    length *= if given.is_empty() {
                        (0.8 / error.sqrt()).clamp(0.2, GROWTH)
                    } else {
                        1e9
                    };
                    rates = Some(self.scratch.rates.clone());
                }
                (Ok(_), Some(error)) => {
                    length = (length * (0.8 / error.sqrt()).clamp(0.1, 0.7)).max(LEAST_ACCURATE);
                }
                (found, _) => {
                    length *= 0.25;
                    if length >= LEAST && !model.meter().has_ended() {
                        continue;
                    }
                    let open = found.err();
                    let Some((part, effort)) = self.leap(model, history, left, leaps) else {
                        return Err(self.failure(model, open, at));
                    };
                    self.advance(model, history);
                    at = if part >= left { 1.0 } else { at + part };
                    schedule.push(at);
                    (residual, length, rates) = (effort.residual, PROBE, None);
                    leaps += 1;
                }
            }
        }
        Ok(residual)
    }

    /// An equilibrium farther on where none is left beside the last one: the robot snaps there. The part of the step to it.
    fn leap<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &History<M::Shape>,
        left: f64,
        leaps: usize,
    ) -> Option<(f64, Effort)> {
        // After a few of them in a row of what is left at once.
        for part in LEAPS[leaps.min(LEAPS.len() - 1)..].iter().map(|part| part * left) {
            self.set_commands(history, part, left);
            for from_last in [true, false] {
                if model.meter().has_ended() {
                    return None;
                }
                if from_last && history.shape.is_some() {
                    self.start_from(model, history);
                } else if from_last || self.start_uniformly(model, history).is_err() {
                    continue;
                }
                if let Ok(effort) = self.converge(model, &history.beyond) {
                    return Some((part, effort));
                }
            }
        }
        None
    }

    /// Why the step goes no farther than to a fraction of it.
    fn failure<M: PassageResponse>(&self, model: &M, open: Option<Open>, reached: f64) -> Failure {
        let failure = match self.fault {
            Some(fault) => model.failure(fault, &self.scratch.tensions),
            None => Failure::NotConverged {
                iterations: self.iterations,
                residual: open.map_or(1.0, |open| open.gap),
                last_load: 0.0,
                advice: STUCK,
            },
        };
        failure.reached(reached)
    }
}
