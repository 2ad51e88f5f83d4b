//! Cables that are driven by their lengths: `0 ≤ τ ⟂ ℓ* + c τ − ℓ ≥ 0` in every step of the iteration, eq. (13) of the page on motion, with the tension at the end of the
//! step where the cable stretches.

use whipcord::Wrench;
use whipcord_numerics::{Pose, Twist};

use crate::block::{dot, transposed_bracket};
use crate::chords;
use crate::drives::{Drives, MotorWork};
use crate::element::{POINTS, add_to_nodes};
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

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
    /// Room for the shape at the end of a step and the gradient of a length.
    room: Room,
}

/// A shape, and the gradient of the length of a straight cable by its strains.
#[derive(Clone, Debug, Default)]
struct Room {
    strains: Vec<Twist>,
    poses: Vec<Pose>,
    pulls: Vec<Wrench>,
    gradient: Vec<Twist>,
}

impl Room {
    fn new(rod: &Rod) -> Self {
        let (nodes, points) = (rod.nodes.len(), rod.points.len());
        Self {
            strains: vec![Twist::default(); points],
            poses: vec![Pose::IDENTITY; nodes],
            pulls: vec![Wrench::default(); nodes],
            gradient: vec![Twist::default(); points],
        }
    }

    /// Adds what a tension of 1 N in a straight cable exerts on the nodes, at strains and poses.
    fn add_pull(
        &mut self,
        rod: &Rod,
        cable: usize,
        (strains, poses): (&[Twist], &[Pose]),
        column: &mut [Twist],
    ) {
        let Self { pulls, gradient, .. } = self;
        let tension = |of: usize| if rod.chords[of].cable == cable { 1.0 } else { 0.0 };
        chords::gradient(rod, strains, poses, tension, pulls, gradient);
        for (q, (pull, strain)) in gradient.iter().zip(strains).enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            let across = transposed_bracket(strain, pull);
            add_to_nodes(&mut column[2 * e..], pull, &across, 1.0, k, rod.lengths[e]);
        }
    }
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
            room: Room::new(rod),
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
        if rod.has_chords() {
            let shape = (stage.strains.as_slice(), stage.poses.as_slice());
            Room::new(rod).add_pull(rod, cable, shape, &mut column);
            return column;
        }
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
        &mut self,
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
        let line = &rod.cables[cable];
        // What stretches it at the end of the step, but for the tension of the stage.
        let carried = self.previous[i] * (1.0 - 1.0 / scheme.place) - line.pretension;
        let longest = self.targets[i] + line.compliance * carried;
        if rod.has_chords() {
            let length = self.linearise_straight(rod, scheme, stage, cable, column, row);
            return longest - length;
        }
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
        longest - length
    }

    /// Column and row of a straight cable; its length at the end of the step, with what the strains lack.
    fn linearise_straight(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &Stage,
        cable: usize,
        column: &mut [Twist],
        row: &mut [Twist],
    ) -> f64 {
        let room = &mut self.room;
        room.add_pull(rod, cable, (&stage.strains, &stage.poses), column);
        let Room { strains, poses, pulls, gradient } = room;
        for ((end, start), strain) in strains.iter_mut().zip(&stage.start).zip(&stage.strains) {
            *end = scheme.end(*start, *strain);
        }
        pose::nodes(rod, stage.base, strains, poses);
        let tension =
            |of: usize| if rod.chords[of].cable == cable { 1.0 / scheme.place } else { 0.0 };
        chords::gradient(rod, strains, poses, tension, pulls, gradient);
        let mut length = rod.straight_length(cable, poses);
        for (q, gradient) in gradient.iter().enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            length += dot(gradient, &stage.lack[q]);
            let (slope, value) = stage.tangents[q].transposed_strain_change(gradient);
            add_to_nodes(&mut row[2 * e..], &slope, &value, 1.0, k, rod.lengths[e]);
        }
        length
    }
}
