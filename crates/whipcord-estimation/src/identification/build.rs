//! Robot and case with numbers in place of the unknowns.

use whipcord_numerics::{UnitQuaternion, Vec3};

use super::quantity::Quantity;
use whipcord::case::{Actuation, CableCommand, Case, Shortening};
use whipcord::error::SolveError;
use whipcord::parameter::{Parameter, StiffnessPart};
use whipcord::robot::{Backbone, Material, Problem, Robot, RobotError, Stiffness};
use whipcord::section::material_stiffness;

/// Axes of the world.
pub(super) const AXES: [Vec3; 3] =
    [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];

/// The robot with these numbers; those of a case are left out. Factors on a stiffness come last, since
/// they count from what the other numbers make of it.
pub(super) fn robot(
    robot: &Robot,
    case: &Case,
    numbers: &[(Quantity, f64)],
) -> Result<Robot, SolveError> {
    let mut built = robot.clone();
    for &(quantity, value) in numbers.iter().filter(|(quantity, _)| !quantity.is_of_case()) {
        built = match quantity {
            Quantity::Parameter(Parameter::StiffnessScale(_)) => continue,
            Quantity::Parameter(parameter) => parameter.changed_to(&built, case, value)?.0,
            Quantity::Friction { cable } => rubbed(&built, cable, value)?,
            _ => continue,
        };
    }
    for &(quantity, factor) in numbers {
        if let Quantity::Parameter(parameter @ Parameter::StiffnessScale(part)) = quantity {
            built = stiffened(&built, &parameter, part, factor)?;
        }
    }
    Ok(built)
}

/// The case of a robot that has its numbers, with those of the case. `rest` has the lengths of the cables at rest
/// in m.
pub(super) fn case(
    robot: &Robot,
    case: &Case,
    numbers: &[(Quantity, f64)],
    rest: &[f64],
) -> Result<Case, RobotError> {
    let mut built = case.clone();
    built.drive(robot)?;
    // Offsets are added to what the gains make of the commands.
    for &(quantity, value) in numbers {
        let Quantity::Gain { cable } = quantity else { continue };
        for_commands(&mut built, cable, |command| {
            command.tension = command.tension.map(|tension| value * tension);
            command.shortening = command.shortening.map(|shortening| match shortening {
                Shortening::Length(length) => Shortening::Length(value * length),
                Shortening::Fraction(part) => Shortening::Fraction(value * part),
            });
        });
    }
    let mut turn = [0.0; 3];
    for &(quantity, value) in numbers {
        match quantity {
            Quantity::Parameter(parameter) if quantity.is_of_case() => {
                built = parameter.changed_to(robot, &built, value)?.1;
            }
            Quantity::TensionOffset { cable } => for_commands(&mut built, cable, |command| {
                command.tension = command.tension.map(|tension| tension + value);
            }),
            Quantity::ShorteningOffset { cable } => for_commands(&mut built, cable, |command| {
                command.shortening = command.shortening.map(|shortening| match shortening {
                    Shortening::Length(length) => Shortening::Length(length + value),
                    Shortening::Fraction(part) => Shortening::Fraction(part + value / rest[cable]),
                });
            }),
            Quantity::BasePosition { axis } => built.base.position[axis] = value,
            Quantity::BaseTurn { axis } => turn[axis] = value,
            Quantity::Parameter(_)
            | Quantity::Friction { .. }
            | Quantity::Gain { .. }
            | Quantity::MarkerOffset { .. }
            | Quantity::MeasuredPosition { .. }
            | Quantity::MeasuredTurn { .. }
            | Quantity::BodyTurn { .. } => {}
        }
    }
    built.base.rotation = turned(built.base.rotation, turn);
    Ok(built)
}

/// A rotation that is turned about x, then y, then z by these angles.
pub(super) fn turned(rotation: UnitQuaternion, turn: [f64; 3]) -> UnitQuaternion {
    if turn == [0.0; 3] {
        return rotation;
    }
    let turned = (0..3)
        .fold(rotation, |rotation, axis| UnitQuaternion::exp(AXES[axis] * turn[axis]) * rotation);
    // Products of unit quaternions drift from unit length by rounding, which a case is checked for.
    UnitQuaternion::from_wxyz(turned.wxyz()).unwrap_or(turned)
}

/// The axis about which the base turns with the unknown turn about `axis` of the world, where it is turned by
/// these angles.
pub(super) fn turning_axis(axis: usize, turn: [f64; 3]) -> Vec3 {
    (axis + 1..3)
        .fold(AXES[axis], |v, later| UnitQuaternion::exp(AXES[later] * turn[later]).rotate(v))
}

