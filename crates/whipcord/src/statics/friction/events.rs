//! Where the holes go in a substep, event by event.
//!
//! Between two events, at which a hole begins to slide or stops, the commands, tensions, angles and `Dᵢ` change together, by
//! the linear response of the robot: the holes that stick keep their `Dᵢ`, those that slide keep to a bound of eq. (1). An event is
//! where a hole that sticks comes to a bound, or where the rate `dDᵢ/dt` of one that slides changes its sign. At
//! an event the rates solve a complementarity problem: `Dᵢ` falls at the bound where the cable is pulled, rises at the bound where it is
//! released, or the hole sticks and the tension goes away from the bound.

use super::holes::Holes;
use super::law::{Iterate, Law};
use super::linear_problem::LinearProblem;
use super::modes::{Condition, Mode};
use super::pivoting::{Complementarity, Cover, Outcome, Pivoting};
use super::response::Response;
use super::trail::Trigger;
use crate::budget::Meter;
use crate::solution::SlipState;
use crate::statics::command::Command;

/// Of the tension by which a bound is met, and of what that shortens a cable by: rates that change nothing in a substep. Where a cable hardly moves,
/// neighbouring nodes on a curve would else change between sticking and sliding again and again.
const STILL: f64 = 0.1;
/// So many times what the linear response misses is a margin.
const SURE: f64 = 4.0;
/// Parts of a substep in which the response is that in their middle, at most.
const SLOTS: usize = 8;
/// By how much of the greatest tension the response at the start may miss the tensions at the end, where one part is enough. What the response in
/// the middle of the parts misses falls with the square of their number.
const RESOLVED: f64 = 1e-4;
/// Events of a substep, of the holes, at most.
const MOST_EVENTS: usize = 8;
/// Of a substep: a part so short is rounding.
const ROUNDED: f64 = 1e-12;

/// The robot at one end of a substep.
#[derive(Clone, Debug, Default)]
pub(super) struct Station {
    pub tensions: Vec<f64>,
    pub beyond: Vec<f64>,
    pub turns: Vec<f64>,
    pub slip_states: Vec<SlipState>,
    pub response: Response,
}

/// How the holes go through a substep.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    /// `Dᵢ` where each hole last came to rest, or began to slide.
    pub rest: Vec<f64>,
    /// Tension of every passage at the end.
    pub tensions: Vec<f64>,
    /// `Dᵢ` at the end.
    pub beyond: Vec<f64>,
    /// Number of events.
    pub count: usize,
    /// The fraction of the substep where no modes agree with their rates: no equilibrium goes on from there.
    pub limit_point: Option<f64>,
    /// Whether it is noted where holes come to rest, for derivatives.
    pub keeps_stops: bool,
    /// These places beyond the start, in order.
    pub stops: Vec<Stop>,
    /// The fraction of the substep that is behind, and what happens there.
    now: f64,
    trigger: Option<Trigger>,
    /// The modes before that.
    modes_before: Vec<Mode>,
    /// How near each hole comes to an event: the least distance of its tension from a bound where it sticks, and the least rate of
    /// its `Dᵢ` where it slides.
    margins: Vec<f64>,
    turns: Vec<f64>,
    modes: Vec<Mode>,
    commands: Vec<Command>,
    response: Response,
    /// Changes with the fraction of the substep.
    rates: Rates,
    /// The state from which the coefficients of the linear problem are taken.
    at: Coefficients,
    pub problem: LinearProblem,
    pivoting: Pivoting,
    /// The greatest tension or rate of a tension, in N.
    scale: f64,
}

/// Where holes come to rest within a substep.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stop {
    /// The fraction of the substep.
    pub at: f64,
    /// Their passages, and `Dᵢ` there.
    pub holes: Vec<(usize, f64)>,
    /// The modes of all holes before.
    pub modes: Vec<Mode>,
    /// What changes the rates of all holes there.
    pub trigger: Option<Trigger>,
}

#[derive(Clone, Debug, Default)]
struct Rates {
    commands: Vec<f64>,
    tensions: Vec<f64>,
    beyond: Vec<f64>,
    turns: Vec<f64>,
}

