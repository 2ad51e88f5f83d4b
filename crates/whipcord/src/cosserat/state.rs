//! Points of the equilibrium path and directions along it.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use crate::shape::Wrench;
use crate::solution::NodeState;
use crate::statics::elimination::Change;
use crate::statics::grid::Grid;
use crate::statics::path::state;

/// A point of the equilibrium path, or an estimate of one.
pub(super) type State = state::State<Node>;
/// Change of a [`State`].
pub(super) type Direction = state::Direction<Change>;

/// Where a step starts.
pub(super) type Node = NodeState;

impl Node {
    /// Bears this moment and followers' force in the base frame.
    pub fn bear(&mut self, Wrench { force, moment }: Wrench) {
        self.moment = self.rotation.conjugate().rotate(moment);
        self.force = force;
    }
}

impl State {
    /// Takes another for its own, in the memory that it has.
    pub fn copy_from(&mut self, other: &Self) {
        self.nodes.clone_from(&other.nodes);
        self.tensions.clone_from(&other.tensions);
        self.load = other.load;
    }

    /// A shape that carries no load.
    pub fn unloaded(poses: &[Pose], tensions: &[f64]) -> Self {
        let node = |pose: &Pose| Node { rotation: pose.rotation, ..Node::default() };
        Self { nodes: poses.iter().map(node).collect(), tensions: tensions.to_vec(), load: 0.0 }
    }

    /// Takes the nodes of a chain, and between them those in the middles of its steps: how they are turned, and the moment in the body frame.
    pub fn halve(&mut self, whole: &Self, middles: impl Iterator<Item = (UnitQuaternion, Vec3)>) {
        self.nodes.clear();
        for (start, (rotation, moment)) in whole.nodes.iter().zip(middles) {
            self.nodes.extend([*start, Node { rotation, moment, ..*start }]);
        }
        self.nodes.extend(whole.nodes.last());
        self.tensions.clone_from(&whole.tensions);
        self.load = whole.load;
    }

    /// The nodes of a chain with every step halved.
    pub fn halved(&self) -> Self {
        let mut halved = Self::default();
        halved.halve(self, self.middles());
        halved
    }

    /// In the middle of each step, between its ends: how the rod is turned there, and the moment in the body frame.
    pub fn middles(&self) -> impl Iterator<Item = (UnitQuaternion, Vec3)> {
        self.nodes.windows(2).map(|pair| {
            let turn = (pair[0].rotation.conjugate() * pair[1].rotation).log();
            let rotation = pair[0].rotation * UnitQuaternion::exp(0.5 * turn);
            (rotation, 0.5 * (pair[0].moment + pair[1].moment))
        })
    }
}

impl state::Part for Node {
    type Change = Change;

    fn stepped(&self, fraction: f64, change: &Change) -> Self {
        let turned = self.rotation * UnitQuaternion::exp(fraction * change.turn);
        Self {
            rotation: turned.renormalized(),
            moment: self.moment + fraction * change.moment,
            force: self.force + fraction * change.force,
        }
    }
}

/// Share of the rod that a node stands for.
pub(super) fn weight(grid: &Grid, k: usize) -> f64 {
    let end = grid.steps.last().map_or(1.0, |step| step.start + step.length);
    grid.steps.get(k).map_or(0.0, |step| step.length / end)
}
