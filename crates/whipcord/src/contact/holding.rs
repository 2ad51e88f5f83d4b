//! The contacts of an answer, linearised: what each pushes when the robot moves under something else.
//!
//! With `X` the motions of the cross-sections that touch, `C` their compliance under pushes, `B δf` the pushes along the lines
//! that hold (the normal of each contact, the tangents of one that sticks, the one across its traction of one that slides) and `G X` what the pushes turn by, a motion `X₀`
//! that something else would cause without the contacts becomes
//!
//! ```text
//! (I − CG) X − CB δf = X₀,   R X = 0,   δW = G X + B δf                                        (10)
//! ```
//!
//! where the rows of `R` say how the gaps, and the slips of those that stick, change. A contact that slides keeps its force on
//! Coulomb's cone, and slides on along its traction: across it, it sticks. One of the backbone moves along it to where the gap is least, an unknown more
//! with the condition that the tangent stays along the obstacle.
//!
//! Where the whole way to the answer is differentiated, slips count from where the cross-sections were at the equilibrium before, which
//! move by `X₋`: what sticks follows them, and what slides turns its traction with its slip,
//!
//! ```text
//! (I − CG) X − CB δf = X₀ + C G₋ X₋,   R X = −R₋ X₋,   δW = G X + B δf + G₋ X₋                (19)
//! ```

use core::ops::{Mul, Sub};

use whipcord_numerics::{DenseLu, Pose, Vec3, dot};

use super::body::{tangents, wrench_of};
use super::carried::{Carried, Rubbed};
use super::differences::differences;
use super::friction::Grip;
use super::held_contact::{ABOUT_TO_CHANGE, BETWEEN, Unknown, is_near_change};
use super::model::Compliant;
use super::object::Objects;
use super::pair::{OVERLAP, Pair};
use super::pairs::{BackboneContacts, Pairs};
use super::scene::Scene;
use crate::derivatives::ContactGain;
use crate::solution::Part;
use crate::statics::hold::Critical;

/// Contacts of the backbone with one obstacle that are no farther apart than this part of the length are one.
const ONE_CONTACT: f64 = 1e-3;
/// A backbone that bends away from what it touches by less than this, in units of 1/L, lies on it: its contacts stay.
const LIES_ON: f64 = 1e-2;

/// What a contact that slides yields across its traction, as a part of what the robot does: several on one disk may depend on one another
/// there, and share what they carry.
const SHARING: f64 = 1e-10;

/// Sine of the angle between the normals of two contacts of a cross-section by which it slides along both obstacles only.
const GUIDED: f64 = 0.02;

/// Step of differences along the backbone, as a part of its length.
const ALONG: f64 = 1e-5;

/// The linearised contacts of an answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Holding {
    /// Arc length in m of the cross-section of each contact.
    pub places: Vec<f64>,
    /// Whether a contact is about to open or to close, to stick or to slide: the answer has one-sided derivatives there.
    pub is_about_to_change: bool,
    /// Whether one neither touches nor is open, or neither sticks nor slides.
    pub is_between: bool,
    /// `G` of each contact.
    geometric: Vec<[[f64; 6]; 6]>,
    unknowns: Vec<Unknown>,
    carried: Carried,
    /// Where it counts slips from the equilibrium before: the contacts that rub, and `G₋` of each.
    before: Vec<Rubbed>,
}

