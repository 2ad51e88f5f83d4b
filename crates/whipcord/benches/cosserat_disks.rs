//! Solve times of the Cosserat rod with cables straight from hole to hole, on the paper's case III:
//! `cargo bench -p whipcord --bench cosserat_disks`. Nine steps are one to each section; their error
//! is about 1e-5 of the length, that of eighteen below 1e-6.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

mod case_3;

use case_3::TENSION;
use divan::Bencher;
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::{CosseratDisks, Options, Workspace};
use whipcord::derivatives::{Hold, Place};
use whipcord::{Actuation, Case, Robot, Shortening, StabilityAnalysis};

fn main() {
    divan::main();
}

const STEPS: [usize; 2] = [9, 18];

fn options(steps: usize, actuation: Actuation) -> Options {
    Options {
        accuracy: Accuracy::Steps(steps),
        actuation,
        stability: StabilityAnalysis::Off,
        ..Options::default()
    }
}

fn measure(bencher: Bencher<'_, '_>, options: &Options, case: &Case) {
    measure_of(&case_3::robot(), bencher, options, case);
}

fn measure_of(robot: &Robot, bencher: Bencher<'_, '_>, options: &Options, case: &Case) {
    let model = CosseratDisks::new(robot, &case.loads, options).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(case, None, &mut workspace).unwrap());
}

/// Builds the model.
#[divan::bench]
fn build(bencher: Bencher<'_, '_>) {
    let robot = case_3::robot();
    let build = || CosseratDisks::new(&robot, &case_3::loads(), &Options::default()).unwrap();
    bencher.bench_local(build);
}

#[divan::bench(args = STEPS)]
fn unloaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    measure(bencher, &options(steps, Actuation::Tension), &Case::with_tensions(&[TENSION]));
}

/// Of a robot no two spans of which are alike.
#[divan::bench(args = STEPS)]
fn unloaded_tapered_cold(bencher: Bencher<'_, '_>, steps: usize) {
    let options = options(steps, Actuation::Tension);
    measure_of(&case_3::tapered(), bencher, &options, &Case::with_tensions(&[TENSION]));
}

/// With the Jacobian of the tip by the tension and the compliance of the tip.
#[divan::bench(args = STEPS)]
fn loaded_cold_with_derivatives(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) };
    derivatives(bencher, &options(steps, Actuation::Tension), &case);
}

#[divan::bench(args = STEPS)]
fn unloaded_cold_with_derivatives(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case::with_tensions(&[TENSION]);
    derivatives(bencher, &options(steps, Actuation::Tension), &case);
}

/// To the default accuracy.
#[divan::bench]
fn default_loaded_with_derivatives(bencher: Bencher<'_, '_>) {
    let case = Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) };
    derivatives(bencher, &Options::default(), &case);
}

fn derivatives(bencher: Bencher<'_, '_>, options: &Options, case: &Case) {
    let model = CosseratDisks::new(&case_3::robot(), &case.loads, options).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| {
        let (_, derivatives) =
            model.solve_with_derivatives(case, None, &[], &mut workspace).unwrap();
        let jacobian = derivatives.actuation_jacobian(Place::Tip);
        (jacobian, derivatives.compliance(Place::Tip, Hold::Tensions).unwrap())
    });
}

fn by_length() -> Case {
    Case::with_shortenings(&[Shortening::Fraction(0.057)])
}

#[divan::bench(args = STEPS)]
fn loaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) };
    measure(bencher, &options(steps, Actuation::Tension), &case);
}

#[divan::bench(args = STEPS)]
fn by_length_cold(bencher: Bencher<'_, '_>, steps: usize) {
    measure(bencher, &options(steps, Actuation::Shortening), &by_length());
}

#[divan::bench(args = STEPS)]
fn by_length_loaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case { loads: case_3::loads(), ..by_length() };
    measure(bencher, &options(steps, Actuation::Shortening), &case);
}

/// To the default tolerance of 1e-6 of the length, with the estimate of the error and the stability.
#[divan::bench]
fn unloaded_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    measure(bencher, &Options::default(), &Case::with_tensions(&[TENSION]));
}

#[divan::bench]
fn loaded_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    let case = Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) };
    measure(bencher, &Options::default(), &case);
}

#[divan::bench]
fn by_length_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    measure(bencher, &Options::default(), &by_length());
}
