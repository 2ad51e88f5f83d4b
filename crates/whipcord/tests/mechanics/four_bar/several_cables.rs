use proptest::prelude::*;
use whipcord::four_bar::{Chord, Conflicts, LengthRule, Objective, Options};
use whipcord::{Pose, Robot, Routing, Solution, SolveError, Vec3};

use super::oracle::{self, Section, gradient, non_negative_least_squares};
use super::{equal_disks, robot, solve, try_solve};

const L0: f64 = 0.02;
const A: f64 = 0.008;

fn straight(angle: f64) -> Routing {
    Routing::Straight { angle, radius: A }
}

fn hole(robot: &Robot, cable: usize, disk: usize) -> Vec3 {
    robot.routes()[cable].at(robot.disks().arc_lengths[disk]).offset
}

fn rotation_vectors(solution: &Solution) -> Vec<Vec3> {
    let steps = solution.disks.poses.windows(2);
    steps.map(|pair| (pair[0].inverse() * pair[1]).rotation.log()).collect()
}

/// Checks from outside that the sum of the measures is stationary with non-negative multipliers
/// of the cables that are as long as prescribed; `targets` by group of sections and cable.
fn check_stationary(robot: &Robot, options: &Options, solution: &Solution, targets: &[Vec<f64>]) {
    let s = &robot.disks().arc_lengths;
    let cables = robot.cables().len();
    let ws = rotation_vectors(solution);
    let group = ws.len() / targets.len();
    for (g, targets) in targets.iter().enumerate() {
        let sections = g * group..(g + 1) * group;
        let section = |k: usize, i: usize| Section {
            length: s[k + 1] - s[k],
            from: hole(robot, i, k),
            to: hole(robot, i, k + 1),
            chord: options.chord,
            objective: options.objective,
            rest: Vec3::ZERO,
        };
        let (mut force, mut arms) = (Vec::new(), vec![Vec::new(); cables]);
        let mut lengths = vec![0.0; cables];
        for k in sections {
            let measure = |w: Vec3| {
                let sum: f64 = (0..cables).map(|i| section(k, i).measure(w)).sum();
                let weight = match options.objective {
                    Objective::StrainEnergy => s[s.len() - 1] / (s[k + 1] - s[k]),
                    _ => 1.0,
                };
                weight * sum / cables as f64
            };
            force.extend(gradient(measure, ws[k]).to_array());
            for i in 0..cables {
                lengths[i] += section(k, i).cable(ws[k]);
                arms[i].extend(gradient(|w| section(k, i).cable(w), ws[k]).to_array());
            }
        }
        let mut binding = Vec::new();
        for i in 0..cables {
            assert!(lengths[i] <= targets[i] + 1e-8, "cable {i} is too long");
            if lengths[i] >= targets[i] - 1e-8 {
                binding.push(arms[i].clone());
            }
        }
        let scale = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let rest = non_negative_least_squares(&binding, &force);
        assert!(rest <= 1e-6 * scale + 1e-9, "rest {rest:e} of {scale:e}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Lengths that some pose has, some of them with play.
    #[test]
    fn the_conditions_of_a_minimum_hold(
        count in 2_usize..6,
        angles in prop::collection::vec(-3.1_f64..3.1, 6),
        turns in prop::collection::vec(-0.8_f64..0.8, 6),
        radii in prop::collection::vec(0.003_f64..0.01, 12),
        play in prop::collection::vec(prop_oneof![Just(0.0), 0.0_f64..0.003], 6),
        bend in 0.0_f64..1.0,
        plane in -3.1_f64..3.1,
        twist in -0.3_f64..0.3,
        strain: bool,
        arc: bool,
    ) {
        let chord = if arc { Chord::Arc } else { Chord::Bisector };
        let objective = if strain { Objective::StrainEnergy } else { Objective::CouplerAngle };
        let routings = (0..count).map(|i| {
            let at = |r: f64, a: f64| [r * a.cos(), r * a.sin()];
            let (start, end) = (at(radii[i], angles[i]), at(radii[6 + i], angles[i] + turns[i]));
            Routing::Linear { start, end }
        });
        let robot = robot(&[0.0, L0], routings.collect());
        let w = Vec3::new(bend * plane.cos(), bend * plane.sin(), twist);
        let Pose { position, rotation } = oracle::pose(L0, chord, w);
        let mut targets = Vec::new();
        let mut pulls = Vec::new();
        for i in 0..count {
            let (from, to) = (hole(&robot, i, 0), hole(&robot, i, 1));
            let target = (position + rotation.rotate(to) - from).norm() + play[i];
            targets.push(target);
            pulls.push((to - from + Vec3::Z * L0).norm() - target);
        }
        let options = Options { objective, chord, ..Options::default() };
        // An arc's chord shrinks whichever way it bends. Cables on all sides of it that are to be
        // shorter may then need a bend that does not grow out of the straight shape, from where
        // they contradict each other.
        let solution = match try_solve(&robot, &options, &pulls) {
            Ok(solution) if arc && solution.diagnostics.residual > 1e-6 => return Ok(()),
            Err(SolveError::CablesConflict { .. }) if arc => return Ok(()),
            other => other.unwrap(),
        };
        let residual = solution.diagnostics.residual;
        // Lengths of as many cables as coordinates, or more, may be close to dependent.
        let most = if count > 2 { 1e-7 } else { 1e-12 };
        prop_assert!(residual < most, "{residual:e}");
        for (cable, &target) in solution.cables.iter().zip(&targets) {
            prop_assert_eq!(cable.slack, cable.length < target - 1e-10 * target);
            if cable.slack {
                prop_assert!(cable.tension.is_none_or(|tension| tension.abs() < 1e-6));
            }
        }
        check_stationary(&robot, &options, &solution, &[targets]);
    }

    #[test]
    fn the_conditions_of_a_minimum_hold_over_all_sections(
        angle in -3.1_f64..3.1,
        turns in -0.5_f64..0.5,
        pulls in prop::collection::vec(0.0_f64..0.008, 2),
        strain: bool,
        free: bool,
    ) {
        let objective = if strain { Objective::StrainEnergy } else { Objective::CouplerAngle };
        let lengths = if free { LengthRule::Free } else { LengthRule::Proportional };
        let helix = |k: f64| Routing::Helix { start_angle: angle + k, turns, radius: A };
        let robot = robot(&[0.0, 0.02, 0.035, 0.06], vec![helix(0.0), helix(1.7)]);
        let options = Options { objective, lengths, ..Options::default() };
        let solution = solve(&robot, &options, &pulls);
        let initial: Vec<f64> = solution.cables.iter().map(|c| c.initial_length).collect();
        let targets = if free {
            vec![vec![initial[0] - pulls[0], initial[1] - pulls[1]]]
        } else {
            let s = &robot.disks().arc_lengths;
            let share = |k: usize, i: usize| {
                let run = hole(&robot, i, k + 1) - hole(&robot, i, k) + Vec3::Z * (s[k + 1] - s[k]);
                run.norm() * (1.0 - pulls[i] / initial[i])
            };
            (0..3).map(|k| vec![share(k, 0), share(k, 1)]).collect()
        };
        check_stationary(&robot, &options, &solution, &targets);
    }
}

#[test]
fn two_straight_cables_at_right_angles_add_up() {
    // ℓ = l₀ − 2 p·a, so p is read off the two shortenings.
    let robot =
        robot(&equal_disks(0.06, 3), vec![straight(0.0), straight(0.5 * std::f64::consts::PI)]);
    for &lengths in LengthRule::ALL {
        let solution = solve(&robot, &Options { lengths, ..Options::default() }, &[0.006, 0.009]);
        for w in rotation_vectors(&solution) {
            let p = (0.002_f64.hypot(0.003)) / (2.0 * A);
            let axis = Vec3::new(-0.003, 0.002, 0.0);
            let expected = axis * (2.0 * p.asin() / axis.norm());
            assert!((w - expected).max_abs() < 1e-10, "{lengths} {w:?} {expected:?}");
        }
    }
}

#[test]
fn antagonists_bend_one_way_and_the_other_is_slack_or_in_the_way() {
    use std::f64::consts::PI;
    let robot = robot(&equal_disks(0.06, 3), vec![straight(0.0), straight(PI)]);
    let options = Options { objective: Objective::StrainEnergy, ..Options::default() };
    let loose = solve(&robot, &options, &[0.003, -0.004]);
    assert!(!loose.cables[0].slack && loose.cables[1].slack);
    assert_eq!(loose.cables[1].tension, Some(0.0));
    // A slack cable's path is what the bend makes of it.
    assert!((loose.cables[1].length - 0.063).abs() < 1e-13);
    let taut = solve(&robot, &options, &[0.003, -0.003]);
    assert!(!taut.cables[0].slack && !taut.cables[1].slack);
    assert!(loose.disks.distances(&taut.disks).all(|d| d < 1e-11));
}

#[test]
fn small_conflicts_of_sections_are_met_half_way_and_others_are_errors() {
    use std::f64::consts::PI;
    let robot = robot(&equal_disks(0.06, 3), vec![straight(0.0), straight(PI)]);
    for &lengths in LengthRule::ALL {
        let options = Options { objective: Objective::StrainEnergy, lengths, ..Options::default() };
        if lengths == LengthRule::Free {
            // The whole length is what was asked for: what misses it is no answer.
            let error = try_solve(&robot, &options, &[0.0030, -0.0028]).unwrap_err();
            let SolveError::CablesConflict { excess, .. } = error else { panic!("{error}") };
            assert!((excess - 0.0001).abs() < 1e-7, "{excess}");
            // Unless a compromise is asked for.
            let options = Options { conflicts: Conflicts::Compromise, ..options.clone() };
            let solution = try_solve(&robot, &options, &[0.0030, -0.0028]).unwrap();
            for (cable, shortening) in solution.cables.iter().zip([0.0030, -0.0028]) {
                let excess = cable.length - (cable.initial_length - shortening);
                assert!((excess - 0.0001).abs() < 1e-7, "{excess}");
            }
            continue;
        }
        let solution = solve(&robot, &options, &[0.0030, -0.0028]);
        // Both are too long by half of what they lack.
        let expected = 0.5 * (0.0030 + 0.0028);
        for w in rotation_vectors(&solution) {
            assert!((w.y - 2.0 * f64::asin(expected / 3.0 / (2.0 * A))).abs() < 1e-6, "{w:?}");
            assert!(w.x.abs() < 1e-6 && w.z.abs() < 1e-6);
        }
        let residual = 0.0001 / 3.0 / 0.06;
        assert!((solution.diagnostics.residual - residual).abs() < 1e-3 * residual);
        assert!(solution.cables.iter().all(|c| c.tension.is_none() && !c.slack));
        let error = try_solve(&robot, &options, &[0.003, 0.003]).unwrap_err();
        match error {
            SolveError::CablesConflict { first_disk: 1, last_disk, excess, .. } => {
                assert_eq!(last_disk, 2);
                assert!((excess - 0.001).abs() < 1e-6, "{excess}");
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn three_and_six_cables_take_the_lengths_of_a_common_bend() {
    use std::f64::consts::PI;
    for count in [3, 6] {
        let angles: Vec<f64> =
            (0..count).map(|i| 2.0 * PI * f64::from(i) / f64::from(count)).collect();
        let robot = robot(&equal_disks(0.18, 9), angles.iter().map(|&a| straight(a)).collect());
        let (p, plane) = (0.25_f64, 0.4_f64);
        let pulls: Vec<f64> =
            angles.iter().map(|a| 9.0 * 2.0 * A * p * (a - plane).cos()).collect();
        for &lengths in LengthRule::ALL {
            let solution = solve(&robot, &Options { lengths, ..Options::default() }, &pulls);
            for w in rotation_vectors(&solution) {
                let expected = Vec3::new(-plane.sin(), plane.cos(), 0.0) * (2.0 * p.asin());
                assert!((w - expected).max_abs() < 1e-9, "{count} {lengths} {w:?}");
            }
            assert!(solution.cables.iter().all(|c| !c.slack));
        }
    }
}

#[test]
fn cables_that_end_midway_act_up_to_their_last_disk() {
    // Two segments of three cables each; the inner ones end half-way.
    let hole_lists = [vec![1; 4], vec![5; 4], vec![9; 4], vec![3; 7], vec![7; 7], vec![11; 7]];
    let robot = robot(&equal_disks(0.12, 6), hole_lists.into_iter().map(Routing::holes).collect());
    let solution = solve(&robot, &Options::default(), &[-0.01, 0.004, -0.01, -0.02, 0.006, -0.02]);
    let ws = rotation_vectors(&solution);
    // The outer part bends away from cable 4 alone.
    for w in &ws[3..] {
        let bend = 2.0 * f64::asin(0.001 / (2.0 * A));
        assert!((w.norm() - bend).abs() < 1e-11, "{w:?}");
    }
    assert!((ws[0] - ws[2]).max_abs() < 1e-9);
    assert!(ws[0].norm() > 1e-2 && (ws[0] - ws[3]).max_abs() > 1e-3);
}
