//! Lists of holes against exhaustion, and planted lists that are found again.

use std::time::Instant;

use whipcord::batch::{BatchOptions, solve_robots};
use whipcord::{
    Actuation, Along, Backbone, Case, Loads, Model, ModelKind, Robot, Routing, Shortening,
    Statics as _, Stations, Vec3,
};
use whipcord_design::{
    DesignError, FixedHole, HoleRules, HoleSearchOptions, Proof, ShapeGoal, design_holes,
};

use crate::robots::{LENGTH, Random, holed, with_holes};

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

fn points(robot: &Robot, kind: ModelKind, case: &Case) -> Vec<(usize, Vec3)> {
    let solution = model(kind).solve(robot, case).unwrap();
    let poses = solution.disks.poses.iter().map(|pose| pose.position);
    poses.enumerate().skip(1).collect()
}

/// All lists of a cable.
fn all_lists(holes: usize, disks: usize) -> Vec<Vec<usize>> {
    (0..holes.pow(disks as u32))
        .map(|mut code| {
            (0..disks)
                .map(|_| {
                    let hole = code % holes;
                    code /= holes;
                    hole + 1
                })
                .collect()
        })
        .collect()
}

/// The least root mean square over lists, by solves of whole robots.
fn exhausted(robot: &Robot, goal: &ShapeGoal, lists: &[Vec<usize>]) -> f64 {
    let robots: Vec<(Robot, Case)> = lists
        .iter()
        .map(|list| (with_holes(robot, core::slice::from_ref(list)), goal.case.clone()))
        .collect();
    let solved =
        solve_robots(&model(ModelKind::CosseratDisks), &robots, &BatchOptions::default()).unwrap();
    let cost = |solution: &whipcord::Solution| {
        let square = |(disk, point): &(usize, Vec3)| {
            (solution.disks.poses[*disk].position - *point).norm().powi(2)
        };
        goal.points.iter().map(square).sum::<f64>()
    };
    let least = solved.iter().flatten().map(cost).fold(f64::INFINITY, f64::min);
    (least / goal.points.len() as f64).sqrt()
}

