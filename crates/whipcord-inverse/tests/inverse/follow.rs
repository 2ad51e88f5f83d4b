//! Paths: every point is reached, jumps are reported, rates are kept.

use std::f64::consts::TAU;

use whipcord::{Actuation, Cable, Case, Loads, Model, ModelKind, Robot, Statics, Vec3};
use whipcord_inverse::{
    CableLimits, CommandedBy, InverseError, InverseSolver, JumpKind, Limits, PathPoint, Preference,
    ReachOptions, ReachStatus, Target, TargetProblem,
};

use crate::clock::Clock;
use crate::robots;

/// A circle about the axis at a height below the straight tip.
fn circle(radius: f64, height: f64, points: usize) -> Vec<PathPoint> {
    (0..points)
        .map(|k| {
            let part = k as f64 / (points - 1) as f64;
            let (sin, cos) = (TAU * part).sin_cos();
            let target = Target::Tip(Vec3::new(radius * cos, radius * sin, height));
            PathPoint { time: 0.01 * k as f64, target }
        })
        .collect()
}

fn solver(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    limits: CableLimits,
    by: CommandedBy,
) -> InverseSolver {
    let model = Model::new(kind, Default::default(), Actuation::Natural);
    let limits = Limits::uniform(robot.cables().len(), limits);
    InverseSolver::new(&model, robot, case, &limits, by).unwrap()
}

fn pulled_to(greatest: f64) -> CableLimits {
    CableLimits { tension: [0.0, greatest], ..CableLimits::default() }
}

const CLOSE: ReachOptions = ReachOptions {
    tolerance: None,
    prefer: Preference::LeastChange,
    starts: 32,
    solves: 4000,
    clearance: None,
    proof: None,
    allows_unstable: false,
    null_space: true,
};

#[test]
fn a_circle_is_followed_without_jumps() {
    let loaded = Case {
        loads: Loads { tip_force: Vec3::new(0.05, 0.0, -0.05), ..Loads::default() },
        ..Case::default()
    };
    for (robot, by) in [
        (robots::two_segments(), CommandedBy::Case),
        (robots::two_segments(), CommandedBy::Shortenings),
        (robots::with_motors(), CommandedBy::Motors),
    ] {
        // Two motors lead the tip on a surface: a circle about the axis of a symmetric robot lies in it only without load.
        let case = if by == CommandedBy::Motors { Case::default() } else { loaded.clone() };
        let mut solver = solver(ModelKind::Cosserat, &robot, &case, pulled_to(8.0), by);
        let height = if by == CommandedBy::Motors {
            let commands = [4.0, 0.0];
            let case = Case::with_motors(&robot, &commands).unwrap();
            let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
            let tip = model.solve(&robot, &case).unwrap().disks.poses[9].position;
            (tip.x.hypot(tip.y), tip.z)
        } else {
            (0.05, 0.171)
        };
        let path = circle(height.0, height.1, 121);
        // The surface of two motors is one of revolution only nearly.
        let options = match by {
            CommandedBy::Motors => ReachOptions {
                tolerance: Some(whipcord_inverse::Tolerance { position: 2e-3, angle: 0.1 }),
                ..CLOSE
            },
            _ => ReachOptions { prefer: Preference::LeastTension, ..CLOSE },
        };
        let followed = solver.follow(&path, &options).unwrap();
        assert_eq!(followed.reached(), path.len(), "{by:?}");
        assert_eq!(followed.jumps, [], "{by:?}");
        let solves: usize = followed.answers[1..].iter().map(|answer| answer.solves).sum();
        assert!(solves < 12 * path.len(), "{solves}");
    }
}

