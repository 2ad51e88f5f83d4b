//! Linearization of answers that touch obstacles, against differences of such answers, for the models in equilibrium under loads.

use whipcord::cosserat::{Accuracy, Options};
use whipcord::derivatives::{Cotangent, Hold, Place};
use whipcord::{
    Case, Linearization, Obstacle, Parameter, Pose, Prepared, Robot, Shortening, Solution,
    Stations, Twist, UnitQuaternion, Vec3,
};

use super::{Tested, off_with_all};
use crate::contact::{among, finger, sphere, wall};

for_every_model!(
    a_disk_that_touches_a_wall,
    the_backbone_on_a_ball,
    a_contact_that_sticks,
    a_contact_that_slides,
    a_contact_slides_on_along_its_traction,
    two_contacts_slide_along_a_groove,
    a_cable_of_given_length,
    backward_is_forward_transposed,
    what_touches_nothing_has_the_derivatives_of_the_robot_alone,
    a_contact_that_is_about_to_open_says_so
);

const STEPS: usize = 36;

/// What differences leave, relative to the size of a change; and where contacts stick, whose places hang on the answer before.
const TOLERANCE: f64 = 1e-7;
const STICKING: f64 = 5e-7;

impl Tested {
    /// On given steps, so that differences are those of one discrete model.
    fn prepared(self, robot: &Robot, case: &Case) -> Prepared {
        let options = Options {
            stations: Stations::At(vec![0.03, 0.095, 0.18]),
            accuracy: Accuracy::Steps(STEPS),
            ..super::options(self, case)
        };
        self.prepare(robot, case, &options).unwrap()
    }

    fn differentiate(
        self,
        robot: &Robot,
        case: &Case,
        parameters: &[Parameter],
    ) -> (Solution, Linearization) {
        self.prepared(robot, case).solve_with_derivatives(case, None, parameters).unwrap()
    }
}

/// What a number changes of an answer, by differences of fourth order of answers from it: positions and tangents of the stations,
/// and the lengths and tensions of the cables.
fn difference(
    tested: Tested,
    base: &Solution,
    is_cold: bool,
    h: f64,
    make: impl Fn(f64) -> (Robot, Case),
) -> Vec<f64> {
    let at = |x: f64| {
        let (robot, case) = make(x);
        let solution =
            tested.prepared(&robot, &case).solve(&case, (!is_cold).then_some(base)).unwrap();
        let touching = |solution: &Solution| -> Vec<_> {
            solution.contacts.iter().map(|touch| (touch.part, touch.sticks)).collect()
        };
        assert_eq!(touching(&solution).len(), touching(base).len());
        values(&solution)
    };
    let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(at);
    (0..a.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
}

fn values(solution: &Solution) -> Vec<f64> {
    let mut values = Vec::new();
    for pose in &solution.shape.poses {
        values.extend(pose.position.to_array());
        values.extend(pose.rotation.rotate(Vec3::Z).to_array().map(|x| 0.1 * x));
    }
    for cable in &solution.cables {
        values.extend([cable.length, 1e-3 * cable.tension.unwrap()]);
    }
    values
}

fn rates(solution: &Solution, change: &whipcord::derivatives::Change) -> Vec<f64> {
    let mut rates = Vec::new();
    for (k, pose) in solution.shape.poses.iter().enumerate() {
        let Twist { linear, angular } = change.twist(Place::Station(k));
        rates.extend(linear.to_array());
        rates.extend(angular.cross(pose.rotation.rotate(Vec3::Z)).to_array().map(|x| 0.1 * x));
    }
    for (length, tension) in change.lengths().iter().zip(change.tensions()) {
        rates.extend([*length, 1e-3 * tension]);
    }
    rates
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs();
        assert!(error <= tolerance * size, "{found:e} {expected:e}: {error:e} of {size:e}");
    }
}

const PARAMETERS: [Parameter; 2] = [Parameter::YoungModulus, Parameter::HoleRadius];

