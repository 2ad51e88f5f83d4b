//! Designs of random robots for random targets: each ends within its budget, with a robot that passes checks of its own, or with a reason.

use core::f64::consts::{PI, TAU};
use std::time::{Duration, Instant};

use whipcord::{
    Actuation, Backbone, Cable, Cancel, Case, Disks, Loads, Material, Model, ModelKind, Robot,
    Routing, Section, Statics as _, Stations, Vec3,
};
use whipcord_design::{
    Criterion, CurveKind, Design, DesignError, DesignGoal, DesignOptions, HoleRules, Known,
    NamedCurve, Proof, Quantity, TargetShape, Vary, design,
};

use crate::robots::{Random, with_holes};

const MODELS: [ModelKind; 6] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::FourBar,
    ModelKind::ConstantCurvature,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
];
/// What varies, by names.
const VARIED: [&str; 12] = [
    "holes",
    "holes and tensions",
    "routing",
    "routing and tension",
    "rest curvature",
    "diameters",
    "disk positions",
    "tensions",
    "number of cables",
    "stiffness",
    "holes of one",
    "holes of one, tensions and diameters",
];

/// A design that is asked for.
struct Asked {
    words: String,
    model: Model,
    robot: Robot,
    goals: Vec<DesignGoal>,
    vary: Vec<Vary>,
    options: DesignOptions,
    /// Robot and cases that make the targets, by the model itself.
    planted: Option<(Robot, Vec<Case>)>,
}

fn between(random: &mut Random, least: f64, greatest: f64) -> f64 {
    least + (greatest - least) * random.next()
}

fn pick<T: Copy>(random: &mut Random, of: &[T]) -> T {
    of[random.below(of.len())]
}

/// About normal, with the deviation 1.
fn normal(random: &mut Random) -> Vec3 {
    let mut one = || (0..12).map(|_| random.next()).sum::<f64>() - 6.0;
    Vec3::new(one(), one(), one())
}

fn robot(random: &mut Random) -> (Robot, f64) {
    let length = between(random, 0.08, 0.25);
    let disks = 4 + random.below(9);
    let holes = pick(random, &[6, 8, 12, 16, 24, 36]);
    let cables = 1 + random.below(6);
    let diameter = length * between(random, 0.012, 0.02);
    let circle = length * between(random, 0.03, 0.06);
    let young = 1e9 * between(random, 0.5, 60.0);
    let material = Material {
        young_modulus: Some(young),
        poisson_ratio: Some(0.3),
        density: Some(1500.0),
        ..Material::default()
    };
    let section = Some(Section::circle(diameter));
    let backbone = Backbone { section, material, ..Backbone::new(length) };
    let plates = Disks::equally_spaced(length, disks, circle).with_holes(holes);
    let cable = |k: usize| {
        let hole = 1 + (k * holes / cables) % holes;
        Cable::new(format!("c{k}"), Routing::holes(vec![hole; disks]))
    };
    let robot = Robot::new(backbone, plates, (0..cables).map(cable).collect()).unwrap();
    // The tension that bends by 1 rad.
    let unit = young * PI * diameter.powi(4) / 64.0 / (length * circle);
    (robot, unit)
}

fn curve(random: &mut Random, length: f64) -> TargetShape {
    let kind = match random.below(5) {
        0 => CurveKind::Arc { angle: between(random, 0.1, 3.5) },
        1 => CurveKind::Circle { radius: length * between(random, 0.2, 2.0) },
        2 => CurveKind::S { angle: between(random, 0.1, 1.6) },
        3 => CurveKind::Helix {
            radius: length * between(random, 0.05, 0.4),
            pitch: length * between(random, 0.1, 2.0),
        },
        _ => CurveKind::Clothoid {
            start: between(random, -1.0, 1.0) / length,
            end: between(random, -4.0, 4.0) / length,
        },
    };
    TargetShape::Curve(NamedCurve { kind, direction: between(random, 0.0, TAU) })
}

fn points(robot: &Robot, case: &Case, model: &Model) -> Option<Vec<(usize, Vec3)>> {
    let solution = model.solve(robot, case).ok()?;
    Some(solution.disks.poses.iter().map(|pose| pose.position).enumerate().skip(1).collect())
}

