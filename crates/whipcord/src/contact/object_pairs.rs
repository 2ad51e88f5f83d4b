//! Contacts of movable objects with obstacles and with one another.

use whipcord_numerics::{Pose, Vec3};

use super::body::{Nearest, along};
use super::friction::Grip;
use super::object::{Object, Objects};
use super::object_pair::{NEAR, ObjectPair};
use super::pair::OVERLAP;
use super::scene::Scene;
use crate::solution::{ObjectContact, Solution};

/// Contacts that are no farther apart than this part of the length of the robot are one.
const ONE: f64 = 1e-6;

impl Objects {
    /// Looks at all pairs again where the objects are now.
    pub fn refresh(&mut self, scene: &Scene, length: f64) {
        for k in 0..self.near.len() {
            let ObjectPair { owner, other, part, nearest, .. } = self.near[k];
            let pose = self.pose_of(owner, scene);
            let features = &self.features[owner];
            let nearest = features.track(part, scene.get(other), &pose, nearest.local);
            let pair = &mut self.near[k];
            pair.nearest = nearest;
            pair.point = pose.position + nearest.lever(pair.rounding);
            if let Some(grip) = &mut pair.grip {
                let from = scene.carry(other, grip.from);
                grip.refresh(&pose, &nearest, pair.rounding, from);
            }
        }
        let far = 2.0 * NEAR * length;
        self.near.retain(|pair| pair.force > 0.0 || pair.nearest.gap < far);
    }

    /// Which of two obstacles is to be looked at for parts that touch the other, by their numbers.
    fn owners(&self, a: usize, b: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (own, its) = (&self.features[a], &self.features[b]);
        // A ball alone says where it touches, and so does a capsule, but for two of them.
        let (by_own, by_its) = match (own.is_ball, its.is_ball) {
            (true, _) => (true, false),
            (_, true) => (false, true),
            _ if own.is_round == its.is_round => (true, true),
            _ => (own.is_round, its.is_round),
        };
        let both = [(a, b, by_own), (b, a, by_its)];
        both.into_iter().filter(|(.., counts)| *counts).map(|(owner, other, _)| (owner, other))
    }

    /// Distance of an object from an obstacle in m.
    pub fn gap(&self, object: &Object, number: usize, scene: &Scene) -> f64 {
        let mut found = Vec::new();
        for (owner, other) in self.owners(object.number, number) {
            let pose = self.pose_of(owner, scene);
            self.features[owner].near(scene.get(other), &pose, f64::INFINITY, &mut found);
        }
        found.iter().map(|(_, nearest)| nearest.gap).fold(f64::INFINITY, f64::min)
    }

    /// Adds the pairs that have come near.
    pub fn discover(&mut self, scene: &Scene, length: f64) {
        let within = NEAR * length;
        let mut found = Vec::new();
        for a in 0..self.list.len() {
            let object = self.list[a];
            for (number, obstacle) in scene.iter() {
                let is_later =
                    self.list.iter().position(|other| other.number == number).is_none_or(|b| b > a);
                if number == object.number || !is_later {
                    continue;
                }
                let apart = obstacle.surface(object.pose.position).distance - object.reach;
                if apart > within {
                    continue;
                }
                for (owner, other) in self.owners(object.number, number) {
                    found.clear();
                    let pose = self.pose_of(owner, scene);
                    self.features[owner].near(scene.get(other), &pose, within, &mut found);
                    for &(part, nearest) in &found {
                        self.add(owner, other, (part, nearest), &pose, scene, length);
                    }
                }
            }
        }
    }

    fn add(
        &mut self,
        owner: usize,
        other: usize,
        (part, nearest): (usize, Nearest),
        pose: &Pose,
        scene: &Scene,
        length: f64,
    ) {
        let rounding = self.features[owner].rounding;
        let point = pose.position + nearest.lever(rounding);
        let known = |pair: &ObjectPair| {
            let same =
                [(pair.owner, pair.other), (pair.other, pair.owner)].contains(&(owner, other));
            same && (pair.owner == owner && pair.part == part
                || (pair.point - point).norm() < ONE * length)
        };
        if self.near.iter().any(known) {
            return;
        }
        let coefficient = scene.get(owner).friction.min(scene.get(other).friction);
        let grip = (coefficient > 0.0).then(|| {
            let began = self.list.iter().find(|object| object.number == owner);
            Grip::new(coefficient, began.map_or(*pose, |object| object.began))
        });
        self.near.push(ObjectPair {
            owner,
            other,
            part,
            nearest,
            rounding,
            point,
            force: 0.0,
            grip,
        });
    }

    /// Takes over the contacts of a known answer.
    pub fn resume(&mut self, answer: &Solution, to_base: &Pose, scene: &Scene, length: f64) {
        self.discover(scene, length);
        let number = |k: usize| answer.objects[k].obstacle;
        for (k, state) in answer.objects.iter().enumerate() {
            for contact in &state.contacts {
                let point = to_base.transform(contact.point);
                let between = [(number(k), contact.obstacle), (contact.obstacle, number(k))];
                let near = self.near.iter_mut().filter(|pair| {
                    between.contains(&(pair.owner, pair.other))
                        && (pair.point - point).norm() < 10.0 * NEAR * length
                });
                let nearest = near
                    .min_by(|a, b| (a.point - point).norm().total_cmp(&(b.point - point).norm()));
                let Some(pair) = nearest else { continue };
                // On the owner.
                let side = if pair.owner == number(k) { 1.0 } else { -1.0 };
                pair.force = contact.force;
                if let Some(grip) = &mut pair.grip {
                    let traction = to_base.rotation.rotate(contact.friction) * side;
                    grip.traction = along(traction, pair.nearest.normal);
                    grip.sticks = contact.sticks;
                }
            }
        }
    }

    /// The deepest overlap of two obstacles of which one can move: both and the depth in m.
    pub fn deepest(&self, scene: &Scene, length: f64) -> Option<(usize, usize, f64)> {
        let mut all = self.clone();
        all.near.clear();
        all.discover(scene, length);
        let deepest = all.near.iter().min_by(|a, b| a.nearest.gap.total_cmp(&b.nearest.gap))?;
        let depth = -deepest.nearest.gap;
        (depth > OVERLAP * length).then_some((deepest.owner, deepest.other, depth))
    }

    /// The contacts of an object with obstacles and other objects, in the frame that the base's pose is given in.
    pub fn contacts_of(&self, number: usize, base: &Pose) -> Vec<ObjectContact> {
        let of = |pair: &ObjectPair| {
            let (other, side) = match number {
                _ if pair.force <= 0.0 => return None,
                number if pair.owner == number => (pair.other, 1.0),
                number if pair.other == number => (pair.owner, -1.0),
                _ => return None,
            };
            let traction = pair.grip.map_or(Vec3::ZERO, |grip| grip.traction);
            Some(ObjectContact {
                obstacle: other,
                point: base.transform(pair.point),
                normal: base.rotation.rotate(pair.nearest.normal) * side,
                force: pair.force,
                friction: base.rotation.rotate(traction) * side,
                sticks: pair.grip.is_some_and(|grip| grip.sticks),
                gap: pair.nearest.gap,
            })
        };
        self.near.iter().filter_map(of).collect()
    }
}
