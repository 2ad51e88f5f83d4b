//! What must hold for any robot under the Cosserat model.

use crate::common;
use crate::common::accurate;
use crate::common::load_kind::burdened;
use crate::common::symmetry::Symmetry;
use crate::common::{
    Wildness, config, distance, fine_options, helix, paper_backbone, paper_robot, robot, solve,
    solve_with, straight,
};
use proptest::prelude::*;
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Cable, CableCommand, Case, Disks, Loads, Model, Pose, RestCurvature, Robot, Solution, Stations,
    Vec3,
};
use whipcord_numerics::Twist;

const CASES: u32 = if cfg!(debug_assertions) { 24 } else { 96 };

/// A third of the robots carry single loads, another third loads along the backbone and masses as well.
fn any_robot() -> impl Strategy<Value = (Robot, Case)> {
    prop_oneof![robot(Wildness::UNLOADED), robot(Wildness::LOADED), burdened(Wildness::LOADED)]
}

fn length(robot: &Robot) -> f64 {
    robot.backbone().length
}

/// With another order of the cables: `order[i]` is the number of the cable that comes i-th.
fn permuted(robot: &Robot, case: &Case, order: &[usize]) -> (Robot, Case) {
    let cables = order.iter().map(|&i| robot.cables()[i].clone()).collect();
    let commands = order.iter().map(|&i| case.commands[i]).collect();
    let other = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
    (other, Case { commands, ..case.clone() })
}

/// Largest difference between lengths of cables, in m.
fn length_difference(a: &Solution, b: &Solution, order: &[usize]) -> f64 {
    let difference = |(k, &i): (usize, &usize)| (b.cables[k].length - a.cables[i].length).abs();
    order.iter().enumerate().map(difference).fold(0.0, f64::max)
}

fn cold_and_warm(robot: &Robot, case: &Case, neighbour: &Case) -> (Solution, Solution) {
    let options = Options { stations: Stations::Equal(11), ..accurate() };
    let mut model = Model::Cosserat(options).prepare(robot, &case.loads).unwrap();
    let near = model.solve(neighbour, None).unwrap();
    let warm = model.solve(case, Some(&near)).unwrap();
    (model.solve(case, None).unwrap(), warm)
}