#[derive(Clone, Debug, Default)]
struct Coefficients {
    commands: Vec<Command>,
    tensions: Vec<f64>,
    turns: Vec<f64>,
}

/// Numbers that change at these rates, this part later.
fn go(numbers: &mut [f64], rates: &[f64], part: f64) {
    numbers.iter_mut().zip(rates).for_each(|(x, rate)| *x += part * rate);
}

fn move_commands(commands: &mut [Command], rates: &[f64], part: f64) {
    for (command, rate) in commands.iter_mut().zip(rates) {
        match command {
            Command::Tension(value) | Command::Length { target: value, .. } => {
                *value += part * rate;
            }
        }
    }
}

impl Events {
    /// From the start of a substep to its end, with the response that changes in proportion from that at the start to that at the end, where
    /// this is known, with how much the response at the start misses of the tensions there; `false` where the holes do not agree on a mode for
    /// each.
    pub fn follow(
        &mut self,
        law: &Law<'_>,
        from: &[Command],
        start: &Station,
        end: Option<(&Station, f64)>,
        meter: &Meter,
    ) -> bool {
        let missed = end.map_or(0.0, |(_, missed)| missed);
        let end = end.map(|(end, _)| end);
        self.start(law, from, start, end);
        (self.count, self.limit_point) = (0, None);
        let slots = ((missed / RESOLVED).sqrt() as usize).clamp(1, SLOTS).next_power_of_two();
        let mut most = MOST_EVENTS * law.holes.count() + 32;
        for slot in 0..slots {
            let at = |slot: f64| slot / slots as f64;
            let (mut now, to) = (at(slot as f64), at(slot as f64 + 1.0));
            (self.now, self.trigger) = (now, None);
            self.respond(law, start, end, 0.5 * (now + to));
            if !self.linearise(law, 0.5 * (to - now), end.is_some(), meter) {
                return false;
            }
            // Until an event changes the modes the rates stay those that were found last.
            let mut is_known = false;
            while now < to - ROUNDED {
                let outcome = self.choose(law, is_known, meter);
                is_known = true;
                self.problem.charge(meter);
                if outcome != Outcome::Agree || most == 0 || meter.has_ended() {
                    self.limit_point = (outcome == Outcome::Ray).then_some(now);
                    return false;
                }
                if now == 0.0 {
                    self.count = 0;
                }
                self.note_margins(law);
                let (until, trigger) = self.until_event(law);
                let part = until.min(to - now);
                self.advance(part);
                (now, most) = (now + part, most - 1);
                (self.now, self.trigger) = (now, trigger.filter(|_| until <= part));
            }
        }
        if end.is_some() {
            // What happens at the very end shows that the response changed too much.
            (self.now, self.trigger) = (1.0, None);
            self.respond(law, start, end, 1.0);
            if !self.linearise(law, 0.0, false, meter)
                || self.choose(law, false, meter) != Outcome::Agree
            {
                return false;
            }
            self.note_margins(law);
        }
        true
    }

    /// Takes the coefficients of the linear problem from the state as it will be this part of the substep later.
    fn linearise(&mut self, law: &Law<'_>, later: f64, moves: bool, meter: &Meter) -> bool {
        self.at.commands.clone_from(&self.commands);
        self.at.tensions.clone_from(&self.tensions);
        self.at.turns.clone_from(&self.turns);
        if moves {
            // The rates of the part before serve, where there is one.
            if self.now == 0.0 && self.choose(law, false, meter) != Outcome::Agree {
                return false;
            }
            go(&mut self.at.tensions, &self.rates.tensions, later);
            go(&mut self.at.turns, &self.rates.turns, later);
            move_commands(&mut self.at.commands, &self.rates.commands, later);
        }
        self.problem.renew();
        true
    }

    /// Whether what slides at the end slides in these directions.
    pub fn agrees_with(&self, slip_states: &[SlipState]) -> bool {
        self.modes.iter().zip(slip_states).all(|(mode, state)| match mode {
            Mode::Pulled => *state == SlipState::Pulled,
            Mode::Released => *state == SlipState::Released,
            Mode::Sticks => *state == SlipState::Sticks,
            Mode::Free | Mode::Held | Mode::Slack => true,
        })
    }

