//! Without noise the true values are found, from wherever the search starts, by all models and for all kinds
//! of unknowns: derivatives that are wrong would keep it from ending there, or make it slow.

use crate::common::{helix, paper_robot, straight};
use crate::identification::synthetic::{
    as_pixels, cases, experiments, model, quantity, settings, unknowns,
};
use whipcord::robot::BendingFriction;
use whipcord::{
    Backbone, Cable, Case, LoadFrame, Loads, ModelKind, Pose, Robot, Shortening, Statics,
    UnitQuaternion, Vec3,
};
use whipcord_estimation::identification::{
    Asked, Experiment, Quantity, Settings, Unknown, analyse, identify, registered,
};
use whipcord_estimation::registration::Alignment;
use whipcord_estimation::{Observation, Place, Seen};

/// Fits the unknowns, started off by these factors or sums, to what the robot with the true ones shows;
/// asserts that they are found, in at most so many evaluations.
fn found(
    kind: ModelKind,
    robot: &Robot,
    seen: &[Experiment],
    unknowns: &[Unknown],
    truth: &[f64],
    evaluations: usize,
) {
    let settings = Settings::new(model(kind));
    let found = identify(robot, seen, unknowns, &settings).unwrap();
    assert!(found.status.is_converged(), "{:?}", found.status);
    for (estimate, truth) in found.estimates.iter().zip(truth) {
        let off = (estimate.value - truth).abs() / truth.abs().max(1e-3);
        assert!(off < 1e-6, "{}: {} instead of {truth}", estimate.unknown, estimate.value);
    }
    assert!(found.evaluations <= evaluations, "{} evaluations", found.evaluations);
}

fn at(path: &str, start: f64) -> Unknown {
    Unknown { start: Some(start), ..Unknown::new(quantity(path)) }
}

/// Of the rod, the holes, the loads and the base at once, under gravity-free loads in the frame of the
/// base.
#[test]
fn of_a_loaded_robot_in_two_cases() {
    let robot = paper_robot(vec![straight(0.0), helix(90.0, 0.4)]);
    let case = |tensions: &[f64], position: Vec3, about: Vec3| Case {
        loads: Loads { tip_force: Vec3::new(0.05, -0.02, 0.03), ..Loads::default() },
        base: Pose { position, rotation: UnitQuaternion::exp(about) },
        ..Case::with_tensions(tensions)
    };
    let truth = [
        case(&[2.0, 0.5], Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.3, 0.2, -0.4)),
        case(&[0.3, 2.5], Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.3, 0.2, -0.4)),
    ];
    let seen = experiments(&model(ModelKind::Cosserat), &robot, &truth);
    let unknowns = [
        at("backbone.young_modulus", 1.5e9),
        at("cables[1].routing.radius", 0.006),
        at("loads.tip_force[0]", 0.0),
        at("backbone.rest_curvature[1]", 1.0),
        at("base.position[2]", 0.32),
        Unknown { start: Some(-0.15), ..Unknown::of(quantity("base.position[1]"), 1) },
        at("base.turn[0]", 0.1),
        at("base.turn[1]", -0.1),
        at("base.turn[2]", 0.05),
    ];
    let values = [1.1e9, 0.008, 0.05, 0.0, 0.3, -0.2, 0.0, 0.0, 0.0];
    found(ModelKind::Cosserat, &robot, &seen, &unknowns, &values, 12);
}

