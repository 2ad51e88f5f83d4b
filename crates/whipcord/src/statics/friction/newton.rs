//! Newton's method for the shape and the tensions of all passages together.
//!
//! The unknowns are those of the shape and one tension for each passage; the equations beside those of the equilibrium
//! are those of [`super::law`], one for each hole. They are piecewise smooth: an iteration takes each hole to stick or to
//! slide as eq. (2) has it at the iterate, and linearises what follows with the lengths beyond the hole and with
//! the angle by which the cable turns in it. The linearised problem is a complementarity problem: its holes change from one
//! case to another until all of them agree with the step (the method of Josephy and Newton).

use super::events::{Events, Station};
use super::holes::Holes;
use super::law::{Iterate, Law};
use super::linear_problem::LinearProblem;
use super::modes::{Condition, Mode};
use super::pivoting::{Complementarity, Cover, Outcome, Pivoting};
use super::response::{PassageResponse, Passages, Response};
use crate::budget::Meter;
use crate::solution::SlipState;
use crate::statics::lengths::Effort;
use crate::statics::outcome::Open;

const MAX_ITERATIONS: usize = 30;
/// A step that gains nothing is shortened to no less than this.
const LEAST_FRACTION: f64 = 1.0 / 64.0;
/// No step may leave more than so many times the least that the last iterations left.
const MOST_GROWTH: f64 = 3.0;
/// What rounding may leave where nothing improves any more: where full steps gain nothing, and where no step does.
const ROUNDING: [f64; 2] = [1e-9, 1e-8];
/// Of the length: what the equations of the holes may leave, so that a hole that is about to slide is known as one.
const TOLERANCE: f64 = 1e-12;
/// What the equilibrium of the shape may leave for that.
const CLOSED: f64 = 1e-11;
/// Of the length: what rounding makes of a violated case.
const VIOLATED: f64 = 1e-13;

/// The state of the holes at an iterate, and memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrictionScratch {
    /// Tension of every passage in N.
    pub tensions: Vec<f64>,
    pub at: Passages,
    /// `Dᵢ` by passage in m.
    pub beyond: Vec<f64>,
    pub slip_states: Vec<SlipState>,
    /// Ends of a substep, and what happens in between.
    pub(super) start: Station,
    pub(super) end: Station,
    pub(super) events: Events,
    kept: Vec<f64>,
    pub(super) modes: Vec<Mode>,
    /// After the linear step.
    after: [Vec<f64>; 3],
    pub(super) response: Response,
    pub(super) changes: Vec<f64>,
    pub(super) problem: LinearProblem,
    pivoting: Pivoting,
    /// Whether the linear problem of an iteration had no cases that agree with it.
    has_disagreed: bool,
    /// Whether an equilibrium is looked for that is not near, on the way to which an iteration may lead where none goes on.
    pub(super) is_leap: bool,
}

