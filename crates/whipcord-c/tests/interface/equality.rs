//! The interface gives what the Rust interface gives, to the last bit.

use std::ffi::CStr;

use whipcord::{
    Actuation, CableCommand, Case, Differentiable as _, Model, ModelKind, Pose, Shortening,
    Solution, Stations, Vec3,
};
use whipcord_c::*;
use whipcord_inverse::{CommandedBy, InverseSolver, ReachOptions, ReachStatus, Target};
use whipcord_motion::Simulation;

use super::common::{MOTORS, example, load, parse, reach, simulation, solver};

fn numbers(pose: Pose) -> [f64; 7] {
    let [x, y, z] = pose.position.to_array();
    let [w, a, b, c] = pose.rotation.wxyz();
    [x, y, z, w, a, b, c]
}

/// All that is read of a solver is that of this solution.
fn check(solver: &Solver, expected: &Solution) {
    let cables = expected.cables.len();
    let mut pose = [0.0; 7];
    let mut poses = vec![0.0; 7 * expected.disks.poses.len()];
    let (mut lengths, mut slack) = (vec![0.0; cables], vec![9; cables]);
    unsafe {
        assert_eq!(whipcord_solver_tip_pose(Some(solver), pose.as_mut_ptr()), Status::Ok);
        let status = whipcord_solver_disk_poses(Some(solver), poses.as_mut_ptr(), poses.len());
        assert_eq!(status, Status::Ok);
        let status = whipcord_solver_lengths(Some(solver), lengths.as_mut_ptr(), cables);
        assert_eq!(status, Status::Ok);
        let status = whipcord_solver_slack(Some(solver), slack.as_mut_ptr(), cables);
        assert_eq!(status, Status::Ok);
    }
    assert_eq!(pose, numbers(expected.disks.tip()));
    let all: Vec<f64> = expected.disks.poses.iter().flat_map(|pose| numbers(*pose)).collect();
    assert_eq!(poses, all);
    assert_eq!(lengths, expected.cables.iter().map(|cable| cable.length).collect::<Vec<_>>());
    let loose: Vec<u8> = expected.cables.iter().map(|cable| u8::from(cable.slack)).collect();
    assert_eq!(slack, loose);
    let known: Option<Vec<f64>> = expected.cables.iter().map(|cable| cable.tension).collect();
    let mut tensions = vec![0.0; cables];
    let status = unsafe { whipcord_solver_tensions(Some(solver), tensions.as_mut_ptr(), cables) };
    match known {
        Some(known) => assert_eq!((status, tensions), (Status::Ok, known)),
        None => assert_eq!(status, Status::Unavailable),
    }
    let mut of =
        Diagnostics { iterations: 0, steps: 0, residual: 0.0, stability: Stability::Unknown };
    let status = unsafe { whipcord_solver_diagnostics(Some(solver), &raw mut of) };
    assert_eq!(status, Status::Ok);
    let Diagnostics { iterations, steps, residual, stability } = of;
    let diagnostics = &expected.diagnostics;
    assert_eq!(
        (iterations, steps, residual),
        (diagnostics.iterations, diagnostics.steps, diagnostics.residual)
    );
    let stable = match stability {
        Stability::Unknown => None,
        Stability::Stable => Some(true),
        Stability::Unstable => Some(false),
    };
    assert_eq!(stable, diagnostics.stable);
}

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

