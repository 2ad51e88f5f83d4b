//! Wrong and random arguments cost an error.

use std::ptr;

use proptest::prelude::*;
use whipcord_c::*;

use super::common::{MOTORS, c, example, load, message, parse, reach, simulation, solver};

fn no_result() -> ReachResult {
    ReachResult {
        outcome: ReachOutcome::Undecided,
        position_miss: 0.0,
        angle_miss: 0.0,
        tip: [0.0; 7],
        solves: 0,
    }
}

#[test]
fn null_is_an_error_everywhere() {
    let mut number = 0.0;
    let n = &raw mut number;
    let mut result = no_result();
    unsafe {
        let mut robot = ptr::null_mut();
        for status in [
            whipcord_robot_load(ptr::null(), &raw mut robot),
            whipcord_robot_load(c("x").as_ptr(), ptr::null_mut()),
            whipcord_robot_parse(ptr::null(), ptr::null(), &raw mut robot),
            whipcord_solver_new(None, ptr::null(), &mut ptr::null_mut()),
            whipcord_solver_new(Some(&load("soft-finger.toml")), ptr::null(), ptr::null_mut()),
            whipcord_solver_reset(None),
            whipcord_solver_set_budget(None, 1, 1),
            whipcord_solver_set_tensions(None, n, 1),
            whipcord_solver_set_tolerance(None, 1e-6),
            whipcord_solver_set_commands(None, n, ptr::null(), 1),
            whipcord_solver_set_shortenings(None, n, 1),
            whipcord_solver_set_motors(None, n, 1),
            whipcord_solver_set_tip_load(None, n, n),
            whipcord_solver_solve(None),
            whipcord_solver_tip_pose(None, n),
            whipcord_solver_disk_poses(None, n, 1),
            whipcord_solver_tensions(None, n, 1),
            whipcord_solver_lengths(None, n, 1),
            whipcord_solver_slack(None, ptr::null_mut(), 1),
            whipcord_solver_diagnostics(None, ptr::null_mut()),
            whipcord_solver_tip_jacobian(None, n, 1),
            whipcord_reach_new(None, ptr::null(), &mut ptr::null_mut()),
            whipcord_reach_command(None, 0, ptr::null_mut(), ptr::null_mut()),
            whipcord_reach_tip(None, n, &raw mut result),
            whipcord_reach_pose(None, n, &raw mut result),
            whipcord_reach_target(None, &raw mut result),
            whipcord_reach_commands(None, n, 1),
            whipcord_simulation_new(None, &mut ptr::null_mut()),
            whipcord_simulation_set_tensions(None, n, 1),
            whipcord_simulation_set_commands(None, n, ptr::null(), 1),
            whipcord_simulation_set_shortenings(None, n, 1),
            whipcord_simulation_set_motors(None, n, 1),
            whipcord_simulation_step(None, 0.1),
            whipcord_simulation_tip_pose(None, n),
            whipcord_simulation_node_poses(None, n, 1),
            whipcord_simulation_tensions(None, n, 1),
            whipcord_simulation_lengths(None, n, 1),
        ] {
            assert_eq!(status, Status::NullPointer);
            assert!(message().ends_with(" is NULL"), "{}", message());
        }
        assert!(robot.is_null());
        // Arrays of handles that there are.
        let mut solver = solver(&load("two-segment-arm.toml"), "cosserat");
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        for status in [
            whipcord_solver_set_tensions(Some(&mut solver), ptr::null(), 6),
            whipcord_solver_set_commands(Some(&mut solver), [1.0; 6].as_ptr(), ptr::null(), 6),
            whipcord_solver_set_commands(Some(&mut solver), ptr::null(), [1; 6].as_ptr(), 6),
            whipcord_solver_tip_pose(Some(&solver), ptr::null_mut()),
            whipcord_solver_disk_poses(Some(&solver), ptr::null_mut(), 7 * 15),
            whipcord_solver_slack(Some(&solver), ptr::null_mut(), 6),
            whipcord_solver_diagnostics(Some(&solver), ptr::null_mut()),
            whipcord_solver_tip_jacobian(Some(&mut solver), ptr::null_mut(), 36),
        ] {
            assert_eq!(status, Status::NullPointer);
        }
    }
    assert_eq!(whipcord_robot_cable_count(None), 0);
    assert_eq!(whipcord_robot_disk_count(None), 0);
    assert_eq!(whipcord_robot_motor_count(None), 0);
    assert!(whipcord_robot_length(None) == 0.0);
    assert!(whipcord_robot_title(None).is_null());
    assert!(whipcord_robot_cable_name(None, 0).is_null());
    assert!(whipcord_robot_motor_name(None, 0).is_null());
    assert_eq!(whipcord_reach_command_count(None), 0);
    assert_eq!(whipcord_simulation_node_count(None), 0);
    assert!(whipcord_simulation_time(None) == 0.0);
    whipcord_robot_free(None);
    whipcord_solver_free(None);
    whipcord_reach_free(None);
    whipcord_simulation_free(None);
}

