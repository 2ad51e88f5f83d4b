//! The rod on a grid as an equilibrium path.

use whipcord_numerics::Vec3;

use super::chain::{Chain, Task};
use super::problem::Problem;
use super::scratch::Scratch;
use super::state::{Direction, Node, State, weight};
use crate::statics::command::Command;
use crate::statics::elimination::Change;
use crate::statics::path::{EquilibriumPath, Step};
use crate::statics::scales::Scales;
use crate::statics::trace::Stage;

/// The chain of a problem whose loads are gathered.
pub(super) struct RodPath<'a> {
    problem: &'a Problem<'a>,
    commands: Vec<Command>,
    scratch: &'a mut Scratch,
}

impl<'a> RodPath<'a> {
    pub fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        scratch.trace.stage = Stage::ArcLength;
        Self { problem, commands: problem.commands.to_vec(), scratch }
    }

    /// One shot of every step.
    fn shoot(&mut self) -> Option<f64> {
        let Self { problem, commands, scratch } = self;
        let Scratch { chain, trajectory, applied, .. } = &mut **scratch;
        chain.shoot(&Task { commands, ..Task::of(problem, applied) }, trajectory).ok()
    }
}

impl EquilibriumPath for RodPath<'_> {
    type Part = Node;

    fn commands(&self) -> &[Command] {
        &self.commands
    }

    fn set_commands(&mut self, commands: &[Command]) {
        self.commands.clear();
        self.commands.extend_from_slice(commands);
    }

    fn has_ended(&self) -> bool {
        self.problem.meter.has_ended()
    }

    fn weight(&self, k: usize) -> f64 {
        weight(self.problem.grid, k)
    }

    fn scales(&self) -> Scales {
        Scales::of(self.problem.grid, self.problem.length)
    }

    fn state(&self) -> State {
        self.scratch.chain.state.clone()
    }

    fn set_state(&mut self, state: State) {
        let Scratch { chain, trajectory, unloaded, .. } = &mut *self.scratch;
        chain.state = state;
        trajectory.seed(self.problem.grid, &unloaded.strains);
    }

    fn converge(&mut self, across: Option<&Direction>, residual: f64) -> Option<usize> {
        let Self { problem, commands, scratch } = self;
        let Scratch { chain, trajectory, applied, trace, .. } = &mut **scratch;
        let tolerance = problem.tolerance.max(residual);
        let task = Task { commands, tolerance, ..Task::of(problem, applied) };
        let (iterations, _) = Chain::newton(chain, &task, across, trajectory, trace).ok()?;
        Some(iterations)
    }

    fn direction(&mut self, step: Step<'_, Change>) -> Option<Direction> {
        let Self { problem, commands, scratch } = self;
        let Scratch { chain, trajectory, applied, .. } = &mut **scratch;
        chain.direction(&Task { commands, ..Task::of(problem, applied) }, step, trajectory)
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        let Self { problem, commands, scratch } = self;
        let Scratch { chain, trajectory, applied, stability, .. } = &mut **scratch;
        if applied.any_follower() {
            let task = Task { commands, ..Task::of(problem, applied) };
            return chain.is_determinant_negative(&task, trajectory).map(usize::from);
        }
        let State { tensions, load, .. } = &chain.state;
        let (samples, lengths) = (&trajectory.samples, &trajectory.lengths);
        let at = problem.equilibrium(samples, tensions, lengths, applied, *load);
        Some(stability.unstable_directions(&at))
    }

    fn lengths(&mut self) -> Option<&[f64]> {
        self.shoot()?;
        Some(&self.scratch.trajectory.lengths)
    }

    fn tip(&mut self) -> Vec3 {
        // Where a step folds, the poses are those of the last equilibrium.
        if self.shoot().is_some() {
            self.scratch.chain.poses(&mut self.scratch.poses);
        }
        self.scratch.poses.last().map_or(Vec3::ZERO, |pose| pose.position)
    }
}
