//! The arc lengths at which an exported robot has bodies, or points of its curves.

use whipcord::{Case, Robot};

/// Places nearer to one another than this, relative to the length, are one.
const ONE_PLACE: f64 = 1e-6;

/// Arc lengths in m, ascending: disks, ends of cables, places of loads and of masses, places at which the section changes, and
/// between them so many pieces for each span from disk to disk that none is longer than its share.
pub fn places(robot: &Robot, case: &Case, per_span: usize) -> Vec<f64> {
    let (disks, length) = (&robot.disks().arc_lengths, robot.backbone().length);
    let mut marks = disks.clone();
    let loads = core::iter::once(&case.loads).chain(&case.loads_before);
    let of_loads = loads.flat_map(|loads| {
        let points = loads.points.iter().map(|point| point.at);
        points.chain(loads.masses.iter().map(|mass| mass.at))
    });
    let ends = robot.routes().iter().map(|route| route.end());
    let others: Vec<f64> = ends.chain(of_loads).chain(robot.backbone().places()).collect();
    for other in others {
        if marks.iter().all(|mark| (mark - other).abs() > ONE_PLACE * length) {
            marks.push(other);
        }
    }
    marks.sort_by(f64::total_cmp);
    let mut places = vec![marks[0]];
    for ends in marks.windows(2) {
        let (span, _) = robot.disks().locate(0.5 * (ends[0] + ends[1]));
        let share = (ends[1] - ends[0]) / (disks[span + 1] - disks[span]);
        let pieces = (share * per_span as f64 - 1e-6).ceil().max(1.0) as usize;
        let h = (ends[1] - ends[0]) / pieces as f64;
        places.extend((1..pieces).map(|k| ends[0] + k as f64 * h));
        places.push(ends[1]);
    }
    places
}

/// The number of the place that is nearest to an arc length.
pub fn nearest(places: &[f64], arc_length: f64) -> usize {
    let after = places.partition_point(|&s| s < arc_length);
    let candidates = after.saturating_sub(1)..(after + 1).min(places.len());
    let distance = |i: usize| (places[i] - arc_length).abs();
    candidates.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use whipcord::{Backbone, Cable, Disks, PointLoad, Routing};

    use super::*;

    #[test]
    fn every_mark_is_a_place_and_spans_have_their_pieces() {
        let cable = Cable {
            ends_at: Some(0.07),
            ..Cable::new("a", Routing::Straight { angle: 0.0, radius: 0.01 })
        };
        let disks = Disks::equally_spaced(0.1, 3, 0.01);
        let robot = Robot::new(Backbone::new(0.1), disks, vec![cable]).unwrap();
        let mut case = Case::with_tensions(&[1.0]);
        case.loads.points = vec![PointLoad { at: 0.05, ..PointLoad::default() }];
        let found = places(&robot, &case, 5);
        let expected = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1];
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
        assert_eq!([0.0, 0.069, 0.2].map(|s| nearest(&found, s)), [0, 7, 10]);
    }
}