/// Also where the points of a path are far apart each has the least tensions, as if it was asked for by itself.
#[test]
fn coarse_points_of_a_path_have_the_least_tensions() {
    let loaded = Case {
        loads: Loads { tip_force: Vec3::new(0.05, 0.0, -0.05), ..Loads::default() },
        ..Case::default()
    };
    let options = ReachOptions { prefer: Preference::LeastTension, ..CLOSE };
    let squares = |commands: &[f64]| commands.iter().map(|tension| tension * tension).sum::<f64>();
    for case in [Case::default(), loaded] {
        let robot = robots::two_segments();
        let solver =
            || solver(ModelKind::Cosserat, &robot, &case, pulled_to(8.0), CommandedBy::Case);
        for points in [9, 25] {
            let path = circle(0.05, 0.171, points);
            let followed = solver().follow(&path, &options).unwrap();
            assert_eq!(followed.reached(), points);
            let mut alone = solver();
            for (point, answer) in path.iter().zip(&followed.answers) {
                let least = squares(&alone.reach(&point.target, &options).unwrap().commands);
                let found = squares(&answer.commands);
                assert!(found <= 1.002 * least, "{points} points: {found} {least}");
            }
        }
    }
}

#[test]
fn rates_are_kept_and_what_they_prevent_is_not_reached() {
    let robot = robots::two_segments();
    let rate = 5.0;
    let limits = CableLimits { rate: Some(rate), ..pulled_to(8.0) };
    let mut solver =
        solver(ModelKind::Cosserat, &robot, &Case::default(), limits, CommandedBy::Case);
    // The tip goes to the other side within 10 ms.
    let mut path = circle(0.05, 0.166, 3);
    path[1].target = Target::Tip(Vec3::new(-0.05, 0.0, 0.166));
    let followed = solver.follow(&path, &CLOSE).unwrap();
    assert_eq!(followed.answers[0].status, ReachStatus::Reached);
    assert_ne!(followed.answers[1].status, ReachStatus::Reached);
    for pair in followed.answers.windows(2) {
        for (a, b) in pair[0].commands.iter().zip(&pair[1].commands) {
            assert!((a - b).abs() <= rate * 0.01 + 1e-12);
        }
    }
}

#[test]
fn a_target_on_the_other_side_is_reported_as_a_jump() {
    let robot = robots::two_segments();
    let mut solver =
        solver(ModelKind::Cosserat, &robot, &Case::default(), pulled_to(8.0), CommandedBy::Case);
    let mut path = circle(0.05, 0.166, 3);
    path[1].target = Target::Tip(Vec3::new(-0.05, 0.0, 0.166));
    let followed = solver.follow(&path, &CLOSE).unwrap();
    assert_eq!(followed.reached(), 3);
    assert!(!followed.jumps.is_empty());
    assert!(
        followed.jumps.iter().all(|jump| matches!(jump.kind, JumpKind::Shape | JumpKind::Commands))
    );
}

/// With friction each answer depends on the points before: the commands of the path, solved in order by the model itself, give the same tips.
#[test]
fn a_path_with_friction_is_that_of_its_steps() {
    let cables: Vec<Cable> = (0..3)
        .map(|k| Cable {
            friction: Some(0.1),
            ..robots::straight(&format!("s{k}"), 120.0 * f64::from(k), None)
        })
        .collect();
    let robot = robots::robot(cables);
    for kind in [ModelKind::CosseratDisks, ModelKind::PiecewiseConstantCurvature] {
        let mut solver = solver(kind, &robot, &Case::default(), pulled_to(6.0), CommandedBy::Case);
        let model = Model::new(kind, Default::default(), Actuation::Natural);
        // Of the robot's own shapes, because three cables lead the tip on a surface.
        let tensions = [[1.0, 0.2, 0.1], [1.5, 0.4, 0.1], [1.2, 0.8, 0.1], [0.6, 1.0, 0.2]];
        let commands = |t: &[f64; 3]| Case::with_tensions(t).commands;
        let planted = Case {
            before: tensions[..3].iter().map(commands).collect(),
            ..Case::with_tensions(&tensions[3])
        };
        let mut prepared = model.prepare(&robot, &planted.loads).unwrap();
        let shapes = prepared.solve_all(&planted).unwrap();
        let path: Vec<PathPoint> = shapes
            .iter()
            .enumerate()
            .map(|(k, shape)| PathPoint {
                time: k as f64,
                target: Target::Tip(shape.disks.poses[9].position),
            })
            .collect();
        let followed = solver.follow(&path, &CLOSE).unwrap();
        assert_eq!(followed.reached(), 4, "{kind}");
        let steps: Vec<_> =
            followed.answers.iter().map(|answer| answer.case.commands.clone()).collect();
        let found =
            Case { before: steps[..3].to_vec(), commands: steps[3].clone(), ..Case::default() };
        let again = prepared.solve_all(&found).unwrap();
        for (again, shape) in again.iter().zip(&shapes) {
            let off = again.disks.poses[9].position - shape.disks.poses[9].position;
            assert!(off.norm() < 1e-4 * robots::LENGTH, "{kind}: {}", off.norm());
        }
    }
}

