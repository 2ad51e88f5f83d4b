//! What answers say of themselves: limits, preferences, obstacles, closed forms, and what cannot be asked.

use whipcord::{
    Actuation, Backbone, Cable, Case, Form, Loads, Model, ModelKind, Obstacle, Pose, Robot,
    Routing, Statics, UnitQuaternion, Vec3,
};
use whipcord_inverse::{
    CableLimits, CommandedBy, InverseError, InverseSolver, Limit, Limits, Preference, ReachOptions,
    ReachStatus, Target, TargetProblem, Tolerance,
};

use crate::planted::Random;
use crate::robots;

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Default::default(), Actuation::Natural)
}

fn solver_of(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    limits: CableLimits,
    by: CommandedBy,
) -> InverseSolver {
    let limits = Limits::uniform(robot.cables().len(), limits);
    InverseSolver::new(&model(kind), robot, case, &limits, by).unwrap()
}

fn pulled(least: f64, greatest: f64) -> CableLimits {
    CableLimits { tension: [least, greatest], ..CableLimits::default() }
}

/// One straight cable of an inextensible rod makes an arc of the curvature κ = τ r/EI.
#[test]
fn one_cable_has_the_tension_of_the_closed_form() {
    let backbone = Backbone { extensible: false, shearable: false, ..robots::backbone(0.003) };
    let cable = Cable::new("a", Routing::Straight { angle: 0.0, radius: 0.008 });
    let robot = Robot::new(backbone, robots::disks(), vec![cable]).unwrap();
    let bending = 1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
    let mut solver = solver_of(
        ModelKind::Cosserat,
        &robot,
        &Case::default(),
        pulled(0.0, 10.0),
        CommandedBy::Case,
    );
    for curvature in [1.0, 5.0, 15.0] {
        let angle = curvature * robots::LENGTH;
        let tip = Vec3::new((1.0 - angle.cos()) / curvature, 0.0, angle.sin() / curvature);
        let answer = solver.reach(&Target::Tip(tip), &ReachOptions::default()).unwrap();
        assert_eq!(answer.status, ReachStatus::Reached);
        let expected = bending * curvature / 0.008;
        // The tip moves by a centimetre for each 5 % of the tension.
        assert!((answer.commands[0] / expected - 1.0).abs() < 1e-3, "{:?}", answer.commands);
        assert!(answer.null_space.is_empty());
    }
}

/// The mirror image of a target has the mirror image of its tensions.
#[test]
fn mirrored_targets_have_mirrored_tensions() {
    let robot = robots::robot(
        (0..4).map(|k| robots::straight(&format!("s{k}"), 90.0 * f64::from(k), None)).collect(),
    );
    let mut solver = solver_of(
        ModelKind::Cosserat,
        &robot,
        &Case::default(),
        pulled(0.2, 6.0),
        CommandedBy::Case,
    );
    let planted = model(ModelKind::Cosserat)
        .solve(&robot, &Case::with_tensions(&[2.0, 1.0, 0.3, 0.3]))
        .unwrap();
    let tip = planted.disks.poses[9].position;
    let options = ReachOptions {
        tolerance: Some(Tolerance { position: 1e-8, angle: 1e-6 }),
        ..ReachOptions::default()
    };
    let mut commands = |tip: Vec3| {
        let answer = solver.reach(&Target::Tip(tip), &options).unwrap();
        assert_eq!(answer.status, ReachStatus::Reached);
        answer.commands
    };
    let right = commands(tip);
    let left = commands(Vec3::new(-tip.x, tip.y, tip.z));
    for (a, b) in [(0, 2), (1, 1), (2, 0), (3, 3)] {
        assert!((right[a] - left[b]).abs() < 1e-3, "{right:?} {left:?}");
    }
}

