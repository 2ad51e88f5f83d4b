//! Cables straight from disk to disk: the length of a cable as a function of the strains, whose gradient is what its tension exerts on them.
//!
//! Both holes of a piece stand on nodes, so that its length follows from their poses. By the strains that gives eq. (27) of the page on motion; by the
//! displacements of the two nodes it gives the part of the linear system that links them, eq. (28).

use whipcord::Wrench;
use whipcord_numerics::{Mat3, Pose, Twist, Vec3};

use crate::block::{Block, skew_times, times_skew};
use crate::elimination::Pair;
use crate::pose;
use crate::rod::{Chord, Rod};

/// A chord in a shape.
struct Posed {
    /// Direction from the first hole to the second.
    along: Vec3,
    length: f64,
    /// From the centres of the cross-sections to the holes.
    levers: [Vec3; 2],
}

impl Chord {
    fn at(&self, poses: &[Pose]) -> Posed {
        let levers = [0, 1].map(|i| poses[self.nodes[i]].rotation.rotate(self.holes[i]));
        let way = self.way(poses);
        let length = way.norm();
        Posed { along: way * (1.0 / length), length, levers }
    }

    /// Its direction from the base on.
    pub fn direction(&self, poses: &[Pose]) -> Vec3 {
        self.at(poses).along
    }

    /// Adds the gradient, by the places and turns of the nodes, of its direction times a vector across it.
    pub fn add_for_direction(&self, poses: &[Pose], vector: Vec3, out: &mut [Wrench]) {
        let posed = self.at(poses);
        self.add(&posed, vector * (1.0 / posed.length), out);
    }

    /// Adds a force at its far hole and the opposite one at its near hole.
    fn add(&self, posed: &Posed, force: Vec3, out: &mut [Wrench]) {
        for ((node, lever), sign) in self.nodes.into_iter().zip(posed.levers).zip([-1.0, 1.0]) {
            out[node].force += force * sign;
            out[node].moment += lever.cross(force * sign);
        }
    }

    /// What its tension adds to the linear system of the nodes, for displacements of both in their frames, eq. (28).
    pub fn stiffness(&self, poses: &[Pose], tension: f64) -> Pair {
        let Posed { along, length, .. } = self.at(poses);
        let turns = self.nodes.map(|node| poses[node].rotation.to_matrix());
        let across = (Mat3::IDENTITY - Mat3::outer(along, along)) * (tension / length);
        let mut pair = Pair::default();
        for (i, sign) in [-1.0, 1.0].into_iter().enumerate() {
            for j in 0..2 {
                let same = if i == j { 1.0 } else { -1.0 };
                let p = turns[i].transpose() * across * turns[j] * same;
                let right = times_skew(&p, self.holes[j]);
                // J = [I, −r̂] of both ends.
                pair[i][j] = Block {
                    a: p,
                    b: -right,
                    c: skew_times(self.holes[i], &p),
                    d: -skew_times(self.holes[i], &right),
                };
            }
            // The force stays while the section turns.
            let pull = Mat3::skew(turns[i].transpose_mul(along) * (tension * sign));
            pair[i][i].b += pull;
            pair[i][i].d += skew_times(self.holes[i], &pull);
        }
        pair
    }
}

/// The sum of lengths times tensions in J, where each chord has its tension by its number.
pub(crate) fn work(rod: &Rod, poses: &[Pose], tension: impl Fn(usize) -> f64) -> f64 {
    let chords = rod.chords.iter().enumerate();
    chords.map(|(k, chord)| tension(k) * chord.way(poses).norm()).sum()
}

/// Adds the gradient of the lengths, times tensions, by the places of the nodes and by their turns about themselves.
pub(crate) fn add_node_gradient(
    rod: &Rod,
    poses: &[Pose],
    tension: impl Fn(usize) -> f64,
    out: &mut [Wrench],
) {
    for (k, chord) in rod.chords.iter().enumerate() {
        let tension = tension(k);
        if tension != 0.0 {
            let posed = chord.at(poses);
            chord.add(&posed, posed.along * tension, out);
        }
    }
}

/// The gradient of the lengths, times tensions, by the strains, eq. (27). `pulls` is room for all nodes.
pub(crate) fn gradient(
    rod: &Rod,
    strains: &[Twist],
    poses: &[Pose],
    tension: impl Fn(usize) -> f64,
    pulls: &mut [Wrench],
    out: &mut [Twist],
) {
    pulls.fill(Wrench::default());
    add_node_gradient(rod, poses, tension, pulls);
    pose::work_gradient(rod, strains, poses, |node| pulls[node], out);
}

/// The gradient by the strains of the lengths, times tensions, less the work of dead forces on the nodes.
pub(crate) fn level_gradient(
    rod: &Rod,
    strains: &[Twist],
    poses: &[Pose],
    tension: impl Fn(usize) -> f64,
    force: impl Fn(usize) -> Vec3,
    pulls: &mut [Wrench],
    out: &mut [Twist],
) {
    for (a, pull) in pulls.iter_mut().enumerate() {
        *pull = Wrench { force: -force(a), moment: Vec3::ZERO };
    }
    add_node_gradient(rod, poses, tension, pulls);
    pose::work_gradient(rod, strains, poses, |node| pulls[node], out);
}

/// Room for the second derivative of the lengths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Curvature {
    strains: Vec<Twist>,
    poses: Vec<Pose>,
    pulls: Vec<Wrench>,
    sides: [Vec<Twist>; 2],
}

impl Curvature {
    pub fn new(rod: &Rod) -> Self {
        let list = || vec![Twist::default(); rod.points.len()];
        Self {
            strains: list(),
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
            pulls: vec![Wrench::default(); rod.nodes.len()],
            sides: [list(), list()],
        }
    }

    /// How the gradient by the strains of the lengths times tensions, less the work of dead forces on the nodes, changes along a change of the strains, added to
    /// `out`. A central difference, whose error is about 1e-10 of it.
    pub fn add(
        &mut self,
        rod: &Rod,
        (base, at): (Pose, &[Twist]),
        along: &[Twist],
        tension: impl Fn(usize) -> f64,
        force: impl Fn(usize) -> Vec3,
        out: &mut [Twist],
    ) {
        /// Greatest change of a strain, times the length where it is one of curvature.
        const STEP: f64 = 1e-5;
        let Self { strains, poses, pulls, sides } = self;
        let size = |of: &Twist| of.linear.max_abs().max(of.angular.max_abs() * rod.length);
        let greatest = along.iter().map(size).fold(0.0, f64::max);
        if !(greatest > 0.0 && greatest.is_finite()) {
            return;
        }
        let h = STEP / greatest;
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            for ((strain, at), along) in strains.iter_mut().zip(at).zip(along) {
                *strain = *at + *along * (sign * h);
            }
            pose::nodes(rod, base, strains, poses);
            level_gradient(rod, strains, poses, &tension, &force, pulls, side);
        }
        let [above, below] = sides;
        for ((out, above), below) in out.iter_mut().zip(above).zip(below) {
            *out = *out + (*above - *below) * (0.5 / h);
        }
    }
}