#[test]
fn files_that_cannot_be_used_say_where() {
    let mut robot = ptr::dangling_mut();
    unsafe {
        let status = whipcord_robot_load(c("no-such-robot.toml").as_ptr(), &raw mut robot);
        assert_eq!(status, Status::File);
        assert!(robot.is_null() && message().contains("no-such-robot.toml"), "{}", message());
        let text = c("[backbone]\nlength = \"180 kg\"\n");
        let name = c("arm.toml");
        let status = whipcord_robot_parse(text.as_ptr(), name.as_ptr(), &raw mut robot);
        assert_eq!(status, Status::File);
        assert!(message().contains("arm.toml:2:"), "{}", message());
        let status = whipcord_robot_parse(c"\xFF\xFE".as_ptr(), ptr::null(), &raw mut robot);
        assert_eq!(status, Status::NotUtf8);
        let status = whipcord_robot_load(c"a\xC3".as_ptr(), &raw mut robot);
        assert_eq!(
            (status, message().as_str()),
            (Status::NotUtf8, "path is not UTF-8: byte 1 is not text")
        );
        let arm = load("two-segment-arm.toml");
        let mut solver = ptr::dangling_mut();
        let status = whipcord_solver_new(Some(&arm), c("cosine").as_ptr(), &raw mut solver);
        assert_eq!(status, Status::InvalidArgument);
        assert!(solver.is_null() && message().contains("piecewise-constant-curvature"));
        let mut moving = ptr::dangling_mut();
        let rubbing = load("rubbing-finger.toml");
        let status = whipcord_simulation_new(Some(&rubbing), &raw mut moving);
        assert_eq!(status, Status::Refused);
        assert!(moving.is_null() && message().contains("rubbing-finger.toml:"), "{}", message());
    }
}

#[test]
fn messages_belong_to_their_thread() {
    assert_eq!(whipcord_solver_reset(None), Status::NullPointer);
    std::thread::spawn(|| assert_eq!(message(), "")).join().unwrap();
    assert_eq!(message(), "solver is NULL");
}

