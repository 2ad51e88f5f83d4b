//! A motion from its start to its end.

use whipcord::ModelKind;

use crate::commands::Commands;
use crate::error::MotionError;
use crate::simulation::Simulation;
use crate::state::State;

/// The states of a motion at equal intervals of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// The model: how cables run.
    pub model: ModelKind,
    /// Arc length of each node in m.
    pub arc_lengths: Vec<f64>,
    /// The state at the start, then one behind each interval.
    pub states: Vec<State>,
    /// Iterations of all steps.
    pub iterations: usize,
    /// Parts into which all steps together were divided; as many as there were steps where none had to be.
    pub parts: usize,
    /// Parts of these in which contacts slid without friction, since the part had no answer with it.
    pub frictionless_parts: usize,
    /// Steps that were asked for.
    pub steps: usize,
    /// The greatest error in m of a step, as estimated; zero where no tolerance is given.
    pub greatest_error: f64,
}

impl Simulation {
    /// Goes on under commands for `count` intervals of `every` seconds, each in `steps` steps, and keeps the state behind each interval.
    ///
    /// # Errors
    /// [`MotionError`] of the first step that fails.
    pub fn run(
        &mut self,
        commands: &Commands,
        every: f64,
        steps: usize,
        count: usize,
    ) -> Result<Trajectory, MotionError> {
        let mut trajectory = Trajectory::default();
        self.run_into(&mut trajectory, commands, every, (steps, count), &mut |_| true)?;
        Ok(trajectory)
    }

    /// The same into a trajectory, which after an error holds the states before it. `steps` are those of each interval and the number of the intervals;
    /// `goes_on` gets each state behind an interval and ends the motion where it says no.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_into(
        &mut self,
        trajectory: &mut Trajectory,
        commands: &Commands,
        every: f64,
        (steps, count): (usize, usize),
        goes_on: &mut dyn FnMut(&State) -> bool,
    ) -> Result<(), MotionError> {
        *trajectory = Trajectory {
            model: self.options().model,
            arc_lengths: self.arc_lengths().collect(),
            states: vec![self.state().clone()],
            ..Trajectory::default()
        };
        let (start, steps) = (self.state().time, steps.max(1));
        for row in 0..count {
            for k in 1..=steps {
                // From the start, so that rounding does not add up.
                let end = start + every * (row as f64 + k as f64 / steps as f64);
                let dt = end - self.state().time;
                let diagnostics = self.step(commands, dt)?.diagnostics;
                trajectory.iterations += diagnostics.iterations;
                trajectory.parts += diagnostics.parts;
                trajectory.frictionless_parts += diagnostics.frictionless_parts;
                trajectory.steps += 1;
                trajectory.greatest_error = trajectory.greatest_error.max(diagnostics.error);
            }
            trajectory.states.push(self.state().clone());
            if !goes_on(self.state()) {
                break;
            }
        }
        Ok(())
    }
}
