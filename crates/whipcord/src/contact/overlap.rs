//! How far the robot is from obstacles, or how deep in them, where it is now.

use whipcord_numerics::Vec3;

use super::member::Member;
use super::model::Compliant;
use super::pair::OVERLAP;
use super::pairs::Pairs;
use super::scene::Scene;
use crate::obstacle::{Obstacle, Surface};
use crate::solution::Part;

impl Pairs {
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
}
