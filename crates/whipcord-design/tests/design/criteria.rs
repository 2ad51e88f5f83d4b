//! Objectives and constraints beside the targets, against formulas and solves of their own.

use core::f64::consts::{PI, TAU};

use whipcord::obstacle::{Form, Obstacle};
use whipcord::{
    Actuation, Case, Model, ModelKind, Parameter, Pose, Robot, Routing, Statics as _, Stations,
    Vec3,
};
use whipcord_design::{
    Criterion, Design, DesignError, DesignGoal, DesignOptions, Known, Proof, Quantity, TargetShape,
    Vary, design,
};

use crate::robots::{LENGTH, holed, straight, with_holes};

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

fn at_least(quantity: Quantity, limit: f64) -> Criterion {
    Criterion { quantity, weight: None, limit: Some(limit) }
}

fn objective(quantity: Quantity, weight: f64) -> Criterion {
    Criterion { quantity, weight: Some(weight), limit: None }
}

fn points(case: Case, points: Vec<(usize, Vec3)>) -> DesignGoal {
    DesignGoal { case, target: TargetShape::Points(points), weight: 1.0 }
}

fn solved(
    kind: ModelKind,
    robot: &Robot,
    goals: &[DesignGoal],
    vary: &[Vary],
    criteria: &[Criterion],
) -> Result<Design, DesignError> {
    let options =
        DesignOptions { criteria: criteria.to_vec(), starts: 1, ..DesignOptions::default() };
    design(&model(kind), robot, goals, vary, &options)
}

fn tip(robot: &Robot, tensions: &[f64]) -> Vec3 {
    let case = Case::with_tensions(tensions);
    model(ModelKind::Cosserat).solve(robot, &case).unwrap().shape.tip().position
}

/// Without a target every diameter that is stiff enough is as good: from several starts the first one is taken, which changes the robot least.
#[test]
fn of_designs_that_are_as_good_that_of_the_given_robot_is_taken() {
    let robot = straight(&[0.0], 0.008);
    let goals = [points(Case::with_tensions(&[0.0]), vec![])];
    let stiffness = Quantity::Stiffness { disk: 9, direction: Some(Vec3::X) };
    let vary = [Vary::Parameter(Parameter::Diameter)];
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let found = solved(kind, &robot, &goals, &vary, &[at_least(stiffness, 20.0)]).unwrap();
        let result = found.criteria[0];
        assert!(result.is_met() && result.value < 1.05 * 20.0, "{kind}: {result:?}");
    }
}

/// A straight rod is a cantilever: 1/k = L³/3EI + L/GA.
#[test]
fn a_diameter_gives_the_stiffness_that_is_asked_for() {
    let robot = straight(&[0.0], 0.008);
    let case = Case::with_tensions(&[0.0]);
    let goals = [points(case.clone(), vec![(9, Vec3::Z * LENGTH)])];
    let stiffness = Quantity::Stiffness { disk: 9, direction: Some(Vec3::X) };
    let vary = [Vary::Parameter(Parameter::Diameter)];
    let wanted = 20.0;
    let found =
        solved(ModelKind::Cosserat, &robot, &goals, &vary, &[at_least(stiffness, wanted)]).unwrap();
    let result = found.criteria[0];
    let cantilever = |diameter: f64| {
        let (e, g) = (1.1e9, 1.1e9 / 2.6);
        let (area, inertia) = (PI * diameter.powi(2) / 4.0, PI * diameter.powi(4) / 64.0);
        1.0 / (LENGTH.powi(3) / (3.0 * e * inertia) + LENGTH / (g * area))
    };
    let diameter = Parameter::Diameter.value(&found.robot, &case).unwrap();
    assert!(result.is_met() && result.value < 1.05 * wanted, "{result:?}");
    assert!((result.value / cantilever(diameter) - 1.0).abs() < 1e-6);
    assert!((result.before.unwrap() / cantilever(0.003) - 1.0).abs() < 1e-6);
    // Within given diameters there is none as stiff.
    let options = DesignOptions {
        criteria: vec![at_least(stiffness, 1e6)],
        diameters: Some([0.001, 0.004]),
        starts: 1,
        ..DesignOptions::default()
    };
    let refused = design(&model(ModelKind::Cosserat), &robot, &goals, &[Vary::Diameters], &options);
    let Err(DesignError::NotMet(unmet)) = refused else { panic!("{refused:?}") };
    assert!((unmet[0].value / cantilever(0.004) - 1.0).abs() < 0.01, "{unmet:?}");
}

