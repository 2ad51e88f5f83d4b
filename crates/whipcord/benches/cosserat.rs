//! Solve times of the Cosserat model on the paper's case III: `cargo bench -p whipcord`.
//!
//! Before the times it prints the error that goes with each number of steps: the largest distance of
//! a disk from where a solution with 576 steps puts it, relative to the length.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark fails by panicking")]

mod case_3;

use case_3::TENSION;
use divan::Bencher;
use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::derivatives::{Hold, Place};
use whipcord::{Actuation, Case, Robot, Shortening, StabilityAnalysis};

fn main() {
    print_errors();
    divan::main();
}

fn print_errors() {
    let tension = Case::with_tensions(&[TENSION]);
    let length = Case::with_shortenings(&[Shortening::Fraction(0.057)]);
    let loaded = Case { loads: case_3::loads(), ..tension.clone() };
    let robot = case_3::robot();
    println!("steps  error: unloaded   loaded  by length");
    for steps in STEPS {
        let error = |case: &Case, actuation: Actuation| {
            let solve = |options: &Options| {
                let model = Cosserat::new(&robot, &case.loads, options).unwrap();
                model.solve(case, None, &mut Workspace::default()).unwrap()
            };
            let exact = solve(&Options { residual: 1e-12, ..options(576, actuation) });
            let distances = solve(&options(steps, actuation)).disks;
            distances.distances(&exact.disks).fold(0.0, f64::max) / 0.18
        };
        println!(
            "{steps:5}        {:.1e}  {:.1e}    {:.1e}",
            error(&tension, Actuation::Tension),
            error(&loaded, Actuation::Tension),
            error(&length, Actuation::Shortening)
        );
    }
}

/// A prescribed number of steps, and a residual in keeping with an error of 1e-6.
fn options(steps: usize, actuation: Actuation) -> Options {
    Options {
        accuracy: Accuracy::Steps(steps),
        actuation,
        stability: StabilityAnalysis::Off,
        residual: 5e-7,
        ..Options::default()
    }
}

/// Steps from base to tip; with 12 of them the error is below 1e-6 of the length.
const STEPS: [usize; 4] = [12, 24, 48, 96];

/// Builds the model.
#[divan::bench]
fn build(bencher: Bencher) {
    let robot = case_3::robot();
    bencher.bench_local(|| Cosserat::new(&robot, &case_3::loads(), &Options::default()).unwrap());
}

#[divan::bench(args = STEPS)]
fn unloaded_cold(bencher: Bencher, steps: usize) {
    let (robot, case) = (case_3::robot(), Case::with_tensions(&[TENSION]));
    let model = Cosserat::new(&robot, &case.loads, &options(steps, Actuation::Tension)).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench(args = STEPS)]
fn loaded_cold(bencher: Bencher, steps: usize) {
    let (robot, case) =
        (case_3::robot(), Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) });
    let model = Cosserat::new(&robot, &case.loads, &options(steps, Actuation::Tension)).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

/// The same with the Jacobian of the tip by the tension and the compliance of the tip.
#[divan::bench(args = STEPS)]
fn loaded_cold_with_derivatives(bencher: Bencher, steps: usize) {
    let (robot, case) =
        (case_3::robot(), Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) });
    derivatives(bencher, &robot, &case, steps);
}

#[divan::bench(args = STEPS)]
fn unloaded_cold_with_derivatives(bencher: Bencher, steps: usize) {
    derivatives(bencher, &case_3::robot(), &Case::with_tensions(&[TENSION]), steps);
}

fn derivatives(bencher: Bencher, robot: &Robot, case: &Case, steps: usize) {
    let model = Cosserat::new(robot, &case.loads, &options(steps, Actuation::Tension)).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| {
        let (_, derivatives) =
            model.solve_with_derivatives(case, None, &[], &mut workspace).unwrap();
        let jacobian = derivatives.actuation_jacobian(Place::Tip);
        (jacobian, derivatives.compliance(Place::Tip, Hold::Tensions).unwrap())
    });
}

/// From a neighbour whose tension is 1 % lower.
#[divan::bench(args = STEPS)]
fn loaded_warm(bencher: Bencher, steps: usize) {
    let (robot, case) =
        (case_3::robot(), Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) });
    let neighbour = Case { loads: case_3::loads(), ..Case::with_tensions(&[0.99 * TENSION]) };
    let model = Cosserat::new(&robot, &case.loads, &options(steps, Actuation::Tension)).unwrap();
    let mut workspace = Workspace::default();
    let before = model.solve(&neighbour, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&before), &mut workspace).unwrap());
}

#[divan::bench(args = STEPS)]
fn by_length_cold(bencher: Bencher, steps: usize) {
    let (robot, case) = (case_3::robot(), Case::with_shortenings(&[Shortening::Fraction(0.057)]));
    let model = Cosserat::new(&robot, &case.loads, &options(steps, Actuation::Shortening)).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

/// From a neighbour whose shortening is 1 % smaller.
#[divan::bench(args = STEPS)]
fn by_length_warm(bencher: Bencher, steps: usize) {
    let (robot, case) = (case_3::robot(), Case::with_shortenings(&[Shortening::Fraction(0.057)]));
    let neighbour = Case::with_shortenings(&[Shortening::Fraction(0.99 * 0.057)]);
    let model = Cosserat::new(&robot, &case.loads, &options(steps, Actuation::Shortening)).unwrap();
    let mut workspace = Workspace::default();
    let before = model.solve(&neighbour, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&before), &mut workspace).unwrap());
}

/// To the default tolerance of 1e-6 of the length, with the estimate of the error.
#[divan::bench]
fn unloaded_cold_to_tolerance(bencher: Bencher) {
    let (robot, case) = (case_3::robot(), Case::with_tensions(&[TENSION]));
    let model = Cosserat::new(&robot, &case.loads, &Options::default()).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench]
fn loaded_cold_to_tolerance(bencher: Bencher) {
    let (robot, case) =
        (case_3::robot(), Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) });
    let model = Cosserat::new(&robot, &case.loads, &Options::default()).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}