/// Of all tensions that lead to a target the answer has the least squares: no step along its null space within the limits lowers
/// them.
#[test]
fn the_least_tensions_meet_their_optimality_conditions() {
    let robot = robots::two_segments();
    let loads = Loads { tip_force: Vec3::new(0.05, 0.02, -0.05), ..Loads::default() };
    let case = Case { loads, ..Case::default() };
    for by in [CommandedBy::Tensions, CommandedBy::Shortenings] {
        let mut solver = solver_of(ModelKind::Cosserat, &robot, &case, pulled(0.1, 8.0), by);
        let mut random = Random(3);
        for _ in 0..5 {
            let tensions: Vec<f64> =
                random.tensions(6, 6.0).iter().map(|tension| tension.max(0.1)).collect();
            let planted = Case { loads: case.loads.clone(), ..Case::with_tensions(&tensions) };
            let tip = model(ModelKind::Cosserat).solve(&robot, &planted).unwrap().disks.poses[9];
            let target = Target::Tip(tip.position);
            let answer = solver.reach(&target, &ReachOptions::default()).unwrap();
            assert_eq!(answer.status, ReachStatus::Reached);
            assert_eq!(answer.null_space.len(), 3);
            let squares = |commands: &[f64]| -> f64 { commands.iter().map(|t| t * t).sum() };
            let held: Vec<f64> =
                answer.solution.cables.iter().map(|cable| cable.tension.unwrap()).collect();
            assert!(held.iter().all(|tension| (0.1 - 1e-9..=8.0).contains(tension)), "{held:?}");
            // From each of the atlas's answers to the same target, the squares are no less nearby: random directions of the null
            // space that keep the limits lead uphill.
            if by == CommandedBy::Tensions {
                for _ in 0..50 {
                    let mut moved = held.clone();
                    for direction in &answer.null_space {
                        let size = 0.02 * (2.0 * random.next() - 1.0);
                        moved.iter_mut().zip(direction).for_each(|(t, z)| *t += size * z);
                    }
                    if moved.iter().all(|tension| (0.1..=8.0).contains(tension)) {
                        assert!(squares(&moved) > squares(&held) - 1e-4 * squares(&held));
                    }
                }
            }
            let first = ReachOptions { prefer: Preference::First, ..ReachOptions::default() };
            let other = solver.reach(&target, &first).unwrap();
            let others: Vec<f64> =
                other.solution.cables.iter().map(|cable| cable.tension.unwrap()).collect();
            assert!(squares(&held) <= squares(&others) * (1.0 + 1e-9));
        }
    }
}

fn balls(random: &mut Random, count: usize) -> Vec<Obstacle> {
    (0..count)
        .map(|number| {
            let mut part = || 2.0 * random.next() - 1.0;
            let position = Vec3::new(0.12 * part(), 0.12 * part(), 0.1 + 0.08 * part());
            Obstacle {
                name: format!("ball {number}"),
                form: Form::Sphere { radius: 0.012 },
                pose: Pose { position, rotation: UnitQuaternion::IDENTITY },
                friction: 0.0,
                movable: None,
            }
        })
        .filter(|ball| ball.pose.position.x.hypot(ball.pose.position.y) > 0.035)
        .collect()
}

#[test]
fn answers_keep_clear_of_obstacles() {
    let robot = robots::two_segments();
    let mut random = Random(8);
    let (mut asked, mut reached) = (0, 0);
    for _ in 0..6 {
        let case = Case { obstacles: balls(&mut random, 12), ..Case::default() };
        let mut solver =
            solver_of(ModelKind::Cosserat, &robot, &case, pulled(0.0, 5.0), CommandedBy::Case);
        for _ in 0..5 {
            let tensions = random.tensions(6, 4.0);
            let planted =
                Case { obstacles: case.obstacles.clone(), ..Case::with_tensions(&tensions) };
            let Ok(shape) = model(ModelKind::Cosserat).solve(&robot, &planted) else { continue };
            if !shape.contacts.is_empty() {
                continue;
            }
            asked += 1;
            let target = Target::Tip(shape.disks.poses[9].position);
            let options = ReachOptions { prefer: Preference::First, ..ReachOptions::default() };
            let answer = solver.reach(&target, &options).unwrap();
            if answer.status == ReachStatus::Reached {
                reached += 1;
                assert!(answer.solution.contacts.is_empty());
            }
        }
    }
    assert!(asked >= 15, "{asked}");
    assert!(reached + 1 >= asked, "{reached} of {asked}");
}

#[test]
fn geometric_models_reach_by_shortening() {
    let robot = robots::three_straight();
    for kind in [ModelKind::FourBar, ModelKind::ConstantCurvature] {
        let shortenings = [0.004, -0.001, -0.003];
        let commands: Vec<_> =
            shortenings.iter().map(|s| whipcord::Shortening::Length(*s)).collect();
        let planted = model(kind).solve(&robot, &Case::with_shortenings(&commands)).unwrap();
        let target = Target::Tip(planted.disks.poses[9].position);
        let limits = CableLimits { shortening: [-0.02, 0.02], ..CableLimits::default() };
        let mut solver = solver_of(kind, &robot, &Case::default(), limits, CommandedBy::Case);
        let answer = solver.reach(&target, &ReachOptions::default()).unwrap();
        assert_eq!(answer.status, ReachStatus::Reached, "{kind}");
        assert!(answer.commands.iter().all(|s| s.abs() <= 0.02));
    }
}

