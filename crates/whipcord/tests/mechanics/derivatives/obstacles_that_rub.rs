//! Answers from rest among obstacles with friction of robots whose cables do not rub: their derivatives against differences of the whole way.

use super::friction_in_contact::{of, off_differences, steps_with_derivatives};
use super::hole_friction::{Sliding, both_ways, moved, offsets};
use super::*;
use crate::common::{helix, straight};
use crate::contact::{sphere, wall};
use whipcord::Obstacle;

for_every_model!(
    contacts_that_slide,
    contacts_that_stick,
    steps_there_and_back,
    steps_one_by_one,
    cables_of_given_lengths,
    a_way_that_ends_on_finer_steps,
    a_way_from_an_answer_is_that_of_the_answer,
    backward_is_forward_transposed
);

/// What differences of the whole way leave, as among obstacles of robots whose cables rub.
const WHOLE_WAY: f64 = 1e-5;

const PARAMETERS: [(Parameter, f64); 5] = [
    (Parameter::YoungModulus, 1e-3 * 1.1e9),
    (Parameter::HoleRadius, 1e-3 * 8e-3),
    (Parameter::RestCurvature { axis: 1 }, 3e-2),
    (Parameter::TipForce { axis: 0 }, 1e-4),
    (Parameter::TipForce { axis: 1 }, 1e-4),
];

fn rough(friction: f64, obstacle: Obstacle) -> Obstacle {
    Obstacle { friction, ..obstacle }
}

fn pair() -> Vec<Cable> {
    [10.0, 170.0].map(|degrees| Cable::new(format!("{degrees}"), straight(degrees))).to_vec()
}

fn check(tested: Tested, sliding: &Sliding) -> Solution {
    let Sliding { name, robot, case } = sliding;
    let list = PARAMETERS.map(|(parameter, _)| parameter);
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    assert!(!solution.contacts.is_empty(), "{:?}, {name}: nothing touches", solution.model);
    assert!(!derivatives.is_contact_about_to_change(), "{:?}, {name}", solution.model);
    let answer = (&solution, &derivatives);
    let mut failures = off_differences(tested, sliding, answer, &PARAMETERS, WHOLE_WAY);
    failures += &offsets(tested, sliding, WHOLE_WAY);
    assert!(failures.is_empty(), "{:?}, {name}\n{failures}", solution.model);
    solution
}

/// The force across turns the finger out of its plane while it slides: another command is another way along the wall.
fn out_of_plane(
    cables: Vec<Cable>,
    steps: &[&[f64]],
    obstacle: Obstacle,
    name: &'static str,
) -> Sliding {
    let mut sliding = of(name, cables, steps, obstacle);
    sliding.case.loads.tip_force.y = 0.05;
    sliding
}

fn contacts_that_slide(tested: Tested) {
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    for (name, obstacle) in [("along a wall", wall(0.05)), ("along a ball", ball)] {
        let of = out_of_plane(pair(), &[&[3.0, 0.4]], rough(0.2, obstacle), name);
        let solution = check(tested, &of);
        assert!(solution.contacts.iter().all(|touch| !touch.sticks), "{name}");
    }
}

fn contacts_that_stick(tested: Tested) {
    // Where the first cable is let go a little, what touches stays where it was.
    let steps = [&[3.0, 0.4][..], &[2.95, 0.41]];
    let solution = check(tested, &out_of_plane(pair(), &steps, rough(1.0, wall(0.05)), "sticks"));
    assert!(solution.contacts.iter().all(|touch| touch.sticks));
}

fn steps_there_and_back(tested: Tested) {
    let steps = [&[3.0, 0.4][..], &[2.6, 0.6]];
    check(tested, &out_of_plane(pair(), &steps, rough(0.3, wall(0.05)), "there and back"));
}

/// In one solve with the derivatives of every step.
fn steps_one_by_one(tested: Tested) {
    let steps = [&[2.7, 0.4][..], &[2.95, 0.3], &[3.1, 0.25]];
    let sliding = out_of_plane(pair(), &steps, rough(0.3, wall(0.05)), "one by one");
    let Sliding { name, robot, case } = &sliding;
    let list = PARAMETERS.map(|(parameter, _)| parameter);
    let found = steps_with_derivatives(tested, robot, case, &list);
    let mut failures = String::new();
    for (step, (solution, derivatives)) in found.iter().enumerate() {
        assert!(!solution.contacts.is_empty());
        // The first step alone is divided as the way without obstacles tells.
        if step == 0 {
            continue;
        }
        let to_it = Sliding { name, robot: robot.clone(), case: case.step(step).unwrap() };
        let answer = (solution, derivatives);
        let off = off_differences(tested, &to_it, answer, &PARAMETERS, 5.0 * WHOLE_WAY);
        if !off.is_empty() {
            failures += &format!("step {step}:\n{off}");
        }
    }
    assert!(failures.is_empty(), "{:?}\n{failures}", found[0].0.model);
}