/// `None` where a target that is to be planted has no answer.
fn asked(seed: u64) -> Option<Asked> {
    let mut state = Random(seed.wrapping_mul(0x5851_F42D_4C95_7F2D));
    let random = &mut state;
    let (robot, unit) = robot(random);
    let (length, cables) = (robot.backbone().length, robot.cables().len());
    let (disks, holes) = (robot.disks().count(), robot.disks().holes.unwrap_or(6));
    let loads = match random.below(20) {
        0..5 => Loads { tip_force: normal(random) * (0.05 * unit), ..Loads::default() },
        5..8 => Loads { gravity: Some(Vec3::new(0.0, 0.0, -9.81)), ..Loads::default() },
        8..10 => Loads {
            gravity: Some(Vec3::new(0.0, -9.81, 0.0)),
            tip_force: normal(random) * (0.03 * unit),
            ..Loads::default()
        },
        _ => Loads::default(),
    };
    let tensions: Vec<f64> = (0..cables).map(|_| unit * between(random, 0.1, 1.5)).collect();
    let with = |tensions: &[f64]| {
        let mut case = Case::with_tensions(tensions);
        case.loads = loads.clone();
        case
    };
    let case = with(&tensions);
    let kind = match random.below(10) {
        k @ 0..6 => MODELS[k],
        6 | 7 => ModelKind::Cosserat,
        _ => ModelKind::CosseratDisks,
    };
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let name = pick(random, &VARIED);
    let all = |of: fn(usize) -> Vary| (0..cables).map(of).collect::<Vec<_>>();
    let pull = |cable| Vary::Tension { cable };
    let pass = |cable| Vary::Holes { cable };
    let stiffness = || Vary::parse("backbone.young_modulus", &robot).unwrap();
    let mut vary = match name {
        "holes" => all(pass),
        "holes and tensions" => [all(pass), all(pull)].concat(),
        "routing" => vec![Vary::Routing { cable: 0 }],
        "routing and tension" => vec![Vary::Routing { cable: 0 }, pull(0)],
        "rest curvature" => vec![Vary::RestCurvature],
        "diameters" => vec![Vary::Diameters],
        "disk positions" => vec![Vary::DiskPositions],
        "tensions" => all(pull),
        "number of cables" => vec![Vary::Cables],
        "stiffness" => stiffness(),
        "holes of one" => vec![pass(0)],
        _ => [vec![pass(0)], all(pull), vec![Vary::Diameters]].concat(),
    };
    let varies_holes = vary.contains(&pass(0));
    let mut options = DesignOptions::default();
    if varies_holes && random.next() < 0.4 {
        let many = vary.contains(&pass(cables - 1)) && cables > 1;
        options.rules = HoleRules {
            largest_jump: Some(1 + random.below(3)),
            are_distinct: many && random.next() < 0.5,
            do_not_cross: many && random.next() < 0.5,
            ..HoleRules::default()
        };
    }
    if random.next() < 0.3 {
        options.tensions = vec![Some([0.0, 2.0 * unit]); cables];
    }
    let objective = |quantity| Criterion { quantity, weight: Some(1e-3), limit: None };
    if random.next() < 0.15 {
        options.criteria = vec![match random.below(4) {
            0 => Criterion { quantity: Quantity::Tension, weight: None, limit: Some(1.8 * unit) },
            1 => objective(Quantity::Tension),
            2 => objective(Quantity::Stiffness { disk: disks - 1, direction: None }),
            _ => objective(Quantity::Workspace),
        }];
    }
    // Another list for each of the cables that vary.
    let other = |random: &mut Random| {
        let lists: Vec<Vec<usize>> = (0..cables)
            .map(|cable| match &robot.cables()[cable].routing {
                Routing::Holes { holes: own, .. } if !vary.contains(&pass(cable)) => own.clone(),
                _ if random.next() < 0.5 => (0..disks).map(|_| 1 + random.below(holes)).collect(),
                _ => vec![1 + random.below(holes); disks],
            })
            .collect();
        with_holes(&robot, &lists)
    };
    let goal = |case: &Case, target| DesignGoal { case: case.clone(), target, weight: 1.0 };
    let noisy = |mut places: Vec<(usize, Vec3)>, random: &mut Random, off: f64| {
        for (_, place) in &mut places {
            *place += normal(random) * (off * length);
        }
        TargetShape::Points(places)
    };
    let mut planted = None;
    let (what, goals) = match random.below(8) {
        0 | 1 => ("curve", vec![goal(&case, curve(random, length))]),
        2 => {
            let maker = other(random);
            let target = TargetShape::Points(points(&maker, &case, &model)?);
            planted = Some((maker, vec![case.clone()]));
            ("planted", vec![goal(&case, target)])
        }
        3 => {
            let maker = other(random);
            let target = noisy(points(&maker, &case, &model)?, random, 0.003);
            planted = Some((maker, vec![case.clone()]));
            ("noisy", vec![goal(&case, target)])
        }
        4 => {
            let away = normal(random);
            let way = Vec3::new(away.x, away.y, away.z.abs() + 1.0);
            let tip = way * (length * between(random, 0.5, 1.1) / way.norm());
            ("tip", vec![goal(&case, TargetShape::Points(vec![(disks - 1, tip)]))])
        }
        5 => {
            let (turn, count) = (between(random, 0.0, TAU), 2 + random.below(4));
            if !vary.iter().any(|of| matches!(of, Vary::Tension { .. } | Vary::Cables)) {
                vary.extend(all(pull));
            }
            let place = |k: usize| {
                let bend = 0.1 + 0.5 * k as f64 / (count - 1) as f64;
                let out = 0.6 * length * bend.sin();
                let tip = Vec3::new(out * turn.cos(), out * turn.sin(), 0.9 * length * bend.cos());
                goal(&case, TargetShape::Points(vec![(disks - 1, tip)]))
            };
            ("path", (0..count).map(place).collect())
        }
        6 => {
            let maker = other(random);
            let cases: Vec<Case> = [tensions.clone(), tensions.iter().rev().copied().collect()]
                .iter()
                .map(|tensions| with(tensions))
                .collect();
            let mut goals = Vec::new();
            for case in &cases {
                goals.push(goal(case, TargetShape::Points(points(&maker, case, &model)?)));
            }
            planted = Some((maker, cases));
            ("two shapes", goals)
        }
        _ => {
            let maker = Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Natural);
            let mut places = points(&other(random), &case, &maker)?;
            places.retain(|(disk, _)| *disk == disks - 1 || random.next() < 0.6);
            ("measured", vec![goal(&case, noisy(places, random, 0.001))])
        }
    };
    let loaded = if loads.is_none() { "" } else { ", loads" };
    let rules = if options.rules == HoleRules::default() { "" } else { ", rules" };
    let criteria = if options.criteria.is_empty() { "" } else { ", criteria" };
    let words = format!(
        "{name}, {what}, {kind}, {cables} cables, {disks} disks, {holes} holes{loaded}{rules}{criteria}"
    );
    Some(Asked { words, model, robot, goals, vary, options, planted })
}