#[test]
fn a_target_out_of_reach_has_the_nearest_answer_and_its_limits() {
    let robot = robots::three_straight();
    let mut solver = solver_of(
        ModelKind::Cosserat,
        &robot,
        &Case::default(),
        pulled(0.0, 2.0),
        CommandedBy::Case,
    );
    let answer =
        solver.reach(&Target::Tip(Vec3::new(0.2, 0.0, 0.05)), &ReachOptions::default()).unwrap();
    assert_eq!(answer.status, ReachStatus::Nearest);
    assert!(
        answer.active_limits.contains(&Limit::GreatestCommand(0)),
        "{:?}",
        answer.active_limits
    );
    assert!((answer.commands[0] - 2.0).abs() < 1e-9 && answer.commands[0] <= 2.0);
    // No sampled tensions lead nearer.
    let mut random = Random(11);
    let goal = Vec3::new(0.2, 0.0, 0.05);
    for _ in 0..300 {
        let shape = model(ModelKind::Cosserat)
            .solve(&robot, &Case::with_tensions(&random.tensions(3, 2.0)))
            .unwrap();
        let distance = (shape.disks.poses[9].position - goal).norm();
        assert!(distance >= answer.miss.position - 1e-7);
    }
}

#[test]
fn limits_of_shortenings_and_motors_are_kept() {
    let robot = robots::with_motors();
    let mut limited = robot.motors().to_vec();
    for motor in &mut limited {
        motor.limits.range = Some([-0.5, 0.5]);
        motor.limits.effort = Some(0.01);
    }
    let robot = robot.with_motors(limited).unwrap();
    let mut solver = solver_of(
        ModelKind::Cosserat,
        &robot,
        &Case::default(),
        CableLimits::default(),
        CommandedBy::Motors,
    );
    let mut random = Random(23);
    let mut held_back = 0;
    for _ in 0..20 {
        let mut part = || 2.0 * random.next() - 1.0;
        let target = Target::Tip(Vec3::new(0.12 * part(), 0.12 * part(), 0.14));
        let answer = solver.reach(&target, &ReachOptions::default()).unwrap();
        assert!(answer.commands.iter().all(|angle| angle.abs() <= 0.5), "{:?}", answer.commands);
        let states = whipcord::MotorState::all(
            &robot,
            &answer.commands.iter().copied().map(Some).collect::<Vec<_>>(),
            &answer.solution,
        );
        assert!(states.iter().all(|state| !state.is_overloaded()), "{states:?}");
        held_back += usize::from(!answer.active_limits.is_empty());
    }
    assert!(held_back >= 10, "{held_back}");
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let robot = robots::three_straight();
    let mut solver = solver_of(
        ModelKind::Cosserat,
        &robot,
        &Case::default(),
        pulled(0.0, 4.0),
        CommandedBy::Case,
    );
    let mut refusal = |target: &Target, options: &ReachOptions| {
        solver.reach(target, options).map(|answer| answer.status).unwrap_err()
    };
    let options = ReachOptions::default();
    let target = |problem| InverseError::Target(problem);
    let nan = Target::Tip(Vec3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(refusal(&nan, &options), target(TargetProblem::NotFinite));
    let none = Target::Axis { point: None, direction: Vec3::new(0.0, 0.0, 0.0) };
    assert_eq!(refusal(&none, &options), target(TargetProblem::NoDirection));
    assert_eq!(refusal(&Target::Shape(vec![]), &options), target(TargetProblem::NoPoints));
    let beyond = Target::Shape(vec![(10, Vec3::default())]);
    let problem = TargetProblem::NoSuchDisk { disk: 10, last: 9 };
    assert_eq!(refusal(&beyond, &options), target(problem));
    let strict = ReachOptions {
        tolerance: Some(Tolerance { position: 0.0, angle: 1.0 }),
        ..ReachOptions::default()
    };
    assert_eq!(refusal(&Target::Tip(Vec3::default()), &strict), target(TargetProblem::Tolerance));
    let no_solves = ReachOptions { solves: 0, ..ReachOptions::default() };
    assert_eq!(refusal(&Target::Tip(Vec3::default()), &no_solves), InverseError::NoSolves);
    // A target that is huge is far, no error.
    let huge = Target::Tip(Vec3::new(1e12, 0.0, 0.0));
    assert_ne!(solver.reach(&huge, &options).unwrap().status, ReachStatus::Reached);

    let limits = Limits::uniform(3, pulled(3.0, 1.0));
    let kind = model(ModelKind::Cosserat);
    let case = Case::default();
    let refused = InverseSolver::new(&kind, &robot, &case, &limits, CommandedBy::Case);
    assert!(matches!(refused.err(), Some(InverseError::EmptyLimits { cable: 0, .. })));
    let motors = InverseSolver::new(
        &kind,
        &robot,
        &case,
        &Limits::uniform(3, CableLimits::default()),
        CommandedBy::Motors,
    );
    assert_eq!(motors.err(), Some(InverseError::NoMotors));
}
