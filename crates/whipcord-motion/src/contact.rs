//! One contact of a robot in motion: where it touches, with what force, and what that changes by.

use whipcord::contact::body::{Nearest, along, tangents};
use whipcord::contact::complementarity;
use whipcord::contact::member::Member;
use whipcord_numerics::{Mat3, Pose, Twist, UnitQuaternion, Vec3};

use crate::block::{Block, dot};
use crate::cross_section::{Posed, Station};
use crate::element::{NODES, POINTS};
use crate::scheme::Scheme;
use crate::surroundings::Near;

/// A part of the robot near an obstacle, and the force between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub obstacle: usize,
    pub member: Member,
    pub station: Station,
    pub shapes: [f64; NODES],
    pub keeps_place: bool,
    /// Coefficient of friction.
    pub coefficient: f64,
    /// How its place was looked for along the backbone; `None` where it is a place of the robot.
    pub search: Option<Search>,
    /// Pose of the cross-section at the start of the step.
    pub start: Pose,
    /// Gap in m at the start of the step, and of which place of the section, in its axes x and y.
    pub start_gap: f64,
    pub start_place: [f64; 2],
    /// Least gap in m at the end of the step: what overlapped at its start is pushed out slowly.
    pub least: f64,
    /// At the end of the step.
    pub nearest: Nearest,
    /// How far what touches has slid in the step, in m.
    pub slip: Vec3,
    /// Derivative of the normal by the place, in 1/m.
    pub bend: Mat3,
    /// Centre of the cross-section at the end of the step.
    pub centre: Vec3,
    /// Rotation of the cross-section at the end of the step, and at the stage.
    pub at_end: UnitQuaternion,
    pub at_stage: UnitQuaternion,
    /// Along the normal, in N.
    pub force: f64,
    /// Along the surface, in N.
    pub traction: Vec3,
    pub sticks: bool,
}

/// How the place of a contact was looked for along the backbone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// How far beside it in m the gap is as large on both sides.
    pub beside: f64,
    /// The round of the step behind which it was looked for at its end; at the start of the step where there is none.
    pub round: Option<usize>,
}

/// A line of the complementarity problem: a unit force and where it acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub direction: Vec3,
    /// From the centre of the cross-section, in m.
    pub lever: Vec3,
    /// Gap or slip in m.
    pub value: f64,
}

/// Contacts at which the surface is bent more than by this part of the length are taken as if it were bent by that.
const SHARPEST: f64 = 1e-4;

impl Contact {
    pub fn new(
        near: &Near,
        obstacle: &whipcord::Obstacle,
        at_start: &Posed<'_>,
        round: Option<usize>,
    ) -> Self {
        let start = at_start.at(near.station);
        let body = &near.member.body;
        let start_gap = body.at_place(obstacle, &start, near.nearest.local).gap;
        Self {
            obstacle: near.obstacle,
            member: near.member,
            station: near.station,
            shapes: near.station.shapes(),
            keeps_place: near.keeps_place,
            coefficient: obstacle.friction,
            search: near.beside.map(|beside| Search { beside, round }),
            start,
            start_gap,
            start_place: near.nearest.local,
            least: 0.0,
            nearest: near.nearest,
            slip: Vec3::ZERO,
            bend: Mat3::ZERO,
            centre: start.position,
            at_end: start.rotation,
            at_stage: start.rotation,
            force: 0.0,
            traction: Vec3::ZERO,
            sticks: false,
        }
    }

    /// Finds the place that is nearest, for a pose of the cross-section.
    pub fn look(&mut self, obstacle: &whipcord::Obstacle, pose: &Pose) {
        let body = &self.member.body;
        self.nearest = if self.keeps_place {
            body.at_place(obstacle, pose, self.nearest.local)
        } else {
            body.track(obstacle, pose, self.nearest.local)
        };
        self.traction = along(self.traction, self.nearest.normal);
    }

    /// Rate in m/s at which the gap grows at the start of the step, where the nodes have these velocities.
    pub fn start_rate(&self, velocities: &[Twist]) -> f64 {
        let push = in_section(self.start.rotation, self.nearest.normal, self.nearest.arm);
        dot(&push, &self.velocity(velocities))
    }

