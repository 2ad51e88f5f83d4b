//! The places of a rim that is about as near to an obstacle all around, as in a narrow bore.

use whipcord_numerics::Pose;

use super::body::{Nearest, Rim};
use super::friction::Grip;
use super::member::Member;
use super::pair::Pair;
use crate::obstacle::Obstacle;

/// A rim is about as near all around where its distances from the obstacle differ by less than this part of its radius; and
/// remains so until they differ by more than the other.
const ALL_AROUND: [f64; 2] = [0.05, 0.1];
/// The largest angle in rad between two places of such a rim that are looked at; four or five are on each rim.
const BETWEEN_PLACES: f64 = 0.6 * core::f64::consts::PI;
/// The least angle in rad between two of them.
const APART_ON_RIM: f64 = 1e-4;

/// Whether a rim is about as near to an obstacle all around, as these pairs of it have seen it before.
pub(super) fn is_all_around<'a>(rim: Rim, mut pairs: impl Iterator<Item = &'a Pair>) -> bool {
    let [least, most] = ALL_AROUND;
    let Rim::Spread(spread) = rim else { return false };
    spread < least || spread < most && pairs.any(|pair| pair.keeps_place)
}

/// The places of a rim that is about as near to an obstacle all around: each is a contact that keeps its place, so that its gap
/// is linear in small motions however narrow a bore is.
pub(super) struct RimPlaces<'a> {
    pub member: &'a Member,
    pub pose: &'a Pose,
    pub obstacle: (usize, &'a Obstacle),
}

impl RimPlaces<'_> {
    /// Adds places so that no part of the rim is left out, and one wherever the rim overlaps between those that are known.
    pub fn add(
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
            let (obstacle, body) = (self.obstacle.1, &self.member.body);
            let overlaps =
                |angle: f64| body.at_place(obstacle, self.pose, body.on_rim(angle)).gap < -overlap;
            for place in [place, at] {
                if is_free(place, APART_ON_RIM) && (place == at || overlaps(place)) {
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
