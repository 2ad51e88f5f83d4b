//! Parts of a step among obstacles: free where nothing is hit, in short parts behind an impact.

use whipcord_numerics::{Pose, golden_section};

use crate::commands::Commands;
use crate::contact::Contact;
use crate::cross_section::Station;
use crate::iteration::Stalled;
use crate::options::Method;
use crate::part::{Impact, ImpactEnd};
use crate::simulation::Simulation;
use crate::state::State;
use crate::surroundings::Hit;

/// Lengths of the parts without rates behind an impact, as parts of the step: the first ends the motion into the obstacle, the second its rates; the
/// others grow, since rates in a short part are those of waves that a longer one cannot follow.
pub(crate) const PARTS: [f64; 5] = [0.02, 0.02, 0.06, 0.15, 0.35];
/// Impacts of one step whose times are looked for; the time of others is that of the end of their part.
const LOCATED: usize = 6;
/// A gap that closes from less than this part of the length is no impact.
const GRAZING: f64 = 1e-4;

/// Whether a part from a state goes by the equations with contacts.
pub(crate) fn touches(from: &State) -> bool {
    !from.contacts.is_empty() || from.impact_parts > 0
}

impl Simulation {
    /// Takes a part of a step among obstacles, or the part up to an impact. Returns its estimated error in m, its length in s and the impact.
    pub(crate) fn attempt_among_obstacles(
        &mut self,
        commands: &Commands,
        method: Method,
        h: f64,
        warm: bool,
    ) -> Result<(f64, f64, Option<Impact>), Stalled> {
        self.solver.contacts.clear();
        let (error, end) = if touches(&self.state) {
            let error = self.attempt_by(commands, Method::Robust, h, warm, true)?;
            (error, self.first_new_contact(h))
        } else {
            let error = self.attempt_by(commands, method, h, warm, false)?;
            (error, self.first_hit().map(|hit| (hit.part, ImpactEnd::Hit(hit))))
        };
        let Some((part, end)) = end else { return Ok((error, h, None)) };
        let is_located = self.state.impacts < LOCATED;
        let (part, end) = if !is_located {
            (1.0, ImpactEnd::Fraction(1.0))
        } else if part <= PARTS[0] {
            (PARTS[0], ImpactEnd::Fraction(PARTS[0]))
        } else {
            (part, end)
        };
        let impact = Impact { tried: h, end };
        let error = self.take_to_impact(commands, &impact, h * part, warm)?;
        Ok((error, h * part, Some(impact)))
    }

    /// Where the robot hits an obstacle first in the free part that was taken last.
    pub(crate) fn first_hit(&mut self) -> Option<Hit> {
        let Self { rod, solver, state, next, .. } = self;
        let from = (state.base, state.strains.as_slice());
        let to = (next.base, next.strains.as_slice());
        solver.contacts.first_hit(rod, from, to)
    }

    /// Takes the part of this length that ends where an obstacle is hit; its estimated error in m.
    pub(crate) fn take_to_impact(
        &mut self,
        commands: &Commands,
        impact: &Impact,
        h: f64,
        warm: bool,
    ) -> Result<f64, Stalled> {
        self.next.copy_from(&self.state);
        self.next.diagnostics.method = Method::Robust;
        let touched = core::mem::replace(&mut self.state.impact_parts, PARTS.len());
        let outcome = self.attempt_one_stage(commands, Method::Robust, h, warm, false, true);
        self.state.impact_parts = touched;
        let error = outcome?;
        self.next.impacts = self.state.impacts + 1;
        self.next.impact_parts = PARTS.len();
        self.next.has_rates = false;
        // Of two that hit at once the other one may be the first.
        if matches!(&impact.end, ImpactEnd::Hit(hit) if !hit.is_alone) {
            self.next.changes += 1;
        }
        Ok(error)
    }

    /// The first contact that closed in a step of length `h` though it was open at its start, and the part of the step up to there.
    fn first_new_contact(&self, h: f64) -> Option<(f64, ImpactEnd)> {
        let Self { rod, solver, state, .. } = self;
        if state.impact_parts > 0 {
            return None;
        }
        let new = solver
            .contacts
            .list
            .iter()
            .filter(|contact| contact.force > 0.0 && contact.start_gap > GRAZING * rod.length);
        let closing = new.filter_map(|contact| {
            let time = self.closes_in(state, contact, contact.station, contact.start)?;
            (time < h).then_some((time, contact))
        });
        let (time, contact) = closing.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (time, contact) = self.soonest_to_close(state, contact, time);
        Some((time / h, ImpactEnd::Closing(Box::new(contact))))
    }

    /// The time in which a contact closes if its gap goes on to close as fast as it does in a state; `None` where it does not close.
    pub(crate) fn closes_in(
        &self,
        state: &State,
        contact: &Contact,
        station: Station,
        start: Pose,
    ) -> Option<f64> {
        let surroundings = self.solver.contacts.surroundings.as_ref()?;
        let mut contact = Contact { start, station, shapes: station.shapes(), ..*contact };
        contact.look(&surroundings.obstacles[contact.obstacle], &start);
        let rate = -contact.start_rate(&state.velocities);
        (rate > 0.0).then(|| contact.nearest.gap / rate)
    }

    /// The same contact at the place of the backbone that gets there first, so that no other way of looking for the place counts.
    fn soonest_to_close(&self, state: &State, contact: &Contact, time: f64) -> (f64, Contact) {
        /// The time is least there, so that the place need not be known as well as the time.
        const SECTIONS: usize = 26;
        /// Intervals along the rod in which the place is looked for.
        const INTERVALS: usize = 12;
        let fixed = Contact { search: None, ..*contact };
        if contact.search.is_none() {
            return (time, fixed);
        }
        let rod = &self.rod;
        let soonest = self.by_shape(state, |shape| {
            let mut middle = contact.station.arc_length(rod);
            let half = 0.25 * rod.lengths[contact.station.element];
            let place = |x: f64, middle: f64| {
                let s = (middle + (2.0 * x - 1.0) * half).clamp(0.0, rod.length);
                let station = Station::at(rod, s);
                (s, station, shape.at(station))
            };
            for _ in 0..INTERVALS {
                let time = |x: f64| {
                    let (_, station, start) = place(x, middle);
                    self.closes_in(state, contact, station, start).unwrap_or(f64::INFINITY)
                };
                let (x, time) = golden_section(SECTIONS, time);
                let (s, station, start) = place(x, middle);
                let is_end = s <= 1e-6 * rod.length || s >= (1.0 - 1e-6) * rod.length;
                if is_end || (0.05..0.95).contains(&x) {
                    return Some((time, station, start));
                }
                middle = s;
            }
            None
        });
        let Some((sooner, station, start)) = soonest.filter(|(sooner, ..)| *sooner < time) else {
            return (time, fixed);
        };
        (sooner, Contact { station, start, shapes: station.shapes(), ..fixed })
    }
}