    fn start(&mut self, law: &Law<'_>, from: &[Command], start: &Station, end: Option<&Station>) {
        self.rest.clear();
        self.rest.extend_from_slice(law.before);
        self.stops.clear();
        self.now = 0.0;
        self.tensions.clone_from(&start.tensions);
        self.beyond.clone_from(&start.beyond);
        self.turns.clone_from(&start.turns);
        self.commands.clear();
        self.commands.extend_from_slice(from);
        let pairs = from.iter().zip(law.commands);
        self.rates.commands.clear();
        self.rates.commands.extend(pairs.map(|pair| match pair {
            (Command::Tension(before), Command::Tension(now)) => now - before,
            (Command::Length { target: before, .. }, Command::Length { target: now, .. }) => {
                now - before
            }
            _ => 0.0,
        }));
        self.margins.clear();
        self.margins.resize(law.holes.count(), f64::INFINITY);
        self.modes.clear();
        self.modes.resize(law.holes.count(), Mode::Free);
        for ((cable, place), p) in law.holes.all() {
            self.modes[p] = if place == 0 && from[cable].is_length() {
                Mode::Held
            } else if law.holes.coefficients[cable] == 0.0 {
                Mode::Free
            } else {
                // Cables that are slack at the start begin as they end.
                let known = if start.tensions[p] > 0.0 { start } else { end.unwrap_or(start) };
                match known.slip_states[p] {
                    SlipState::Pulled => Mode::Pulled,
                    SlipState::Released => Mode::Released,
                    SlipState::Sticks => Mode::Sticks,
                }
            };
        }
    }

    fn note_margins(&mut self, law: &Law<'_>) {
        for (hole, p) in law.holes.all() {
            let margin = match self.modes[p] {
                Mode::Sticks => {
                    let [below, above] = self.bounds(law, hole);
                    below.0.min(above.0)
                }
                Mode::Pulled | Mode::Released => self.rates.beyond[p].abs(),
                Mode::Free | Mode::Held | Mode::Slack => f64::INFINITY,
            };
            self.margins[p] = self.margins[p].min(margin);
        }
    }

    /// Whether no hole came to an event, and none would if the tensions and `Dᵢ` of all holes changed on the way by several times what they
    /// differ by from these at the end.
    pub fn is_sure(&self, holes: &Holes, tensions: &[f64], beyond: &[f64]) -> bool {
        let differs = |p: usize| (self.tensions[p] - tensions[p]).abs();
        self.count == 0
            && holes.all().all(|((cable, place), p)| {
                let passages = &holes.of_cable[cable];
                let difference = match self.modes[p] {
                    Mode::Sticks => {
                        differs(p)
                            + place.checked_sub(1).map_or(0.0, |before| differs(passages[before]))
                    }
                    _ => (self.beyond[p] - beyond[p]).abs(),
                };
                self.margins[p] > SURE * difference
            })
    }

    /// The response at a fraction of the substep.
    fn respond(&mut self, law: &Law<'_>, start: &Station, end: Option<&Station>, at: f64) {
        let Some(end) = end else {
            self.response.clone_from(&start.response);
            return self.problem.begin(law.holes, &self.response);
        };
        let between = |into: &mut Vec<f64>, from: &[f64], to: &[f64]| {
            into.clear();
            into.extend(from.iter().zip(to).map(|(from, to)| from + at * (to - from)));
        };
        between(&mut self.response.lengths, &start.response.lengths, &end.response.lengths);
        between(&mut self.response.turns, &start.response.turns, &end.response.turns);
        // The angle of a straight cable has no derivative; it is that of a little later.
        let wide = self.tensions.len() + 1;
        for (p, _) in start.turns.iter().enumerate().filter(|(_, turn)| **turn < 1e-8) {
            let row = p * wide..(p + 1) * wide;
            self.response.turns[row.clone()].copy_from_slice(&end.response.turns[row]);
        }
        self.problem.begin(law.holes, &self.response);
    }

