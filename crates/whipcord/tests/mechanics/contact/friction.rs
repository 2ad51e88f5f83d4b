//! Obstacles that rub.

use super::{LENGTH, STIFFNESS, among, assert_clear, assert_forces_hold, finger, sphere, wall};
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::four_bar::{FourBar, LengthRule, Objective};
use whipcord::{
    Actuation, Case, Contact, ModelKind, Obstacle, Robot, Shortening, Solution, SolveError, Vec3,
};

fn rubbing(obstacle: Obstacle, friction: f64) -> Obstacle {
    Obstacle { friction, ..obstacle }
}

fn solve(robot: &Robot, case: &Case, from: Option<&Solution>) -> Result<Solution, SolveError> {
    let model = Cosserat::new(robot, &case.loads, &Options::default())?;
    model.solve(case, from, &mut Workspace::default())
}

fn only(solution: &Solution) -> Contact {
    assert_eq!(solution.contacts.len(), 1, "{:?}", solution.contacts);
    solution.contacts[0]
}

/// The tip of a slender rod slides down a wall, and friction μN holds its rim, by R from the axis, back up: it
/// bends the rod by μNRL²/2EI away from the wall, so that the wall has to push less, by the factor
/// `1/(1 + 3μR/2L)`.
#[test]
fn the_rim_of_a_sliding_tip_bends_a_beam_back() {
    let robot = finger(9);
    let free = 0.02 * 0.008 * LENGTH * LENGTH / (2.0 * STIFFNESS);
    let push = |friction: f64| {
        let wall = rubbing(wall(0.5 * free + 0.01), friction);
        let solution = solve(&robot, &among(Case::with_tensions(&[0.02]), vec![wall]), None);
        let touch = only(&solution.unwrap());
        let (force, drag) = (touch.force.unwrap(), touch.friction.unwrap());
        assert!(!touch.sticks || friction == 0.0);
        assert!((drag.norm() - friction * force).abs() < 1e-7 * force, "{drag:?} of {force} N");
        assert!(friction == 0.0 || drag.z > 0.999 * drag.norm());
        force
    };
    let smooth = push(0.0);
    for friction in [0.2, 0.5] {
        let expected = 1.0 / (1.0 + 1.5 * friction * 0.01 / LENGTH);
        let found = push(friction) / smooth;
        assert!((found / expected - 1.0).abs() < 2e-3, "{found}, {expected}");
    }
}

/// What sticks stays where it touched, and friction is within its cone; the rod under the forces found is in
/// equilibrium in the shape found.
#[test]
fn forces_keep_to_the_cone_and_hold_the_shape() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.005, 0.12), 0.03);
    let mut stuck = 0;
    for (obstacle, friction) in [
        (wall(0.05), 0.3),
        (wall(0.05), 3.0),
        (ball.clone(), 0.1),
        (ball.clone(), 0.8),
        (ball, 2.0),
    ] {
        let obstacle = rubbing(obstacle, friction);
        let case = among(Case::with_tensions(&[3.0]), vec![obstacle.clone()]);
        let solution = solve(&robot, &case, None).unwrap();
        assert!(!solution.contacts.is_empty());
        for touch in &solution.contacts {
            let (force, drag) = (touch.force.unwrap(), touch.friction.unwrap());
            assert!(drag.dot(touch.normal).abs() < 1e-9 * force);
            let part = drag.norm() / (friction * force);
            assert!(if touch.sticks { part < 1.0 } else { (part - 1.0).abs() < 1e-6 }, "{touch:?}");
            stuck += usize::from(touch.sticks);
        }
        assert_forces_hold(ModelKind::Cosserat, &robot, &case, &solution);
        assert_clear(&robot, &solution, &obstacle);
    }
    assert_eq!(stuck, 1);
}

/// Pulled further and let go again, a finger that rubs along a wall is not where it was: friction turned round.
#[test]
fn pulling_and_letting_go_differ() {
    let robot = finger(9);
    let wall = rubbing(wall(0.05), 0.3);
    let case = |tension: f64| among(Case::with_tensions(&[tension]), vec![wall.clone()]);
    let pulled = solve(&robot, &case(3.0), None).unwrap();
    let more = solve(&robot, &case(3.6), Some(&pulled)).unwrap();
    let released = solve(&robot, &case(3.0), Some(&more)).unwrap();
    let [up, down] = [&pulled, &released].map(|solution| only(solution).friction.unwrap().z);
    assert!(up > 0.0 && down < up, "{up} N, {down} N");
    let apart = (pulled.disks.tip().position - released.disks.tip().position).norm();
    assert!(apart > 1e-4 * LENGTH, "{apart}");
    // A small step back does not loosen it: it sticks.
    let little = solve(&robot, &case(3.59), Some(&more)).unwrap();
    let [there, here] = [&more, &little].map(only);
    assert!(here.sticks && (here.point - there.point).norm() < 2e-4 * LENGTH, "{here:?}");
}

/// The chain of sections and the rod agree where it rubs.
#[test]
fn the_chain_rubs_as_the_rod_does() {
    let robot = finger(20);
    for friction in [0.3, 3.0] {
        let wall = rubbing(wall(0.05), friction);
        let case = among(Case::with_shortenings(&[Shortening::Length(0.012)]), vec![wall]);
        let options = Options { actuation: Actuation::Shortening, ..Options::default() };
        let model = Cosserat::new(&robot, &case.loads, &options).unwrap();
        let rod = model.solve(&case, None, &mut Workspace::default()).unwrap();
        let options = whipcord::four_bar::Options {
            objective: Objective::StrainEnergy,
            lengths: LengthRule::Free,
            ..Default::default()
        };
        let chain =
            FourBar::new(&robot, &options).unwrap().solve(&case, None, &mut Default::default());
        let chain = chain.unwrap();
        let apart = rod.disks.distances(&chain.disks).fold(0.0, f64::max);
        assert!(apart < 0.01 * LENGTH, "{apart}");
        let [a, b] = [&rod, &chain].map(only);
        assert_eq!(a.sticks, b.sticks);
        let [f, g] = [a, b].map(|touch| touch.friction.unwrap().z / touch.force.unwrap());
        assert!((f - g).abs() < 0.05 * f.abs(), "{f}, {g}");
    }
}
