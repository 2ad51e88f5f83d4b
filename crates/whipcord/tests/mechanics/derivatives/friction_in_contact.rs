//! Answers with friction at the holes that touch obstacles: their derivatives against differences of the whole way.

use super::hole_friction::{Sliding, both_ways, commands, moved, offsets, rubbing};
use super::*;
use crate::common::{helix, straight};
use crate::contact::{finger, sphere, wall};
use whipcord::{Obstacle, SlipState};

for_every_model!(
    disks_that_slide_on_what_they_touch,
    steps_there_and_back,
    contacts_that_rub,
    steps_that_rub_one_by_one,
    cables_of_given_lengths,
    backward_is_forward_transposed
);

/// Differences leave about this much, relative to the largest change: each place of the way is known to a few digits less than the answer.
const WHOLE_WAY: f64 = 1e-5;

fn robot(cables: Vec<Cable>) -> Robot {
    let bare = finger(6);
    Robot::new(bare.backbone().clone(), bare.disks().clone(), cables).unwrap()
}

pub(super) fn of(
    name: &'static str,
    cables: Vec<Cable>,
    steps: &[&[f64]],
    obstacle: Obstacle,
) -> Sliding {
    let steps: Vec<_> = steps.iter().map(|step| commands(step)).collect();
    let (last, before) = steps.split_last().unwrap();
    let mut case = Case {
        commands: last.clone(),
        before: before.to_vec(),
        obstacles: vec![obstacle],
        ..Case::default()
    };
    case.loads.tip_force = Vec3::new(0.01, 0.02, -0.01);
    Sliding { name, robot: robot(cables), case }
}

fn rough(friction: f64, obstacle: Obstacle) -> Obstacle {
    Obstacle { friction, ..obstacle }
}

fn pair() -> Vec<Cable> {
    antagonists([0.3, 0.2], None)
}

/// Cables that stretch: where others stick on both sides, they lock the robot, and nothing tells the force of a contact.
fn antagonists(mu: [f64; 2], axial_stiffness: Option<f64>) -> Vec<Cable> {
    let cable = |angle, mu| Cable { axial_stiffness, ..rubbing(straight(angle), mu) };
    vec![cable(10.0, mu[0]), cable(170.0, mu[1])]
}

const PARAMETERS: [(Parameter, f64); 6] = [
    (Parameter::YoungModulus, 1e-3 * 1.1e9),
    (Parameter::HoleRadius, 1e-3 * 8e-3),
    (Parameter::Friction { cable: None }, 1e-4),
    (Parameter::RestCurvature { axis: 1 }, 1e-2),
    (Parameter::TipForce { axis: 0 }, 1e-4),
    (Parameter::TipForce { axis: 1 }, 1e-4),
];

fn holes(solution: &Solution, state: SlipState) -> usize {
    let all = solution.cables.iter().flat_map(|cable| &cable.slip_states);
    all.filter(|&&of| of == state).count()
}

/// By commands in the last step, and by parameters with steps for their differences.
pub(super) fn off_differences(
    tested: Tested,
    Sliding { robot, case, .. }: &Sliding,
    (solution, derivatives): (&Solution, &Linearization),
    parameters: &[(Parameter, f64)],
    tolerance: f64,
) -> String {
    let mut failures = String::new();
    let mut compare =
        |what: String, change: &Change, step: f64, near: &dyn Fn(f64) -> (Robot, Case)| {
            let off = |step: f64| {
                let solve = |by: f64| {
                    let (robot, case) = near(by);
                    solve_near(tested, &robot, &case, solution)
                };
                differentiate(solve, step)
                    .map_or(f64::INFINITY, |found| off_above(1e-9, change, &found, robot))
            };
            // Longer ones may meet other cases on the way.
            let steps = [0.25, 0.0625, 1.0, 0.0156, 4.0].map(|part| part * step);
            if let Err(all) = off_with_all(steps, tolerance, off) {
                failures += &format!("{what}: {all:?}\n");
            }
        };
    for cable in 0..robot.cables().len() {
        let command = case.commands[cable];
        let size = command.tension.unwrap_or(1e-3);
        compare(format!("command {cable}"), &derivatives.command(cable), 2e-3 * size, &|by| {
            let mut case = case.clone();
            case.commands[cable] = moved(command, by);
            (robot.clone(), case)
        });
    }
    for (p, (parameter, step)) in parameters.iter().enumerate() {
        let change = derivatives.parameter(p, Hold::Commands);
        compare(parameter.to_string(), &change, *step, &|by| {
            parameter.moved(robot, case, by).unwrap()
        });
    }
    failures
}

