//! Random robots bent up to 180° under tip loads up to twice the buckling load of the bare rod, with
//! gravity, and some of them with loads spread along a part of the rod: how many converge, and whether the
//! reasons of those that do not are true.
//!
//! The whole study, which prints its table:
//! `cargo test --release -p whipcord --test mechanics cosserat::study:: -- --ignored --nocapture`.

use crate::common;
use core::f64::consts::PI;
use std::time::Instant;

use crate::common::bending::{self, CLASSES};
use crate::common::{Wildness, bending_stiffness, lengths_of, robot, samples, solve_times};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Actuation, Case, DistributedLoad, Loads, Profile, Robot, Solution, SolveError, Statics, Vec3,
};

/// Euler's load of the bare rod is π²/4 EI/L²; the tip force is up to twice that.
const WILD: Wildness =
    Wildness { cables: 6, tension: 1.0, force: 0.5 * PI * PI, moment: 0.0, weight: 1.0 };

/// One robot in so many has a load spread along a part of it.
const SPREAD_EVERY: usize = 3;

/// A dead load on the outer part of the rod, as great as up to half of the greatest tip force.
fn spread(robot: &Robot, direction: Vec3, share: f64) -> DistributedLoad {
    let length = robot.backbone().length;
    let from = 0.6 * share * length;
    let greatest = 0.25 * PI * PI * bending_stiffness(robot) / length.powi(2);
    let force = direction * (greatest / (length - from));
    let profile = Profile::Constant { from, to: length, force, moment: Vec3::ZERO };
    DistributedLoad { profile, follower: false }
}

/// The case with its tensions scaled so that the cables alone turn the backbone by about `target`;
/// `None` where they fold it before.
fn bent_by(robot: &Robot, case: &Case, target: f64) -> Option<(Case, Solution)> {
    let model = whipcord::Model::Cosserat(Options::default());
    let mut scaled = Case { loads: Loads::default(), ..case.clone() };
    let mut answer = None;
    for _ in 0..6 {
        let solution = model.solve(robot, &scaled).ok()?;
        let factor = bending::towards(target, &solution);
        answer = Some((Case { loads: case.loads.clone(), ..scaled.clone() }, solution));
        for command in &mut scaled.commands {
            command.tension = command.tension.map(|t| t * factor);
        }
    }
    answer
}

#[derive(Clone, Copy, Debug, Default)]
struct Row {
    stable: usize,
    snapped: usize,
    unstable: usize,
    folds: usize,
    unreachable: usize,
    buckled: usize,
    not_converged: usize,
    other: usize,
    unconfirmed: usize,
}

/// Whether a reason is true, by a different way: from many base wrenches at once on a fine grid no
/// equilibrium is found that the robot could stay in; a section that folds does so on fine steps, and lengths
/// that cannot be had are refused there for the same reason.
fn is_confirmed(robot: &Robot, case: &Case, actuation: Actuation, reason: &SolveError) -> bool {
    let fine = |accuracy| Options { accuracy, actuation, ..Options::default() };
    match reason {
        SolveError::SectionFolds { .. }
        | SolveError::UnreachableLength { .. }
        | SolveError::ContradictoryLengths { .. } => {
            let model = whipcord::Model::Cosserat(fine(Accuracy::Steps(300)));
            let of = core::mem::discriminant::<SolveError>;
            model.solve(robot, case).is_err_and(|found| of(&found) == of(reason))
        }
        _ => {
            let model = whipcord::Model::Cosserat(fine(Accuracy::Steps(96)));
            let unloaded = Case { loads: Loads::default(), ..case.clone() };
            let start = model.solve(robot, &unloaded);
            start.is_ok_and(|start| !bending::stable_from_afar(&model, robot, case, &start, 40))
        }
    }
}

/// What is drawn for a robot: itself with a case, and the direction and the beginning of a spread load.
type Drawn = ((Robot, Case), Vec3, f64);

fn drawn(count: usize) -> impl Iterator<Item = Drawn> {
    samples((robot(WILD), common::ball(), 0.0..1.0_f64), count)
}

/// Robot number `n` with its loads, and its shape without them; `None` where its cables alone fold it
/// before they bend it as far as they are to.
fn bent(n: usize, ((robot, mut case), direction, share): Drawn) -> Option<(Robot, Case, Solution)> {
    case.loads.points.clear();
    if n.is_multiple_of(SPREAD_EVERY) {
        case.loads.distributed.push(spread(&robot, direction, share));
    }
    let (bent, alone) = bent_by(&robot, &case, bending::target(n))?;
    Some((robot, bent, alone))
}

