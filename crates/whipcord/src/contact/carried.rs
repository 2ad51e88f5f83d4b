//! The movable objects of an answer, linearised: they move so that their balance stays.
//!
//! Besides the motions `X` of the cross-sections and the forces `f` of eq. (10) the motions `Y` of the objects are unknown, with the
//! balance of each as equations:
//!
//! ```text
//! X − C (G_XX X + G_XY Y + B_X f) = X₀,   G_YX X + G_YY Y + B_Y f = 0,   R_X X + R_Y Y = 0     (18)
//! ```
//!
//! In directions that nothing determines an object stays where it is, by a stiffness far below that of the robot.

use whipcord_numerics::{DenseLu, Pose, Vec3, dot};

use super::body::{Nearest, wrench_of};
use super::friction::Grip;
use super::held_contact::{ABOUT_TO_CHANGE, Unknown, is_near_change};
use super::model::Compliant;
use super::object::Objects;
use super::pair::Pair;
use super::scene::Scene;
use super::step::of_objects;
use super::two_bodies::{Block, Differences, End, axis_of, carried, put};
use crate::derivatives::ContactGain;
use crate::statics::hold::Critical;

/// The stiffness that keeps an object, relative to that of the robot.
const STIFFNESS: f64 = 1e-9;

/// Movable objects, whose numbers follow those of the contacts of the robot.
#[derive(Clone, Debug, Default)]
pub(super) struct Carried {
    count: usize,
    /// How the wrenches on robot and objects change with motions, but for those of cross-sections on themselves.
    blocks: Vec<Block>,
    /// The ends on objects of the unknowns of the robot's contacts, and both ends of those of other contacts.
    ends: Vec<(usize, End)>,
    /// How many unknowns there are.
    unknowns: usize,
    stiffness: Vec<[f64; 6]>,
    /// In kg.
    masses: Vec<f64>,
    pub is_about_to_change: bool,
}

