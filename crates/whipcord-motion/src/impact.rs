//! Parts of a step among obstacles: free where nothing is hit, in short parts behind an impact.

use crate::commands::Commands;
use crate::iteration::Stalled;
use crate::options::Method;
use crate::simulation::Simulation;

/// Lengths of the parts without rates behind an impact, as parts of the step: the first ends the motion into the obstacle, the second its rates; the
/// others grow, since rates in a short part are those of waves that a longer one cannot follow.
pub(crate) const PARTS: [f64; 5] = [0.02, 0.02, 0.06, 0.15, 0.35];
/// Impacts of one step whose times are looked for; the time of others is that of the end of their part.
const LOCATED: usize = 6;
/// A gap that closes from less than this part of the length is no impact.
const GRAZING: f64 = 1e-4;

impl Simulation {
    /// Takes a part of a step among obstacles, or the part up to an impact. Returns its estimated error in m and its length in s.
    pub(crate) fn attempt_among_obstacles(
        &mut self,
        commands: &Commands,
        method: Method,
        h: f64,
        warm: bool,
    ) -> Result<(f64, f64), Stalled> {
        self.solver.contacts.clear();
        if self.state.contacts.is_empty() && self.state.impact_parts == 0 {
            let error = self.attempt_by(commands, method, h, warm, false)?;
            let Self { rod, solver, state, next, .. } = self;
            let from = (state.base, state.strains.as_slice());
            let to = (next.base, next.strains.as_slice());
            let Some(part) = solver.contacts.first_hit(rod, from, to) else {
                return Ok((error, h));
            };
            return self.take_to_impact(commands, part, h, warm);
        }
        let error = self.attempt_by(commands, Method::Robust, h, warm, true)?;
        match self.first_new_contact(h) {
            Some(part) if self.state.impact_parts == 0 => {
                self.take_to_impact(commands, part, h, warm)
            }
            _ => Ok((error, h)),
        }
    }

    /// Takes a step to where an obstacle is hit, at a part of its length.
    fn take_to_impact(
        &mut self,
        commands: &Commands,
        part: f64,
        h: f64,
        warm: bool,
    ) -> Result<(f64, f64), Stalled> {
        let is_located = self.state.impacts < LOCATED;
        let taken = if is_located { h * part.max(PARTS[0]) } else { h };
        self.next.copy_from(&self.state);
        self.next.diagnostics.method = Method::Robust;
        let touched = core::mem::replace(&mut self.state.impact_parts, PARTS.len());
        let outcome = self.attempt_one_stage(commands, Method::Robust, taken, warm, false, true);
        self.state.impact_parts = touched;
        let error = outcome?;
        self.next.impacts = self.state.impacts + 1;
        self.next.impact_parts = PARTS.len();
        self.next.has_rates = false;
        Ok((error, taken))
    }

    /// Where in a step of length `h` the first contact closed that was open at its start.
    fn first_new_contact(&self, h: f64) -> Option<f64> {
        let Self { rod, solver, state, .. } = self;
        let new = solver
            .contacts
            .list
            .iter()
            .filter(|contact| contact.force > 0.0 && contact.start_gap > GRAZING * rod.length);
        new.filter_map(|contact| {
            let closing = -contact.start_rate(&state.velocities);
            (closing * h > contact.start_gap).then(|| contact.start_gap / (closing * h))
        })
        .min_by(f64::total_cmp)
    }
}