impl Holding {
    /// Of the pairs that touch; slips count from the answer on, or where it `remembers` from the equilibrium before.
    pub(super) fn new(
        pairs: &Pairs,
        objects: &Objects,
        (model, scene): (&impl Compliant, &Scene),
        length: f64,
        remembers: bool,
    ) -> Self {
        let mut holding = Self::default();
        let scale = model.force_scale();
        for pair in &pairs.near {
            let is_near = |near: f64| {
                is_near_change((pair.nearest.gap, pair.force, pair.grip), near, scale, length)
            };
            holding.is_about_to_change |= is_near(ABOUT_TO_CHANGE);
            holding.is_between |= is_near(BETWEEN);
        }
        let mut touching = merged(pairs, length);
        for pair in &mut touching {
            if let Some(grip) = &mut pair.grip {
                // What has not slid, though its traction is at its bound, stays where it was; from the answer on it slides on.
                match remembers {
                    true => grip.sticks |= grip.slip.norm() <= OVERLAP * length,
                    false => grip.sticks &= !grip.is_at_bound(pair.force, ABOUT_TO_CHANGE),
                }
            }
        }
        for pair in &touching {
            let numbers = (holding.places.len(), holding.unknowns.len());
            // Beside another obstacle its normals alone keep a disk from sliding across the tractions.
            let is_guided = touching.iter().any(|other| {
                let turned = other.nearest.normal.cross(pair.nearest.normal).norm();
                other.member.arc_length == pair.member.arc_length && turned > GUIDED
            });
            let follows = pairs.backbone == BackboneContacts::Anywhere;
            holding.add(pair, (model, scene), length, (remembers || is_guided, follows));
            if let Some(grip) = pair.grip.filter(|_| remembers) {
                let from = |s: f64| scene.carried(model.pose_before(s));
                let along = Along { pair, grip, scene, from: &from };
                holding.remember(numbers, &along, model, length);
            }
        }
        let Self { geometric, unknowns, before, .. } = &holding;
        let of_way = remembers.then_some(&before[..]);
        let contacts = (&touching[..], of_way);
        holding.carried =
            Carried::new((geometric, unknowns), contacts, objects, (model, scene), length);
        holding.is_about_to_change |= holding.carried.is_about_to_change;
        holding
    }

    fn add(
        &mut self,
        pair: &Pair,
        (model, scene): (&impl Compliant, &Scene),
        length: f64,
        (slides_across, follows): (bool, bool),
    ) {
        let contact = self.places.len();
        let s = pair.member.arc_length;
        let (pose, body) = (model.pose(s), &pair.member.body);
        let rounding = body.rounding;
        let at = |pose: &Pose| pair.look(scene.get(pair.obstacle), pose);
        let traction = |normal: Vec3| {
            let Some(grip) = &pair.grip else { return Vec3::ZERO };
            let along = grip.traction - normal * normal.dot(grip.traction);
            let part = if grip.sticks { 1.0 } else { grip.traction.norm() / along.norm() };
            if part.is_finite() { along * part } else { Vec3::ZERO }
        };
        let push = |pose: &Pose| {
            let nearest = at(pose);
            let normal = nearest.push();
            let drag = wrench_of(traction(nearest.normal), nearest.lever(rounding));
            let [x, y, z, u, v, w] = core::array::from_fn(|a| pair.force * normal[a] + drag[a]);
            [Vec3::new(x, y, z), Vec3::new(u, v, w)]
        };
        let mut geometric = [[0.0; 6]; 6];
        let rates = differences(6, &pose, body.reach(), push);
        for (b, [force, moment]) in rates.into_iter().enumerate() {
            for a in 0..6 {
                geometric[a][b] = if a < 3 { force[a] } else { moment[a - 3] };
            }
        }
        // The normal, with what a contact that slides bears along the surface.
        let nearest = at(&pose);
        let lever = nearest.lever(rounding);
        let mut along_normal = nearest.push();
        if let Some(grip) = pair.grip.filter(|grip| !grip.sticks) {
            let by_force = wrench_of(grip.traction / pair.force, lever);
            along_normal.iter_mut().zip(by_force).for_each(|(sum, by)| *sum += by);
        }
        let unit = nearest.push();
        self.unknowns.push(Unknown::new(contact, along_normal, unit));
        if let Some(grip) = pair.grip {
            // From the answer on.
            let from = Grip { from: pose, ..grip };
            let slip = |pose: &Pose| [from.slip_at(pose, &at(pose), rounding)];
            let rates = differences(6, &pose, body.reach(), slip);
            let own = if grip.sticks { 0.0 } else { SHARING * length / model.force_scale() };
            for axis in grip.held_axes(nearest.normal, slides_across) {
                let rate = rates.map(|[rate]| rate.dot(axis));
                let push = wrench_of(axis, lever);
                self.unknowns.push(Unknown { own, ..Unknown::new(contact, push, rate) });
            }
        }
        if follows
            && pair.member.part == Part::Backbone
            && let Some(unknown) = along_backbone((contact, s), &pose, model, length, |pose| {
                (at(pose).normal, push(pose))
            })
        {
            self.unknowns.push(unknown);
        }
        self.geometric.push(geometric);
        self.places.push(s);
    }