/// Points that no list leads through: those of a list, moved off.
fn moved_points(robot: &Robot, case: &Case, random: &mut Random) -> Vec<(usize, Vec3)> {
    let off = 0.02 * robot.backbone().length;
    points(robot, ModelKind::CosseratDisks, case)
        .into_iter()
        .map(|(disk, point)| {
            let by = Vec3::new(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
            (disk, point + by * off)
        })
        .collect()
}

#[test]
fn branch_and_bound_and_meeting_in_the_middle_equal_exhaustion() {
    let (holes, disks) = (5, 5);
    let lists = all_lists(holes, disks);
    let mut random = Random(5);
    for trial in 0..4 {
        let mut robot = holed(0.1, disks, holes, 1);
        // A backbone that is bent at rest has another shape where all holes are moved on by the same number.
        if trial == 3 {
            let rest_curvature = Along::Uniform(Vec3::new(2.0, -4.0, 1.0));
            let backbone = Backbone { rest_curvature, ..robot.backbone().clone() };
            robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
        }
        let list: Vec<usize> = (0..disks).map(|_| 1 + random.below(holes)).collect();
        let case = Case::with_tensions(&[5.0]);
        let all = moved_points(&with_holes(&robot, &[list]), &case, &mut random);
        for wanted in [all.clone(), all[disks - 2..].to_vec()] {
            let goal = ShapeGoal::new(case.clone(), wanted);
            let design = design_holes(
                &model(ModelKind::CosseratDisks),
                &robot,
                &[0],
                core::slice::from_ref(&goal),
                &HoleRules::default(),
                &HoleSearchOptions::default(),
            )
            .unwrap();
            assert_eq!(design.proof, Proof::Optimal);
            let least = exhausted(&robot, &goal, &lists);
            assert!((design.error - least).abs() < 1e-7, "{trial}: {} {least}", design.error);
        }
    }
}

#[test]
fn rules_are_kept_and_the_best_within_them_is_found() {
    let (holes, disks) = (6, 5);
    let robot = holed(0.1, disks, holes, 1);
    let case = Case::with_tensions(&[5.0]);
    let mut random = Random(8);
    let planted = with_holes(&robot, &[vec![1, 4, 2, 5, 3]]);
    let goal = ShapeGoal::new(case.clone(), moved_points(&planted, &case, &mut random));
    let rules = HoleRules {
        largest_jump: Some(1),
        fixed: vec![FixedHole { cable: 0, disk: 2, hole: 3 }],
        ..HoleRules::default()
    };
    let jump = |a: usize, b: usize| {
        let ahead = (b + holes - a) % holes;
        ahead.min(holes - ahead)
    };
    let lists: Vec<Vec<usize>> = all_lists(holes, disks)
        .into_iter()
        .filter(|list| list[2] == 3 && list.windows(2).all(|pair| jump(pair[0], pair[1]) <= 1))
        .collect();
    let goals = [goal];
    let design = design_holes(
        &model(ModelKind::CosseratDisks),
        &robot,
        &[0],
        &goals,
        &rules,
        &HoleSearchOptions::default(),
    )
    .unwrap();
    assert!(lists.contains(&design.holes[0]), "{:?}", design.holes);
    let least = exhausted(&robot, &goals[0], &lists);
    assert!((design.error - least).abs() < 1e-7, "{} {least}", design.error);
}

#[test]
fn planted_lists_are_found_by_every_model_of_straight_cables() {
    let robot = holed(LENGTH, 10, 12, 1);
    let list = vec![1, 2, 3, 4, 4, 5, 4, 3, 2, 1];
    let case = Case::with_tensions(&[3.0]);
    for kind in [
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
    ] {
        let planted = with_holes(&robot, core::slice::from_ref(&list));
        let goal = ShapeGoal::new(case.clone(), points(&planted, kind, &case));
        let design = design_holes(
            &model(kind),
            &robot,
            &[0],
            &[goal],
            &HoleRules::default(),
            &HoleSearchOptions::default(),
        )
        .unwrap();
        assert_eq!(design.proof, Proof::Optimal, "{kind}");
        assert!(design.error < 1e-6 * LENGTH, "{kind}: {}", design.error);
        // A hole on a disk where the cable runs straight on cannot be told from another only by rounding.
        assert_eq!(design.holes, core::slice::from_ref(&list), "{kind}");
    }
}

#[test]
fn two_cables_make_two_shapes() {
    let robot = holed(0.12, 6, 6, 2);
    let lists = [vec![1, 2, 3, 3, 2, 1], vec![4, 4, 5, 6, 6, 5]];
    let planted = with_holes(&robot, &lists);
    let goals: Vec<ShapeGoal> = [[4.0, 0.5], [0.5, 4.0]]
        .iter()
        .map(|tensions| {
            let case = Case::with_tensions(tensions);
            ShapeGoal::new(case.clone(), points(&planted, ModelKind::CosseratDisks, &case))
        })
        .collect();
    let rules = HoleRules { are_distinct: true, ..HoleRules::default() };
    let design = design_holes(
        &model(ModelKind::CosseratDisks),
        &robot,
        &[0, 1],
        &goals,
        &rules,
        &HoleSearchOptions::default(),
    )
    .unwrap();
    assert_eq!(design.proof, Proof::Optimal);
    assert_eq!(design.holes, lists);
    assert!(design.error < 1e-6);
}

/// Four cables with twelve holes have 10²⁵ lists: each is chosen beside the others, within the rules, and a change of any one cable by itself is not better.
#[test]
fn many_cables_are_chosen_one_by_one() {
    let robot = holed(0.12, 6, 12, 4);
    let lists = [
        vec![1, 2, 3, 3, 2, 1],
        vec![5, 5, 6, 7, 7, 6],
        vec![9, 10, 10, 9, 9, 9],
        vec![11, 12, 12, 11, 11, 11],
    ];
    let planted = with_holes(&robot, &lists);
    let case = Case::with_tensions(&[3.0, 2.0, 1.0, 0.5]);
    let goals = [ShapeGoal::new(case.clone(), points(&planted, ModelKind::CosseratDisks, &case))];
    let rules = HoleRules {
        are_distinct: true,
        do_not_cross: true,
        largest_jump: Some(2),
        fixed: vec![FixedHole { cable: 1, disk: 0, hole: 5 }],
    };
    let disks = model(ModelKind::CosseratDisks);
    let all = [0, 1, 2, 3];
    let options = HoleSearchOptions::default();
    let found = design_holes(&disks, &robot, &all, &goals, &rules, &options).unwrap();
    println!("{:e}, {} spans, {:?}", found.error, found.effort, found.holes);
    assert_eq!(found.proof, Proof::InTurn);
    assert!(found.error < 0.01 * 0.12, "{:e}", found.error);
    assert_eq!(found.holes[1][0], 5);
    for list in &found.holes {
        let jump = |pair: &[usize]| (pair[0] + 12 - pair[1]) % 12;
        assert!(list.windows(2).all(|pair| matches!(jump(pair), 0..=2 | 10..=11)), "{list:?}");
    }
    for disk in 0..6 {
        let mut holes: Vec<usize> = found.holes.iter().map(|list| list[disk]).collect();
        holes.sort_unstable();
        holes.dedup();
        assert_eq!(holes.len(), 4);
    }
    assert!(!crosses(&found.robot));
    // Of one cable, its own list is the best beside the others.
    for cable in all {
        let alone = HoleRules { largest_jump: Some(2), are_distinct: true, ..HoleRules::default() };
        let again = design_holes(&disks, &found.robot, &[cable], &goals, &alone, &options).unwrap();
        assert!(
            again.error >= found.error * (1.0 - 1e-9) || crosses(&again.robot),
            "cable {cable}"
        );
    }
    // Six cables, free and under load, with a small budget.
    let robot = holed(0.12, 5, 6, 6);
    let case = Case::with_tensions(&[1.0, 2.0, 3.0, 1.0, 0.5, 1.5]);
    let loads = Loads { tip_force: Vec3::new(0.02, 0.0, 0.0), ..Loads::default() };
    let loaded = Case { loads, ..case.clone() };
    let options = HoleSearchOptions { solves: 3_000, ..options };
    for case in [case, loaded] {
        let point = Vec3::new(0.05, 0.02, 0.1);
        let goals = [ShapeGoal::new(case, vec![(4, point)])];
        let all = [0, 1, 2, 3, 4, 5];
        let rules = HoleRules::default();
        let found = design_holes(&disks, &robot, &all, &goals, &rules, &options).unwrap();
        println!("{:e}, {} spans or solves, {:?}", found.error, found.effort, found.proof);
        assert!(found.error < 0.05 * 0.12 && found.effort < 2 * options.nodes);
    }
}

/// Whether some cables change their order round the disks.
fn crosses(robot: &Robot) -> bool {
    let lists: Vec<Vec<usize>> = robot
        .cables()
        .iter()
        .filter_map(|cable| match &cable.routing {
            Routing::Holes { holes, .. } => Some(holes.clone()),
            _ => None,
        })
        .collect();
    let order = |disk: usize| {
        let mut order: Vec<usize> = (0..lists.len()).collect();
        order.sort_by_key(|&cable| (lists[cable][disk] + 12 - lists[0][disk]) % 12);
        order
    };
    (1..lists[0].len()).any(|disk| order(disk) != order(0))
}

#[test]
fn under_load_the_planted_list_is_found_by_changes() {
    let robot = holed(0.1, 5, 6, 1);
    let planted = with_holes(&robot, &[vec![1, 2, 3, 3, 2]]);
    let loads = Loads { tip_force: Vec3::new(0.05, -0.08, -0.05), ..Loads::default() };
    let case = Case { loads, ..Case::with_tensions(&[4.0]) };
    for kind in [ModelKind::CosseratDisks, ModelKind::Cosserat] {
        let goal = ShapeGoal::new(case.clone(), points(&planted, kind, &case));
        let design = design_holes(
            &model(kind),
            &robot,
            &[0],
            &[goal],
            &HoleRules::default(),
            &HoleSearchOptions::default(),
        )
        .unwrap();
        assert_eq!(design.proof, Proof::Local);
        assert!(design.error < 1e-6, "{kind}: {} {:?}", design.error, design.holes);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let robot = holed(0.1, 5, 6, 2);
    let case = Case::with_tensions(&[1.0, 1.0]);
    let goal = ShapeGoal::new(case.clone(), vec![(4, Vec3::new(0.0, 0.0, 0.1))]);
    let design = |cables: &[usize], goal: &ShapeGoal, rules: &HoleRules| {
        let model = model(ModelKind::CosseratDisks);
        let goals = core::slice::from_ref(goal);
        design_holes(&model, &robot, cables, goals, rules, &HoleSearchOptions::default())
            .map(|design| design.error)
    };
    let rules = HoleRules::default();
    assert!(matches!(design(&[], &goal, &rules), Err(DesignError::NoCables)));
    assert!(matches!(design(&[2], &goal, &rules), Err(DesignError::NoSuchCable { cable: 2, .. })));
    assert!(matches!(design(&[0, 0], &goal, &rules), Err(DesignError::NoSuchCable { .. })));
    let none = ShapeGoal::new(case.clone(), Vec::new());
    assert!(matches!(design(&[0], &none, &rules), Err(DesignError::NoPoints)));
    let far = ShapeGoal::new(case.clone(), vec![(5, Vec3::default())]);
    assert!(matches!(
        design(&[0], &far, &rules),
        Err(DesignError::NoSuchDisk { disk: 5, last: 4 })
    ));
    let nan = ShapeGoal::new(case, vec![(3, Vec3::new(f64::NAN, 0.0, 0.0))]);
    assert!(matches!(design(&[0], &nan, &rules), Err(DesignError::NotFinite { disk: 3, .. })));
    let rules = HoleRules {
        largest_jump: Some(1),
        fixed: vec![
            FixedHole { cable: 0, disk: 0, hole: 1 },
            FixedHole { cable: 0, disk: 1, hole: 4 },
        ],
        ..HoleRules::default()
    };
    assert!(matches!(design(&[0], &goal, &rules), Err(DesignError::NoChoice { disk: 1 })));
    // Given lengths have no table: they are searched by changes.
    let by_length = Case::with_shortenings(&[Shortening::Length(0.004), Shortening::Length(-0.01)]);
    let goal = ShapeGoal { case: by_length, ..goal };
    assert!(design(&[0], &goal, &HoleRules::default()).is_ok());
}

/// Twelve holes and ten disks: 6.2e10 lists.
#[test]
#[ignore = "seconds"]
fn study_of_large_searches() {
    let robot = holed(LENGTH, 10, 12, 1);
    let case = Case::with_tensions(&[3.9227]);
    let mut random = Random(3);
    let count = std::env::var("COUNT").ok().and_then(|n| n.parse().ok()).unwrap_or(21);
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..count {
        let list: Vec<usize> = (0..10).map(|_| 1 + random.below(12)).collect();
        let moved = moved_points(&with_holes(&robot, &[list]), &case, &mut random);
        for (kind, wanted) in [moved.clone(), moved[8..].to_vec()].into_iter().enumerate() {
            let goals = [ShapeGoal::new(case.clone(), wanted)];
            let search = || {
                design_holes(
                    &model(ModelKind::CosseratDisks),
                    &robot,
                    &[0],
                    &goals,
                    &HoleRules::default(),
                    &HoleSearchOptions::default(),
                )
                .unwrap()
            };
            let design = search();
            // The system may tell the time in steps of some milliseconds.
            const REPEATS: usize = 10;
            let clock = processor_time();
            for _ in 0..REPEATS {
                assert_eq!(search().holes, design.holes);
            }
            let time = (processor_time() - clock) / REPEATS as f64;
            assert_eq!(design.proof, Proof::Optimal);
            println!(
                "{} points: {:.4} mm, {} looked at, {:.1} ms",
                design.misses[0].len(),
                1e3 * design.error,
                design.effort,
                1e3 * time
            );
            times[kind].push(time);
        }
    }
    for (what, times) in ["shape", "tip"].iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        let last = times.len() - 1;
        println!(
            "{what}: median {:.1} ms, largest {:.1} ms of processor time",
            1e3 * times[last / 2],
            1e3 * times[last]
        );
    }
}

/// Processor time of this thread in s, where the system tells it; else the time that has passed.
fn processor_time() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let told = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    let passed = || START.get_or_init(Instant::now).elapsed().as_secs_f64();
    told.map_or_else(passed, |nanoseconds| 1e-9 * nanoseconds)
}