/// Three cables have a common mode, which moves the tip little: least tension leaves one of them slack.
#[test]
fn least_tension_takes_the_common_mode_away_and_a_limit_holds() {
    let robot = straight(&[0.0, TAU / 3.0, 2.0 * TAU / 3.0], 0.008);
    let target = tip(&robot, &[3.0, 2.0, 1.0]);
    let goals = [points(Case::with_tensions(&[4.0, 3.0, 2.0]), vec![(9, target)])];
    let vary = [0, 1, 2].map(|cable| Vary::Tension { cable });
    let with = |criteria: &[Criterion]| {
        let found = solved(ModelKind::Cosserat, &robot, &goals, &vary, criteria).unwrap();
        let commands = &found.goals[0].case.commands;
        let tensions: Vec<f64> = commands.iter().map(|of| of.tension.unwrap()).collect();
        (found, tensions)
    };
    let (free, usual) = with(&[]);
    assert!(free.error < 1e-6 * LENGTH);
    let (least, tensions) = with(&[objective(Quantity::Tension, 1e-3)]);
    assert!(least.error < 1e-3 * LENGTH, "{:e}", least.error / LENGTH);
    let squares = |of: &[f64]| of.iter().map(|tension| tension * tension).sum::<f64>();
    assert!(squares(&tensions) < 0.6 * squares(&usual), "{tensions:?} {usual:?}");
    assert!(tensions[2] < 0.05 && (tensions[0] - 2.0).abs() < 0.05, "{tensions:?}");
    let (limited, tensions) = with(&[at_least(Quantity::Tension, 2.2)]);
    assert!(tensions.iter().all(|tension| *tension <= 2.2), "{tensions:?}");
    assert!(limited.error < 1e-3 * LENGTH && limited.criteria[0].is_met());
    // A limit below what [limits] asks for at least.
    let options = DesignOptions {
        criteria: vec![at_least(Quantity::Tension, 1.0)],
        tensions: vec![Some([1.5, 9.0]); 3],
        ..DesignOptions::default()
    };
    let refused = design(&model(ModelKind::Cosserat), &robot, &goals, &vary, &options);
    assert!(matches!(refused, Err(DesignError::Criterion { .. })), "{refused:?}");
}

fn ball(position: Vec3, radius: f64) -> Obstacle {
    Obstacle {
        name: "ball".to_owned(),
        form: Form::Sphere { radius },
        pose: Pose { position, ..Pose::IDENTITY },
        friction: 0.0,
        movable: None,
    }
}

