//! A contact between two bodies, linearised: how the wrenches that it exerts on both change with their motions.
//!
//! The first body is a cross-section of the robot or an obstacle, the second an obstacle. A force F at the point p is a wrench on
//! the first body, about its reference point c, and the opposite one on the second about its centre y. Motions of the first body
//! are differentiated; those of the second follow, because nothing but direction changes when both move together.

use whipcord_numerics::{Pose, Vec3, dot};

use super::body::{Nearest, wrench_of};
use super::differences::{differences as central, one_sided};
use super::friction::Grip;

/// The bodies of a contact that can move, by their numbers in the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bodies {
    pub first: Option<usize>,
    /// With its centre.
    pub second: Option<(usize, Vec3)>,
}

/// What a contact is between its two bodies where they are now.
pub(super) struct TwoBodies<'a, L> {
    pub bodies: Bodies,
    /// Of the first body, at its reference point.
    pub pose: Pose,
    /// The radius in m of a ball about that point that what touches lies in.
    pub reach: f64,
    pub rounding: f64,
    pub nearest: &'a Nearest,
    /// The place that is nearest at another pose of the first body.
    pub look: L,
}

/// How the change of a wrench is found: a step of Newton's method does not need it as exactly as a derivative of the answer.
#[derive(Clone, Copy, Debug)]
pub(super) enum Differences {
    Central,
    OneSided,
}

/// How with each motion of the first body, by m or rad, change its force in N, the lever of what touches in m, and its slip in m.
pub(super) type Rates = [[Vec3; 3]; 6];

/// A unit of force along a line, on one body.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub body: usize,
    /// The force with its moment.
    pub unit: [f64; 6],
    /// How the gap, or the slip along the line, changes with the motion of the body.
    pub rate: [f64; 6],
}

/// A direction in which two bodies push each other: the normal or, where there is friction, a tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// The force of 1 N.
    pub force: Vec3,
    /// The ends of the line; `None` where the body is fixed.
    pub ends: [Option<End>; 2],
    /// The gap, or the slip, in m.
    pub gap: f64,
    /// The force that was, in N.
    pub before: f64,
}

/// How the wrench on one body changes with the motion of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub row: usize,
    pub column: usize,
    pub matrix: [[f64; 6]; 6],
}

impl Line {
    pub fn ends(&self) -> impl Iterator<Item = &End> {
        self.ends.iter().flatten()
    }

    /// How much the gap changes with motions of all bodies.
    pub fn approach(&self, motions: &[f64]) -> f64 {
        let by = |end: &End| dot(&motions[6 * end.body..6 * end.body + 6], &end.rate);
        self.ends().map(by).sum()
    }
}

