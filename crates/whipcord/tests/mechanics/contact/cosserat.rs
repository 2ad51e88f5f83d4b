//! The rod among obstacles.

use super::{LENGTH, STIFFNESS, among, assert_forces_hold, finger, moved, sphere, wall};
use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::{
    Case, Loads, Model, ModelKind, Obstruction, Part, Pose, Robot, Shortening, Solution,
    SolveError, Statics, UnitQuaternion, Vec3,
};

fn solve(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let model = Cosserat::new(robot, &case.loads, &Options::default())?;
    model.solve(case, None, &mut Workspace::default())
}

/// A slender rod of small slope bends under a moment M = τr along it and a force F across its tip by
/// `ML²/2EI − FL³/3EI`. The tip disk of radius R turns by θ, so its rim is lower by Rθ²/2, which is
/// left out, and higher by the roundness of the rim not at all.
#[test]
fn a_wall_holds_a_slender_rod_back_as_a_beam_says() {
    let robot = finger(9);
    for (tension, part) in [(0.05, 0.7), (0.05, 0.9), (0.02, 0.5)] {
        let moment = tension * 0.008;
        let free = moment * LENGTH * LENGTH / (2.0 * STIFFNESS);
        let held = part * free;
        let case = among(Case::with_tensions(&[tension]), vec![wall(held + 0.01)]);
        let solution = solve(&robot, &case).unwrap();
        let [touch] = solution.contacts[..] else { panic!("{:?}", solution.contacts) };
        assert_eq!((touch.part, touch.obstacle), (Part::Disk(9), 0));
        let force = 3.0 * STIFFNESS / LENGTH.powi(3) * (free - held);
        let found = touch.force.unwrap();
        assert!((found / force - 1.0).abs() < 0.02, "{found} N, {force} N");
        assert!((touch.point.x - held - 0.01).abs() < 1e-9 * LENGTH);
    }
}

/// What pushes the robot is in equilibrium with its base, and the rod under these forces as point loads
/// has the shape that was found. Nothing overlaps.
#[test]
fn contacts_hold_the_shape_and_do_not_overlap() {
    let robot = finger(9);
    for (tension, obstacle) in [
        (3.0, wall(0.05)),
        (3.0, sphere(Vec3::new(0.05, 0.0, 0.12), 0.03)),
        (3.0, sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)),
        (5.0, sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)),
    ] {
        let case = among(Case::with_tensions(&[tension]), vec![obstacle.clone()]);
        let solution = solve(&robot, &case).unwrap();
        assert!(!solution.contacts.is_empty());
        assert_forces_hold(ModelKind::Cosserat, &robot, &case, &solution);
        super::assert_clear(&robot, &solution, &obstacle);
    }
}

/// The obstacles stand in the world: where base and obstacles are moved together, so is the answer.
#[test]
fn moving_base_and_obstacles_moves_the_answer() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.005, 0.12), 0.03);
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    let here = among(Case::with_tensions(&[3.0]), vec![ball.clone()]);
    let there = Case { base, ..among(Case::with_tensions(&[3.0]), vec![moved(&ball, &base)]) };
    let [here, there] = [here, there].map(|case| solve(&robot, &case).unwrap());
    for (a, b) in here.disks.poses.iter().zip(&there.disks.poses) {
        assert!((base.transform(a.position) - b.position).norm() < 1e-8 * LENGTH);
    }
    for (a, b) in here.contacts.iter().zip(&there.contacts) {
        assert!((base.transform(a.point) - b.point).norm() < 1e-8 * LENGTH);
        assert!((a.force.unwrap() - b.force.unwrap()).abs() < 1e-7);
    }
}

/// A step from a known answer keeps its contacts and gives what a solve from rest does.
#[test]
fn a_warm_start_keeps_the_contacts() {
    let robot = finger(9);
    let case = |tension: f64| {
        among(Case::with_tensions(&[tension]), vec![sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)])
    };
    let model = Cosserat::new(&robot, &Loads::default(), &Options::default()).unwrap();
    let mut workspace = Workspace::default();
    let before = model.solve(&case(2.8), None, &mut workspace).unwrap();
    let warm = model.solve(&case(3.0), Some(&before), &mut workspace).unwrap();
    let cold = model.solve(&case(3.0), None, &mut workspace).unwrap();
    assert!(warm.diagnostics.iterations < cold.diagnostics.iterations);
    assert_eq!(warm.contacts.len(), cold.contacts.len());
    let apart = warm.disks.distances(&cold.disks).fold(0.0, f64::max);
    assert!(apart < 1e-7 * LENGTH, "{apart}");
}

