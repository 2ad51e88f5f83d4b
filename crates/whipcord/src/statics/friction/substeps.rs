//! A step of actuation, in which all commands change in proportion, as the limit of ever smaller steps.
//!
//! Where a cable slides in a hole, the tensions hang on the angles alone, and where it sticks, `Dᵢ` is that at which it came to
//! rest. The equations (2) of one substep are therefore exact if `Dᵢ(before)` of each hole that sticks at the end of the substep is
//! where it last came to rest. [`super::events`] finds these places, with the linear response of the robot: first with that at the start of the
//! substep, then with that at both ends. Two differences show the error: that of the tensions with the places of both passes,
//! and that of the tensions at the end from those of the linear response. A substep in which they are too great is shortened.

use super::holes::{History, Holes};
use super::law::Law;
use super::newton::FrictionScratch;
use super::response::PassageResponse;
use super::way::{Way, between};
use crate::budget::Meter;
use crate::solution::SlipState;
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Failure, Found, Open};

/// Of the backbone's length: places where a hole comes to rest that differ by less are one.
const ROUNDED: f64 = 1e-9;
/// By how much of the greatest tension of its cable a tension may differ between the two passes of a substep; what the second
/// leaves is much less.
const TOLERANCE: f64 = 1e-3;
/// By how much of the greatest tension of its cable a tension may differ from that of the linear response: where a hole may come to
/// rest, and where none does.
const LINEAR: [f64; 2] = [3e-3, 0.3];
/// Tensions below this part of the greatest of all cables, or of the force that bends the robot, need no accuracy of their own.
const SLIGHT: [f64; 2] = [1e-2, 1e-4];
/// The longest substep whose error cannot be told.
const UNKNOWN: f64 = 1.0 / 16.0;
/// The substep after one, of its length, at most.
const GROWTH: f64 = 3.0;
/// A substep that is longer than this part of what is left takes all of it.
const SHORTER: f64 = 0.75;
/// Lengths of substeps are powers of this.
const LENGTH_RATIO: f64 = 0.8;
/// A substep that finds no answer is shortened to no less than this.
const LEAST: f64 = 1.0 / 4096.0;
/// Of substeps whose only fault is their error, the shortest.
const LEAST_ACCURATE: f64 = 1.0 / 256.0;
/// The error of a substep that is as long as on another mesh, in units of what it may be elsewhere: a greater one differs from mesh to mesh by more
/// than the meshes do.
const MOST_OF_COURSE: f64 = 10.0;
/// A substep that would go beyond a limit point ends at so much of the way to it: where that is, is known well only near by.
const BEFORE_LIMIT_POINT: f64 = 0.5;
/// Where equilibria are looked for beyond the end of a path, as parts of what is left of the step.
const LEAPS: [f64; 4] = [1.0 / 16.0, 0.25, 0.5, 1.0];
/// The first substep after one of them, of the step.
const AFTER_LEAP: f64 = 1.0 / 64.0;
const STUCK: &str =
    "the cables find no state of sticking and sliding: go there in smaller steps of actuation";

/// The nearest power of [`LENGTH_RATIO`] that is not greater than `most`. The division of a step then stays as it is while what it depends on
/// changes a little: the answer is as smooth as one division makes it, and changes with commands and parameters as its derivatives say.
fn nearest_length(length: f64, most: f64) -> f64 {
    let mut nearest = 1.0;
    while nearest > most || nearest * LENGTH_RATIO.sqrt() > length {
        nearest *= LENGTH_RATIO;
    }
    nearest
}

/// How a step of actuation was taken on one mesh, for the finer ones.
#[derive(Clone, Debug)]
pub(crate) struct Course<S> {
    /// Ends of the substeps, as fractions of the step; empty before the first mesh.
    pub ends: Vec<f64>,
    /// By how much `Dᵢ` where each hole last came to rest is greater than before the step, in m.
    pub rest: Vec<f64>,
    /// Shape and tensions at the end.
    pub answer: Option<(S, Vec<f64>)>,
}

impl<S> Default for Course<S> {
    fn default() -> Self {
        Self { ends: Vec::new(), rest: Vec::new(), answer: None }
    }
}

