//! Sections of an arc or of rigid bodies among obstacles.

use super::{
    LENGTH, STIFFNESS, among, assert_clear, assert_forces_hold, finger, moved, sphere, wall,
};
use whipcord::{
    Actuation, Backbone, Cable, Case, Contact, LoadFrame, Loads, Model, ModelKind, Obstacle, Part,
    PointLoad, Pose, Robot, Routing, Shortening, Solution, SolveError, StabilityAnalysis, Stations,
    UnitQuaternion, Vec3,
};

const PCC: ModelKind = ModelKind::PiecewiseConstantCurvature;
const PRB: ModelKind = ModelKind::PseudoRigidBody;
const KINDS: [ModelKind; 2] = [PCC, PRB];

fn solve_from(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    from: Option<&Solution>,
) -> Result<Solution, SolveError> {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.prepare(robot, &case.loads)?.solve(case, from)
}

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    solve_from(kind, robot, case, None).unwrap_or_else(|error| panic!("{kind}: {error}"))
}

fn ball() -> Obstacle {
    sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)
}

fn rubbing(obstacle: Obstacle, friction: f64) -> Obstacle {
    Obstacle { friction, ..obstacle }
}

fn only(solution: &Solution) -> Contact {
    assert_eq!(solution.contacts.len(), 1, "{:?}", solution.contacts);
    solution.contacts[0]
}

/// The finger with a mass and with these cables.
fn heavy(cables: Vec<Cable>) -> Robot {
    let bare = finger(9);
    let mut backbone = bare.backbone().clone();
    backbone.material.density = Some(1040.0);
    Robot::new(backbone, bare.disks().clone(), cables).unwrap()
}

/// As [`super::cosserat::a_wall_holds_a_slender_rod_back_as_a_beam_says`], from the deflection without the wall: what the
/// coefficients of rigid bodies are off by is a large part of what the wall takes back.
#[test]
fn a_wall_holds_a_slender_chain_back_as_a_beam_says() {
    let robot = finger(9);
    for kind in KINDS {
        for (tension, part) in [(0.05, 0.7), (0.05, 0.9), (0.02, 0.5)] {
            let alone = solve(kind, &robot, &Case::with_tensions(&[tension]));
            let free = alone.disks.tip().position.x;
            let held = part * free;
            let case = among(Case::with_tensions(&[tension]), vec![wall(held + 0.01)]);
            let touch = only(&solve(kind, &robot, &case));
            assert_eq!((touch.part, touch.obstacle), (Part::Disk(9), 0));
            let force = 3.0 * STIFFNESS / LENGTH.powi(3) * (free - held);
            let found = touch.force.unwrap();
            assert!((found / force - 1.0).abs() < 0.02, "{kind}: {found} N, {force} N");
            assert!((touch.point.x - held - 0.01).abs() < 1e-9 * LENGTH);
        }
    }
}

/// What pushes the robot is in equilibrium with its base, and the robot under these forces as point loads
/// has the shape that was found. Nothing overlaps, and friction keeps to its cone.
#[test]
fn contacts_hold_the_shape_and_do_not_overlap() {
    let robot = finger(9);
    let mut stuck = [0; 2];
    for (kind, stuck) in KINDS.into_iter().zip(&mut stuck) {
        for (tension, obstacle, friction) in [
            (3.0, wall(0.05), 0.0),
            (3.0, sphere(Vec3::new(0.05, 0.0, 0.12), 0.03), 0.0),
            (3.0, ball(), 0.0),
            (5.0, ball(), 0.0),
            (3.0, wall(0.05), 0.3),
            (3.0, wall(0.05), 3.0),
            (3.0, ball(), 0.8),
            (3.0, ball(), 2.0),
        ] {
            let obstacle = rubbing(obstacle, friction);
            let case = among(Case::with_tensions(&[tension]), vec![obstacle.clone()]);
            let solution = solve(kind, &robot, &case);
            assert!(!solution.contacts.is_empty());
            for touch in &solution.contacts {
                let (force, drag) = (touch.force.unwrap(), touch.friction.unwrap());
                assert!(force > 0.0 && touch.gap.abs() <= 1e-8 * LENGTH, "{touch:?}");
                assert!(drag.dot(touch.normal).abs() < 1e-9 * force);
                let part = if friction > 0.0 { drag.norm() / (friction * force) } else { 0.0 };
                let is_lawful = friction == 0.0 && drag == Vec3::ZERO
                    || touch.sticks && part < 1.0
                    || !touch.sticks && (part - 1.0).abs() < 1e-6;
                assert!(is_lawful, "{kind}: {part} {touch:?}");
                *stuck += usize::from(touch.sticks);
            }
            assert_forces_hold(kind, &robot, &case, &solution);
            assert_clear(&robot, &solution, &obstacle);
        }
    }
    assert!(stuck.iter().all(|&stuck| stuck > 0), "{stuck:?}");
}

