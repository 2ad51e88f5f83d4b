//! Points of an equilibrium path and directions along it.

use core::fmt::Debug;

use crate::statics::elimination::Change;
use crate::statics::scales::Scales;

/// A part of a state: a node of a rod, a disk, or the coordinates of a section.
pub(crate) trait Part: Copy + Debug {
    /// Its change.
    type Change: PartChange;

    /// This part a fraction of a change on.
    fn stepped(&self, fraction: f64, change: &Self::Change) -> Self;
}

/// Change of a part of a state.
pub(crate) trait PartChange: Copy + Debug + Default {
    /// This change and a multiple of another.
    fn plus(self, f: f64, other: Self) -> Self;

    /// Product of two changes, each relative to its scale.
    fn product(&self, other: &Self, scales: &Scales) -> f64;
}

/// A point of the equilibrium path, or an estimate of one.
#[derive(Clone, Debug, Default)]
pub(crate) struct State<N> {
    /// From base to tip.
    pub nodes: Vec<N>,
    /// In N, in the order of the commands.
    pub tensions: Vec<f64>,
    /// Factor on all loads.
    pub load: f64,
}

/// Change of a [`State`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Direction<C> {
    pub nodes: Vec<C>,
    pub tensions: Vec<f64>,
    pub load: f64,
}

impl<N: Part> State<N> {
    /// Moves this state away from another by a fraction of a direction.
    pub fn step_from(&mut self, from: &Self, fraction: f64, direction: &Direction<N::Change>) {
        self.nodes.clear();
        let nodes = from.nodes.iter().zip(&direction.nodes);
        self.nodes.extend(nodes.map(|(node, change)| node.stepped(fraction, change)));
        self.tensions.clear();
        let moved = |(t, d): (&f64, &f64)| (t + fraction * d).max(0.0);
        self.tensions.extend(from.tensions.iter().zip(&direction.tensions).map(moved));
        self.load = from.load + fraction * direction.load;
    }

    /// The direction along the load alone.
    pub fn along_load(&self) -> Direction<N::Change> {
        Direction {
            nodes: vec![N::Change::default(); self.nodes.len()],
            tensions: vec![0.0; self.tensions.len()],
            load: 1.0,
        }
    }
}

impl<C: PartChange> Direction<C> {
    /// Product in which rotations count in radians, averaged along the robot by the weights of the nodes, and the
    /// rest relative to its scale.
    pub fn dot(&self, other: &Self, weight: impl Fn(usize) -> f64, scales: &Scales) -> f64 {
        let nodes = self.nodes.iter().zip(&other.nodes).enumerate();
        let sum: f64 = nodes.map(|(k, (a, b))| weight(k) * a.product(b, scales)).sum();
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

    pub fn scale(&mut self, f: f64) {
        for change in &mut self.nodes {
            *change = C::default().plus(f, *change);
        }
        self.tensions.iter_mut().for_each(|t| *t *= f);
        self.load *= f;
    }
}

impl PartChange for Change {
    fn plus(self, f: f64, other: Self) -> Self {
        Self::plus(self, f, other)
    }

    fn product(&self, other: &Self, scales: &Scales) -> f64 {
        self.turn.dot(other.turn)
            + self.moment.dot(other.moment) / (scales.moment * scales.moment)
            + self.force.dot(other.force) / (scales.force * scales.force)
    }
}