    /// The modes that agree with their rates, and the rates. Those of the modes as they are may be known: the coefficients of the linear
    /// problem stay as they are from one event to the next.
    fn choose(&mut self, law: &Law<'_>, is_known: bool, meter: &Meter) -> Outcome {
        self.modes_before.clone_from(&self.modes);
        let mut pivoting = core::mem::take(&mut self.pivoting);
        let mut problem = RatesOfHoles { events: self, law, meter };
        let (outcome, changes) = pivoting.find(&mut problem, is_known, true);
        self.pivoting = pivoting;
        self.count += changes;
        for p in 0..self.modes.len() {
            // A hole that stops remembers where.
            if self.modes[p] == Mode::Sticks && self.modes_before[p] != Mode::Sticks {
                self.rest[p] = self.beyond[p];
                if self.keeps_stops && self.now > 0.0 {
                    self.note_stop(p);
                }
            }
        }
        outcome
    }

    /// The rates in the modes as they are.
    fn solve(&mut self, law: &Law<'_>, covers: Option<&[Cover]>) -> bool {
        let Self { at, beyond, rates, modes, response, problem, .. } = self;
        let here = Iterate { tensions: &at.tensions, beyond, turns: &at.turns };
        let now = Law { commands: &at.commands, ..*law };
        let Rates { commands, tensions, beyond, turns } = rates;
        if !problem.solve(&now, here, modes, response, Some(commands), tensions) {
            return false;
        }
        if let Some(covers) = covers
            && !problem.add_covers(covers, tensions)
        {
            return false;
        }
        turns.resize(tensions.len(), 0.0);
        beyond.resize(tensions.len(), 0.0);
        for (p, mode) in modes.iter().enumerate() {
            match mode {
                Mode::Sticks => {
                    turns[p] = response.turn(p, tensions);
                    beyond[p] = 0.0;
                }
                _ => beyond[p] = problem.beyond(p, tensions),
            }
        }
        if covers.is_none() {
            self.scale = self.greatest_tension();
        }
        true
    }

    /// Goes on at the rates.
    fn advance(&mut self, part: f64) {
        for (p, mode) in self.modes.iter().enumerate() {
            if *mode != Mode::Sticks {
                self.rates.turns[p] = self.response.turn(p, &self.rates.tensions);
            }
        }
        go(&mut self.tensions, &self.rates.tensions, part);
        go(&mut self.beyond, &self.rates.beyond, part);
        go(&mut self.turns, &self.rates.turns, part);
        move_commands(&mut self.commands, &self.rates.commands, part);
    }

    /// Distances of a hole from its lower and upper bound, and their rates.
    fn bounds(&self, law: &Law<'_>, (cable, place): (usize, usize)) -> [(f64, f64); 2] {
        let (rates, passages) = (&self.rates, &law.holes.of_cable[cable]);
        let p = passages[place];
        let (incoming, changes) = match place.checked_sub(1) {
            Some(before) => (self.tensions[passages[before]], rates.tensions[passages[before]]),
            None => match self.commands[cable] {
                Command::Tension(given) => (given, rates.commands[cable]),
                Command::Length { .. } => (0.0, 0.0),
            },
        };
        let coefficient = law.holes.coefficients[cable];
        let factor = (coefficient * self.turns[p].max(0.0)).exp();
        let turned = coefficient * rates.turns[p] * incoming;
        let (tension, rate) = (self.tensions[p], rates.tensions[p]);
        [
            (tension - incoming / factor, rate - (changes - turned) / factor),
            (factor * incoming - tension, factor * (changes + turned) - rate),
        ]
    }

    fn greatest_tension(&self) -> f64 {
        let commanded = self.rates.commands.iter().zip(&self.commands);
        let tensions = commanded.map(|(rate, command)| match command {
            Command::Tension(now) => now.abs().max(rate.abs()),
            Command::Length { .. } => 0.0,
        });
        let rates = self.rates.tensions.iter().map(|rate| rate.abs());
        tensions.chain(self.tensions.iter().copied()).chain(rates).fold(f64::MIN_POSITIVE, f64::max)
    }

    fn note_stop(&mut self, p: usize) {
        let Self { now, beyond, modes_before, trigger, stops, .. } = self;
        match stops.last_mut().filter(|last| last.at == *now) {
            Some(last) => last.holes.push((p, beyond[p])),
            None => stops.push(Stop {
                at: *now,
                holes: vec![(p, beyond[p])],
                modes: modes_before.clone(),
                trigger: *trigger,
            }),
        }
    }