impl FrictionScratch {
    /// The iteration from the shape as it stands and from [`Self::tensions`].
    pub(super) fn converge<M: PassageResponse>(
        &mut self,
        model: &mut M,
        law: &Law<'_>,
    ) -> Result<Effort, Open> {
        let failed = |iterations, gap, fault| Open { iterations, gap, fault };
        let (mut gap, mut left) =
            self.measure(model, law).map_err(|fault| failed(0, f64::INFINITY, Some(fault)))?;
        let closed = model.tolerance().min(CLOSED);
        let mut recent = [f64::INFINITY; 3];
        self.has_disagreed = false;
        'newton: for iteration in 1..=MAX_ITERATIONS {
            if model.meter().has_ended() {
                break;
            }
            if gap <= closed && left <= TOLERANCE {
                return Ok(Effort { iterations: iteration - 1, residual: gap.max(left) });
            }
            let before = gap.max(left);
            let most = self.direct(model, law);
            let Some(most) = most else {
                if before <= ROUNDING[1] {
                    break;
                }
                return Err(failed(iteration, before, None));
            };
            model.meter().iterate();
            self.problem.charge(model.meter());
            self.kept.clone_from(&self.tensions);
            recent.rotate_right(1);
            recent[0] = before;
            let bound = MOST_GROWTH * recent.iter().copied().fold(f64::INFINITY, f64::min);
            let mut fraction = most;
            loop {
                model.go(fraction);
                let pairs = self.kept.iter().zip(&self.changes);
                self.tensions.clear();
                self.tensions.extend(pairs.map(|(kept, d)| (kept + fraction * d).max(0.0)));
                let measured = self.measure(model, law);
                if let Ok((now_gap, now_left)) = measured {
                    let now = now_gap.max(now_left);
                    if fraction == 1.0 && now.max(before) <= ROUNDING[0] && now >= 0.5 * before {
                        return Ok(Effort { iterations: iteration, residual: now });
                    }
                    if now <= bound.min(1e3) || (fraction <= LEAST_FRACTION && now.is_finite()) {
                        (gap, left) = (now_gap, now_left);
                        model.note(iteration, now, fraction, &self.tensions);
                        break;
                    }
                }
                fraction *= 0.5;
                if fraction < LEAST_FRACTION {
                    if before <= ROUNDING[1] {
                        // Nothing is better than where the step began.
                        model.go(0.0);
                        self.tensions.clone_from(&self.kept);
                        let measured = self.measure(model, law);
                        (gap, left) = measured.unwrap_or((f64::INFINITY, f64::INFINITY));
                        break 'newton;
                    }
                    return Err(failed(iteration, before, measured.err()));
                }
            }
        }
        let residual = gap.max(left);
        if residual <= ROUNDING[1] && !model.meter().has_ended() {
            return Ok(Effort { iterations: MAX_ITERATIONS, residual });
        }
        Err(failed(MAX_ITERATIONS, residual, None))
    }

    /// What is left of the equilibrium, and of the equations of the holes as a fraction of the length.
    fn measure<M: PassageResponse>(
        &mut self,
        model: &mut M,
        law: &Law<'_>,
    ) -> Result<(f64, f64), crate::section::Fault> {
        let gap = model.measure(&self.tensions, &mut self.at)?;
        Ok((gap, self.assess(law)))
    }

    /// What is left of the equations of the holes at the lengths and angles as they are, as a fraction of the length.
    pub(super) fn assess(&mut self, law: &Law<'_>) -> f64 {
        let Self { tensions, at, beyond, slip_states, modes, .. } = self;
        law.holes.beyond_into(&at.lengths, tensions, beyond);
        slip_states.resize(tensions.len(), SlipState::Sticks);
        modes.resize(tensions.len(), Mode::Free);
        let here = Iterate { tensions, beyond, turns: &at.turns };
        let mut greatest: f64 = 0.0;
        for (hole, p) in law.holes.all() {
            modes[p] = law.mode(hole, here);
            slip_states[p] = modes[p].slip_state(law.before[p] - beyond[p]);
            let left = law.row(hole, modes[p], here).1.abs() / law.holes.length;
            // A NaN must not pass for an equation that is met.
            greatest = if left.is_finite() { greatest.max(left) } else { f64::INFINITY };
        }
        greatest
    }

    /// The linear step of shape and tensions from where they were measured last, and how much of it may be taken; `None`
    /// where there is none.
    fn direct<M: PassageResponse>(&mut self, model: &mut M, law: &Law<'_>) -> Option<f64> {
        if !model.respond(&self.tensions, &mut self.response) {
            return None;
        }
        self.has_disagreed |= self.solve(law, Some(model.meter()))? != Outcome::Agree;
        if self.has_disagreed && !self.is_leap {
            return None;
        }
        model.prepare(&self.changes)
    }

    /// The linear step of the tensions by the response as it is, in cases that agree with it, if there are any; `None` where there is none.
    pub(super) fn solve(&mut self, law: &Law<'_>, meter: Option<&Meter>) -> Option<Outcome> {
        self.problem.begin(law.holes, &self.response);
        let mut pivoting = core::mem::take(&mut self.pivoting);
        let rounding = VIOLATED * law.holes.length;
        let mut step = LinearStep { scratch: self, law, meter, rounding };
        // A path that was followed in vain is not followed again.
        let follows = !step.scratch.has_disagreed;
        let (outcome, _) = pivoting.find(&mut step, false, follows);
        self.pivoting = pivoting;
        (outcome != Outcome::Singular).then_some(outcome)
    }

    /// The state that was found last as an end of a substep; `false` where the shape has no response there.
    pub(super) fn station<M: PassageResponse>(
        &mut self,
        model: &mut M,
        into: &mut Station,
    ) -> bool {
        if !model.respond(&self.tensions, &mut self.response) {
            return false;
        }
        into.tensions.clone_from(&self.tensions);
        into.beyond.clone_from(&self.beyond);
        into.turns.clone_from(&self.at.turns);
        into.slip_states.clone_from(&self.slip_states);
        into.response.lengths.clone_from(&self.response.lengths);
        into.response.turns.clone_from(&self.response.turns);
        true
    }
}

