//! Targets that can be reached, from rest, with and without a load: `cargo bench -p whipcord-inverse`.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

#[path = "../tests/inverse/robots.rs"]
mod robots;

use divan::Bencher;
use whipcord::{Actuation, Case, Loads, Model, ModelKind, Robot};
use whipcord_inverse::{
    CableLimits, CommandedBy, InverseSolver, Limits, Preference, ReachOptions, ReachStatus, Target,
};

fn main() {
    divan::main();
}

const ROBOTS: [&str; 4] =
    ["three straight", "three straight and a helix", "two segments", "three segments"];

fn robot(name: &str) -> (Robot, f64) {
    let (_, robot, greatest) = robots::all().into_iter().find(|(of, ..)| *of == name).unwrap();
    (robot, greatest)
}

/// What a robot reaches with these loads, one target after the other.
fn reach(
    bencher: Bencher,
    kind: ModelKind,
    name: &str,
    loads: Loads,
    of: impl Fn(&whipcord::Solution) -> Target,
) {
    let (robot, greatest) = robot(name);
    let model = Model::new(kind, Default::default(), Actuation::Natural);
    let cables = robot.cables().len();
    let limits =
        Limits::uniform(cables, CableLimits { tension: [0.0, greatest], ..Default::default() });
    let case = Case { loads: loads.clone(), ..Case::with_tensions(&vec![0.0; cables]) };
    let mut solver = InverseSolver::new(&model, &robot, &case, &limits, CommandedBy::Case).unwrap();
    let mut prepared = model.prepare(&robot, &loads).unwrap();
    let targets: Vec<Target> = (0..16_u32)
        .map(|k| {
            let tensions: Vec<f64> = (0..cables)
                .map(|i| {
                    greatest
                        * (0.3 + 0.5 * f64::from(k * 7 + 3).sin() * (1.7 * i as f64).cos())
                            .clamp(0.0, 0.8)
                })
                .collect();
            let planted = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
            of(&prepared.solve(&planted, None).unwrap())
        })
        .collect();
    let options = ReachOptions { prefer: Preference::First, ..ReachOptions::default() };
    for target in &targets {
        assert_eq!(solver.reach(target, &options).unwrap().status, ReachStatus::Reached);
    }
    let mut next = targets.iter().cycle();
    bencher.bench_local(|| solver.reach(next.next().unwrap(), &options).unwrap());
}

fn tip(solution: &whipcord::Solution) -> Target {
    Target::Tip(solution.disks.poses.last().unwrap().position)
}

fn pose(solution: &whipcord::Solution) -> Target {
    Target::Pose(*solution.disks.poses.last().unwrap())
}

#[divan::bench(args = ROBOTS)]
fn tip_unloaded(bencher: Bencher, name: &str) {
    reach(bencher, ModelKind::Cosserat, name, Loads::default(), tip);
}

#[divan::bench(args = ROBOTS)]
fn pose_unloaded(bencher: Bencher, name: &str) {
    reach(bencher, ModelKind::Cosserat, name, Loads::default(), pose);
}

#[divan::bench(args = ROBOTS)]
fn tip_loaded(bencher: Bencher, name: &str) {
    reach(bencher, ModelKind::Cosserat, name, robots::load(), tip);
}

#[divan::bench(args = ROBOTS)]
fn tip_of_disks(bencher: Bencher, name: &str) {
    reach(bencher, ModelKind::CosseratDisks, name, Loads::default(), tip);
}