/// Several cables, loads between disks, a load that turns with the robot, and cables at their lengths.
#[test]
fn cables_at_their_lengths_and_loads_between_disks_hold_the_shape() {
    let cables = [0.0, 120.0, 240.0].map(|degrees: f64| {
        let routing =
            Routing::Helix { start_angle: degrees.to_radians(), turns: 0.2, radius: 0.008 };
        Cable::new(format!("{degrees}"), routing)
    });
    let robot = heavy(cables.into());
    for kind in KINDS {
        for (follower, by_length) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut case = Case::with_tensions(&[3.0, 0.5, 0.8]);
            case.loads.gravity = Some(Vec3::new(0.0, 2.0, 0.0));
            let force = Vec3::new(0.02, 0.01, -0.01);
            let point = PointLoad { at: 0.095, force, follower, ..PointLoad::default() };
            case.loads.points.push(point);
            if by_length {
                let free = solve(kind, &robot, &case);
                for (command, cable) in case.commands.iter_mut().zip(&free.cables).take(2) {
                    let shortening = Shortening::Length(cable.initial_length - cable.length);
                    (command.tension, command.shortening) = (None, Some(shortening));
                }
            }
            let obstacle = sphere(Vec3::new(0.045, -0.01, 0.12), 0.02);
            let case = among(case, vec![obstacle.clone()]);
            let solution = solve(kind, &robot, &case);
            let what = format!("{kind} {follower} {by_length}");
            assert!(!solution.contacts.is_empty(), "{what}");
            assert_clear(&robot, &solution, &obstacle);
            for (command, cable) in case.commands.iter().zip(&solution.cables) {
                if let Some(shortening) = command.shortening {
                    let wanted = cable.initial_length - shortening.in_metres(cable.initial_length);
                    let loose = wanted - cable.length;
                    let is_met =
                        if cable.slack { loose > 0.0 } else { loose.abs() < 1e-9 * LENGTH };
                    assert!(
                        is_met && (cable.slack == (cable.tension == Some(0.0))),
                        "{what} {cable:?}"
                    );
                }
            }
            // The chain under the forces found.
            let (pushes, _) = super::pushes_of(&solution);
            let mut alone = Case { obstacles: vec![], ..case.clone() };
            alone.loads.points.extend(pushes.points);
            let again = solve_from(kind, &robot, &alone, Some(&solution)).unwrap();
            let apart = again.disks.distances(&solution.disks).fold(0.0, f64::max);
            assert!(apart < 1e-6 * LENGTH, "{what}: {apart}");
            for (a, b) in again.cables.iter().zip(&solution.cables) {
                assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-5, "{a:?} {b:?}");
            }
        }
    }
}

/// A cable that is paid out hangs loose beside a wall.
#[test]
fn a_cable_that_is_paid_out_is_slack() {
    let bare = finger(9);
    let other = Cable::new("other", Routing::Straight { angle: 1.5, radius: 0.008 });
    let cables = vec![bare.cables()[0].clone(), other];
    let robot = Robot::new(bare.backbone().clone(), bare.disks().clone(), cables).unwrap();
    for kind in KINDS {
        let case = Case::with_shortenings(&[Shortening::Length(0.008), Shortening::Length(-0.002)]);
        let solution = solve(kind, &robot, &among(case, vec![wall(0.05)]));
        assert!(!solution.contacts.is_empty());
        let [pulled, loose] = &solution.cables[..] else { panic!("{:?}", solution.cables) };
        assert!(loose.slack && loose.tension == Some(0.0) && loose.length < LENGTH + 0.002);
        assert!(!pulled.slack && (pulled.length - LENGTH + 0.008).abs() < 1e-9);
    }
}

#[test]
fn moving_base_and_obstacles_moves_the_answer() {
    let robot = heavy(finger(9).cables().to_vec());
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    for kind in KINDS {
        let gravity = Vec3::new(0.0, 3.0, -6.0);
        let mut case = among(Case::with_tensions(&[3.0]), vec![ball()]);
        case.loads.gravity = Some(gravity);
        case.loads.frame = LoadFrame::World;
        let here = solve(kind, &robot, &case);
        (case.base, case.obstacles) = (base, vec![moved(&ball(), &base)]);
        case.loads.gravity = Some(base.rotation.rotate(gravity));
        let there = solve(kind, &robot, &case);
        assert!(!here.contacts.is_empty());
        for (a, b) in here.disks.poses.iter().zip(&there.disks.poses) {
            assert!((base.transform(a.position) - b.position).norm() < 1e-8 * LENGTH);
        }
        for (a, b) in here.contacts.iter().zip(&there.contacts) {
            assert!((base.transform(a.point) - b.point).norm() < 1e-8 * LENGTH);
            assert!((a.force.unwrap() - b.force.unwrap()).abs() < 1e-7);
        }
    }
}

