//! Answers that touch obstacles: what would move the places that touch changes what pushes there.
//!
//! At constant tensions a motion `X₀` of those places that something causes without the contacts comes with pushes `δW = K X₀`
//! ([`crate::contact`], eq. (10) of its page), and these with columns like those of any other wrench. So every column of the
//! robot among obstacles is that of the robot alone and `K X₀` times those of the pushes, and a functional of it is one of the
//! former, with what its worth of the pushes is worth to `X₀`.

use super::column::Raw;
use super::node_change::NodeChange;
use crate::shape::Wrench;

/// The contacts of an answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Touching {
    /// The node of each.
    pub nodes: Vec<usize>,
    /// Columns of a unit of each component of the push of each, of the robot alone.
    pub columns: Vec<Raw>,
    /// `K` by rows.
    pub gain: Vec<f64>,
    pub is_about_to_change: bool,
}

impl Touching {
    /// Adds what the contacts push to a column of the robot alone.
    pub fn respond(&self, raw: &mut Raw) {
        let moved: Vec<f64> = self.nodes.iter().flat_map(|&node| motion(raw, node)).collect();
        let n = moved.len();
        let by = |row: &[f64]| row.iter().zip(&moved).map(|(k, x)| k * x).sum();
        raw.pushes = self.gain.chunks_exact(n.max(1)).map(by).collect();
        for i in 0..n {
            let push = raw.pushes[i];
            raw.add(push, &self.columns[i]);
        }
    }

    /// Adds to a functional of columns of the robot among obstacles what makes it one of columns of the robot alone.
    pub fn pull_back(&self, nodes: &mut [NodeChange], lengths: &[f64], base: &Wrench) {
        let worth: Vec<f64> =
            self.columns.iter().map(|column| column.worth(nodes, lengths, base)).collect();
        let n = worth.len();
        for (k, &node) in self.nodes.iter().enumerate() {
            let by =
                |c: usize| (0..n).map(|i| self.gain[i * n + 6 * k + c] * worth[i]).sum::<f64>();
            for axis in 0..3 {
                nodes[node].position[axis] += by(axis);
                nodes[node].turn[axis] += by(3 + axis);
            }
        }
    }

    /// What is pushed more at a node.
    pub fn push(&self, pushes: &[f64], node: usize) -> Wrench {
        let mut wrench = Wrench::default();
        for (_, push) in
            self.nodes.iter().zip(pushes.chunks_exact(6)).filter(|(at, _)| **at == node)
        {
            for axis in 0..3 {
                wrench.force[axis] += push[axis];
                wrench.moment[axis] += push[3 + axis];
            }
        }
        wrench
    }
}

/// How a node moves, its point first.
pub(super) fn motion(raw: &Raw, node: usize) -> [f64; 6] {
    let NodeChange { position: p, turn: t, .. } = raw.nodes[node];
    [p.x, p.y, p.z, t.x, t.y, t.z]
}