    /// Adds what the slip of a contact, whose first unknown has this number, remembers.
    fn remember(
        &mut self,
        (contact, first): (usize, usize),
        along: &Along<'_>,
        model: &impl Compliant,
        length: f64,
    ) {
        let Along { pair, grip, .. } = along;
        let (s, body) = (pair.member.arc_length, &pair.member.body);
        let (pose, from) = (model.pose(s), (along.from)(s));
        let nearest = pair.look(along.scene.get(pair.obstacle), &pose);
        let rates = differences(6, &pose, body.reach(), |pose| [along.slip(pose, &from)]);
        let by_before = differences(6, &from, body.reach(), |from| [along.slip(&pose, from)]);
        // As the contact moves along the backbone, it is another material point that has slid.
        let slip = |back: f64| along.slip(&model.pose(s - back), &(along.from)(s - back));
        let way = (first..self.unknowns.len()).find(|&k| self.unknowns[k].own != 0.0);
        let by_way = way.map(|number| (number, behind(ALONG * length, slip)));
        let mut before = [[0.0; 6]; 6];
        if grip.sticks {
            let tangents = tangents(nearest.normal);
            for (unknown, axis) in self.unknowns[first + 1..].iter_mut().zip(tangents) {
                unknown.rate = rates.map(|[rate]| rate.dot(axis));
                unknown.rate_before = by_before.map(|[rate]| rate.dot(axis));
                unknown.by_other = by_way.map(|(number, by)| (number, by.dot(axis)));
            }
        } else {
            let lever = nearest.lever(body.rounding);
            let turned = |slip: Vec3| wrench_of(grip.turned(slip, nearest.normal), lever);
            for (b, ([rate], [by])) in rates.into_iter().zip(by_before).enumerate() {
                let (own, of_before) = (turned(rate), turned(by));
                for a in 0..6 {
                    self.geometric[contact][a][b] += own[a];
                    before[a][b] = of_before[a];
                }
            }
            if let Some((number, by)) = by_way {
                let more = turned(by);
                self.unknowns[number].push.iter_mut().zip(more).for_each(|(sum, by)| *sum += by);
            }
        }
        self.before.push((contact, before));
    }

    /// The arc lengths in m of the contacts whose slips count from the equilibrium before.
    pub fn remembered(&self) -> impl Iterator<Item = f64> {
        self.before.iter().map(|&(contact, _)| self.places[contact])
    }

    /// Whether anything here depends on what was at the equilibrium before.
    pub fn depends_on_before(&self) -> bool {
        !self.before.is_empty() || self.carried.remembers()
    }

