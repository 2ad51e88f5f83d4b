//! Where loads are so weak that there is one equilibrium, eq. (16) of the page on the rod: against Euler's load, and against what is found
//! from wrenches at the base that have nothing to do with the answer.

use crate::common::{Wildness, ball, bending_stiffness, robot, samples};
use whipcord::cosserat::Options;
use whipcord::{
    Backbone, CableCommand, Case, InternalState, Loads, Model, PointLoad, Prepared, Robot,
    Shortening, Solution, StabilityAnalysis, Stiffness, Vec3, Wrench,
};

fn prepared(robot: &Robot, loads: &Loads, stability: StabilityAnalysis) -> Prepared {
    Model::Cosserat(Options { stability, ..Options::default() }).prepare(robot, loads).unwrap()
}

fn has_one(robot: &Robot, case: &Case) -> bool {
    let mut prepared = prepared(robot, &case.loads, StabilityAnalysis::Verdict);
    prepared.has_one_equilibrium(case, &[]).unwrap()
}

/// Length 1, `K_bt` = 1, `K_se` = 10⁶.
fn column() -> Robot {
    let stiffness = Stiffness::diagonal([1e6, 1e6], 1e6, [1.0, 1.0], 1.0);
    let backbone = Backbone { stiffness: Some(stiffness), ..Backbone::new(1.0) };
    Robot::new(backbone, whipcord::Disks::equally_spaced(1.0, 11, 0.01), vec![]).unwrap()
}

#[test]
fn a_column_has_one_equilibrium_up_to_nine_tenths_of_eulers_load() {
    let under = |force: Vec3| {
        let loads = Loads { tip_force: force, ..Loads::default() };
        has_one(&column(), &Case { loads, ..Case::default() })
    };
    let eulers = core::f64::consts::PI.powi(2) / 4.0;
    for direction in [Vec3::Z, Vec3::Z * -1.0, Vec3::new(0.6, 0.0, 0.8)] {
        // The worst of each step counts: with ten steps somewhat less than 93 %.
        assert!(under(direction * (0.8 * eulers)));
        assert!(!under(direction * (0.93 * eulers)));
    }
}

#[test]
fn nothing_is_said_of_followers() {
    let weak = 1e-6;
    let case = |loads| Case { loads, ..Case::default() };
    let tip = Loads { tip_force: Vec3::X * weak, tip_follower: true, ..Loads::default() };
    let point = PointLoad { at: 0.5, force: Vec3::X * weak, moment: Vec3::ZERO, follower: true };
    let along = Loads { points: vec![point], ..Loads::default() };
    for loads in [tip, along] {
        assert!(!has_one(&column(), &case(loads)));
    }
    assert!(has_one(&column(), &case(Loads::default())));
}

/// (16) counts a dead moment from the base to where it acts.
#[test]
fn a_dead_moment_counts_between_the_base_and_where_it_acts() {
    let at = |at: f64, moment: f64| {
        let point = PointLoad { at, force: Vec3::ZERO, moment: Vec3::Z * moment, follower: false };
        let loads = Loads { points: vec![point], ..Loads::default() };
        has_one(&column(), &Case { loads, ..Case::default() })
    };
    // y′ = −m²/4 − y² with y = m/2 where it acts has a solution as far as m a/2 < π/4 from there.
    let greatest = core::f64::consts::FRAC_PI_2;
    assert!(at(1.0, 0.85 * greatest) && !at(1.0, greatest));
    assert!(at(0.5, 1.7 * greatest) && !at(0.5, 2.0 * greatest));
}

const WILD: Wildness = Wildness { cables: 6, tension: 0.8, force: 1.5, moment: 0.5, weight: 1.0 };

fn without_moments(case: &mut Case) {
    case.loads.points.clear();
    case.loads.tip_moment = Vec3::ZERO;
}

#[test]
fn what_has_one_equilibrium_is_stable_and_found_from_anywhere() {
    is_found_from_anywhere(without_moments);
}

/// Moments have no energy: that a shape is stable is then more than that it is the only one.
#[test]
fn what_has_one_equilibrium_under_dead_moments_is_stable_and_found_from_anywhere() {
    is_found_from_anywhere(|case| {
        case.loads.points.iter_mut().for_each(|point| point.follower = false);
        case.loads.tip_follower = false;
    });
}

