//! Batches: order, sizes, failing rows, threads.

use crate::common;
use core::num::NonZeroUsize;
use core::sync::atomic::{AtomicUsize, Ordering};

use whipcord::batch::{
    Arrays, Batch, BatchError, BatchOptions, Driven, Rows, Width, solve_batch, solve_batch_into,
    solve_robots,
};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Loads, Material, Model, ModelKind,
    PointLoad, Pose, Robot, Routing, Section, Shortening, Solution, SolveError, StabilityAnalysis,
    Statics, Stations, UnitQuaternion, Vec3,
};

/// The paper's rod; the first cable is that of its case III, the others turn about it.
fn robot(cables: usize) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let holes = [1, 2, 3, 4, 4, 4, 4, 3, 2, 1];
    let cable = |i: usize| {
        let turned = holes.map(|hole| (hole - 1 + 2 * i) % 12 + 1);
        // Every other cable ends before the tip.
        let reach = if i.is_multiple_of(2) { 10 } else { 6 };
        Cable::new(format!("cable {i}"), Routing::holes(turned[..reach].to_vec()))
    };
    Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap()
}

/// The same numbers in every run, between 0 and 1.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count).map(|_| next()).collect()
}

fn threads(count: usize) -> BatchOptions<'static> {
    BatchOptions { threads: NonZeroUsize::new(count), ..BatchOptions::default() }
}

fn cosserat(options: Options) -> Model {
    Model::Cosserat(options)
}

fn quick() -> Options {
    Options {
        accuracy: Accuracy::Steps(12),
        stability: StabilityAnalysis::Off,
        ..Options::default()
    }
}

fn same_as(batch: &Batch, row: usize, expected: &Result<Solution, SolveError>) {
    match (batch.row(row).unwrap(), expected) {
        (Ok(row), Ok(solution)) => {
            assert_eq!(row.positions.len(), 3 * solution.shape.poses.len());
            for (i, pose) in solution.shape.poses.iter().enumerate() {
                assert_eq!(row.position(i), pose.position.to_array());
                assert_eq!(row.orientations[4 * i..4 * i + 4], pose.rotation.wxyz());
            }
            for (i, cable) in solution.cables.iter().enumerate() {
                assert_eq!(row.tensions.map(|t| t[i]), cable.tension);
                assert_eq!(row.lengths[i], cable.length);
            }
            assert_eq!(row.diagnostics, &solution.diagnostics);
        }
        (Err(error), Err(expected)) => assert_eq!(error, expected),
        (got, expected) => panic!("row {row}: {got:?} instead of {expected:?}"),
    }
}

/// Rows that fail among others, with the numbers of the single solve, bit for bit.
#[test]
fn rows_are_single_solves_in_the_order_given() {
    for options in [
        quick(),
        Options { stability: StabilityAnalysis::Off, ..Options::default() },
        Options::default(),
    ] {
        let model = cosserat(options);
        for cables in [1, 3, 6] {
            let robot = robot(cables);
            let mut tensions: Vec<f64> = noise(83 * cables).iter().map(|x| 4.0 * x).collect();
            tensions[cables * 5] = 1e4;
            tensions[cables * 17] = 0.0;
            tensions[cables * 40] = -1.0;
            tensions[cables * 41] = f64::INFINITY;
            let under = Case::default();
            let rows = Rows::Tensions { values: &tensions, case: &under };
            let batch = solve_batch(&model, &robot, rows, &threads(2)).unwrap();
            assert_eq!(batch.len(), 83);
            let single = |row: usize| {
                let values = &tensions[row * cables..(row + 1) * cables];
                model.solve(&robot, &Case::with_tensions(values))
            };
            for row in 0..83 {
                same_as(&batch, row, &single(row));
            }
            assert!(matches!(batch.outcomes()[5], Err(SolveError::SectionFolds { .. })));
            assert!(matches!(batch.outcomes()[40], Err(SolveError::Invalid(_))));
            assert!(matches!(batch.outcomes()[41], Err(SolveError::Invalid(_))));
            let width = 30;
            // A row without an answer holds NaN everywhere, and no other row does.
            let of_row = |numbers: &[f64], width: usize, row: usize| -> Vec<bool> {
                numbers[row * width..(row + 1) * width].iter().map(|x| x.is_nan()).collect()
            };
            for row in 0..83 {
                let failed = batch.outcomes()[row].is_err();
                for (numbers, width) in [
                    (batch.positions(), width),
                    (batch.orientations(), 40),
                    (batch.tensions(), cables),
                    (batch.lengths(), cables),
                ] {
                    assert!(of_row(numbers, width, row).iter().all(|nan| *nan == failed));
                }
            }
            assert!(batch == batch.clone());
            assert_eq!(batch.outcomes().iter().filter(|o| o.is_err()).count(), 3);
        }
    }
}

