//! Rows per second of batches: `cargo bench -p whipcord --bench batch --features parallel`.
//!
//! The paper's rod. One cable is that of its case III; further cables run as it does, turned about the
//! backbone, and all together pull with up to the weight of 400 g. `default_options` is what a user gets:
//! steps halved until the estimated error is below 1e-6 of the length (9 and 18 steps for most of these
//! robots), and the stability. `twelve_steps` leaves an error below 1e-6 of the length (see
//! `benches/cosserat.rs`).
//!
//! What bounds it. A step of a rod with one cable, for all lanes, is three sections of about a hundred
//! additions and multiplications, four divisions and a square root for each iteration, and some three
//! hundred for the Magnus exponent, its exponential and the product of frames. Nothing is loaded but the
//! robot's own nodes, some 30 numbers to each, which stay in the first-level cache and serve all rows;
//! a row writes half a kilobyte. The three sections do not wait for one another, so that it is the
//! throughput of the arithmetic that should count, divisions and square roots first, and neither memory nor
//! a chain of dependencies. With AVX2 callgrind counts 1640 instructions for a step of four rows. With
//! several cables Newton's method takes one 3×3 system to a section, whose forces hardly strain it; a quarter
//! of the time goes by in divisions and square roots, and what does not fit the registers goes to the first-level
//! cache and back. Of the 36 sections of these robots 16 are others, turned or on the way back, and not solved.
//! A group of loaded rows takes some ten shots of `benches/cosserat.rs`, each in lanes.
//!
//! Processor time for a row in µs, on two cores of a Zen server that a dozen other programs ran on at the
//! time (to compare with one another; nothing was measured on a quiet machine), with twelve steps and
//! one, three and six cables: row by row 3.4, 18 and 24; in eight lanes 0.67, 2.5 and 3.6; in four lanes
//! one and three cables 0.85 and 3.9. With the default options, in eight lanes, 0.47, 2.9 and 4.3; under
//! load, row by row, 38 with one cable and 87 with three. Two threads
//! took as much processor time as one, to within 1 % row by row, under load and with the default options:
//! sharing the rows costs nothing that shows.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use core::num::NonZeroUsize;

use divan::Bencher;
use divan::counter::ItemsCount;
use whipcord::batch::{Arrays, BatchOptions, Rows, Width, solve_batch_into};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Model, Robot, Routing, Section, Vec3,
};

fn main() {
    divan::main();
}

fn robot(cables: usize) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let cable = |i: usize| {
        let holes = [1, 2, 3, 4, 4, 4, 4, 3, 2, 1].map(|hole| (hole - 1 + 2 * i) % 12 + 1);
        Cable::new(format!("cable {i}"), Routing::holes(holes.to_vec()))
    };
    Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap()
}

fn bench(
    bencher: Bencher,
    (rows, cables): (usize, usize),
    model: Options,
    case: &Case,
    options: &BatchOptions<'_>,
) {
    let robot = robot(cables);
    // From nothing to the weight of 400 g, shared among the cables.
    let most = 0.4 * 9.80665 / cables as f64;
    let count = rows * cables;
    let tensions: Vec<f64> =
        (0..count).map(|i| most * (i * 7919 % count) as f64 / count as f64).collect();
    let model = Model::Cosserat(model);
    let mut memory = [10 * 3, 10 * 4, cables, cables].map(|width| vec![0.0; rows * width]);
    bencher.counter(ItemsCount::new(rows)).bench_local(|| {
        let [positions, orientations, tensions_out, lengths] = &mut memory;
        let arrays = Arrays { positions, orientations, tensions: tensions_out, lengths };
        let rows = Rows::Tensions { values: &tensions, case };
        solve_batch_into(&model, &robot, rows, options, arrays).unwrap()
    });
}

fn threads(count: usize) -> BatchOptions<'static> {
    BatchOptions { threads: NonZeroUsize::new(count), ..BatchOptions::default() }
}

/// With a residual in keeping with the error of these steps.
fn twelve() -> Options {
    Options { accuracy: Accuracy::Steps(12), residual: 5e-7, ..Options::default() }
}

#[divan::bench(args = [1, 3, 6], consts = [1, 2], sample_count = 20)]
fn default_options<const THREADS: usize>(bencher: Bencher, cables: usize) {
    let size = (5_000, cables);
    bench(bencher, size, Options::default(), &Case::default(), &threads(THREADS));
}

#[divan::bench(args = [1, 3, 6], consts = [1, 2], sample_count = 20)]
fn twelve_steps<const THREADS: usize>(bencher: Bencher, cables: usize) {
    bench(bencher, (10_000, cables), twelve(), &Case::default(), &threads(THREADS));
}

#[divan::bench(args = [1, 3, 6], sample_count = 10)]
fn twelve_steps_four_lanes(bencher: Bencher, cables: usize) {
    let options = BatchOptions { width: Width::Avx2, ..threads(1) };
    bench(bencher, (5_000, cables), twelve(), &Case::default(), &options);
}

#[divan::bench(args = [1, 3, 6], consts = [1, 2], sample_count = 10)]
fn twelve_steps_row_by_row<const THREADS: usize>(bencher: Bencher, cables: usize) {
    let options = BatchOptions { no_lanes: true, ..threads(THREADS) };
    bench(bencher, (2_000, cables), twelve(), &Case::default(), &options);
}

#[divan::bench(args = [1, 3], consts = [1, 2], sample_count = 10)]
fn loaded<const THREADS: usize>(bencher: Bencher, cables: usize) {
    let loads = Loads { tip_force: Vec3::new(0.02, 0.01, -0.02), ..Loads::default() };
    let case = Case { loads, ..Case::default() };
    bench(bencher, (500, cables), Options::default(), &case, &threads(THREADS));
}
