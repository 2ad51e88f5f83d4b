//! Points of the equilibrium path and directions along it.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use crate::statics::elimination::Change;
use crate::statics::grid::Grid;
use crate::statics::scales::Scales;

/// A point of the equilibrium path, or an estimate of one.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub nodes: Vec<Node>,
    /// In N, in the order of the grid.
    pub tensions: Vec<f64>,
    pub load: f64,
}

/// Where a step starts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub rotation: UnitQuaternion,
    /// In the body frame, in N·m.
    pub moment: Vec3,
    /// Of the followers, in the base frame, in N.
    pub force: Vec3,
}

/// Change of a [`State`].
#[derive(Clone, Debug, Default)]
pub(super) struct Direction {
    pub nodes: Vec<Change>,
    pub tensions: Vec<f64>,
    pub load: f64,
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

    /// The nodes of a chain with every step halved.
    pub fn halved(&self) -> Self {
        let mut nodes = Vec::with_capacity(2 * self.nodes.len());
        for pair in self.nodes.windows(2) {
            let turn = (pair[0].rotation.conjugate() * pair[1].rotation).log();
            let rotation = pair[0].rotation * UnitQuaternion::exp(0.5 * turn);
            let moment = 0.5 * (pair[0].moment + pair[1].moment);
            nodes.extend([pair[0], Node { rotation, moment, ..pair[0] }]);
        }
        nodes.extend(self.nodes.last());
        Self { nodes, ..self.clone() }
    }

    /// Moves this state away from another by a fraction of a direction.
    pub fn step_from(&mut self, from: &Self, fraction: f64, direction: &Direction) {
        self.nodes.clear();
        self.nodes.extend(from.nodes.iter().zip(&direction.nodes).map(|(node, change)| Node {
            rotation: (node.rotation * UnitQuaternion::exp(fraction * change.turn)).renormalized(),
            moment: node.moment + fraction * change.moment,
            force: node.force + fraction * change.force,
        }));
        self.tensions.clear();
        let moved = |(t, d): (&f64, &f64)| (t + fraction * d).max(0.0);
        self.tensions.extend(from.tensions.iter().zip(&direction.tensions).map(moved));
        self.load = from.load + fraction * direction.load;
    }
}

impl Direction {
    /// Along the load alone.
    pub fn of_load(nodes: usize, cables: usize) -> Self {
        Self { nodes: vec![Change::default(); nodes], tensions: vec![0.0; cables], load: 1.0 }
    }

    /// Product in which rotations count in radians, averaged along the rod, and the rest relative to
    /// its scale.
    pub fn dot(&self, other: &Self, grid: &Grid, scales: &Scales) -> f64 {
        let nodes = self.nodes.iter().zip(&other.nodes).enumerate();
        let sum: f64 = nodes.map(|(k, (a, b))| weight(grid, k) * scaled(a, b, scales)).sum();
        let tensions: f64 = self.tensions.iter().zip(&other.tensions).map(|(a, b)| a * b).sum();
        sum + tensions / (scales.force * scales.force) + self.load * other.load
    }

    /// Adds a multiple of another direction.
    pub fn add(&mut self, f: f64, other: &Self) {
        for (a, b) in self.nodes.iter_mut().zip(&other.nodes) {
            *a = a.plus(f, *b);
        }
        for (a, b) in self.tensions.iter_mut().zip(&other.tensions) {
            *a += f * b;
        }
        self.load += f * other.load;
    }

    /// Scales to length 1; `false` where it has none.
    pub fn normalize(&mut self, grid: &Grid, scales: &Scales) -> bool {
        let norm = self.dot(self, grid, scales).sqrt();
        if !norm.is_finite() || norm < f64::MIN_POSITIVE {
            return false;
        }
        self.scale(1.0 / norm);
        true
    }

    pub fn scale(&mut self, f: f64) {
        for change in &mut self.nodes {
            *change = Change::default().plus(f, *change);
        }
        self.tensions.iter_mut().for_each(|t| *t *= f);
        self.load *= f;
    }
}

/// Share of the rod that a node stands for.
pub(super) fn weight(grid: &Grid, k: usize) -> f64 {
    let end = grid.steps.last().map_or(1.0, |step| step.start + step.length);
    grid.steps.get(k).map_or(0.0, |step| step.length / end)
}

/// Product of two changes, each relative to its scale.
pub(super) fn scaled(a: &Change, b: &Change, scales: &Scales) -> f64 {
    a.turn.dot(b.turn)
        + a.moment.dot(b.moment) / (scales.moment * scales.moment)
        + a.force.dot(b.force) / (scales.force * scales.force)
}