/// What lanes may be asked for; eight, four and one of them where the processor has AVX-512.
const WIDTHS: [Width; 3] = [Width::Widest, Width::Avx2, Width::One];

/// Tensions of so many rows up to `most`, here and there a slack cable, and rows that fail.
fn tensions_with_failures(rows: usize, cables: usize, most: f64) -> Vec<f64> {
    let mut tensions: Vec<f64> =
        noise(rows * cables).iter().map(|x| most * (1.25 * x - 0.25).max(0.0)).collect();
    for (row, wrong) in [(3, 1e5), (rows / 2, -1.0), (rows - 2, f64::INFINITY)] {
        tensions[row * cables] = wrong;
    }
    tensions
}

#[test]
fn the_bits_do_not_depend_on_threads_or_lanes() {
    let push = Loads { tip_force: Vec3::new(0.02, 0.01, 0.0), ..Loads::default() };
    for (cables, loads, rows) in [
        (1, Loads::default(), 1000),
        (3, Loads::default(), 400),
        (3, push.clone(), 50),
        (1, push, 50),
    ] {
        let robot = robot(cables);
        let tensions = tensions_with_failures(rows, cables, 4.0 / cables as f64);
        let under = Case { loads, ..Case::default() };
        let rows = Rows::Tensions { values: &tensions, case: &under };
        let model = cosserat(Options { accuracy: Accuracy::Steps(12), ..Options::default() });
        let one = solve_batch(&model, &robot, rows, &threads(1)).unwrap();
        assert_eq!(one.outcomes().iter().filter(|outcome| outcome.is_err()).count(), 3);
        let same = |options: &BatchOptions<'_>| {
            let other = solve_batch(&model, &robot, rows, options).unwrap();
            assert!(one == other, "{cables} {:?} {:?}", options.threads, options.width);
        };
        for count in [2, 7] {
            same(&threads(count));
        }
        for width in WIDTHS {
            same(&BatchOptions { width, ..threads(2) });
        }
        same(&BatchOptions::default());
        let by_row = BatchOptions { no_lanes: true, ..threads(1) };
        if under.loads.is_none() {
            same(&by_row);
        } else {
            near(&one, &solve_batch(&model, &robot, rows, &by_row).unwrap(), 1e-9);
        }
        // A row does not hang on those beside it.
        let alone = &tensions[cables * 7..cables * 8];
        let rows = Rows::Tensions { values: alone, case: &under };
        let alone = solve_batch(&model, &robot, rows, &threads(1)).unwrap();
        assert_eq!(alone.row(0).unwrap().unwrap(), one.row(7).unwrap().unwrap());
    }
}

/// Whether both have the same answers to a part of the length, and refuse the same rows for the same reason.
fn near(one: &Batch, other: &Batch, part: f64) {
    for (a, b) in one.outcomes().iter().zip(other.outcomes()) {
        match (a, b) {
            (Ok(a), Ok(b)) => {
                assert_eq!(a.diagnostics.stable, b.diagnostics.stable);
                assert_eq!(a.diagnostics.stability_absent, b.diagnostics.stability_absent);
            }
            (Err(a), Err(b)) => assert_eq!(a, b),
            (a, b) => panic!("{a:?} instead of {b:?}"),
        }
    }
    let numbers = |batch: &Batch| -> Vec<f64> {
        [batch.positions(), batch.lengths(), batch.orientations(), batch.tensions()].concat()
    };
    let size =
        numbers(other).iter().filter(|x| x.is_finite()).fold(0.0, |a: f64, b| a.max(b.abs()));
    for (a, b) in numbers(one).iter().zip(&numbers(other)) {
        assert!((a - b).abs() <= part * size || a.is_nan() && b.is_nan(), "{a} {b}");
    }
}

