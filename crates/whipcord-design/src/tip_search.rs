//! The list of holes that brings one disk nearest to a point, of all lists, by meeting in the middle.
//!
//! With the pose g of a disk in the middle and the place r of the last disk in its frame, `‖g r − x‖ = ‖r − g⁻¹ x‖`, eq. (3): of all ways from the
//! middle on the places r are in a tree, and every way to the middle asks it for the one nearest to `g⁻¹ x`.

use rstar::RTree;
use rstar::primitives::GeomWithData;
use whipcord::{Pose, Vec3};

use crate::choices::Choices;
use crate::shape_search::Found;
use crate::span_table::SpanTable;

/// Ways to the middle, and ways from there, that are kept.
const MOST: usize = 4_000_000;

/// A way through some disks: where it leads, and the combinations in mixed radix, the last first.
struct Way {
    pose: Pose,
    last: usize,
    code: u64,
}

/// Where the last disk can be in the frame of the disk in the middle, and how far from it.
struct Places {
    tree: RTree<GeomWithData<[f64; 3], u64>>,
    distances: [f64; 2],
}

/// The best list to one disk for the first goal; `None` where there are too many ways even for halves, or none.
pub(crate) fn nearest(
    choices: &Choices,
    table: &SpanTable,
    disk: usize,
    point: Vec3,
) -> Option<Found> {
    let middle = split(choices, disk)?;
    let trees: Vec<Option<Places>> = (0..choices.count)
        .map(|start| {
            choices.at(middle).binary_search(&start).ok()?;
            let start = Way { pose: Pose::IDENTITY, last: start, code: 0 };
            let ways = extended(choices, table, vec![start], middle, disk);
            let place = |way: &Way| GeomWithData::new(way.pose.position.to_array(), way.code);
            let distances = || ways.iter().map(|way| way.pose.position.norm());
            let least = distances().fold(f64::INFINITY, f64::min);
            let greatest = distances().fold(0.0, f64::max);
            (!ways.is_empty()).then(|| Places {
                tree: RTree::bulk_load(ways.iter().map(place).collect()),
                distances: [least, greatest],
            })
        })
        .collect();
    let start = |&choice: &usize| Way { pose: table.bases[0], last: choice, code: choice as u64 };
    let starts = choices.at(0).iter().map(start).collect();
    let fronts = extended(choices, table, starts, 0, middle);
    let mut best: Option<(f64, u64, u64, usize)> = None;
    for front in &fronts {
        let Some(Places { tree, distances: [least, greatest] }) = &trees[front.last] else {
            continue;
        };
        let asked = front.pose.inverse().transform(point);
        let known = best.map_or(f64::INFINITY, |(distance, ..)| distance);
        // All places are in a thin shell.
        let away = asked.norm();
        let outside = (least - away).max(away - greatest);
        let asked = asked.to_array();
        if outside >= known.sqrt() || tree.root().envelope().distance_2(&asked) >= known {
            continue;
        }
        let Some((found, distance)) = tree.nearest_neighbor_iter_with_distance_2(asked).next()
        else {
            continue;
        };
        if distance < known {
            best = Some((distance, front.code, found.data, front.last));
        }
    }
    let (cost, front, back, _) = best?;
    let mut list = decoded(choices, front, middle + 1);
    list.extend(decoded(choices, back, disk - middle));
    Some(Found { list, cost, is_proven: true, nodes: fronts.len() })
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
            for choice in choices.after(way.last, disk) {
                if let Some(span) = table.span(0, disk - 1, way.last, choice) {
                    let code = way.code * choices.count as u64 + choice as u64;
                    next.push(Way { pose: way.pose * span, last: choice, code });
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
    // A tree takes longer to make than a question takes to answer.
    let most = |middle: &usize| {
        let (front, back) = (
            count(0, *middle, choices.at(0)),
            count(*middle, disk, choices.at(*middle)).saturating_mul(8),
        );
        front.max(back)
    };
    let middle = (0..disk).min_by_key(most)?;
    let is_possible = most(&middle) <= 8 * MOST
        && count(0, middle, choices.at(0)) <= MOST
        && (choices.count as f64).powi(i32::try_from(disk + 1).ok()?) < 1e19;
    is_possible.then_some(middle)
}
