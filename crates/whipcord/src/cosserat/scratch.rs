//! Memory of a solve on one grid, and where it starts.

use whipcord_numerics::Pose;

use super::chain::Chain;
use super::loaded::Trajectory;
use super::newton::Newton;
use super::relaxation::Relaxation;
use super::stability::Stability;
use super::state::{Node, State};
use super::unloaded::Unloaded;
use crate::shape::Wrench;
use crate::solution::InternalState;
use crate::statics::grid::Grid;
use crate::statics::lengths::{Effort, LengthScratch};
use crate::statics::loads::AppliedLoads;
use crate::statics::runge_kutta::{SAMPLED_STAGES, STAGES};
use crate::statics::trace::Trace;

/// Where the iteration starts: from the robot without load, or from a neighbouring answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Start {
    /// In N, in the order of the grid; none from the robot without load.
    pub tensions: Vec<f64>,
    /// Wrench at the base of a neighbouring answer.
    pub base_wrench: Option<Wrench>,
    /// Whether that answer was stable, so that this one is held to be.
    pub stable: bool,
    /// Whether it took multiple shooting.
    pub on_chain: bool,
    /// Whether it is no answer yet: more than the residual is left.
    pub is_iterate: bool,
    /// Whether its steps were closed side by side.
    pub side_by_side: bool,
    /// Its nodes then: those of multiple shooting on a grid with half as many steps, and those side by side with the middles of their steps.
    pub chain: State,
    /// The nodes of a neighbouring answer, where it tells them.
    pub internal: InternalState,
    /// Cables that were let go, see [`super::redundant_cables`].
    pub slackened: Vec<usize>,
    /// Whether the memory of the solve still has the derivatives and the strains of that answer.
    pub remembered: bool,
}

impl Start {
    /// From the robot without load, in the memory that it has.
    pub fn forget(&mut self) {
        self.tensions.clear();
        self.internal.clear();
        self.slackened.clear();
        (self.base_wrench, self.stable, self.on_chain) = (None, false, false);
        (self.remembered, self.side_by_side, self.is_iterate) = (false, false, false);
    }
}

/// Memory of a solve, and the answer it ends with.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Frames at the ends of all steps.
    pub poses: Vec<Pose>,
    /// Tensions in N and lengths in m, in the order of the grid.
    pub tensions: Vec<f64>,
    pub lengths: Vec<f64>,
    pub base_wrench: Wrench,
    pub(super) unloaded: Unloaded,
    pub(super) applied: AppliedLoads,
    pub(super) guess: Relaxation,
    pub(super) trajectory: Trajectory,
    pub(super) newton: Newton,
    pub(super) chain: Chain,
    pub(super) stability: Stability,
    pub(super) length_scratch: LengthScratch,
    pub trace: Trace,
    /// Cables that were let go, see [`super::redundant_cables`].
    pub(super) slackened: Vec<usize>,
    /// Whether the answer is that of the chain, which single shooting would miss.
    pub(super) on_chain: bool,
    /// Whether its steps were closed side by side, see [`Chain::close_from_base`].
    pub(super) side_by_side: bool,
    /// Whether the samples of the last shot are those of the answer.
    pub(super) sampled: bool,
    /// Whether [`Newton::sensitivity`] and the strains of the last shot are those near the answer.
    pub(super) differentiated: bool,
    /// Whether the answer is stable, as far as that was asked for.
    pub(super) stable: bool,
    /// Whether an equilibrium was accepted whose stability was not checked, see [`StabilityCheck::AtAnswer`].
    pub(super) unverified: bool,
    /// Where the derivatives of the answer are asked for at once, and it is corrected by them: the residual that its last shot, which is
    /// sampled, may leave. Zero where it is not.
    pub(super) corrected: f64,
    /// Whether branches off the path are left alone.
    pub(super) stays_on_path: bool,
    /// What the iterate leaves open at which the budget was spent; it is then in the place of the answer.
    pub(super) open: Option<Effort>,
}

impl Scratch {
    /// Moment, and force of the followers, in the base frame at the start of each step, of an answer
    /// that single shooting would miss.
    pub fn chain_starts(&self) -> impl Iterator<Item = Option<Wrench>> {
        let start =
            |node: &Node| Wrench { force: node.force, moment: node.rotation.rotate(node.moment) };
        let nodes = self.chain.state.nodes.iter().filter(|_| self.on_chain);
        nodes.map(move |node| Some(start(node)))
    }

    /// Whether the sections of a shot in lanes are iterated from somewhere.
    pub fn sections_need_a_start(&self, grid: &Grid) -> bool {
        let is_crossed_once = grid.step_table().is_some_and(|table| table.is_crossed_once);
        !is_crossed_once || self.applied.any_line()
    }

    /// Writes what acts at the nodes of the answer: nothing where single shooting found it.
    pub fn write_internal(&self, grid: &Grid, internal: &mut InternalState) {
        internal.clear();
        if !(self.on_chain || self.side_by_side) {
            return;
        }
        internal.nodes.clone_from(&self.chain.state.nodes);
        internal.takes_multiple_shooting = self.on_chain;
        if self.sections_need_a_start(grid) {
            let of_steps = self.trajectory.strains().chunks_exact(STAGES);
            internal.strains.extend(of_steps.flat_map(|of| SAMPLED_STAGES.map(|stage| of[stage])));
        }
    }

    /// Keeps the answer as the start of another solve.
    pub fn keep_start(&self, start: &mut Start) {
        start.tensions.clone_from(&self.tensions);
        (start.base_wrench, start.stable) = (Some(self.base_wrench), self.stable);
        start.on_chain = self.on_chain;
        if self.on_chain {
            start.chain.copy_from(&self.chain.state);
        }
        (start.side_by_side, start.is_iterate) = (self.side_by_side, false);
        if self.side_by_side {
            let middles = self.trajectory.in_lanes.middles(self.chain.state.nodes.len() - 1);
            start.chain.halve(&self.chain.state, middles);
        }
        start.internal.clear();
        start.slackened.clone_from(&self.slackened);
        start.remembered = self.differentiated && !self.on_chain;
    }
}