/// A straight rod that is pulled along its axis is in equilibrium from the start; beside it others are not.
#[test]
fn a_row_that_is_there_at_once_has_its_own_shape() {
    let robot = robot(3);
    let loads = Loads { tip_force: Vec3::new(0.0, 0.0, 0.05), ..Loads::default() };
    let under = Case { loads, ..Case::default() };
    let tensions = [0.0, 0.0, 0.0, 0.9, 0.1, 0.4, 0.0, 0.0, 0.0, 0.2, 0.7, 0.0];
    let model = cosserat(quick());
    let solve = |values: &[f64], options: &BatchOptions<'_>| {
        solve_batch(&model, &robot, Rows::Tensions { values, case: &under }, options).unwrap()
    };
    let all = solve(&tensions, &threads(1));
    let by_row = BatchOptions { no_lanes: true, ..threads(1) };
    near(&all, &solve(&tensions, &by_row), 1e-9);
    for (row, values) in tensions.chunks(3).enumerate() {
        let alone = solve(values, &threads(1));
        assert_eq!(alone.row(0).unwrap().unwrap(), all.row(row).unwrap().unwrap());
    }
}

/// Robots under loads from weak to strong: what lanes solve is what single solves have, to the tolerance.
#[test]
fn lanes_answer_under_loads_as_single_solves_do() {
    let (mut answered, mut in_lanes) = (0, 0);
    let wild = common::Wildness { cables: 4, tension: 2.0, ..common::Wildness::UNLOADED };
    for (i, (robot, case)) in common::samples(common::robot(wild), 40).enumerate() {
        let backbone =
            Backbone { extensible: i % 5 != 0, shearable: i % 7 != 0, ..robot.backbone().clone() };
        let robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
        let most: Vec<f64> = case.commands.iter().map(|c| c.tension.unwrap()).collect();
        let cables = most.len();
        let tensions: Vec<f64> = noise(13 * cables)
            .iter()
            .enumerate()
            .map(|(k, x)| most[k % cables] * (1.2 * x * x - 0.2).max(0.0))
            .collect();
        // In units of what bends the rod by a radian.
        let length = robot.backbone().length;
        let unit = common::bending_stiffness(&robot) / (length * length);
        let strength = [0.01, 0.2, 0.8, 5.0][i % 4] * unit;
        let push = strength * Vec3::new(0.6, -0.3, [-0.7, 0.7][i % 2]);
        let moment = 0.3 * length * Vec3::new(push.y, push.z, push.x);
        let loads = match i % 3 {
            0 => Loads { tip_force: push, tip_moment: moment, ..Loads::default() },
            1 => Loads {
                points: vec![PointLoad { at: 0.4 * length, force: push, moment, follower: false }],
                tip_force: -0.5 * push,
                ..Loads::default()
            },
            _ => Loads {
                gravity: Some(Vec3::new(0.0, 3.0, -9.0)),
                masses: vec![whipcord::PointMass { at: 0.7 * length, mass: strength / 9.81 }],
                ..Loads::default()
            },
        };
        let turn = UnitQuaternion::exp(Vec3::new(0.3, -1.0, 0.2 * i as f64));
        let base = Pose { position: Vec3::new(0.1, -0.2, 0.3), rotation: turn };
        let under = Case { base, loads, ..Case::default() };
        let rows = Rows::Tensions { values: &tensions, case: &under };
        let (accuracy, part) = match i % 2 {
            0 => (Accuracy::Steps(12), 1e-9),
            _ => (Accuracy::default(), 3e-6),
        };
        let stability = [StabilityAnalysis::Off, StabilityAnalysis::Verdict][i / 2 % 2];
        let model = cosserat(Options { accuracy, stability, ..Options::default() });
        let by_row = BatchOptions { no_lanes: true, ..threads(1) };
        let slow = solve_batch(&model, &robot, rows, &by_row).unwrap();
        let wide = solve_batch(&model, &robot, rows, &threads(1)).unwrap();
        near(&wide, &slow, part);
        for width in WIDTHS {
            let other = solve_batch(&model, &robot, rows, &BatchOptions { width, ..threads(1) });
            assert!(other.unwrap() == wide, "{robot:?} {accuracy:?} {width:?}");
        }
        answered += slow.outcomes().iter().flatten().count();
        let (a, b) = (wide.positions(), slow.positions());
        let per_row = a.len() / wide.len();
        let differs = |row: usize| {
            let of = row * per_row..(row + 1) * per_row;
            a[of.clone()].iter().zip(&b[of]).any(|(a, b)| a != b && a.is_finite())
        };
        in_lanes += (0..wide.len()).filter(|&row| differs(row)).count();
    }
    assert!(answered > 400 && in_lanes > 150, "{answered} {in_lanes}");
}

