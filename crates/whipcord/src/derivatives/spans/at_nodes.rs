//! Changes at the nodes of the grid that are kept, from those at the disks, and back.

use whipcord_numerics::Vec3;

use super::super::effect::Effect;
use super::super::forward::StepMap;
use super::super::node_change::NodeChange;
use super::{Span, Spans};

impl Spans {
    /// The effects of an input at the kept nodes of each span.
    pub fn input(&self, input: usize) -> impl Fn(usize, usize) -> Effect {
        move |k, node| self.inside_effects[(self.spans[k].first + node) * self.inputs + input]
    }

    /// How a kept node of a span moves with its start.
    pub fn inside(&self, k: usize, node: usize) -> &StepMap {
        &self.inside[self.spans[k].first + node]
    }

    /// The changes at the nodes of the grid, of those that are kept, from the changes of the disks and what acts inside the
    /// spans, by span and kept node. What acts at a node is that in the rod just behind it, at the tip in front of it.
    pub fn expand(
        &self,
        disks: &[NodeChange],
        acting: impl Fn(usize, usize) -> Effect,
        nodes: &mut Vec<NodeChange>,
    ) {
        nodes.clear();
        let count = self.spans.last().map_or(0, |span| span.steps.end + 1);
        nodes.resize(count, NodeChange::default());
        for (k, span) in self.spans.iter().enumerate() {
            let NodeChange { turn, position, moment, force } = disks[k];
            // The far disk is the near one of the next span, which comes later.
            for (i, (node, map)) in span.kept.iter().zip(&self.inside[span.nodes()]).enumerate() {
                let Effect { turn, moment, shift, force } =
                    map.apply([turn, moment, force]).plus(&acting(k, i));
                let at = &mut nodes[span.steps.start + node];
                *at = NodeChange { turn, position: position + shift, moment, force };
            }
        }
    }

    /// The transpose of [`Self::expand`]: sensitivities to the disks, and to the starts of the spans as
    /// [`super::elimination::Elimination::pull_back`] takes them.
    pub fn gather(&self, nodes: &[NodeChange]) -> (Vec<NodeChange>, Vec<[Vec3; 3]>) {
        let mut disks = vec![NodeChange::default(); self.spans.len() + 1];
        let mut starts = vec![[Vec3::ZERO; 3]; self.spans.len()];
        for (k, span) in self.spans.iter().enumerate() {
            for (i, &node) in span.kept.iter().enumerate().skip(1) {
                let NodeChange { turn, position, .. } = nodes[span.steps.start + node];
                if node == span.steps.len() {
                    disks[k + 1].turn += turn;
                    disks[k + 1].position += position;
                    continue;
                }
                disks[k].position += position;
                let map = &self.inside[span.first + i];
                for (to, (by_turn, by_shift)) in
                    starts[k].iter_mut().zip(map.turn.iter().zip(&map.shift))
                {
                    *to += by_turn.transpose_mul(turn) + by_shift.transpose_mul(position);
                }
            }
        }
        (disks, starts)
    }

    /// What effects inside the spans, by span and kept node, are worth at the nodes of the grid but the disks.
    pub fn worth(&self, nodes: &[NodeChange], acting: impl Fn(usize, usize) -> Effect) -> f64 {
        let of_span = |(k, span): (usize, &Span)| -> f64 {
            let of_node = |(i, node): (usize, &usize)| {
                let NodeChange { turn, position, .. } = nodes[span.steps.start + node];
                let Effect { turn: by_turn, shift, .. } = acting(k, i);
                turn.dot(by_turn) + position.dot(shift)
            };
            let last = span.kept.len() - 1;
            span.kept[..last].iter().enumerate().skip(1).map(of_node).sum()
        };
        self.spans.iter().enumerate().map(of_span).sum()
    }
}