/// The commands of a cable in all steps.
fn for_commands(case: &mut Case, cable: usize, mut change: impl FnMut(&mut CableCommand)) {
    for commands in case.before.iter_mut().chain([&mut case.commands]) {
        if let Some(command) = commands.get_mut(cable) {
            change(command);
        }
    }
}

/// Whether a cable is driven by its tension in all steps of a case, or by its shortening in all;
/// `None` where it is now this, now that.
pub(super) fn is_driven_by_tension(
    case: &Case,
    cable: usize,
    actuation: Actuation,
) -> Option<bool> {
    let by_tension = |commands: &Vec<CableCommand>| {
        commands
            .get(cable)
            .is_some_and(|command| command.tension.is_some() && actuation != Actuation::Shortening)
    };
    let last = by_tension(&case.commands);
    case.before.iter().all(|commands| by_tension(commands) == last).then_some(last)
}

/// The robot whose cable, or whose cables, have this friction coefficient.
fn rubbed(robot: &Robot, cable: Option<usize>, friction: f64) -> Result<Robot, RobotError> {
    let mut cables = robot.cables().to_vec();
    for (i, each) in cables.iter_mut().enumerate() {
        if cable.is_none_or(|only| only == i) {
            each.friction = Some(friction);
        }
    }
    robot.with_parts(robot.backbone().clone(), robot.disks().clone(), cables)
}

/// The robot with a part of its stiffness multiplied by a factor.
fn stiffened(
    robot: &Robot,
    parameter: &Parameter,
    part: StiffnessPart,
    factor: f64,
) -> Result<Robot, SolveError> {
    let backbone = robot.backbone();
    let stiffness = match &backbone.stiffness {
        Some(given) => given.clone(),
        None if backbone.is_uniform() => material_stiffness(robot)?,
        None => return Err(parameter.absent().into()),
    };
    let pair = |pair: &[f64; 2]| pair.map(|k| k * factor);
    let stiffness = match (stiffness, part) {
        (Stiffness::Diagonal { shear, axial, bending, torsion }, part) => match part {
            StiffnessPart::Shear => {
                let shear = shear.map(|along| along.map(pair));
                Stiffness::Diagonal { shear, axial, bending, torsion }
            }
            StiffnessPart::Extension => {
                let axial = axial.map(|along| along.map(|k| k * factor));
                Stiffness::Diagonal { shear, axial, bending, torsion }
            }
            StiffnessPart::Bending => {
                Stiffness::Diagonal { shear, axial, bending: bending.map(pair), torsion }
            }
            StiffnessPart::Torsion => {
                let torsion = torsion.map(|k| k * factor);
                Stiffness::Diagonal { shear, axial, bending, torsion }
            }
        },
        (Stiffness::Matrix(_), _) => return Err(parameter.absent().into()),
    };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        material: Material {
            density: backbone.material.density,
            yield_strain: backbone.material.yield_strain,
            ..Material::default()
        },
        shear_correction: 1.0,
        ..backbone.clone()
    };
    Ok(robot.with_parts(backbone, robot.disks().clone(), robot.cables().to_vec())?)
}

/// Where robot and case have the quantity, before anything is estimated.
pub(super) fn present(quantity: &Quantity, robot: &Robot, case: &Case) -> Result<f64, RobotError> {
    let absent = || RobotError::new(quantity.to_string(), Problem::NoSuchQuantity);
    let there = |cable: usize| robot.cables().get(cable).ok_or_else(absent);
    match *quantity {
        Quantity::Parameter(parameter) => parameter.value(robot, case),
        Quantity::Friction { cable } => {
            there(cable.unwrap_or(0)).map(|cable| cable.friction.unwrap_or(0.0))
        }
        Quantity::TensionOffset { cable } | Quantity::ShorteningOffset { cable } => {
            there(cable).map(|_| 0.0)
        }
        Quantity::Gain { cable } => there(cable).map(|_| 1.0),
        // Of the frame of a measurement, `Forward::start` knows more.
        Quantity::MarkerOffset { .. }
        | Quantity::MeasuredPosition { .. }
        | Quantity::MeasuredTurn { .. }
        | Quantity::BodyTurn { .. } => Ok(0.0),
        Quantity::BasePosition { axis } => Ok(case.base.position[axis]),
        Quantity::BaseTurn { .. } => Ok(0.0),
    }
}
