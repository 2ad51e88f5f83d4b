//! Derivatives of a number by the shape of the rod.

use whipcord::Wrench;
use whipcord_numerics::Twist;

use crate::block::{add, dot, sum};
use crate::cross_section::{MOTIONS, Posed, Station, unit};
use crate::element::{POINTS, pose_at};
use crate::pose;
use crate::rod::Rod;

/// Derivatives of a number by the strains, and by displacements of the base along and about its own axes.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByShape {
    pub strains: Vec<Twist>,
    pub base: Twist,
}

impl ByShape {
    /// Of a number that does not depend on the shape.
    pub fn none(rod: &Rod) -> Self {
        Self { strains: vec![Twist::default(); rod.points.len()], base: Twist::default() }
    }

    /// Of the displacement of a section along a wrench, in the frame that the poses are given in.
    pub fn of_section(shape: &Posed<'_>, station: Station, along: Twist) -> Self {
        let base = shape.poses[0];
        let turn = base.rotation.conjugate();
        let arm = shape.at(station).position - base.position;
        Self {
            strains: gradient(shape, station, along),
            base: Twist {
                linear: turn.rotate(along.linear),
                angular: turn.rotate(along.angular + arm.cross(along.linear)),
            },
        }
    }

    pub fn add(&mut self, other: &Self, factor: f64) {
        add(&mut self.strains, &other.strains, factor);
        self.base = self.base + other.base * factor;
    }

    /// What the number changes by.
    pub fn times(&self, strains: &[Twist], base: &Twist) -> f64 {
        sum(&self.strains, strains) + dot(&self.base, base)
    }
}

/// The gradient by the strains of the displacement of a section along a wrench, in the frame that the poses are given in.
fn gradient(shape: &Posed<'_>, station: Station, along: Twist) -> Vec<Twist> {
    let Posed { rod, strains, poses } = *shape;
    let mut out = vec![Twist::default(); strains.len()];
    let (e, h) = (station.element, rod.lengths[station.element]);
    let (q, x) = (POINTS * e, station.fraction);
    // From the last node before it on.
    let from = q + if x < 0.5 {
        0
    } else if x < 1.0 {
        1
    } else {
        2
    };
    let place = shape.at(station).position;
    let moment = along.angular + (place - poses[from].position).cross(along.linear);
    let wrench = |node: usize| match node == from {
        true => Wrench { force: along.linear, moment },
        false => Wrench::default(),
    };
    pose::work_gradient(rod, strains, poses, wrench, &mut out);
    if x == 0.0 || x == 0.5 || x == 1.0 {
        return out;
    }
    let own = [strains[q], strains[q + 1]];
    for k in 0..POINTS {
        for axis in 0..MOTIONS {
            let step = if axis < 3 { 1e-6 } else { 1e-6 / rod.length };
            let at = |by: f64| {
                let mut points = own;
                points[k] = points[k] + unit(axis) * by;
                pose_at(&poses[q..], &points, h, x)
            };
            let (above, below) = (at(step), at(-step));
            let shift = (above.position - below.position) * (0.5 / step);
            let turn = (above.rotation * below.rotation.conjugate()).log() * (0.5 / step);
            let change = along.linear.dot(shift) + along.angular.dot(turn);
            out[q + k] = out[q + k] + unit(axis) * change;
        }
    }
    out
}
