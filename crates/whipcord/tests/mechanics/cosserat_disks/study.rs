//! Random robots with cables straight from hole to hole, bent up to 180° under tip loads up to twice the
//! buckling load of the bare rod, with gravity, driven by tensions and by lengths: how many converge,
//! and whether the reasons of those that do not are true.
//!
//! The whole study, which prints its table:
//! `cargo test --release -p whipcord --test mechanics -- --ignored --nocapture cosserat_disks::study::`.

use core::f64::consts::PI;
use std::time::Instant;

use crate::common::bending::{self, CLASSES};
use crate::common::{ball, bending_stiffness, lengths_of, routing, samples, solve_times};
use proptest::collection::vec;
use proptest::prelude::*;
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Loads, Material, Model, Robot, Section, Solution,
    SolveError, StabilityAnalysis, Statics as _, Vec3,
};

const LENGTH: f64 = 0.2;
const RADIUS: f64 = 0.009;
/// Solves that take longer, in s, are named.
const SLOW: f64 = 0.05;

/// One to six cables of any routing that the files know, anchored at a disk; six to fifteen sections.
pub fn robots() -> impl Strategy<Value = (Robot, Case)> {
    (7..=16_usize, 1..=6_usize)
        .prop_flat_map(|(disks, cables)| {
            (
                Just(disks),
                (prop_oneof![3 => Just(0.0), 1 => 0.3..0.8], 40.0..90.0),
                prop_oneof![2 => Just(Vec3::ZERO), 1 => ball()],
                vec((routing(disks, RADIUS), 0.1..1.0), cables),
                (ball(), ball(), 0.0..1.0),
            )
        })
        .prop_map(|(count, (bore, slender), bent, cables, (force, down, weight))| {
            let diameter = LENGTH / slender;
            let section = match bore {
                0.0 => Section::circle(diameter),
                bore => Section::tube(diameter, bore * diameter),
            };
            let material = Material {
                young_modulus: Some(1.1e9),
                poisson_ratio: Some(0.3),
                density: Some(1000.0),
                ..Material::default()
            };
            let backbone = Backbone {
                section: Some(section),
                material,
                rest_curvature: (bent / LENGTH).into(),
                ..Backbone::new(LENGTH)
            };
            let disks = Disks::equally_spaced(LENGTH, count, RADIUS).with_holes(12);
            let at = disks.arc_lengths.clone();
            let cable = |(i, ((routing, end), _)): (usize, &((_, Option<f64>), f64))| {
                let on_disk = |end: f64| at[((end * (count - 1) as f64) as usize).max(1)];
                let ends_at = end.map(on_disk);
                Cable { ends_at, ..Cable::new(format!("cable {i}"), Clone::clone(routing)) }
            };
            let of: Vec<Cable> = cables.iter().enumerate().map(cable).collect();
            let robot = Robot::new(backbone, disks, of).unwrap();
            let stiffness = bending_stiffness(&robot);
            let unit = stiffness / (LENGTH * LENGTH);
            let area = robot.backbone().section_at(robot.disks(), 0.0).unwrap().area;
            let loads = Loads {
                tip_force: 0.5 * PI * PI * unit * force,
                gravity: Some(down * (weight * unit / (1000.0 * area * LENGTH))),
                ..Loads::default()
            };
            let tensions: Vec<f64> =
                cables.iter().map(|(_, t)| t * stiffness / (LENGTH * RADIUS)).collect();
            (robot, Case { loads, ..Case::with_tensions(&tensions) })
        })
}

