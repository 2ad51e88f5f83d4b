//! Contacts of the backbone that move along it to where its gap is least, eq. (11) of `docs/theory/contact.md`.

use whipcord_numerics::{Pose, Vec3};

use super::model::Compliant;
use crate::obstacle::Obstacle;

/// A gap that bends by less than this along the backbone, in units of 1/L, has no least place: the contact keeps its own.
const FLAT: f64 = 0.1;
/// Differences along the normal, relative to the radius of the backbone.
const STEP: f64 = 1e-4;
/// Distances at which the bend is measured, as parts of that between watched places: at first, and at least.
const BESIDE: [f64; 2] = [0.25, 1e-3];
/// No contact moves farther at once, as a part of that distance.
const FARTHEST: f64 = 0.5;
/// A contact that is nearer than this to its place, as a part of the length, stays.
const THERE: f64 = 1e-9;

/// How a contact of the backbone moves along it, linearised: its slope there is `σ + a·δX + β δs`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slide {
    /// Slope `σ` of the gap along the backbone.
    slope: f64,
    /// Its bend `β` in 1/m, positive.
    bend: f64,
    /// `a`: how the slope changes with the motion of the cross-section, and how a unit push changes along the backbone.
    pub along: [f64; 6],
    /// It moves no farther than this back and forth, in m.
    limits: [f64; 2],
}

impl Slide {
    /// Of a ball of the backbone at an arc length to which it has come by a way of `moved` m; `None` where it keeps its place. The bend is
    /// that as far around as it has moved: beside an edge it jumps, and a mean value across the jump would lead to and fro.
    pub fn of(
        model: &impl Compliant,
        obstacle: &Obstacle,
        (s, radius, moved): (f64, f64, f64),
        length: f64,
    ) -> Option<Self> {
        let watched = model.watched();
        let last = watched.len() - 1;
        // From the watched place before, or at it, to the one behind.
        let k = watched.partition_point(|&there| there <= s).clamp(1, last);
        if s == watched[k - 1] && model.corner(k - 1).is_some() {
            return None;
        }
        let spacing = watched[k] - watched[k - 1];
        let ends = [
            // Beyond a watched place that is no corner, too.
            if k > 1 && model.corner(k - 1).is_none() {
                watched[k - 1] - spacing
            } else {
                watched[k - 1]
            },
            if k < last && model.corner(k).is_none() { watched[k] + spacing } else { watched[k] },
        ];
        // The base is clamped.
        let ends = [ends[0].max(0.5 * watched[1]), ends[1].min(watched[last])];
        let [widest, least] = BESIDE.map(|part| part * spacing);
        let at = s.max(ends[0]).min(ends[1]);
        let around = |beside: f64| [(at - beside).max(ends[0]), (at + beside).min(ends[1])];
        let [before, after] = around(least);
        if before >= after {
            return None;
        }
        let pose = model.pose(s);
        let tangent = pose.rotation.rotate(Vec3::Z);
        // An arc whose chord keeps its length is longer than its arc length says.
        let [behind, ahead] = [before, after].map(|s| model.pose(s).position);
        let stretch = (ahead - behind).dot(tangent) / (after - before);
        let slope_at = |pose: &Pose| {
            let tangent = pose.rotation.rotate(Vec3::Z);
            obstacle.surface(pose.position).normal.dot(tangent) * stretch
        };
        let bend_within = |beside: f64| {
            let [before, after] = around(beside);
            let slopes = [before, after].map(|s| slope_at(&model.pose(s)));
            let bend = (slopes[1] - slopes[0]) / (after - before);
            (bend.is_finite() && bend * length > FLAT).then_some(bend)
        };
        let bend = bend_within(widest)?;
        let near = moved.max(least);
        let bend = if near < widest { bend_within(near).unwrap_or(bend) } else { bend };
        let normal = |h: f64| obstacle.surface(pose.position + tangent * h).normal;
        let h = STEP * radius;
        let turns = (normal(h) - normal(-h)) * (0.5 * stretch / h);
        let here = normal(0.0);
        let across = tangent.cross(here) * stretch;
        let along = [turns.x, turns.y, turns.z, across.x, across.y, across.z];
        let farthest = FARTHEST * spacing;
        let limits = [(ends[0] - s).clamp(-farthest, 0.0), (ends[1] - s).clamp(0.0, farthest)];
        let slide = Self { slope: here.dot(tangent) * stretch, bend, along, limits };
        let way = -slide.slope / bend;
        let is_at_end = way < 0.0 && limits[0] == 0.0 || way > 0.0 && limits[1] == 0.0;
        (!is_at_end).then_some(slide)
    }

    /// How far it moves with a motion of the cross-section, in m.
    pub fn way(&self, motion: &[f64]) -> f64 {
        let turned: f64 = self.along.iter().zip(motion).map(|(a, x)| a * x).sum();
        let way = -(self.slope + turned) / self.bend;
        way.clamp(self.limits[0], self.limits[1])
    }

    /// How far it is from its place, in m.
    pub fn left(&self) -> f64 {
        self.way(&[])
    }

    /// What the gap is less by at its place, in m.
    pub fn depth(&self) -> f64 {
        let way = self.left();
        -way * (self.slope + 0.5 * self.bend * way)
    }

    /// How a force in N changes with the motion of the cross-section as the contact follows it: `−λ a aᵀ/β`.
    pub fn stiffness(&self, force: f64) -> [[f64; 6]; 6] {
        let a = &self.along;
        core::array::from_fn(|i| core::array::from_fn(|j| -force * a[i] * a[j] / self.bend))
    }

    /// Whether a way in m is too short, in a scene of this length, for the contact to be moved.
    pub fn is_negligible(way: f64, length: f64) -> bool {
        way.abs() <= THERE * length
    }
}
