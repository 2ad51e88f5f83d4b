//! What a parameter changes in the equations of the holes, and in what a cable is asked for, at constant shape and tensions.

use crate::case::{Case, Shortening};
use crate::parameter::{MotorChange, Parameter};
use crate::robot::Robot;
use crate::statics::friction::{HoleSource, Holes};

/// How the length that a cable is to keep inside the robot changes where nothing pulls it, and the compliance of cable and drive, of a cable
/// that is so long at rest, which changes by so much.
pub(super) fn asked(
    parameter: &Parameter,
    (robot, case): (&Robot, &Case),
    cable: usize,
    (at_rest, change): (f64, f64),
) -> (f64, f64) {
    let asked = match case.commands[cable].shortening {
        Some(Shortening::Fraction(fraction)) => change * (1.0 - fraction),
        _ => change,
    };
    let motor = MotorChange::new(parameter, robot, case, cable, at_rest);
    let inside = robot.cables()[cable].axial_stiffness.map_or(0.0, |k| change / k);
    let compliance = inside + motor.compliance;
    let by_pretension = robot.cable_compliance(cable, at_rest) * motor.pretension;
    let wound_up = compliance * robot.pretension(cable) + by_pretension;
    (asked - motor.shortening - wound_up, compliance)
}

/// What a parameter changes in the equations of the holes of cables, which are these and so long at rest. The lengths of all passages at
/// rest change by `rest`.
pub(crate) fn hole_source(
    parameter: &Parameter,
    (robot, case): (&Robot, &Case),
    holes: &Holes,
    (cables, rest): (impl Iterator<Item = (usize, f64)>, &[f64]),
    is_length: impl Fn(usize) -> bool,
) -> HoleSource {
    let mut of_cables = Vec::new();
    holes.cable_lengths(rest, &mut of_cables);
    let mut source = HoleSource { yielding: vec![0.0; holes.count()], ..HoleSource::default() };
    for (place, (cable, at_rest)) in cables.enumerate() {
        let (this, change) = (&robot.cables()[cable], of_cables[place]);
        let rubs = matches!(*parameter, Parameter::Friction { cable: of }
            if of.is_none_or(|only| only == cable) && this.friction.is_some());
        source.friction.push(if rubs { 1.0 } else { 0.0 });
        let (target, mut outside) = asked(parameter, (robot, case), cable, (at_rest, change));
        source.targets.push(target);
        source.commands.push(if is_length(place) { target } else { 0.0 });
        if let Some(stiffness) = this.axial_stiffness {
            let softens = *parameter == Parameter::AxialStiffness { cable };
            let by_stiffness = if softens { -1.0 / stiffness } else { 0.0 };
            outside -= change / stiffness + by_stiffness * at_rest / stiffness;
            for &p in &holes.of_cable[place] {
                source.yielding[p] = by_stiffness * holes.yielding[p] + rest[p] / stiffness;
            }
        }
        source.outside.push(outside);
    }
    source.rest.extend_from_slice(rest);
    source
}
