//! A record of the iterations, for who asks for it.

use super::lengths::Note;
use super::model::{Cosserat, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::shape::Solution;

/// Where in a solve an iteration belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stage {
    /// Finding the tensions that given cable lengths take, eq. (6) of the theory.
    Lengths,
    /// All of the load at once from the rod without load.
    #[default]
    Cold,
    /// All of the load at once from a neighbouring answer, or from that on a coarser grid.
    Warm,
    /// Raising the load by multiple shooting.
    LoadSteps,
    /// Following the equilibrium path by its arc length.
    ArcLength,
}

/// One iteration of Newton's method: on equilibrium under load, or on the tensions that given lengths take.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceEvent {
    /// Where it belongs.
    pub stage: Stage,
    /// Integration steps of the grid from base to tip.
    pub steps: usize,
    /// Fraction of the given load; 0 for the robot without load.
    pub load: f64,
    /// Number of the iteration, from 1 on at each start.
    pub iteration: usize,
    /// What is left of the equations, relative to their scale.
    pub residual: f64,
    /// Fraction of Newton's step that was taken, from 0 to 1.
    pub step: f64,
    /// Tension of each cable in N, in the order of the robot's cables.
    pub tensions: Vec<f64>,
}

/// The record; empty and without cost unless it is on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trace {
    pub is_on: bool,
    pub stage: Stage,
    pub steps: usize,
    /// With tensions in the order of the grid.
    pub events: Vec<TraceEvent>,
}

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

impl Stage {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lengths => "lengths",
            Self::Cold => "cold",
            Self::Warm => "warm",
            Self::LoadSteps => "load steps",
            Self::ArcLength => "arc length",
        }
    }
}

impl Trace {
    /// Of the search for the tensions that given lengths take.
    pub fn of_lengths(&mut self, load: f64, note: &Note, tensions: &[f64]) {
        let stage = core::mem::replace(&mut self.stage, Stage::Lengths);
        self.iteration(note.iteration, load, note.residual, note.step, tensions);
        self.stage = stage;
    }

    #[inline]
    pub fn iteration(
        &mut self,
        iteration: usize,
        load: f64,
        residual: f64,
        step: f64,
        tensions: &[f64],
    ) {
        if self.is_on {
            let (stage, steps, tensions) = (self.stage, self.steps, tensions.to_vec());
            self.events.push(TraceEvent {
                stage,
                steps,
                load,
                iteration,
                residual,
                step,
                tensions,
            });
        }
    }
}