/// A step from a known answer keeps its contacts and gives what a solve from rest does.
#[test]
fn a_warm_start_keeps_the_contacts() {
    let robot = finger(9);
    let case = |tension: f64| among(Case::with_tensions(&[tension]), vec![ball()]);
    for kind in KINDS {
        let before = solve(kind, &robot, &case(2.8));
        let warm = solve_from(kind, &robot, &case(3.0), Some(&before)).unwrap();
        let cold = solve(kind, &robot, &case(3.0));
        let [warm_steps, cold_steps] = [&warm, &cold].map(|s| s.diagnostics.iterations);
        assert!(2 * warm_steps < cold_steps, "{kind}: {warm_steps} {cold_steps}");
        assert_eq!(warm.contacts.len(), cold.contacts.len());
        let apart = warm.disks.distances(&cold.disks).fold(0.0, f64::max);
        assert!(apart < 1e-7 * LENGTH, "{kind}: {apart}");
    }
}

/// Solved once more from its answer a case has the same answer, with the same friction: it is known where the robot was,
/// also where its disks alone do not tell.
#[test]
fn the_answer_to_the_same_case_stays() {
    let robot = finger(4);
    for kind in KINDS {
        for friction in [0.0, 0.3, 3.0] {
            let case = among(Case::with_tensions(&[2.5]), vec![rubbing(wall(0.05), friction)]);
            let answer = solve(kind, &robot, &case);
            let again = solve_from(kind, &robot, &case, Some(&answer)).unwrap();
            let [a, b] = [&answer, &again].map(only);
            assert!((a.friction.unwrap() - b.friction.unwrap()).norm() < 1e-6 * a.force.unwrap());
            assert!((a.point - b.point).norm() < 1e-8 * LENGTH, "{kind} {friction} {a:?} {b:?}");
            let apart = again.disks.distances(&answer.disks).fold(0.0, f64::max);
            assert!(apart < 1e-8 * LENGTH, "{kind} {friction}: {apart:e}");
        }
    }
}

/// Pressed against the middle of a ball the finger slips off sideways.
#[test]
fn a_finger_slips_off_the_middle_of_a_ball() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    let case = among(Case::with_tensions(&[3.3]), vec![ball.clone()]);
    for kind in KINDS {
        let solution = solve(kind, &robot, &case);
        let lost_at = solution.diagnostics.stability_lost_at;
        assert!(lost_at.is_some_and(|at| at > 0.5 && at < 1.0), "{kind}: {lost_at:?}");
        let aside = solution.disks.tip().position.y;
        assert!(aside.abs() > 0.05 * LENGTH, "{kind}: {aside}");
        assert_clear(&robot, &solution, &ball);
    }
}

/// A robot that keeps clear is solved without obstacles, to the last bit, its stability included.
#[test]
fn what_touches_nothing_is_solved_alone() {
    let robot = finger(9);
    let far = sphere(Vec3::new(-0.1, 0.0, 0.1), 0.03);
    let tip = Loads { tip_force: Vec3::new(0.05, 0.02, 0.0), ..Loads::default() };
    for free in [
        Case::with_tensions(&[2.0]),
        Case { loads: tip, ..Case::with_tensions(&[1.0]) },
        Case::with_shortenings(&[Shortening::Length(0.005)]),
    ] {
        for kind in KINDS {
            let model = Model::new(kind, Stations::Equal(31), Actuation::Natural)
                .with_stability(StabilityAnalysis::Eigenvalue);
            let [alone, among_far] =
                [free.clone(), among(free.clone(), vec![far.clone()])].map(|case| {
                    let mut prepared = model.prepare(&robot, &case.loads).unwrap();
                    let cold = prepared.solve(&case, None).unwrap();
                    let warm = prepared.solve(&case, Some(&cold)).unwrap();
                    (cold, warm)
                });
            assert_eq!(alone, among_far);
            assert!(alone.0.diagnostics.stability.is_some());
        }
    }
}