#[test]
fn wrong_commands_change_nothing() {
    let mut solver = solver(&load("two-segment-arm.toml"), "cosserat");
    let mut tip = [0.0; 7];
    unsafe {
        let status = whipcord_solver_tip_pose(Some(&solver), tip.as_mut_ptr());
        assert_eq!(status, Status::Unavailable);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        assert_eq!(whipcord_solver_tip_pose(Some(&solver), tip.as_mut_ptr()), Status::Ok);
        let mut tensions = [1.0; 6];
        for (count, value, expected) in [
            (5, 1.0, Status::WrongLength),
            (usize::MAX, 1.0, Status::WrongLength),
            (6, f64::NAN, Status::InvalidArgument),
            (6, f64::INFINITY, Status::InvalidArgument),
            (6, -1.0, Status::InvalidArgument),
        ] {
            tensions[3] = value;
            let status = whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), count);
            assert_eq!(status, expected);
        }
        assert!(message().contains("tensions[3] is -1 N"), "{}", message());
        let mut flags = [1; 6];
        flags[3] = 0;
        for (flag, words) in [(0, "commands[3] is a tension of -1 N"), (2, "by_shortening[3] is 2")]
        {
            flags[3] = flag;
            let status = whipcord_solver_set_commands(
                Some(&mut solver),
                tensions.as_ptr(),
                flags.as_ptr(),
                6,
            );
            assert_eq!(status, Status::InvalidArgument);
            assert!(message().contains(words), "{}", message());
        }
        for tolerance in [0.0, -1.0, 1e-14, 0.1, f64::NAN, f64::INFINITY] {
            let status = whipcord_solver_set_tolerance(Some(&mut solver), tolerance);
            assert_eq!(status, Status::InvalidArgument);
            assert!(message().contains("from 1e-13 to 0.01"), "{}", message());
        }
        let status = whipcord_solver_set_motors(Some(&mut solver), tensions.as_ptr(), 1);
        assert_eq!(status, Status::WrongLength);
        let force = [0.0, f64::NAN, 0.0];
        let status = whipcord_solver_set_tip_load(Some(&mut solver), force.as_ptr(), ptr::null());
        assert_eq!(status, Status::InvalidArgument);
        let mut again = [0.0; 7];
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        assert_eq!(whipcord_solver_tip_pose(Some(&solver), again.as_mut_ptr()), Status::Ok);
        for (a, b) in tip.iter().zip(again) {
            assert!((a - b).abs() < 1e-9);
        }
        tensions.fill(1e200);
        let status = whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), 6);
        assert_eq!(status, Status::InvalidArgument);
        assert!(message().contains("give 1e12 N or less"), "{}", message());
        // A solve that fails keeps the solution.
        tensions.fill(1e11);
        assert_eq!(
            whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), 6),
            Status::Ok
        );
        assert_ne!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
        let mut kept = [0.0; 7];
        assert_eq!(whipcord_solver_tip_pose(Some(&solver), kept.as_mut_ptr()), Status::Ok);
        assert_eq!(kept, again);
    }
}

#[test]
fn a_spent_budget_gives_the_best_shape_so_far() {
    let mut solver = solver(&load("two-segment-arm.toml"), "cosserat");
    assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
    assert_eq!(whipcord_solver_set_budget(Some(&mut solver), 1, usize::MAX), Status::Ok);
    let tensions = [16.0, 1.0, 1.0, 3.0, 1.0, 1.0];
    let status = unsafe { whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), 6) };
    assert_eq!(status, Status::Ok);
    assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::BudgetSpent);
    let converged = (0..50).any(|_| whipcord_solver_solve(Some(&mut solver)) == Status::Ok);
    assert!(converged);
}

#[test]
fn an_unreachable_point_is_a_result_and_a_wrong_one_an_error() {
    let mut reach = reach(&load("reaching-arm.toml"));
    let mut result = no_result();
    let mut commands = [0.0; 6];
    unsafe {
        let status = whipcord_reach_commands(Some(&reach), commands.as_mut_ptr(), 6);
        assert_eq!(status, Status::Unavailable);
        let far = [5.0, 0.0, 0.0];
        assert_eq!(whipcord_reach_tip(Some(&mut reach), far.as_ptr(), &raw mut result), Status::Ok);
        assert!(result.outcome != ReachOutcome::Reached && result.position_miss > 4.0);
        let wrong = [f64::NAN, 0.0, 0.0];
        let status = whipcord_reach_tip(Some(&mut reach), wrong.as_ptr(), &raw mut result);
        assert_eq!(status, Status::InvalidArgument);
        let status = whipcord_reach_pose(Some(&mut reach), [0.0; 7].as_ptr(), &raw mut result);
        assert_eq!(status, Status::InvalidArgument);
        let status = whipcord_reach_command(Some(&reach), 6, &mut CommandKind::Motor, &mut 0);
        assert_eq!(status, Status::InvalidArgument);
    }
}

/// Numbers of all sizes, and what is none.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -20.0..20.0_f64,
        2 => prop::num::f64::ANY,
        1 => Just(0.0),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(1e-300),
    ]
}

fn any_numbers() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        3 => prop::collection::vec(any_number(), 2..=2),
        2 => prop::collection::vec(0.0..5.0_f64, 2..=2),
        1 => prop::collection::vec(any_number(), 0..9),
    ]
}

