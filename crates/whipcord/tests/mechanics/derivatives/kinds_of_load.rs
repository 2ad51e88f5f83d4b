//! Loads that turn with the robot, that are spread along it, and that are strong.

use super::{
    ROBOTS, TOLERANCE, Tested, bending_stiffness, by_length, check_parameters, check_parameters_to,
    taut,
};
use crate::common::{self, Wildness};
use whipcord::{Case, DistributedLoad, Profile, Robot, Vec3};

fn follower_loads(tested: Tested) {
    let mut failures = String::new();
    for (i, (robot, mut case)) in taut(tested, Wildness::LOADED, ROBOTS).enumerate() {
        case.loads.tip_follower = i % 2 == 0;
        case.loads.tip_force *= 0.5;
        for point in &mut case.loads.points {
            point.follower = true;
        }
        check_parameters(tested, &robot, &case, &mut failures);
        let (robot, case) = by_length(tested, &robot, &case, true);
        check_parameters(tested, &robot, &case, &mut failures);
    }
    assert!(failures.is_empty(), "{failures}");
}

/// The case with forces and moments that turn with the robot and are spread along it: on a stretch,
/// and linear along all of it; with followers at points as well, or without.
pub fn under_spread_followers(robot: &Robot, case: &Case, points: bool) -> Case {
    let mut case = under_spread_loads(robot, case, true);
    case.loads.tip_force *= 0.5;
    case.loads.tip_follower = points;
    for point in &mut case.loads.points {
        point.follower = points;
    }
    case
}

fn under_spread_loads(robot: &Robot, case: &Case, follower: bool) -> Case {
    let mut case = case.clone();
    let (length, stiffness) = (robot.backbone().length, bending_stiffness(robot));
    let (force, moment) = (stiffness / length.powi(3), stiffness / length.powi(2));
    let stretch = Profile::Constant {
        from: 0.25 * length,
        to: 0.75 * length,
        force: Vec3::new(0.6, -0.3, 0.4) * force,
        moment: Vec3::new(0.1, 0.2, -0.15) * moment,
    };
    let linear = Profile::Linear {
        at: vec![0.0, length],
        force: vec![Vec3::new(-0.2, 0.5, 0.0) * force, Vec3::new(0.3, 0.0, -0.4) * force],
        moment: vec![Vec3::new(0.1, 0.0, 0.05) * moment, Vec3::new(0.0, -0.1, 0.1) * moment],
    };
    case.loads.distributed =
        [stretch, linear].map(|profile| DistributedLoad { profile, follower }).to_vec();
    case
}

/// Dead forces and moments that are spread along the robot, and masses that it carries.
fn spread_dead_loads_and_masses(tested: Tested) {
    let mut failures = String::new();
    for (i, (robot, case)) in taut(tested, Wildness::LOADED, ROBOTS).enumerate() {
        let mut case = under_spread_loads(&robot, &case, false);
        let (length, stiffness) = (robot.backbone().length, bending_stiffness(&robot));
        case.loads.gravity = Some(Vec3::new(3.0, -9.0, 2.0));
        let mass = 0.05 * stiffness / length.powi(2) / 9.81;
        let carried = |at| whipcord::PointMass { at, mass };
        case.loads.masses = vec![carried(0.4 * length), carried(length)];
        check_parameters(tested, &robot, &case, &mut failures);
        if i % 2 == 0 {
            let (robot, case) = by_length(tested, &robot, &case, true);
            check_parameters(tested, &robot, &case, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

fn spread_follower_loads(tested: Tested) {
    let mut failures = String::new();
    for (i, (robot, case)) in taut(tested, Wildness::LOADED, ROBOTS).enumerate() {
        let case = under_spread_followers(&robot, &case, i % 2 == 0);
        check_parameters(tested, &robot, &case, &mut failures);
        let (robot, case) = by_length(tested, &robot, &case, true);
        check_parameters(tested, &robot, &case, &mut failures);
    }
    // A rod that is bent far by followers alone.
    let robot = common::paper_robot(vec![]);
    let unit = bending_stiffness(&robot) / 0.18_f64.powi(3);
    let mut case = Case::default();
    case.loads.distributed = vec![DistributedLoad {
        follower: true,
        ..DistributedLoad::uniform(0.18, Vec3::new(8.0 * unit, 3.0 * unit, 0.0))
    }];
    check_parameters(tested, &robot, &case, &mut failures);
    assert!(failures.is_empty(), "{failures}");
}

/// A rod that a single shot misses, pulled and bent by many times the load that would buckle it.
fn strong_loads(tested: Tested) {
    let mut failures = String::new();
    for force in [Vec3::new(20.0, 5.0, 150.0), Vec3::new(-60.0, 0.0, -80.0)] {
        let robot = common::paper_robot(vec![]);
        let unit = bending_stiffness(&robot) / 0.18_f64.powi(2);
        let mut case = Case::default();
        case.loads.tip_force = force * unit;
        // The gaps of the chain close to rounding of the greatest moment.
        check_parameters_to(tested, 20.0 * TOLERANCE, &robot, &case, &mut failures);
    }
    assert!(failures.is_empty(), "{failures}");
}

for_every_model!(follower_loads, spread_dead_loads_and_masses, spread_follower_loads, strong_loads);