    /// How much too long the cable is between its holes for the given length, and its rate.
    fn lack(&self, law: &Law<'_>, cable: usize) -> (f64, f64) {
        let Self { tensions, beyond, turns, rates, .. } = self;
        let now = Law { commands: &self.commands, ..*law };
        let rate = law.holes.at_drive(cable, &rates.beyond, &rates.tensions);
        (now.lack(cable, Iterate { tensions, beyond, turns }), rate - rates.commands[cable])
    }

    /// The part of the substep to the next event at these rates, and the event.
    fn until_event(&self, law: &Law<'_>) -> (f64, Option<Trigger>) {
        let rates = &self.rates;
        let (mut least, mut next) = (f64::INFINITY, None);
        let mut meets = |(distance, rate): (f64, f64), event: Trigger| {
            if rate < 0.0 {
                let part = distance.max(0.0) / -rate;
                if part < least {
                    (least, next) = (part, Some(event));
                }
            }
        };
        let tension = self.greatest_tension();
        let still = STILL * law.holes.met * tension;
        for ((cable, place), p) in law.holes.all() {
            match self.modes[p] {
                Mode::Sticks => {
                    let bounds = self.bounds(law, (cable, place));
                    for (bound, sign) in bounds.into_iter().zip([-1.0, 1.0]) {
                        if bound.1 < -still {
                            meets(bound, Trigger::Slides { cable, place, sign });
                        }
                    }
                }
                Mode::Held if rates.tensions[p] < -still => {
                    meets((self.tensions[p], rates.tensions[p]), Trigger::Slack { cable });
                }
                Mode::Slack => {
                    let (lack, rate) = self.lack(law, cable);
                    if rate > still * law.holes.compliance {
                        meets((-lack, -rate), Trigger::Taut { cable });
                    }
                }
                _ => {}
            }
        }
        (least, next)
    }
}

/// The rates of all holes at an event, whose modes are to agree with them.
struct RatesOfHoles<'a> {
    events: &'a mut Events,
    law: &'a Law<'a>,
    meter: &'a Meter,
}

impl Complementarity for RatesOfHoles<'_> {
    fn modes(&self) -> &[Mode] {
        &self.events.modes
    }

    fn set_mode(&mut self, p: usize, mode: Mode) {
        self.events.modes[p] = mode;
    }

    fn solve(&mut self, covers: Option<&[Cover]>) -> bool {
        self.events.solve(self.law, covers)
    }

    fn conditions(&self, hole: (usize, usize), p: usize) -> [Option<Condition>; 2] {
        let Self { events, law, .. } = self;
        let kappa = law.holes.compliance;
        let met = law.holes.met * events.scale;
        let part = STILL * law.holes.met;
        let still = part * kappa * events.scale;
        let resting = still.min(part * law.holes.length);
        let sliding = events.rates.beyond[p];
        let holds =
            |value: f64, rounding: f64, next: Mode| Some(Condition { value, rounding, next });
        match events.modes[p] {
            Mode::Free => [None; 2],
            Mode::Pulled => [holds(-sliding, resting, Mode::Sticks), None],
            Mode::Released => [holds(sliding, resting, Mode::Sticks), None],
            Mode::Held if events.tensions[p] > met => [None; 2],
            Mode::Held => [holds(kappa * events.rates.tensions[p], still, Mode::Slack), None],
            Mode::Slack => match events.lack(law, hole.0) {
                (lack, _) if lack < -resting => [None; 2],
                (_, rate) => [holds(-rate, resting, Mode::Held), None],
            },
            Mode::Sticks => {
                let [below, above] = events.bounds(law, hole);
                let at = |bound: (f64, f64), next: Mode| match bound.0 <= met {
                    true => holds(kappa * bound.1, still, next),
                    false => None,
                };
                [at(below, Mode::Pulled), at(above, Mode::Released)]
            }
        }
    }

    fn holes(&self) -> &Holes {
        self.law.holes
    }

    fn unit(&self) -> f64 {
        self.law.holes.compliance * self.events.scale
    }

    fn has_ended(&mut self) -> bool {
        self.events.problem.charge(self.meter);
        self.meter.has_ended()
    }
}
