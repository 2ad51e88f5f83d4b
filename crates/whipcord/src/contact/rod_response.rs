//! How a rod moves with the pushes of its contacts, and with the step that is left.

use crate::derivatives::{Derivatives, Motion, unit_wrench};

/// The linearised rod.
#[derive(Clone, Debug)]
pub(crate) struct RodResponse {
    derivatives: Derivatives,
    /// Newton's step while the wrenches stay as they are.
    closing: Motion,
    /// The nodes that are pushed, each once: several pushes may act on one.
    nodes: Vec<usize>,
    /// The place in these of each push.
    place_of: Vec<usize>,
    /// How everything moves with each component of a wrench on each of these nodes.
    by_push: Vec<Motion>,
}

impl RodResponse {
    pub fn new(derivatives: Derivatives, closing: Motion) -> Self {
        let (nodes, place_of, by_push) = (Vec::new(), Vec::new(), Vec::new());
        Self { derivatives, closing, nodes, place_of, by_push }
    }

    /// How the nodes of pushes move with each component of each of them, by rows, and how with the step that is left.
    pub fn compliance(
        &mut self,
        of_pushes: &[usize],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        let Self { derivatives, closing, nodes, place_of, by_push } = self;
        nodes.clear();
        nodes.extend_from_slice(of_pushes);
        nodes.sort_unstable();
        nodes.dedup();
        place_of.clear();
        place_of.extend(of_pushes.iter().map(|node| nodes.partition_point(|other| other < node)));
        by_push.clear();
        let components = nodes.iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
        by_push
            .extend(components.map(|(node, i)| derivatives.contact_response(node, unit_wrench(i))));
        let rates = |motion: &Motion, node: usize| {
            let twist = motion.nodes[node].twist();
            let parts = [twist.linear, twist.angular].map(<[f64; 3]>::from);
            core::array::from_fn::<f64, 6, _>(|a| parts[a / 3][a % 3])
        };
        let mut columns: Vec<[f64; 6]> = Vec::with_capacity(by_push.len());
        for &node in of_pushes {
            drift.extend(rates(closing, node));
            columns.clear();
            columns.extend(by_push.iter().map(|motion| rates(motion, node)));
            for a in 0..6 {
                for &place in place_of.iter() {
                    compliance.extend(columns[6 * place..6 * place + 6].iter().map(|x| x[a]));
                }
            }
        }
    }

    /// The step that is left, with what changes of the pushes do.
    pub fn step(&self, changes: &[[f64; 6]]) -> Motion {
        let mut motion = self.closing.clone();
        let mut together = vec![0.0; self.by_push.len()];
        for (&place, change) in self.place_of.iter().zip(changes) {
            let of_node = &mut together[6 * place..6 * place + 6];
            of_node.iter_mut().zip(change).for_each(|(sum, change)| *sum += change);
        }
        for (column, &change) in self.by_push.iter().zip(&together) {
            motion.add(change, column);
        }
        motion
    }
}