#[test]
fn warm_solves_of_every_model_are_those_of_rust() {
    for kind in ModelKind::ALL {
        let file = whipcord_io::load(example("table1/case-1.toml")).unwrap();
        let robot = load("table1/case-1.toml");
        let mut solver = solver(&robot, kind.name());
        let mut prepared = model(kind).prepare(&file.robot, &file.case.loads).unwrap();
        let mut last: Option<Solution> = None;
        let mut case = file.case.clone();
        let by_length = kind.natural_actuation() == Actuation::Shortening;
        for cycle in 0..20 {
            if cycle > 0 {
                let command = match by_length {
                    true => 1e-3 + 1e-4 * f64::from(cycle),
                    false => 1.0 + 0.1 * f64::from(cycle),
                };
                let commands = vec![command; file.robot.cables().len()];
                let set = |solver: &mut Solver| unsafe {
                    match by_length {
                        true => whipcord_solver_set_shortenings(
                            Some(solver),
                            commands.as_ptr(),
                            commands.len(),
                        ),
                        false => whipcord_solver_set_tensions(
                            Some(solver),
                            commands.as_ptr(),
                            commands.len(),
                        ),
                    }
                };
                assert_eq!(set(&mut solver), Status::Ok);
                case.commands.fill(match by_length {
                    true => CableCommand {
                        tension: None,
                        shortening: Some(Shortening::Length(command)),
                    },
                    false => CableCommand { tension: Some(command), shortening: None },
                });
            }
            let expected = prepared.solve(&case, last.as_ref()).unwrap();
            assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
            check(&solver, &expected);
            last = Some(expected);
        }
        // From cold again.
        assert_eq!(whipcord_solver_reset(Some(&mut solver)), Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        check(&solver, &prepared.solve(&file.case, None).unwrap());
    }
}

#[test]
fn the_tip_load_is_that_of_the_case() {
    let file = whipcord_io::load(example("two-segment-arm.toml")).unwrap();
    let mut case = file.case.clone();
    case.loads.tip_force = Vec3::new(0.1, -0.05, 0.02);
    case.loads.tip_moment = Vec3::new(0.0, 1e-3, 0.0);
    let mut prepared = model(ModelKind::Cosserat).prepare(&file.robot, &case.loads).unwrap();
    let mut solver = solver(&load("two-segment-arm.toml"), "cosserat");
    let (force, moment) = (case.loads.tip_force.to_array(), case.loads.tip_moment.to_array());
    unsafe {
        let status =
            whipcord_solver_set_tip_load(Some(&mut solver), force.as_ptr(), moment.as_ptr());
        assert_eq!(status, Status::Ok);
    }
    assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
    check(&solver, &prepared.solve(&case, None).unwrap());
}

#[test]
fn each_cable_can_be_driven_in_its_own_way() {
    let file = whipcord_io::load(example("three-cable-segment.toml")).unwrap();
    let mut case = file.case.clone();
    let by = |tension, shortening: Option<f64>| CableCommand {
        tension,
        shortening: shortening.map(Shortening::Length),
    };
    case.commands = vec![by(Some(4.0), None), by(None, Some(-2e-3)), by(Some(0.5), None)];
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks, ModelKind::PseudoRigidBody] {
        let mut solver = solver(&load("three-cable-segment.toml"), kind.name());
        let (commands, flags) = ([4.0, -2e-3, 0.5], [0, 1, 0]);
        let status = unsafe {
            whipcord_solver_set_commands(Some(&mut solver), commands.as_ptr(), flags.as_ptr(), 3)
        };
        assert_eq!(status, Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let mut prepared = model(kind).prepare(&file.robot, &case.loads).unwrap();
        check(&solver, &prepared.solve(&case, None).unwrap());
    }
}

#[test]
fn the_tolerance_is_that_of_the_model() {
    let file = whipcord_io::load(example("wall-mounted-arm.toml")).unwrap();
    let mut solver = solver(&load("wall-mounted-arm.toml"), "cosserat");
    let mut steps = Vec::new();
    for tolerance in [1e-3, 1e-6, 1e-10] {
        assert_eq!(whipcord_solver_set_tolerance(Some(&mut solver), tolerance), Status::Ok);
        assert_eq!(whipcord_solver_reset(Some(&mut solver)), Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let model = model(ModelKind::Cosserat).with_tolerance(tolerance);
        let mut prepared = model.prepare(&file.robot, &file.case.loads).unwrap();
        let expected = prepared.solve(&file.case, None).unwrap();
        check(&solver, &expected);
        steps.push(expected.diagnostics.steps);
    }
    assert!(steps[0] < steps[2], "{steps:?}");
}

#[test]
fn files_of_several_steps_are_followed_through_them() {
    for name in ["rubbing-finger.toml", "hysteresis-loop.toml"] {
        let file = whipcord_io::load(example(name)).unwrap();
        assert!(!file.case.before.is_empty());
        let mut prepared =
            model(ModelKind::Cosserat).prepare(&file.robot, &file.case.loads).unwrap();
        let mut last = None;
        prepared.solve_steps(&file.case, |solution| last = Some(solution)).unwrap();
        let last = last.unwrap();
        let mut solver = solver(&load(name), "cosserat");
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        check(&solver, &last);
        // One step more.
        let cables = file.robot.cables().len();
        let tensions = vec![1.0; cables];
        let status =
            unsafe { whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), cables) };
        assert_eq!(status, Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let next = Case {
            loads: file.case.loads.clone(),
            base: file.case.base,
            ..Case::with_tensions(&tensions)
        };
        check(&solver, &prepared.solve(&next, Some(&last)).unwrap());
    }
}

#[test]
fn motors_remember_their_backlash() {
    let file = whipcord_io::parse(MOTORS, "robot.toml").unwrap();
    let mut prepared = model(ModelKind::Cosserat).prepare(&file.robot, &file.case.loads).unwrap();
    let mut solver = solver(&parse(MOTORS), "cosserat");
    let mut history = file.case.motors.clone();
    let mut last: Option<Solution> = None;
    for angles in [None, Some([0.3, 0.2]), Some([0.28, 0.1]), Some([0.1, 0.3])] {
        if let Some(angles) = angles {
            let status =
                unsafe { whipcord_solver_set_motors(Some(&mut solver), angles.as_ptr(), 2) };
            assert_eq!(status, Status::Ok);
            history.push(angles.map(Some).to_vec());
        }
        // All earlier commands are rows before the step.
        let mut case = Case { motors: history.clone(), ..file.case.clone() };
        case.drive(&file.robot).unwrap();
        let expected = prepared.solve(&case, last.as_ref()).unwrap();
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        check(&solver, &expected);
        last = Some(expected);
    }
}

#[test]
fn jacobians_are_those_of_rust() {
    for kind in ModelKind::ALL {
        let file = whipcord_io::load(example("three-cable-segment.toml")).unwrap();
        let (robot, case) = (&file.robot, &file.case);
        let mut solver = solver(&load("three-cable-segment.toml"), kind.name());
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let cables = robot.cables().len();
        let mut jacobian = vec![f64::NAN; 6 * cables];
        let status = unsafe {
            whipcord_solver_tip_jacobian(Some(&mut solver), jacobian.as_mut_ptr(), 6 * cables)
        };
        assert_eq!(status, Status::Ok);
        let mut prepared = model(kind).prepare(robot, &case.loads).unwrap();
        let solution = prepared.solve(case, None).unwrap();
        let motions = match model(kind).has_derivatives(robot) {
            true => {
                let mut motions = Vec::new();
                prepared.tip_by_commands(case, &solution, &mut motions).unwrap();
                motions
            }
            false => {
                let length = robot.backbone().length;
                model(kind).solve_at(robot, case, length).unwrap().1.actuation_jacobian
            }
        };
        for (i, motion) in motions.iter().enumerate() {
            let expected = [motion.linear.to_array(), motion.angular.to_array()].concat();
            let found: Vec<f64> = (0..6).map(|row| jacobian[row * cables + i]).collect();
            assert_eq!(found, expected, "{kind}");
        }
        // A slack cable moves nothing, but not all of them are.
        assert!(jacobian.iter().any(|rate| *rate != 0.0), "{kind}");
    }
}

#[test]
fn the_jacobian_is_the_rate_of_the_tip_also_on_a_turned_base() {
    let text = MOTORS.split("[[motors]]").next().unwrap().to_owned()
        + "[base]\nposition = [\"1 m\", \"0 m\", \"0 m\"]\nrotation = { axis = [1, 1, 1], angle = \"120 deg\" }\n";
    let mut solver = solver(&parse(&text), "cosserat");
    let mut tip = |tensions: [f64; 2]| {
        let mut pose = [0.0; 7];
        let status =
            unsafe { whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), 2) };
        assert_eq!(status, Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let mut jacobian = [0.0; 12];
        unsafe {
            assert_eq!(whipcord_solver_tip_pose(Some(&solver), pose.as_mut_ptr()), Status::Ok);
            let status = whipcord_solver_tip_jacobian(Some(&mut solver), jacobian.as_mut_ptr(), 12);
            assert_eq!(status, Status::Ok);
        }
        (pose, jacobian)
    };
    let h = 1e-4;
    let (low, high, (_, jacobian)) =
        (tip([2.0 - h, 1.0]).0, tip([2.0 + h, 1.0]).0, tip([2.0, 1.0]));
    for row in 0..3 {
        let difference = (high[row] - low[row]) / (2.0 * h);
        assert!((difference - jacobian[2 * row]).abs() < 1e-7, "{row} {difference} {jacobian:?}");
    }
    assert!(jacobian.iter().any(|rate| rate.abs() > 1e-3));
}