/// The linear step from an iterate, whose cases are to agree with it.
struct LinearStep<'a> {
    scratch: &'a mut FrictionScratch,
    law: &'a Law<'a>,
    meter: Option<&'a Meter>,
    rounding: f64,
}

impl Complementarity for LinearStep<'_> {
    fn modes(&self) -> &[Mode] {
        &self.scratch.modes
    }

    fn set_mode(&mut self, p: usize, mode: Mode) {
        self.scratch.modes[p] = mode;
    }

    fn solve(&mut self, covers: Option<&[Cover]>) -> bool {
        let FrictionScratch {
            tensions, at, beyond, modes, response, changes, problem, after, ..
        } = &mut *self.scratch;
        let here = Iterate { tensions, beyond, turns: &at.turns };
        if !problem.solve(self.law, here, modes, response, None, changes) {
            return false;
        }
        if let Some(covers) = covers
            && !problem.add_covers(covers, changes)
        {
            return false;
        }
        let n = tensions.len();
        let [new_tensions, new_beyond, new_turns] = after;
        new_tensions.clear();
        new_tensions.extend(tensions.iter().zip(&*changes).map(|(now, change)| now + change));
        // Of each hole what its case looks at.
        new_beyond.clone_from(beyond);
        new_turns.clone_from(&at.turns);
        for (p, mode) in modes.iter().enumerate() {
            match mode {
                Mode::Free => {}
                Mode::Sticks => {
                    let closing = response.turns[p * (n + 1) + n];
                    new_turns[p] += closing + response.turn(p, changes);
                }
                Mode::Slack | Mode::Held | Mode::Pulled | Mode::Released => {
                    new_beyond[p] += problem.beyond(p, changes) + problem.beyond_closing(p, n);
                }
            }
        }
        true
    }

    fn conditions(&self, hole: (usize, usize), p: usize) -> [Option<Condition>; 2] {
        let FrictionScratch { tensions, at, beyond, modes, after, .. } = &*self.scratch;
        let [new_tensions, new_beyond, new_turns] = after;
        let now = Iterate { tensions, beyond, turns: &at.turns };
        let then = Iterate { tensions: new_tensions, beyond: new_beyond, turns: new_turns };
        self.law.conditions(hole, modes[p], now, then, self.rounding)
    }

    fn holes(&self) -> &Holes {
        self.law.holes
    }

    fn unit(&self) -> f64 {
        let greatest = self.scratch.tensions.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        (self.law.holes.compliance * greatest).max(1e-6 * self.law.holes.length)
    }

    fn has_ended(&mut self) -> bool {
        self.meter.is_some_and(|meter| {
            self.scratch.problem.charge(meter);
            meter.has_ended()
        })
    }
}
