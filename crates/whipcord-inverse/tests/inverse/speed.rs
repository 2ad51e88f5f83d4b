//! What the inverse problems of each robot take, in one table.

use std::hint::black_box;
use std::time::Instant;

use whipcord::cosserat::{Accuracy, Options};
use whipcord::{Case, Loads, Model, ModelKind, Robot, StabilityAnalysis};
use whipcord_inverse::{CommandedBy, Preference, ReachOptions, WorkspaceOptions};

use crate::clock::Clock;
use crate::planted::{FIRST, Kind, Question, study};
use crate::{follow, proof, robots, workspace};

/// The median, and the greatest.
fn middle_and_most(mut of: Vec<f64>) -> [f64; 2] {
    of.sort_by(f64::total_cmp);
    [of.len() / 2, of.len().saturating_sub(1)].map(|at| of.get(at).copied().unwrap_or(f64::NAN))
}

/// The medians of planted targets of three kinds in s, and how many were not reached.
fn planted(robot: &Robot, greatest: f64, loads: &Loads, count: usize) -> ([f64; 3], usize) {
    let mut missed = 0;
    let medians = [Kind::Tip, Kind::Pose, Kind::Shape].map(|of| {
        let by = if robot.motors().is_empty() { CommandedBy::Case } else { CommandedBy::Motors };
        let kind = ModelKind::Cosserat;
        let shapes = std::env::var("SHAPES").ok().and_then(|n| n.parse().ok()).unwrap_or(128);
        let question = Question { kind, robot, greatest, loads, of, by, count, times: 3, shapes };
        let tally = study(&question, &ReachOptions { null_space: false, ..FIRST });
        missed += tally.asked - tally.reached;
        middle_and_most(tally.seconds)[0]
    });
    (medians, missed)
}

/// The least time of a solve of the paper's case III with 12 steps in s, as the benchmark `cosserat` of the library has it: how fast the machine is at the time.
fn rod() -> f64 {
    let (accuracy, stability) = (Accuracy::Steps(12), StabilityAnalysis::Off);
    let model = Model::Cosserat(Options { accuracy, stability, ..Options::default() });
    let robot = robots::robot(vec![robots::holes("pull", [1, 2, 3, 4, 4, 4, 4, 3, 2, 1])]);
    let mut prepared = model.prepare(&robot, &Loads::default()).unwrap();
    let case = Case::with_tensions(&[0.4 * 9.80665]);
    let solves = 100;
    let seconds = (0..200).map(|_| {
        let clock = Instant::now();
        for _ in 0..solves {
            black_box(prepared.solve(black_box(&case), None).unwrap());
        }
        clock.elapsed().as_secs_f64() / f64::from(solves)
    });
    seconds.fold(f64::INFINITY, f64::min)
}

/// Seconds of the processor that a survey with voxels of 8 mm takes.
fn survey(robot: &Robot, greatest: f64, loads: &Loads) -> f64 {
    let options = WorkspaceOptions { voxel: Some(0.008), ..WorkspaceOptions::default() };
    let case = Case { loads: loads.clone(), ..Case::default() };
    let clock = Clock::of_process();
    assert!(workspace::survey(robot, &case, greatest, &options).is_complete);
    clock.seconds()
}

/// A row for each robot, without load and under a force on the tip: medians of planted tips, poses and shapes from `SHAPES` shapes, each the least of three times; and of the processor: the mean of a
/// point of a path, the median and the greatest of proofs, and what all threads take for the workspace; and a solve of [`rod`] beside them. `COUNT` targets of each kind, `ROBOT` for one robot, `ONLY` for some of `reach`, `path`, `proof` and `workspace`.
#[test]
#[ignore = "minutes"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_speed() {
    let count = std::env::var("COUNT").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    let only = std::env::var("ROBOT").ok();
    let part = std::env::var("ONLY").ok();
    let is_asked = |of: &str| part.as_deref().is_none_or(|part| part.contains(of));
    println!(
        "| robot | tip, µs | pose, µs | shape, µs | a point of a path, µs | proof, s | workspace, s | rod, µs | missed |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, robot, greatest) in robots::all() {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        for (loaded, loads) in [("", Loads::default()), (", loaded", robots::load())] {
            let mut cells = vec!["–".to_owned(); 6];
            let mut missed = 0;
            if is_asked("reach") {
                let (medians, not_reached) = planted(&robot, greatest, &loads, count);
                for (cell, median) in cells.iter_mut().zip(medians) {
                    *cell = format!("{:.0}", 1e6 * median);
                }
                missed += not_reached;
            }
            if is_asked("path") {
                let points = 1000;
                let of = (Preference::First, false);
                let (reached, jumps, seconds, _) =
                    follow::walk((&robot, greatest), &loads, points, of);
                cells[3] = format!("{:.0}", 1e6 * seconds);
                missed += usize::try_from(points).unwrap() - reached + jumps;
            }
            let is_pulled = robot.motors().is_empty();
            if is_asked("proof") && loaded.is_empty() && is_pulled && robot.cables().len() <= 6 {
                let targets = (count / 20).clamp(2, 20);
                let (seconds, proven) = proof::proofs(&robot, greatest, targets);
                missed += seconds.len() - proven;
                let [median, most] = middle_and_most(seconds);
                cells[4] = format!("{median:.3}, {most:.3}");
            }
            if is_asked("workspace") && is_pulled {
                cells[5] = format!("{:.2}", survey(&robot, greatest, &loads));
            }
            let rod = 1e6 * rod();
            println!("| {name}{loaded} | {} | {rod:.1} | {missed} |", cells.join(" | "));
        }
    }
}