impl<L: Fn(&Pose) -> Nearest> TwoBodies<'_, L> {
    /// From the second body's centre to the point that touches.
    fn arm(&self, centre: Vec3) -> Vec3 {
        self.pose.position + self.nearest.lever(self.rounding) - centre
    }

    /// The opposite of a unit force, on the second body.
    fn opposite(&self, axis: Vec3, centre: Vec3) -> [f64; 6] {
        wrench_of(axis, self.arm(centre)).map(|component| -component)
    }

    /// The changes of its force in N, its lever in m and its slip in m with each of the first so many motions of the first body, zero with
    /// the others. The grip begins where that body was, carried along with the second.
    pub fn rates(
        &self,
        force: impl Fn(&Nearest, &Pose) -> Vec3,
        grip: Option<&Grip>,
        motions: usize,
        differences: Differences,
    ) -> Rates {
        let see = |pose: &Pose| {
            let nearest = (self.look)(pose);
            let slip = grip.map(|grip| grip.slip_at(pose, &nearest, self.rounding));
            let lever = nearest.lever(self.rounding);
            [force(&nearest, pose), lever, slip.unwrap_or(Vec3::ZERO)]
        };
        match differences {
            Differences::Central => central(motions, &self.pose, self.reach, see),
            Differences::OneSided => {
                // What is nearest may be another place than when it was last looked at.
                let here = if motions > 0 { see(&self.pose) } else { [Vec3::ZERO; 3] };
                one_sided(motions, &self.pose, self.reach, here, see)
            }
        }
    }

    /// Its lines: that of the normal with this force, and those along the surface where there is friction.
    pub fn lines(
        &self,
        force: f64,
        grip: Option<(&Grip, impl IntoIterator<Item = Vec3>)>,
        rates: &Rates,
        lines: &mut Vec<Line>,
    ) {
        let Nearest { normal, gap, .. } = *self.nearest;
        let Bodies { first, second } = self.bodies;
        let unit = self.nearest.push();
        let on_first = first.map(|body| End { body, unit, rate: unit });
        let on_second = second.map(|(body, centre)| {
            let unit = self.opposite(normal, centre);
            End { body, unit, rate: unit }
        });
        lines.push(Line { force: normal, ends: [on_first, on_second], gap, before: force });
        let Some((grip, axes)) = grip else { return };
        for axis in axes {
            let unit = wrench_of(axis, self.nearest.lever(self.rounding));
            let rate = rates.map(|[.., slip]| slip.dot(axis));
            let on_first = first.map(|body| End { body, unit, rate });
            let on_second = second.map(|(body, centre)| {
                let motions = self.carried(centre);
                let rate = core::array::from_fn(|b| {
                    let turns = if b < 3 { 0.0 } else { axis_of(b).cross(grip.slip).dot(axis) };
                    turns - dot(&rate, &motions[b])
                });
                End { body, unit: self.opposite(axis, centre), rate }
            });
            let (gap, before) = (grip.slip.dot(axis), grip.traction.dot(axis));
            lines.push(Line { force: axis, ends: [on_first, on_second], gap, before });
        }
    }

    fn carried(&self, centre: Vec3) -> [[f64; 6]; 6] {
        carried(self.pose.position - centre)
    }

    /// `∂W/∂X` of what it exerts on both bodies: of this force on the first one, of which a part turns with both.
    pub fn geometric(
        &self,
        (total, turning): (Vec3, Vec3),
        rates: &Rates,
        blocks: &mut Vec<Block>,
    ) {
        let Bodies { first, second } = self.bodies;
        let lever = self.nearest.lever(self.rounding);
        let by_first = rates.map(|[force, lever, _]| [force, lever]);
        let mut columns = [[[0.0; 6]; 6]; 2];
        let mut add = |column: usize, turned: [[Vec3; 2]; 6], own: bool| {
            for (b, [change, l]) in turned.into_iter().enumerate() {
                let moment = l.cross(total) + lever.cross(change);
                put(&mut columns[0], b, change, moment);
                let Some((_, centre)) = second else { continue };
                // What touches moves beside the centre of the second body.
                let shift = if b < 3 { axis_of(b) } else { Vec3::ZERO };
                let beside = if own { l + shift } else { l - shift };
                let moment = beside.cross(total) + self.arm(centre).cross(change);
                put(&mut columns[1], b, -change, -moment);
            }
            for (row, matrix) in [first, second.map(|(body, _)| body)].into_iter().zip(columns) {
                blocks.extend(row.map(|row| Block { row, column, matrix }));
            }
        };
        if let Some(body) = first {
            add(body, by_first, true);
        }
        if let Some((body, centre)) = second {
            let carried = self.carried(centre);
            let turned = core::array::from_fn(|b| {
                let axis = if b < 3 { Vec3::ZERO } else { axis_of(b) };
                let mut sum = [axis.cross(turning), axis.cross(lever)];
                for (c, part) in carried[b].into_iter().enumerate() {
                    sum[0] -= by_first[c][0] * part;
                    sum[1] -= by_first[c][1] * part;
                }
                sum
            });
            add(body, turned, false);
        }
    }
}

/// The motion of a point that each motion of a body about its centre carries it through, at this place beside the centre.
pub(super) fn carried(beside: Vec3) -> [[f64; 6]; 6] {
    core::array::from_fn(|b| {
        if b < 3 {
            return core::array::from_fn(|a| if a == b { 1.0 } else { 0.0 });
        }
        let axis = axis_of(b);
        let moved = axis.cross(beside);
        [moved.x, moved.y, moved.z, axis.x, axis.y, axis.z]
    })
}

/// Writes a column of a matrix of wrenches.
pub(super) fn put(matrix: &mut [[f64; 6]; 6], column: usize, force: Vec3, moment: Vec3) {
    for a in 0..3 {
        matrix[a][column] = force[a];
        matrix[3 + a][column] = moment[a];
    }
}

/// The axis of the motion of this number: three displacements, then three rotations.
pub(super) fn axis_of(motion: usize) -> Vec3 {
    let mut axis = [0.0; 3];
    axis[motion % 3] = 1.0;
    Vec3::from(axis)
}
