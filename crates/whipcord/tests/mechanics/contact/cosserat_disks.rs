//! The rod with cables from hole to hole among obstacles.

use super::{
    LENGTH, STIFFNESS, among, assert_clear, assert_forces_hold, finger, moved, sphere, wall,
};
use whipcord::{
    Actuation, Cable, Case, Model, ModelKind, Obstacle, Part, PointLoad, Pose, Robot, Routing,
    Shortening, Solution, SolveError, Stations, UnitQuaternion, Vec3,
};

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

fn solve_from(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    from: Option<&Solution>,
) -> Result<Solution, SolveError> {
    model(kind).prepare(robot, &case.loads)?.solve(case, from)
}

fn solve(robot: &Robot, case: &Case) -> Solution {
    solve_from(ModelKind::CosseratDisks, robot, case, None).unwrap()
}

fn ball() -> Obstacle {
    sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)
}

/// As [`super::cosserat::a_wall_holds_a_slender_rod_back_as_a_beam_says`]: the slope is so small that the straight cable is
/// where a continuous one would be.
#[test]
fn a_wall_holds_a_slender_rod_back_as_a_beam_says() {
    let robot = finger(9);
    for (tension, part) in [(0.05, 0.7), (0.02, 0.5)] {
        let free = tension * 0.008 * LENGTH * LENGTH / (2.0 * STIFFNESS);
        let held = part * free;
        let case = among(Case::with_tensions(&[tension]), vec![wall(held + 0.01)]);
        let solution = solve(&robot, &case);
        let [touch] = solution.contacts[..] else { panic!("{:?}", solution.contacts) };
        assert_eq!((touch.part, touch.obstacle), (Part::Disk(9), 0));
        let force = 3.0 * STIFFNESS / LENGTH.powi(3) * (free - held);
        let found = touch.force.unwrap();
        assert!((found / force - 1.0).abs() < 0.02, "{found} N, {force} N");
    }
}

/// What pushes the robot is in equilibrium with its base, and the rod under these forces as point loads
/// has the shape that was found. Nothing overlaps.
#[test]
fn contacts_hold_the_shape_and_do_not_overlap() {
    let robot = finger(9);
    for (tension, obstacle, friction) in [
        (3.0, wall(0.05), 0.0),
        (3.0, sphere(Vec3::new(0.05, 0.0, 0.12), 0.03), 0.0),
        (3.0, ball(), 0.0),
        (5.0, ball(), 0.0),
        (3.0, wall(0.05), 0.3),
        (3.0, ball(), 0.8),
    ] {
        let obstacle = Obstacle { friction, ..obstacle };
        let case = among(Case::with_tensions(&[tension]), vec![obstacle.clone()]);
        let solution = solve(&robot, &case);
        assert!(!solution.contacts.is_empty());
        for touch in &solution.contacts {
            let (force, drag) = (touch.force.unwrap(), touch.friction.unwrap().norm());
            assert!(drag <= (1.0 + 1e-6) * friction * force, "{touch:?}");
        }
        assert_forces_hold(ModelKind::CosseratDisks, &robot, &case, &solution);
        assert_clear(&robot, &solution, &obstacle);
    }
}

/// Several cables, loads between disks, a load that turns with the robot, and a cable at its length.
#[test]
fn cables_at_their_lengths_and_loads_between_disks_hold_the_shape() {
    let cables = [0.0, 120.0, 240.0].map(|degrees: f64| {
        let routing =
            Routing::Helix { start_angle: degrees.to_radians(), turns: 0.2, radius: 0.008 };
        Cable::new(format!("{degrees}"), routing)
    });
    let bare = finger(9);
    let robot = Robot::new(bare.backbone().clone(), bare.disks().clone(), cables.into()).unwrap();
    for (follower, by_length) in [(false, false), (true, false), (false, true)] {
        let mut case = Case::with_tensions(&[3.0, 0.5, 0.8]);
        let push = Vec3::new(0.02, 0.01, -0.01);
        case.loads.points.push(PointLoad {
            at: 0.095,
            force: push,
            follower,
            ..PointLoad::default()
        });
        if by_length {
            let free = solve(&robot, &case);
            for (command, cable) in case.commands.iter_mut().zip(&free.cables).take(2) {
                let shortening = Shortening::Length(cable.initial_length - cable.length);
                (command.tension, command.shortening) = (None, Some(shortening));
            }
        }
        let obstacle = sphere(Vec3::new(0.045, -0.01, 0.12), 0.02);
        let case = among(case, vec![obstacle.clone()]);
        let solution = solve(&robot, &case);
        assert!(!solution.contacts.is_empty(), "{follower} {by_length}");
        assert_clear(&robot, &solution, &obstacle);
        // The rod under the forces found.
        let (pushes, _) = super::pushes_of(&solution);
        let mut alone = Case { obstacles: vec![], ..case.clone() };
        alone.loads.points.extend(pushes.points);
        let again = solve_from(ModelKind::CosseratDisks, &robot, &alone, Some(&solution)).unwrap();
        let apart = again.disks.distances(&solution.disks).fold(0.0, f64::max);
        assert!(apart < 1e-6 * LENGTH, "{follower} {by_length}: {apart}");
        for (a, b) in again.cables.iter().zip(&solution.cables) {
            assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-4, "{a:?} {b:?}");
        }
    }
}

