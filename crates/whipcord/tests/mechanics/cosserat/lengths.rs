//! The Cosserat model driven by cable lengths.

use crate::common;
use crate::common::accurate;
use crate::common::{
    Wildness, config, distance, helix, lengths_of, paper_robot, robot, samples, solve,
    solve_lengths, solve_with, straight, tensions,
};
use proptest::prelude::*;
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Interpolation, Loads, Robot, Routing,
    Shortening, Solution, SolveError, Stations, Vec3,
};

const CASES: u32 = if cfg!(debug_assertions) { 24 } else { 96 };

fn with_cables(cables: usize, wild: Wildness) -> impl Strategy<Value = (Robot, Case)> {
    robot(Wildness { cables, ..wild })
}

fn by_length(metres: f64) -> CableCommand {
    CableCommand { tension: None, shortening: Some(Shortening::Length(metres)) }
}

/// Largest relative difference; tensions below a thousandth of the largest count as that.
fn tension_error(a: &[f64], b: &[f64]) -> f64 {
    let least = 1e-3 * a.iter().copied().fold(0.0, f64::max);
    a.iter().zip(b).map(|(x, y)| (x - y).abs() / x.max(least)).fold(0.0, f64::max)
}

fn length_error(a: &Solution, b: &Solution) -> f64 {
    a.cables.iter().zip(&b.cables).map(|(a, b)| (a.length - b.length).abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(config(CASES))]

    #[test]
    fn the_lengths_of_an_answer_return_its_tensions(
        (robot, case) in prop_oneof![
            with_cables(2, Wildness::UNLOADED),
            with_cables(2, Wildness::LOADED),
        ]
    ) {
        let pulled = solve(&robot, &case);
        let shortened = solve_lengths(&robot, &lengths_of(&pulled, &case.loads)).unwrap();
        let error = tension_error(&tensions(&pulled), &tensions(&shortened));
        prop_assert!(error < 1e-8, "off by {error:.1e}");
    }

    /// Many cables may not determine their tensions, but they determine the shape.
    #[test]
    fn the_lengths_of_an_answer_return_its_shape((robot, case) in with_cables(6, Wildness::UNLOADED)) {
        let pulled = solve(&robot, &case);
        let shortened = solve_lengths(&robot, &lengths_of(&pulled, &case.loads)).unwrap();
        let length = robot.backbone().length;
        prop_assert!(distance(&pulled, &shortened) < 1e-11 * length);
        prop_assert!(length_error(&pulled, &shortened) < 1e-12 * length);
        prop_assert!(tensions(&shortened).iter().all(|&t| t >= 0.0));
    }

    #[test]
    fn a_cable_that_is_too_long_hangs_slack_and_changes_nothing(
        (robot, case) in prop_oneof![
            with_cables(3, Wildness::UNLOADED),
            with_cables(3, Wildness::LOADED),
        ],
        more in 0.001..0.1_f64,
    ) {
        let mut pulled = case.clone();
        pulled.commands[0].tension = Some(0.0);
        let pulled = solve(&robot, &pulled);
        let mut longer = lengths_of(&pulled, &case.loads);
        let length = robot.backbone().length;
        let first = &pulled.cables[0];
        longer.commands[0] = by_length(first.initial_length - first.length - more * length);
        let answer = solve_lengths(&robot, &longer).unwrap();
        let loose = &answer.cables[0];
        prop_assert!(loose.slack);
        prop_assert_eq!(loose.tension, Some(0.0));
        // The length is that of the path, not of the cable.
        prop_assert!((loose.length - first.length).abs() < 1e-9 * length);
        prop_assert!(distance(&pulled, &answer) < 1e-9 * length);
        prop_assert!(answer.cables[1..].iter().all(|c| !c.slack));
    }

    #[test]
    fn cables_at_their_initial_length_leave_the_rod_at_rest((robot, _) in with_cables(4, Wildness::UNLOADED)) {
        let count = robot.cables().len();
        let solve = |case: &Case| solve_lengths(&robot, case).unwrap();
        let same = solve(&Case::with_shortenings(&vec![Shortening::Length(0.0); count]));
        let longer = solve(&Case::with_shortenings(&vec![Shortening::Fraction(-0.01); count]));
        let rest = common::solve(&robot, &Case::with_tensions(&vec![0.0; count]));
        let length = robot.backbone().length;
        prop_assert!(distance(&same, &rest) < 1e-12 * length);
        prop_assert!(distance(&longer, &rest) < 1e-12 * length);
        prop_assert!(longer.cables.iter().all(|c| c.slack && c.tension == Some(0.0)));
        prop_assert!(same.cables.iter().all(|c| !c.slack));
    }

    #[test]
    fn how_far_one_cable_goes_is_told_truly(
        (robot, case) in with_cables(2, Wildness::UNLOADED),
        fraction in 0.6..1.0_f64,
    ) {
        // The others keep their tensions.
        let mut asked = case.clone();
        asked.commands[0] =
            CableCommand { tension: None, shortening: Some(Shortening::Fraction(fraction)) };
        match solve_with(accurate(), &robot, &asked) {
            Ok(solution) => {
                let cable = &solution.cables[0];
                let left = cable.length - (1.0 - fraction) * cable.initial_length;
                prop_assert!(left.abs() < 1e-12 || cable.slack);
            }
            Err(SolveError::UnreachableLength { cable, requested, reachable }) => {
                prop_assert_eq!(cable, "cable 0");
                prop_assert!(reachable < requested);
                let reach = |factor: f64| {
                    let mut case = asked.clone();
                    case.commands[0] = by_length(factor * reachable);
                    solve_with(accurate(), &robot, &case)
                };
                prop_assert!(reach(0.99).is_ok(), "{:?}", reach(0.99));
                prop_assert!(reach(1.02).is_err(), "goes farther than {reachable}");
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }
}

/// Robots whose cables depend on one another so nearly that a projected Newton step climbs, found
/// among 25,000.
#[test]
fn cables_that_all_but_depend_on_one_another_settle() {
    let seeds: &[usize] = if cfg!(debug_assertions) { &[439] } else { &[439, 18678] };
    let last = seeds[seeds.len() - 1];
    for (n, (robot, case)) in samples(robot(Wildness::UNLOADED), last + 1).enumerate() {
        if seeds.contains(&n) {
            let options = |actuation| Options {
                stations: Stations::Equal(11),
                accuracy: Accuracy::Steps(24),
                actuation,
                ..accurate()
            };
            let pulled = solve_with(options(Actuation::Tension), &robot, &case).unwrap();
            let asked = lengths_of(&pulled, &case.loads);
            let shortened = solve_with(options(Actuation::Shortening), &robot, &asked).unwrap();
            assert!(distance(&pulled, &shortened) < 1e-10 * robot.backbone().length, "{n}");
        }
    }
}

/// One cable on the paper's robot asked for nearly all of its length: the error says how far it goes.
#[test]
fn a_cable_asked_for_nearly_all_of_its_length_is_unreachable() {
    let holes = Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]);
    let pchip = Routing::Holes {
        holes: vec![10, 10, 10, 10, 10, 10, 11, 12, 1, 2],
        interpolation: Interpolation::Pchip,
    };
    let linear = Routing::Linear { start: [0.008, 0.0], end: [0.003, 0.002] };
    for (name, routing) in [
        ("straight", straight(30.0)),
        ("helix", helix(0.0, 0.75)),
        ("steep helix", helix(0.0, 4.0)),
        ("linear", linear),
        ("holes", holes),
        ("pchip", pchip),
    ] {
        let robot = paper_robot(vec![routing]);
        let at = |shortening| solve_lengths(&robot, &Case::with_shortenings(&[shortening]));
        let Err(SolveError::UnreachableLength { cable, requested, reachable }) =
            at(Shortening::Fraction(1.0))
        else {
            panic!("{name}: {:?}", at(Shortening::Fraction(1.0)));
        };
        assert_eq!(cable, "cable 0");
        let initial = at(Shortening::Length(0.0)).unwrap().cables[0].initial_length;
        assert!((requested - initial).abs() < 1e-12);
        assert!(reachable > 0.5 * initial && reachable < requested, "{name}: {reachable}");
        let near = at(Shortening::Length(0.999 * reachable));
        assert!(near.is_ok(), "{name}: {near:?}");
        if 1.01 * reachable < initial {
            let beyond = at(Shortening::Length(1.01 * reachable));
            assert!(matches!(beyond, Err(SolveError::UnreachableLength { .. })), "{name}");
        }
    }
}