fn is_found_from_anywhere(change: impl Fn(&mut Case)) {
    let (mut shown, mut found) = (0, 0);
    for (robot, mut case) in samples(robot(WILD), 400) {
        change(&mut case);
        if !has_one(&robot, &case) {
            continue;
        }
        shown += 1;
        let mut prepared = prepared(&robot, &case.loads, StabilityAnalysis::Eigenvalue);
        let Ok(answer) = prepared.solve(&case, None) else { continue };
        assert!(answer.diagnostics.stability.unwrap() > 0.0);
        assert_eq!(answer.diagnostics.stability_lost_at, None);
        let length = robot.backbone().length;
        let unit = bending_stiffness(&robot) / length;
        for (moment, force) in samples((ball(), ball()), 10) {
            let wrench =
                Wrench { force: force * (5.0 * unit / length), moment: moment * (8.0 * unit) };
            let afar = Solution {
                base_wrench: Some(wrench),
                internal: InternalState::default(),
                ..answer.clone()
            };
            let Ok(other) = prepared.solve(&case, Some(&afar)) else { continue };
            found += 1;
            let off = (other.disks.tip().position - answer.disks.tip().position).norm();
            assert!(off < 1e-5 * length, "{off}");
        }
    }
    println!("{shown} of 400 robots, {found} answers from afar");
    assert!(shown >= 100 && found >= 500);
}

/// Of cables of given lengths there is one shape with tensions up to limits, wherever a solve starts from.
#[test]
fn cables_of_given_lengths_have_one_equilibrium_within_limits() {
    is_one_within_limits(without_moments);
}

#[test]
fn cables_of_given_lengths_have_one_equilibrium_within_limits_under_dead_moments() {
    is_one_within_limits(|case| {
        case.loads.points.iter_mut().for_each(|point| point.follower = false);
        case.loads.tip_follower = false;
    });
}

fn is_one_within_limits(change: impl Fn(&mut Case)) {
    let (mut shown, mut found) = (0, 0);
    for (robot, mut case) in samples(robot(WILD), 200) {
        change(&mut case);
        let mut prepared = prepared(&robot, &case.loads, StabilityAnalysis::Verdict);
        let Ok(answer) = prepared.solve(&case, None) else { continue };
        let shortening = |cable: &whipcord::CableState| CableCommand {
            tension: None,
            shortening: Some(Shortening::Length(cable.initial_length - cable.length)),
        };
        let commands: Vec<_> = answer.cables.iter().map(shortening).collect();
        let case = Case { commands, ..case };
        assert!(robot.cables().is_empty() || !prepared.has_one_equilibrium(&case, &[]).unwrap());
        let tensions = answer.cables.iter().filter_map(|cable| cable.tension);
        let greatest = 2.0 * tensions.fold(1e-3, f64::max);
        let limits = vec![greatest; robot.cables().len()];
        if !prepared.has_one_equilibrium(&case, &limits).unwrap() {
            continue;
        }
        let Ok(answer) = prepared.solve(&case, None) else { continue };
        shown += 1;
        let length = robot.backbone().length;
        let unit = bending_stiffness(&robot) / length;
        for (moment, force) in samples((ball(), ball()), 5) {
            let wrench =
                Wrench { force: force * (5.0 * unit / length), moment: moment * (8.0 * unit) };
            let mut afar = Solution {
                base_wrench: Some(wrench),
                internal: InternalState::default(),
                ..answer.clone()
            };
            afar.cables.iter_mut().for_each(|cable| cable.tension = Some(0.3 * greatest));
            let Ok(other) = prepared.solve(&case, Some(&afar)) else { continue };
            let is_within = |of: &Solution| {
                of.cables.iter().all(|cable| cable.tension.is_none_or(|t| t <= greatest))
            };
            if is_within(&answer) && is_within(&other) {
                found += 1;
                let off = (other.disks.tip().position - answer.disks.tip().position).norm();
                assert!(off < 1e-4 * length, "{off}");
            }
        }
    }
    println!("{shown} of 200 robots, {found} answers from afar");
    assert!(shown >= 40 && found >= 100);
}