/// An answer that no rod can start from is told of.
#[test]
fn a_warm_start_that_folds_the_rod_is_an_error() {
    let robot = finger(9);
    let case = among(Case::with_tensions(&[3.0]), vec![wall(0.05)]);
    let mut warm = solve(&robot, &case).unwrap();
    warm.cables[0].tension = Some(1e7);
    let model = Cosserat::new(&robot, &case.loads, &Options::default()).unwrap();
    let error = model.solve(&case, Some(&warm), &mut Workspace::default()).unwrap_err();
    assert!(error.to_string().contains("folds"), "{error}");
}

/// Pressed against the middle of a ball the finger slips off sideways, as whoever pushes a rod against a
/// ball knows: to one side or the other, the two being mirror images.
#[test]
fn a_finger_slips_off_the_middle_of_a_ball() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    let case = among(Case::with_tensions(&[3.5]), vec![ball.clone()]);
    let solution = solve(&robot, &case).unwrap();
    assert!(solution.diagnostics.stability_lost_at.is_some_and(|at| at > 0.5 && at < 1.0));
    let aside = solution.disks.tip().position.y;
    assert!(aside.abs() > 0.05 * LENGTH, "{aside}");
    super::assert_clear(&robot, &solution, &ball);
}

#[test]
fn what_cannot_be_is_said() {
    let robot = finger(9);
    let inside = among(
        Case::with_tensions(&[3.0]),
        vec![wall(0.3), sphere(Vec3::new(0.02, 0.0, 0.1), 0.015)],
    );
    let error = solve(&robot, &inside).unwrap_err();
    let SolveError::ObstacleInTheWay { obstacle, part, depth, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!((obstacle.as_str(), *part), ("ball", Part::Disk(5)));
    assert!((depth - 0.005).abs() < 1e-9, "{depth}");
    assert!(error.to_string().contains("`ball` overlaps disk 6 of the robot at rest by 5 mm"));

    // Between four walls that leave no room for the bend; between two it turns sideways.
    let quarters = [0.0, 0.5, 1.0, 1.5];
    let walls = quarters.map(|turns| moved(&wall(0.0105), &turned(turns * core::f64::consts::PI)));
    let case = among(Case::with_shortenings(&[Shortening::Length(0.03)]), walls.into());
    let options = Options {
        actuation: whipcord::Actuation::Shortening,
        accuracy: Accuracy::Steps(9),
        ..Options::default()
    };
    let model = Cosserat::new(&robot, &Loads::default(), &options).unwrap();
    let error = model.solve(&case, None, &mut Workspace::default()).unwrap_err();
    let SolveError::Obstructed { reached, touching, why } = &error else { panic!("{error}") };
    assert!(*reached < 0.5 && touching.iter().any(|name| name == "wall"), "{error}");
    assert!(!matches!(why, Obstruction::Leaps), "{error}");
}

/// Turned about z by this angle in rad.
fn turned(angle: f64) -> Pose {
    let rotation = UnitQuaternion::exp(Vec3::new(0.0, 0.0, angle));
    Pose { position: Vec3::ZERO, rotation }
}

#[test]
fn models_without_contact_refuse_obstacles() {
    let robot = finger(9);
    let case = among(Case::with_tensions(&[3.0]), vec![wall(0.05)]);
    for kind in ModelKind::ALL {
        let model = Model::new(kind, Default::default(), whipcord::Actuation::Natural);
        let refuses = matches!(kind, ModelKind::FourBar | ModelKind::ConstantCurvature);
        match (kind, model.solve(&robot, &case)) {
            (_, Ok(solution)) if !refuses => assert_eq!(solution.contacts.len(), 1, "{kind}"),
            (_, Err(error)) if !refuses => panic!("{kind}: {error}"),
            (_, Ok(_)) => panic!("{kind} ignores the wall"),
            (_, Err(SolveError::Unsupported { .. } | SolveError::Missing { .. })) => {}
            (_, Err(error)) => panic!("{kind}: {error}"),
        }
    }
}