#[test]
fn of_two_cables_on_one_route_the_shorter_one_carries_all() {
    let robot = paper_robot(vec![helix(10.0, 0.5), helix(10.0, 0.5)]);
    let alone = paper_robot(vec![helix(10.0, 0.5)]);
    let one = solve_lengths(&alone, &Case::with_shortenings(&[Shortening::Length(0.006)])).unwrap();
    let both = [Shortening::Length(0.004), Shortening::Length(0.006)];
    let two = solve_lengths(&robot, &Case::with_shortenings(&both)).unwrap();
    assert!(distance(&one, &two) < 1e-12);
    assert!(two.cables[0].slack && !two.cables[1].slack);
    assert_eq!(two.cables[0].tension, Some(0.0));
    assert!(tension_error(&tensions(&one), &[two.cables[1].tension.unwrap()]) < 1e-9);
}

#[test]
fn a_case_may_give_lengths_of_some_cables_and_tensions_of_others() {
    let robot = paper_robot(vec![helix(10.0, 0.5), straight(200.0), straight(90.0)]);
    let mut case = Case::with_tensions(&[3.0, 1.0, 2.0]);
    case.loads.tip_force = Vec3::new(0.03, -0.02, 0.01);
    for loads in [case.loads.clone(), Loads::default()] {
        let case = Case { loads, ..case.clone() };
        let pulled = solve(&robot, &case);
        let mut mixed = case.clone();
        let cable = &pulled.cables[1];
        mixed.commands[1] = by_length(cable.initial_length - cable.length);
        let options = Options { stations: Stations::Equal(11), ..accurate() };
        let answer = solve_with(options, &robot, &mixed).unwrap();
        assert!(tension_error(&tensions(&pulled), &tensions(&answer)) < 1e-8);
        assert!(distance(&pulled, &answer) < 1e-10);
    }
}

