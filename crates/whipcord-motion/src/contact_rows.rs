//! The equations of contacts beside the linearised stage, for derivatives over motions, section "Gradients" of the page on motion.
//!
//! Each contact that pushes has its push on the section as six unknowns and its forces in the lines as further ones, so that a push may change with the pose of the section
//! as stiffly as it will.

use whipcord::Obstacle;
use whipcord::contact::body::{along, tangents};
use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use crate::block::{add, sum};
use crate::by_shape::ByShape;
use crate::contact::{Contact, in_section};
use crate::contacts::{Contacts, OUTWARD};
use crate::cross_section::{MOTIONS, Posed, Station, displaced, unit};
use crate::element::{NODES, POINTS};
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// A slip below this part of the length has no direction.
const LEAST_SLIP: f64 = 1e-13;

/// An equation: what it has for changes of the strains of the stage, of those at the start of the step, of the base, of the length of the step, of the place that touches and of the
/// unknowns of the contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactRow {
    pub stage: Vec<Twist>,
    pub start: Vec<Twist>,
    /// By displacements of the base at the start of the step, at the stage and at the end.
    pub bases: [Twist; 3],
    pub by_length: f64,
    /// By the arc length of the place, and the number of its contact.
    pub by_place: f64,
    pub contact: usize,
    pub unknowns: Vec<(usize, f64)>,
}

/// All equations, as many as unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactRows {
    pub rows: Vec<ContactRow>,
    /// The unknowns that are a component of a push on a section, each with the nodes that bear it and their weights.
    pub pushes: Vec<Push>,
    /// What each contact that pushes exerts where its place moves along the rod.
    pub shifts: Vec<PushShift>,
}

/// What a push exerts on the nodes of its element where its place moves by 1 m along the rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PushShift {
    pub contact: usize,
    element: usize,
    forces: [Twist; NODES],
}

impl PushShift {
    /// Adds it, times a factor, to what the equations of motion lack.
    pub fn add(&self, out: &mut [Twist], factor: f64) {
        add(&mut out[POINTS * self.element..][..NODES], &self.forces, -factor);
    }

    /// What the equations lack times multipliers.
    pub fn work(&self, on: &[Twist]) -> f64 {
        -sum(&self.forces, &on[POINTS * self.element..][..NODES])
    }
}

/// A unit push along or about an axis of a section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub unknown: usize,
    axis: usize,
    station: Station,
}

/// What a contact does at a pose of its section.
#[derive(Default)]
struct Doing {
    /// Gap, then the slip along both tangents.
    lines: [f64; 3],
    push: Twist,
}

/// A contact with the forces in its lines held, at poses of its section.
#[derive(Clone, Copy)]
struct Held<'a> {
    contact: Contact,
    obstacle: &'a Obstacle,
    tangents: [Vec3; 2],
    forces: [f64; 3],
}

fn component(of: &Twist, i: usize) -> f64 {
    if i < 3 { of.linear[i] } else { of.angular[i - 3] }
}

impl Held<'_> {
    fn at(&self, start: &Pose, end: &Pose) -> Doing {
        let mut contact = self.contact;
        contact.start = *start;
        contact.look(self.obstacle, end);
        let (nearest, rounding) = (contact.nearest, contact.member.body.rounding);
        let basis = self.tangents.map(|of| along(of, nearest.normal));
        contact.force = self.forces[0];
        contact.traction = basis[0] * self.forces[1] + basis[1] * self.forces[2];
        let slip = nearest.slip(start, end, rounding);
        let least = match contact.least < 0.0 {
            true => contact.member.body.at_place(self.obstacle, start, contact.start_place).gap,
            false => 0.0,
        };
        let [x, y] = basis.map(|of| of.dot(slip));
        Doing { lines: [nearest.gap - least, x, y], push: contact.push() }
    }
}

impl Push {
    /// What it adds to the residual of the equations of motion.
    pub fn add(&self, out: &mut [Twist]) {
        for (a, f) in self.station.shapes().into_iter().enumerate() {
            let node = POINTS * self.station.element + a;
            out[node] = out[node] - unit(self.axis) * f;
        }
    }

    /// The same times multipliers.
    pub fn work(&self, on: &[Twist]) -> f64 {
        let nodes = &on[POINTS * self.station.element..];
        let of = |(f, on): (f64, &Twist)| -f * component(on, self.axis);
        self.station.shapes().into_iter().zip(nodes).map(of).sum()
    }
}