/// By the command of the cable, a force on the tip and parameters.
fn check(tested: Tested, case: &Case, is_cold: bool) {
    check_axes(tested, case, is_cold, &[0, 1, 2]);
}

fn check_axes(tested: Tested, case: &Case, is_cold: bool, axes: &[usize]) {
    let (solution, derivatives) = tested.differentiate(&finger(9), case, &PARAMETERS);
    compare(tested, case, (&solution, &derivatives), is_cold, (TOLERANCE, axes));
}

#[track_caller]
fn assert_difference(
    what: &str,
    tolerance: f64,
    found: &[f64],
    step: f64,
    difference: impl Fn(f64) -> Vec<f64>,
) {
    let off = |step: f64| {
        let expected = difference(step);
        let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs() / size);
        errors.fold(0.0, f64::max)
    };
    let off = off_with_all([1.0, 0.25, 0.0625].map(|part| part * step), tolerance, off);
    assert!(off.is_ok(), "{what}: {off:?}");
}

fn compare(
    tested: Tested,
    case: &Case,
    (solution, derivatives): (&Solution, &Linearization),
    is_cold: bool,
    (tolerance, axes): (f64, &[usize]),
) {
    let robot = finger(9);
    assert!(!solution.contacts.is_empty(), "nothing touches");
    assert!(!derivatives.is_contact_about_to_change());
    let unit = if case.commands[0].tension.is_some() { 1.0 } else { 0.02 };
    let found: Vec<f64> =
        rates(solution, &derivatives.command(0)).iter().map(|rate| unit * rate).collect();
    assert_difference("command", tolerance, &found, 1e-3, |h| {
        difference(tested, solution, is_cold, h, |x| {
            let mut case = case.clone();
            let command = &mut case.commands[0];
            match (command.tension, command.shortening) {
                (Some(tension), _) => command.tension = Some(tension + x),
                (_, Some(Shortening::Length(length))) => {
                    command.shortening = Some(Shortening::Length(length + 0.02 * x));
                }
                other => panic!("{other:?}"),
            }
            (robot.clone(), case)
        })
    });
    for &component in axes {
        let change = derivatives.wrench(Place::Tip, component, Hold::Commands);
        assert_difference(
            &format!("force {component}"),
            tolerance,
            &rates(solution, &change),
            if is_cold { 1e-3 } else { 2e-4 },
            |h| {
                difference(tested, solution, is_cold, h, |x| {
                    let mut case = case.clone();
                    case.loads.tip_force[component] += x;
                    (robot.clone(), case)
                })
            },
        );
    }
    for (p, parameter) in PARAMETERS.iter().enumerate() {
        let value = parameter.value(&robot, case).unwrap();
        let change = derivatives.parameter(p, Hold::Commands);
        let found: Vec<f64> = rates(solution, &change).iter().map(|rate| value * rate).collect();
        assert_difference(&parameter.to_string(), tolerance, &found, 1e-3, |h| {
            difference(tested, solution, is_cold, h, |x| {
                parameter.moved(&robot, case, value * x).unwrap()
            })
        });
    }
}

fn a_disk_that_touches_a_wall(tested: Tested) {
    check(tested, &among(Case::with_tensions(&[3.0]), vec![wall(0.05)]), false);
}

fn the_backbone_on_a_ball(tested: Tested) {
    let case = among(Case::with_tensions(&[2.0]), vec![sphere(Vec3::new(0.04, 0.0, 0.105), 0.02)]);
    check(tested, &case, false);
}

fn a_contact_that_sticks(tested: Tested) {
    // It has slid as it was pulled, and sticks as it is let go a little.
    let robot = finger(9);
    let at = |tension| {
        let obstacle = Obstacle { friction: 0.8, ..wall(0.05) };
        among(Case::with_tensions(&[tension]), vec![obstacle])
    };
    let (pulled, case) = (at(3.0), at(2.6));
    let mut model = tested.prepared(&robot, &pulled);
    let before = model.solve(&pulled, None).unwrap();
    let (solution, derivatives) =
        model.solve_with_derivatives(&case, Some(&before), &PARAMETERS).unwrap();
    assert!(solution.contacts.iter().all(|touch| touch.sticks));
    compare(tested, &case, (&solution, &derivatives), false, (STICKING, &[0, 1, 2]));
}

