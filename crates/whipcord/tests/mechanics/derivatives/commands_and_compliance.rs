//! Commands of both kinds, and the compliance with tensions and with lengths held.

use super::{
    ROBOTS, TOLERANCE, Tested, bending_stiffness, by_length, check_parameters, differentiated, off,
    options, solve_near, taut,
};
use crate::common::Wildness;
use whipcord::cosserat::{Accuracy, Options};
use whipcord::derivatives::{Hold, Place};
use whipcord::differences::differentiate;
use whipcord::{Case, PointLoad, Shortening, Solution, Vec3};

fn parameters_with_given_lengths(tested: Tested) {
    let mut failures = String::new();
    let mut checked = 0;
    for wild in [Wildness::LOADED, Wildness::UNLOADED] {
        for (i, (robot, case)) in taut(tested, wild, ROBOTS).enumerate() {
            let (robot, case) = by_length(tested, &robot, &case, i % 2 == 0);
            checked += check_parameters(tested, &robot, &case, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
    println!("{checked} derivatives by parameters with given lengths");
}

/// The case with one command changed: a tension by `by` N, a shortening by `by` m.
fn commanded(case: &Case, cable: usize, solution: &Solution, by: f64) -> Case {
    let mut case = case.clone();
    let command = &mut case.commands[cable];
    match (&mut command.tension, &mut command.shortening) {
        (Some(tension), _) => *tension += by,
        (None, Some(Shortening::Length(length))) => *length += by,
        (None, Some(Shortening::Fraction(f))) => *f += by / solution.cables[cable].initial_length,
        (None, None) => panic!("a cable without a command"),
    }
    case
}

fn commands_of_both_kinds(tested: Tested) {
    let mut failures = String::new();
    for wild in [Wildness::LOADED, Wildness::UNLOADED] {
        for (i, (robot, case)) in taut(tested, wild, 2 * ROBOTS).enumerate() {
            let (robot, case) = match i % 3 {
                0 => (robot, case),
                kind => by_length(tested, &robot, &case, kind == 1),
            };
            let (solution, derivatives) = differentiated(tested, &robot, &case, &[]);
            let jacobian = derivatives.actuation_jacobian(Place::Tip);
            for cable in 0..case.commands.len() {
                let change = derivatives.command(cable);
                let (a, b) = (change.twist(Place::Tip).linear, jacobian[cable].linear);
                assert!((a - b).norm() <= 1e-13 * b.norm());
                let step = match case.commands[cable].tension {
                    Some(tension) => 2e-3 * tension,
                    None => 2e-5 * robot.backbone().length,
                };
                let difference = differentiate(
                    |by| {
                        let case = commanded(&case, cable, &solution, by);
                        solve_near(tested, &robot, &case, &solution)
                    },
                    step,
                );
                let off = off(&change, &difference.unwrap(), &robot);
                if off.is_nan() || off > TOLERANCE {
                    failures += &format!("robot {i}, cable {cable}: {off:.1e}\n");
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// The case with a wrench at a place that has a point load of its own.
fn pushed(case: &Case, load: usize, component: usize, by: f64) -> Case {
    let mut case = case.clone();
    let point = &mut case.loads.points[load];
    match component {
        0..3 => point.force[component] += by,
        _ => point.moment[component - 3] += by,
    }
    case
}

fn compliance_with_tensions_and_with_lengths_held(tested: Tested) {
    let mut failures = String::new();
    for (i, (robot, mut case)) in taut(tested, Wildness::LOADED, ROBOTS).enumerate() {
        let length = robot.backbone().length;
        // At stations 1 and 2 and at the tip.
        case.loads.points.clear();
        for at in [length / 3.0, length * 2.0 / 3.0, length] {
            case.loads.points.push(PointLoad { at, ..PointLoad::default() });
        }
        let (robot, locked) = by_length(tested, &robot, &case, true);
        let (solution, derivatives) = differentiated(tested, &robot, &case, &[]);
        let stiffness = bending_stiffness(&robot);
        let steps = [stiffness / length.powi(2), stiffness / length].map(|s| 2e-3 * s);
        for (hold, case) in [(Hold::Tensions, &case), (Hold::Lengths, &locked)] {
            for (load, place) in
                [Place::Station(1), Place::Station(2), Place::Tip].into_iter().enumerate()
            {
                let compliance = derivatives.compliance(place, hold).unwrap();
                for component in 0..6 {
                    let change = derivatives.wrench(place, component, hold);
                    let twist = change.twist(place);
                    let column: Vec<f64> =
                        (0..6).map(|row| compliance.at(row, component)).collect();
                    let [v, w] = [twist.linear, twist.angular];
                    let size = column.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                    for (a, b) in column.iter().zip([v.x, v.y, v.z, w.x, w.y, w.z]) {
                        assert!((a - b).abs() <= 1e-12 * size);
                    }
                    let difference = differentiate(
                        |by| {
                            solve_near(
                                tested,
                                &robot,
                                &pushed(case, load, component, by),
                                &solution,
                            )
                        },
                        steps[component / 3],
                    );
                    let off = off(&change, &difference.unwrap(), &robot);
                    if off.is_nan() || off > 2.0 * TOLERANCE {
                        failures +=
                            &format!("robot {i}, {hold:?} at {place:?}, {component}: {off:.1e}\n");
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Dead forces have a potential.
fn compliance_is_symmetric_under_dead_forces(tested: Tested) {
    for (robot, mut case) in taut(tested, Wildness::LOADED, 2 * ROBOTS) {
        case.loads.tip_moment = Vec3::ZERO;
        for point in &mut case.loads.points {
            point.moment = Vec3::ZERO;
        }
        // Fine steps: the discrete solution has no potential of its own.
        let fine = Options { accuracy: Accuracy::Steps(64), ..options(tested, &case) };
        let (_, derivatives) = tested.solve_with_derivatives(&robot, &case, &fine, &[]).unwrap();
        let length = robot.backbone().length;
        for hold in [Hold::Tensions, Hold::Lengths] {
            for place in [Place::Tip, Place::Station(1)] {
                let compliance = derivatives.compliance(place, hold).unwrap();
                let asymmetry = compliance.asymmetry(length);
                assert!(asymmetry < 1e-7, "{hold:?} {place:?}: {asymmetry:.1e}");
                let stiffness = derivatives.stiffness(place, hold).unwrap();
                // Few sections do not yield in every direction.
                assert!(stiffness.is_some() || !tested.is_rod());
                let asymmetry = stiffness.map_or(0.0, |stiffness| stiffness.asymmetry(length));
                assert!(asymmetry < 1e-4, "{hold:?} {place:?}: {asymmetry:.1e}");
            }
        }
        let by_tension = derivatives.length_by_tension();
        let size = by_tension.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
        for (i, row) in by_tension.iter().enumerate() {
            assert!(row[i] < 0.0);
            for (j, value) in row.iter().enumerate() {
                assert!((value - by_tension[j][i]).abs() < 1e-7 * size);
            }
        }
    }
}

for_every_model!(
    parameters_with_given_lengths,
    commands_of_both_kinds,
    compliance_with_tensions_and_with_lengths_held,
    compliance_is_symmetric_under_dead_forces
);
