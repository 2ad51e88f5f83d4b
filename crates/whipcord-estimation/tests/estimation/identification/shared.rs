//! Numbers that several cables or motors share, gains of commands and offsets of markers.

use crate::common::{helix, paper_backbone, straight};
use crate::identification::synthetic::{experiments, model, quantity};
use whipcord::{Cable, Case, Disks, ModelKind, Motor, Robot, Routing, Shortening, Vec3};
use whipcord_estimation::Seen;
use whipcord_estimation::identification::{
    Experiment, IdentifyError, ParameterPath, Settings, Unknown, identify,
};

/// Four cables in two groups; two motors with an antagonistic pair each.
fn robot(change: impl Fn(&mut Vec<Cable>, &mut Vec<Motor>)) -> Robot {
    let cable = |name: &str, group: &str, degrees: f64| Cable {
        group: Some(group.into()),
        axial_stiffness: Some(4e3),
        ..Cable::new(name, straight(degrees))
    };
    let mut cables = vec![
        cable("east", "x", 0.0),
        cable("west", "x", 180.0),
        cable("north", "y", 90.0),
        Cable { routing: helix(270.0, 0.1), ..cable("south", "y", 270.0) },
    ];
    let motor = |name: &str, pair: [usize; 2]| Motor {
        stiffness: Some(6e3),
        pretension: 3.0,
        ..Motor::spool(name, [(pair[0], 0.01), (pair[1], -0.01)])
    };
    let mut motors = vec![motor("left", [0, 1]), motor("right", [2, 3])];
    change(&mut cables, &mut motors);
    let disks = Disks::equally_spaced(0.18, 10, 0.008);
    Robot::new(paper_backbone(), disks, cables).unwrap().with_motors(motors).unwrap()
}

fn driven(robot: &Robot) -> Case {
    let angles = [[0.3, -0.2], [-0.4, 0.5], [0.6, 0.6]];
    let mut case = Case {
        commands: vec![Default::default(); 4],
        before: vec![vec![Default::default(); 4]; angles.len() - 1],
        motors: angles.iter().map(|step| step.iter().map(|a| Some(*a)).collect()).collect(),
        ..Case::default()
    };
    case.drive(robot).unwrap();
    case
}

fn shared(robot: &Robot, path: &str, start: Option<f64>) -> Unknown {
    let path: ParameterPath = path.parse().unwrap();
    Unknown { start, ..path.unknown(robot).unwrap() }
}

/// Fits what the robot `real` shows with the robot `file`.
fn found(file: &Robot, seen: &[Experiment], unknowns: &[Unknown], truth: &[f64]) {
    let settings = Settings::new(model(ModelKind::Cosserat));
    let found = identify(file, seen, unknowns, &settings).unwrap();
    assert!(found.status.is_converged(), "{:?}", found.status);
    for (estimate, truth) in found.estimates.iter().zip(truth) {
        let off = (estimate.value - truth).abs() / truth.abs().max(1e-3);
        assert!(off < 1e-6, "{}: {} instead of {truth}", estimate.unknown, estimate.value);
        assert!(!estimate.by_differences, "{}", estimate.unknown);
    }
    assert!(found.evaluations <= 14, "{} evaluations", found.evaluations);
}

#[test]
fn of_motors_and_of_groups_of_cables() {
    let real = robot(|cables, motors| {
        motors.iter_mut().for_each(|motor| motor.stiffness = Some(2.5e3));
        cables[..2].iter_mut().for_each(|cable| cable.axial_stiffness = Some(1e3));
    });
    let file = robot(|_, _| {});
    let seen = experiments(&model(ModelKind::Cosserat), &real, &[driven(&real)]);
    let unknowns = [
        shared(&file, "motors[*].stiffness", None),
        shared(&file, "cables[x].axial_stiffness", None),
        shared(&file, "motors[right].angle_offset", Some(0.05)),
    ];
    found(&file, &seen, &unknowns, &[2.5e3, 1e3, 0.0]);
}

/// Of where cables run, the change is shared: each keeps its own angle.
#[test]
fn of_changes_of_the_routing() {
    let real = robot(|cables, _| {
        for cable in cables {
            match &mut cable.routing {
                Routing::Straight { angle, radius } => {
                    (*angle, *radius) = (*angle + 0.1, *radius + 4e-4)
                }
                Routing::Helix { start_angle, radius, .. } => {
                    (*start_angle, *radius) = (*start_angle + 0.1, *radius + 4e-4);
                }
                _ => unreachable!(),
            }
        }
    });
    let file = robot(|_, _| {});
    let mut case = Case::with_tensions(&[2.0, 0.2, 0.6, 1.4]);
    case.motors = vec![vec![None, None]];
    let seen = experiments(&model(ModelKind::Cosserat), &real, &[case]);
    let unknowns = [
        shared(&file, "cables[*].routing.angle", None),
        shared(&file, "cables[*].routing.radius", None),
    ];
    found(&file, &seen, &unknowns, &[0.1, 4e-4]);
}

