//! Whether positions and arc lengths are those of a robot of this size: else their unit is another than
//! the file says.

use whipcord::Vec3;
use whipcord_estimation::{Observation, Place, Seen};

use super::Known;
use super::LENGTH_UNITS;
use crate::units::{Dimension, parse_quantity};

/// The markers of a robot lie within half its length of their middle. By the median, which a marker that
/// was mistaken for another does not move, and with room for robots that are drawn out.
const FARTHEST: f64 = 2.0;
/// A robot that is rolled up this small has gone round thirty times.
const NEAREST: f64 = 0.01;

/// What is wrong with the size of what was measured.
pub(super) fn problem(observations: &[Observation], known: &Known<'_>) -> Option<String> {
    let length = known.robot.length?;
    let mut positions = Vec::new();
    // Where along the robot the markers are, from 0 to 1.
    let mut places = Vec::new();
    let mut beside: f64 = 0.0;
    for seen in observations {
        let Seen::Position(position) = seen.seen else { continue };
        positions.push(position);
        beside = beside.max(seen.offset.norm());
        places.push(match (seen.place, known.robot.disks) {
            (Place::ArcLength(arc_length), _) => arc_length / length,
            (Place::Disk(disk), Some(disks)) if disks > 1 => disk as f64 / (disks - 1) as f64,
            (Place::Disk(_), _) => 0.0,
        });
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let mut middle = [0.0; 3];
    for (axis, middle) in middle.iter_mut().enumerate() {
        *middle = median(&mut positions.iter().map(|position| position[axis]).collect())?;
    }
    let distances = positions.iter().map(|position| {
        let [x, y, z] = position.to_array();
        (x - middle[0]).hypot(y - middle[1]).hypot(z - middle[2])
    });
    let usual = median(&mut distances.clone().collect())?;
    places.sort_by(f64::total_cmp);
    places.dedup();
    let covers = places.len() > 2 && places[places.len() - 1] - places[0] >= 0.5;
    let far = distances.fold(0.0, f64::max);
    let unit = known.unit;
    if usual > FARTHEST * (length + beside) {
        Some(format!(
            "read as {unit}, half of the markers lie more than {usual:.3} m from their middle, but the backbone is {length} m long"
        ))
    } else if covers && far < NEAREST * length {
        Some(format!(
            "read as {unit}, all markers lie within {:.3} mm of their middle, but the backbone is {length} m long",
            1e3 * far
        ))
    } else {
        None
    }
}

/// Markers at less than this part of the length are next to the base.
const NEXT_TO_BASE: f64 = 0.01;
/// Positions farther apart than this part of the length are not all next to the base.
const APART: f64 = 0.05;

/// Arc lengths beyond so many lengths of the backbone are in another unit.
const FAR_BEYOND: f64 = 5.0;

/// A length in m as a number in a unit.
fn number_in(unit: &str, metres: f64) -> Option<f64> {
    let (one, _) = parse_quantity(&format!("1 {unit}"), &[Dimension::Length]).ok()?;
    Some((metres / one * 1e9).round() / 1e9)
}

/// A length in m that was read in one unit, had it been read in another one.
fn reread(metres: f64, read_in: &str, unit: &str) -> Option<f64> {
    let (one, _) = parse_quantity(&format!("1 {unit}"), &[Dimension::Length]).ok()?;
    Some(number_in(read_in, metres)? * one)
}

/// The unit, smaller than that in which an arc length was read, in which it lies on a backbone of this length.
pub(super) fn smaller_unit(arc_length: f64, read_in: &str, length: f64) -> Option<&'static str> {
    // A little beyond the tip is a marker in the wrong place, not another unit.
    if arc_length < FAR_BEYOND * length {
        return None;
    }
    ["mm", "cm", "in", "um"].into_iter().find(|unit| {
        let value = reread(arc_length, read_in, unit);
        value.is_some_and(|s| s < arc_length && s > NEXT_TO_BASE * length && s <= 1.001 * length)
    })
}

/// Arc lengths in a larger unit than that in which they were read: message and remedy. All of them are then next to the
/// base, where the positions are not, or where too many are to be told apart.
pub(super) fn arc_lengths(
    observations: &[Observation],
    read_in: &'static str,
    known: &Known<'_>,
) -> Option<(String, String)> {
    let length = known.robot.length?;
    let at = |seen: &Observation| match seen.place {
        Place::ArcLength(s) => Some(s),
        Place::Disk(_) => None,
    };
    let mut places: Vec<f64> = observations.iter().filter_map(at).filter(|s| *s > 0.0).collect();
    let farthest = places.iter().copied().reduce(f64::max)?;
    if farthest >= NEXT_TO_BASE * length {
        return None;
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    // Of each step, the first marker is what the others are near to; where positions are those of the base's frame, so
    // is the base.
    let mut apart: f64 = 0.0;
    let mut first: Option<(usize, Vec3)> = None;
    for seen in observations.iter().filter(|seen| at(seen).is_some()) {
        let Seen::Position(position) = seen.seen else { continue };
        let room = 2.0 * seen.offset.norm();
        match first {
            Some((step, other)) if step == seen.step => {
                apart = apart.max((position - other).norm() - room);
            }
            _ => first = Some((seen.step, position)),
        }
        if known.robot.at_origin {
            apart = apart.max(position.norm() - room);
        }
    }
    if apart <= APART * length && places.len() < 3 {
        return None;
    }
    let larger = LENGTH_UNITS.into_iter().find(|unit| {
        let value = reread(farthest, read_in, unit);
        value.is_some_and(|s| s > NEXT_TO_BASE * length && s <= 1.001 * length)
    })?;
    let number = number_in(read_in, farthest)?;
    let message = format!(
        "read in {read_in}, the arc lengths only go up to {number} {read_in}, but the backbone is {length} m long{}",
        if apart > APART * length {
            format!(", and the positions are {apart:.3} m apart")
        } else {
            String::new()
        }
    );
    let help = format!(
        "name the column `arc_length [{larger}]` if they are in {larger}, or write `unit = \"{larger}\"` under [measured] if all lengths of the file are"
    );
    Some((message, help))
}