/// Goes one step of actuation on from `history`. A course that is known is followed: from its answer with its places
/// of rest where it has them, else in its substeps. One that is empty is filled.
pub(crate) fn step<M: PassageResponse>(
    model: &mut M,
    holes: &Holes,
    to: &[Command],
    history: &mut History<M::Shape>,
    course: &mut Course<M::Shape>,
    scratch: &mut FrictionScratch,
) -> Result<Found, Failure> {
    let is_first = history.is_empty();
    if is_first {
        *history = History { trail: history.trail.take(), ..History::at_rest(holes) };
    }
    if let Some(trail) = &mut history.trail {
        trail.steps.push(trail.ends.len());
        // Places of rest that another mesh found have their derivatives there.
        if course.rest.iter().any(|slid| *slid != 0.0) {
            course.rest.clear();
        }
    }
    let (commands, fault) = (to.to_vec(), None);
    let mut way = Way {
        holes,
        to,
        commands,
        fraction: 1.0,
        stops: Vec::new(),
        iterations: 0,
        fault,
        limit_point: None,
        is_first,
        stands: false,
        scratch,
    };
    if is_first {
        way.load(model, history);
    }
    let residual = match way.finish(model, history, course) {
        Some(residual) => residual,
        None => way.go(model, history, course)?,
    };
    Ok(Found::with(Effort { iterations: way.iterations, residual }))
}