#[test]
fn of_gains_and_markers_off_the_axis() {
    let robot = Robot::new(
        paper_backbone(),
        Disks::equally_spaced(0.18, 10, 0.008),
        [0.0, 120.0, 240.0].map(|a| Cable::new(format!("cable {a}"), straight(a))).to_vec(),
    )
    .unwrap();
    let step = |[first, second, tension]: [f64; 3], scale: f64, more: f64| {
        let mut case = Case::with_shortenings(&[
            Shortening::Length(first * scale + more),
            Shortening::Fraction((second * scale * 0.18 + more) / 0.18),
            Shortening::Length(0.0),
        ]);
        case.commands[2] = Case::with_tensions(&[tension * scale]).commands[0];
        case.commands
    };
    let command = |scale: f64, more: f64| Case {
        commands: step([0.004, 0.01, 0.5], scale, more),
        before: vec![step([0.001, 0.03, 0.8], scale, more)],
        ..Case::default()
    };
    let offset = Vec3::new(0.003, -0.001, 0.002);
    let real = [command(1.2, 1e-3)];
    let mut seen = experiments(&model(ModelKind::Cosserat), &robot, &real);
    let prepared = model(ModelKind::Cosserat).prepare(&robot, &real[0].loads);
    let mut solutions = Vec::new();
    prepared.unwrap().solve_steps(&real[0], |solution| solutions.push(solution)).unwrap();
    for seen in &mut seen[0].observations {
        if let (Seen::Position(position), whipcord_estimation::Place::Disk(disk)) =
            (&mut seen.seen, seen.place)
        {
            *position = solutions[seen.step].disks.poses[disk].transform(offset);
        }
    }
    seen[0].case = command(1.0, 0.0);
    let at = |path: &str| Unknown::new(quantity(path));
    let unknowns = [
        shared(&robot, "cables[*].gain", None),
        // Of the two that are driven by length.
        at("cables[0].shortening_offset"),
        at("cables[1].shortening_offset"),
        at("measured.offset[0]"),
        at("measured.offset[1]"),
        at("measured.offset[2]"),
    ];
    found(&robot, &seen, &unknowns, &[1.2, 1e-3, 1e-3, 0.003, -0.001, 0.002]);
}

#[test]
fn the_same_number_twice_is_refused() {
    let robot = robot(|_, _| {});
    let seen = experiments(&model(ModelKind::Cosserat), &robot, &[driven(&robot)]);
    let settings = Settings::new(model(ModelKind::Cosserat));
    let both = [
        shared(&robot, "cables[*].axial_stiffness", None),
        Unknown::new(quantity("cables[2].axial_stiffness")),
    ];
    let error = identify(&robot, &seen, &both, &settings).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cables[*].axial_stiffness and cables[2].axial_stiffness change the same numbers: estimate one of them"
    );
    // A member that robot and case do not have is named.
    let friction = [shared(&robot, "cables[*].tension_offset", None)];
    let error = identify(&robot, &seen, &friction, &settings).unwrap_err();
    assert!(matches!(error, IdentifyError::NotDriven { .. }), "{error}");
}

/// Stiffness of segments of the backbone: each its own, and one for a group.
#[test]
fn of_segments_of_the_backbone() {
    use whipcord::Backbone;
    use whipcord::robot::BackboneSegment;
    let robot = |factors: [f64; 3]| {
        let ends = [0.0, 0.05, 0.11, 0.18];
        let segments = factors.into_iter().enumerate().map(|(i, bending_factor)| BackboneSegment {
            bending_factor,
            group: (i > 0).then(|| "outer".to_owned()),
            ..BackboneSegment::new(format!("s{i}"), [ends[i], ends[i + 1]])
        });
        let backbone = Backbone { segments: segments.collect(), ..paper_backbone() };
        let cables = [0.0, 120.0, 240.0].map(|a| Cable::new(format!("cable {a}"), straight(a)));
        let disks = Disks::equally_spaced(0.18, 10, 0.008);
        Robot::new(backbone, disks, cables.to_vec()).unwrap()
    };
    let case = |tensions: &[f64]| {
        let mut case = Case::with_tensions(tensions);
        case.loads.tip_force = Vec3::new(0.05, 0.0, 0.0);
        case
    };
    let cases = [case(&[2.0, 0.5, 0.1]), case(&[0.1, 1.0, 1.5])];
    let file = robot([1.0; 3]);
    let seen = experiments(&model(ModelKind::Cosserat), &robot([1.3, 0.8, 0.9]), &cases);
    let each = ["s0", "s1", "s2"]
        .map(|name| shared(&file, &format!("backbone.segments[{name}].bending_factor"), None));
    found(&file, &seen, &each, &[1.3, 0.8, 0.9]);
    let seen = experiments(&model(ModelKind::Cosserat), &robot([1.3, 0.8, 0.8]), &cases);
    let grouped = [
        shared(&file, "backbone.segments[s0].bending_factor", None),
        shared(&file, "backbone.segments[outer].bending_factor", None),
    ];
    found(&file, &seen, &grouped, &[1.3, 0.8]);
}