    /// How the pushes change with the motions that something else would cause without the contacts, and with those at the equilibrium
    /// before: of the compliance of the places under pushes, by rows, all with a force and a moment to a place.
    pub fn gain(&self, compliance: &[f64]) -> Result<ContactGain, Critical> {
        let n = 6 * self.places.len();
        if !self.carried.is_empty() {
            return self.carried.gain(n, (&self.geometric, &self.unknowns), compliance);
        }
        let size = n + self.unknowns.len();
        let mut matrix = vec![0.0; size * size];
        for i in 0..n {
            let row = &compliance[i * n..(i + 1) * n];
            for (k, block) in self.geometric.iter().enumerate() {
                for b in 0..6 {
                    let by: f64 = (0..6).map(|a| row[6 * k + a] * block[a][b]).sum();
                    matrix[i * size + 6 * k + b] = -by;
                }
            }
            matrix[i * size + i] += 1.0;
            for (j, unknown) in self.unknowns.iter().enumerate() {
                let of = &row[6 * unknown.contact..6 * unknown.contact + 6];
                matrix[i * size + n + j] = -dot(of, &unknown.push);
            }
        }
        for (j, unknown) in self.unknowns.iter().enumerate() {
            let row = &mut matrix[(n + j) * size..(n + j + 1) * size];
            row[6 * unknown.contact..6 * unknown.contact + 6].copy_from_slice(&unknown.rate);
            row[n + j] = unknown.own;
            if let Some((other, by)) = unknown.by_other {
                row[n + other] += by;
            }
        }
        let mut lu = DenseLu::default();
        if size > 0 {
            lu.factor(size, &matrix).map_err(|_| Critical)?;
        }
        let pushes = |column: &[f64]| {
            let mut pushes = vec![0.0; n];
            for (k, block) in self.geometric.iter().enumerate() {
                for a in 0..6 {
                    pushes[6 * k + a] = dot(&block[a], &column[6 * k..6 * k + 6]);
                }
            }
            for (unknown, &change) in self.unknowns.iter().zip(&column[n..]) {
                for a in 0..6 {
                    pushes[6 * unknown.contact + a] += unknown.push[a] * change;
                }
            }
            pushes
        };
        // With what objects that are held will be released with.
        let with_held = |column: &[f64], mut pushes: Vec<f64>, gravity: Vec3| {
            let held = self.carried.held_with((column, &pushes), gravity);
            pushes.extend(held);
            pushes
        };
        let by_motion: Vec<Vec<f64>> = (lu.inverse_columns(n).iter())
            .map(|column| with_held(column, pushes(column), Vec3::ZERO))
            .collect();
        let mut by_before = Vec::with_capacity(6 * self.before.len());
        for (contact, block) in &self.before {
            for b in 0..6 {
                let mut column = vec![0.0; size];
                for (i, value) in column[..n].iter_mut().enumerate() {
                    let row = &compliance[i * n + 6 * contact..][..6];
                    *value = (0..6).map(|a| row[a] * block[a][b]).sum();
                }
                for (value, unknown) in column[n..].iter_mut().zip(&self.unknowns) {
                    if unknown.contact == *contact {
                        *value = -unknown.rate_before[b];
                    }
                }
                lu.solve(&mut column);
                let mut pushes = pushes(&column);
                (0..6).for_each(|a| pushes[6 * contact + a] += block[a][b]);
                by_before.push(with_held(&column, pushes, Vec3::ZERO));
            }
        }
        let nothing = vec![0.0; n];
        let by_gravity = [Vec3::X, Vec3::Y, Vec3::Z]
            .map(|gravity| with_held(&nothing, nothing.clone(), gravity));
        ContactGain::of_columns(&by_motion, &by_before, &by_gravity).ok_or(Critical)
    }
}

/// A contact that rubs, as its slip is counted.
struct Along<'a> {
    pair: &'a Pair,
    grip: Grip,
    scene: &'a Scene,
    /// Where the cross-section at an arc length was at the last equilibrium.
    from: &'a dyn Fn(f64) -> Pose,
}

impl Along<'_> {
    fn slip(&self, pose: &Pose, from: &Pose) -> Vec3 {
        let obstacle = self.pair.obstacle;
        let nearest = self.pair.look(self.scene.get(obstacle), pose);
        // Carried along by an obstacle that moves.
        let from = self.scene.carry(obstacle, *from);
        nearest.slip(&from, pose, self.pair.member.body.rounding)
    }
}

/// The derivative along the backbone of something that is known by how far it is behind a contact: on that side, as the strains beside
/// the contact jump with its push, and a contact that moves on takes those behind it along.
fn behind<T>(step: f64, value: impl Fn(f64) -> T) -> T
where
    T: Sub<Output = T> + Mul<f64, Output = T>,
{
    let value = &value;
    let since = |back: f64| value(0.0) - value(back);
    (since(step) * 4.0 - since(2.0 * step)) * (0.5 / step)
}