/// By commands in the last step and in all, and by parameters.
fn check(tested: Tested, sliding: &Sliding, tolerance: f64) -> Solution {
    let Sliding { name, robot, case } = sliding;
    let list = PARAMETERS.map(|(parameter, _)| parameter);
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    assert!(!solution.contacts.is_empty(), "{:?}, {name}: nothing touches", solution.model);
    assert!(!derivatives.is_contact_about_to_change(), "{:?}, {name}", solution.model);
    assert!(!derivatives.is_hole_about_to_change(), "{:?}, {name}", solution.model);
    let mut failures = offsets(tested, sliding, tolerance);
    let answer = (&solution, &derivatives);
    failures += &off_differences(tested, sliding, answer, &PARAMETERS, tolerance);
    assert!(failures.is_empty(), "{:?}, {name}\n{failures}", solution.model);
    solution
}

fn disks_that_slide_on_what_they_touch(tested: Tested) {
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    check(tested, &of("against a wall", pair(), &[&[3.0, 0.4]], wall(0.05)), WHOLE_WAY);
    check(tested, &of("against a ball", pair(), &[&[3.0, 0.4]], ball), WHOLE_WAY);
}

fn steps_there_and_back(tested: Tested) {
    let cables = antagonists([0.3, 0.2], Some(400.0));
    let released = of("released", cables, &[&[3.0, 0.4], &[2.2, 0.6]], wall(0.05));
    let solution = check(tested, &released, WHOLE_WAY);
    assert!(holes(&solution, SlipState::Released) > 0);
    assert!(tested == Tested::FourBar || holes(&solution, SlipState::Sticks) > 0);
}

fn contacts_that_rub(tested: Tested) {
    let slides = of("slides", pair(), &[&[3.0, 0.4]], rough(0.1, wall(0.05)));
    let solution = check(tested, &slides, WHOLE_WAY);
    assert!(solution.contacts.iter().all(|touch| !touch.sticks));
    let cables = antagonists([0.02, 0.02], Some(300.0));
    let sticks = of("sticks", cables, &[&[3.0, 0.4], &[2.7, 0.5]], rough(2.0, wall(0.05)));
    let solution = check(tested, &sticks, WHOLE_WAY);
    assert!(solution.contacts.iter().all(|touch| touch.sticks));
}

/// The answers to all steps of a case, in one solve with the derivatives of every one.
pub(super) fn steps_with_derivatives(
    tested: Tested,
    robot: &Robot,
    case: &Case,
    parameters: &[Parameter],
) -> Vec<(Solution, Linearization)> {
    let mut found = Vec::new();
    let mut prepared = tested.prepare(robot, case, &options(tested, case)).unwrap();
    let each = |solution, of: Option<Linearization>| found.push((solution, of.unwrap()));
    prepared.solve_steps_with_derivatives(case, parameters, |_| true, each).unwrap();
    found
}

/// In one solve with the derivatives of every step, what sticks remembers where it was at the end of the step before.
fn steps_that_rub_one_by_one(tested: Tested) {
    let cables = || antagonists([0.02, 0.02], Some(300.0));
    let steps = [&[3.0, 0.4][..], &[2.7, 0.5], &[2.5, 0.6]];
    let mut sliding = of("sticks", cables(), &steps, rough(2.0, wall(0.05)));
    // Across the way along the wall.
    sliding.case.loads.tip_force.y = 0.05;
    let Sliding { name, robot, case } = &sliding;
    let list = PARAMETERS.map(|(parameter, _)| parameter);
    let found = steps_with_derivatives(tested, robot, case, &list);
    let mut failures = String::new();
    for (step, (solution, derivatives)) in found.iter().enumerate() {
        let case = case.step(step).unwrap();
        assert!(!solution.contacts.is_empty() && !derivatives.is_contact_about_to_change());
        let to_it = Sliding { name, robot: robot.clone(), case };
        let answer = (solution, derivatives);
        let off = off_differences(tested, &to_it, answer, &PARAMETERS, 5.0 * WHOLE_WAY);
        if !off.is_empty() {
            failures += &format!("step {step}:\n{off}");
        }
    }
    assert!(failures.is_empty(), "{:?}\n{failures}", found[0].0.model);
    assert!(found[2].0.contacts.iter().all(|touch| touch.sticks));
}

fn cables_of_given_lengths(tested: Tested) {
    let cables = || {
        vec![
            Cable { axial_stiffness: Some(800.0), ..rubbing(straight(10.0), 0.3) },
            Cable { axial_stiffness: Some(400.0), ..rubbing(helix(150.0, 0.2), 0.2) },
        ]
    };
    check(tested, &of("shortened", cables(), &[&[-6.0, 0.3]], wall(0.05)), WHOLE_WAY);
    let released = of("paid out", cables(), &[&[-7.0, 0.3], &[-6.5, 0.4]], rough(0.2, wall(0.05)));
    check(tested, &released, WHOLE_WAY);
}

fn backward_is_forward_transposed(tested: Tested) {
    let cables = antagonists([0.1, 0.1], Some(300.0));
    let steps = [&[3.0, 0.4][..], &[2.7, 0.5]];
    both_ways(tested, &of("there and back", cables, &steps, rough(0.5, wall(0.05))));
}