/// An array that nothing but finite numbers may be written to, with room for none that is not told.
fn finite(status: Status, values: &[f64]) {
    assert_ne!(status, Status::Internal, "{}", message());
    if status == Status::Ok {
        assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn random_calls_of_a_solver_are_answered(
        calls in prop::collection::vec((0..9_u8, any_numbers(), 0..60_usize), 1..12),
        kind in 0..6_usize,
    ) {
        let model = whipcord::ModelKind::ALL[kind].name();
        let mut solver = solver(&parse(MOTORS), model);
        // A solve far out may take its whole budget.
        whipcord_solver_set_budget(Some(&mut solver), 300, 20_000);
        for (call, numbers, count) in calls {
            let (given, n) = (numbers.as_ptr(), numbers.len());
            let solver = &mut *solver;
            let status = unsafe {
                match call {
                    0 => whipcord_solver_set_tensions(Some(solver), given, n),
                    1 => whipcord_solver_set_shortenings(Some(solver), given, n),
                    2 => whipcord_solver_set_motors(Some(solver), given, n),
                    3 if n >= 3 => whipcord_solver_set_tip_load(Some(solver), given, ptr::null()),
                    4 => whipcord_solver_reset(Some(solver)),
                    5 => whipcord_solver_set_tolerance(Some(solver), numbers.first().copied().unwrap_or(1e-4)),
                    6 => {
                        let flags: Vec<u8> = (0..n).map(|i| u8::try_from((count >> i) % 3).unwrap()).collect();
                        whipcord_solver_set_commands(Some(solver), given, flags.as_ptr(), n)
                    }
                    _ => whipcord_solver_solve(Some(solver)),
                }
            };
            finite(status, &[]);
            let mut out = vec![0.0; count];
            let pointer = out.as_mut_ptr();
            unsafe {
                finite(whipcord_solver_disk_poses(Some(solver), pointer, count), &out);
                finite(whipcord_solver_tensions(Some(solver), pointer, count), &out);
                finite(whipcord_solver_tip_jacobian(Some(solver), pointer, count), &out);
                let mut jacobian = [0.0; 12];
                finite(whipcord_solver_tip_jacobian(Some(solver), jacobian.as_mut_ptr(), 12), &jacobian);
            }
        }
    }

    #[test]
    fn random_calls_of_a_simulation_are_answered(
        calls in prop::collection::vec((0..6_u8, any_numbers(), any_number()), 1..10),
    ) {
        let mut simulation = simulation(&parse(MOTORS));
        for (call, numbers, number) in calls {
            let (given, n) = (numbers.as_ptr(), numbers.len());
            let simulation = &mut *simulation;
            let status = unsafe {
                match call {
                    0 => whipcord_simulation_set_tensions(Some(simulation), given, n),
                    1 => whipcord_simulation_set_shortenings(Some(simulation), given, n),
                    2 => whipcord_simulation_set_motors(Some(simulation), given, n),
                    3 => whipcord_simulation_step(Some(simulation), number),
                    4 => {
                        let flags: Vec<u8> = numbers.iter().map(|x| u8::from(x.abs() < 0.5)).collect();
                        whipcord_simulation_set_commands(Some(simulation), given, flags.as_ptr(), n)
                    }
                    _ => whipcord_simulation_step(Some(simulation), 5e-3),
                }
            };
            finite(status, &[]);
            let (mut pose, mut tensions) = ([0.0; 7], [0.0; 2]);
            unsafe {
                finite(whipcord_simulation_tip_pose(Some(simulation), pose.as_mut_ptr()), &pose);
                finite(whipcord_simulation_tensions(Some(simulation), tensions.as_mut_ptr(), 2), &tensions);
            }
        }
    }

    #[test]
    fn random_texts_are_no_robots(text in "(?s).{0,200}") {
        let mut robot = ptr::null_mut();
        let text: String = text.replace('\0', " ");
        let status = unsafe { whipcord_robot_parse(c(&text).as_ptr(), ptr::null(), &raw mut robot) };
        assert_eq!(status, Status::File);
        assert!(robot.is_null());
    }
}

#[test]
fn what_is_made_of_a_robot_outlives_it() {
    let mut pointer = ptr::null_mut();
    let path = c(&example("two-segment-arm.toml"));
    let status = unsafe { whipcord_robot_load(path.as_ptr(), &raw mut pointer) };
    assert_eq!(status, Status::Ok);
    let robot = unsafe { Box::from_raw(pointer) };
    let mut solver = solver(&robot, "cosserat");
    whipcord_robot_free(Some(robot));
    assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
    whipcord_solver_free(Some(solver));
}
