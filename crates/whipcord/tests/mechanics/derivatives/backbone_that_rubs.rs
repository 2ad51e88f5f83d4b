//! Rods with friction at the holes whose backbone touches an obstacle between two disks, on the way at places where no step ends: their
//! derivatives against differences of the whole way.

use super::friction_in_contact::{of, off_differences};
use super::hole_friction::{Sliding, both_ways, offsets, rubbing};
use super::*;
use crate::common::straight;
use crate::contact::sphere;
use whipcord::{Form, Obstacle, Part, Pose, UnitQuaternion};

/// Tests of both rods, under their names.
macro_rules! for_both_rods {
    ($($name:ident),*) => {
        mod continuous_cables {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::Continuous);
            })*
        }
        mod from_hole_to_hole {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::Disks);
            })*
        }
    };
}

for_both_rods!(
    a_backbone_that_slides_on_a_cylinder,
    a_backbone_that_slides_on_a_ball,
    a_backbone_that_slides_back,
    backward_is_forward_transposed
);

/// What is left, relative to the largest change: as a contact moves, so do the end of a step, whose error counts with one step between each
/// two places, and the jump of the strains, which derivatives leave out.
fn left(tested: Tested) -> f64 {
    if tested == Tested::Continuous { 2e-4 } else { 1e-5 }
}

const PARAMETERS: [(Parameter, f64); 4] = [
    (Parameter::YoungModulus, 1e-3 * 1.1e9),
    (Parameter::Friction { cable: None }, 1e-4),
    (Parameter::RestCurvature { axis: 1 }, 1e-2),
    (Parameter::TipForce { axis: 1 }, 1e-4),
];

/// A thin cylinder across the robot between two disks.
fn rod(friction: f64) -> Obstacle {
    let pose = Pose {
        position: Vec3::new(0.0165, 0.001, 0.105),
        rotation: UnitQuaternion::exp(Vec3::new(1.4, 0.0, 0.0)),
    };
    let form = Form::Cylinder { radius: 0.005, length: 0.1 };
    Obstacle { name: "rod".to_owned(), form, pose, friction, movable: None }
}

fn cables(mu: f64) -> Vec<Cable> {
    let cable = |angle| Cable { axial_stiffness: Some(400.0), ..rubbing(straight(angle), mu) };
    vec![cable(10.0), cable(170.0)]
}

/// By commands in the last step and in all, and by parameters.
fn check(tested: Tested, sliding: &Sliding) -> Solution {
    let Sliding { name, robot, case } = sliding;
    let list = PARAMETERS.map(|(parameter, _)| parameter);
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    assert!(!solution.contacts.is_empty(), "{:?}, {name}: nothing touches", solution.model);
    let disks = &robot.disks().arc_lengths;
    for touch in &solution.contacts {
        assert_eq!(touch.part, Part::Backbone, "{name}");
        assert!(disks.iter().all(|disk| (disk - touch.arc_length).abs() > 5e-3), "{name}");
    }
    assert!(!derivatives.is_contact_about_to_change(), "{:?}, {name}", solution.model);
    assert!(!derivatives.is_hole_about_to_change(), "{:?}, {name}", solution.model);
    let mut failures = offsets(tested, sliding, left(tested));
    let answer = (&solution, &derivatives);
    failures += &off_differences(tested, sliding, answer, &PARAMETERS, left(tested));
    assert!(failures.is_empty(), "{:?}, {name}\n{failures}", solution.model);
    solution
}

fn a_backbone_that_slides_on_a_cylinder(tested: Tested) {
    check(tested, &of("a cylinder", cables(0.1), &[&[2.0, 0.4]], rod(0.1)));
    let steps: [&[f64]; 2] = [&[1.5, 0.4], &[2.0, 0.5]];
    let solution = check(tested, &of("a cylinder, steps", cables(0.1), &steps, rod(0.1)));
    assert!(solution.contacts.iter().all(|touch| !touch.sticks));
}

fn a_backbone_that_slides_on_a_ball(tested: Tested) {
    let ball = Obstacle { friction: 0.1, ..sphere(Vec3::new(0.0165, 0.004, 0.105), 0.005) };
    check(tested, &of("a ball", cables(0.1), &[&[2.0, 0.4]], ball));
}

fn a_backbone_that_slides_back(tested: Tested) {
    let steps: [&[f64]; 2] = [&[1.5, 0.4], &[1.4, 0.42]];
    check(tested, &of("let go", cables(0.02), &steps, rod(0.3)));
}

fn backward_is_forward_transposed(tested: Tested) {
    let steps: [&[f64]; 2] = [&[2.0, 0.4], &[1.8, 0.45]];
    for friction in [0.1, 2.0] {
        both_ways(tested, &of("there and back", cables(0.1), &steps, rod(friction)));
    }
}