/// From rest, since what slides one way sticks the other; in the plane, since a force across turns the way it slides.
fn a_contact_that_slides(tested: Tested) {
    let obstacle = Obstacle { friction: 0.1, ..wall(0.05) };
    // It slides up the wall as it is pulled.
    check_axes(tested, &among(Case::with_tensions(&[3.0]), vec![obstacle]), true, &[0, 2]);
}

/// A force across bends the finger sideways along the wall, and the answer is a corner: what slides on one way sticks the other. It
/// slides on in steps from the answer.
fn a_contact_slides_on_along_its_traction(tested: Tested) {
    let robot = finger(9);
    let at = |tension: f64, across: f64| {
        let obstacle = Obstacle { friction: 0.3, ..wall(0.05) };
        let mut case = among(Case::with_tensions(&[tension]), vec![obstacle]);
        case.loads.tip_force.y = across;
        case
    };
    let (tension, across) = (3.0, 0.1);
    let mut model = tested.prepared(&robot, &at(tension, across));
    let solution = model.solve(&at(tension, across), None).unwrap();
    let derivatives = model.linearize(&at(tension, across), &solution, &[]).unwrap();
    assert!(!solution.contacts.is_empty());
    let turned = |friction: Option<Vec3>| friction.is_some_and(|along| along.y.abs() > 1e-3);
    assert!(solution.contacts.iter().all(|touch| !touch.sticks && turned(touch.friction)));
    let here = values(&solution);
    for (unit, [by_tension, by_force]) in [(1.0, [1.0, 0.0]), (0.03, [0.0, 1.0])] {
        let on = |h: f64| {
            let case = at(tension + by_tension * h * unit, across + by_force * h * unit);
            let mut model = tested.prepared(&robot, &case);
            let solution = model.solve(&case, Some(&solution)).unwrap();
            assert!(solution.contacts.iter().all(|touch| !touch.sticks));
            values(&solution)
        };
        let change = match by_tension == 1.0 {
            true => derivatives.command(0),
            false => derivatives.wrench(Place::Tip, 1, Hold::Commands),
        };
        let found: Vec<f64> = rates(&solution, &change).iter().map(|rate| unit * rate).collect();
        // What the conditions of contact leave is the limit of one-sided differences.
        assert_difference("on", 1e-4, &found, 1e-3, |h| {
            let [one, two, three] = [h, 2.0 * h, 3.0 * h].map(on);
            let at = |i: usize| 18.0 * one[i] - 9.0 * two[i] + 2.0 * three[i] - 11.0 * here[i];
            (0..here.len()).map(|i| at(i) / (6.0 * h)).collect()
        });
    }
}

/// What keeps a disk from sliding across one of the walls, the other one keeps it from, too.
fn two_contacts_slide_along_a_groove(tested: Tested) {
    let side = |angle: f64| {
        let turn = Pose { rotation: UnitQuaternion::exp(Vec3::Z * angle), ..Pose::IDENTITY };
        let (wall, name) = (wall(0.045), format!("wall at {angle} rad"));
        Obstacle { friction: 0.1, pose: turn * wall.pose, name, ..wall }
    };
    let case = among(Case::with_tensions(&[3.0]), vec![side(0.6), side(-0.6)]);
    let robot = finger(9);
    let (solution, derivatives) = tested.differentiate(&robot, &case, &[]);
    assert!(solution.contacts.len() > 1 && solution.contacts.iter().all(|touch| !touch.sticks));
    let found = rates(&solution, &derivatives.command(0));
    // From rest, where the slips on the way turn the tractions a little.
    assert_difference("command", 5e-3, &found, 1e-3, |h| {
        difference(tested, &solution, true, h, |x| {
            let mut case = case.clone();
            case.commands[0].tension = Some(3.0 + x);
            (robot.clone(), case)
        })
    });
}