/// What is wrong with a design.
fn faults(asked: &Asked, found: &Design) -> Vec<String> {
    let mut faults = Vec::new();
    let length = asked.robot.backbone().length;
    // The model solves the robot again.
    let (mut sum, mut count) = (0.0, 0.0);
    for goal in &found.goals {
        match asked.model.solve(&found.robot, &goal.case) {
            Err(error) => faults.push(format!("the robot has no answer: {error}")),
            Ok(solution) => {
                for (disk, wanted) in &goal.points {
                    let off = solution.disks.poses[*disk].position - *wanted;
                    (sum, count) = (sum + off.dot(off), count + 1.0);
                }
            }
        }
    }
    let error = (sum / f64::max(count, 1.0)).sqrt();
    if (error - found.error).abs() > 1e-5 * length {
        faults.push(format!("solved again {error:.3e}, told {:.3e}", found.error));
    }
    let options = &asked.options;
    // Fewer cables may be farther off, within the tolerance.
    let is_free = !asked.vary.contains(&Vary::Cables)
        && options.criteria.is_empty()
        && options.tensions.is_empty()
        && options.rules == HoleRules::default();
    if let Some([before, _]) = found.before
        && is_free
        && found.error > before * (1.0 + 1e-6) + 1e-7 * length
    {
        faults.push(format!("worse than before, {before:.3e}"));
    }
    if found.lower_bound.is_some_and(|bound| bound > found.error * (1.0 + 1e-6)) {
        faults.push("a bound above the error".to_owned());
    }
    for (cable, command) in found.goals.iter().flat_map(|of| of.case.commands.iter().enumerate()) {
        let most = options.tensions.get(cable).copied().flatten().map_or(f64::INFINITY, |of| of[1]);
        let is_varied = asked.vary.contains(&Vary::Tension { cable });
        if is_varied && command.tension.is_some_and(|of| of > most * (1.0 + 1e-9) || of < 0.0) {
            faults.push("a tension beyond its limit".to_owned());
        }
    }
    let lists: Vec<Option<&Vec<usize>>> = (0..found.robot.cables().len())
        .map(|cable| match &found.robot.cables()[cable].routing {
            Routing::Holes { holes, .. } if asked.vary.contains(&Vary::Holes { cable }) => {
                Some(holes)
            }
            _ => None,
        })
        .collect();
    let lists: Vec<&Vec<usize>> = lists.into_iter().flatten().collect();
    let holes = asked.robot.disks().holes.unwrap_or(1);
    if let Some(most) = options.rules.largest_jump {
        let jump = |pair: &[usize]| {
            let away = pair[0].abs_diff(pair[1]);
            away.min(holes - away) > most
        };
        if lists.iter().any(|list| list.windows(2).any(jump)) {
            faults.push("a jump beyond the rule".to_owned());
        }
    }
    if options.rules.are_distinct {
        let is_shared = |disk: usize| {
            let mut at: Vec<usize> = lists.iter().map(|list| list[disk]).collect();
            at.sort_unstable();
            at.windows(2).any(|pair| pair[0] == pair[1])
        };
        if (0..asked.robot.disks().count()).any(is_shared) {
            faults.push("a hole with two cables".to_owned());
        }
    }
    // A list that is proven to be the best is no worse than the one that made the target.
    let is_proven = |of: &whipcord_design::Finding| of.known == Known::Holes(Proof::Optimal);
    let are_kept = found.goals.iter().zip(&asked.goals).all(|(a, b)| a.case == b.case);
    if let Some((maker, cases)) = &asked.planted
        && is_free
        && are_kept
        && found.findings.iter().any(is_proven)
    {
        let (mut sum, mut count) = (0.0, 0.0);
        for (case, goal) in cases.iter().zip(&found.goals) {
            if let Some(places) = points(maker, case, &asked.model) {
                for ((_, place), (_, wanted)) in places.iter().zip(&goal.points) {
                    sum += (*place - *wanted).dot(*place - *wanted);
                    count += 1.0;
                }
            }
        }
        let made = (sum / f64::max(count, 1.0)).sqrt();
        if found.error > made + 1e-5 * length {
            faults.push(format!("proven, but {made:.3e} is possible"));
        }
    }
    faults
}

