//! What is called in every cycle of a controller takes no memory.

use whipcord_c::*;

use super::common::{MOTORS, load, parse, simulation, solver};

#[test]
fn a_cycle_of_a_controller_allocates_nothing() {
    let robot = load("two-segment-arm.toml");
    for model in ["cosserat", "cosserat-disks", "piecewise-constant-curvature", "pseudo-rigid-body"]
    {
        let mut solver = solver(&robot, model);
        let mut cycle = |number: u32| {
            let mut tensions = [14.0, 1.0, 1.0, 8.0, 1.0, 1.0];
            tensions[0] += 0.3 * (0.1 * f64::from(number)).sin();
            let force = [0.01 * (0.05 * f64::from(number)).sin(), 0.0, 0.0];
            let (mut pose, mut poses, mut slack) = ([0.0; 7], [0.0; 7 * 15], [0; 6]);
            unsafe {
                let status = whipcord_solver_set_tensions(Some(&mut solver), tensions.as_ptr(), 6);
                assert_eq!(status, Status::Ok);
                let moment = std::ptr::null();
                let status =
                    whipcord_solver_set_tip_load(Some(&mut solver), force.as_ptr(), moment);
                assert_eq!(status, Status::Ok);
                assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
                assert_eq!(whipcord_solver_tip_pose(Some(&solver), pose.as_mut_ptr()), Status::Ok);
                whipcord_solver_disk_poses(Some(&solver), poses.as_mut_ptr(), poses.len());
                whipcord_solver_lengths(Some(&solver), tensions.as_mut_ptr(), 6);
                whipcord_solver_tensions(Some(&solver), tensions.as_mut_ptr(), 6);
                assert_eq!(whipcord_solver_slack(Some(&solver), slack.as_mut_ptr(), 6), Status::Ok);
                let mut jacobian = [0.0; 36];
                let status =
                    whipcord_solver_tip_jacobian(Some(&mut solver), jacobian.as_mut_ptr(), 36);
                assert_eq!(status, Status::Ok);
            }
        };
        // The first round finds how much memory the commands take.
        (0..200).for_each(&mut cycle);
        let info = allocation_counter::measure(|| (0..200).for_each(&mut cycle));
        assert_eq!(info.count_total, 0, "{model}");
    }
}

#[test]
fn commands_of_motors_allocate_nothing() {
    let robot = parse(MOTORS);
    let mut solver = solver(&robot, "cosserat");
    let mut cycle = |number: u32| {
        let angles = [0.3 + 0.1 * (0.1 * f64::from(number)).sin(), 0.2];
        let status = unsafe { whipcord_solver_set_motors(Some(&mut solver), angles.as_ptr(), 2) };
        assert_eq!(status, Status::Ok);
        assert_eq!(whipcord_solver_solve(Some(&mut solver)), Status::Ok);
    };
    (0..200).for_each(&mut cycle);
    let info = allocation_counter::measure(|| (0..200).for_each(&mut cycle));
    assert_eq!(info.count_total, 0);
}

#[test]
fn steps_of_a_simulation_allocate_nothing() {
    let mut simulation = simulation(&load("released-arm.toml"));
    let mut cycle = |number: u32| {
        let mut tensions = [1.0 + 0.5 * (0.1 * f64::from(number)).sin(), 0.5];
        let (mut pose, mut poses) = ([0.0; 7], [0.0; 7 * 64]);
        unsafe {
            let status =
                whipcord_simulation_set_tensions(Some(&mut simulation), tensions.as_ptr(), 2);
            assert_eq!(status, Status::Ok);
            assert_eq!(whipcord_simulation_step(Some(&mut simulation), 5e-3), Status::Ok);
            whipcord_simulation_tip_pose(Some(&simulation), pose.as_mut_ptr());
            let nodes = whipcord_simulation_node_count(Some(&simulation));
            whipcord_simulation_node_poses(Some(&simulation), poses.as_mut_ptr(), 7 * nodes);
            whipcord_simulation_tensions(Some(&simulation), tensions.as_mut_ptr(), 2);
        }
    };
    (0..20).for_each(&mut cycle);
    let info = allocation_counter::measure(|| (0..50).for_each(&mut cycle));
    assert_eq!(info.count_total, 0);
}