/// How a contact of the backbone moves along it; `None` where the backbone lies on what it touches. `look` says the normal and
/// the push at a pose.
fn along_backbone(
    (contact, s): (usize, f64),
    pose: &Pose,
    model: &impl Compliant,
    length: f64,
    look: impl Fn(&Pose) -> (Vec3, [Vec3; 2]),
) -> Option<Unknown> {
    let watched = model.watched();
    let k = watched.partition_point(|&there| there <= s);
    let (before, after) = (*watched.get(k.checked_sub(1)?)?, *watched.get(k)?);
    let slope_at = |pose: &Pose| look(pose).0.dot(pose.rotation.rotate(Vec3::Z));
    let h = ALONG * length;
    let (bend, tangent) = if before == s {
        // Where the place is watched itself, from the one before it: the backbone may have a corner there.
        let before = *watched.get(k.checked_sub(2)?)?;
        let [first, last] = [before, after].map(|there| model.pose(there));
        let apart = after - before;
        let bend = (slope_at(&last) - slope_at(&first)) / apart;
        (bend, (last.position - first.position) / apart)
    } else {
        let bend = behind(h, |back| slope_at(&model.pose(s - back)));
        (bend, behind(h, |back| model.pose(s - back).position))
    };
    if !(bend.is_finite() && bend * length > LIES_ON) {
        return None;
    }
    // A cross-section farther along, of which the reference is the place of the contact.
    let ahead = |h: f64| {
        let moved = Pose { position: pose.position + tangent * h, ..*pose };
        let [force, moment] = look(&moved).1;
        (force, moment + (tangent * h).cross(force))
    };
    let (next, last) = (ahead(h), ahead(-h));
    let (force, moment) = ((next.0 - last.0) / (2.0 * h), (next.1 - last.1) / (2.0 * h));
    let slope = |pose: &Pose| [Vec3::Z * slope_at(pose)];
    let rates = differences(6, pose, length, slope);
    Some(Unknown {
        contact,
        push: [force.x, force.y, force.z, moment.x, moment.y, moment.z],
        rate: rates.map(|[rate]| rate.z),
        own: bend,
        by_other: None,
        rate_before: [0.0; 6],
    })
}

/// The pairs that touch; those of the backbone that are next to one another as one.
fn merged(pairs: &Pairs, length: f64) -> Vec<Pair> {
    let mut touching: Vec<Pair> = Vec::new();
    let mut order: Vec<&Pair> = pairs.near.iter().filter(|pair| pair.force > 0.0).collect();
    // The one that pushes most stands for those beside it.
    order.sort_by(|a, b| b.force.total_cmp(&a.force));
    for pair in order {
        let beside = |other: &&mut Pair| {
            let apart = (other.member.arc_length - pair.member.arc_length).abs();
            other.obstacle == pair.obstacle
                && (other.member.part, pair.member.part) == (Part::Backbone, Part::Backbone)
                && apart <= ONE_CONTACT * length
        };
        match touching.iter_mut().find(beside) {
            Some(other) => {
                other.force += pair.force;
                if let (Some(grip), Some(more)) = (&mut other.grip, &pair.grip) {
                    grip.traction += more.traction;
                }
            }
            None => touching.push(*pair),
        }
    }
    touching
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring of 2 m/N along the normal that a contact keeps still: it pushes back with what the motion would take.
    #[test]
    fn a_contact_keeps_its_gap() {
        let unit = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        let holding = Holding {
            places: vec![0.1],
            is_about_to_change: false,
            is_between: false,
            geometric: vec![[[0.0; 6]; 6]],
            unknowns: vec![Unknown::new(0, unit, unit)],
            carried: Carried::default(),
            before: Vec::new(),
        };
        let compliance: Vec<f64> = (0..36).map(|i| if i % 7 == 0 { 2.0 } else { 0.0 }).collect();
        let gain = holding.gain(&compliance).unwrap();
        for (i, value) in gain.by_motion.iter().enumerate() {
            assert_eq!(*value, if i == 2 * 6 + 2 { -0.5 } else { 0.0 });
        }
        // A place that nothing moves has no force that keeps it.
        assert!(holding.gain(&[0.0; 36]).is_err());
    }
}
