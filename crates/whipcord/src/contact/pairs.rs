//! Which parts of the robot are near which obstacles.

use whipcord_numerics::{Pose, Vec3, golden_section};

use super::body::{Body, Nearest, Rim, wrench_of};
use super::friction::Grip;
use super::model::{Compliant, Push};
use super::scene::{DistanceBound, Scene};
use super::sliding::Slide;
use crate::obstacle::{Obstacle, Surface};
use crate::robot::Robot;
use crate::shape::{Contact, Part, Solution, Wrench};

/// A part of the robot that can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub part: Part,
    pub arc_length: f64,
    pub body: Body,
}

/// A part near an obstacle, and the push between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub obstacle: usize,
    pub member: Member,
    pub nearest: Nearest,
    /// Whether it keeps its place on the body: where a rim is about as near to the obstacle all around, as in a narrow bore,
    /// the nearest place is not defined well enough to be followed.
    pub keeps_place: bool,
    /// Force along the normal in N, not negative.
    pub force: f64,
    /// Force and moment on the cross-section that the model was last given.
    pub given: [f64; 6],
    /// How it holds on to the obstacle; `None` without friction.
    pub grip: Option<Grip>,
    /// How it moves along the backbone; `None` where it keeps its place.
    pub slide: Option<Slide>,
    /// Whether it keeps its place along the backbone from now on.
    pub is_settled: bool,
}

/// All pairs that are near, and where to look for more.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// Disks beyond the base, which is clamped.
    disks: Vec<Member>,
    /// The watched arc lengths, and the radius of the backbone at each.
    watched: Vec<f64>,
    radii: Vec<f64>,
    length: f64,
    pub near: Vec<Pair>,
    /// The obstacles and arc lengths of contacts that have been added since [`Pairs::begin_search`] where the robot was in
    /// equilibrium but for them.
    added: Vec<(usize, f64)>,
}

/// The most pairs that are looked at together: their equations are dense.
const MOST: usize = 256;
/// The most pairs times watched places: at each place the motion by each pair is kept.
const MOST_MOTIONS: usize = 100_000;

/// Pairs are looked at from this distance on, as a part of the length.
const NEAR: f64 = 2e-3;
/// Overlap that is not mended, as a part of the length.
pub(super) const OVERLAP: f64 = 1e-8;
/// Least distance of a contact to one where the backbone seems to overlap between two watched places, as a part of their
/// distance.
const BETWEEN: f64 = 0.05;
/// So often a contact is added at one place of the backbone while one equilibrium is looked for.
const ATTEMPTS: usize = 2;
/// Contacts of the backbone that are nearer than this to one another, in distances of watched places, keep their places.
const BESIDE: f64 = 1.0;
/// The same of those that rub.
const BESIDE_RUBBING: f64 = 1.5;
/// Least distance of two of those, where one lies between two watched places.
const CROWDED: f64 = 0.5;
/// Least distance of two contacts of the backbone, as a part of its length.
const APART: f64 = 1e-5;
/// A rim is about as near all around where its distances from the obstacle differ by less than this part of its radius; and
/// remains so until they differ by more than the other.
const ALL_AROUND: [f64; 2] = [0.05, 0.1];
/// The largest angle in rad between two places of such a rim that are looked at; four or five are on each rim.
const BETWEEN_PLACES: f64 = 0.6 * core::f64::consts::PI;
/// The least angle in rad between two of them.
const APART_ON_RIM: f64 = 1e-4;

/// Normals whose cosine is greater are those of a smooth surface, on which the gap is a parabola between two watched places.
const ALIKE: f64 = 0.98;
/// Of the search for the least gap between two watched places: its interval becomes 1e-5 of their distance.
const SECTIONS: usize = 24;