/// Least distance of the backbone's surface from a ball, by stations of its own.
fn distance(robot: &Robot, case: &Case, centre: Vec3, radius: f64) -> f64 {
    let stations = whipcord::equally_spaced(0.0, LENGTH, 200).collect();
    let free = Case { obstacles: Vec::new(), ..case.clone() };
    let solution =
        model(ModelKind::Cosserat).at(Stations::At(stations)).solve(robot, &free).unwrap();
    let off = |pose: &Pose| (pose.position - centre).norm() - radius - 0.0015;
    solution.shape.poses.iter().map(off).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_routing_keeps_clear_of_a_ball_on_the_way() {
    let robot = straight(&[0.0], 0.006);
    let target = tip(&robot, &[2.5]);
    // Beside the middle of the backbone in the shape that the cable would have.
    let (centre, radius) = (Vec3::new(0.035, 0.0, 0.075), 0.015);
    let case = Case { obstacles: vec![ball(centre, radius)], ..Case::with_tensions(&[2.5]) };
    let goals = [points(case.clone(), vec![(9, target)])];
    let vary = [Vary::Routing { cable: 0 }, Vary::Tension { cable: 0 }];
    let wanted = 0.004;
    let criterion = at_least(Quantity::Clearance, wanted);
    let found = solved(ModelKind::Cosserat, &robot, &goals, &vary, &[criterion]).unwrap();
    let apart = distance(&found.robot, &found.goals[0].case, centre, radius);
    println!("{:?} {apart:e} {:e}", found.criteria, found.error);
    assert!(found.criteria[0].before.unwrap() < wanted, "{:?}", found.criteria[0].before);
    assert!(found.criteria[0].is_met() && apart > wanted - 2e-4);
    assert!(found.error < 0.02 * LENGTH, "{:e}", found.error / LENGTH);
    let none = [points(Case::with_tensions(&[2.5]), vec![(9, target)])];
    let refused = solved(ModelKind::Cosserat, &robot, &none, &vary, &[criterion]);
    assert!(matches!(refused, Err(DesignError::Criterion { .. })));
}

#[test]
fn holes_stay_proven_where_the_nearest_list_keeps_clear_and_change_where_not() {
    let robot = holed(LENGTH, 6, 6, 1);
    let kind = ModelKind::CosseratDisks;
    let planted = with_holes(&robot, &[vec![1, 1, 2, 2, 1, 1]]);
    let case = Case::with_tensions(&[3.0]);
    let shape = model(kind).solve(&planted, &case).unwrap();
    let places = shape.disks.poses.iter().map(|pose| pose.position);
    let wanted: Vec<(usize, Vec3)> = places.enumerate().skip(1).collect();
    let beside = |off: Vec3| {
        let centre = wanted[3].1 + off;
        let case = Case { obstacles: vec![ball(centre, 0.004)], ..case.clone() };
        let goals = [points(case, wanted.clone())];
        let vary = [Vary::Holes { cable: 0 }];
        solved(kind, &robot, &goals, &vary, &[at_least(Quantity::Clearance, 0.003)]).unwrap()
    };
    let far = beside(Vec3::new(0.0, 0.1, 0.0));
    assert_eq!(far.robot.cables()[0].routing, Routing::holes(vec![1, 1, 2, 2, 1, 1]));
    let near = beside(Vec3::new(0.0, 0.012, 0.0));
    assert!(near.criteria[0].is_met() && near.error > 1e-4);
    assert_eq!(near.findings[0].known, Known::Holes(Proof::Local));
}

/// Thinner is more easily bent: the volume grows without any target, and as far as is asked for.
#[test]
fn a_workspace_grows() {
    let robot = straight(&[0.0, TAU / 3.0, 2.0 * TAU / 3.0], 0.008);
    let goals = [points(Case::with_tensions(&[1.0, 1.0, 1.0]), Vec::new())];
    let vary = [Vary::Parameter(Parameter::Diameter)];
    let options = |criterion| DesignOptions {
        criteria: vec![criterion],
        tensions: vec![Some([0.0, 4.0]); 3],
        starts: 1,
        ..DesignOptions::default()
    };
    let grown = |criterion| {
        let cosserat = model(ModelKind::Cosserat);
        design(&cosserat, &robot, &goals, &vary, &options(criterion)).unwrap()
    };
    let largest = grown(objective(Quantity::Workspace, 1.0));
    let (value, before) = (largest.criteria[0].value, largest.criteria[0].before.unwrap());
    assert!(value > 1.5 * before, "{value:e} {before:e}");
    let limited = grown(at_least(Quantity::Workspace, 1.3 * before));
    let result = limited.criteria[0];
    assert!(result.is_met() && result.value < 1.4 * before, "{:e} {before:e}", result.value);
    // No target and no criterion is nothing to do.
    let nothing = solved(ModelKind::Cosserat, &robot, &goals, &vary, &[]);
    assert!(matches!(nothing, Err(DesignError::NoPoints)));
}

/// Places of the tip along a path, each with tensions of its own.
#[test]
fn a_routing_leads_the_tip_along_a_path() {
    let planted = {
        let robot = straight(&[0.0, PI / 2.0], 0.006);
        let mut cables = robot.cables().to_vec();
        cables[0].routing = Routing::Polynomial { x: vec![0.006, -0.02], y: vec![0.0, 0.02] };
        Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
    };
    let path: Vec<Vec3> = (0..6)
        .map(|k| tip(&planted, &[1.0 + 0.4 * f64::from(k), 2.0 - 0.3 * f64::from(k)]))
        .collect();
    let robot = straight(&[0.0, PI / 2.0], 0.006);
    let goals: Vec<DesignGoal> = path
        .iter()
        .map(|place| points(Case::with_tensions(&[1.0, 1.0]), vec![(9, *place)]))
        .collect();
    let vary = [Vary::Routing { cable: 0 }, Vary::Tension { cable: 0 }, Vary::Tension { cable: 1 }];
    let found = solved(ModelKind::Cosserat, &robot, &goals, &vary, &[]).unwrap();
    println!("{:?} {:e}", found.findings, found.largest / LENGTH);
    assert!(found.largest < 2e-3 * LENGTH, "{:e}", found.largest / LENGTH);
    assert!(found.before.unwrap()[0] > 20.0 * found.error);
}

#[test]
fn criteria_that_cannot_be_say_why() {
    let robot = straight(&[0.0], 0.006);
    let goals = [points(Case::with_tensions(&[1.0]), vec![(9, Vec3::Z * LENGTH)])];
    let vary = [Vary::Tension { cable: 0 }];
    let base = Quantity::Stiffness { disk: 0, direction: None };
    let missing = Quantity::Stiffness { disk: 10, direction: None };
    let tilted = Quantity::Stiffness { disk: 3, direction: Some(Vec3::new(1.0, 1.0, 0.0)) };
    let nothing = Criterion { quantity: Quantity::Tension, weight: None, limit: None };
    for criterion in [
        at_least(base, 1.0),
        at_least(missing, 1.0),
        at_least(tilted, 1.0),
        objective(Quantity::Tension, 0.0),
        objective(Quantity::Tension, f64::NAN),
        at_least(Quantity::Workspace, -1.0),
        nothing,
    ] {
        let refused = solved(ModelKind::Cosserat, &robot, &goals, &vary, &[criterion]);
        assert!(matches!(refused, Err(DesignError::Criterion { .. })), "{refused:?}");
    }
    // Of a model without loads.
    let stiffness = at_least(Quantity::Stiffness { disk: 9, direction: None }, 1.0);
    let refused = solved(ModelKind::ConstantCurvature, &robot, &goals, &vary, &[stiffness]);
    assert!(refused.is_err());
}
