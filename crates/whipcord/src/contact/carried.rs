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
//!
//! Where the whole way is differentiated the motions `Y₋` of the objects at the equilibrium before count as those of the cross-sections do
//! in eq. (19), an object that nothing determines moves on by them, and what an object was held with when it was released, and a part of
//! which holds it still, changes by `H₋`.

use whipcord_numerics::{DenseLu, Pose, Vec3, dot};

use super::body::{Nearest, along, tangents, wrench_of};
use super::differences::differences;
use super::friction::Grip;
use super::held_contact::{ABOUT_TO_CHANGE, Unknown, is_near_change};
use super::model::Compliant;
use super::object::{Object, Objects};
use super::object_pair::ObjectPair;
use super::pair::{OVERLAP, Pair};
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
    /// How many move.
    count: usize,
    /// How many there are, and so parts of what is remembered of each, where any of that is.
    listed: usize,
    /// How many contacts of the robot there are.
    contacts: usize,
    /// How many cross-sections rub: what is remembered of objects follows that of these.
    rubbing: usize,
    /// What the contacts push more, and how much more what they keep at zero changes, with the motions at the equilibrium before.
    blocks_before: Vec<Block>,
    rates_before: Vec<(usize, usize, [f64; 6])>,
    /// The part that is left of what held each object.
    held: Vec<f64>,
    /// The contacts of objects that are held, with the place of the cross-section beside the centre and the force on it.
    holding: Vec<(usize, usize, Vec3, Vec3)>,
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

/// A contact that rubs, by its number, with `G₋` of (19).
pub(super) type Rubbed = (usize, [[f64; 6]; 6]);

