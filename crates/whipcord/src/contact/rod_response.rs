//! How a rod moves with the pushes of its contacts, and with the step that is left.

use whipcord_numerics::Vec3;

use super::pushed_places::PushedPlaces;
use crate::derivatives::{Derivatives, Motion, unit_wrench};

/// The linearised rod.
#[derive(Clone, Debug)]
pub(crate) struct RodResponse {
    derivatives: Derivatives,
    /// Newton's step while the wrenches stay as they are.
    closing: Motion,
    /// The nodes that are pushed.
    nodes: PushedPlaces<usize>,
    /// How everything moves with each component of a wrench on each of these nodes.
    by_push: Vec<Motion>,
}

impl RodResponse {
    pub fn new(derivatives: Derivatives, closing: Motion) -> Self {
        Self { derivatives, closing, nodes: PushedPlaces::default(), by_push: Vec::new() }
    }

    /// How the nodes of pushes move with each component of each of them, by rows, and how with the step that is left.
    pub fn compliance(
        &mut self,
        of_pushes: &[usize],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        let Self { derivatives, closing, nodes, by_push } = self;
        nodes.set(of_pushes);
        by_push.clear();
        let components = nodes.places().iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
        by_push
            .extend(components.map(|(node, i)| derivatives.contact_response(node, unit_wrench(i))));
        let twist = |motion: &Motion, place: usize| motion.nodes[nodes.places()[place]].twist();
        nodes.compliance(
            |wrench, place| twist(&by_push[wrench], place),
            |place| twist(closing, place),
            compliance,
            drift,
        );
    }

    /// What changes of the pushes add to the dead force behind a node: pushes are no forces of followers.
    pub fn pushed_beyond(&self, node: usize, changes: &[[f64; 6]]) -> Vec3 {
        self.nodes.beyond(node, changes)
    }

    /// The step that is left, with what changes of the pushes do.
    pub fn step(&self, changes: &[[f64; 6]]) -> Motion {
        let mut motion = self.closing.clone();
        // Without pushes nothing was asked of the response to them.
        for (column, change) in self.by_push.iter().zip(self.nodes.totals(changes)) {
            motion.add(change, column);
        }
        motion
    }
}
