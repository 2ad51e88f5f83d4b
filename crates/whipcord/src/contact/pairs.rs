//! Which parts of the robot are near which obstacles.

use whipcord_numerics::{Pose, Vec3};

use super::body::{Body, Nearest};
use super::friction::Grip;
use super::member::{Member, backbone_radius};
use super::model::{Compliant, Push};
use super::pair::{OVERLAP, Pair, grip};
use super::rim_places::is_all_around;
use super::scene::Scene;
use super::sliding::Slide;
use crate::robot::Robot;
use crate::shape::Wrench;
use crate::solution::{Contact, Part, Solution};

/// Where the backbone may have contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum BackboneContacts {
    /// Where the gap is least, which they follow along the backbone.
    #[default]
    Anywhere,
    /// At watched places, where they stay: on the way into pipes. A backbone that lies along a bore is as near to it everywhere, so that
    /// contacts that follow the least gap move to and fro.
    AtWatchedPlaces,
}

/// All pairs that are near, and where to look for more.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// Disks beyond the base, which is clamped.
    pub(super) disks: Vec<Member>,
    /// The watched arc lengths, and the radius of the backbone at each.
    pub(super) watched: Vec<f64>,
    pub(super) radii: Vec<f64>,
    pub(super) length: f64,
    pub near: Vec<Pair>,
    /// Where the backbone may have contacts in the step at hand.
    pub backbone: BackboneContacts,
    /// The obstacles and arc lengths of contacts that have been added since [`Pairs::begin_search`] where the robot was in
    /// equilibrium but for them.
    pub(super) added: Vec<(usize, f64)>,
}

/// The most pairs that are looked at together: their equations are dense.
const MOST: usize = 256;
/// The most pairs times watched places: at each place the motion by each pair is kept.
const MOST_MOTIONS: usize = 100_000;

/// Contacts of the backbone that are nearer than this to one another, in distances of watched places, keep their places.
const BESIDE: f64 = 1.0;
/// The same of those that rub.
const BESIDE_RUBBING: f64 = 1.5;
/// Pairs are looked at from this distance on, as a part of the length.
pub(super) const NEAR: f64 = 2e-3;
/// Least distance of a contact to one where the backbone seems to overlap between two watched places, as a part of their
/// distance.
pub(super) const BETWEEN: f64 = 0.05;

impl Pairs {
    pub fn new(robot: &Robot, watched: &[f64]) -> Self {
        Self {
            disks: Member::disks(robot),
            watched: watched.to_vec(),
            radii: watched.iter().map(|&s| backbone_radius(robot, s)).collect(),
            length: robot.backbone().length,
            near: Vec::new(),
            backbone: BackboneContacts::Anywhere,
            added: Vec::new(),
        }
    }

    /// An equilibrium is looked for anew.
    pub fn begin_search(&mut self) {
        self.added.clear();
        for pair in &mut self.near {
            pair.moved = f64::INFINITY;
            // One that rubs keeps its place from equilibrium to equilibrium.
            pair.is_placed &= pair.grip.is_some();
        }
    }

    /// The most pairs that memory and time allow.
    pub fn most(&self) -> usize {
        MOST.min(MOST_MOTIONS / self.watched.len().max(1)).max(1)
    }

    /// Of the backbone, at the watched place that is next.
    pub(super) fn radius(&self, arc_length: f64) -> f64 {
        let k = self.watched.partition_point(|&s| s < arc_length).min(self.radii.len() - 1);
        self.radii[k]
    }

    /// Looks at all pairs again where the robot is now.
    pub fn refresh(&mut self, model: &impl Compliant, scene: &Scene) {
        for k in 0..self.near.len() {
            let is_alone = self.is_alone(k);
            let pair = &mut self.near[k];
            let pose = model.pose(pair.member.arc_length);
            let obstacle = scene.get(pair.obstacle);
            let rounding = pair.member.body.rounding;
            pair.nearest = pair.look(obstacle, &pose);
            if let Some(grip) = &mut pair.grip {
                let from = scene.carry(pair.obstacle, grip.from);
                grip.refresh(&pose, &pair.nearest, rounding, from);
            }
            let slides = is_alone
                && !pair.is_placed
                && pair.member.part == Part::Backbone
                && self.backbone == BackboneContacts::Anywhere
                && obstacle.movable.is_none();
            let place = (pair.member.arc_length, rounding, pair.moved);
            pair.slide = if slides { Slide::of(model, obstacle, place, self.length) } else { None };
        }
        self.merge();
        self.merge_along();
        let far = 2.0 * NEAR * self.length;
        self.near.retain(|pair| pair.force > 0.0 || pair.nearest.gap < far);
    }