impl Carried {
    /// Of the contacts of the robot, with what they push and how that changes, and of those of objects with obstacles; `before` has the
    /// contacts that rub, and what they push more with the motion of each at the equilibrium before, where that counts.
    pub fn new(
        (geometric, unknowns): (&[[[f64; 6]; 6]], &[Unknown]),
        (touching, before): (&[Pair], Option<&[Rubbed]>),
        objects: &Objects,
        (model, scene): (&impl Compliant, &Scene),
        length: f64,
    ) -> Self {
        let contacts = touching.len();
        let scale = model.force_scale();
        let mut all = Self {
            count: objects.count(),
            listed: before.map_or(0, |_| objects.list.len()),
            contacts,
            rubbing: before.map_or(0, <[_]>::len),
            held: objects.list.iter().map(|object| object.held).collect(),
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
        if all.count == 0 {
            for (k, pair) in touching.iter().enumerate() {
                let on = objects.list.iter().position(|object| object.number == pair.obstacle);
                if let Some(object) = on.filter(|_| all.listed > 0) {
                    let centre = model.pose(pair.member.arc_length).position;
                    let beside = centre - objects.list[object].pose.position;
                    all.holding.push((k, object, beside, pair.total()));
                }
            }
            return all;
        }
        for (place, (k, push)) in before.into_iter().flatten().enumerate() {
            all.remember_robot((place, *k), push, (touching, unknowns), objects, (model, scene));
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
            let grip = pair.grip.map(|mut grip| {
                if before.is_some() {
                    // What has not slid, though its traction is at its bound, stays where it was.
                    grip.sticks |= grip.slip.norm() <= OVERLAP * length;
                    return Grip { from: scene.carry(pair.other, grip.from), ..grip };
                }
                // From the answer on, where it slides on.
                grip.sticks &= !grip.is_at_bound(pair.force, ABOUT_TO_CHANGE);
                Grip { from: contact.pose, slip: Vec3::ZERO, ..grip }
            });
            let turning = grip.filter(|grip| before.is_some() && !grip.sticks);
            let turned = |slip: Vec3| {
                turning.map_or(Vec3::ZERO, |grip| grip.turned(slip, pair.nearest.normal))
            };
            let traction = |nearest: &Nearest, pose: &Pose| {
                let Some(grip) = &grip else { return Vec3::ZERO };
                let along = along(grip.traction, nearest.normal);
                let part = if grip.sticks { 1.0 } else { grip.traction.norm() / along.norm() };
                let along = if part.is_finite() { along * part } else { Vec3::ZERO };
                match turning {
                    Some(grip) => {
                        along + turned(grip.slip_at(pose, nearest, pair.rounding) - grip.slip)
                    }
                    None => along,
                }
            };
            let force = |nearest: &Nearest, pose: &Pose| {
                nearest.normal * pair.force + traction(nearest, pose)
            };
            let rates = contact.rates(force, grip.as_ref(), 6, Differences::Central);
            let total = force(&pair.nearest, &contact.pose);
            contact.geometric((total, pair.total()), &rates, &mut all.blocks);
            if let Some(grip) = grip.filter(|_| before.is_some()) {
                all.remember_objects((pair, &grip), &turned, objects, scene);
            }
            let mut lines = Vec::new();
            let normal = pair.nearest.normal;
            let held = grip.as_ref().map(|grip| (grip, grip.held_axes(normal, before.is_some())));
            contact.lines(pair.force, held, &rates, &mut lines);
            for (number, line) in lines.iter().enumerate() {
                for mut end in line.ends().copied() {
                    // What slides bears along the surface in proportion.
                    if let Some(grip) = grip.filter(|grip| number == 0 && !grip.sticks) {
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

    /// Whether no object moves.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether an object has anything of what is remembered.
    pub fn remembers(&self) -> bool {
        !self.rates_before.is_empty()
            || !self.blocks_before.is_empty()
            || self.count > 0 && self.held.iter().any(|held| *held > 0.0)
    }

    /// How many numbers what is remembered has.
    pub const fn numbers_before(&self) -> usize {
        6 * (self.rubbing + 2 * self.listed)
    }

    /// Adds what a contact of the robot, of this place among those that rub, remembers: it pushes so with the motion of its cross-section
    /// at the equilibrium before.
    fn remember_robot(
        &mut self,
        (place, contact): (usize, usize),
        push: &[[f64; 6]; 6],
        (touching, unknowns): (&[Pair], &[Unknown]),
        objects: &Objects,
        (model, scene): (&impl Compliant, &Scene),
    ) {
        let pair = &touching[contact];
        let s = pair.member.arc_length;
        let (contacts, centre) = (touching.len(), model.pose(s).position);
        let own = unknowns.iter().enumerate().filter(|(_, unknown)| unknown.contact == contact);
        let rates: Vec<_> = own.map(|(number, unknown)| (number, unknown.rate_before)).collect();
        self.blocks_before.push(Block { row: contact, column: place, matrix: *push });
        self.rates_before.extend(rates.iter().map(|&(number, rate)| (number, place, rate)));
        let Some(object) = objects.of(pair.obstacle) else { return };
        let Object { pose, began, .. } = objects.list[object];
        let on_object = opposite_rows(push, centre - pose.position);
        let motions = carried(scene.carried(model.pose_before(s)).position - began.position);
        let with_object = self.rubbing + object;
        for (row, matrix) in [(contact, push), (contacts + object, &on_object)] {
            let matrix_of_object = by_carried(matrix, &motions);
            self.blocks_before.push(Block { row, column: with_object, matrix: matrix_of_object });
            if row != contact {
                self.blocks_before.push(Block { row, column: place, matrix: *matrix });
            }
        }
        let of_object = |(number, rate): (usize, [f64; 6])| {
            (number, with_object, core::array::from_fn(|b| -dot(&rate, &motions[b])))
        };
        self.rates_before.extend(rates.into_iter().map(of_object));
    }

    /// The same of a contact of objects, whose unknowns are the next ones; `turned` is how the traction turns with the slip.
    fn remember_objects(
        &mut self,
        (pair, grip): (&ObjectPair, &Grip),
        turned: &impl Fn(Vec3) -> Vec3,
        objects: &Objects,
        scene: &Scene,
    ) {
        let ObjectPair { owner, other, nearest, rounding, point, .. } = pair;
        let (owners, others) = (objects.of(*owner), objects.of(*other));
        let began = |object: usize| objects.list[object].began;
        let from = owners.map_or_else(|| scene.get(*owner).pose, began);
        let pose = objects.pose_of(*owner, scene);
        let slips = differences(6, &from, nearest.arm.norm() + rounding, |from| {
            [nearest.slip(&scene.carry(*other, *from), &pose, *rounding)]
        });
        let slips = slips.map(|[slip]| slip);
        let contacts = self.contacts;
        let mut push = |object: usize, column: usize, side: f64, slips: &[Vec3; 6]| {
            let lever = *point - objects.list[object].pose.position;
            let mut matrix = [[0.0; 6]; 6];
            for (b, slip) in slips.iter().enumerate() {
                let traction = turned(*slip) * side;
                put(&mut matrix, b, traction, lever.cross(traction));
            }
            self.blocks_before.push(Block { row: contacts + object, column, matrix });
        };
        let with_other: Option<(usize, [Vec3; 6])> = others.map(|object| {
            let motions = carried(from.position - began(object).position);
            let slips = motions.map(|motion| {
                slips.iter().zip(motion).fold(Vec3::ZERO, |sum, (slip, by)| sum - *slip * by)
            });
            (object, slips)
        });
        for (object, slips) in owners.map(|object| (object, slips)).into_iter().chain(with_other) {
            let column = self.rubbing + object;
            if grip.sticks {
                for (k, axis) in tangents(nearest.normal).into_iter().enumerate() {
                    let rate = slips.map(|slip| slip.dot(axis));
                    self.rates_before.push((self.unknowns + 1 + k, column, rate));
                }
                continue;
            }
            owners.iter().for_each(|&row| push(row, column, 1.0, &slips));
            others.iter().for_each(|&row| push(row, column, -1.0, &slips));
        }
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

    /// What objects that are held will be released with: adds to columns of motions and pushes of the contacts of the robot how it changes, and how
    /// with gravity.
    pub fn held_with(&self, (motion, pushes): (&[f64], &[f64]), gravity: Vec3) -> Vec<f64> {
        let mut found = vec![0.0; 12 * self.listed];
        let part = |v: &[f64], from: usize| Vec3::new(v[from], v[from + 1], v[from + 2]);
        for &(contact, object, beside, force) in &self.holding {
            let (by_force, by_moment) = (part(pushes, 6 * contact), part(pushes, 6 * contact + 3));
            let moved = part(motion, 6 * contact);
            let moment = by_moment + beside.cross(by_force) + moved.cross(force);
            let held = &mut found[6 * (self.listed + object)..][..6];
            for axis in 0..3 {
                held[axis] += by_force[axis];
                held[3 + axis] += moment[axis];
            }
        }
        for (object, mass) in self.masses.iter().enumerate().take(self.listed) {
            for axis in 0..3 {
                found[6 * (self.listed + object) + axis] -= mass * gravity[axis];
            }
        }
        found
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
            if let Some((other, by)) = unknown.by_other {
                matrix[(moving + number) * size + moving + other] += by;
            }
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
        let (objects, tail) = (6 * self.count, 12 * self.listed);
        // What is pushed more, then how the objects move, and what they were held with changes by.
        let found = |column: &[f64], more: &[f64], held: Option<usize>| -> Vec<f64> {
            let push = |i: usize| {
                dot(&wrenches[i * size..(i + 1) * size], column) + more.get(i).unwrap_or(&0.0)
            };
            let mut found: Vec<f64> = (0..n).map(push).collect();
            found.extend_from_slice(if tail > 0 { &column[n..n + objects] } else { &[] });
            found.resize(n + tail, 0.0);
            if let Some(number) = held {
                found[n + objects + number] += 1.0;
            }
            found
        };
        let alone = |column: &Vec<f64>| found(column, &[], None);
        let remembered = |number: usize| {
            let (body, b) = (number / 6, number % 6);
            let mut more = vec![0.0; moving];
            for Block { row, matrix, .. } in
                self.blocks_before.iter().filter(|of| of.column == body)
            {
                (0..6).for_each(|a| more[6 * row + a] += matrix[a][b]);
            }
            let mut column = vec![0.0; size];
            for (i, value) in column[..n].iter_mut().enumerate() {
                *value = dot(&compliance[i * n..(i + 1) * n], &more[..n]);
            }
            for (value, more) in column[n..moving].iter_mut().zip(&more[n..]) {
                *value = -more;
            }
            let object = body.checked_sub(self.rubbing);
            let mut held = None;
            match object {
                Some(object) if object < self.count => {
                    // What nothing determines moves on.
                    column[n + 6 * object + b] -= self.stiffness[object][b];
                }
                Some(object) if object >= self.listed => {
                    let object = object - self.listed;
                    column[n + 6 * object + b] -= self.held[object];
                    held = Some(6 * object + b);
                }
                _ => {}
            }
            for &(unknown, _, rate) in self.rates_before.iter().filter(|(_, of, _)| *of == body) {
                column[moving + unknown] -= rate[b];
            }
            lu.solve(&mut column);
            found(&column, &more, held)
        };
        let by_before: Vec<Vec<f64>> = (0..self.numbers_before()).map(remembered).collect();
        let weighed = |axis: usize| {
            let mut column = vec![0.0; size];
            for (object, mass) in self.masses.iter().enumerate() {
                column[n + 6 * object + axis] = -mass;
            }
            lu.solve(&mut column);
            column
        };
        let by_gravity = [0, 1, 2].map(|axis| alone(&weighed(axis)));
        let by_motion: Vec<Vec<f64>> = lu.inverse_columns(n).iter().map(alone).collect();
        ContactGain::of_columns(&by_motion, &by_before, &by_gravity).ok_or(Critical)
    }
}

/// What a contact exerts on an object that it has this place beside the centre of, where it pushes the robot so.
fn opposite_rows(push: &[[f64; 6]; 6], beside: Vec3) -> [[f64; 6]; 6] {
    let columns: [[f64; 6]; 6] =
        core::array::from_fn(|b| opposite(&core::array::from_fn(|a| push[a][b]), beside));
    core::array::from_fn(|a| core::array::from_fn(|b| columns[b][a]))
}

/// What the motion of an object pushes that carries a cross-section along so, where both together push nothing.
fn by_carried(matrix: &[[f64; 6]; 6], motions: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    matrix.map(|row| core::array::from_fn(|b| -dot(&row, &motions[b])))
}

/// What a contact yields of itself, as a part of what would move an object that nothing else holds.
const SHARING: f64 = 1e-18;

/// The opposite of a wrench, about a centre that it is beside.
fn opposite(push: &[f64; 6], beside: Vec3) -> [f64; 6] {
    let [x, y, z, u, v, w] = *push;
    let (force, moment) = (Vec3::new(x, y, z), Vec3::new(u, v, w));
    let moment = moment + beside.cross(force);
    [force.x, force.y, force.z, moment.x, moment.y, moment.z].map(|component| -component)
}
