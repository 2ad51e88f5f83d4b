//! The same robot cut into another number of sections.

use std::f64::consts::TAU;

use whipcord::robot::Route;
use whipcord::{Cable, Disks, HoleOffset, Interpolation, Robot, RobotError, Routing};

/// Holes of the resampled disks. A cable that ran through a hole of each disk runs between the
/// holes of the new ones: with so many holes there is one within 3·10⁻¹¹ m of any place, so that a
/// list of holes describes any course.
const HOLES: usize = 1_000_000_000;

/// The robot with `sections` equal sections. Cables through holes keep their course: the new disks
/// have a hole wherever it passes them. All else stays as it is.
///
/// # Errors
/// [`RobotError`] when a cable ends before the first new disk.
pub fn resample(robot: &Robot, sections: usize) -> Result<Robot, RobotError> {
    let old = robot.disks();
    let length = robot.backbone().length;
    let mut disks = Disks::equally_spaced(length, sections + 1, 0.0);
    disks.are_present = old.are_present;
    disks.mass = old.mass * old.count() as f64 / disks.count() as f64;
    disks.hole_circle_radii = if old.hole_circle_radii.is_empty() {
        Vec::new()
    } else {
        disks.arc_lengths.iter().map(|&s| between(old, &old.hole_circle_radii, s)).collect()
    };
    disks.holes = old.holes.map(|_| HOLES);

    let backbone = robot.backbone().apart_from(old);
    let cables = robot
        .cables()
        .iter()
        .zip(robot.routes())
        .map(|(cable, route)| match cable.routing {
            Routing::Holes { .. } => through_holes(cable, route, &disks),
            _ => cable.clone(),
        })
        .collect();
    robot.with_parts(backbone, disks, cables)
}

/// A quantity given at each disk, linearly between them.
fn between(disks: &Disks, values: &[f64], arc_length: f64) -> f64 {
    let (i, t) = disks.locate(arc_length);
    values[i] * (1.0 - t) + values[i + 1] * t
}

fn through_holes(cable: &Cable, route: &Route, disks: &Disks) -> Cable {
    let end = route.end();
    // The list reaches the first disk at or beyond the place where the cable is anchored.
    let passed = disks.arc_lengths.partition_point(|&s| s < end) + 1;
    let holes = disks.arc_lengths[..passed.min(disks.count())]
        .iter()
        .map(|&s| {
            let offset = route.at(s.min(end)).offset;
            let turns = (offset.y.atan2(offset.x) / TAU).rem_euclid(1.0);
            (turns * HOLES as f64).round() as usize % HOLES + 1
        })
        .collect();
    Cable {
        routing: Routing::Holes { holes, interpolation: Interpolation::Spline },
        // The holes are where the cable runs, on the circle of the disks.
        hole_offset: HoleOffset { angle: 0.0, ..cable.hole_offset },
        ends_at: Some(end),
        ..cable.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::paper;

    #[test]
    fn cables_keep_their_course() {
        for paper::Example { robot, .. } in paper::table_1().unwrap() {
            for sections in [5, 9, 20, 320] {
                let fine = resample(&robot, sections).unwrap();
                assert_eq!(fine.disks().count(), sections + 1);
                let (old, new) = (&robot.routes()[0], &fine.routes()[0]);
                for &s in &fine.disks().arc_lengths {
                    assert!((old.at(s).offset - new.at(s).offset).max_abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn a_cable_that_ends_midway_still_does() {
        let disks = Disks::equally_spaced(0.1, 5, 0.01).with_holes(4);
        let cable = Cable::new("short", Routing::holes(vec![1, 1, 2]));
        let robot = Robot::new(whipcord::Backbone::new(0.1), disks, vec![cable]).unwrap();
        let fine = resample(&robot, 10).unwrap();
        assert!((fine.routes()[0].end() - 0.05).abs() < 1e-15);
        assert!((fine.disks().hole_circle_radii[3] - 0.01).abs() < 1e-15);
    }
}