impl Carried {
    /// Of the contacts of the robot, with what they push and how that changes, and of those of objects with obstacles.
    pub fn new(
        (geometric, unknowns): (&[[[f64; 6]; 6]], &[Unknown]),
        touching: &[Pair],
        objects: &Objects,
        (model, scene): (&impl Compliant, &Scene),
        length: f64,
    ) -> Self {
        let contacts = touching.len();
        let scale = model.force_scale();
        let mut all = Self {
            count: objects.count(),
            unknowns: unknowns.len(),
            stiffness: (objects.list.iter())
                .map(|object| {
                    let straight = STIFFNESS * scale / length;
                    let turning = straight * object.reach * object.reach;
                    core::array::from_fn(|a| if a < 3 { straight } else { turning })
                })
                .collect(),
            masses: (objects.list.iter())
                .map(|object| scene.get(object.number).movable.map_or(0.0, |body| body.mass))
                .collect(),
            ..Self::default()
        };
        if all.is_empty() {
            return all;
        }
        for (k, pair) in touching.iter().enumerate() {
            let Some(object) = objects.of(pair.obstacle) else { continue };
            let centre = model.pose(pair.member.arc_length).position;
            let beside = centre - objects.list[object].pose.position;
            all.add_robot((k, contacts + object), beside, &pair.push(), &geometric[k]);
            for (number, unknown) in unknowns.iter().enumerate().filter(|(_, u)| u.contact == k) {
                let motions = carried(beside);
                let rate = core::array::from_fn(|b| -dot(&unknown.rate, &motions[b]));
                let unit = opposite(&unknown.push, beside);
                all.ends.push((number, End { body: contacts + object, unit, rate }));
            }
        }
        for pair in &objects.near {
            let state = (pair.nearest.gap, pair.force, pair.grip);
            all.is_about_to_change |= is_near_change(state, ABOUT_TO_CHANGE, scale, length);
            if pair.force <= 0.0 {
                continue;
            }
            let contact = of_objects(pair, (scene, objects), contacts);
            let traction = |normal: Vec3| {
                let Some(grip) = &pair.grip else { return Vec3::ZERO };
                let along = grip.traction - normal * normal.dot(grip.traction);
                let part = if grip.sticks { 1.0 } else { grip.traction.norm() / along.norm() };
                if part.is_finite() { along * part } else { Vec3::ZERO }
            };
            let force = |nearest: &Nearest| nearest.normal * pair.force + traction(nearest.normal);
            contact.geometric(force, pair.total(), 6, Differences::Central, &mut all.blocks);
            // From the answer on.
            let from: Pose = contact.pose;
            let sticking = pair.grip.filter(|grip| grip.sticks);
            let sticking = sticking.map(|grip| Grip { from, slip: Vec3::ZERO, ..grip });
            let mut lines = Vec::new();
            contact.lines(pair.force, sticking.as_ref(), &mut lines);
            for (number, line) in lines.iter().enumerate() {
                for mut end in line.ends().copied() {
                    // What slides bears along the surface in proportion.
                    if let Some(grip) = pair.grip.filter(|grip| number == 0 && !grip.sticks) {
                        let body = objects.list[end.body - contacts];
                        let is_owner = objects.list[end.body - contacts].number == pair.owner;
                        let side = if is_owner { 1.0 } else { -1.0 };
                        let along = grip.traction * (side / pair.force);
                        let wrench = wrench_of(along, pair.point - body.pose.position);
                        end.unit.iter_mut().zip(wrench).for_each(|(sum, by)| *sum += by);
                    }
                    all.ends.push((all.unknowns, end));
                }
                all.unknowns += 1;
            }
        }
        all
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// What a contact of the robot adds: of what it pushes with and how that changes with the cross-section, how it changes with the
    /// object, and what the object is pushed with changes with both; `beside` is from the centre of the object to that of the
    /// cross-section.
    fn add_robot(
        &mut self,
        (contact, object): (usize, usize),
        beside: Vec3,
        push: &[f64; 6],
        geometric: &[[f64; 6]; 6],
    ) {
        let part = |v: &[f64; 6], from: usize| Vec3::new(v[from], v[from + 1], v[from + 2]);
        let (force, moment) = (part(push, 0), part(push, 3));
        let change = |motion: &[f64; 6]| {
            let column: [f64; 6] = core::array::from_fn(|a| dot(&geometric[a], motion));
            [part(&column, 0), part(&column, 3)]
        };
        let motions = carried(beside);
        let mut columns = [[[0.0; 6]; 6]; 3];
        for b in 0..6 {
            let mut own = [0.0; 6];
            own[b] = 1.0;
            let (shift, axis) =
                if b < 3 { (axis_of(b), Vec3::ZERO) } else { (Vec3::ZERO, axis_of(b)) };
            let [f, m] = change(&own);
            put(&mut columns[0], b, -f, -(m + beside.cross(f) + shift.cross(force)));
            let [df, dm] = change(&motions[b]);
            let (f, m) = (axis.cross(force) - df, axis.cross(moment) - dm);
            put(&mut columns[1], b, f, m);
            put(&mut columns[2], b, -f, -(m + beside.cross(f) - shift.cross(force)));
        }
        let places = [(object, contact), (contact, object), (object, object)];
        for ((row, column), matrix) in places.into_iter().zip(columns) {
            self.blocks.push(Block { row, column, matrix });
        }
    }

    /// How the pushes of the robot's contacts change with the motions that something else would cause without them, and with gravity.
    pub fn gain(
        &self,
        n: usize,
        (geometric, unknowns): (&[[[f64; 6]; 6]], &[Unknown]),
        compliance: &[f64],
    ) -> Result<ContactGain, Critical> {
        let moving = n + 6 * self.count;
        let size = moving + self.unknowns;
        // How the wrenches on all change with all unknowns.
        let mut wrenches = vec![0.0; moving * size];
        let of_robot = geometric.iter().enumerate();
        let of_robot = of_robot.map(|(k, matrix)| Block { row: k, column: k, matrix: *matrix });
        for Block { row, column, matrix } in of_robot.chain(self.blocks.iter().copied()) {
            for (a, of) in matrix.iter().enumerate() {
                for (b, value) in of.iter().enumerate() {
                    wrenches[(6 * row + a) * size + 6 * column + b] += value;
                }
            }
        }
        let ends = unknowns.iter().enumerate().map(|(number, unknown)| {
            let &Unknown { contact, push, rate, .. } = unknown;
            (number, End { body: contact, unit: push, rate })
        });
        let ends: Vec<(usize, End)> = ends.chain(self.ends.iter().copied()).collect();
        let mut matrix = vec![0.0; size * size];
        for (number, end) in &ends {
            let column = moving + number;
            for a in 0..6 {
                wrenches[(6 * end.body + a) * size + column] += end.unit[a];
                matrix[column * size + 6 * end.body + a] += end.rate[a];
            }
        }
        for (number, unknown) in unknowns.iter().enumerate() {
            matrix[(moving + number) * size + moving + number] = unknown.own;
        }
        for i in 0..n {
            for (k, &c) in compliance[i * n..(i + 1) * n].iter().enumerate() {
                let of = &wrenches[k * size..(k + 1) * size];
                matrix[i * size..(i + 1) * size].iter_mut().zip(of).for_each(|(m, w)| *m -= c * w);
            }
            matrix[i * size + i] += 1.0;
        }
        for (object, stiffness) in self.stiffness.iter().enumerate() {
            for (a, stiffness) in stiffness.iter().enumerate() {
                let i = n + 6 * object + a;
                matrix[i * size..(i + 1) * size]
                    .copy_from_slice(&wrenches[i * size..(i + 1) * size]);
                matrix[i * size + i] -= stiffness;
            }
        }
        // Contacts that depend on one another share what they carry.
        for number in unknowns.len()..self.unknowns {
            let i = moving + number;
            matrix[i * size + i] += SHARING / self.stiffness[0][0];
        }
        let mut lu = DenseLu::default();
        lu.factor(size, &matrix).map_err(|_| Critical)?;
        let by_rows = |columns: &[Vec<f64>]| -> Vec<f64> {
            let row = |i: usize| &wrenches[i * size..(i + 1) * size];
            (0..n).flat_map(|i| columns.iter().map(move |column| dot(row(i), column))).collect()
        };
        let weighed = |axis: usize| {
            let mut column = vec![0.0; size];
            for (object, mass) in self.masses.iter().enumerate() {
                column[n + 6 * object + axis] = -mass;
            }
            lu.solve(&mut column);
            column
        };
        let by_gravity = by_rows(&[0, 1, 2].map(weighed));
        let by_motion = by_rows(&lu.inverse_columns(n));
        let is_finite = by_motion.iter().chain(&by_gravity).all(|x| x.is_finite());
        let gain = ContactGain { by_motion, by_gravity, ..ContactGain::default() };
        if is_finite { Ok(gain) } else { Err(Critical) }
    }
}

/// What a contact yields of itself, as a part of what would move an object that nothing else holds.
const SHARING: f64 = 1e-16;

/// The opposite of a wrench, about a centre that it is beside.
fn opposite(push: &[f64; 6], beside: Vec3) -> [f64; 6] {
    let [x, y, z, u, v, w] = *push;
    let (force, moment) = (Vec3::new(x, y, z), Vec3::new(u, v, w));
    let moment = moment + beside.cross(force);
    [force.x, force.y, force.z, moment.x, moment.y, moment.z].map(|component| -component)
}