    /// Whether a contact of the backbone has no other with the same obstacle beside it: where several lie side by side, as on a
    /// cylinder that the backbone is wrapped around, each keeps its place.
    fn is_alone(&self, number: usize) -> bool {
        let of = &self.near[number];
        let s = of.member.arc_length;
        let beside = if of.grip.is_some() { BESIDE_RUBBING } else { BESIDE };
        let apart = beside * self.spacing(s);
        let is_beside = |(k, pair): (usize, &Pair)| {
            k != number
                && pair.obstacle == of.obstacle
                && pair.member.part == Part::Backbone
                && (pair.member.arc_length - s).abs() < apart
                // Not those that are merely near.
                && !(pair.force == 0.0 && (0.0..f64::INFINITY).contains(&pair.nearest.gap))
        };
        !self.near.iter().enumerate().any(is_beside)
    }

    /// The pairs of the backbone with an obstacle.
    pub(super) fn along_backbone(&self, obstacle: usize) -> impl Iterator<Item = &Pair> {
        let is_of =
            move |pair: &&Pair| pair.obstacle == obstacle && pair.member.part == Part::Backbone;
        self.near.iter().filter(is_of)
    }

    /// Of the watched places beside an arc length, in m.
    pub(super) fn spacing(&self, s: f64) -> f64 {
        let watched = &self.watched;
        let k = watched.partition_point(|&there| there < s).clamp(1, watched.len() - 1);
        watched[k] - watched[k - 1]
    }

    /// Contacts that have moved along the backbone to one place become one, with what both pushed; those that push nothing beside
    /// one that pushes are left out.
    fn merge_along(&mut self) {
        let mut k = 0;
        while k < self.near.len() {
            let of = self.near[k];
            let s = of.member.arc_length;
            let apart = self.spacing(s);
            let beside = |pair: &Pair, within: f64| {
                pair.obstacle == of.obstacle
                    && (pair.member.part, of.member.part) == (Part::Backbone, Part::Backbone)
                    && (pair.member.arc_length - s).abs() < within * apart
            };
            let follows = |pair: &Pair| pair.slide.is_some() && of.slide.is_some();
            let same = |pair: &Pair| beside(pair, BETWEEN) && follows(pair);
            if let Some(first) = self.near[..k].iter().position(same) {
                self.near.remove(k);
                let into = &mut self.near[first];
                if of.force > into.force {
                    (into.member, into.nearest, into.slide) = (of.member, of.nearest, of.slide);
                }
                into.force += of.force;
                into.given.iter_mut().zip(of.given).for_each(|(sum, given)| *sum += given);
                if let (Some(grip), Some(other)) = (&mut into.grip, of.grip) {
                    grip.traction += other.traction;
                }
                continue;
            }
            let is_idle = of.force == 0.0 && of.nearest.gap.is_finite();
            let pushes = |pair: &Pair| beside(pair, 0.5) && pair.force > 0.0;
            let overlaps = of.nearest.gap < -OVERLAP * self.length;
            if is_idle && !overlaps && self.near.iter().any(pushes) {
                self.near.remove(k);
                continue;
            }
            k += 1;
        }
    }

    /// Moves a pair along the backbone: what it has slid counts for the cross-section where it is.
    pub fn move_to(
        &mut self,
        number: usize,
        arc_length: f64,
        model: &impl Compliant,
        scene: &Scene,
    ) {
        let rounding = self.radius(arc_length);
        let Pair { member, grip, .. } = &mut self.near[number];
        (member.arc_length, member.body.rounding) = (arc_length, rounding);
        if let Some(grip) = grip {
            grip.from = scene.carried(model.pose_before(arc_length));
        }
    }

    /// Places of one disk that have run into one another become one, with what both pushed.
    fn merge(&mut self) {
        let mut k = 0;
        while k < self.near.len() {
            let of = self.near[k];
            let same = |pair: &Pair| {
                let [dx, dy] = [0, 1].map(|i| pair.nearest.local[i] - of.nearest.local[i]);
                pair.obstacle == of.obstacle
                    && pair.member.part == of.member.part
                    && !pair.keeps_place
                    && !of.keeps_place
                    && !of.member.body.is_ball()
                    && dx.hypot(dy) < 1e-3 * of.member.body.flat
            };
            let Some(first) = self.near[..k].iter().position(same) else {
                k += 1;
                continue;
            };
            self.near.remove(k);
            let into = &mut self.near[first];
            into.force += of.force;
            into.given.iter_mut().zip(of.given).for_each(|(sum, given)| *sum += given);
            if let (Some(grip), Some(other)) = (&mut into.grip, of.grip) {
                grip.traction += other.traction;
            }
        }
    }

