//! The list of holes that brings one disk nearest to a point, of all lists, by meeting in the middle.
//!
//! With the pose g of a disk in the middle and the place r of the last disk in its frame, `‖g r − x‖ = ‖r − g⁻¹ x‖`, eq. (3): of all ways from the
//! middle on the places r are in a tree of boxes (R*-tree), and every way to the middle asks it for the one nearest to `g⁻¹ x`. Of ways to the middle only the point in the
//! frame of the disk before it is kept.

use rstar::RTree;
use rstar::primitives::GeomWithData;
use whipcord::{Mat3, Pose, Vec3};

use crate::choices::Choices;
use crate::shape_search::Found;
use crate::span_table::SpanTable;

/// Ways to the disk before the middle and from the middle on that are kept, and ways to the middle that are looked at.
const MOST: usize = 4_000_000;
const MOST_LOOKED_AT: usize = 60_000_000;
/// A place takes about so many times as long to put in a tree as a tree takes to be asked.
const TREE: usize = 4;

/// A way through some disks: where it leads, and the combinations in mixed radix, the last first.
struct Way {
    pose: Pose,
    last: usize,
    code: u64,
}

/// Where the last disk can be in the frame of the disk in the middle, how far from it, and by which ways.
struct Places {
    tree: RTree<GeomWithData<[f64; 3], u64>>,
    distances: [f64; 2],
}

impl Places {
    fn new(ways: &[Way]) -> Self {
        let place = |way: &Way| GeomWithData::new(way.pose.position.to_array(), way.code);
        let distances = || ways.iter().map(|way| way.pose.position.norm());
        Self {
            tree: RTree::bulk_load(ways.iter().map(place).collect()),
            distances: [distances().fold(f64::INFINITY, f64::min), distances().fold(0.0, f64::max)],
        }
    }

    /// The way to the place nearest to a point, and the square of its distance, if that is less than this.
    fn nearest(&self, point: Vec3, below: f64) -> Option<(u64, f64)> {
        let point = point.to_array();
        // Most points have no place so near, which a tree says sooner than which place is the nearest.
        if below.is_finite() && self.tree.locate_within_distance(point, below).next().is_none() {
            return None;
        }
        let (place, square) = self.tree.nearest_neighbor_with_distance_2(point)?;
        (square < below).then_some((place.data, square))
    }
}

/// The best list to one disk, the third or one behind it, for the first goal; `None` where there are too many ways even for halves, or none.
pub(crate) fn nearest(
    choices: &Choices,
    table: &SpanTable,
    disk: usize,
    point: Vec3,
) -> Option<Found> {
    let middle = split(choices, disk)?;
    let start = |&choice: &usize| Way { pose: table.bases[0], last: choice, code: choice as u64 };
    let starts = choices.at(0).iter().map(start).collect();
    // The point in the frames of the disk before the middle.
    let fronts = extended(choices, table, starts, 0, middle - 1);
    let asked: Vec<(Vec3, u64, usize)> = fronts
        .iter()
        .map(|front| (front.pose.inverse().transform(point), front.code, front.last))
        .collect();
    let mut best: Option<(f64, u64, u64, usize)> = None;
    let mut looked_at = 0;
    for &meeting in choices.at(middle) {
        let start = Way { pose: Pose::IDENTITY, last: meeting, code: 0 };
        let ways = extended(choices, table, vec![start], middle, disk);
        if ways.is_empty() {
            continue;
        }
        let places = Places::new(&ways);
        let [least, greatest] = places.distances;
        // From the disk before the middle to it, back.
        let to_middle: Vec<Option<(Mat3, Vec3)>> = (0..choices.count)
            .map(|before| {
                let pair = choices.pair(before, meeting)?;
                let span = table.span(0, middle - 1, pair)?.inverse();
                if !table.is_possible(middle - 1, pair) {
                    return None;
                }
                Some((span.rotation.to_matrix(), span.position))
            })
            .collect();
        for &(point, code, last) in &asked {
            let Some((rotation, position)) = to_middle[last] else { continue };
            looked_at += 1;
            let asked = rotation * point + position;
            let known = best.map_or(f64::INFINITY, |(distance, ..)| distance);
            // All places are in a thin shell.
            let away = asked.norm();
            let outside = (least - away).max(away - greatest);
            if outside > 0.0 && outside * outside >= known {
                continue;
            }
            if let Some((back, distance)) = places.nearest(asked, known) {
                best = Some((distance, code, back, meeting));
            }
        }
    }
    let (cost, front, back, meeting) = best?;
    let mut list = decoded(choices, front, middle);
    list.push(meeting);
    list.extend(decoded(choices, back, disk - middle));
    Some(Found { list, cost, is_proven: true, least: cost, nodes: looked_at })
}

/// All ways on from these at one disk to another.
fn extended(
    choices: &Choices,
    table: &SpanTable,
    mut ways: Vec<Way>,
    from: usize,
    to: usize,
) -> Vec<Way> {
    for disk in from + 1..=to {
        let mut next = Vec::with_capacity(ways.len() * choices.count.min(8));
        for way in &ways {
            for (pair, choice) in choices.pairs_after(way.last, disk) {
                if let Some(span) = table.span(0, disk - 1, pair) {
                    let code = way.code * choices.count as u64 + choice as u64;
                    next.push(Way { pose: way.pose * *span, last: choice, code });
                }
            }
        }
        ways = next;
    }
    ways
}

/// Combinations of a code.
fn decoded(choices: &Choices, mut code: u64, disks: usize) -> Vec<usize> {
    let mut list = vec![0; disks];
    for choice in list.iter_mut().rev() {
        #[allow(clippy::cast_possible_truncation, reason = "below the number of combinations")]
        let digit = (code % choices.count as u64) as usize;
        *choice = digit;
        code /= choices.count as u64;
    }
    list
}

/// The disk in the middle: with as few ways on either side as possible.
fn split(choices: &Choices, disk: usize) -> Option<usize> {
    let count = |from: usize, to: usize, start: &[usize]| {
        let mut ways = vec![0_usize; choices.count];
        for &choice in start {
            ways[choice] = 1;
        }
        for at in from + 1..=to {
            let mut next = vec![0_usize; choices.count];
            for (choice, &number) in ways.iter().enumerate().filter(|(_, number)| **number > 0) {
                for after in choices.after(choice, at) {
                    next[after] = next[after].saturating_add(number);
                }
            }
            ways = next;
        }
        ways.iter().fold(0_usize, |sum, of| sum.saturating_add(*of))
    };
    let most = |middle: &usize| {
        let back = count(*middle, disk, choices.at(*middle)).saturating_mul(TREE);
        count(0, *middle, choices.at(0)).max(back)
    };
    let middle = (1..disk).min_by_key(most)?;
    let is_possible = count(0, middle, choices.at(0)) <= MOST_LOOKED_AT
        && count(0, middle - 1, choices.at(0)) <= MOST
        && count(middle, disk, choices.at(middle)) <= MOST
        && (choices.count as f64).powi(i32::try_from(disk + 1).ok()?) < 1e19;
    is_possible.then_some(middle)
}