#[test]
fn a_fraction_is_of_the_cables_own_initial_length() {
    let robot = paper_robot(vec![helix(10.0, 2.0)]);
    let at = |s| solve_lengths(&robot, &Case::with_shortenings(&[s])).unwrap();
    let fraction = at(Shortening::Fraction(0.057));
    let cable = &fraction.cables[0];
    let around = core::f64::consts::TAU * 2.0 * 0.008;
    assert!((cable.initial_length - around.hypot(0.18)).abs() < 1e-15);
    assert!((cable.length / cable.initial_length - 0.943).abs() < 1e-12);
    let length = at(Shortening::Length(0.057 * cable.initial_length));
    assert!(distance(&fraction, &length) < 1e-13);
}

/// Straight cables at these angles on the paper's rod, which does not stretch.
fn inextensible(angles: &[f64], axial_stiffness: Option<f64>) -> Robot {
    let backbone = Backbone { extensible: false, ..common::paper_backbone() };
    let cable = |&angle: &f64| Cable {
        axial_stiffness,
        ..Cable::new(format!("at {angle}°"), straight(angle))
    };
    Robot::new(backbone, common::paper_disks(), angles.iter().map(cable).collect()).unwrap()
}

fn shortened(lengths: &[f64], tip_force: Vec3) -> Case {
    let lengths: Vec<_> = lengths.iter().map(|&s| Shortening::Length(s)).collect();
    let loads = Loads { tip_force, ..Loads::default() };
    Case { loads, ..Case::with_shortenings(&lengths) }
}

/// Two straight cables opposite one another on a rod that does not stretch, at lengths that fit exactly:
/// their common tension does nothing. The one pulls alone, as if the other were not there.
#[test]
fn a_pair_that_fits_exactly_pulls_no_more_than_it_must() {
    let (pair, alone) = (inextensible(&[0.0, 180.0], None), inextensible(&[0.0], None));
    for shortening in [1e-3, 0.013_37] {
        let both =
            solve_lengths(&pair, &shortened(&[shortening, -shortening], Vec3::ZERO)).unwrap();
        let one = solve_lengths(&alone, &shortened(&[shortening], Vec3::ZERO)).unwrap();
        assert!(both.diagnostics.iterations <= 4, "{:?}", both.diagnostics);
        assert_eq!(tensions(&both)[1], 0.0);
        assert!((tensions(&both)[0] / tensions(&one)[0] - 1.0).abs() < 1e-9);
        assert!(distance(&both, &one) < 1e-9 * pair.backbone().length);
    }
}

