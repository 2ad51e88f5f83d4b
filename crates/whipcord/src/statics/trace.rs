//! A record of the iterations, for who asks for it.

use super::lengths::Note;

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