/// Bends up to where the section folds, steps that turn far, rest curvature, axes that are held, slack
/// cables, a tip beyond reach of the grids at hand: what lanes leave to the scalar code must come out
/// the same.
#[test]
fn lanes_answer_as_single_solves_do_for_many_robots() {
    let mut answered = 0;
    let wild = common::Wildness { cables: 5, tension: 4.0, ..common::Wildness::UNLOADED };
    for (i, (robot, case)) in common::samples(common::robot(wild), 60).enumerate() {
        let backbone =
            Backbone { extensible: i % 5 != 0, shearable: i % 7 != 0, ..robot.backbone().clone() };
        // Along straight cables all sections may be the same, and are solved once.
        let radius = 0.03 * backbone.length;
        let cables = robot.cables().iter().enumerate().map(|(k, cable)| match i % 3 {
            0 => Cable { routing: Routing::Straight { angle: k as f64, radius }, ..cable.clone() },
            _ => cable.clone(),
        });
        let robot = Robot::new(backbone, robot.disks().clone(), cables.collect()).unwrap();
        let most: Vec<f64> = case.commands.iter().map(|c| c.tension.unwrap()).collect();
        let cables = most.len();
        // Rows that leave the last lanes empty, some of them slack.
        let tensions: Vec<f64> = noise(21 * cables)
            .iter()
            .enumerate()
            .map(|(k, x)| most[k % cables] * (1.2 * x * x - 0.2).max(0.0))
            .collect();
        let turn = UnitQuaternion::exp(Vec3::new(0.3, -1.0, 0.2 * i as f64));
        let base = Pose { position: Vec3::new(0.1, -0.2, 0.3), rotation: turn };
        // What is said to be no load is none.
        let loads = Loads { gravity: Some(Vec3::ZERO), ..Loads::default() };
        let under =
            if i % 2 == 0 { Case::default() } else { Case { base, loads, ..Case::default() } };
        let rows = Rows::Tensions { values: &tensions, case: &under };
        let accuracy = [
            Accuracy::Steps(12),
            Accuracy::Steps(1),
            Accuracy::Tolerance(1e-6),
            Accuracy::default(),
        ][i % 4];
        let model = cosserat(Options {
            accuracy,
            stability: [
                StabilityAnalysis::Off,
                StabilityAnalysis::Verdict,
                StabilityAnalysis::Eigenvalue,
            ][i % 3],
            ..Options::default()
        });
        let by_row = BatchOptions { no_lanes: true, ..threads(1) };
        let slow = solve_batch(&model, &robot, rows, &by_row).unwrap();
        for width in WIDTHS {
            let fast =
                solve_batch(&model, &robot, rows, &BatchOptions { width, ..threads(1) }).unwrap();
            assert!(fast == slow, "{robot:?} {accuracy:?} {width:?}");
        }
        answered += slow.outcomes().iter().flatten().count();
    }
    assert!(answered > 900, "{answered}");
}

/// The base that the case gives is that of all rows, with and without lanes.
#[test]
fn rows_stand_on_the_base_of_their_case() {
    let robot = robot(3);
    let model = cosserat(quick());
    let turn = UnitQuaternion::exp(Vec3::new(0.3, -1.0, 2.0));
    let base = Pose { position: Vec3::new(0.1, -0.2, 0.3), rotation: turn };
    let at_home = Case::default();
    let moved = Case { base, ..Case::default() };
    let values = [0.5, 1.0, 0.0, 0.0, 0.7, 0.2];
    for no_lanes in [false, true] {
        let options = BatchOptions { no_lanes, ..threads(1) };
        let solve = |case| {
            solve_batch(&model, &robot, Rows::Tensions { values: &values, case }, &options).unwrap()
        };
        let (home, away) = (solve(&at_home), solve(&moved));
        for row in 0..2 {
            let tip = |batch: &Batch| Vec3::from(batch.row(row).unwrap().unwrap().position(9));
            assert!((tip(&away) - base.transform(tip(&home))).norm() < 1e-15);
            let commands = Case::with_tensions(&values[3 * row..3 * row + 3]).commands;
            same_as(&away, row, &model.solve(&robot, &Case { commands, ..moved.clone() }));
        }
        assert_eq!(home.lengths(), away.lengths());
    }
    // A base that is none is what every row says.
    let nowhere =
        Case { base: Pose { position: Vec3::new(f64::NAN, 0.0, 0.0), ..base }, ..Case::default() };
    let rows = Rows::Tensions { values: &values, case: &nowhere };
    let batch = solve_batch(&model, &robot, rows, &threads(1)).unwrap();
    assert!(batch.outcomes().iter().all(|row| matches!(row, Err(SolveError::Invalid(_)))));
}