/// Under load, too: as without those that pull least, and nearly as cables of steel.
#[test]
fn loaded_cables_that_fit_exactly_pull_no_more_than_they_must() {
    let s = 0.013_37;
    let three = [0.0, 120.0, 240.0];
    for (angles, lengths) in [
        (&[0.0, 180.0][..], &[s, -s][..]),
        (&[0.0, 180.0], &[0.0, 0.0]),
        (&three, &[s, -0.5 * s, -0.5 * s]),
        (&three, &[0.01, -0.003, -0.007]),
        (&[0.0, 90.0, 180.0, 270.0], &[0.01, 0.004, -0.01, -0.004]),
    ] {
        let robot = inextensible(angles, None);
        let forces = [-0.05 * Vec3::X, 1e-3 * Vec3::X, 0.05 * Vec3::X, 1e-6 * Vec3::X];
        let tried = if cfg!(debug_assertions) { 2 } else { 4 };
        for force in forces.into_iter().take(tried) {
            let found = solve_lengths(&robot, &shortened(lengths, force)).unwrap();
            let steel = inextensible(angles, Some(1e4));
            let elastic = solve_lengths(&steel, &shortened(lengths, force)).unwrap();
            let all: f64 = tensions(&found).iter().sum();
            for (a, b) in tensions(&found).iter().zip(tensions(&elastic)) {
                // Those stretch by up to 1 % of what they are shortened by.
                let (found, elastic) = (tensions(&found), tensions(&elastic));
                assert!((a - b).abs() < 0.02 * all, "{force:?}: {found:?} {elastic:?}");
            }
            // No more cables pull than there are directions to bend in.
            let pulls: Vec<usize> =
                (0..angles.len()).filter(|&i| tensions(&found)[i] > 0.0).collect();
            assert!(pulls.len() <= 2, "{:?}", tensions(&found));
            let of = |values: &[f64]| -> Vec<f64> { pulls.iter().map(|&i| values[i]).collect() };
            let few = inextensible(&of(angles), None);
            let alone = solve_lengths(&few, &shortened(&of(lengths), force)).unwrap();
            assert!(distance(&found, &alone) < 1e-8 * 0.18, "{force:?}");
        }
    }
}

/// A load that twists the robot lengthens all of its straight cables: without stretch they cannot have their
/// lengths together, and their play does not suffice.
#[test]
fn cables_that_do_not_fit_under_the_load_are_named() {
    let robot = inextensible(&[0.0, 120.0, 240.0], None);
    let case = shortened(&[0.013_37, -0.006_685, -0.006_685], Vec3::new(0.1, 0.1, 0.1));
    let refused = solve_lengths(&robot, &case);
    let Err(SolveError::ContradictoryLengths { misses }) = refused else { panic!("{refused:?}") };
    assert!(misses.iter().all(|miss| miss.excess > 1e-4 * 0.18 && miss.excess < 1e-3 * 0.18));
    // Cables that stretch share it.
    let steel = inextensible(&[0.0, 120.0, 240.0], Some(1e5));
    assert!(solve_lengths(&steel, &case).is_ok());
}

/// A rod that stretches gets shorter by what both cables of a pair are shortened by: with a force F at the tip
/// and the shortening s of both, `2τ = EA s/L + F`.
#[test]
fn a_pair_shortened_alike_compresses_the_rod() {
    let robot = paper_robot(vec![straight(0.0), straight(180.0)]);
    let stiffness = 1.1e9 * core::f64::consts::PI / 4.0 * 9e-6;
    for (shortening, force) in [(1e-3, 0.0), (1e-3, 5.0), (2e-3, -0.3), (1e-5, -0.1)] {
        let case = shortened(&[shortening, shortening], force * Vec3::Z);
        let solution = solve_lengths(&robot, &case).unwrap();
        let exact = 0.5 * (stiffness * shortening / 0.18 + force);
        for tension in tensions(&solution) {
            assert!((tension - exact).abs() < 1e-6, "{tension} {exact}");
        }
        let tip = solution.disks.tip().position;
        assert!((tip - (0.18 - shortening) * Vec3::Z).norm() < 1e-9, "{tip:?}");
    }
}
