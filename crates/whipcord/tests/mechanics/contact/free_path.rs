//! Robots that keep clear of all obstacles, and robots whose way is barred although their answer would be clear.

use super::{LENGTH, among, finger, sphere, wall};
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::{
    Actuation, Case, Loads, Model, ModelKind, Obstacle, Pose, Robot, Shortening, Solution,
    SolveError, Stations, UnitQuaternion, Vec3,
};

fn solve(robot: &Robot, case: &Case, from: Option<&Solution>) -> Result<Solution, SolveError> {
    let options = Options { actuation: Actuation::Natural, ..Options::default() };
    Cosserat::new(robot, &case.loads, &options)?.solve(case, from, &mut Workspace::default())
}

/// Obstacles on all sides that no shape between rest and a bend towards +x comes near.
fn far() -> Vec<Obstacle> {
    vec![
        wall(0.2),
        sphere(Vec3::new(-0.06, 0.0, 0.12), 0.03),
        sphere(Vec3::new(0.03, 0.08, 0.1), 0.03),
        sphere(Vec3::new(0.06, -0.08, 0.02), 0.04),
    ]
}

fn cases() -> Vec<Case> {
    let tip = Loads { tip_force: Vec3::new(0.1, 0.05, 0.0), ..Loads::default() };
    vec![
        Case::with_tensions(&[0.5]),
        Case::with_tensions(&[3.0]),
        Case { loads: tip, ..Case::with_tensions(&[1.0]) },
        Case::with_shortenings(&[Shortening::Length(0.005)]),
    ]
}

/// The answer is that without obstacles, to the last bit.
#[test]
fn what_touches_nothing_has_the_answer_without_obstacles() {
    let robot = finger(9);
    for case in cases() {
        let free = solve(&robot, &case, None).unwrap();
        let found = solve(&robot, &among(case.clone(), far()), None).unwrap();
        assert_eq!(found, free);
        let near = Case {
            commands: case
                .commands
                .iter()
                .map(|command| whipcord::CableCommand {
                    tension: command.tension.map(|tension| 1.05 * tension),
                    ..*command
                })
                .collect(),
            ..case
        };
        let warm = solve(&robot, &near, Some(&free)).unwrap();
        assert_eq!(solve(&robot, &among(near, far()), Some(&free)).unwrap(), warm);
    }
}

/// Base and obstacles may be anywhere.
#[test]
fn a_moved_base_changes_nothing() {
    let robot = finger(9);
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.7),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, 1.1, -0.3)),
    };
    let case = Case::with_tensions(&[3.0]);
    let free = solve(&robot, &case, None).unwrap();
    let obstacles = far().iter().map(|obstacle| super::moved(obstacle, &base)).collect();
    let there = among(Case { base, ..case }, obstacles);
    let found = solve(&robot, &there, None).unwrap();
    for (a, b) in found.disks.poses.iter().zip(&free.disks.poses) {
        assert!((a.position - (base * *b).position).norm() < 1e-12);
    }
    assert!(found.contacts.is_empty());
}

/// The models with tensions.
const KINDS: [ModelKind; 4] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
];

fn by(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    Model::new(kind, Stations::Disks, Actuation::Tension)
        .prepare(robot, &case.loads)?
        .solve(case, None)
}

/// A ball on the way of the tip, which would be clear of it before and behind, stops the robot: the answer touches.
#[test]
fn an_obstacle_on_the_way_stops_the_robot() {
    KINDS.into_iter().for_each(assert_stopped);
}

fn assert_stopped(kind: ModelKind) {
    let robot = finger(9);
    let case = Case::with_tensions(&[4.0]);
    let free = by(kind, &robot, &case).unwrap();
    let half = by(kind, &robot, &Case::with_tensions(&[2.0])).unwrap();
    let (tip, middle) = (free.disks.tip().position, half.disks.tip().position);
    let ball = sphere(middle + Vec3::X * 0.012, 0.008);
    let clear = |solution: &Solution| {
        let centre = ball.pose.position;
        solution.disks.poses.iter().all(|pose| (pose.position - centre).norm() > 0.008 + 0.011)
    };
    assert!((tip - middle).norm() > 0.1 * LENGTH && clear(&free), "the scene tests nothing");
    let found = by(kind, &robot, &among(case, vec![ball])).unwrap();
    assert!(!found.contacts.is_empty(), "{kind}");
    assert!((found.disks.tip().position - tip).norm() > 0.05 * LENGTH, "{kind}");
}

/// What stands in the robot at rest is an error, though the answer would be clear of it.
#[test]
fn an_obstacle_in_the_robot_at_rest_is_an_error() {
    let robot = finger(9);
    let case = Case::with_tensions(&[4.0]);
    let case = among(case, vec![sphere(Vec3::Z * (0.9 * LENGTH), 0.01)]);
    for kind in KINDS {
        let found = by(kind, &robot, &case);
        assert!(matches!(found, Err(SolveError::ObstacleInTheWay { .. })), "{kind} {found:?}");
    }
}