/// Solves so many robots and sorts what comes of it by how far the cables alone bend them.
fn study(count: usize, actuation: Actuation) -> [Row; CLASSES] {
    let mut rows = [Row::default(); CLASSES];
    let (mut times, mut failure_times) = (Vec::new(), Vec::new());
    let robots = drawn(2 * count)
        .enumerate()
        .filter_map(|(n, drawn)| Some((n, bent(n, drawn)?)))
        .take(count);
    for (n, (robot, bent, alone)) in robots {
        let asked = match actuation {
            Actuation::Shortening => lengths_of(&alone, &bent.loads),
            _ => bent,
        };
        let row = &mut rows[bending::class(&alone)];
        let begun = Instant::now();
        let options = Options { actuation, ..Options::default() };
        let outcome = whipcord::Model::Cosserat(options).solve(&robot, &asked);
        let taken = begun.elapsed().as_secs_f64();
        times.push(taken);
        let reason = match outcome {
            Ok(solution) if solution.diagnostics.is_unstable() => {
                row.unstable += 1;
                let lost_at = solution.diagnostics.stability_lost_at;
                println!("{n}: unstable, lost at {lost_at:?}, {:.1} ms", 1e3 * taken);
                continue;
            }
            Ok(solution) => {
                row.stable += 1;
                if let Some(load) = solution.diagnostics.stability_lost_at {
                    row.snapped += 1;
                    println!("{n}: snapped through at {load:.4}, {:.1} ms", 1e3 * taken);
                }
                continue;
            }
            Err(reason) => reason,
        };
        failure_times.push(taken);
        *match reason {
            SolveError::SectionFolds { .. } => &mut row.folds,
            SolveError::UnreachableLength { .. } => &mut row.unreachable,
            SolveError::Buckled { .. } => &mut row.buckled,
            SolveError::NotConverged { .. } => &mut row.not_converged,
            _ => &mut row.other,
        } += 1;
        let confirmed = is_confirmed(&robot, &asked, actuation, &reason);
        let verdict = if confirmed { "confirmed" } else { "NOT CONFIRMED" };
        println!("{n}: {reason} — {verdict}, {:.1} ms", 1e3 * taken);
        row.unconfirmed += usize::from(!confirmed);
    }
    println!("all: {}", solve_times::summary(times));
    println!("failures: {}", solve_times::summary(failure_times));
    rows
}

fn print(title: &str, rows: &[Row]) {
    println!("\n{title}");
    println!(
        "bending       stable (snapped)  unstable  folds  unreachable  buckled  not conv.  other  unconfirmed"
    );
    for (i, r) in rows.iter().enumerate() {
        println!(
            "{:3}° – {:3}°  {:7} ({:7})  {:8}  {:5}  {:11}  {:7}  {:9}  {:5}  {:11}",
            30 * i,
            30 * (i + 1),
            r.stable,
            r.snapped,
            r.unstable,
            r.folds,
            r.unreachable,
            r.buckled,
            r.not_converged,
            r.other,
            r.unconfirmed
        );
    }
}

fn check(rows: &[Row], count: usize) {
    let sum = |f: fn(&Row) -> usize| rows.iter().map(f).sum::<usize>();
    assert_eq!(sum(|r| r.unconfirmed), 0, "a reason is not true");
    assert!(sum(|r| r.stable) * 100 >= 97 * count, "{rows:?}");
}

#[test]
fn random_robots_converge_or_say_why_not() {
    let count = if cfg!(debug_assertions) { 15 } else { 150 };
    for actuation in [Actuation::Tension, Actuation::Shortening] {
        let rows = study(count, actuation);
        print(&format!("{actuation:?}"), &rows);
        check(&rows, count);
    }
}

/// The same loads, so many times as strong.
fn times(case: &Case, factor: f64) -> Case {
    let mut case = case.clone();
    case.loads.tip_force *= factor;
    case.loads.gravity = case.loads.gravity.map(|g| g * factor);
    for load in &mut case.loads.distributed {
        if let Profile::Constant { force, .. } = &mut load.profile {
            *force *= factor;
        }
    }
    case
}

/// Robots that keep their shape only as long as a cable is taut: where it goes slack the load path turns
/// sharply back, and the robot snaps. Up to that load it does not, from there on it does.
#[test]
fn a_cable_that_goes_slack_lets_the_robot_snap() {
    let options = Options { actuation: Actuation::Shortening, ..Options::default() };
    let model = whipcord::Model::Cosserat(options);
    let numbers: &[usize] = if cfg!(debug_assertions) { &[333] } else { &[333, 707] };
    for (n, drawn) in drawn(708).enumerate().filter(|(n, _)| numbers.contains(n)) {
        let (robot, case, alone) = bent(n, drawn).unwrap();
        let case = lengths_of(&alone, &case.loads);
        let solve = |factor: f64| model.solve(&robot, &times(&case, factor)).unwrap();
        let at_once = solve(1.0);
        assert!(!at_once.diagnostics.is_unstable(), "{n}");
        let snaps_at = at_once.diagnostics.stability_lost_at.unwrap();
        let before = solve((1.0 - 1e-3) * snaps_at);
        assert_eq!(before.diagnostics.stability_lost_at, None, "{n}");
        let after = solve((1.0 + 1e-3) * snaps_at);
        assert!(after.diagnostics.stability_lost_at.is_some(), "{n}");
        let jump = common::distance(&before, &after) / robot.backbone().length;
        assert!(jump > 0.1, "{n}: {jump}");
    }
}

#[test]
#[ignore = "takes minutes: the whole study"]
fn two_thousand_random_robots() {
    for actuation in [Actuation::Tension, Actuation::Shortening] {
        let rows = study(2000, actuation);
        print(&format!("2000 random robots, driven by {actuation:?}"), &rows);
        check(&rows, 2000);
    }
}