/// A tracker has a frame of its own. Under gravity that is no pose of the base; the frame is found exactly, by each experiment or by all, and
/// serves measurements that are not fitted.
#[test]
fn of_measurements_in_a_frame_of_their_own() {
    let backbone = crate::common::paper_backbone();
    let mut material = backbone.material;
    material.density = Some(1040.0);
    let backbone = Backbone { material, ..backbone };
    let plain = paper_robot(vec![straight(0.0), straight(90.0)]);
    let robot = Robot::new(backbone, plain.disks().clone(), plain.cables().to_vec()).unwrap();
    let case = |tensions: &[f64]| Case {
        loads: Loads { gravity: Some(Vec3::new(0.0, -9.81, 0.0)), ..Loads::default() },
        ..Case::with_tensions(tensions)
    };
    let frame = Pose {
        position: Vec3::new(0.4, -1.2, 0.7),
        rotation: UnitQuaternion::exp(Vec3::new(0.5, -1.4, 0.8)),
    };
    let all = [case(&[2.0, 0.5]), case(&[0.3, 2.5]), case(&[1.0, 1.0])];
    let mut seen = experiments(&model(ModelKind::Cosserat), &robot, &all);
    for of in &mut seen {
        of.alignment = Alignment::Rigid;
        for observation in &mut of.observations {
            if let Seen::Position(position) = &mut observation.seen {
                *position = frame.transform(*position);
            }
        }
    }
    let asked = [at("backbone.young_modulus", 1.3e9), at("backbone.density", 2000.0)];
    let settings = Settings::new(model(ModelKind::Cosserat));
    for one_frame in [false, true] {
        let (fitted, unknowns) =
            registered(&robot, &seen[..2], &asked, one_frame, &settings).unwrap();
        assert_eq!(unknowns.len(), if one_frame { 8 } else { 14 });
        let found = identify(&robot, &fitted, &unknowns, &settings).unwrap();
        assert!(found.status.is_converged() && found.evaluations < 12, "{}", found.evaluations);
        assert!((found.estimates[0].value / 1.1e9 - 1.0).abs() < 1e-6);
        assert!((found.estimates[1].value / 1040.0 - 1.0).abs() < 1e-6);
        for of in &found.frames {
            assert!((of.position - frame.position).norm() < 1e-8);
            assert!((of.rotation.conjugate() * frame.rotation).log().norm() < 1e-7);
        }
        let asked = Asked { test: Some((seen[2..].to_vec(), false)), ..Asked::default() };
        let analyses = analyse(&robot, &fitted, &unknowns, &settings, &found, &asked).unwrap();
        assert!(analyses.test.unwrap().rms_distance.unwrap() < 1e-7);
    }
}

/// The best of several starts is the best end, whichever comes first.
#[test]
fn of_several_starts() {
    let robot = crate::identification::synthetic::robot();
    let seen = experiments(&model(ModelKind::Cosserat), &robot, &cases(&[1.0, 2.5]));
    let settings = Settings { starts: 5, ..Settings::new(model(ModelKind::Cosserat)) };
    let found = identify(&robot, &seen, &[at("backbone.young_modulus", 2.0e9)], &settings);
    let found = found.unwrap();
    assert_eq!((found.starts.tried, found.starts.agree), (5, 5));
    assert!((found.estimates[0].value / 1.1e9 - 1.0).abs() < 1e-6);
    assert_eq!(found.estimates[0].unknown.start, Some(2.0e9));
}

/// A turn of the base turns loads of the world in the robot: there are only differences.
#[test]
fn of_a_base_under_gravity() {
    let backbone = crate::common::paper_backbone();
    let mut material = backbone.material;
    material.density = Some(1040.0);
    let backbone = Backbone { material, ..backbone };
    let plain = paper_robot(vec![straight(0.0)]);
    let robot = Robot::new(backbone, plain.disks().clone(), plain.cables().to_vec()).unwrap();
    let case = Case {
        loads: Loads {
            frame: LoadFrame::World,
            gravity: Some(Vec3::new(0.0, -9.81, 0.0)),
            ..Loads::default()
        },
        ..Case::with_tensions(&[1.0])
    };
    let seen = experiments(&model(ModelKind::Cosserat), &robot, &[case]);
    let unknowns =
        [at("base.turn[0]", 0.2), at("base.turn[2]", -0.1), at("backbone.density", 2000.0)];
    found(ModelKind::Cosserat, &robot, &seen, &unknowns, &[0.0, 0.0, 1040.0], 10);
}