impl Contacts {
    /// The linearised equations of all contacts that push at the stage that is solved, in the state each of them has.
    pub fn rows(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) -> ContactRows {
        let mut out = ContactRows::default();
        if !self.list.iter().any(|contact| contact.force > 0.0) {
            return out;
        }
        self.refresh(rod, scheme, stage);
        let mut start_poses = vec![Pose::IDENTITY; rod.nodes.len()];
        pose::nodes(rod, self.start_base, &stage.start, &mut start_poses);
        let (strains, poses) = self.end();
        let end = Posed { rod, strains, poses };
        let start = Posed { rod, strains: &stage.start, poses: &start_poses };
        let at_stage = Posed { rod, strains: &stage.strains, poses: &stage.poses };
        let Some(surroundings) = &self.surroundings else { return out };
        let touching = self.list.iter().enumerate().filter(|(_, contact)| contact.force > 0.0);
        for (number, contact) in touching {
            let held = Held {
                contact: *contact,
                obstacle: &surroundings.obstacles[contact.obstacle],
                tangents: tangents(contact.nearest.normal),
                forces: contact.forces(),
            };
            out.add(&held, number, scheme, (&start, &end, &at_stage));
        }
        out
    }

    /// How far the contacts of the step that was solved last are from another state, in relative terms: a gap or slip as a part of the length, a force as a part of EI/L², and a traction as a
    /// part of its bound.
    pub fn margin(&self, rod: &Rod) -> f64 {
        let unit = rod.points[0].stiffness.d.rows[0].x / (rod.length * rod.length);
        let of = |contact: &Contact| {
            let gap = (contact.nearest.gap - contact.least).abs() / rod.length;
            if contact.force <= 0.0 {
                return gap;
            }
            let most = contact.coefficient * contact.force;
            let way = match (contact.lines(), contact.sticks) {
                (1, _) => f64::INFINITY,
                (_, true) => 1.0 - contact.traction.norm() / most,
                (_, false) => contact.slip.norm() / rod.length,
            };
            way.min(contact.force / unit)
        };
        self.list.iter().map(of).fold(f64::INFINITY, f64::min)
    }
}

impl ContactRows {
    pub fn unknowns(&self) -> usize {
        self.rows.len()
    }

