//! The chain on a mesh as an equilibrium path.

use whipcord_numerics::{Pose, Vec3};

use super::chain::{Chain, Direction, Node, NodeStep, State, Task};
use super::load_continuation::finish;
use super::stability_check;
use super::statics::{Problem, Scratch};
use crate::statics::command::Command;
use crate::statics::lengths::Effort;
use crate::statics::outcome::{Found, Open};
use crate::statics::path::{EquilibriumPath, Step};
use crate::statics::scales::Scales;
use crate::statics::trace::Stage;

/// The chain of a problem whose loads are gathered; without friction.
pub(super) struct ChainPath<'a> {
    problem: &'a Problem<'a>,
    commands: Vec<Command>,
    load: f64,
    scratch: &'a mut Scratch,
}

impl<'a> ChainPath<'a> {
    pub fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        scratch.chain.trace.stage = Stage::ArcLength;
        scratch.chain.trace.steps = problem.mesh.grid.len();
        Self { problem, commands: problem.commands.to_vec(), load: 0.0, scratch }
    }

    /// Asks the chain, which stands at a state, for what a step is for.
    fn ask<T>(
        &mut self,
        step: Step<'_, NodeStep>,
        residual: f64,
        ask: impl FnOnce(&mut Chain, &Task<'_>) -> T,
    ) -> T {
        let Problem { frame, mesh, tolerance, cancel, .. } = *self.problem;
        let Scratch { chain, groups, applied, .. } = &mut *self.scratch;
        let by_length = self.commands.iter().any(Command::is_length);
        let task = Task {
            frame,
            mesh,
            loads: applied,
            load: self.load,
            step,
            groups,
            commands: if by_length { &self.commands } else { &[] },
            derivatives: false,
            tolerance: tolerance.max(residual),
            cancel,
        };
        ask(chain, &task)
    }

    /// Newton's method at the load of the state, and the answer copied out of the chain.
    pub fn finish(mut self) -> Result<Found, Open> {
        let closed = self.ask(Step::Close, 0.0, |chain, task| chain.newton(task, false));
        let (iterations, residual) = closed?;
        Ok(finish(self.problem, self.scratch, Effort { iterations, residual }))
    }
}

impl EquilibriumPath for ChainPath<'_> {
    type Part = Node;

    fn commands(&self) -> &[Command] {
        &self.commands
    }

    fn set_commands(&mut self, commands: &[Command]) {
        self.commands.clear();
        self.commands.extend_from_slice(commands);
    }

    fn is_cancelled(&self) -> bool {
        self.problem.cancel.is_cancelled()
    }

    fn weight(&self, k: usize) -> f64 {
        self.problem.frame.weight(k)
    }

    fn scales(&self) -> Scales {
        self.problem.frame.scales(self.problem.mesh)
    }

    fn state(&self) -> State {
        let Chain { nodes, tensions, .. } = &self.scratch.chain;
        State { nodes: nodes.clone(), tensions: tensions.clone(), load: self.load }
    }

    fn set_state(&mut self, state: State) {
        let Scratch { chain, groups, .. } = &mut *self.scratch;
        chain.nodes = state.nodes;
        chain.pull(groups, &state.tensions);
        self.load = state.load;
    }

    fn converge(&mut self, across: Option<&Direction>, residual: f64) -> Option<usize> {
        let step = across.map_or(Step::Close, Step::Across);
        let closed = self.ask(step, residual, |chain, task| chain.newton(task, false));
        let (iterations, _) = closed.ok()?;
        self.load = self.scratch.chain.load;
        Some(iterations)
    }

    fn direction(&mut self, step: Step<'_, NodeStep>) -> Option<Direction> {
        self.ask(step, 0.0, Chain::direction)
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        if self.scratch.applied.any_follower() {
            let negative = self.ask(Step::Close, 0.0, Chain::is_determinant_negative);
            return negative.map(usize::from);
        }
        stability_check::unstable_directions(self.problem, self.load, self.scratch)
    }

    fn lengths(&mut self) -> Option<&[f64]> {
        self.ask(Step::Close, 0.0, Chain::measure).ok()?;
        Some(&self.scratch.chain.lengths)
    }

    fn tip(&mut self) -> Vec3 {
        // A span that folds keeps the poses it had before.
        let _ = self.ask(Step::Close, 0.0, Chain::measure);
        let spans = self.problem.mesh.spans.iter();
        let ends = spans.map(|steps| self.scratch.chain.poses[steps.end - 1]);
        ends.fold(Pose::IDENTITY, |disk, end| disk * end).position
    }
}