#[test]
fn of_offsets_and_factors() {
    let robot = paper_robot(vec![straight(0.0), helix(120.0, 0.3)]);
    let mut case = Case::with_shortenings(&[Shortening::Fraction(0.03), Shortening::Length(0.0)]);
    case.commands[1] = Case::with_tensions(&[1.0]).commands[0];
    let seen = experiments(&model(ModelKind::Cosserat), &robot, &[case.clone()]);
    let mut moved = case;
    moved.commands[0].shortening = Some(Shortening::Fraction(0.03 - 0.002 / 0.18));
    moved.commands[1].tension = Some(1.2);
    let seen: Vec<Experiment> =
        seen.into_iter().map(|of| Experiment { case: moved.clone(), ..of }).collect();
    let unknowns = [
        at("cables[0].shortening_offset", 0.0),
        at("cables[1].tension_offset", 0.0),
        at("backbone.torsion_factor", 1.3),
    ];
    found(ModelKind::Cosserat, &robot, &seen, &unknowns, &[0.002, -0.2, 1.0], 12);
}

#[test]
fn of_markers_in_images() {
    let robot = paper_robot(vec![straight(0.0), straight(120.0)]);
    let cases = [Case::with_tensions(&[2.0, 0.2]), Case::with_tensions(&[0.2, 1.5])];
    let model = model(ModelKind::Cosserat);
    let seen = as_pixels(&model, &robot, &cases, Vec3::new(0.008, 0.002, 0.001));
    let unknowns = [
        at("backbone.young_modulus", 0.9e9),
        at("disks.hole_circle_radius", 0.008),
        at("base.position[0]", 0.004),
        at("base.turn[2]", 0.1),
    ];
    // These cables do not run through the holes.
    let found = identify(&robot, &seen, &unknowns, &settings()).unwrap();
    assert_eq!(found.unresolved.len(), 1);
    assert_eq!(
        found.unresolved[0].to_string(),
        "nothing that was measured depends on disks.hole_circle_radius"
    );
    assert!(found.estimates[1].deviation.is_none());
    assert!(found.rms_distance.is_none() && found.rms_pixels.is_some_and(|rms| rms < 1e-6));
    for (i, truth) in [(0, 1.1e9), (2, 0.0), (3, 0.0)] {
        assert!((found.estimates[i].value - truth).abs() < 1e-8 + 1e-6 * truth, "{found:?}");
    }
}

/// Friction along steps that pull and release, exactly; lengths of a model without forces by differences.
#[test]
fn of_friction_and_of_length() {
    let plain = paper_robot(vec![straight(0.0)]);
    let cable = Cable { friction: Some(0.2), ..plain.cables()[0].clone() };
    let robot = Robot::new(plain.backbone().clone(), plain.disks().clone(), vec![cable]).unwrap();
    let commands = |tension: f64| Case::with_tensions(&[tension]).commands;
    let case = Case { before: vec![commands(1.0), commands(3.0)], ..Case::with_tensions(&[1.5]) };
    let seen = experiments(&model(ModelKind::CosseratDisks), &robot, &[case]);
    let start = [at("cables.friction", 0.1), at("backbone.young_modulus", 1.2e9)];
    found(ModelKind::CosseratDisks, &robot, &seen, &start, &[0.2, 1.1e9], 12);

    let robot = paper_robot(vec![helix(0.0, 0.4)]);
    let case = Case::with_shortenings(&[Shortening::Fraction(0.05)]);
    let seen = experiments(&model(ModelKind::FourBar), &robot, &[case]);
    let start = [at("cables[0].routing.radius", 0.007), at("cables[0].shortening_offset", 1e-3)];
    found(ModelKind::FourBar, &robot, &seen, &start, &[0.008, 0.0], 12);
}

/// A friction that is nought lies at the end of what it can be: the differences are one-sided.
#[test]
fn of_friction_that_is_none() {
    let robot = paper_robot(vec![straight(0.0)]);
    let seen =
        experiments(&model(ModelKind::CosseratDisks), &robot, &[Case::with_tensions(&[2.0])]);
    let settings = Settings::new(model(ModelKind::CosseratDisks));
    let found = identify(&robot, &seen, &unknowns(&["cables[0].friction"]), &settings).unwrap();
    let friction = &found.estimates[0];
    assert!(friction.value == 0.0 && friction.is_at_bound && friction.deviation.is_none());
    assert!(friction.by_differences);
}

