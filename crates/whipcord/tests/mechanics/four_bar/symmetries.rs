use proptest::prelude::*;
use whipcord::four_bar::{Chord, LengthRule, Objective, Options};
use whipcord::{Routing, UnitQuaternion, Vec3};

use super::{robot, solve};

const DISKS: [f64; 5] = [0.0, 0.02, 0.035, 0.06, 0.08];

fn options(objective: usize, arc: bool, rule: usize) -> Options {
    Options {
        objective: Objective::ALL[objective],
        chord: if arc { Chord::Arc } else { Chord::Bisector },
        lengths: LengthRule::ALL[rule],
        ..Options::default()
    }
}

fn helix(start_angle: f64, turns: f64) -> Routing {
    Routing::Helix { start_angle, turns, radius: 0.008 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn mirrored_and_turned_routings_mirror_and_turn_the_shape(
        angle in -3.0_f64..3.0,
        turn in -3.0_f64..3.0,
        turns in -0.5_f64..0.5,
        shortening in 0.0_f64..0.012,
        slack in -0.01_f64..0.001,
        objective in 0_usize..2,
        arc: bool,
        rule in 0_usize..3,
    ) {
        let options = options(objective, arc, rule);
        let pull = [shortening, slack];
        let shape = |sign: f64, turn: f64| {
            let routings = vec![
                helix(sign * angle + turn, sign * turns),
                helix(sign * (angle + 2.2) + turn, sign * turns),
            ];
            solve(&robot(&DISKS, routings), &options, &pull)
        };
        let plain = shape(1.0, 0.0);
        let mirrored = shape(-1.0, 0.0);
        let turned = shape(1.0, turn);
        let rotation = UnitQuaternion::exp(Vec3::Z * turn);
        for i in 0..DISKS.len() {
            let Vec3 { x, y, z } = plain.disks.poses[i].position;
            let error = mirrored.disks.poses[i].position - Vec3::new(x, -y, z);
            prop_assert!(error.max_abs() < 1e-9, "{error:?}");
            let error = turned.disks.poses[i].position - rotation.rotate(Vec3::new(x, y, z));
            prop_assert!(error.max_abs() < 1e-9, "{error:?}");
        }
        for i in 0..2 {
            prop_assert!((plain.cables[i].length - turned.cables[i].length).abs() < 1e-10);
            prop_assert_eq!(plain.cables[i].slack, mirrored.cables[i].slack);
        }
    }

    #[test]
    fn the_order_of_the_cables_does_not_matter(
        pulls in prop::collection::vec(-0.004_f64..0.004, 3),
        turns in -0.4_f64..0.4,
        objective in 0_usize..2,
        rule in 0_usize..3,
    ) {
        let options = options(objective, false, rule);
        let angle = |i: usize| 0.3 + 2.0 * std::f64::consts::PI * i as f64 / 3.0;
        let run = |order: [usize; 3]| {
            let routings = order.iter().map(|&i| helix(angle(i), turns)).collect();
            let pulls: Vec<f64> = order.iter().map(|&i| pulls[i] - 0.002).collect();
            super::try_solve(&robot(&DISKS, routings), &options, &pulls)
        };
        let (a, b) = (run([0, 1, 2]), run([2, 0, 1]));
        prop_assert_eq!(a.is_ok(), b.is_ok());
        if let (Ok(a), Ok(b)) = (a, b) {
            for distance in a.disks.distances(&b.disks) {
                // A compromise between conflicting lengths is approached, not reached.
                prop_assert!(distance < 1e-7, "{distance:e}");
            }
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                prop_assert!((a.cables[i].length - b.cables[j].length).abs() < 1e-7);
            }
        }
    }
}

#[test]
fn a_second_slack_cable_changes_nothing_in_the_strain_energy() {
    let options = options(1, false, 0);
    let alone = solve(&robot(&DISKS, vec![helix(0.0, 0.3)]), &options, &[0.006]);
    let routings = vec![helix(3.0, 0.3), helix(0.0, 0.3)];
    let both = solve(&robot(&DISKS, routings), &options, &[-0.02, 0.006]);
    assert!(both.cables[0].slack && both.cables[0].tension == Some(0.0) && !both.cables[1].slack);
    assert!(alone.disks.distances(&both.disks).all(|d| d < 1e-10));
    let (a, b) = (alone.cables[0].tension.unwrap(), both.cables[1].tension.unwrap());
    assert!((a - b).abs() < 1e-7 * a, "{a} {b}");
}

#[test]
fn answers_do_not_depend_on_what_was_solved_before() {
    use whipcord::four_bar::{FourBar, Workspace};
    use whipcord::{Case, Shortening};
    let robot = robot(&DISKS, vec![helix(0.0, 0.3), helix(2.0, 0.3)]);
    let case =
        |a: f64, b: f64| Case::with_shortenings(&[Shortening::Length(a), Shortening::Length(b)]);
    for &lengths in LengthRule::ALL {
        let model = FourBar::new(&robot, &Options { lengths, ..Options::default() }).unwrap();
        let fresh = model.solve(&case(0.004, 0.002), None, &mut Workspace::default()).unwrap();
        let mut workspace = Workspace::default();
        let other = model.solve(&case(-0.001, 0.008), None, &mut workspace).unwrap();
        let again = model.solve(&case(0.004, 0.002), Some(&other), &mut workspace).unwrap();
        assert_eq!(fresh, again);
    }
}
