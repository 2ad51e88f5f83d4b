//! Derivatives of the four-bar model whose strain energy decides where it bends.

use super::{NOTHING, bending_stiffness, off, off_above};
use crate::common::{helix, paper_robot, straight};
use crate::contact::{among, finger, sphere, wall};
use whipcord::derivatives::{Change, Cotangent, Hold, Place};
use whipcord::differences::differentiate;
use whipcord::four_bar::{LengthRule, Objective, Options};
use whipcord::{
    Case, Differentiable, Interpolation, Model, Obstacle, Parameter, Robot, Routing, Shortening,
    Solution, SolveError, Statics, Stations, StiffnessPart, Twist, Vec3,
};

fn model() -> Model {
    Model::FourBar(Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        stations: Stations::At(vec![0.03, 0.095, 0.18]),
        ..Options::default()
    })
}

fn case(shortenings: &[f64]) -> Case {
    let given: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
    Case::with_shortenings(&given)
}

fn linearized(
    robot: &Robot,
    case: &Case,
    parameters: &[Parameter],
) -> (Solution, whipcord::Linearization) {
    let mut prepared = model().prepare(robot, &case.loads).unwrap();
    prepared.solve_with_derivatives(case, None, parameters).unwrap()
}

/// Robots with cables whose lengths are independent, all of which pull.
fn robots() -> Vec<(Robot, Case)> {
    let holes = Routing::Holes {
        holes: vec![1, 1, 2, 2, 3, 3, 4, 4, 5, 5],
        interpolation: Interpolation::Spline,
    };
    vec![
        (paper_robot(vec![straight(20.0)]), case(&[0.006])),
        (paper_robot(vec![straight(20.0), helix(120.0, 0.4)]), case(&[0.006, 0.004])),
        (paper_robot(vec![helix(10.0, 0.7), holes]), case(&[0.003, 0.005])),
    ]
}

#[test]
fn commands_are_those_of_differences() {
    for (robot, case) in robots() {
        let (_, derivatives) = linearized(&robot, &case, &[]);
        for cable in 0..case.commands.len() {
            let difference = differentiate(
                |by| {
                    let mut case = case.clone();
                    let Some(Shortening::Length(length)) = &mut case.commands[cable].shortening
                    else {
                        panic!("no length");
                    };
                    *length += by;
                    model().solve(&robot, &case)
                },
                2e-5,
            );
            let off = off(&derivatives.command(cable), &difference.unwrap(), &robot);
            assert!(off < 1e-6, "{off:e}");
        }
    }
}

#[test]
fn parameters_are_those_of_differences() {
    for (robot, case) in robots() {
        let mut parameters = vec![
            Parameter::YoungModulus,
            Parameter::PoissonRatio,
            Parameter::Diameter,
            Parameter::HoleRadius,
            Parameter::RestCurvature { axis: 0 },
            Parameter::RestCurvature { axis: 2 },
            Parameter::DiskMass,
        ];
        for cable in 0..case.commands.len() {
            parameters.extend([
                Parameter::Angle { cable },
                Parameter::Radius { cable },
                Parameter::Turns { cable },
            ]);
        }
        // One straight cable twists nothing: differences of nothing are rounding.
        let twists = case.commands.len() > 1;
        parameters.retain(|parameter| {
            parameter.value(&robot, &case).is_ok()
                && (twists || *parameter != Parameter::PoissonRatio)
        });
        let (_, derivatives) = linearized(&robot, &case, &parameters);
        for (i, parameter) in parameters.iter().enumerate() {
            let value = parameter.value(&robot, &case).unwrap().abs();
            let step = match parameter {
                // Of holes it is how far beside them the cable is.
                Parameter::Radius { .. } if value == 0.0 => 4e-5,
                _ if value == 0.0 => 1e-2,
                _ => 5e-3 * value,
            };
            let solved = |by: f64| -> Result<Solution, SolveError> {
                // A mass cannot be negative.
                let by = if *parameter == Parameter::DiskMass { by.abs() } else { by };
                let (robot, case) = parameter.moved(&robot, &case, by)?;
                model().solve(&robot, &case)
            };
            let difference = differentiate(solved, step).unwrap();
            let change = derivatives.parameter(i, Hold::Commands);
            // Tensions are known to fewer digits than lengths.
            let off = off_above(100.0 * NOTHING / step, &change, &difference, &robot);
            assert!(off < 1e-6, "{parameter}: {off:e}");
        }
    }
}

/// A factor on all that resists is one on Young's modulus, and holes together move a cable as one.
#[test]
fn parameters_that_no_file_has() {
    let routing = Routing::Holes { holes: vec![4; 10], interpolation: Interpolation::Spline };
    let by_holes = paper_robot(vec![routing, helix(0.0, 0.5)]);
    let by_angle = paper_robot(vec![straight(90.0), helix(0.0, 0.5)]);
    let case = case(&[0.004, 0.003]);
    let mut list: Vec<Parameter> =
        (0..10).map(|disk| Parameter::HoleAngle { cable: 0, disk }).collect();
    list.push(Parameter::StiffnessScale(StiffnessPart::Bending));
    list.push(Parameter::StiffnessScale(StiffnessPart::Torsion));
    list.push(Parameter::YoungModulus);
    let (_, of_holes) = linearized(&by_holes, &case, &list);
    let (_, of_angle) = linearized(&by_angle, &case, &[Parameter::Angle { cable: 0 }]);
    let tip = |change: &Change| change.twist(Place::Tip);
    let parts = (0..10).map(|i| tip(&of_holes.parameter(i, Hold::Commands)));
    let sum = parts.fold(Twist::default(), |sum, twist| sum + twist);
    let whole = tip(&of_angle.parameter(0, Hold::Commands));
    assert!((sum.linear - whole.linear).norm() < 1e-8 * whole.linear.norm());
    let tensions = |i: usize| of_holes.parameter(i, Hold::Commands).tensions().to_vec();
    let (bending, torsion, young) = (tensions(10), tensions(11), tensions(12));
    for cable in 0..2 {
        let whole = young[cable] * 1.1e9;
        assert!((bending[cable] + torsion[cable] - whole).abs() < 1e-8 * whole.abs());
    }
}

