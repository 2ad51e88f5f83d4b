//! Robots that two antagonists lock at their lengths while they touch an obstacle: on a backbone that keeps its length their lengths
//! depend on each other, so that their tensions are not determined.

use super::hole_friction::moved;
use super::*;
use crate::common::straight;
use crate::contact::{finger, sphere, wall};
use whipcord::{Backbone, Obstacle};

for_every_model!(
    loads_and_stiffness_move_a_locked_robot_in_contact,
    a_length_that_contradicts_the_other_counts_by_what_does_not,
    a_cable_that_is_about_to_become_taut_is_told
);

const TOLERANCE: f64 = 1e-5;

/// With cables that do not stretch, or that stretch a little.
fn robot(sections: usize, axial_stiffness: Option<f64>) -> Robot {
    let bare = finger(sections);
    let backbone = Backbone { extensible: false, shearable: false, ..bare.backbone().clone() };
    let cables = [("pull", 0.0), ("back", 180.0)];
    let cable = |(name, angle)| Cable { axial_stiffness, ..Cable::new(name, straight(angle)) };
    Robot::new(backbone, bare.disks().clone(), cables.map(cable).to_vec()).unwrap()
}

fn prepared(tested: Tested, robot: &Robot, case: &Case) -> Prepared {
    let options = Options {
        accuracy: Accuracy::Steps(36),
        stations: Stations::At(vec![0.03, 0.095, 0.18]),
        ..options(tested, case)
    };
    tested.prepare(robot, case, &options).unwrap()
}

/// The case in which the cables have the lengths that these tensions give them, and the answer under the tensions.
fn locked(tested: Tested, robot: &Robot, tensions: &[f64], obstacle: Obstacle) -> (Case, Solution) {
    let mut case = Case::with_tensions(tensions);
    case.obstacles = vec![obstacle];
    let pulled = prepared(tested, robot, &case).solve(&case, None).unwrap();
    let command = |(state, cable): (&whipcord::CableState, &Cable)| {
        let tension = state.tension.unwrap();
        let stretch = cable.axial_stiffness.map_or(0.0, |k| state.initial_length * tension / k);
        let shortening = state.initial_length - state.length + stretch;
        CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) }
    };
    let commands = pulled.cables.iter().zip(robot.cables()).map(command).collect();
    (Case { commands, ..case }, pulled)
}

/// Positions of the tip and of a station.
fn places(solution: &Solution) -> Vec<f64> {
    let stations = solution.shape.poses.iter();
    stations.flat_map(|pose| pose.position.to_array()).collect()
}

fn rates(change: &Change) -> Vec<f64> {
    (0..3).flat_map(|k| change.twist(Place::Station(k)).linear.to_array()).collect()
}

fn off_by(found: &[f64], expected: &[f64]) -> f64 {
    let size = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    apart.fold(0.0, f64::max) / size
}

/// Differences of a solution from this one, of one step or another.
fn off_difference(
    found: &[f64],
    step: f64,
    solve: &dyn Fn(f64) -> Result<Solution, SolveError>,
) -> Vec<f64> {
    [1.0, 0.2, 0.04, 8e-3, 1.6e-3].map(|part| off_step(found, part * step, solve)).to_vec()
}

fn off_step(found: &[f64], h: f64, solve: &dyn Fn(f64) -> Result<Solution, SolveError>) -> f64 {
    let near = [-2.0, -1.0, 1.0, 2.0].map(|k| solve(k * h).map(|solution| places(&solution)));
    let [Ok(a), Ok(b), Ok(c), Ok(d)] = near else { return f64::INFINITY };
    let rate = |i: usize| (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * h);
    off_by(found, &(0..a.len()).map(rate).collect::<Vec<f64>>())
}

#[track_caller]
fn assert_one(what: &str, off: &[f64], tolerance: f64) {
    assert!(off.iter().any(|off| *off <= tolerance), "{what}: {off:?}");
}

