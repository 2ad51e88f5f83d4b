//! Solve times of the Cosserat rod with cables straight from hole to hole, on the paper's case III:
//! `cargo bench -p whipcord --bench cosserat_disks`. Nine steps are one to each section; their error
//! is about 1e-5 of the length, that of eighteen below 1e-6.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use divan::Bencher;
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::{CosseratDisks, Options, Workspace};
use whipcord::{
    Backbone, Cable, Case, Disks, Drive, Loads, Material, Robot, Routing, Section, Shortening, Vec3,
};

fn main() {
    divan::main();
}

const TENSION: f64 = 0.4 * 9.80665;
const STEPS: [usize; 2] = [9, 18];

fn case_3() -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            shear_modulus: None,
            density: Some(1040.0),
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let cable = Cable::new("pull", Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]));
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

fn options(steps: usize, drive: Drive) -> Options {
    Options { accuracy: Accuracy::Steps(steps), drive, stability: false, ..Options::default() }
}

fn measure(bencher: Bencher<'_, '_>, options: &Options, case: &Case) {
    let model = CosseratDisks::new(&case_3(), &case.loads, options).unwrap();
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(case, None, &mut workspace).unwrap());
}

#[divan::bench(args = STEPS)]
fn unloaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    measure(bencher, &options(steps, Drive::Tension), &Case::with_tensions(&[TENSION]));
}

fn loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(0.0, 0.0, -9.80665)),
        tip_force: Vec3::new(0.05, 0.0, 0.02),
        tip_moment: Vec3::new(0.0, 1e-3, 5e-4),
        ..Loads::default()
    }
}

fn by_length() -> Case {
    Case::with_shortenings(&[Shortening::Fraction(0.057)])
}

#[divan::bench(args = STEPS)]
fn loaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case { loads: loads(), ..Case::with_tensions(&[TENSION]) };
    measure(bencher, &options(steps, Drive::Tension), &case);
}

#[divan::bench(args = STEPS)]
fn by_length_cold(bencher: Bencher<'_, '_>, steps: usize) {
    measure(bencher, &options(steps, Drive::Shortening), &by_length());
}

#[divan::bench(args = STEPS)]
fn by_length_loaded_cold(bencher: Bencher<'_, '_>, steps: usize) {
    let case = Case { loads: loads(), ..by_length() };
    measure(bencher, &options(steps, Drive::Shortening), &case);
}

/// To the default tolerance of 1e-9 of the length, with the estimate of the error and the stability.
#[divan::bench]
fn unloaded_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    measure(bencher, &Options::default(), &Case::with_tensions(&[TENSION]));
}

#[divan::bench]
fn loaded_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    let case = Case { loads: loads(), ..Case::with_tensions(&[TENSION]) };
    measure(bencher, &Options::default(), &case);
}

#[divan::bench]
fn by_length_cold_to_tolerance(bencher: Bencher<'_, '_>) {
    measure(bencher, &Options::default(), &by_length());
}