impl Way<'_> {
    /// Puts the loads on the robot at rest, with its cables as they are there.
    fn load<M: PassageResponse>(&mut self, model: &mut M, history: &mut History<M::Shape>) {
        let zero = vec![0.0; self.holes.count()];
        if model.converge(&zero).is_err() {
            return;
        }
        self.scratch.tensions.clone_from(&zero);
        self.set_commands(history, 0.0, 1.0);
        if self.converge(model, &history.beyond).is_ok() {
            let rest = history.beyond.clone();
            self.advance(model, history, &rest);
            self.is_first = true;
        }
    }

    /// Takes the state of the scratch over, with where each hole last came to rest.
    fn advance<M: PassageResponse>(
        &mut self,
        model: &M,
        history: &mut History<M::Shape>,
        rest: &[f64],
    ) {
        self.fault = None;
        self.take_over(model, history, rest);
        if history.trail.is_some() {
            let commands = (&self.commands[..], self.fraction);
            let end = history.end(self.holes, commands, self.scratch, rest, None);
            history.trail.iter_mut().for_each(|trail| trail.ends.extend(end.clone()));
        }
        self.is_first = false;
        if self.stands {
            // The end of the substep is where the next one starts.
            let FrictionScratch { start, end, .. } = &mut *self.scratch;
            core::mem::swap(start, end);
            start.beyond.clone_from(&history.beyond);
            start.slip_states.clone_from(&history.slip_states);
        }
    }

    /// The end of the step on a finer mesh, from that of its course.
    fn finish<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &mut History<M::Shape>,
        course: &Course<M::Shape>,
    ) -> Option<f64> {
        let answer = course.answer.as_ref()?;
        if course.rest.len() != self.holes.count() {
            return None;
        }
        self.set_commands(history, 1.0, 1.0);
        let rest: Vec<f64> =
            history.beyond.iter().zip(&course.rest).map(|(before, slid)| before + slid).collect();
        self.start_near(model, answer);
        let effort = self.converge(model, &rest).ok()?;
        self.advance(model, history, &rest);
        Some(effort.residual)
    }

    fn start_near<M: PassageResponse>(&mut self, model: &mut M, near: &(M::Shape, Vec<f64>)) {
        model.set_shape(&near.0);
        self.scratch.tensions.clone_from(&near.1);
    }

    /// The state that was reached as the start of a substep; `false` where its response is not known.
    fn stand<M: PassageResponse>(&mut self, model: &mut M, history: &History<M::Shape>) -> bool {
        if history.shape.is_none() {
            return false;
        }
        self.start_from(model, history);
        let FrictionScratch { tensions, at, .. } = &mut *self.scratch;
        if model.measure(tensions, at).is_err() {
            return false;
        }
        let mut start = core::mem::take(&mut self.scratch.start);
        let is_known = self.scratch.station(model, &mut start);
        start.beyond.clone_from(&history.beyond);
        start.slip_states.clone_from(&history.slip_states);
        self.scratch.start = start;
        is_known
    }

    /// Where the holes last come to rest in the substep, by the response at its start, or at both ends, where it is known how much of the
    /// tensions the one at the start misses; `false` where this does not tell.
    fn follow<S>(&mut self, history: &History<S>, missed: Option<f64>, meter: &Meter) -> bool {
        let from: Vec<Command> = between(history, self.holes, &self.commands, 0.0).collect();
        let law = Law {
            holes: self.holes,
            commands: &self.commands,
            before: &history.beyond,
            modes: None,
        };
        let FrictionScratch { start, end, events, .. } = &mut *self.scratch;
        let end = missed.map(|missed| (&*end, missed));
        let followed = events.follow(&law, &from, start, end, meter);
        events.problem.charge(meter);
        followed
    }

    /// The greatest difference of the tensions of the scratch from these, as a part of the greatest one of its cable. Cables that
    /// hardly pull count as if they pulled with a small part of what the others do, or of what bends the robot.
    fn tensions_apart<S>(&self, history: &History<S>, others: &[f64]) -> f64 {
        let tensions = &self.scratch.tensions;
        let greatest = |passages: &[usize], command: &Command| {
            let at_end = match *command {
                Command::Tension(tension) => tension,
                Command::Length { .. } => 0.0,
            };
            let of = |p: &usize| tensions[*p].max(history.tensions[*p]);
            passages.iter().map(of).fold(at_end, f64::max)
        };
        let cables = || self.holes.of_cable.iter().zip(self.to);
        let of_all = cables().map(|(passages, command)| greatest(passages, command));
        let least = SLIGHT[0] * of_all.fold(0.0, f64::max);
        let least = least.max(SLIGHT[1] * self.holes.length / self.holes.compliance);
        let mut worst: f64 = 0.0;
        for (passages, command) in cables() {
            let apart = |p: &usize| (tensions[*p] - others[*p]).abs();
            let apart = passages.iter().map(apart).fold(0.0, f64::max);
            if apart > 0.0 {
                let greatest = greatest(passages, command).max(least);
                worst = worst.max(apart / greatest.max(f64::MIN_POSITIVE));
            }
        }
        worst
    }

    /// The substep from where the history ends to the commands: the effort of its solve, and its error in units of what it may be;
    /// `None` where that cannot be told. Leaves in `rest` where the holes came to rest.
    fn substep<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &History<M::Shape>,
        near: Option<&(M::Shape, Vec<f64>)>,
        rest: &mut Vec<f64>,
    ) -> Result<(Effort, Option<f64>), Option<Open>> {
        let is_known = self.stands || self.stand(model, history);
        self.stands = false;
        self.scratch.events.keeps_stops = history.trail.is_some();
        let is_followed = is_known && self.follow(history, None, model.meter());
        if let Some(limit_point) =
            self.scratch.events.limit_point.filter(|_| is_known && !is_followed)
            && history.shape.is_some()
            && !self.is_first
        {
            // No iteration finds an equilibrium beyond it that goes on from the last one.
            self.limit_point = Some(limit_point);
            return Err(None);
        }
        let no_event = self.scratch.events.count == 0;
        rest.clear();
        rest.extend_from_slice(if is_followed {
            &self.scratch.events.rest
        } else {
            &history.beyond
        });
        self.stops.clear();
        if is_followed {
            self.stops.clone_from(&self.scratch.events.stops);
        }
        let mut effort = self.find(model, history, near, is_followed, rest)?;
        let missed = match is_followed {
            true => self.tensions_apart(history, &self.scratch.events.tensions),
            false => f64::INFINITY,
        };
        let follows =
            is_known && self.end(model) && self.follow(history, Some(missed), model.meter());
        if !follows {
            return Ok((effort, None));
        }
        self.stands = true;
        let least = ROUNDED * self.holes.length;
        let FrictionScratch { events, slip_states, tensions, .. } = &*self.scratch;
        let moved = |p: usize| {
            let sticks = slip_states[p] == SlipState::Sticks && tensions[p] > 0.0;
            sticks && (events.rest[p] - rest[p]).abs() > least
        };
        let mut change = 0.0;
        if (0..rest.len()).any(moved) {
            let first = tensions.clone();
            rest.clone_from(&events.rest);
            self.stops.clone_from(&events.stops);
            self.stands = false;
            let corrected = self.converge(model, rest).map_err(Some)?;
            let iterations = effort.iterations + corrected.iterations;
            effort = Effort { iterations, residual: corrected.residual };
            change = self.tensions_apart(history, &first);
        }
        let FrictionScratch { events, slip_states, tensions, beyond, .. } = &*self.scratch;
        let is_sure = no_event
            && events.count == 0
            && events.agrees_with(slip_states)
            && (!self.sticks() || events.is_sure(self.holes, tensions, beyond));
        let curved = self.tensions_apart(history, &events.tensions);
        let error = (change / TOLERANCE).max(curved / LINEAR[usize::from(is_sure)]);
        Ok((effort, Some(error)))
    }

    /// The state of the scratch as the end of a substep; `false` where its response is not known.
    fn end<M: PassageResponse>(&mut self, model: &mut M) -> bool {
        let mut end = core::mem::take(&mut self.scratch.end);
        let is_known = self.scratch.station(model, &mut end);
        self.scratch.end = end;
        is_known
    }

    /// Whether a taut cable sticks in a hole at the state of the scratch.
    fn sticks(&self) -> bool {
        let FrictionScratch { tensions, slip_states, .. } = &*self.scratch;
        slip_states.iter().zip(tensions).any(|(&s, &t)| s == SlipState::Sticks && t > 0.0)
    }

    /// Goes from the start of the substep, where the model was linearised last, to where the linear response has it at the end.
    fn predict<M: PassageResponse>(&mut self, model: &mut M) -> bool {
        let FrictionScratch { tensions, start, events, .. } = &mut *self.scratch;
        let pairs = events.tensions.iter().zip(&start.tensions);
        let changes: Vec<f64> = pairs.map(|(end, start)| end - start).collect();
        if model.prepare(&changes).is_none_or(|most| most < 1.0) {
            return false;
        }
        model.go(1.0);
        tensions.clear();
        tensions.extend(events.tensions.iter().map(|tension| tension.max(0.0)));
        true
    }

    /// The equilibrium at the commands with these places of rest.
    fn find<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &History<M::Shape>,
        near: Option<&(M::Shape, Vec<f64>)>,
        is_followed: bool,
        rest: &[f64],
    ) -> Result<Effort, Option<Open>> {
        if is_followed
            && self.predict(model)
            && let Ok(effort) = self.converge(model, rest)
        {
            return Ok(effort);
        }
        if let Some(near) = near {
            self.start_near(model, near);
            if let Ok(effort) = self.converge(model, rest) {
                return Ok(effort);
            }
        }
        if self.is_first
            && self.start_uniformly(model, history).is_ok()
            && let Ok(effort) = self.converge(model, rest)
        {
            return Ok(effort);
        }
        if history.shape.is_none() {
            return Err(None);
        }
        self.start_from(model, history);
        self.converge(model, rest).map_err(Some)
    }

    /// The step in substeps, those of the course where it is known.
    fn go<M: PassageResponse>(
        &mut self,
        model: &mut M,
        history: &mut History<M::Shape>,
        course: &mut Course<M::Shape>,
    ) -> Result<f64, Failure> {
        let Course { ends: given, answer, .. } = core::mem::take(course);
        let (mut at, mut length, mut residual, mut leaps) = (0.0, 1.0, 0.0, 0);
        let (mut rest, before) = (Vec::new(), history.beyond.clone());
        let shortest = |error: Option<f64>| if error.is_some() { LEAST_ACCURATE } else { UNKNOWN };
        while at < 1.0 {
            let left = 1.0 - at;
            let end = given.iter().copied().find(|&next| next > at).unwrap_or(1.0);
            let is_to_end = length > SHORTER * (end - at);
            if is_to_end {
                length = end - at;
            }
            self.set_commands(history, length, left);
            let near = answer.as_ref().filter(|_| length >= left);
            match self.substep(model, history, near, &mut rest) {
                // The last substep takes what is left, which is up to a third longer than it would be. One of another mesh is as long as
                // there, so that the answers differ by what the meshes do, unless its error is too great for that or cannot be told.
                Ok((effort, error))
                    if (!given.is_empty()
                        && error.is_some_and(|error| error <= MOST_OF_COURSE))
                        || error.is_some_and(|error| error <= 1.0)
                        || 0.75 * length <= shortest(error) =>
                {
                    self.note_stops(model, history);
                    self.advance(model, history, &rest);
                    at = if is_to_end { end } else { at + length };
                    residual = effort.residual;
                    course.ends.push(at);
                    length *= match error {
                        // The next one of that mesh.
                        _ if is_to_end && !given.is_empty() => 1e9,
                        Some(error) => (0.8 / error.sqrt()).clamp(0.2, GROWTH),
                        None => 1.0,
                    };
                    length = nearest_length(length, 1.0);
                }
                Ok((_, error)) => {
                    self.stands = false;
                    let factor = error.map_or(0.25, |error| (0.8 / error.sqrt()).clamp(0.1, 0.7));
                    length = nearest_length(length * factor, SHORTER * left).max(shortest(error));
                }
                Err(open) => {
                    self.stands = false;
                    length *= match self.limit_point.take() {
                        Some(limit_point) => BEFORE_LIMIT_POINT * limit_point,
                        None => 0.25,
                    };
                    if length >= LEAST && !model.meter().has_ended() {
                        continue;
                    }
                    let Some((part, effort)) = self.leap(model, history, left, leaps) else {
                        return Err(self.failure(model, open, at));
                    };
                    rest.clone_from(&history.beyond);
                    self.advance(model, history, &rest);
                    at = if part >= left { 1.0 } else { at + part };
                    course.ends.push(at);
                    (residual, length) = (effort.residual, AFTER_LEAP);
                    leaps += 1;
                }
            }
        }
        course.rest = rest.iter().zip(&before).map(|(rest, before)| rest - before).collect();
        course.answer = Some((model.shape(), history.tensions.clone()));
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
                self.scratch.is_leap = true;
                let found = self.converge(model, &history.beyond);
                self.scratch.is_leap = false;
                if let Ok(effort) = found {
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