/// Friction against bending and stiffness of the backbone from the loops of a robot in steps, of which the first were not
/// measured but are history.
#[test]
fn of_friction_against_bending_through_the_steps() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let plain = paper_robot(vec![straight(0.0), straight(120.0), straight(240.0)]);
        let friction = BendingFriction { yield_moment: [6e-3; 2], yield_stiffness: None };
        let backbone = Backbone { bending_friction: Some(friction), ..plain.backbone().clone() };
        let robot = Robot::new(backbone, plain.disks().clone(), plain.cables().to_vec()).unwrap();
        let mut case = cases(&[2.5, 1.0, 0.6, 1.5]).remove(0);
        case.loads.tip_force = Vec3::new(0.0, 0.02, -0.01);
        let mut seen = experiments(&model(kind), &robot, &[case]);
        seen[0].observations.retain(|seen| seen.step > 0);
        let unknowns = [at("backbone.yield_moment", 3e-3), at("backbone.young_modulus", 1.3e9)];
        found(kind, &robot, &seen, &unknowns, &[6e-3, 1.1e9], 20);
        // By offsets of commands, which change what the steps before left.
        let offsets = [at("backbone.yield_moment", 5.5e-3), at("cables[1].tension_offset", 0.02)];
        found(kind, &robot, &seen, &offsets, &[6e-3, 0.0], 20);
    }
}

/// Positions and orientations of two tracked bodies that are mounted nobody knows how, in the frame of a tracker: frame, mounting and the
/// numbers of the robot are found together, exactly and with the derivatives of all models that have them.
#[test]
fn orientations_of_bodies_are_fitted() {
    let robot = paper_robot(vec![straight(0.0), helix(90.0, 0.4)]);
    let cases: Vec<Case> = [[2.0, 0.5], [0.3, 2.5], [1.0, 1.5], [0.0, 0.8]]
        .map(|tensions| Case::with_tensions(&tensions))
        .to_vec();
    let tracker = Pose {
        position: Vec3::new(0.4, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.5, -1.0, 0.8)),
    };
    let body = UnitQuaternion::exp(Vec3::new(1.0, 2.0, -0.5));
    for kind in [ModelKind::Cosserat, ModelKind::PiecewiseConstantCurvature] {
        let mut seen = experiments(&model(kind), &robot, &cases);
        for (experiment, case) in seen.iter_mut().zip(&cases) {
            let solution = model(kind).solve(&robot, case).unwrap();
            experiment.alignment = Alignment::Rigid;
            // Of the positions two are left.
            experiment.observations.retain(|seen| matches!(seen.place, Place::Disk(5 | 9)));
            let mut turned = Vec::new();
            for of in &mut experiment.observations {
                let Place::Disk(disk) = of.place else { unreachable!() };
                if let Seen::Position(position) = &mut of.seen {
                    *position = tracker.transform(*position);
                }
                let rotation = tracker.rotation * solution.disks.poses[disk].rotation * body;
                turned.push(Observation { seen: Seen::Rotation { rotation, arm: 0.05 }, ..*of });
            }
            experiment.observations.extend(turned);
        }
        let unknowns = [at("backbone.young_modulus", 1.5e9), at("cables[1].routing.radius", 0.006)];
        let settings = Settings::new(model(kind));
        let (seen, all) = registered(&robot, &seen, &unknowns, true, &settings).unwrap();
        assert_eq!(all.len(), 2 + 6 + 3, "{kind}");
        let found = identify(&robot, &seen, &all, &settings).unwrap();
        assert!(found.status.is_converged(), "{kind}: {:?}", found.status);
        assert!((found.estimates[0].value / 1.1e9 - 1.0).abs() < 1e-6, "{kind}");
        assert!((found.estimates[1].value / 0.008 - 1.0).abs() < 1e-6, "{kind}");
        assert!(found.evaluations < 30, "{kind}: {}", found.evaluations);
        // What is left is nothing, of turns as well.
        assert!(found.residuals.iter().all(|residual| residual.distance() < 1e-8), "{kind}");
        assert!(found.estimates.iter().all(|estimate| !estimate.by_differences), "{kind}");

        // Where the mounting is known no turn of it is added, and a wrong one shows.
        let mut known = seen.clone();
        known.iter_mut().for_each(|of| of.body = Some(body));
        let (_, all) = registered(&robot, &known, &unknowns, true, &settings).unwrap();
        assert!(all.iter().all(|of| !matches!(of.quantity, Quantity::BodyTurn { .. })), "{kind}");
    }
}
