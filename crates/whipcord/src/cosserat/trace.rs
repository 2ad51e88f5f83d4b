//! Solves with a record of the iterations.

use super::prepared::{Cosserat, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::solution::Solution;
use crate::statics::trace::TraceEvent;

impl Cosserat {
    /// [`Cosserat::solve`], with a record of the iterations, whether they lead to an answer or not. Without
    /// load, and with the tensions given, every section stands for itself and there is nothing to record.
    pub fn solve_traced(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> (Result<Solution, SolveError>, Vec<TraceEvent>) {
        let trace = &mut workspace.scratch.trace;
        trace.is_on = true;
        trace.events.clear();
        let outcome = self.solve(case, warm_start, workspace);
        let trace = &mut workspace.scratch.trace;
        trace.is_on = false;
        let mut events = core::mem::take(&mut trace.events);
        let mut tensions = Vec::new();
        for event in &mut events {
            // From the order of the grid to that of the robot.
            tensions.clone_from(&event.tensions);
            for (place, &cable) in self.layout.order.iter().enumerate() {
                if let (Some(slot), Some(&tension)) =
                    (event.tensions.get_mut(cable), tensions.get(place))
                {
                    *slot = tension;
                }
            }
        }
        (outcome, events)
    }
}