/// The compliance is that of the other derivation, and a wrench on the tip is worth what backward says.
#[test]
fn compliance_and_gradients_agree() {
    for (robot, case) in robots() {
        let parameters = [Parameter::HoleRadius, Parameter::YoungModulus];
        let (_, derivatives) = linearized(&robot, &case, &parameters);
        let (_, local) = model().solve_at(&robot, &case, 0.095).unwrap();
        let compliances = local.compliances.unwrap();
        let found = derivatives.at(Place::Station(1)).unwrap();
        let length = robot.backbone().length;
        let unit = length * length / bending_stiffness(&robot);
        for (hold, expected) in [
            (Hold::Tensions, compliances.tensions_held),
            (Hold::Lengths, compliances.lengths_held),
            (Hold::Commands, compliances.lengths_held),
        ] {
            let got = derivatives.compliance(Place::Station(1), hold).unwrap();
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                let (a, b) = (got.at(i, j), expected.compliance.at(i, j));
                assert!((a - b).abs() < 1e-6 * unit / length, "{hold:?} {i} {j}: {a:e} {b:e}");
            }
        }
        for (a, b) in found.actuation_jacobian.iter().zip(&local.actuation_jacobian) {
            assert!((a.linear - b.linear).norm() < 1e-7 * b.linear.norm());
        }
        let twist =
            Twist { linear: Vec3::new(0.3, -1.2, 0.7), angular: Vec3::new(0.02, 0.05, -0.01) };
        let cables = case.commands.len();
        let cotangent = Cotangent {
            places: vec![(Place::Tip, twist)],
            lengths: vec![0.9; cables],
            tensions: vec![1e-3; cables],
            ..Cotangent::default()
        };
        let worth = |change: &Change| {
            let moved = change.twist(Place::Tip);
            let sum = |values: &[f64]| values.iter().sum::<f64>();
            moved.linear.dot(twist.linear)
                + moved.angular.dot(twist.angular)
                + 0.9 * sum(change.lengths())
                + 1e-3 * sum(change.tensions())
        };
        let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-8 * b.abs(), "{a:e} {b:e}");
        for hold in [Hold::Commands, Hold::Tensions] {
            let gradient = derivatives.pull_back(&cotangent, hold);
            close(gradient.parameters[0], worth(&derivatives.parameter(0, hold)));
            close(
                gradient.wrench(Place::Station(0)).force.x,
                worth(&derivatives.wrench(Place::Station(0), 0, hold)),
            );
            for cable in 0..cables {
                close(gradient.commands[cable], worth(&derivatives.command(cable)));
            }
        }
    }
}

#[test]
fn contacts_hold_it() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.045, 0.0, 0.12), 0.02);
    // Where the backbone touches between its watched places is known less well.
    let cases =
        [(wall(0.05), 1e-5), (Obstacle { friction: 0.1, ..wall(0.05) }, 1e-4), (ball, 1e-2)];
    for (obstacle, tolerance) in cases {
        let at = |shortening: f64| among(case(&[shortening]), vec![obstacle.clone()]);
        let mut prepared = model().prepare(&robot, &Default::default()).unwrap();
        let parameters = [Parameter::Radius { cable: 0 }];
        let (base, derivatives) =
            prepared.solve_with_derivatives(&at(0.012), None, &parameters).unwrap();
        assert!(!base.contacts.is_empty());
        let change = derivatives.command(0);
        let h = 2e-5;
        // What slides on sticks when it is let go: from rest each time.
        let tip =
            |x: f64| prepared.clone().solve(&at(0.012 + x), None).unwrap().shape.tip().position;
        let slope = (8.0 * (tip(h) - tip(-h)) - (tip(2.0 * h) - tip(-2.0 * h))) / (12.0 * h);
        let found = change.twist(Place::Tip).linear;
        assert!((slope - found).norm() <= tolerance * found.norm(), "{slope:?} {found:?}");
        let tip = |x: f64| {
            let (robot, case) =
                Parameter::Radius { cable: 0 }.moved(&robot, &at(0.012), x).unwrap();
            model().solve(&robot, &case).unwrap().shape.tip().position
        };
        let slope = (8.0 * (tip(h) - tip(-h)) - (tip(2.0 * h) - tip(-2.0 * h))) / (12.0 * h);
        let found = derivatives.parameter(0, Hold::Commands).twist(Place::Tip).linear;
        assert!((slope - found).norm() <= tolerance * found.norm(), "{slope:?} {found:?}");
    }
}

#[test]
fn without_a_strain_energy_they_are_refused() {
    let robot = paper_robot(vec![straight(0.0)]);
    let mut by_angles =
        Model::FourBar(Options::default()).prepare(&robot, &Default::default()).unwrap();
    let refused =
        by_angles.solve_with_derivatives(&case(&[0.004]), None, &[]).unwrap_err().to_string();
    assert!(refused.contains("strain-energy"), "{refused}");
}