#[test]
fn a_path_is_the_same_for_any_threads_and_near_the_cold_answers() {
    let robot = robot(3);
    let model = Model::new(ModelKind::Cosserat, Stations::Equal(7), Actuation::Shortening);
    let path: Vec<f64> = (0..70)
        .flat_map(|i| {
            let t = f64::from(i) * 0.03;
            [0.003 * (1.0 + t.cos()), 0.002 * (1.0 + t.sin()), 0.004 * t.sin()]
        })
        .collect();
    let loads = Loads { tip_force: Vec3::new(0.02, 0.01, 0.0), ..Loads::default() };
    let under = Case { loads, ..Case::default() };
    let rows = Rows::Shortenings { values: &path, case: &under };
    let warm = |count| BatchOptions { warm_path: true, ..threads(count) };
    let one = solve_batch(&model, &robot, rows, &warm(1)).unwrap();
    assert!(one == solve_batch(&model, &robot, rows, &warm(2)).unwrap());
    assert!(one == solve_batch(&model, &robot, rows, &warm(7)).unwrap());
    let cold = solve_batch(&model, &robot, rows, &threads(2)).unwrap();
    assert!(cold.outcomes().iter().all(Result::is_ok));
    let apart = one.positions().iter().zip(cold.positions()).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 2e-9 * 0.18);
    let iterations = |batch: &Batch| -> usize {
        batch.outcomes().iter().flatten().map(|solved| solved.diagnostics.iterations).sum()
    };
    let (warm, cold) = (iterations(&one), iterations(&cold));
    assert!(warm <= cold, "{warm} from row to row, {cold} cold");
}

#[test]
fn loads_may_sit_anywhere_from_row_to_row() {
    let robot = robot(1);
    let case = |i: usize| Case {
        commands: vec![CableCommand {
            tension: i.is_multiple_of(2).then_some(1.5),
            shortening: Some(Shortening::Fraction(0.02)),
        }],
        loads: Loads {
            points: vec![
                PointLoad {
                    at: 0.06 + 0.03 * (i % 3) as f64,
                    force: Vec3::new(0.01 * i as f64, 0.0, 0.0),
                    ..PointLoad::default()
                };
                i % 2
            ],
            ..Loads::default()
        },
        ..Case::default()
    };
    let cases: Vec<Case> = (0..12).map(case).collect();
    let model = cosserat(Options { actuation: Actuation::Natural, ..Options::default() });
    let batch = solve_batch(&model, &robot, Rows::Cases(&cases), &threads(2)).unwrap();
    for (row, case) in cases.iter().enumerate() {
        same_as(&batch, row, &model.solve(&robot, case));
    }
}

#[test]
fn the_other_model_takes_batches() {
    let robot = robot(1);
    let model = Model::new(ModelKind::FourBar, Stations::Disks, Actuation::Natural);
    let shortenings = [0.0, 0.004, 0.5, 0.008];
    let under = Case::default();
    let rows = Rows::Shortenings { values: &shortenings, case: &under };
    let batch = solve_batch(&model, &robot, rows, &threads(2)).unwrap();
    for (row, &shortening) in shortenings.iter().enumerate() {
        let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
        same_as(&batch, row, &model.solve(&robot, &case));
    }
    assert!(batch.row(2).unwrap().is_err());
    assert!(batch.row(1).unwrap().unwrap().tensions.is_none());
    assert!(batch.row(4).is_none());
}

#[test]
fn many_robots_answer_in_order() {
    let mut robots: Vec<(Robot, Case)> = (0..40)
        .map(|i| (robot(1 + i % 3), Case::with_tensions(&vec![0.1 * i as f64; 1 + i % 3])))
        .collect();
    robots[20].1 = Case::with_tensions(&[-1.0, 0.0, 0.0]);
    let model = cosserat(Options::default());
    let one = solve_robots(&model, &robots, &threads(1)).unwrap();
    for count in [2, 7] {
        assert!(one == solve_robots(&model, &robots, &threads(count)).unwrap());
    }
    assert_eq!(one.iter().filter(|solution| solution.is_err()).count(), 1);
    for (solution, (robot, case)) in one.iter().zip(&robots) {
        assert_eq!(solution, &model.solve(robot, case));
    }
}