    /// A step on the way begins where the robot is: what touches has not slid yet.
    pub fn begin_step(&mut self, model: &impl Compliant, scene: &Scene) {
        let is_backbone_fixed = self.backbone == BackboneContacts::AtWatchedPlaces;
        let keeps_place = |pair: &Pair| {
            pair.keeps_place || is_backbone_fixed && pair.member.part == Part::Backbone
        };
        self.near.retain(|pair| pair.force > 0.0 || !keeps_place(pair));
        for pair in &mut self.near {
            if let Some(grip) = &mut pair.grip {
                grip.from = scene.carried(model.pose_before(pair.member.arc_length));
            }
        }
    }

    /// Takes over a contact of a known answer.
    pub fn resume(&mut self, touch: &Contact, answer: &Solution, to_base: &Pose, scene: &Scene) {
        let normal = to_base.rotation.rotate(touch.normal);
        let point = to_base.transform(touch.point);
        let (member, arm, local) = match touch.part {
            Part::Disk(k) => {
                let known = self.disks.iter().find(|member| member.part == touch.part);
                let (Some(member), Some(pose)) = (known, answer.disks.poses.get(k)) else { return };
                let pose = *to_base * *pose;
                let arm = point + normal * member.body.rounding - pose.position;
                let local = pose.rotation.conjugate().rotate(arm);
                (*member, arm, [local.x, local.y])
            }
            Part::Backbone => {
                let rounding = self.radius(touch.arc_length);
                let body = Body { flat: 0.0, rounding };
                let member = Member { part: touch.part, arc_length: touch.arc_length, body };
                (member, Vec3::ZERO, [0.0, 0.0])
            }
        };
        let nearest = Nearest { gap: touch.gap, normal, arm, local };
        let force = touch.force.unwrap_or(0.0);
        let coefficient = scene.get(touch.obstacle).friction;
        let grip = (coefficient > 0.0).then(|| {
            let from = match touch.part {
                Part::Disk(k) => answer.disks.poses.get(k).copied(),
                Part::Backbone => None,
            };
            let from = *to_base * from.unwrap_or_else(|| answer.shape.at(touch.arc_length));
            let traction = to_base.rotation.rotate(touch.friction.unwrap_or_default());
            Grip { traction, sticks: touch.sticks, ..Grip::new(coefficient, from) }
        });
        let mut pair = Pair { force, grip, ..Pair::new(touch.obstacle, member, nearest) };
        if let Part::Disk(k) = touch.part
            && let Some(pose) = answer.disks.poses.get(k)
        {
            let rim = member.body.nearest(
                scene.get(touch.obstacle),
                &(*to_base * *pose),
                NEAR * self.length,
                &mut Vec::new(),
            );
            pair.keeps_place = is_all_around(rim, core::iter::empty());
        }
        pair.given = pair.push();
        self.near.push(pair);
    }

    /// Obstacles that did not rub do so from now on, at rest where the robot is.
    pub fn grip_all(&mut self, model: &impl Compliant, scene: &Scene) {
        for pair in &mut self.near {
            pair.grip = grip(model, scene, pair.obstacle, pair.member.arc_length);
        }
    }

    /// What the pairs push the robot with.
    pub fn pushes(&self, into: &mut Vec<Push>) {
        into.clear();
        into.extend(self.near.iter().map(|pair| {
            let [fx, fy, fz, mx, my, mz] = pair.given;
            let wrench = Wrench { force: Vec3::new(fx, fy, fz), moment: Vec3::new(mx, my, mz) };
            Push { arc_length: pair.member.arc_length, wrench }
        }));
    }

    /// The contacts in the frame that the base's pose is given in.
    pub fn contacts(&self, model: &impl Compliant, base: &Pose, forces: bool) -> Vec<Contact> {
        let touching = self.near.iter().filter(|pair| pair.force > 0.0);
        let mut touches: Vec<Contact> = touching
            .map(|pair| {
                let Pair { nearest, member, .. } = pair;
                let centre = model.pose(member.arc_length).position;
                let point = centre + nearest.arm - nearest.normal * member.body.rounding;
                Contact {
                    obstacle: pair.obstacle,
                    part: member.part,
                    arc_length: member.arc_length,
                    point: base.transform(point),
                    normal: base.rotation.rotate(nearest.normal),
                    force: forces.then_some(pair.force),
                    friction: forces.then(|| base.rotation.rotate(pair.traction())),
                    sticks: pair.grip.is_some_and(|grip| grip.sticks),
                    gap: nearest.gap,
                }
            })
            .collect();
        touches.sort_by(|a, b| {
            a.arc_length.total_cmp(&b.arc_length).then(a.obstacle.cmp(&b.obstacle))
        });
        touches
    }
}
