//! Which parts of the robot have come near which obstacles, where it is now.

use whipcord_numerics::{Vec3, golden_section};

use super::body::{Body, Nearest};
use super::member::Member;
use super::model::Compliant;
use super::pair::{OVERLAP, Pair, grip};
use super::pairs::{BETWEEN, BackboneContacts, NEAR, Pairs};
use super::rim_places::{RimPlaces, is_all_around};
use super::scene::{DistanceBound, Scene};
use crate::obstacle::Obstacle;
use crate::solution::Part;

/// So often a contact is added at one place of the backbone while one equilibrium is looked for.
const ATTEMPTS: usize = 2;
/// Least distance of two of those, where one lies between two watched places.
const CROWDED: f64 = 0.5;
/// Least distance of two contacts of the backbone, as a part of its length.
const APART: f64 = 1e-5;
/// Normals whose cosine is greater are those of a smooth surface, on which the gap is a parabola between two watched places.
const ALIKE: f64 = 0.98;
/// Of the search for the least gap between two watched places: its interval becomes 1e-5 of their distance.
const SECTIONS: usize = 24;

/// Contacts of the backbone are looked at from this part of [`NEAR`] on where it goes into a pipe, of which it may be near to both sides.
const NEAR_IN_PIPE: f64 = 0.2;

impl Pairs {
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
        let within = match self.backbone {
            BackboneContacts::Anywhere => within,
            BackboneContacts::AtWatchedPlaces => NEAR_IN_PIPE * within,
        };
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
        let mut placed: Vec<f64> = Vec::new();
        let mut moved: Vec<(usize, f64)> = Vec::new();
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
            let is_smooth = self.backbone == BackboneContacts::Anywhere
                && i < last
                && before.is_finite()
                && model.corner(i).is_none();
            let (mut arc_length, mut least) = (watched[i], here);
            if is_smooth {
                (arc_length, least) = vertex([watched[i - 1], watched[i], watched[i + 1]], gaps);
                if closely && least < -OVERLAP * self.length {
                    // Beside a jump of the slope the parabola tells of an overlap that is not there.
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
            let overlaps = closely && here < overlap;
            if overlaps && self.near.iter().any(is_beside) {
                (arc_length, least) = (watched[i], here);
            }
            // Shear tilts the cross-sections, so that the gap need not be least where a contact has come to along the backbone.
            let has_come_beside = |pair: &Pair| {
                pair.obstacle == number
                    && pair.member.part == Part::Backbone
                    && pair.slide.is_some()
                    && (pair.member.arc_length - watched[i]).abs() < BETWEEN * apart
            };
            if overlaps && let Some(beside) = self.near.iter().position(has_come_beside) {
                moved.push((beside, watched[i]));
                continue;
            }
            let spacing = match (overlaps, closely && least < overlap) {
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
                // Beside a contact that has come to a place where the gap is not least it would come there, too: it keeps its place.
                let has_come = |pair: &Pair| is_beside(pair) && pair.slide.is_some();
                if overlaps && self.near.iter().any(has_come) {
                    placed.push(arc_length);
                }
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
        let mut elsewhere = !moved.is_empty();
        for (beside, watched) in moved {
            self.move_to(beside, watched, model, scene);
            self.near[beside].is_placed = true;
        }
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
                self.near[between].is_placed = true;
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
            let is_placed = placed.contains(&arc_length);
            self.near.push(Pair { grip, is_placed, ..Pair::new(number, member, nearest) });
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