#[test]
fn times_must_ascend() {
    let robot = robots::three_straight();
    let mut solver =
        solver(ModelKind::Cosserat, &robot, &Case::default(), pulled_to(4.0), CommandedBy::Case);
    let mut path = circle(0.02, 0.17, 4);
    path[2].time = 0.0;
    let refused = solver.follow(&path, &CLOSE).unwrap_err();
    assert_eq!(refused, InverseError::Target(TargetProblem::Times { point: 3 }));
    assert_eq!(
        solver.follow(&[], &CLOSE).unwrap_err(),
        InverseError::Target(TargetProblem::NoPoints)
    );
}

/// Tips under tensions, or positions of motors, that go round smoothly.
fn smooth_path(robot: &Robot, greatest: f64, loads: &Loads, points: i32) -> Vec<PathPoint> {
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let mut prepared = model.prepare(robot, loads).unwrap();
    let motors = robot.motors().len();
    (0..points)
        .map(|k| {
            let turn = TAU * f64::from(k) / f64::from(points);
            let wave = |i: usize| 0.5 + 0.3 * (turn * (1 + i % 2) as f64 + 1.7 * i as f64).sin();
            let case = if motors > 0 {
                let angles: Vec<f64> = (0..motors).map(|i| 4.0 * (wave(i) - 0.5)).collect();
                Case::with_motors(robot, &angles).unwrap()
            } else {
                let pulls = (0..robot.cables().len()).map(|i| 0.6 * greatest * wave(i));
                Case::with_tensions(&pulls.collect::<Vec<_>>())
            };
            let case = Case { loads: loads.clone(), ..case };
            let tip = prepared.solve(&case, None).unwrap().disks.tip().position;
            PathPoint { time: 0.01 * f64::from(k), target: Target::Tip(tip) }
        })
        .collect()
}

/// How a robot follows such a path: points that are reached, jumps, and seconds of the processor and solves for each point.
pub fn walk(
    (robot, greatest): (&Robot, f64),
    loads: &Loads,
    points: i32,
    (prefer, null_space): (Preference, bool),
) -> (usize, usize, f64, f64) {
    let path = smooth_path(robot, greatest, loads, points);
    let by = if robot.motors().is_empty() { CommandedBy::Case } else { CommandedBy::Motors };
    let case = Case { loads: loads.clone(), ..Case::default() };
    let mut solver = solver(ModelKind::Cosserat, robot, &case, pulled_to(greatest), by);
    let options = ReachOptions { prefer, null_space, ..CLOSE };
    let clock = Clock::of_thread();
    let followed = solver.follow(&path, &options).unwrap();
    let taken = clock.seconds();
    let solves: usize = followed.answers.iter().map(|answer| answer.solves).sum();
    let each = |of: f64| of / f64::from(points);
    (followed.reached(), followed.jumps.len(), each(taken), each(solves as f64))
}

/// Tips under tensions that go round smoothly, a thousand points: what a point takes, and how many are reached without jumps.
#[test]
#[ignore = "a minute"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_paths() {
    let points = 1000;
    let only = std::env::var("ROBOT").ok();
    for (name, robot, greatest) in robots::all() {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        for (loaded, loads) in [("", Loads::default()), (", loaded", robots::load())] {
            for (prefer, null_space) in [
                (Preference::First, false),
                (Preference::First, true),
                (Preference::LeastTension, true),
            ] {
                let of = (prefer, null_space);
                let (reached, jumps, seconds, solves) =
                    walk((&robot, greatest), &loads, points, of);
                println!(
                    "{name}{loaded}, {prefer:?}, null space {null_space}: {reached} of {points}, {jumps} jumps, {:.3} ms a point, {solves:.2} solves",
                    1e3 * seconds,
                );
            }
        }
    }
}