fn obstacles() -> [(&'static str, Obstacle); 2] {
    [("wall", wall(0.05)), ("ball", sphere(Vec3::new(0.05, 0.0, 0.12), 0.03))]
}

/// Across the plane of the cables, in which they do not lock it, and in it where the dependence leaves it free.
fn loads_and_stiffness_move_a_locked_robot_in_contact(tested: Tested) {
    for (name, obstacle) in obstacles() {
        let robot = robot(6, None);
        let (case, pulled) = locked(tested, &robot, &[3.0, 0.4], obstacle);
        let (solution, derivatives) = prepared(tested, &robot, &case)
            .solve_with_derivatives(&case, Some(&pulled), &[])
            .unwrap();
        assert!(!solution.contacts.is_empty() && !derivatives.is_contact_about_to_change());
        assert!(!derivatives.is_cable_about_to_change(), "{name}");
        for axis in 0..3 {
            let change = derivatives.wrench(Place::Tip, axis, Hold::Commands);
            let off = off_difference(&rates(&change), 1e-4, &|by| {
                let mut case = case.clone();
                case.loads.tip_force[axis] += by;
                prepared(tested, &robot, &case).solve(&case, Some(&solution))
            });
            let size = rates(&change).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            println!("{name} force {axis}: {off:?} of {size:e}, {:?}", change.tensions());
            // A robot that is locked does not move; arcs are held by their curvatures too, of which the lengths are extremal there.
            let is_extremal =
                tested == Tested::Arcs && derivatives.are_lengths_dependent(Hold::Commands);
            if size > 1e-6 && !is_extremal {
                assert_one(&format!("{name}, force {axis}"), &off, TOLERANCE);
            }
        }
    }
}

/// The robot whose cables stretch tends to it.
fn a_length_that_contradicts_the_other_counts_by_what_does_not(tested: Tested) {
    for (name, obstacle) in obstacles() {
        let solved = |axial_stiffness| {
            let robot = robot(6, axial_stiffness);
            let (case, pulled) = locked(tested, &robot, &[3.0, 0.4], obstacle.clone());
            let found = prepared(tested, &robot, &case)
                .solve_with_derivatives(&case, Some(&pulled), &[])
                .unwrap();
            (robot, case, found)
        };
        let (_, _, (_, derivatives)) = solved(None);
        println!("{name}: dependent {}", derivatives.are_lengths_dependent(Hold::Commands));
        let (robot, case, (solution, elastic)) = solved(Some(1e6));
        assert!(!elastic.are_lengths_dependent(Hold::Commands));
        for cable in 0..2 {
            let change = elastic.command(cable);
            let off = off_difference(&rates(&change), 1e-8, &|by| {
                let mut case = case.clone();
                case.commands[cable] = moved(case.commands[cable], by);
                prepared(tested, &robot, &case).solve(&case, Some(&solution))
            });
            let limit = derivatives.command(cable);
            let apart = off_by(&rates(&limit), &rates(&change));
            println!(
                "{name} command {cable}: elastic {off:?}, limit {apart:e}, {:?}",
                limit.tensions()
            );
            assert_one(&format!("{name}, command {cable}"), &off, TOLERANCE);
            if derivatives.are_lengths_dependent(Hold::Commands) && tested != Tested::Arcs {
                assert!(apart < 1e-3, "{name}, command {cable}: {apart}");
                assert!(limit.tensions().iter().all(|by| by.abs() < 1e5), "{:?}", limit.tensions());
            }
        }
    }
}

/// A cable that is as long as it would be without tension.
fn a_cable_that_is_about_to_become_taut_is_told(tested: Tested) {
    if tested == Tested::Arcs {
        // Where the lengths are extremal both cables pull.
        return;
    }
    let robot = robot(6, None);
    let (mut case, pulled) = locked(tested, &robot, &[3.0, 0.0], wall(0.05));
    let told = |case: &Case| {
        let found = prepared(tested, &robot, case).solve_with_derivatives(case, Some(&pulled), &[]);
        found.unwrap().1.is_cable_about_to_change()
    };
    assert!(told(&case));
    case.commands[1].shortening = Some(Shortening::Length(-0.02));
    assert!(!told(&case));
}