#[test]
fn reached_commands_are_those_of_rust() {
    let file = whipcord_io::load(example("reaching-arm.toml")).unwrap();
    let goal = &file.goal;
    let length = file.robot.backbone().length;
    let tolerance = goal.tolerance(length).unwrap();
    let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural)
        .with_tolerance((0.1 * tolerance.position / length).clamp(1e-12, 1e-6));
    let actuators: Vec<_> =
        (0..file.robot.cables().len()).map(whipcord_inverse::Actuator::Tension).collect();
    let limits = goal.limits(&file.robot, &actuators).unwrap();
    let mut expected =
        InverseSolver::new(&model, &file.robot, &file.case, &limits, CommandedBy::Case).unwrap();
    let options = ReachOptions {
        tolerance: Some(tolerance),
        prefer: goal.preference.unwrap(),
        ..ReachOptions::default()
    };
    let mut reach = reach(&load("reaching-arm.toml"));
    let count = whipcord_reach_command_count(Some(&reach));
    assert_eq!(count, actuators.len());
    for point in [None, Some([0.05, 0.0, 0.285]), Some([0.2, 0.2, 0.2])] {
        let target = point.map_or_else(
            || goal.target.clone().unwrap(),
            |[x, y, z]| Target::Tip(Vec3::new(x, y, z)),
        );
        let reached = expected.reach(&target, &options).unwrap();
        let mut result = ReachResult {
            outcome: ReachOutcome::Undecided,
            position_miss: 0.0,
            angle_miss: 0.0,
            tip: [0.0; 7],
            solves: 0,
        };
        let mut commands = vec![0.0; count];
        unsafe {
            let status = match point {
                None => whipcord_reach_target(Some(&mut reach), &raw mut result),
                Some(point) => {
                    whipcord_reach_tip(Some(&mut reach), point.as_ptr(), &raw mut result)
                }
            };
            assert_eq!(status, Status::Ok);
            let status = whipcord_reach_commands(Some(&reach), commands.as_mut_ptr(), count);
            assert_eq!(status, Status::Ok);
        }
        assert_eq!(commands, reached.commands);
        assert_eq!(result.outcome == ReachOutcome::Reached, reached.status == ReachStatus::Reached);
        assert_eq!(result.tip, numbers(reached.solution.disks.tip()));
        assert_eq!(result.position_miss, reached.miss.position);
    }
    let (mut kind, mut number) = (CommandKind::Motor, 9);
    let status = unsafe { whipcord_reach_command(Some(&reach), 2, &raw mut kind, &raw mut number) };
    assert_eq!((status, kind, number), (Status::Ok, CommandKind::Tension, 2));
}