/// With ever more disks it is the rod with a continuous cable, in contact too: the difference falls with the square of the
/// distance between disks.
#[test]
fn tends_to_the_rod_with_a_continuous_cable() {
    let case = among(Case::with_tensions(&[3.0]), vec![wall(0.05)]);
    let errors = [9, 18].map(|sections| {
        let robot = finger(sections);
        let ours = solve(&robot, &case);
        let rod = solve_from(ModelKind::Cosserat, &robot, &case, None).unwrap();
        assert_eq!(ours.contacts.len(), rod.contacts.len());
        let [a, b] = [&ours, &rod].map(|solution| solution.contacts[0].force.unwrap());
        (a / b - 1.0).abs()
    });
    assert!(errors[0] < 0.1 && (3.0..5.0).contains(&(errors[0] / errors[1])), "{errors:?}");
}

#[test]
fn moving_base_and_obstacles_moves_the_answer() {
    let robot = finger(9);
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    let here = solve(&robot, &among(Case::with_tensions(&[3.0]), vec![ball()]));
    let case = Case { base, ..among(Case::with_tensions(&[3.0]), vec![moved(&ball(), &base)]) };
    let there = solve(&robot, &case);
    for (a, b) in here.disks.poses.iter().zip(&there.disks.poses) {
        assert!((base.transform(a.position) - b.position).norm() < 1e-7 * LENGTH);
    }
}

/// A step from a known answer keeps its contacts and gives what a solve from rest does.
#[test]
fn a_warm_start_keeps_the_contacts() {
    let robot = finger(9);
    let case = |tension: f64| among(Case::with_tensions(&[tension]), vec![ball()]);
    let before = solve(&robot, &case(2.8));
    let from = Some(&before);
    let warm = solve_from(ModelKind::CosseratDisks, &robot, &case(3.0), from).unwrap();
    let cold = solve(&robot, &case(3.0));
    assert!(warm.diagnostics.iterations < cold.diagnostics.iterations);
    assert_eq!(warm.contacts.len(), cold.contacts.len());
    let apart = warm.disks.distances(&cold.disks).fold(0.0, f64::max);
    assert!(apart < 1e-6 * LENGTH, "{apart}");
}

/// Pressed against the middle of a ball the finger slips off sideways.
#[test]
fn a_finger_slips_off_the_middle_of_a_ball() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    let case = among(Case::with_tensions(&[3.3]), vec![ball.clone()]);
    let solution = solve(&robot, &case);
    assert!(solution.diagnostics.stability_lost_at.is_some_and(|at| at > 0.5 && at < 1.0));
    let aside = solution.disks.tip().position.y;
    assert!(aside.abs() > 0.05 * LENGTH, "{aside}");
    assert_clear(&robot, &solution, &ball);
}

/// A robot that keeps clear is solved without obstacles, to the last bit.
#[test]
fn what_touches_nothing_is_solved_alone() {
    let robot = finger(9);
    let free = Case::with_tensions(&[2.0]);
    let far = sphere(Vec3::new(-0.1, 0.0, 0.1), 0.03);
    let [alone, among_far] =
        [free.clone(), among(free, vec![far])].map(|case| solve(&robot, &case));
    assert_eq!(alone.disks, among_far.disks);
    assert_eq!(alone.diagnostics.iterations, among_far.diagnostics.iterations);
}
