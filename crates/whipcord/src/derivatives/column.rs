//! What one source changes at constant tensions, in the terms of the grid.

use whipcord_numerics::Vec3;

use super::node_change::NodeChange;
use super::replay::AXES;
use crate::shape::Wrench;

/// A change at constant tensions, in the terms of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Raw {
    /// At the nodes of the grid; what acts there is that in the rod, and in cables that run through its sections.
    pub nodes: Vec<NodeChange>,
    /// At the disks, with what acts in cables too, where these run straight from disk to disk; else empty.
    pub disks: Vec<NodeChange>,
    pub base: Wrench,
    pub lengths: Vec<f64>,
    /// What the contacts push more, a force and a moment to each.
    pub pushes: Vec<f64>,
}

/// What acts: a column's source.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    Tension(usize),
    Parameter(usize),
    /// Component of a dead wrench at a node, the force first.
    Wrench {
        node: usize,
        component: usize,
    },
}

impl Raw {
    /// `self += f · other`.
    pub fn add(&mut self, f: f64, other: &Self) {
        if f == 0.0 {
            return;
        }
        for (nodes, others) in [(&mut self.nodes, &other.nodes), (&mut self.disks, &other.disks)] {
            for (node, by) in nodes.iter_mut().zip(others) {
                node.add(f, by);
            }
        }
        for (length, by) in self.lengths.iter_mut().zip(&other.lengths) {
            *length += f * by;
        }
        self.base.add(f, &other.base);
        self.pushes.resize(self.pushes.len().max(other.pushes.len()), 0.0);
        for (push, by) in self.pushes.iter_mut().zip(&other.pushes) {
            *push += f * by;
        }
    }

    /// What it is worth to a functional of nodes, lengths and wrench at the base.
    pub fn worth(&self, nodes: &[NodeChange], lengths: &[f64], base: &Wrench) -> f64 {
        let moved: f64 = self.nodes.iter().zip(nodes).map(|(a, b)| a.dot(b)).sum();
        let longer: f64 = self.lengths.iter().zip(lengths).map(|(a, b)| a * b).sum();
        moved + longer + self.base.dot(base)
    }

    pub fn is_finite(&self) -> bool {
        self.nodes.iter().all(|n| n.turn.is_finite() && n.position.is_finite())
            && self.lengths.iter().all(|l| l.is_finite())
    }
}

/// A wrench of which one component is 1, the force first.
pub(crate) fn unit_wrench(component: usize) -> Wrench {
    match component {
        0..3 => Wrench { force: AXES[component], moment: Vec3::ZERO },
        _ => Wrench { force: Vec3::ZERO, moment: AXES[component % 3] },
    }
}