#[test]
fn motions_are_those_of_rust() {
    let file = whipcord_io::load(example("released-arm.toml")).unwrap();
    let mut commands = file.motion.commands(&file.robot, &file.case);
    let mut expected =
        Simulation::with_commands(&file.robot, &file.case, &commands, file.motion.options())
            .unwrap();
    let mut simulation = simulation(&load("released-arm.toml"));
    let nodes = whipcord_simulation_node_count(Some(&simulation));
    for step in 0..30 {
        if step == 10 {
            commands.set_tension(0, 1.0);
            commands.set_tension(1, 2.5);
            let tensions = [1.0, 2.5];
            let status = unsafe {
                whipcord_simulation_set_tensions(Some(&mut simulation), tensions.as_ptr(), 2)
            };
            assert_eq!(status, Status::Ok);
        }
        if step == 20 {
            let by = 1e-3;
            commands.set_tension(0, 0.5);
            commands.set_shortening(1, by);
            let (values, flags) = ([0.5, by], [0, 1]);
            let status = unsafe {
                whipcord_simulation_set_commands(
                    Some(&mut simulation),
                    values.as_ptr(),
                    flags.as_ptr(),
                    2,
                )
            };
            assert_eq!(status, Status::Ok);
        }
        let state = expected.step(&commands, 5e-3).unwrap();
        assert_eq!(whipcord_simulation_step(Some(&mut simulation), 5e-3), Status::Ok);
        let mut poses = vec![0.0; 7 * nodes];
        let (mut tensions, mut lengths, mut tip) = ([0.0; 2], [0.0; 2], [0.0; 7]);
        unsafe {
            whipcord_simulation_node_poses(Some(&simulation), poses.as_mut_ptr(), poses.len());
            whipcord_simulation_tensions(Some(&simulation), tensions.as_mut_ptr(), 2);
            whipcord_simulation_lengths(Some(&simulation), lengths.as_mut_ptr(), 2);
            whipcord_simulation_tip_pose(Some(&simulation), tip.as_mut_ptr());
        }
        assert_eq!(poses, state.poses.iter().flat_map(|pose| numbers(*pose)).collect::<Vec<_>>());
        assert_eq!(tensions.to_vec(), state.cables.iter().map(|c| c.tension).collect::<Vec<_>>());
        assert_eq!(lengths.to_vec(), state.cables.iter().map(|c| c.length).collect::<Vec<_>>());
        assert_eq!(tip, numbers(state.tip()));
        assert_eq!(whipcord_simulation_time(Some(&simulation)), state.time);
    }
}

#[test]
fn robots_are_described() {
    let robot = load("two-segment-arm.toml");
    let text = |pointer| unsafe { CStr::from_ptr(pointer) }.to_str().unwrap();
    assert_eq!(text(whipcord_robot_title(Some(&robot))), "Two-segment arm");
    assert_eq!(whipcord_robot_cable_count(Some(&robot)), 6);
    assert_eq!(whipcord_robot_disk_count(Some(&robot)), 15);
    assert_eq!(whipcord_robot_length(Some(&robot)), 0.3);
    assert_eq!(text(whipcord_robot_cable_name(Some(&robot), 3)), "lower-1");
    assert!(whipcord_robot_cable_name(Some(&robot), 6).is_null());
    let motors = parse(MOTORS);
    assert_eq!(whipcord_robot_motor_count(Some(&motors)), 2);
    assert_eq!(text(whipcord_robot_motor_name(Some(&motors), 1)), "m2");
    assert_eq!(text(whipcord_version()), env!("CARGO_PKG_VERSION"));
    assert_eq!(whipcord_abi_version(), ABI_VERSION);
}