proptest! {
    #![proptest_config(config(CASES))]

    #[test]
    fn a_mirrored_robot_takes_the_mirrored_shape((robot, case) in any_robot()) {
        let mirror = Symmetry::Mirror;
        let image = solve(&mirror.robot(&robot), &mirror.case(&case));
        let error = mirror.error(&solve(&robot, &case), &image, length(&robot));
        prop_assert!(error < 1e-9, "off by {error:.1e}");
    }

    #[test]
    fn turning_robot_and_loads_turns_the_answer((robot, case) in any_robot(), holes in 1..12_usize) {
        let turn = Symmetry::turn_of(&robot, holes);
        let image = solve(&turn.robot(&robot), &turn.case(&case));
        let error = turn.error(&solve(&robot, &case), &image, length(&robot));
        prop_assert!(error < 1e-9, "off by {error:.1e}");
    }

    #[test]
    fn the_order_of_the_cables_changes_nothing(
        ((robot, case), order) in any_robot().prop_flat_map(|(robot, case)| {
            let order: Vec<usize> = (0..robot.cables().len()).collect();
            (Just((robot, case)), Just(order).prop_shuffle())
        })
    ) {
        let (other, other_case) = permuted(&robot, &case, &order);
        let (a, b) = (solve(&robot, &case), solve(&other, &other_case));
        // Sums in another order differ by rounding, and under loads the iteration ends elsewhere
        // within its tolerance.
        let tolerance = length(&robot) * if case.loads.is_none() { 1e-13 } else { 1e-10 };
        prop_assert!(distance(&a, &b) < tolerance, "{:.1e}", distance(&a, &b));
        let lengths = length_difference(&a, &b, &order);
        prop_assert!(lengths < tolerance, "lengths {lengths:.1e}");
    }

    #[test]
    fn two_cables_on_one_route_act_as_one((robot, case) in any_robot(), share in 0.0..1.0_f64) {
        let whole = case.commands[0].tension.unwrap();
        let part = |tension: f64| CableCommand { tension: Some(tension), shortening: None };
        let mut cables = robot.cables().to_vec();
        cables.push(Cable { name: "second half".to_owned(), ..cables[0].clone() });
        let mut split = case.clone();
        split.commands[0] = part(share * whole);
        split.commands.push(part((1.0 - share) * whole));
        let doubled =
            Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
        let (a, b) = (solve(&robot, &case), solve(&doubled, &split));
        prop_assert!(distance(&a, &b) < 1e-10 * length(&robot), "{:.1e}", distance(&a, &b));
        let lengths = (b.cables[0].length - b.cables[b.cables.len() - 1].length).abs();
        prop_assert!(lengths < 1e-15 + 1e-14 * length(&robot));
    }

    #[test]
    fn a_cable_without_tension_changes_nothing((robot, case) in any_robot()) {
        let mut cables = robot.cables().to_vec();
        cables.push(Cable::new("idle", helix(77.0, 0.4)));
        let mut more = case.clone();
        more.commands.push(CableCommand { tension: Some(0.0), shortening: None });
        let other = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
        let (a, b) = (solve(&robot, &case), solve(&other, &more));
        // With the idle cable the steps may be shared out otherwise.
        prop_assert!(distance(&a, &b) < 3e-9 * length(&robot), "{:.1e}", distance(&a, &b));
    }

    #[test]
    fn a_robot_that_nothing_pulls_on_has_its_rest_shape((robot, case) in robot(Wildness::UNLOADED)) {
        let idle = Case::with_tensions(&vec![0.0; case.commands.len()]);
        let solution = solve(&robot, &idle);
        if let RestCurvature::Uniform(u) = robot.backbone().rest_curvature {
            for (&s, pose) in solution.shape.arc_length.iter().zip(&solution.shape.poses) {
                let rest = Pose::exp(Twist { linear: Vec3::Z * s, angular: u * s });
                prop_assert!((pose.position - rest.position).norm() < 1e-13 * length(&robot));
            }
        }
        for cable in &solution.cables {
            let change = (cable.length - cable.initial_length).abs();
            prop_assert!(change < 1e-14 * length(&robot), "{change:.1e}");
        }
        prop_assert!((solution.diagnostics.stability.unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_warm_start_ends_where_a_cold_one_does((robot, case) in any_robot(), by in 0.85..1.15_f64) {
        let mut neighbour = case.clone();
        for command in &mut neighbour.commands {
            command.tension = command.tension.map(|t| t * by);
        }
        neighbour.loads.tip_force *= by;
        neighbour.loads.tip_moment *= by;
        let (cold, warm) = cold_and_warm(&robot, &case, &neighbour);
        prop_assert!(distance(&cold, &warm) < 1e-9 * length(&robot), "{:.1e}", distance(&cold, &warm));
    }
}

/// Distance of the tips, and of the lengths of the first cable, with so many equal steps from what
/// they are with many.
fn error_of_steps(robot: &Robot, case: &Case, steps: usize) -> f64 {
    let with = |accuracy| {
        // Only base and tip break the steps.
        let options =
            Options { accuracy, stations: Stations::Equal(2), residual: 1e-14, ..fine_options() };
        solve_with(options, robot, case).unwrap()
    };
    let (coarse, fine) = (with(Accuracy::Steps(steps)), with(Accuracy::Steps(512)));
    assert_eq!(coarse.diagnostics.steps, steps);
    assert_eq!(coarse.diagnostics.discretization_error, None);
    (coarse.shape.tip().position - fine.shape.tip().position).norm()
}

/// Orders that halving the steps shows.
fn orders(robot: &Robot, case: &Case, steps: &[usize]) -> Vec<f64> {
    let errors: Vec<f64> = steps.iter().map(|&n| error_of_steps(robot, case, n)).collect();
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

fn smooth_robot(routings: Vec<whipcord::Routing>) -> Robot {
    let mut backbone = paper_backbone();
    backbone.material.density = Some(1040.0);
    let cable = |(i, routing)| Cable::new(format!("cable {i}"), routing);
    let cables = routings.into_iter().enumerate().map(cable).collect();
    Robot::new(backbone, Disks::equally_spaced(0.18, 2, 0.008), cables).unwrap()
}

fn some_loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(-9.81, 0.0, 0.0)),
        tip_force: Vec3::new(0.1, 0.05, -0.1),
        tip_moment: Vec3::new(0.0, 0.003, 0.004),
        ..Loads::default()
    }
}

#[test]
fn without_load_the_error_falls_with_the_sixth_power_of_the_step() {
    for routings in [vec![helix(20.0, 0.75)], vec![helix(0.0, 1.0), helix(150.0, -0.6)]] {
        let tensions = vec![4.0; routings.len()];
        let robot = smooth_robot(routings);
        let orders = orders(&robot, &Case::with_tensions(&tensions), &[6, 12, 24]);
        assert!(orders.iter().all(|&order| order > 5.5), "{orders:?}");
    }
}

#[test]
fn under_loads_the_error_falls_with_the_fifth_power_of_the_step() {
    for routings in [vec![helix(20.0, 0.75)], vec![helix(0.0, 1.0), straight(150.0)]] {
        let mut case = Case::with_tensions(&vec![3.0; routings.len()]);
        case.loads = some_loads();
        let robot = smooth_robot(routings);
        let orders = orders(&robot, &case, &[12, 24, 48]);
        assert!(orders.iter().all(|&order| order > 4.6), "{orders:?}");
    }
}

#[test]
fn the_estimated_error_is_no_less_than_the_true_one() {
    let robot = paper_robot(vec![helix(20.0, 0.75), helix(150.0, -0.5)]);
    for (loads, tolerance) in [
        (Loads::default(), 1e-5),
        (Loads::default(), 1e-8),
        (Loads { gravity: None, ..some_loads() }, 1e-5),
        (Loads { gravity: None, ..some_loads() }, 1e-8),
    ] {
        let case = Case { loads, ..Case::with_tensions(&[3.0, 2.0]) };
        let options = Options { accuracy: Accuracy::Tolerance(tolerance), ..fine_options() };
        let solution = solve_with(options, &robot, &case).unwrap();
        let truth = common::solve_finely(&robot, &case);
        let estimate = solution.diagnostics.discretization_error.unwrap();
        assert!(estimate <= tolerance * 0.18);
        // The estimate is of the steps; the iteration leaves its residual.
        let left = solution.diagnostics.residual * 0.18;
        assert!(left <= 1e-3 * tolerance * 0.18);
        assert!(distance(&solution, &truth) <= (estimate + left).max(1e-12), "{tolerance}");
    }
}
