//! Cross-sections of a rod: their places in the elements, poses and displacements.

use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use crate::element::{NODES, PLACES, POINTS, pose_at, shapes};
use crate::rod::Rod;

/// A cross-section by its place in the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Station {
    pub element: usize,
    /// From 0 at the start of the element to 1 at its end.
    pub fraction: f64,
}

impl Station {
    /// At an arc length in m.
    pub fn at(rod: &Rod, arc_length: f64) -> Self {
        let starts = rod.nodes.iter().step_by(POINTS).take(rod.elements());
        let element = starts.filter(|node| node.arc_length < arc_length).count().max(1) - 1;
        let fraction = (arc_length - rod.nodes[POINTS * element].arc_length) / rod.lengths[element];
        Self { element, fraction: fraction.clamp(0.0, 1.0) }
    }

    /// Of a node beyond the base.
    pub fn of_node(node: usize) -> Self {
        let element = (node - 1) / POINTS;
        Self { element, fraction: PLACES[node - POINTS * element] }
    }

    /// Arc length in m.
    pub fn arc_length(self, rod: &Rod) -> f64 {
        rod.nodes[POINTS * self.element].arc_length + self.fraction * rod.lengths[self.element]
    }

    /// How these weights change with the arc length, in 1/m.
    pub fn slopes(self, rod: &Rod) -> [f64; NODES] {
        // They are quadratic, so that a difference has no error.
        const STEP: f64 = 0.25;
        let [above, below] = [STEP, -STEP].map(|by| shapes(self.fraction + by));
        core::array::from_fn(|a| (above[a] - below[a]) / (2.0 * STEP * rod.lengths[self.element]))
    }

    /// The velocity there is the sum of those of the three nodes of the element with these weights.
    pub fn shapes(self) -> [f64; NODES] {
        shapes(self.fraction)
    }
}

/// A rod in a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Posed<'a> {
    pub rod: &'a Rod,
    pub strains: &'a [Twist],
    /// Poses of the nodes, in the frame of the base at the start of the motion.
    pub poses: &'a [Pose],
}

impl Posed<'_> {
    pub fn at(&self, station: Station) -> Pose {
        let (q, h) = (POINTS * station.element, self.rod.lengths[station.element]);
        pose_at(&self.poses[q..], &self.strains[q..], h, station.fraction)
    }
}

/// Displacements of a cross-section: along and about three axes.
pub(crate) const MOTIONS: usize = 6;

/// A unit displacement along or about an axis.
pub(crate) fn unit(axis: usize) -> Twist {
    let mut out = Twist::default();
    let part = if axis < 3 { &mut out.linear } else { &mut out.angular };
    part[axis % 3] = 1.0;
    out
}

/// A pose displaced along, or turned about, an axis of the frame that it is given in.
pub(crate) fn displaced(pose: &Pose, axis: usize, by: f64) -> Pose {
    let motion = unit(axis) * by;
    let rotation = UnitQuaternion::exp(motion.angular) * pose.rotation;
    Pose { position: pose.position + motion.linear, rotation }
}

/// Derivatives of a number by the displacements of a section along and about each axis, by central differences of a rod of this length.
pub(crate) fn by_displacements(length: f64, at: impl Fn(usize, f64) -> f64) -> Twist {
    let of = |axis: usize| {
        let step = if axis < 3 { 1e-6 * length } else { 1e-6 };
        (at(axis, step) - at(axis, -step)) * (0.5 / step)
    };
    Twist { linear: Vec3::new(of(0), of(1), of(2)), angular: Vec3::new(of(3), of(4), of(5)) }
}
