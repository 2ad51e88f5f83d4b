//! Where elements begin and end.

use whipcord::{Loads, Robot};

use crate::error::MotionError;
use crate::options::MotionOptions;

/// Places nearer to one another than this part of the length are one.
const NEAR: f64 = 1e-9;

/// Arc lengths in m of the ends of the elements: at the ends of the backbone and of cables, at corners of routings, where loads act and the
/// cross-section changes; disks are at ends or in the middle of elements, always at ends where cables `turn_at_disks`.
pub(crate) fn element_ends(
    robot: &Robot,
    loads: &[&Loads],
    least: usize,
    turn_at_disks: bool,
) -> Result<Vec<f64>, MotionError> {
    let length = robot.backbone().length;
    let mut ends = vec![0.0, length];
    ends.extend(robot.backbone().places());
    for route in robot.routes() {
        ends.push(route.end());
        ends.extend_from_slice(route.breakpoints());
    }
    for loads in loads {
        ends.extend(loads.points.iter().map(|point| point.at));
        ends.extend(loads.masses.iter().map(|mass| mass.at));
        ends.extend(loads.distributed.iter().flat_map(|load| load.profile.knots()));
    }
    let mut places: Vec<(f64, bool)> = ends.into_iter().map(|s| (s, true)).collect();
    if robot.has_disks() {
        let are_ends = turn_at_disks || has_values_at_disks(robot);
        places.extend(robot.disks().arc_lengths.iter().map(|&s| (s, are_ends)));
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Of places that are one, an end remains an end.
    let mut merged: Vec<(f64, bool)> = Vec::with_capacity(places.len());
    for (s, is_end) in places {
        match merged.last_mut() {
            Some(last) if s - last.0 < NEAR * length => last.1 |= is_end,
            _ => merged.push((s, is_end)),
        }
    }
    let divided = divide(&merged, length, least);
    let given = divided.len() - 1;
    if given > MotionOptions::MOST_ELEMENTS {
        return Err(MotionError::Option {
            what: "number of elements",
            value: given as f64,
            need: "there must be at most 2000; the robot has too many disks, loads or corners",
        });
    }
    Ok(divided)
}

/// Whether a quantity of the backbone is given at the disks, so that its slope jumps there.
fn has_values_at_disks(robot: &Robot) -> bool {
    let backbone = robot.backbone();
    !backbone.is_uniform()
        || backbone.linear_density.as_ref().is_some_and(|along| !along.is_uniform())
}

/// Elements between places, of which those that are no ends may be in the middle of one.
fn divide(places: &[(f64, bool)], length: f64, least: usize) -> Vec<f64> {
    let usual = length / least as f64;
    let mut ends = vec![places[0].0];
    let mut i = 0;
    while i + 1 < places.len() {
        let start = places[i].0;
        if let Some(&(end, _)) = places.get(i + 2) {
            let (middle, is_end) = places[i + 1];
            let is_middle = (middle - 0.5 * (start + end)).abs() < NEAR * length;
            if is_middle && !is_end && end - start <= 1.5 * usual {
                ends.push(end);
                i += 2;
                continue;
            }
        }
        let piece = places[i + 1].0 - start;
        let count = (piece / usual).round().max(1.0);
        let steps = (1..count as usize).map(|k| start + piece * k as f64 / count);
        ends.extend(steps);
        ends.push(places[i + 1].0);
        i += 1;
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_ends_or_in_the_middle() {
        let disks = |count: usize| -> Vec<(f64, bool)> {
            let last = count - 1;
            (0..count).map(|k| (k as f64 / last as f64, k == 0 || k == last)).collect()
        };
        assert_eq!(divide(&disks(5), 1.0, 2), [0.0, 0.5, 1.0]);
        assert_eq!(divide(&disks(5), 1.0, 4), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(
            divide(&[(0.0, true), (0.4, true), (1.0, true)], 1.0, 5),
            [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
        );
        assert_eq!(divide(&[(0.0, true), (0.5, true), (1.0, true)], 1.0, 1), [0.0, 0.5, 1.0]);
    }
}
