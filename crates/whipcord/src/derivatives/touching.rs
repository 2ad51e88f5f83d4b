//! Answers that touch obstacles: what would move the places that touch changes what pushes there.
//!
//! At constant tensions a motion `X₀` of those places that something causes without the contacts comes with pushes `δW = K X₀`
//! ([`crate::contact`], eq. (10) of its page), and these with columns like those of any other wrench. So every column of the
//! robot among obstacles is that of the robot alone and `K X₀` times those of the pushes, and a functional of it is one of the
//! former, with what its worth of the pushes is worth to `X₀`.

use super::Derivatives;
use super::NoDerivatives;
use super::columns::{Raw, Source};
use super::elimination::NodeChange;
use crate::shape::Wrench;
use crate::statics::hold::Critical;

/// The contacts of an answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Touching {
    /// The node of each.
    pub nodes: Vec<usize>,
    /// Columns of a unit of each component of the push of each, of the robot alone.
    columns: Vec<Raw>,
    /// `K` by rows.
    gain: Vec<f64>,
    is_about_to_change: bool,
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
fn motion(raw: &Raw, node: usize) -> [f64; 6] {
    let NodeChange { position: p, turn: t, .. } = raw.nodes[node];
    [p.x, p.y, p.z, t.x, t.y, t.z]
}

impl Derivatives {
    /// The derivatives of an answer that touches obstacles at these nodes, from those of the robot alone under what pushes there.
    /// `gain` makes `K` of the compliance of the nodes, both by rows with a force and a moment to a node.
    pub(crate) fn touching(
        mut self,
        nodes: Vec<usize>,
        gain: impl FnOnce(&[f64]) -> Result<Vec<f64>, Critical>,
        is_about_to_change: bool,
    ) -> Result<Self, NoDerivatives> {
        if nodes.is_empty() {
            self.touching.is_about_to_change = is_about_to_change;
            return Ok(self);
        }
        let sources = nodes.iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
        let column = |(node, component)| self.raw(Source::Wrench { node, component });
        let columns: Vec<Raw> = sources.map(column).collect();
        let n = columns.len();
        let mut compliance = vec![0.0; n * n];
        for (j, column) in columns.iter().enumerate() {
            for (k, &node) in nodes.iter().enumerate() {
                for (a, moved) in motion(column, node).into_iter().enumerate() {
                    compliance[(6 * k + a) * n + j] = moved;
                }
            }
        }
        let gain = gain(&compliance)?;
        self.touching = Touching { nodes, columns, gain, is_about_to_change };
        let cables = self.place_of.len();
        self.by_tension = (0..cables).map(|place| self.raw(Source::Tension(place))).collect();
        self.hold()?;
        if self.by_tension.iter().all(Raw::is_finite) {
            Ok(self)
        } else {
            Err(NoDerivatives::Critical)
        }
    }

    /// The same with other stations, by their nodes.
    pub(crate) fn at_stations(mut self, nodes: Vec<usize>) -> Self {
        self.places.stations = nodes;
        self
    }

    /// Whether a contact of the answer is about to open or to close, to stick or to slide: it has a kink there, and these are the
    /// derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_contact_about_to_change(&self) -> bool {
        self.touching.is_about_to_change
    }
}