    /// Velocity of its cross-section, where the nodes have these velocities.
    pub fn velocity(&self, velocities: &[Twist]) -> Twist {
        let nodes = &velocities[POINTS * self.station.element..];
        let weighted = nodes.iter().zip(self.shapes);
        weighted.fold(Twist::default(), |sum, (velocity, f)| sum + *velocity * f)
    }

    /// Has it slide without friction.
    pub const fn leave_friction_out(&mut self) {
        (self.coefficient, self.traction, self.sticks) = (0.0, Vec3::ZERO, false);
    }

    /// Lines of the complementarity problem: of the normal, and of both tangents with friction.
    pub const fn lines(&self) -> usize {
        if self.coefficient > 0.0 { 3 } else { 1 }
    }

    /// As the complementarity problem has it, from a line on.
    pub const fn problem(&self, first: usize) -> complementarity::Contact {
        complementarity::Contact {
            first,
            coefficient: self.coefficient,
            touches: self.force > 0.0,
            sticks: self.sticks,
        }
    }

    pub fn line(&self, line: usize) -> Line {
        let normal = self.nearest.normal;
        if line == 0 {
            return Line {
                direction: normal,
                lever: self.nearest.arm,
                value: self.nearest.gap - self.least,
            };
        }
        let direction = tangents(normal)[line - 1];
        let lever = self.nearest.lever(self.member.body.rounding);
        Line { direction, lever, value: self.slip.dot(direction) }
    }

    /// The forces in the lines in N.
    pub fn forces(&self) -> [f64; 3] {
        let [x, y] = tangents(self.nearest.normal).map(|t| t.dot(self.traction));
        [self.force, x, y]
    }

    /// Takes over forces in the lines.
    pub fn take(&mut self, forces: &[f64], sticks: bool) {
        self.force = forces[0];
        self.traction = Vec3::ZERO;
        if let [_, x, y] = *forces {
            let [a, b] = tangents(self.nearest.normal);
            self.traction = a * x + b * y;
        }
        self.sticks = sticks && self.force > 0.0;
    }

    /// Force and moment on the section at the stage, in its frame.
    pub fn push(&self) -> Twist {
        let lever = self.nearest.lever(self.member.body.rounding);
        in_section(self.at_stage, self.nearest.normal * self.force, self.nearest.arm)
            + in_section(self.at_stage, self.traction, lever)
    }

    /// What the push changes by with the velocity of the section: the section turns, and the normal changes with the place.
    pub fn stiffness(&self, scheme: &Scheme) -> Block {
        let back = |v: Vec3| self.at_stage.conjugate().rotate(v);
        let force = back(self.nearest.normal * self.force + self.traction);
        let columns = [Vec3::X, Vec3::Y, Vec3::Z]
            .map(|axis| back(self.bend * self.at_stage.rotate(axis)) * self.force);
        let by_place = Mat3::from_columns(columns[0], columns[1], columns[2]);
        let push = self.push();
        Block {
            a: by_place * (scheme.g / scheme.place),
            b: Mat3::skew(force) * scheme.g,
            c: Mat3::ZERO,
            d: Mat3::skew(push.angular) * scheme.g,
        }
    }
}

/// A force that acts with a lever, with its moment, in the frame of a section; of a unit force also what a motion of the section moves it along by.
pub(crate) fn in_section(rotation: UnitQuaternion, force: Vec3, lever: Vec3) -> Twist {
    let back = rotation.conjugate();
    Twist { linear: back.rotate(force), angular: back.rotate(lever.cross(force)) }
}

/// Derivative of the normal of an obstacle by the place, by central differences.
pub(crate) fn bend(obstacle: &whipcord::Obstacle, place: Vec3, length: f64) -> Mat3 {
    let h = 1e-6 * length;
    let column = |axis: Vec3| {
        (obstacle.surface(place + axis * h).normal - obstacle.surface(place - axis * h).normal)
            * (0.5 / h)
    };
    let m = Mat3::from_columns(column(Vec3::X), column(Vec3::Y), column(Vec3::Z));
    let symmetric = (m + m.transpose()) * 0.5;
    let largest = (0..3).map(|j| symmetric.column(j).max_abs()).fold(0.0, f64::max);
    symmetric * (1.0 / (SHARPEST * length * largest).max(1.0))
}
