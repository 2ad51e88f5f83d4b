//! How far a robot may move in one step on the way, so that no part of it passes through an obstacle.

use whipcord_numerics::Vec3;

use super::scene::{DistanceBound, Scene, is_pipe};
use crate::obstacle::Obstacle;

/// No cross-section moves farther in one step on the way, as a part of the length.
pub(super) const STRIDE: f64 = 0.25;
/// A step that is too long is shortened to this part of one that is not.
pub(super) const SHORTENED: f64 = 0.9;
/// Free balls below this part of the length count as it, where they bound the steps on the way.
const LEAST_REACH: f64 = 0.005;

/// A step that ends at a round place of the way, if that is not much nearer: the same for neighbouring cases, as friction remembers the places
/// of the way.
pub(super) fn rounded(way: f64, step: f64) -> f64 {
    const PLACES: [f64; 2] = [64.0, 512.0];
    let rounded = PLACES.map(|places| ((way + step) * places).floor() / places - way);
    rounded.into_iter().find(|&rounded| rounded >= 0.5 * step).unwrap_or(step)
}

/// The centres of the cross-sections before a step, in a scene of this length.
pub(super) struct StepLength<'a> {
    pub scene: &'a Scene,
    pub before: &'a [Vec3],
    pub length: f64,
}

impl StepLength<'_> {
    /// By which part the step was too long, if any cross-section could have passed through an obstacle or a side of one on
    /// its way to the centres where it is now. It has not where the free balls around its centre before and after cover the
    /// way, eq. (7).
    pub fn too_far(&self, centre: impl Fn(usize) -> Vec3) -> Option<f64> {
        let least = LEAST_REACH * self.length;
        let mut part = f64::INFINITY;
        for (k, old) in self.before.iter().enumerate().skip(1) {
            let way = (centre(k) - *old).norm();
            if way > least {
                part = part.min(STRIDE * self.length / way);
            }
        }
        // A long way costs much to look at, and is not taken anyway.
        if part < 1.0 {
            return Some((SHORTENED * part).clamp(0.1, 0.7));
        }
        for (number, obstacle) in self.scene.iter().filter(|(_, o)| !is_pipe(o)) {
            let mut distances = [DistanceBound::new(obstacle); 2];
            for (k, old) in self.before.iter().enumerate().skip(1) {
                let points = [self.scene.carry_point(number, *old), centre(k)];
                let way = (points[1] - points[0]).norm();
                let bound = |i: usize| distances[i].least(points[i]);
                if way <= least || bound(0).min(bound(1)) > 0.5 * way {
                    continue;
                }
                let measured = [0, 1].map(|i| distances[i].measure(points[i]));
                if !is_covered(obstacle, points, measured, least) {
                    let [before, after] = measured.map(|distance| room(distance, least));
                    part = part.min((before + after) / way);
                }
            }
        }
        (part < 1.0).then(|| (SHORTENED * part).clamp(0.1, 0.7))
    }
}

/// Radius in m of the free ball around a point at a distance from an obstacle, which counts as `least` where it is less.
fn room(distance: f64, least: f64) -> f64 {
    if distance > -least { distance.max(least) } else { 0.0 }
}

/// Whether free balls around the ends of a straight line, and around points between them where these do not suffice, cover it:
/// eq. (7). `distances` are those of its ends.
fn is_covered(obstacle: &Obstacle, line: [Vec3; 2], distances: [f64; 2], least: f64) -> bool {
    let way = (line[1] - line[0]).norm();
    let [before, after] = distances.map(|distance| room(distance, least));
    if before == 0.0 || after == 0.0 {
        return false;
    }
    if before + after >= way {
        return true;
    }
    let middle = (line[0] + line[1]) * 0.5;
    let distance = obstacle.surface(middle).distance;
    // Inside, it may be on its way through.
    distance > 0.0
        && is_covered(obstacle, [line[0], middle], [distances[0], distance], least)
        && is_covered(obstacle, [middle, line[1]], [distance, distances[1]], least)
}
