//! Robots whose cables rub in their holes and that move or hold objects by friction: derivatives against differences of the whole way.

use super::friction_in_contact::off_differences;
use super::hole_friction::{Sliding, both_ways, commands, offsets, rubbing};
use super::*;
use crate::common::straight;
use crate::contact::{finger, sphere, wall};
use whipcord::{Backbone, Form, Material, MovableBody, Obstacle};

for_every_model!(
    a_ball_that_is_squeezed_against_a_wall,
    a_ball_that_is_squeezed_harder,
    a_ball_that_rolls_on_a_table,
    a_box_that_slides_on_a_table,
    backward_is_forward_transposed
);

/// Differences leave about this much, relative to the largest change.
const MOVED: f64 = 1e-5;
/// The same where the object is held until the cable is pulled and then released, by a way of more steps.
const HELD: f64 = 3e-4;

const PARAMETERS: [(Parameter, f64); 6] = [
    (Parameter::YoungModulus, 1e-2 * 1.1e9),
    (Parameter::Friction { cable: None }, 2e-2),
    (Parameter::TipForce { axis: 0 }, 1e-3),
    (Parameter::TipForce { axis: 1 }, 1e-3),
    (Parameter::TipForce { axis: 2 }, 1e-3),
    (Parameter::Gravity { axis: 2 }, 0.1),
];

/// A finger without weight, in the plane or pushed across it.
fn of(name: &'static str, steps: &[&[f64]], obstacles: Vec<Obstacle>) -> Sliding {
    let bare = finger(9);
    let material = Material { density: Some(0.0), ..bare.backbone().material };
    let backbone = Backbone { material, ..bare.backbone().clone() };
    let cables = vec![rubbing(straight(0.0), 0.2)];
    let robot = Robot::new(backbone, bare.disks().clone(), cables).unwrap();
    let steps: Vec<_> = steps.iter().map(|step| commands(step)).collect();
    let (last, before) = steps.split_last().unwrap();
    let mut case =
        Case { commands: last.clone(), before: before.to_vec(), obstacles, ..Case::default() };
    case.loads.gravity = Some(Vec3::new(0.0, 0.0, -9.81));
    Sliding { name, robot, case }
}

fn rough(friction: f64, obstacle: Obstacle) -> Obstacle {
    Obstacle { friction, ..obstacle }
}

fn ball(mass: f64, position: Vec3) -> Obstacle {
    let ball = sphere(position, 0.02);
    Obstacle { movable: MovableBody::with_mass(&ball.form, mass), ..ball }
}

fn block(size: Vec3, position: Vec3) -> Obstacle {
    Obstacle { name: "block".to_owned(), form: Form::Box { size }, ..sphere(position, 1.0) }
}

fn table() -> Obstacle {
    block(Vec3::new(0.2, 0.2, 0.02), Vec3::new(0.125, 0.0, 0.11))
}

/// Only the closed grasp carries it.
fn squeezed(steps: &[&[f64]]) -> Sliding {
    let ball = ball(0.005, Vec3::new(0.045, 0.0, 0.17));
    of("squeezed", steps, vec![rough(0.5, ball), rough(0.5, wall(0.065))])
}

fn check(tested: Tested, sliding: &Sliding, parameters: &[(Parameter, f64)], tolerance: f64) {
    let Sliding { name, robot, case } = sliding;
    let list: Vec<Parameter> = parameters.iter().map(|(parameter, _)| *parameter).collect();
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    let model = solution.model;
    assert!(!solution.contacts.is_empty(), "{model:?}, {name}: nothing touches");
    assert!(derivatives.one_sided().names().count() == 0, "{model:?}, {name}");
    let answer = (&solution, &derivatives);
    let mut failures = off_differences(tested, sliding, answer, parameters, tolerance);
    if !case.before.is_empty() {
        failures += &offsets(tested, sliding, tolerance);
    }
    assert!(failures.is_empty(), "{model:?}, {name}\n{failures}");
}

fn a_ball_that_is_squeezed_against_a_wall(tested: Tested) {
    check(tested, &squeezed(&[&[3.0]]), &PARAMETERS, HELD);
}

fn a_ball_that_is_squeezed_harder(tested: Tested) {
    check(tested, &squeezed(&[&[3.0], &[3.3]]), &PARAMETERS[..2], HELD);
}

/// The finger slides along it, and its spin about the normal of the table is held by nothing else.
fn a_ball_that_rolls_on_a_table(tested: Tested) {
    let ball = ball(0.01, Vec3::new(0.045, 0.003, 0.14));
    let rolls = of("rolls", &[&[1.5]], vec![rough(0.3, ball), rough(0.3, table())]);
    // Its weight does not matter as long as it rolls.
    check(tested, &rolls, &PARAMETERS[..5], MOVED);
}

/// On four corners, more than carry it; across its way the traction of the finger would turn within the least force.
fn a_box_that_slides_on_a_table(tested: Tested) {
    let pushed = block(Vec3::new(0.03, 0.03, 0.08), Vec3::new(0.045, 0.0, 0.16));
    let pushed = Obstacle { movable: MovableBody::with_mass(&pushed.form, 0.02), ..pushed };
    let slides = of("slides", &[&[1.3]], vec![rough(0.1, pushed), rough(0.1, table())]);
    let [young, friction, x, _, z, gravity] = PARAMETERS;
    check(tested, &slides, &[young, friction, x, z, gravity], MOVED);
}

fn backward_is_forward_transposed(tested: Tested) {
    both_ways(tested, &squeezed(&[&[3.0]]));
}
