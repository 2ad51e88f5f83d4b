//! The way of a step of actuation: from one state to the commands, and where holes come to rest on it.

use super::events::Stop;
use super::holes::{History, Holes};
use super::law::Law;
use super::modes::Mode;
use super::newton::FrictionScratch;
use super::response::PassageResponse;
use crate::section::Fault;
use crate::solution::SlipState;
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Failure, Open};

/// Of the backbone's length: less is no sliding.
pub(super) const SLIDES: f64 = 1e-11;

/// The way from one state to the commands of a step.
pub(super) struct Way<'a> {
    pub holes: &'a Holes,
    pub to: &'a [Command],
    /// The commands of the substep.
    pub commands: Vec<Command>,
    /// How far these are from those before it to those of the step.
    pub fraction: f64,
    /// Where holes came to rest within the substep.
    pub stops: Vec<Stop>,
    pub iterations: usize,
    /// Whether nothing was found before.
    pub is_first: bool,
    /// Whether model and scratch have where the substep starts, and its response.
    pub stands: bool,
    /// A fold that was met since the last state.
    pub fault: Option<Fault>,
    /// The fraction of the substep beyond which there is no equilibrium near by, where one is seen.
    pub limit_point: Option<f64>,
    pub scratch: &'a mut FrictionScratch,
}

/// The commands at a fraction of the way from a state.
pub(super) fn between<'a, S>(
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
            let start = holes.at_drive(cable, &from.beyond, &from.tensions);
            Command::Length { target: start + fraction * (target - start), compliance }
        }
    })
}

impl Way<'_> {
    /// The commands at a fraction `at` of the way from a state that is `1 − left` of it.
    pub fn set_commands<S>(&mut self, from: &History<S>, part: f64, left: f64) {
        self.commands.clear();
        self.fraction = if part >= left { 1.0 } else { part / left };
        self.commands.extend(between(from, self.holes, self.to, self.fraction));
    }

    /// Newton's method from where model and scratch are.
    pub fn converge<M: PassageResponse>(
        &mut self,
        model: &mut M,
        before: &[f64],
    ) -> Result<Effort, Open> {
        self.converge_in(model, before, None)
    }

    /// The same in these cases of the holes where they are given.
    fn converge_in<M: PassageResponse>(
        &mut self,
        model: &mut M,
        before: &[f64],
        modes: Option<&[Mode]>,
    ) -> Result<Effort, Open> {
        let law = Law { holes: self.holes, commands: &self.commands, before, modes };
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

    pub fn take_over<M: PassageResponse>(
        &self,
        model: &M,
        history: &mut History<M::Shape>,
        rest: &[f64],
    ) {
        let FrictionScratch { tensions, beyond, at, .. } = &*self.scratch;
        let state = (&tensions[..], &beyond[..], &at.turns[..]);
        let least = SLIDES * self.holes.length;
        history.beyond.clear();
        history.beyond.extend_from_slice(rest);
        history.advance(self.holes, &self.commands, state, least, model.shape());
    }

    /// Adds to the trail where holes came to rest within the substep to the present state, each with the equilibrium there.
    pub fn note_stops<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &mut History<M::Shape>,
    ) {
        let Some(mut trail) = history.trail.take() else { return };
        let stops = core::mem::take(&mut self.stops);
        let FrictionScratch { tensions, beyond, at, slip_states, .. } = &*self.scratch;
        let counts =
            |&(p, _): &(usize, f64)| slip_states[p] == SlipState::Sticks && tensions[p] > 0.0;
        if stops.iter().flat_map(|stop| &stop.holes).any(counts) && history.shape.is_some() {
            let end = (tensions.clone(), beyond.clone(), at.clone(), slip_states.clone());
            let kept = (model.shape(), self.commands.clone(), self.fraction, self.iterations);
            let rate = |(start, end): (Command, &Command)| end.number() - start.number();
            let start = between(history, self.holes, self.to, 0.0);
            let rates: Vec<f64> = start.zip(self.to).map(rate).collect();
            let mut there = history.clone();
            let mut rest = history.beyond.clone();
            self.start_from(model, history);
            for stop in &stops {
                self.fraction = kept.2 * stop.at;
                self.commands.clear();
                self.commands.extend(between(history, self.holes, self.to, self.fraction));
                // At an event two cases of a hole meet: those before it decide, where the iteration does not.
                let is_found = self.converge(model, &rest).is_ok()
                    || self.converge_in(model, &rest, Some(&stop.modes)).is_ok();
                if !is_found {
                    trail.is_broken = true;
                    break;
                }
                self.take_over(model, &mut there, &rest);
                let commands = (&self.commands[..], self.fraction);
                let end = there.end(self.holes, commands, self.scratch, &rest, Some(&stop.modes));
                trail.ends.extend(end.map(|mut end| {
                    (end.standing.trigger, end.standing.rates) = (stop.trigger, rates.clone());
                    end.stops = Some(stop.holes.iter().map(|&(p, _)| p).collect());
                    end
                }));
                stop.holes.iter().for_each(|&(p, beyond)| rest[p] = beyond);
            }
            model.set_shape(&kept.0);
            (self.commands, self.fraction, self.iterations) = (kept.1, kept.2, kept.3);
            let scratch = &mut *self.scratch;
            (scratch.tensions, scratch.beyond, scratch.at, scratch.slip_states) = end;
            // The model keeps more of a shape than its unknowns.
            trail.is_broken |= model.measure(&scratch.tensions, &mut scratch.at).is_err();
            self.stands = false;
        }
        history.trail = Some(trail);
    }

    /// Starts from the state that was reached.
    pub fn start_from<M: PassageResponse>(&mut self, model: &mut M, history: &History<M::Shape>) {
        if let Some(shape) = &history.shape {
            model.set_shape(shape);
        }
        self.scratch.tensions.clone_from(&history.tensions);
    }

    /// Starts from cables that slide everywhere without friction.
    pub fn start_uniformly<M: PassageResponse>(
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
        model.converge(tensions)
    }
}
