//! Derivatives by the prescribed lengths against differences of fourth order of answers.

use proptest::prelude::*;
use whipcord::four_bar::{Chord, Derivatives, FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{Case, Robot, Routing, Shape, Shortening, Solution, SolveError, Stations, Vec3};

use super::pre_bent::bent;
use super::{equal_disks, robot};

fn case(shortenings: &[f64]) -> Case {
    let given: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
    Case::with_shortenings(&given)
}

fn differentiate(
    robot: &Robot,
    options: &Options,
    shortenings: &[f64],
) -> Result<(Solution, Derivatives), SolveError> {
    let model = FourBar::new(robot, options)?;
    model.solve_with_derivatives(&case(shortenings), &mut Workspace::default())
}

/// What all the tests compare: velocity and angular velocity of each pose of the shape by a cable, and the
/// change of each length, by `(8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h`.
struct Differences {
    motions: Vec<[Vec3; 2]>,
    lengths: Vec<f64>,
}

fn differences(
    robot: &Robot,
    options: &Options,
    shortenings: &[f64],
    cable: usize,
    h: f64,
) -> Result<Differences, SolveError> {
    let model = FourBar::new(robot, options)?;
    let at = |step: f64| {
        let mut moved = shortenings.to_vec();
        moved[cable] += step * h;
        model.solve(&case(&moved), None, &mut Workspace::default())
    };
    let middle = at(0.0)?;
    let ends = [(at(1.0)?, at(-1.0)?, 8.0 / 12.0), (at(2.0)?, at(-2.0)?, -1.0 / 12.0)];
    let motion = |k: usize| {
        let rest = middle.shape.poses[k].rotation.conjugate();
        let mut sum = [Vec3::ZERO; 2];
        for (ahead, behind, weight) in &ends {
            let (a, b) = (&ahead.shape.poses[k], &behind.shape.poses[k]);
            // Vectors of rotation from the middle, whose differences are odd in h.
            let turn = |r: whipcord::UnitQuaternion| (r * rest).log();
            sum[0] += (a.position - b.position) * (weight / h);
            sum[1] += (turn(a.rotation) - turn(b.rotation)) * (weight / h);
        }
        sum
    };
    let length = |i: usize| {
        let change = |(a, b, w): &(Solution, Solution, f64)| {
            (a.cables[i].length - b.cables[i].length) * w / h
        };
        ends.iter().map(change).sum()
    };
    Ok(Differences {
        motions: (0..middle.shape.poses.len()).map(motion).collect(),
        lengths: (0..middle.cables.len()).map(length).collect(),
    })
}

/// The largest difference, relative to the largest motion by any cable: the differences of an answer that changes much with one cable are as
/// uncertain by the others.
fn error(exact: &Derivatives, by: usize, found: &Differences) -> f64 {
    let mut worst = [0.0_f64; 3];
    // What a slack cable moves: nothing.
    let mut size = [1.0, 10.0, 1.0_f64];
    for (k, [linear, angular]) in found.motions.iter().enumerate() {
        let twist = exact.station(k)[by];
        worst[0] = worst[0].max((twist.linear - *linear).norm());
        worst[1] = worst[1].max((twist.angular - *angular).norm());
        for twist in exact.station(k) {
            size[0] = size[0].max(twist.linear.norm());
            size[1] = size[1].max(twist.angular.norm());
        }
    }
    for (i, &length) in found.lengths.iter().enumerate() {
        worst[2] = worst[2].max((exact.length(i)[by] - length).abs());
        size[2] = exact.length(i).iter().fold(size[2], |size, of| size.max(of.abs()));
    }
    (0..3).map(|kind| worst[kind] / size[kind]).fold(0.0, f64::max)
}

fn options(rule: u8, strain: bool, arc: bool) -> Options {
    Options {
        objective: if strain { Objective::StrainEnergy } else { Objective::CouplerAngle },
        chord: if arc { Chord::Arc } else { Chord::Bisector },
        lengths: [LengthRule::Proportional, LengthRule::Equal, LengthRule::Free][usize::from(rule)],
        stations: Stations::Equal(12),
        ..Options::default()
    }
}

/// A cable that winds round the backbone, and ends early where it is the second.
fn winding(start: f64, turns: f64, radius: f64) -> Routing {
    Routing::Helix { start_angle: start, turns, radius }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn by_one_cable(
        start in -3.0_f64..3.0,
        turns in -0.6_f64..0.6,
        part in 0.0_f64..0.06,
        curved in prop::option::of([-4.0_f64..4.0, -4.0_f64..4.0, -3.0_f64..3.0]),
        rule in 0_u8..3,
        strain: bool,
        arc: bool,
    ) {
        let straight = robot(&equal_disks(0.18, 6), vec![winding(start, turns, 0.007)]);
        let robot = bent(&straight, Vec3::from(curved.unwrap_or_default()).into());
        let options = options(rule, strain, arc);
        // Away from the straight shape, where shorter and longer differ.
        let shortening = 0.002 + 0.18 * part;
        let (_, exact) = differentiate(&robot, &options, &[shortening]).unwrap();
        let found = differences(&robot, &options, &[shortening], 0, 4e-5).unwrap();
        let error = error(&exact, 0, &found);
        prop_assert!(error < 1e-7, "{error:e}");
        prop_assert!((exact.length(0)[0] + 1.0).abs() < 1e-10);
    }

    #[test]
    fn by_several_cables(
        start in -3.0_f64..3.0,
        apart in 1.2_f64..2.2,
        turns in [-0.5_f64..0.5, -0.5_f64..0.5, -0.5_f64..0.5],
        pulled in [0.01_f64..0.03, 0.005_f64..0.02],
        loose in -0.03_f64..-0.02,
        rule in 0_u8..3,
        strain: bool,
        arc: bool,
    ) {
        let cables = turns.iter().zip(0..).map(|(&turns, i)| {
            winding(start + apart * f64::from(i), turns, 0.007)
        });
        let robot = robot(&equal_disks(0.18, 6), cables.collect());
        let options = options(rule, strain, arc);
        let shortenings = [0.18 * pulled[0], 0.18 * pulled[1], 0.18 * loose];
        let Ok((_, exact)) = differentiate(&robot, &options, &shortenings) else {
            // Lengths that cannot be had, or not together.
            return Ok(());
        };
        for cable in 0..3 {
            // Where a cable gets slack or taut in a section within the step, a narrower one tells.
            let told = [(2e-5, 1e-7), (5e-6, 1e-6), (5e-7, 1e-5), (1e-8, 1e-4)].into_iter().find(|&(h, limit)| {
                let found = differences(&robot, &options, &shortenings, cable, h);
                found.is_ok_and(|found| error(&exact, cable, &found) < limit)
            });
            prop_assert!(told.is_some(), "cable {cable}");
        }
    }
}

/// `φ = 2 asin(s/2na)` in each of n sections.
#[test]
fn a_straight_cable_bends_as_the_closed_form_says() {
    let (n, radius, shortening) = (6_u32, 0.008, 0.009);
    let robot = robot(&equal_disks(0.18, 6), vec![Routing::Straight { angle: 0.0, radius }]);
    let (solution, exact) = differentiate(&robot, &Options::default(), &[shortening]).unwrap();
    let sine = shortening / (2.0 * f64::from(n) * radius);
    let bend = 2.0 / (2.0 * f64::from(n) * radius) / (1.0 - sine * sine).sqrt();
    for (k, pose) in solution.disks.poses.iter().enumerate() {
        let motion = exact.disk(k)[0];
        assert!((motion.angular - Vec3::new(0.0, bend * k as f64, 0.0)).norm() < 1e-9 * bend);
        assert!(pose.position.y.abs() < 1e-15 && motion.linear.y.abs() < 1e-12);
    }
}

/// Three cables at 120° whose lengths can be had move together: the motion by one of them is what is left when the
/// part that lengthens or shortens all alike is taken off.
#[test]
fn of_dependent_cables_the_part_counts_that_can_be_had() {
    let third = core::f64::consts::TAU / 3.0;
    let straight = |i: u32| Routing::Straight { angle: third * f64::from(i), radius: 0.008 };
    let robot = robot(&equal_disks(0.18, 6), (0..3).map(straight).collect());
    let turned = |angle: f64| [0.0, 1.0, 2.0].map(|i| 0.004 * f64::cos(angle - third * i));
    let options = Options { stations: Stations::Disks, ..Options::default() };
    for angle in [0.3, 1.9, 4.0] {
        let (solution, exact) = differentiate(&robot, &options, &turned(angle)).unwrap();
        // The tip turns about the base's axis as the lengths go round.
        let rate: Vec<f64> = [0.0, 1.0, 2.0].map(|i| -0.004 * f64::sin(angle - third * i)).to_vec();
        let tip = exact.disk(6);
        let velocity =
            tip.iter().zip(&rate).fold(Vec3::ZERO, |sum, (twist, rate)| sum + twist.linear * *rate);
        let position = solution.disks.tip().position;
        assert!((velocity - Vec3::Z.cross(position)).norm() < 1e-9, "{velocity:?}");
        let all = tip.iter().fold(Vec3::ZERO, |sum, twist| sum + twist.linear);
        assert!(all.norm() < 1e-9 * tip[0].linear.norm(), "{all:?}");
    }
}

#[test]
fn a_slack_cable_changes_nothing_and_is_changed() {
    let angle = core::f64::consts::PI;
    let both = [0.0, angle].map(|angle| Routing::Straight { angle, radius: 0.008 });
    let robot = robot(&equal_disks(0.18, 6), both.to_vec());
    let (_, exact) = differentiate(&robot, &Options::default(), &[0.006, -0.02]).unwrap();
    let tip = exact.disk(6);
    assert_eq!(tip[1].linear, Vec3::ZERO);
    assert!((exact.length(1)[0] - 1.0).abs() < 1e-12 && exact.length(1)[1] == 0.0);
}

/// The frame is that of the shape, whatever the base.
#[test]
fn motions_turn_with_the_base() {
    let robot = robot(&equal_disks(0.18, 6), vec![winding(0.4, 0.3, 0.007)]);
    let model = FourBar::new(&robot, &Options::default()).unwrap();
    let plain = case(&[0.006]);
    let rotation = whipcord::UnitQuaternion::exp(Vec3::new(0.3, -0.5, 0.9));
    let base = whipcord::Pose { position: Vec3::new(1.0, 2.0, 3.0), rotation };
    let turned = Case { base, ..plain.clone() };
    let tip = |case: &Case| {
        model.solve_with_derivatives(case, &mut Workspace::default()).unwrap().1.disk(6)[0]
    };
    let (here, there) = (tip(&plain), tip(&turned));
    assert!((rotation.rotate(here.linear) - there.linear).norm() < 1e-12);
    assert!((rotation.rotate(here.angular) - there.angular).norm() < 1e-10);
}

#[test]
fn what_has_no_derivatives_is_said() {
    let both = [0.0, core::f64::consts::PI].map(|angle| Routing::Straight { angle, radius: 0.008 });
    let two = robot(&equal_disks(0.18, 6), both.to_vec());
    let refused = |robot: &Robot, options: &Options, shortenings: &[f64]| {
        differentiate(robot, options, shortenings).unwrap_err().to_string()
    };
    let conflict = refused(&two, &Options::default(), &[0.001, 0.001]);
    assert!(conflict.contains("contradict"), "{conflict}");
    let one = robot(&equal_disks(0.18, 6), vec![winding(0.0, 0.2, 0.007)]);
    let printed = Options { objective: Objective::AsPrinted, ..Options::default() };
    let printed = refused(&one, &printed, &[0.001]);
    assert!(printed.contains("as-printed"), "{printed}");
}

/// A robot at rest moves by what is pulled.
#[test]
fn from_rest_a_cable_is_pulled() {
    let robot = robot(&equal_disks(0.18, 6), vec![winding(0.4, 0.3, 0.007)]);
    let (_, exact) = differentiate(&robot, &Options::default(), &[0.0]).unwrap();
    let model = FourBar::new(&robot, &Options::default()).unwrap();
    let tip = |s: f64| -> Shape {
        model.solve(&case(&[s]), None, &mut Workspace::default()).unwrap().disks
    };
    let h = 1e-5;
    let [a, b, c] = [0.0, h, 2.0 * h].map(|s| tip(s).tip().position);
    let ahead = (b * 4.0 - a * 3.0 - c) / (2.0 * h);
    let motion = exact.disk(6)[0].linear;
    assert!((motion - ahead).norm() < 1e-5 * motion.norm(), "{motion:?} {ahead:?}");
}
