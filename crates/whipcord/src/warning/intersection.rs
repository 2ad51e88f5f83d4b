//! Whether a shape passes through itself: the backbone as a chain of capsules, the disks as flat discs.

use core::f64::consts::PI;

use super::kinds::{Place, Warning};
use super::span;
use crate::robot::Robot;
use crate::shape::Shape;
use crate::solution::Solution;
use whipcord_numerics::{Pose, Vec3};

/// Pieces of the backbone that are compared, at most; so many comparisons take a millisecond.
const MOST_PIECES: usize = 240;
/// Pieces between two stations, at most.
const PIECES: usize = 8;

/// A straight piece of the backbone.
struct Piece {
    ends: [Vec3; 2],
    /// Arc lengths in m.
    from: f64,
    to: f64,
    radius: f64,
}

impl Piece {
    fn middle(&self) -> f64 {
        0.5 * (self.from + self.to)
    }
}

/// A disk without thickness.
struct Disc {
    number: usize,
    arc_length: f64,
    pose: Pose,
    radius: f64,
}

pub(super) fn warnings(robot: &Robot, solution: &Solution) -> Vec<Warning> {
    let discs = discs(robot, &solution.disks);
    let mut found = Vec::new();
    let overlap = overlapping_neighbours(robot, &solution.disks);
    let disks_overlap = overlap.is_some();
    found.extend(overlap);
    let finer = solution.shape.poses.len() > solution.disks.poses.len();
    let shape = if finer { &solution.shape } else { &solution.disks };
    let pieces = pieces(robot, shape);
    let crossing = backbone_and_backbone(&pieces)
        .or_else(|| backbone_and_disc(&pieces, &discs))
        .or_else(|| if disks_overlap { None } else { disc_and_disc(&discs) });
    found.extend(crossing);
    found
}

/// The backbone between the stations, with constant strains from one to the next.
fn pieces(robot: &Robot, shape: &Shape) -> Vec<Piece> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let spans = shape.poses.len().saturating_sub(1);
    if spans == 0 {
        return Vec::new();
    }
    // Of very many stations every few ones are taken.
    let stride = spans.div_ceil(MOST_PIECES);
    let division = (MOST_PIECES / spans).clamp(1, PIECES);
    let mut pieces = Vec::with_capacity(spans.min(MOST_PIECES) * division + 1);
    let mut at = 0;
    while at < spans {
        let next = (at + stride).min(spans);
        let (start, length) = (shape.arc_length[at], shape.arc_length[next] - shape.arc_length[at]);
        // Where no constant strain leads from one to the next the piece is straight.
        let strain = span::strain(shape.poses[at], shape.poses[next], length);
        let mut previous = shape.poses[at].position;
        for k in 1..=division {
            let share = |k: usize| k as f64 / division as f64;
            let end = match strain {
                Some(strain) if k < division => {
                    (shape.poses[at] * Pose::exp(strain * (share(k) * length))).position
                }
                Some(_) => shape.poses[next].position,
                None => {
                    let start = shape.poses[at].position;
                    start + (shape.poses[next].position - start) * share(k)
                }
            };
            let (from, to) = (start + share(k - 1) * length, start + share(k) * length);
            let radius = backbone.outer_radius_at(disks, 0.5 * (from + to));
            pieces.push(Piece { ends: [previous, end], from, to, radius });
            previous = end;
        }
        at = next;
    }
    pieces
}

/// The disks of which a radius is known.
fn discs(robot: &Robot, shape: &Shape) -> Vec<Disc> {
    let stride = shape.poses.len().div_ceil(MOST_PIECES).max(1);
    let all = shape.arc_length.iter().zip(&shape.poses).enumerate().step_by(stride);
    all.map(|(i, (&arc_length, &pose))| Disc {
        number: i + 1,
        arc_length,
        pose,
        radius: robot.disks().rim_radius(i),
    })
    .filter(|disc| disc.radius > 0.0)
    .collect()
}

/// Neighbouring disks whose rims meet on the inner side of a bend.
fn overlapping_neighbours(robot: &Robot, shape: &Shape) -> Option<Warning> {
    let disks = robot.disks();
    let thickness = disks.thickness.unwrap_or(0.0);
    let deepest = shape.poses.windows(2).enumerate().filter_map(|(i, pair)| {
        let (radius, other) = (disks.rim_radius(i), disks.rim_radius(i + 1));
        if radius.min(other) <= 0.0 {
            return None;
        }
        let next = pair[0].inverse() * pair[1];
        let normal = next.rotation.rotate(Vec3::Z);
        // The direction in the plane of the next disk that descends most, and the lowest point of its rim.
        let down = normal * normal.z - Vec3::Z;
        if down.norm() < 1e-9 {
            return None;
        }
        let lowest = next.position + down * (other / down.norm());
        let beside = lowest.x.hypot(lowest.y) > radius + other;
        let overlap = thickness - lowest.z;
        (!beside && overlap > 1e-9 * other).then_some((i, overlap))
    });
    let (i, overlap) = deepest.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Warning::DisksOverlap { disk: i + 1, overlap })
}

/// How many entries of a chain can be passed over where the next is at least this far away, when each is at most
/// `step` long.
fn passed_over(gap: f64, step: f64) -> usize {
    if gap > step { ((gap / step) as usize).min(MOST_PIECES * PIECES) } else { 1 }
}

fn longest(pieces: &[Piece]) -> f64 {
    pieces.iter().map(|piece| (piece.ends[1] - piece.ends[0]).norm()).fold(0.0, f64::max)
}

