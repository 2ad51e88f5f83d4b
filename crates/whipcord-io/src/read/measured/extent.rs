//! Whether positions are those of a robot of this size: else their unit is another than the file says.

use whipcord::{Observation, Place, Seen};

use super::rows::Known;

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