/// The case with its tensions scaled so that the cables alone turn the backbone by about `target`;
/// `None` where they fold it before.
pub fn bent_by(robot: &Robot, case: &Case, target: f64) -> Option<(Case, Solution)> {
    let model =
        Model::CosseratDisks(Options { stability: StabilityAnalysis::Off, ..Options::default() });
    let mut scaled = Case { loads: Loads::default(), ..case.clone() };
    let mut answer = None;
    for _ in 0..6 {
        let Ok(solution) = model.solve(robot, &scaled) else { break };
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
    unstable: usize,
    /// Unstable answers where another way finds a stable one.
    missed: usize,
    folds: usize,
    unreachable: usize,
    not_converged: usize,
    other: usize,
    unconfirmed: usize,
}

/// Whether a robot has no equilibrium that it stays in as far as another way finds: on a fine mesh, from
/// many base wrenches.
fn none_is_found(robot: &Robot, case: &Case, actuation: Actuation) -> bool {
    let accuracy = Accuracy::Steps(6 * robot.disks().count());
    let options = Options { accuracy, actuation, ..Options::default() };
    let model = Model::CosseratDisks(options);
    let unloaded = Case { loads: Loads::default(), ..case.clone() };
    match model.solve(robot, &unloaded) {
        Ok(start) => !bending::stable_from_afar(&model, robot, case, &start, 20),
        Err(_) => model.solve(robot, case).is_err(),
    }
}

/// Solves so many robots and sorts what comes of it by how far the cables alone bend them.
fn study(count: usize, actuation: Actuation) -> [Row; CLASSES] {
    let mut rows = [Row::default(); CLASSES];
    let (mut times, mut failure_times) = (Vec::new(), Vec::new());
    for (n, (robot, case)) in samples(robots(), count).enumerate() {
        let Some((bent, alone)) = bent_by(&robot, &case, bending::target(n)) else { continue };
        let asked = match actuation {
            Actuation::Shortening => lengths_of(&alone, &bent.loads),
            _ => bent,
        };
        let row = &mut rows[bending::class(&alone)];
        let options = Options { actuation, ..Options::default() };
        let begun = Instant::now();
        let outcome = Model::CosseratDisks(options).solve(&robot, &asked);
        let taken = begun.elapsed().as_secs_f64();
        times.push(taken);
        if taken > SLOW {
            println!("{n}: {:.0} ms", 1e3 * taken);
        }
        let reason = match outcome {
            Ok(solution) if solution.diagnostics.is_unstable() => {
                row.unstable += 1;
                let missed = !none_is_found(&robot, &asked, actuation);
                println!("{n}: unstable{}", if missed { ", and need not be" } else { "" });
                row.missed += usize::from(missed);
                continue;
            }
            Ok(solution) => {
                assert!(solution.disks.tip().position.is_finite());
                row.stable += 1;
                continue;
            }
            Err(reason) => reason,
        };
        failure_times.push(taken);
        *match reason {
            SolveError::SectionFolds { .. } => &mut row.folds,
            SolveError::UnreachableLength { .. } => &mut row.unreachable,
            SolveError::NotConverged { .. } => &mut row.not_converged,
            _ => &mut row.other,
        } += 1;
        let confirmed = none_is_found(&robot, &asked, actuation);
        println!("{n}: {reason} — {}", if confirmed { "confirmed" } else { "NOT CONFIRMED" });
        row.unconfirmed += usize::from(!confirmed);
    }
    println!("all: {}", solve_times::summary(times));
    println!("failures: {}", solve_times::summary(failure_times));
    rows
}

fn print(title: &str, rows: &[Row]) {
    println!("\n{title}");
    println!(
        "bending      stable  unstable (missed)  folds  unreachable  not conv.  other  unconfirmed"
    );
    for (i, r) in rows.iter().enumerate() {
        println!(
            "{:3}° – {:3}°  {:6}  {:8} ({:6})  {:5}  {:11}  {:9}  {:5}  {:11}",
            30 * i,
            30 * (i + 1),
            r.stable,
            r.unstable,
            r.missed,
            r.folds,
            r.unreachable,
            r.not_converged,
            r.other,
            r.unconfirmed
        );
    }
}

fn check(rows: &[Row], count: usize) {
    let sum = |f: fn(&Row) -> usize| rows.iter().map(f).sum::<usize>();
    assert_eq!(sum(|r| r.unconfirmed + r.other), 0, "a reason is not true");
    assert!(sum(|r| r.stable) * 100 >= 98 * count, "{rows:?}");
    // A stable equilibrium that no way from the robot at rest leads to may be missed.
    assert!(sum(|r| r.missed) * 500 <= count, "{rows:?}");
}

#[test]
fn random_robots_converge_or_say_why_not() {
    let count = if cfg!(debug_assertions) { 8 } else { 50 };
    for actuation in [Actuation::Tension, Actuation::Shortening] {
        let rows = study(count, actuation);
        print(&format!("{actuation:?}"), &rows);
        check(&rows, count);
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