fn backbone_and_backbone(pieces: &[Piece]) -> Option<Warning> {
    let step = longest(pieces);
    let widest = pieces.iter().map(|piece| piece.radius).fold(0.0, f64::max);
    for (i, a) in pieces.iter().enumerate() {
        let mut next = i + 1;
        while let Some(b) = pieces.get(next) {
            let reach = a.radius + b.radius;
            // A rod that turns back as tightly as its own thickness lets it touches itself half a circle on.
            if b.from - a.to <= PI * reach {
                next += 1;
                continue;
            }
            let distance = segment_distance(a.ends, b.ends);
            if distance < reach.max(1e-12) * (1.0 - 1e-6) {
                return Some(Warning::SelfIntersection {
                    first: Place::Backbone(a.middle()),
                    second: Place::Backbone(b.middle()),
                });
            }
            next += passed_over(distance - a.radius - widest, step);
        }
    }
    None
}

fn backbone_and_disc(pieces: &[Piece], discs: &[Disc]) -> Option<Warning> {
    let step = longest(pieces);
    let widest = pieces.iter().map(|piece| piece.radius).fold(0.0, f64::max);
    for disc in discs {
        let to_disc = disc.pose.inverse();
        let mut next = 0;
        while let Some(piece) = pieces.get(next) {
            next += 1;
            let length = piece.to - piece.from;
            // The pieces that begin and end at the disk cross its plane there.
            if piece.from - length <= disc.arc_length && disc.arc_length <= piece.to + length {
                continue;
            }
            let [a, b] = piece.ends.map(|point| to_disc.transform(point));
            let share = a.z / (a.z - b.z);
            let crosses = (a.z > 0.0) != (b.z > 0.0) && {
                let crossing = a + (b - a) * share;
                crossing.x.hypot(crossing.y) < disc.radius + piece.radius
            };
            if crosses {
                let (disk, backbone) = (Place::Disk(disc.number), Place::Backbone(piece.middle()));
                let (first, second) = match piece.middle() < disc.arc_length {
                    true => (backbone, disk),
                    false => (disk, backbone),
                };
                return Some(Warning::SelfIntersection { first, second });
            }
            next += passed_over(b.norm() - disc.radius - widest, step) - 1;
        }
    }
    None
}

fn disc_and_disc(discs: &[Disc]) -> Option<Warning> {
    let apart = |pair: &[Disc]| (pair[1].pose.position - pair[0].pose.position).norm();
    let step = discs.windows(2).map(apart).fold(0.0, f64::max);
    let widest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
    for (i, a) in discs.iter().enumerate() {
        let mut next = i + 2;
        while let Some(b) = discs.get(next) {
            if discs_cross(a, b) {
                return Some(Warning::SelfIntersection {
                    first: Place::Disk(a.number),
                    second: Place::Disk(b.number),
                });
            }
            let between = (b.pose.position - a.pose.position).norm();
            next += passed_over(between - a.radius - widest, step);
        }
    }
    None
}

/// Whether two discs share a point: both cut the line in which their planes meet, and where they cut it.
fn discs_cross(a: &Disc, b: &Disc) -> bool {
    let between = b.pose.position - a.pose.position;
    if between.norm() > a.radius + b.radius {
        return false;
    }
    let [n, m] = [a, b].map(|disc| disc.pose.rotation.rotate(Vec3::Z));
    let line = n.cross(m);
    let squared = line.norm_squared();
    if squared < 1e-12 {
        return false;
    }
    // Seen from the centre of the first.
    let point = line.cross(n) * (m.dot(between) / squared);
    let direction = line / squared.sqrt();
    let cut = |centre: Vec3, radius: f64| {
        let to = centre - point;
        let along = to.dot(direction);
        let half = radius * radius - (to.norm_squared() - along * along);
        (half > 0.0).then(|| [along - half.sqrt(), along + half.sqrt()])
    };
    match (cut(Vec3::ZERO, a.radius), cut(between, b.radius)) {
        (Some(a), Some(b)) => a[0].max(b[0]) < a[1].min(b[1]),
        _ => false,
    }
}

/// Least distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
fn segment_distance(a: [Vec3; 2], b: [Vec3; 2]) -> f64 {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, vv, uv, uw, vw) = (u.dot(u), v.dot(v), u.dot(v), u.dot(w), v.dot(w));
    let share =
        |top: f64, bottom: f64| if bottom > 0.0 { (top / bottom).clamp(0.0, 1.0) } else { 0.0 };
    let denominator = uu * vv - uv * uv;
    let mut s =
        if denominator > 1e-14 * uu * vv { share(uv * vw - uw * vv, denominator) } else { 0.0 };
    let t = share(uv * s + vw, vv);
    s = share(uv * t - uw, uu);
    (w + u * s - v * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_segments_are_those_of_their_nearest_points() {
        let p = Vec3::new;
        let x = [p(-1.0, 0.0, 0.0), p(1.0, 0.0, 0.0)];
        for (other, expected) in [
            ([p(0.0, -1.0, 0.5), p(0.0, 1.0, 0.5)], 0.5),
            ([p(2.0, 0.0, 0.0), p(3.0, 1.0, 0.0)], 1.0),
            ([p(-5.0, 2.0, 0.0), p(5.0, 2.0, 0.0)], 2.0),
            ([p(0.0, 3.0, 0.0), p(0.0, 3.0, 0.0)], 3.0),
        ] {
            assert!((segment_distance(x, other) - expected).abs() < 1e-12, "{other:?}");
            assert!((segment_distance(other, x) - expected).abs() < 1e-12, "{other:?}");
        }
    }
}