fn a_cable_of_given_length(tested: Tested) {
    let case = Case::with_shortenings(&[Shortening::Length(0.006)]);
    check(tested, &among(case, vec![wall(0.05)]), false);
}

fn backward_is_forward_transposed(tested: Tested) {
    let robot = finger(9);
    let parameters = [Parameter::YoungModulus, Parameter::PoissonRatio];
    for obstacle in [wall(0.05), Obstacle { friction: 5.0, ..wall(0.05) }] {
        let case = among(Case::with_tensions(&[3.0]), vec![obstacle]);
        let (_, derivatives) = tested.differentiate(&robot, &case, &parameters);
        let twist =
            Twist { linear: Vec3::new(0.3, -1.2, 0.7), angular: Vec3::new(0.02, 0.05, -0.01) };
        let cotangent = Cotangent {
            places: vec![(Place::Tip, twist), (Place::Station(1), twist * -0.4)],
            lengths: vec![0.9],
            tensions: vec![0.1],
            ..Cotangent::default()
        };
        for hold in [Hold::Commands, Hold::Lengths] {
            let gradient = derivatives.pull_back(&cotangent, hold);
            let worth = |change: &whipcord::derivatives::Change| {
                let places: f64 = cotangent
                    .places
                    .iter()
                    .map(|(at, by)| {
                        let moved = change.twist(*at);
                        moved.linear.dot(by.linear) + moved.angular.dot(by.angular)
                    })
                    .sum();
                places + 0.9 * change.lengths()[0] + 0.1 * change.tensions()[0]
            };
            for p in 0..parameters.len() {
                let forward = worth(&derivatives.parameter(p, hold));
                assert_close(&[gradient.parameters[p]], &[forward], 1e-9);
            }
            for component in 0..6 {
                let forward = worth(&derivatives.wrench(Place::Station(0), component, hold));
                let Vec3 { x, y, z } = match component {
                    0..3 => gradient.wrench(Place::Station(0)).force,
                    _ => gradient.wrench(Place::Station(0)).moment,
                };
                assert_close(&[[x, y, z][component % 3]], &[forward], 1e-8);
            }
            assert_close(&gradient.commands, &[worth(&derivatives.command(0))], 1e-9);
        }
    }
}

fn what_touches_nothing_has_the_derivatives_of_the_robot_alone(tested: Tested) {
    let robot = finger(9);
    let alone = Case::with_tensions(&[3.0]);
    let (_, expected) = tested.differentiate(&robot, &alone, &[Parameter::YoungModulus]);
    let case = among(alone, vec![wall(0.3)]);
    let (solution, found) = tested.differentiate(&robot, &case, &[Parameter::YoungModulus]);
    assert!(solution.contacts.is_empty());
    assert_close(
        &rates(&solution, &found.parameter(0, Hold::Commands)),
        &rates(&solution, &expected.parameter(0, Hold::Commands)),
        1e-8,
    );
}

/// Where the last disk just touches the wall, and nothing pushes.
fn a_contact_that_is_about_to_open_says_so(tested: Tested) {
    let robot = finger(9);
    let alone = Case::with_tensions(&[3.0]);
    let free = tested.prepared(&robot, &alone).solve(&alone, None).unwrap();
    let mut at = free.shape.tip().position.x;
    let near = |at: f64| among(Case::with_tensions(&[3.0]), vec![wall(at)]);
    // The rim stands out from the centre: down to where it pushes with next to nothing.
    let (mut open, mut pushed) = (at + 0.02, at);
    for _ in 0..60 {
        at = 0.5 * (open + pushed);
        let case = near(at);
        let solution = tested.prepared(&robot, &case).solve(&case, None).unwrap();
        if solution.contacts.is_empty() { open = at } else { pushed = at }
    }
    let (solution, derivatives) = tested.differentiate(&robot, &near(pushed), &[]);
    assert_eq!(solution.contacts.len(), 1);
    assert!(derivatives.is_contact_about_to_change());
}