fn cables_of_given_lengths(tested: Tested) {
    let cables = || {
        vec![
            Cable { axial_stiffness: Some(800.0), ..Cable::new("one", straight(10.0)) },
            Cable { axial_stiffness: Some(400.0), ..Cable::new("two", helix(150.0, 0.2)) },
        ]
    };
    check(tested, &out_of_plane(cables(), &[&[-6.0, 0.3]], rough(0.2, wall(0.05)), "shortened"));
    let steps = [&[-7.0, 0.3][..], &[-6.5, 0.4]];
    check(tested, &out_of_plane(cables(), &steps, rough(0.2, wall(0.05)), "paid out"));
    // The second step is long, and comes to touch within it.
    let steps = [&[-2.0, 0.3][..], &[-7.5, 0.4]];
    check(tested, &out_of_plane(cables(), &steps, rough(0.2, wall(0.05)), "wound up"));
}

/// To a tolerance, for which the answer is found again on finer steps than the way to it: against differences of answers to that tolerance.
fn a_way_that_ends_on_finer_steps(tested: Tested) {
    let Sliding { robot, case, .. } =
        out_of_plane(pair(), &[&[3.0, 0.4]], rough(0.2, wall(0.05)), "finer");
    for tolerance in [1e-6, 1e-9] {
        let accuracy = Accuracy::Tolerance(tolerance);
        let options = Options { accuracy, ..options(tested, &case) };
        let found = tested.solve_with_derivatives(&robot, &case, &options, &[]);
        let (_, derivatives) = found.unwrap();
        for cable in 0..2 {
            let found = derivatives.command(cable).twist(Place::Tip).linear;
            let at = |by: f64| {
                let mut case = case.clone();
                case.commands[cable] = moved(case.commands[cable], by);
                let answer = tested.solve(&robot, &case, &options, None).unwrap();
                answer.disks.tip().position
            };
            // Longer ones may meet another division of the way.
            let off = off_with_all([2e-3, 5e-4, 1e-4], 1e-3, |h| {
                let expected = (at(h) - at(-h)) / (2.0 * h);
                (found - expected).norm() / expected.norm()
            });
            assert!(off.is_ok(), "{tolerance} {cable}: {off:?}");
        }
    }
}

/// From an answer the contacts move on; from rest the whole way to it differs.
fn a_way_from_an_answer_is_that_of_the_answer(tested: Tested) {
    let Sliding { robot, case, .. } =
        out_of_plane(pair(), &[&[3.0, 0.4]], rough(0.2, wall(0.05)), "from");
    let options = options(tested, &case);
    let mut prepared = tested.prepare(&robot, &case, &options).unwrap();
    let (solution, of_way) = prepared.solve_with_derivatives(&case, None, &[]).unwrap();
    let moving_on = prepared.linearize(&case, &solution, &[]).unwrap();
    let [way, on] = [&of_way, &moving_on].map(|of| of.command(0).twist(Place::Tip).linear);
    assert!((way - on).norm() > 1e-3 * on.norm(), "{way:?} {on:?}");
    // A load at a place is added to the robot as it stands, in both.
    let [from_rest, here] =
        [&of_way, &moving_on].map(|of| of.compliance(Place::Tip, Hold::Commands).unwrap());
    for i in 0..6 {
        for j in 0..6 {
            let scale = (here.at(i, i) * here.at(j, j)).abs().sqrt();
            assert!((from_rest.at(i, j) - here.at(i, j)).abs() <= 1e-5 * scale, "{i} {j}");
        }
    }
}

fn backward_is_forward_transposed(tested: Tested) {
    let steps = [&[3.0, 0.4][..], &[2.7, 0.5]];
    both_ways(tested, &out_of_plane(pair(), &steps, rough(0.3, wall(0.05)), "there and back"));
}
