//! Cables that are driven by their lengths: `0 ≤ τ ⟂ ℓ* + c τ − ℓ ≥ 0` in every step of the iteration, eq. (13) of the page on motion, with the tension at the end of the
//! step where the cable stretches.

use whipcord_numerics::Twist;

use crate::block::{dot, transposed_bracket};
use crate::drives::{Drives, MotorWork};
use crate::element::{POINTS, add_to_nodes};
use crate::rod::Rod;
use crate::stage::{Pull, Scheme, Stage};

/// The cables that are driven by their lengths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lengths {
    /// Their numbers.
    pub cables: Vec<usize>,
    /// Length in m of each at the end of the step, where it has no tension.
    pub targets: Vec<f64>,
    /// Tension in N of each at the start of the step.
    pub previous: Vec<f64>,
    /// Motors with inertia, whose cables have the length that they leave them.
    pub drives: Drives,
    /// What these motors gain and lose in a step.
    pub motor_work: MotorWork,
}

impl Lengths {
    /// Room for all cables of a rod.
    pub fn new(rod: &Rod, drives: Drives) -> Self {
        let count = rod.cables.len();
        Self {
            cables: Vec::with_capacity(count),
            targets: Vec::with_capacity(count),
            previous: Vec::with_capacity(count),
            drives,
            motor_work: MotorWork::default(),
        }
    }

    /// Tension at the end of a step, from those at its start and at its stage: straight through both. A cable that is slack at the stage is so at the end.
    pub fn end_tension(previous: f64, stage: f64, place: f64) -> f64 {
        if stage == 0.0 {
            return 0.0;
        }
        (previous + (stage - previous) / place).max(0.0)
    }

    /// The same of a cable that is driven by its length.
    pub fn end_tension_of(&self, cable: usize, stage: &Stage, scheme: &Scheme) -> f64 {
        let place = self.cables.iter().position(|of| *of == cable);
        let previous = place.and_then(|k| self.previous.get(k)).copied().unwrap_or_default();
        Self::end_tension(previous, stage.tensions[cable], scheme.place)
    }

    /// What a tension of 1 N in a cable exerts on the nodes at the strains of a stage.
    pub fn pull(rod: &Rod, stage: &Stage, cable: usize) -> Vec<Twist> {
        let mut column = vec![Twist::default(); rod.nodes.len()];
        for q in 0..POINTS * rod.cables[cable].elements {
            let (e, k) = (q / POINTS, q % POINTS);
            let (weight, h) = (rod.points[q].weight, rod.lengths[e]);
            let crossing = &rod.crossings[q * rod.cables.len() + cable];
            let strain = stage.strains[q];
            let pull = Pull::new(crossing, &strain, &strain, &Scheme::STATICS).wrench(crossing);
            add_to_nodes(
                &mut column[2 * e..],
                &pull,
                &transposed_bracket(&strain, &pull),
                weight,
                k,
                h,
            );
        }
        column
    }

    /// Fills column and row of a cable: what a tension of 1 N exerts on the nodes, and what a change of the velocities adds to the length. Returns by how
    /// much the cable without stretch is longer than its path at the end of the step, with what the strains lack.
    pub fn linearise(
        &self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &Stage,
        i: usize,
        column: &mut [Twist],
        row: &mut [Twist],
    ) -> f64 {
        let cable = self.cables[i];
        column.fill(Twist::default());
        row.fill(Twist::default());
        let count = rod.cables.len();
        let mut length = 0.0;
        for q in 0..POINTS * rod.cables[cable].elements {
            let (e, k) = (q / POINTS, q % POINTS);
            let (weight, h) = (rod.points[q].weight, rod.lengths[e]);
            let crossing = &rod.crossings[q * count + cable];
            let strain = stage.strains[q];
            let pull = Pull::new(crossing, &strain, &stage.start[q], scheme).wrench(crossing);
            let across = transposed_bracket(&strain, &pull);
            // At the end of the step.
            let end = scheme.end(stage.start[q], strain);
            let tangent = crossing.tangent(&end);
            let norm = tangent.norm();
            length += weight * norm;
            let direction = tangent * (1.0 / (norm * scheme.place));
            let gradient = Twist { linear: direction, angular: crossing.offset.cross(direction) };
            length += weight * dot(&gradient, &stage.lack[q]);
            let (slope, value) = stage.tangents[q].transposed_strain_change(&gradient);
            add_to_nodes(&mut column[2 * e..], &pull, &across, weight, k, h);
            add_to_nodes(&mut row[2 * e..], &slope, &value, weight, k, h);
        }
        row[0] = Twist::default();
        let line = &rod.cables[cable];
        // What stretches it at the end of the step, but for the tension of the stage.
        let carried = self.previous[i] * (1.0 - 1.0 / scheme.place) - line.pretension;
        self.targets[i] + line.compliance * carried - length
    }
}
