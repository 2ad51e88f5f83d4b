//! How far the sliders reach: far enough for half a turn, and for what the file asks for.

use core::f64::consts::PI;

use whipcord::{Motor, Robot, Stiffness};

use crate::protocol::{Command, Ranges, Request};

/// A slider reaches at least so many times as far as where the file puts it.
const BEYOND: f64 = 1.5;
/// What is reached where nothing is known of a robot's stiffness: in N.
const FORCE: f64 = 10.0;
/// The weight on Earth and a half, in m/s².
const GRAVITY: f64 = 15.0;

/// The ranges for a robot that starts from what the file asks for.
pub fn ranges(robot: &Robot, initial: &Request) -> Ranges {
    let length = robot.backbone().length;
    let lever = robot.routes().iter().map(|route| route.at(0.0).offset.norm()).fold(0.0, f64::max);
    let lever = if lever > 0.0 { lever } else { 0.05 * length };
    let stiffness = bending_stiffness(robot);
    // A moment M turns the tip by M L/EI; a cable of this lever by τ r L/EI, and is shortened by r times that.
    let half_turn = stiffness.map_or(FORCE * lever, |stiffness| PI * stiffness / length);
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let tensions = &mut initial.commands.iter().filter_map(|command| match command {
        Command::Tension(value) => Some(*value),
        _ => None,
    });
    let shortenings = &mut initial.commands.iter().filter_map(|command| match command {
        Command::Shortening(value) => Some(*value),
        _ => None,
    });
    let reach = |usual: f64, given: f64| round(usual.max(BEYOND * given));
    Ranges {
        tension: reach(half_turn / lever, greatest(tensions)),
        shortening: reach(PI * lever, greatest(shortenings)),
        // A force across the tip bends it about as much as its moment about the base, by half.
        force: reach(half_turn / length, greatest(&mut initial.tip_force.into_iter())),
        moment: reach(0.5 * half_turn, greatest(&mut initial.tip_moment.into_iter())),
        gravity: reach(GRAVITY, greatest(&mut initial.gravity.into_iter())),
    }
}

/// From where to where the slider of a motor reaches: its limits, or what winds up cables for half a turn of the tip.
pub fn motor_reach(motor: &Motor, ranges: &Ranges, command: Option<f64>) -> [f64; 2] {
    if let Some(limits) = motor.limits.range {
        return limits;
    }
    let least = motor.cables.iter().map(|of| of.radius).fold(f64::INFINITY, f64::min);
    let usual = ranges.shortening / least * motor.gear_ratio().abs() + motor.offset.abs();
    let reach = round(usual.max(BEYOND * command.map_or(0.0, f64::abs)));
    [-reach, reach]
}

/// The lesser bending stiffness at the base in N·m², where it is known.
fn bending_stiffness(robot: &Robot) -> Option<f64> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let [x, y] = match &backbone.stiffness {
        Some(Stiffness::Diagonal { bending, .. }) => bending.at(disks, 0.0),
        Some(given @ Stiffness::Matrix(_)) => {
            let matrix = given.at_end(disks, 0.0, 0.0);
            [matrix[3][3], matrix[4][4]]
        }
        None => {
            let section = backbone.section_at(disks, 0.0)?;
            let young = backbone.material.young_modulus?;
            [young * section.second_moment_x, young * section.second_moment_y]
        }
    };
    Some(x.min(y))
}

/// Up to 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.
fn round(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.0];
    let step = steps.into_iter().find(|step| step * power >= value * (1.0 - 1e-12));
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_round_and_large_enough() {
        for (value, expected) in
            [(1.0, 1.0), (1.2, 1.5), (0.031, 0.05), (7.6, 10.0), (980.0, 1000.0), (2e-4, 2e-4)]
        {
            assert!((round(value) / expected - 1.0).abs() < 1e-12, "{value}: {}", round(value));
        }
    }
}