/// The tip of a slender chain slides down a wall: as [`super::friction::the_rim_of_a_sliding_tip_bends_a_beam_back`].
#[test]
fn the_rim_of_a_sliding_tip_bends_a_chain_back() {
    let robot = finger(9);
    for kind in KINDS {
        let alone = solve(kind, &robot, &Case::with_tensions(&[0.02]));
        let free = alone.disks.tip().position.x;
        let push = |friction: f64| {
            let wall = rubbing(wall(0.5 * free + 0.01), friction);
            let touch =
                only(&solve(kind, &robot, &among(Case::with_tensions(&[0.02]), vec![wall])));
            touch.force.unwrap()
        };
        let smooth = push(0.0);
        for friction in [0.2, 0.5] {
            let expected = 1.0 / (1.0 + 1.5 * friction * 0.01 / LENGTH);
            let found = push(friction) / smooth;
            assert!((found / expected - 1.0).abs() < 2e-3, "{kind}: {found}, {expected}");
        }
    }
}

/// Pulled further and let go again, a finger that rubs along a wall is not where it was, in single solves and in the
/// steps of one case alike; after a small step back it sticks where it was.
#[test]
fn pulling_and_letting_go_differ() {
    let robot = finger(9);
    let wall = rubbing(wall(0.05), 0.3);
    let case = |tension: f64| among(Case::with_tensions(&[tension]), vec![wall.clone()]);
    for kind in KINDS {
        let pulled = solve(kind, &robot, &case(3.0));
        let more = solve_from(kind, &robot, &case(3.6), Some(&pulled)).unwrap();
        let released = solve_from(kind, &robot, &case(3.0), Some(&more)).unwrap();
        let [up, down] = [&pulled, &released].map(|solution| only(solution).friction.unwrap().z);
        assert!(up > 0.0 && down < up, "{kind}: {up} N, {down} N");
        let apart = (pulled.disks.tip().position - released.disks.tip().position).norm();
        assert!(apart > 1e-4 * LENGTH, "{kind}: {apart}");
        let steps = [3.0, 3.6].map(|tension| case(tension).commands).to_vec();
        let stepped = solve(kind, &robot, &Case { before: steps, ..case(3.0) });
        assert!(stepped.disks.distances(&released.disks).all(|apart| apart < 1e-9 * LENGTH));
        let little = solve_from(kind, &robot, &case(3.59), Some(&more)).unwrap();
        let [there, here] = [&more, &little].map(only);
        let slid = (here.point - there.point).norm();
        assert!(here.sticks && slid < 2e-4 * LENGTH, "{kind}: {slid} {here:?}");
    }
}

/// The finger of so many sections that neither stretches nor shears.
fn stiff_finger(sections: usize) -> Robot {
    let bare = finger(sections);
    let backbone = Backbone { extensible: false, shearable: false, ..bare.backbone().clone() };
    Robot::new(backbone, bare.disks().clone(), bare.cables().to_vec()).unwrap()
}

/// The difference of arcs from the rod with the same disks and cables falls with the square of the length of the sections,
/// in shape and force. Rigid bodies stay as far away as their coefficients are off.
#[test]
fn arcs_come_to_the_rod_in_contact_too() {
    for obstacle in [wall(0.05), ball(), rubbing(wall(0.05), 0.3)] {
        let difference = |kind: ModelKind, sections: usize| {
            let robot = stiff_finger(sections);
            let case = among(Case::with_tensions(&[3.0]), vec![obstacle.clone()]);
            let rod = solve(ModelKind::CosseratDisks, &robot, &case);
            let ours = solve(kind, &robot, &case);
            let total = |solution: &Solution| {
                let forces = solution.contacts.iter();
                forces.map(|t| t.normal * t.force.unwrap()).fold(Vec3::ZERO, |sum, f| sum + f)
            };
            let (force, expected) = (total(&ours), total(&rod));
            let apart = ours.disks.distances(&rod.disks).fold(0.0, f64::max);
            [apart / LENGTH, (force - expected).norm() / expected.norm()]
        };
        let [coarse, fine] = [9, 18].map(|sections| difference(PCC, sections));
        // What is the same in both would not fall.
        assert!(coarse[0] > 1e-4 && coarse[1] > 2e-3, "{coarse:?}");
        assert!((3.5..4.5).contains(&(coarse[0] / fine[0])), "{coarse:?} {fine:?}");
        assert!(coarse[1] / fine[1] > 3.5, "{coarse:?} {fine:?}");
        for sections in [9, 18] {
            let bodies = difference(PRB, sections);
            assert!(bodies[0] < 0.015 && bodies[1] < 0.04, "{bodies:?}");
        }
    }
}