impl Pairs {
    pub fn new(robot: &Robot, watched: &[f64]) -> Self {
        let backbone = robot.backbone();
        let disks = robot.disks();
        let radius = |arc_length: f64| backbone.outer_radius_at(disks, arc_length);
        let disk = |k: usize| {
            let arc_length = disks.arc_lengths[k];
            let outer = disks.rim_radius(k).max(radius(arc_length));
            let body = Body::disk(outer, 0.5 * disks.thickness.unwrap_or(THICKNESS * outer));
            Member { part: Part::Disk(k), arc_length, body }
        };
        Self {
            disks: (1..disks.count())
                .filter(|_| disks.are_present)
                .map(disk)
                .filter(|m| m.body.reach() > 0.0)
                .collect(),
            watched: watched.to_vec(),
            radii: watched.iter().map(|&s| radius(s)).collect(),
            length: backbone.length,
            near: Vec::new(),
            added: Vec::new(),
        }
    }

    /// An equilibrium is looked for anew.
    pub fn begin_search(&mut self) {
        self.added.clear();
    }

    /// The most pairs that memory and time allow.
    pub fn most(&self) -> usize {
        MOST.min(MOST_MOTIONS / self.watched.len().max(1)).max(1)
    }

    /// Of the backbone, at the watched place that is next.
    fn radius(&self, arc_length: f64) -> f64 {
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
                && !pair.is_settled
                && pair.member.part == Part::Backbone
                && obstacle.movable.is_none();
            let place = (pair.member.arc_length, rounding);
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
    fn along_backbone(&self, obstacle: usize) -> impl Iterator<Item = &Pair> {
        let is_of =
            move |pair: &&Pair| pair.obstacle == obstacle && pair.member.part == Part::Backbone;
        self.near.iter().filter(is_of)
    }

    /// Of the watched places beside an arc length, in m.
    fn spacing(&self, s: f64) -> f64 {
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

    /// Adds the pairs that have come near; whether some of them are where the model has not been
    /// looked at yet. Beside a contact of the backbone there is another only where it is to be looked for `closely`.
    pub fn discover(&mut self, model: &impl Compliant, scene: &Scene, closely: bool) -> bool {
        let within = NEAR * self.length;
        let mut found = Vec::new();
        for member in &self.disks {
            let pose = model.pose(member.arc_length);
            for (k, obstacle) in scene.iter() {
                let rim = member.body.nearest(obstacle, &pose, within, &mut found);
                let of_rim = |pair: &Pair| pair.obstacle == k && pair.member.part == member.part;
                if is_all_around(rim, self.near.iter().filter(|pair| of_rim(pair))) {
                    let overlap = OVERLAP * self.length;
                    let places = RimPlaces { member, pose: &pose, obstacle: (k, obstacle) };
                    let grip = grip(model, scene, k, member.arc_length);
                    places.add(&found, (within, overlap), grip, &mut self.near);
                    continue;
                }
                for pair in self.near.iter_mut().filter(|pair| of_rim(pair)) {
                    pair.keeps_place = false;
                }
                for nearest in &found {
                    let known = |pair: &Pair| {
                        let [dx, dy] = [0, 1].map(|i| pair.nearest.local[i] - nearest.local[i]);
                        pair.obstacle == k
                            && pair.member.part == member.part
                            && (member.body.is_ball()
                                // One that has been followed to a place that is not the nearest does not count.
                                || dx.hypot(dy) < 0.2 * member.body.flat
                                    && pair.nearest.gap < nearest.gap + OVERLAP * self.length)
                    };
                    if !self.near.iter().any(known) {
                        let grip = grip(model, scene, k, member.arc_length);
                        self.near.push(Pair { grip, ..Pair::new(k, *member, *nearest) });
                    }
                }
            }
        }
        let mut elsewhere = false;
        for (k, obstacle) in scene.iter() {
            elsewhere |= self.discover_along(model, scene, (k, obstacle), (within, closely));
        }
        elsewhere
    }

    /// The same for the backbone and one obstacle: the least gaps along it.
    fn discover_along(
        &mut self,
        model: &impl Compliant,
        scene: &Scene,
        (number, obstacle): (usize, &Obstacle),
        (within, closely): (f64, bool),
    ) -> bool {
        let watched = model.watched();
        let mut added = Vec::new();
        let last = watched.len() - 1;
        let mut distance = DistanceBound::new(obstacle);
        // The gap at the place before, where it is known.
        let mut known_before = None;
        for i in 1..=last {
            let centre = model.centre(i);
            if distance.least(centre) - self.radii[i] > within {
                known_before = None;
                continue;
            }
            let here = distance.measure(centre) - self.radii[i];
            let before_here = known_before.replace(here);
            if here > within {
                continue;
            }
            let gap = |i: usize| obstacle.surface(model.centre(i)).distance - self.radii[i];
            // The base is clamped and does not count.
            let before =
                if i == 1 { f64::INFINITY } else { before_here.unwrap_or_else(|| gap(i - 1)) };
            let after = if i < last { gap(i + 1) } else { f64::INFINITY };
            if here > before || here >= after {
                continue;
            }
            let gaps = [before, here, after];
            // At a corner the gap may be least without being flat there.
            let is_smooth = i < last && before.is_finite() && model.corner(i).is_none();
            let (mut arc_length, mut least) = (watched[i], here);
            if is_smooth {
                (arc_length, least) = vertex([watched[i - 1], watched[i], watched[i + 1]], gaps);
                if closely && least < -OVERLAP * self.length {
                    // Beside a kink the parabola tells of an overlap that is not there.
                    let centre = model.pose(arc_length).position;
                    least = obstacle.surface(centre).distance - self.radii[i];
                    if least > here {
                        (arc_length, least) = (watched[i], here);
                    }
                }
            }
            // Beside a contact there is no other until the robot overlaps there, or seems to between two places.
            let overlap = -OVERLAP * self.length;
            let apart = watched[i] - watched[i - 1];
            let is_beside = |pair: &Pair| {
                pair.obstacle == number
                    && pair.member.part == Part::Backbone
                    && (pair.member.arc_length - watched[i]).abs() < apart
            };
            if closely && here < overlap && self.near.iter().any(is_beside) {
                (arc_length, least) = (watched[i], here);
            }
            let spacing = match (closely && here < overlap, closely && least < overlap) {
                (true, _) => APART * self.length,
                (false, true) => BETWEEN * apart,
                (false, false) => apart,
            };
            let known = |pair: &Pair| {
                pair.obstacle == number
                    && pair.member.part == Part::Backbone
                    && (pair.member.arc_length - arc_length).abs()
                        < spacing.max(if pair.slide.is_some() { BETWEEN * apart } else { 0.0 })
            };
            if !self.near.iter().any(known) {
                added.push((arc_length, self.radii[i]));
            }
        }
        if closely {
            self.beside_contacts(model, (number, obstacle), &mut added);
            self.between_watched(model, (number, obstacle), &mut added);
        }
        if closely {
            // One that was added there in vain overlaps on other steps only.
            added.retain(|&(s, _)| {
                let again = |&&(at, there): &&(usize, f64)| {
                    at == number && (there - s).abs() < APART * self.length
                };
                self.added.iter().filter(again).count() < ATTEMPTS
            });
            self.added.extend(added.iter().map(|&(s, _)| (number, s)));
        }
        let mut elsewhere = false;
        for (arc_length, rounding) in added {
            // Tractions act at the surface: contacts that are nearer to one another than their moments shift the force may hold
            // in several ways. Where a backbone that rubs lies on an obstacle they are watched places.
            let close = 2.0 * obstacle.friction * rounding;
            let crowded = CROWDED * self.spacing(arc_length);
            let beside = if close > 0.0 { close.max(crowded) } else { 0.0 };
            let is_watched = |s: f64| watched.binary_search_by(|at| at.total_cmp(&s)).is_ok();
            let is_near = |pair: &Pair, within: f64| {
                pair.obstacle == number
                    && pair.member.part == Part::Backbone
                    && (pair.member.arc_length - arc_length).abs() < within
            };
            let is_between = |pair: &Pair| !is_watched(pair.member.arc_length);
            if !is_watched(arc_length) {
                if self.near.iter().any(|pair| is_near(pair, beside)) {
                    continue;
                }
            } else if let Some(between) =
                self.near.iter().position(|pair| is_near(pair, beside) && is_between(pair))
            {
                self.move_to(between, arc_length, model, scene);
                self.near[between].is_settled = true;
                elsewhere = true;
                continue;
            } else if self.near.iter().any(|pair| is_near(pair, close)) {
                continue;
            }
            let body = Body { flat: 0.0, rounding };
            let member = Member { part: Part::Backbone, arc_length, body };
            let nearest =
                Nearest { gap: f64::INFINITY, normal: Vec3::Z, arm: Vec3::ZERO, local: [0.0, 0.0] };
            let grip = grip(model, scene, number, arc_length);
            self.near.push(Pair { grip, ..Pair::new(number, member, nearest) });
            elsewhere = true;
        }
        elsewhere
    }

    /// Where the backbone overlaps an obstacle beside a contact, or a place that is about to become one: the gap has a
    /// slope along it there.
    fn beside_contacts(
        &self,
        model: &impl Compliant,
        (number, obstacle): (usize, &Obstacle),
        added: &mut Vec<(f64, f64)>,
    ) {
        let slope = |s: f64, tangent: Option<Vec3>| {
            let pose = model.pose(s);
            let tangent = tangent.unwrap_or_else(|| pose.rotation.rotate(Vec3::Z));
            obstacle.surface(pose.position).normal.dot(tangent)
        };
        // At a watched place, on one side of it.
        let slope_at = |k: usize, side: usize| {
            slope(self.watched[k], model.corner(k).map(|tangents| tangents[side]))
        };
        self.between_contacts(model, (number, obstacle), added);
        for pair in self.along_backbone(number).filter(|pair| pair.slide.is_none()) {
            let Pair { member, force, .. } = pair;
            // One that pushes touches, once the iteration has converged.
            let gap = if *force > 0.0 { 0.0 } else { pair.nearest.gap.max(0.0) };
            let s = member.arc_length;
            let k = self.watched.partition_point(|&there| there < s).max(1);
            let is_watched = self.watched.get(k) == Some(&s);
            for k in k..=k + usize::from(is_watched) {
                let Some(&after) = self.watched.get(k) else { continue };
                let before = self.watched[k - 1];
                let slopes = [slope_at(k - 1, 1), slope_at(k, 0)];
                let here = if s == before {
                    slopes[0]
                } else if s == after {
                    slopes[1]
                } else {
                    slope(s, None)
                };
                let bend = (slopes[1] - slopes[0]) / (after - before);
                let aside = -here / bend;
                let overlap = 0.5 * here * here / bend - gap;
                let there = s + aside;
                if overlap.is_nan()
                    || overlap <= OVERLAP * self.length
                    || !(before..=after).contains(&there)
                {
                    continue;
                }
                let near = |other: f64| {
                    (other - there).abs() < (0.5 * aside.abs()).max(APART * self.length)
                };
                let known = self.along_backbone(number).any(|pair| near(pair.member.arc_length));
                // Where the gap is no parabola it may not overlap there.
                let centre = model.pose(there).position;
                let least = obstacle.surface(centre).distance - self.radius(there);
                let opened = if *force > 0.0 { pair.nearest.gap.min(0.0) } else { 0.0 };
                let overlaps = least - opened < -OVERLAP * self.length;
                if overlaps && !known && !added.iter().any(|&(other, _)| near(other)) {
                    added.push((there, self.radius(there)));
                }
            }
        }
    }

    /// Where the backbone overlaps a sharp edge or a small obstacle between two watched places that may both be clear of it: the
    /// normals there differ, and the gap, which changes no faster than the arc length, may vanish between them.
    fn between_watched(
        &self,
        model: &impl Compliant,
        (number, obstacle): (usize, &Obstacle),
        added: &mut Vec<(f64, f64)>,
    ) {
        let watched = &self.watched;
        let distance = DistanceBound::new(obstacle);
        // The base is clamped and does not count.
        for i in 2..watched.len() {
            let (from, apart) = (watched[i - 1], watched[i] - watched[i - 1]);
            if distance.least(model.centre(i)) - self.radii[i] > apart {
                continue;
            }
            let [before, after] = [i - 1, i].map(|k| obstacle.surface(model.centre(k)));
            let sum = before.distance - self.radii[i - 1] + after.distance - self.radii[i];
            if sum > apart || before.normal.dot(after.normal) > ALIKE {
                continue;
            }
            let gap = |part: f64| {
                let s = from + part * apart;
                obstacle.surface(model.pose(s).position).distance - self.radius(s)
            };
            let (part, least) = golden_section(SECTIONS, gap);
            let s = from + part * apart;
            let is_known = |other: f64| (other - s).abs() < BETWEEN * apart;
            let mut known = self.along_backbone(number);
            if least < -OVERLAP * self.length
                && !known.any(|pair| is_known(pair.member.arc_length))
                && !added.iter().any(|&(other, _)| is_known(other))
            {
                added.push((s, self.radius(s)));
            }
        }
    }

    /// Where the backbone overlaps an obstacle half-way between two contacts that lie side by side, on both flanks of a narrow one.
    fn between_contacts(
        &self,
        model: &impl Compliant,
        (number, obstacle): (usize, &Obstacle),
        added: &mut Vec<(f64, f64)>,
    ) {
        let touching = self.along_backbone(number).filter(|pair| pair.force > 0.0);
        let mut places: Vec<f64> = touching.map(|pair| pair.member.arc_length).collect();
        places.sort_by(f64::total_cmp);
        for pair in places.windows(2) {
            let (apart, middle) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            let radius = self.radius(middle);
            let gap = || obstacle.surface(model.pose(middle).position).distance - radius;
            if (2.0 * APART * self.length..1.5 * self.spacing(middle)).contains(&apart)
                && gap() < -OVERLAP * self.length
            {
                added.push((middle, radius));
            }
        }
    }

    /// A step on the way begins where the robot is: what touches has not slid yet.
    pub fn begin_step(&mut self, model: &impl Compliant, scene: &Scene) {
        self.near.retain(|pair| pair.force > 0.0 || !pair.keeps_place);
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

    /// How far the robot is from an obstacle that it has no pair with, no more than that; infinitely where it has one.
    pub fn room(&self, model: &impl Compliant, number: usize, obstacle: &Obstacle) -> f64 {
        if self.near.iter().any(|pair| pair.obstacle == number) {
            return f64::INFINITY;
        }
        let of_disk = |member: &Member| (member.arc_length, member.body.reach());
        let along = self.watched.iter().copied().zip(self.radii.iter().copied()).skip(1);
        let all = self.disks.iter().map(of_disk).chain(along);
        let apart =
            |(s, reach): (f64, f64)| obstacle.surface(model.pose(s).position).distance - reach;
        all.map(apart).fold(f64::INFINITY, f64::min)
    }

    /// The deepest overlap of the robot with an obstacle where it is now: obstacle, part, arc length and
    /// depth in m.
    pub fn deepest(
        &self,
        model: &impl Compliant,
        scene: &Scene,
    ) -> Option<(usize, Part, f64, f64)> {
        let mut found = Vec::new();
        let mut deepest: Option<(usize, Part, f64, f64)> = None;
        let mut note = |k: usize, part: Part, arc_length: f64, gap: f64| {
            if -gap > deepest.map_or(OVERLAP * self.length, |known| known.3) {
                deepest = Some((k, part, arc_length, -gap));
            }
        };
        for (k, obstacle) in scene.iter() {
            for member in &self.disks {
                member.body.nearest(obstacle, &model.pose(member.arc_length), 0.0, &mut found);
                for nearest in &found {
                    note(k, member.part, member.arc_length, nearest.gap);
                }
            }
            for (i, (&s, radius)) in model.watched().iter().zip(&self.radii).enumerate().skip(1) {
                let surface = obstacle.surface(model.centre(i));
                note(k, Part::Backbone, s, surface.distance - radius);
            }
        }
        deepest
    }

    /// The deepest place of the robot in an obstacle, with what lies no farther from it than `margin` in m, as if disks were balls: its
    /// normal there and the depth beyond the margin.
    pub fn overlap_with(
        &self,
        model: &impl Compliant,
        obstacle: &Obstacle,
        margin: f64,
    ) -> Option<(Vec3, f64)> {
        let of_disk =
            |member: &Member| (model.pose(member.arc_length).position, member.body.reach());
        let along = (1..self.watched.len()).map(|k| (model.centre(k), self.radii[k]));
        let depth = |(centre, reach): (Vec3, f64)| {
            let Surface { distance, normal } = obstacle.surface(centre);
            (normal, margin + reach - distance)
        };
        let depths = self.disks.iter().map(of_disk).chain(along).map(depth);
        depths.filter(|(_, depth)| *depth > 0.0).max_by(|a, b| a.1.total_cmp(&b.1))
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

/// Thickness of a disk as a part of its radius, where none is given.
const THICKNESS: f64 = 0.1;

impl Pair {
    fn new(obstacle: usize, member: Member, nearest: Nearest) -> Self {
        Self {
            obstacle,
            member,
            nearest,
            keeps_place: false,
            force: 0.0,
            given: [0.0; 6],
            grip: None,
            slide: None,
            is_settled: false,
        }
    }

    /// Where it is nearest to its obstacle at a pose of the cross-section.
    pub fn look(&self, obstacle: &Obstacle, pose: &Pose) -> Nearest {
        let (body, local) = (&self.member.body, self.nearest.local);
        if self.keeps_place {
            body.at_place(obstacle, pose, local)
        } else {
            body.track(obstacle, pose, local)
        }
    }

    /// Angle on the rim.
    fn angle(&self) -> f64 {
        self.nearest.local[1].atan2(self.nearest.local[0])
    }

    /// The force along the surface on the robot, in N.
    fn traction(&self) -> Vec3 {
        self.grip.map_or(Vec3::ZERO, |grip| grip.traction)
    }

    /// Force and moment on the cross-section, where it is now.
    pub fn push(&self) -> [f64; 6] {
        let drag = wrench_of(self.traction(), self.nearest.lever(self.member.body.rounding));
        let push = self.nearest.push();
        core::array::from_fn(|a| self.force * push[a] + drag[a])
    }

    /// Takes over what a step found, or a part of it.
    pub fn hold(&mut self, sticks: bool, traction: Vec3, part: f64) {
        let touches = self.force > 0.0;
        if let Some(grip) = &mut self.grip {
            grip.take(touches, sticks, traction, part);
        }
    }
}

/// Whether a rim is about as near to an obstacle all around, as these pairs of it have seen it before.
fn is_all_around<'a>(rim: Rim, mut pairs: impl Iterator<Item = &'a Pair>) -> bool {
    let [least, most] = ALL_AROUND;
    let Rim::Spread(spread) = rim else { return false };
    spread < least || spread < most && pairs.any(|pair| pair.keeps_place)
}

/// The places of a rim that is about as near to an obstacle all around: each is a contact that keeps its place, so that its gap
/// is linear in small motions however narrow a bore is.
struct RimPlaces<'a> {
    member: &'a Member,
    pose: &'a Pose,
    obstacle: (usize, &'a Obstacle),
}

impl RimPlaces<'_> {
    /// Adds places so that no part of the rim is left out, and one wherever the rim overlaps between those that are known.
    fn add(
        &self,
        found: &[Nearest],
        (within, overlap): (f64, f64),
        grip: Option<Grip>,
        near: &mut Vec<Pair>,
    ) {
        use core::f64::consts::TAU;
        let is_of_rim =
            |pair: &Pair| pair.obstacle == self.obstacle.0 && pair.member.part == self.member.part;
        // By angle, with the forces.
        let mut known: Vec<(f64, f64)> = Vec::new();
        for pair in near.iter_mut().filter(|pair| is_of_rim(pair)) {
            pair.keeps_place = true;
            known.push((pair.angle(), pair.force));
        }
        let lowest = found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let Some(lowest) = lowest else { return };
        let mut more: Vec<f64> = Vec::new();
        let angle = |nearest: &Nearest| nearest.local[1].atan2(nearest.local[0]);
        if known.is_empty() {
            let first = angle(lowest);
            known.push((first, 0.0));
            more.push(first);
        }
        let apart = |a: f64, b: f64| {
            let turn = (a - b).rem_euclid(TAU);
            turn.min(TAU - turn)
        };
        for overlapping in found.iter().filter(|nearest| nearest.gap < -overlap) {
            let at = angle(overlapping);
            let beside = |ahead: bool| {
                let way =
                    |other: f64| (if ahead { other - at } else { at - other }).rem_euclid(TAU);
                let pushing = known.iter().filter(|(_, force)| *force > 0.0);
                pushing
                    .map(|&(other, force)| (way(other), other, force))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
            };
            // Where two places beside it push, the rim touches where their resultant points.
            let place = match (beside(true), beside(false)) {
                (Some((ahead, a, f)), Some((behind, b, g))) if ahead + behind < 0.5 * TAU => {
                    let (x, y) = (f * a.cos() + g * b.cos(), f * a.sin() + g * b.sin());
                    y.atan2(x)
                }
                _ => at,
            };
            let is_free = |place: f64, least: f64| {
                known.iter().all(|&(other, _)| apart(place, other) > least)
            };
            for place in [place, at] {
                if is_free(place, APART_ON_RIM) {
                    more.push(place);
                    known.push((place, 0.0));
                    break;
                }
            }
        }
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        for k in 0..known.len() {
            let (from, next) = (known[k].0, known[(k + 1) % known.len()].0);
            let turn = (next - from).rem_euclid(TAU);
            let turn = if turn == 0.0 { TAU } else { turn };
            let parts = (turn / BETWEEN_PLACES).ceil();
            more.extend((1..parts as usize).map(|i| from + turn * i as f64 / parts));
        }
        for angle in more {
            let (number, obstacle) = self.obstacle;
            let body = &self.member.body;
            let nearest = body.at_place(obstacle, self.pose, body.on_rim(angle));
            if nearest.gap <= within {
                let pair = Pair::new(number, *self.member, nearest);
                near.push(Pair { grip, keeps_place: true, ..pair });
            }
        }
    }
}

/// The grip of a part that comes near, where the obstacle has friction.
fn grip(model: &impl Compliant, scene: &Scene, obstacle: usize, arc_length: f64) -> Option<Grip> {
    let coefficient = scene.get(obstacle).friction;
    let from = || scene.carried(model.pose_before(arc_length));
    (coefficient > 0.0).then(|| Grip::new(coefficient, from()))
}

/// Where the parabola through three points is least, not beyond the middles of their intervals, and its value there.
fn vertex([a, b, c]: [f64; 3], [fa, fb, fc]: [f64; 3]) -> (f64, f64) {
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let bend = (right - left) / (c - a);
    if bend <= 0.0 {
        return (b, fb);
    }
    let at = (0.5 * (a + b) - 0.5 * left / bend).clamp(0.5 * (a + b), 0.5 * (b + c));
    (at, fa + (at - a) * (left + (at - b) * bend))
}
