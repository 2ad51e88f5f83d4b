//! Derivatives through the history of friction against bending, against differences of answers.

use whipcord::cosserat::Accuracy;
use whipcord::derivatives::{Cotangent, Hold, Place};
use whipcord::robot::BendingFriction;
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Material, Model, ModelKind, Parameter,
    Robot, Routing, Section, Shortening, Stations, Twist, Vec3,
};

const ARM: f64 = 0.008;
const LENGTH: f64 = 0.2;

fn robot(given: bool, moment: f64) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.0026)),
        material: Material {
            young_modulus: Some(1.8e9),
            poisson_ratio: Some(0.3),
            density: Some(1200.0),
            ..Default::default()
        },
        bending_friction: Some(BendingFriction {
            yield_moment: [moment, 1.3 * moment],
            yield_stiffness: given.then_some([0.03, 0.025]),
        }),
        ..Backbone::new(LENGTH)
    };
    let cables = vec![
        Cable::new("a", Routing::Straight { angle: 0.2, radius: ARM }),
        Cable::new("b", Routing::Helix { start_angle: 2.4, turns: 0.3, radius: ARM }),
        Cable {
            axial_stiffness: Some(2e3),
            ends_at: None,
            ..Cable::new("c", Routing::Straight { angle: 4.0, radius: ARM })
        },
    ];
    Robot::new(backbone, Disks::equally_spaced(LENGTH, 7, ARM), cables).unwrap()
}

fn case(loaded: bool, lengths: bool) -> Case {
    let step = |t: [f64; 3]| -> Vec<CableCommand> {
        t.iter()
            .map(|&t| {
                if lengths {
                    CableCommand {
                        tension: None,
                        shortening: Some(Shortening::Length(0.0012 * t - 0.0018)),
                    }
                } else {
                    CableCommand { tension: Some(t), shortening: None }
                }
            })
            .collect()
    };
    let steps = [step([2.0, 0.5, 0.3]), step([0.4, 1.2, 0.3]), step([1.0, 0.2, 2.0])];
    let mut case =
        Case { commands: steps[2].clone(), before: steps[..2].to_vec(), ..Case::default() };
    case.loads.gravity = loaded.then_some(Vec3::new(0.0, -9.81, 0.0));
    if loaded {
        case.loads.tip_force = Vec3::new(0.02, 0.05, -0.03);
    }
    case
}

#[test]
fn derivatives_agree_with_differences() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        for loaded in [false, true] {
            for lengths in [false, true] {
                for given in [true, false] {
                    let robot = robot(given, 4e-3);
                    let case = case(loaded, lengths);
                    let mut model = Model::new(
                        kind,
                        Stations::default(),
                        if lengths { Actuation::Shortening } else { Actuation::Tension },
                    );
                    if let Model::Cosserat(o) | Model::CosseratDisks(o) = &mut model {
                        o.accuracy = Accuracy::Steps(24);
                    }
                    let mut parameters = vec![
                        Parameter::YoungModulus,
                        Parameter::Diameter,
                        Parameter::YieldMoment { axis: None },
                        Parameter::YieldMoment { axis: Some(1) },
                        Parameter::RestCurvature { axis: 0 },
                        Parameter::Radius { cable: 0 },
                        Parameter::AxialStiffness { cable: 2 },
                    ];
                    if given {
                        parameters.push(Parameter::YieldStiffness { axis: None });
                    }
                    if loaded {
                        parameters.extend([
                            Parameter::TipForce { axis: 1 },
                            Parameter::Gravity { axis: 0 },
                            Parameter::Density,
                        ]);
                    }
                    let solve = |robot: &Robot, case: &Case| {
                        model.prepare(robot, &case.loads).unwrap().solve(case, None).unwrap()
                    };
                    let (solution, of) = model
                        .prepare(&robot, &case.loads)
                        .unwrap()
                        .solve_with_derivatives(&case, None, &parameters)
                        .unwrap();
                    assert_eq!(solution.shape, solve(&robot, &case).shape);
                    assert!(solution.plastic_curvature.iter().all(|held| *held != [0.0; 2]));
                    let direction = Vec3::new(0.3, -0.5, 0.8);
                    let cotangent = Cotangent {
                        places: vec![(
                            Place::Disk(6),
                            Twist { linear: direction, angular: Vec3::ZERO },
                        )],
                        ..Cotangent::default()
                    };
                    let gradient = of.pull_back(&cotangent, Hold::Commands);
                    for (p, parameter) in parameters.iter().enumerate() {
                        let value = parameter.value(&robot, &case).unwrap();
                        let scale = match parameter {
                            Parameter::RestCurvature { .. } => 1.0,
                            Parameter::Gravity { .. } => 10.0,
                            _ => value.abs(),
                        };
                        let h = 1e-5 * scale;
                        let at = |by: f64| {
                            let (r, c) = parameter.moved(&robot, &case, by).unwrap();
                            solve(&r, &c).disks.tip().position
                        };
                        let difference = (at(h) - at(-h)) * (0.5 / h);
                        let exact = of.parameter(p, Hold::Commands).twist(Place::Disk(6)).linear;
                        let off = (difference - exact).norm() * scale / LENGTH;
                        let backward = gradient.parameters[p];
                        let forward = exact.dot(direction);
                        assert!(
                            (backward - forward).abs() * scale < 1e-9,
                            "{parameter}: {backward} {forward}"
                        );
                        assert!(
                            off < 1e-7,
                            "{kind:?} {loaded} {lengths} {given} {parameter}: {off}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_derivatives_of_a_step_are_those_of_the_steps_up_to_it() {
    let parameters = [Parameter::YieldMoment { axis: None }, Parameter::YoungModulus];
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let (robot, case) = (robot(true, 4e-3), case(true, false));
        let model = Model::new(kind, Stations::default(), Actuation::Tension);
        let mut prepared = model.prepare(&robot, &case.loads).unwrap();
        let mut found = Vec::new();
        prepared
            .solve_steps_with_derivatives(
                &case,
                &parameters,
                |step| step != 1,
                |solution, of| {
                    found.push((solution, of));
                },
            )
            .unwrap();
        assert_eq!(found.len(), 3);
        for (n, (solution, of)) in found.iter().enumerate() {
            assert_eq!(of.is_some(), n != 1);
            let Some(of) = of else { continue };
            let step = case.step(n).unwrap();
            let (alone, derivatives) =
                prepared.solve_with_derivatives(&step, None, &parameters).unwrap();
            assert_eq!(alone.shape, solution.shape);
            let tip = |of: &whipcord::Linearization| {
                of.parameter(0, Hold::Commands).twist(Place::Disk(6))
            };
            assert_eq!(tip(of), tip(&derivatives));
        }
    }
}
