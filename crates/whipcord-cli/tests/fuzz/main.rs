//! Damaged files of every kind: they are read, or refused with a reason, in bounded time and memory.
//!
//! `make test` runs a few hundred of each kind, `make test-long` tens of thousands; both always the same, by their seed.
//! To look at others: `FUZZ_SEED=7 FUZZ_SCALE=3 make test-long`. What was not answered is kept in `target/fuzz`.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the outcome is a table")]
#![cfg(target_os = "linux")]

mod document;
mod kinds;
mod pictures;
mod random;
mod runner;
mod stand_ins;
mod tables;
mod text;

use std::time::Duration;

use kinds::Kind;
use pictures::Wall;
use runner::{Plan, Tally, run};

/// Executions of each kind, in the order of [`Kind::ALL`].
fn plans(executions: [usize; 7], solve_seconds: u64) -> [Plan; 7] {
    core::array::from_fn(|k| {
        let kind = Kind::ALL[k];
        let (seconds, memory) = match kind {
            Kind::Solve => (solve_seconds, 2000),
            Kind::Photograph => (20, 3000),
            _ => (20, 1500),
        };
        Plan { kind, executions: executions[k], time: Duration::from_secs(seconds), memory }
    })
}

/// At least this share of each kind is to be taken.
fn run_all(plans: &[Plan], seed: u64, least: f64) {
    println!("seed {seed}");
    println!(
        "kind           executions   taken  no answer  stopped  timeouts  worst time  worst memory  failures"
    );
    let mut tallies: Vec<(Plan, Tally)> = Vec::new();
    for &plan in plans {
        let tally = run(plan, seed);
        println!(
            "{:<14} {:>10} {:>5} % {:>10} {:>8} {:>9} {:>8.3} s {:>9} MiB {:>9}",
            plan.kind.name(),
            tally.executions,
            100 * tally.taken / tally.executions.max(1),
            tally.unsolved,
            tally.cut,
            tally.timeouts,
            tally.worst_time.as_secs_f64(),
            tally.worst_memory,
            tally.failures.len()
        );
        assert_eq!(tally.executions, plan.executions, "{}", plan.kind.name());
        tallies.push((plan, tally));
    }
    let failures: Vec<&String> = tallies.iter().flat_map(|(_, tally)| &tally.failures).collect();
    assert!(failures.is_empty(), "{failures:#?}");
    // Where few are taken, the first lines of a reader are tested alone; where nearly all are, what it refuses is not.
    let share = |kind| {
        let (_, tally) = tallies.iter().find(|(plan, _)| plan.kind == kind).expect("a kind");
        (tally.taken + tally.unsolved) as f64 / tally.executions as f64
    };
    for kind in Kind::ALL {
        let share = share(kind);
        assert!((least..=0.8).contains(&share), "{share} of {} are taken", kind.name());
    }
}

#[test]
fn damaged_files_are_answered() {
    run_all(&plans([600, 30, 300, 300, 300, 300, 150], 20), 1, 0.4);
}

/// Twelve million pixels, as telephones have.
#[test]
fn photographs_are_measured_in_the_stated_memory() {
    pictures::measure([4000, 3000], Wall::Even, &["dots", "circles"]);
}

#[test]
#[ignore = "takes minutes: make test-long"]
fn the_largest_photographs_are_measured_in_the_stated_memory() {
    pictures::measure([8000, 7936], Wall::Even, &["dots", "circles"]);
    pictures::measure([4000, 3000], Wall::Noisy, &["dots"]);
}

#[test]
#[ignore = "takes minutes: make test-long"]
fn damaged_files_of_every_kind_are_answered() {
    let text = |name: &str| std::env::var(name).ok();
    let seed = text("FUZZ_SEED").map_or(1, |seed| seed.parse().expect("FUZZ_SEED is a number"));
    let scale: f64 =
        text("FUZZ_SCALE").map_or(1.0, |scale| scale.parse().expect("FUZZ_SCALE is a number"));
    let executions = [40_000, 1_500, 20_000, 20_000, 20_000, 10_000, 10_000]
        .map(|n| (scale * f64::from(n)) as usize);
    run_all(&plans(executions, 20), seed, 0.45);
}

/// The process that reads mutants for the tests above.
#[test]
#[ignore = "is run by the other tests"]
fn worker() {
    runner::work();
}