/// `COUNT` targets from the seed `FIRST` on, each with `SECONDS` and `SOLVES` at most.
#[test]
#[ignore = "minutes"]
fn study_of_random_targets() {
    let number = |name: &str, usual: u64| {
        std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
    };
    let (count, first) = (number("COUNT", 20), number("FIRST", 0));
    let limit = Duration::from_secs(number("SECONDS", 60));
    let (mut found, mut refused, mut ended, mut wrong) = (0, 0, 0, 0);
    let mut times = Vec::new();
    for seed in first..first + count {
        let Some(mut asked) = asked(seed) else { continue };
        let stop = Cancel::new();
        asked.options.stop = stop.clone();
        asked.options.solves = usize::try_from(number("SOLVES", 40_000)).unwrap();
        let (done, waits) = std::sync::mpsc::channel::<()>();
        let watch = std::thread::spawn(move || {
            if waits.recv_timeout(limit).is_err() {
                stop.cancel();
            }
        });
        let begun = Instant::now();
        let Asked { model, robot, goals, vary, options, .. } = &asked;
        let outcome = design(model, robot, goals, vary, options);
        let time = begun.elapsed();
        done.send(()).ok();
        watch.join().unwrap();
        times.push(time.as_secs_f64());
        let mut words = match &outcome {
            Err(error) => {
                refused += 1;
                if matches!(error, DesignError::Ended) {
                    wrong += 1;
                }
                format!("refused: {error}")
            }
            Ok(of) => {
                found += 1;
                ended += usize::from(of.ended.is_some());
                let known: Vec<&str> = of.findings.iter().map(|of| of.known.name()).collect();
                let before =
                    of.before.map_or(f64::NAN, |[error, _]| error / of.robot.backbone().length);
                format!(
                    "{:.2e} of the length, before {before:.2e}, {} solves, ended {:?}, {}",
                    of.error / of.robot.backbone().length,
                    of.solves,
                    of.ended,
                    known.join(" ")
                )
            }
        };
        if let Ok(of) = &outcome {
            let faults = faults(&asked, of);
            wrong += usize::from(!faults.is_empty());
            if !faults.is_empty() {
                words += &format!(" WRONG: {}", faults.join(", "));
            }
        }
        // What was begun when the time is over is completed, which may take as long again.
        if time > limit * 2 + Duration::from_secs(10) {
            wrong += 1;
            words += " LATE";
        }
        println!("{seed}: {:.2} s, {}: {words}", time.as_secs_f64(), asked.words);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{found} found, {ended} of them by the end of their budgets, {refused} refused, {wrong} wrong; median {:.2} s, longest {:.2} s",
        times.get(times.len() / 2).unwrap_or(&0.0),
        times.last().unwrap_or(&0.0)
    );
    assert_eq!(wrong, 0);
}