    fn add(
        &mut self,
        held: &Held<'_>,
        number: usize,
        scheme: &Scheme,
        (start, end, stage): (&Posed<'_>, &Posed<'_>, &Posed<'_>),
    ) {
        let contact = &held.contact;
        let (station, length) = (contact.station, end.rod.length);
        let poses = [start, end].map(|shape| shape.at(station));
        // How lines and push change with displacements of the section at the start and at the end of the step.
        let changes: [[Doing; MOTIONS]; 2] = [0, 1].map(|which| {
            core::array::from_fn(|axis| {
                let step = if axis < 3 { 1e-6 * length } else { 1e-6 };
                let at = |by: f64| {
                    let mut of = poses;
                    of[which] = displaced(&of[which], axis, by);
                    held.at(&of[0], &of[1])
                };
                let (above, below) = (at(step), at(-step));
                let per = 0.5 / step;
                Doing {
                    lines: [0, 1, 2].map(|i| (above.lines[i] - below.lines[i]) * per),
                    push: (above.push - below.push) * per,
                }
            })
        });
        // The same with the arc length of the place, where it was looked for.
        let by_place = contact.search.map(|_| {
            let h = 1e-6 * length;
            let at = |by: f64| {
                let place = Station::at(end.rod, station.arc_length(end.rod) + by);
                let [start, end, stage] = [start, end, stage].map(|shape| shape.at(place));
                let mut held = Held { contact: held.contact, ..*held };
                held.contact.at_stage = stage.rotation;
                held.at(&start, &end)
            };
            let (above, below) = (at(h), at(-h));
            Doing {
                lines: [0, 1, 2].map(|i| (above.lines[i] - below.lines[i]) * (0.5 / h)),
                push: (above.push - below.push) * (0.5 / h),
            }
        });
        if by_place.is_some() {
            let push = contact.push();
            let forces = station.slopes(end.rod).map(|slope| push * slope);
            let element = station.element;
            self.shifts.push(PushShift { contact: number, element, forces });
        }
        let by_place = by_place.unwrap_or_default();
        let along_line = |which: usize, line: usize| {
            let of: [f64; MOTIONS] = core::array::from_fn(|axis| changes[which][axis].lines[line]);
            wrench(of)
        };
        let first = self.rows.len();
        let line_unknown = |line: usize| first + MOTIONS + line;
        let rotation: UnitQuaternion = contact.at_stage;
        let now = contact.push();
        let world = |of: Vec3| rotation.rotate(of);
        for axis in 0..MOTIONS {
            let of_end: [f64; MOTIONS] =
                core::array::from_fn(|by| -component(&changes[1][by].push, axis));
            // The push is constant while the section turns at the stage.
            let part = if axis < 3 { now.linear } else { now.angular };
            let turning = world(unit(axis % 3).linear).cross(world(part)) * -1.0;
            let of_stage = Twist { linear: Vec3::ZERO, angular: turning };
            let mut row = ContactRow {
                unknowns: vec![(first + axis, 1.0)],
                by_place: -component(&by_place.push, axis),
                contact: number,
                ..Default::default()
            };
            let by_line = [
                in_section(rotation, contact.nearest.normal, contact.nearest.arm),
                in_section(rotation, held.tangents[0], lever(contact)),
                in_section(rotation, held.tangents[1], lever(contact)),
            ];
            for (line, by) in by_line.iter().enumerate().take(contact.lines()) {
                row.unknowns.push((line_unknown(line), -component(by, axis)));
            }
            row.take_end(scheme, &ByShape::of_section(end, station, wrench(of_end)));
            let turned = ByShape::of_section(stage, station, of_stage);
            add(&mut row.stage, &turned.strains, 1.0);
            row.bases[1] = turned.base;
            self.rows.push(row);
            self.pushes.push(Push { unknown: first + axis, axis, station });
        }
        let line_row = |weights: &[(usize, f64)]| {
            let sum = |which: usize| {
                weights
                    .iter()
                    .fold(Twist::default(), |sum, (line, by)| sum + along_line(which, *line) * *by)
            };
            let of_place = weights.iter().map(|(line, by)| by_place.lines[*line] * by).sum();
            let mut row =
                ContactRow { by_place: of_place, contact: number, ..ContactRow::default() };
            row.take_end(scheme, &ByShape::of_section(end, station, sum(1)));
            let at_start = ByShape::of_section(start, station, sum(0));
            add(&mut row.start, &at_start.strains, 1.0);
            row.bases[0] = at_start.base;
            row
        };
        let mut gap = line_row(&[(0, 1.0)]);
        if contact.least < 0.0 {
            gap.by_length = -OUTWARD * length;
        }
        self.rows.push(gap);
        if contact.lines() == 1 {
            return;
        }
        let [_, x, y] = held.at(&poses[0], &poses[1]).lines;
        let size = x.hypot(y);
        if contact.sticks || size < LEAST_SLIP * length {
            self.rows.push(line_row(&[(1, 1.0)]));
            self.rows.push(line_row(&[(2, 1.0)]));
            return;
        }
        // The traction is μ times the force, against the slip.
        let way = [x / size, y / size];
        for k in 0..2 {
            let grip = contact.coefficient * contact.force / size;
            let own = |j: usize| if j == k { 1.0 } else { 0.0 };
            let weights = [0, 1].map(|j| (j + 1, grip * (own(j) - way[k] * way[j])));
            let mut row = line_row(&weights);
            row.unknowns.push((line_unknown(k + 1), 1.0));
            row.unknowns.push((line_unknown(0), contact.coefficient * way[k]));
            self.rows.push(row);
        }
    }
}

fn wrench([a, b, c, d, e, f]: [f64; MOTIONS]) -> Twist {
    Twist { linear: Vec3::new(a, b, c), angular: Vec3::new(d, e, f) }
}

fn lever(contact: &Contact) -> Vec3 {
    contact.nearest.lever(contact.member.body.rounding)
}

impl ContactRow {
    /// Takes what it has for changes of the strains at the end of the step.
    fn take_end(&mut self, scheme: &Scheme, end: &ByShape) {
        let by_stage = 1.0 / scheme.place;
        self.stage = end.strains.iter().map(|of| *of * by_stage).collect();
        self.start = end.strains.iter().map(|of| *of * (1.0 - by_stage)).collect();
        self.bases[2] = end.base;
    }

    /// What it has for displacements of the base.
    pub fn by_bases(&self, bases: &[Twist; 3]) -> f64 {
        sum(&self.bases, bases)
    }

    /// What it has for changes of the strains of the stage.
    pub fn by_stage(&self, strains: &[Twist]) -> f64 {
        sum(&self.stage, strains)
    }

    /// What it has for changes of the strains at the start of the step.
    pub fn by_start(&self, strains: &[Twist]) -> f64 {
        sum(&self.start, strains)
    }
}