#[test]
fn what_is_no_batch_is_refused() {
    let under = Case::default();
    let model = cosserat(quick());
    let solve = |robot: &Robot, values: &[f64]| {
        solve_batch(&model, robot, Rows::Tensions { values, case: &under }, &threads(2))
    };
    assert!(solve(&robot(3), &[]).unwrap().is_empty());
    let error = solve(&robot(3), &[1.0; 7]).unwrap_err();
    assert_eq!(error, BatchError::Width { given: 7, count: 3, driven: Driven::Cables });
    assert_eq!(
        solve(&robot(0), &[1.0]).unwrap_err(),
        BatchError::NoCommands { driven: Driven::Cables }
    );
    let bare =
        Robot::new(Backbone::new(0.18), Disks::equally_spaced(0.18, 3, 0.01), vec![]).unwrap();
    let error =
        solve_batch(&model, &bare, Rows::Cases(&[Case::default()]), &threads(1)).unwrap_err();
    assert!(matches!(error, BatchError::Model(SolveError::Missing { .. })), "{error:?}");
}

#[test]
fn arrays_of_the_caller_are_filled_or_refused() {
    let (robot, model, under) = (robot(3), cosserat(quick()), Case::default());
    let values: Vec<f64> = noise(30).iter().map(|x| 2.0 * x).collect();
    let rows = Rows::Tensions { values: &values, case: &under };
    let batch = solve_batch(&model, &robot, rows, &threads(1)).unwrap();
    let fill = |positions: usize| {
        let mut memory = [vec![7.0; positions], vec![7.0; 400], vec![7.0; 30], vec![7.0; 30]];
        let [p, o, t, l] = &mut memory;
        let arrays = Arrays { positions: p, orientations: o, tensions: t, lengths: l };
        solve_batch_into(&model, &robot, rows, &threads(2), arrays).map(|outcomes| {
            assert_eq!(outcomes, batch.outcomes());
            memory
        })
    };
    let memory = fill(300).unwrap();
    assert_eq!(memory[0], batch.positions());
    assert_eq!(memory[1], batch.orientations());
    assert_eq!(memory[2], batch.tensions());
    assert_eq!(memory[3], batch.lengths());
    let error = fill(299).unwrap_err();
    assert_eq!(error, BatchError::Size { name: "positions", given: 299, needed: 300 });
}

#[test]
fn progress_is_told_and_can_stop() {
    let (robot, model, under) = (robot(1), cosserat(quick()), Case::default());
    let values = vec![1.0; 2000];
    let rows = Rows::Tensions { values: &values, case: &under };
    let most = AtomicUsize::new(0);
    let watch = |done: usize, rows: usize| {
        assert_eq!(rows, 2000);
        most.fetch_max(done, Ordering::Relaxed);
        true
    };
    let options = BatchOptions { progress: Some(&watch), ..threads(2) };
    solve_batch(&model, &robot, rows, &options).unwrap();
    assert_eq!(most.load(Ordering::Relaxed), 2000);
    let stop = |_: usize, _: usize| false;
    let options = BatchOptions { progress: Some(&stop), ..threads(1) };
    match solve_batch(&model, &robot, rows, &options).unwrap_err() {
        BatchError::Stopped { done, rows } => assert!(done > 0 && done < rows),
        other => panic!("{other}"),
    }
    // A row that is solved by itself may take seconds: no other begins.
    let stopped = BatchError::Stopped { done: 1, rows: 2000 };
    let alone = BatchOptions { no_lanes: true, ..options };
    assert_eq!(solve_batch(&model, &robot, rows, &alone).unwrap_err(), stopped);
    let path = BatchOptions { warm_path: true, ..options };
    assert_eq!(solve_batch(&model, &robot, rows, &path).unwrap_err(), stopped);
    let robots = vec![(robot, Case::with_tensions(&[1.0])); 20];
    let error = solve_robots(&model, &robots, &options).unwrap_err();
    assert_eq!(error, BatchError::Stopped { done: 1, rows: 20 });
}
