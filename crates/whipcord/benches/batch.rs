//! Rows per second of unloaded batches of the paper's rod, 12 steps: `cargo bench -p whipcord --bench batch --features parallel`.
//!
//! One cable is that of the paper's case III, where 12 steps leave an error below 1e-6 of the
//! length (see `benches/cosserat.rs`); further cables run as it does, turned about the backbone.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use core::num::NonZeroUsize;

use divan::Bencher;
use divan::counter::ItemsCount;
use whipcord::batch::{Arrays, BatchOptions, Rows, solve_batch_into};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{Backbone, Cable, Case, Disks, Material, Model, Robot, Routing, Section, Stations};

fn main() {
    divan::main();
}

const ROWS: usize = 20_000;

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

fn bench(bencher: Bencher, cables: usize, options: &BatchOptions<'_>) {
    let robot = robot(cables);
    // From nothing to the weight of 400 g, shared among the cables.
    let most = 0.4 * 9.80665 / cables as f64;
    let count = ROWS * cables;
    let tensions: Vec<f64> =
        (0..count).map(|i| most * (i * 7919 % count) as f64 / count as f64).collect();
    let model = Model::Cosserat(Options {
        accuracy: Accuracy::Steps(12),
        stability: false,
        stations: Stations::Disks,
        ..Options::default()
    });
    let mut memory = [10 * 3, 10 * 4, cables, cables].map(|width| vec![0.0; ROWS * width]);
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
        let [positions, orientations, tensions_out, lengths] = &mut memory;
        let arrays = Arrays { positions, orientations, tensions: tensions_out, lengths };
        let rows = Rows::Tensions { values: &tensions, case: &Case::default() };
        solve_batch_into(&model, &robot, rows, options, arrays).unwrap()
    });
}

#[divan::bench(args = [1, 3, 6], consts = [1, 2], sample_count = 20)]
fn lanes<const THREADS: usize>(bencher: Bencher, cables: usize) {
    let threads = NonZeroUsize::new(THREADS);
    bench(bencher, cables, &BatchOptions { threads, ..BatchOptions::default() });
}

#[divan::bench(args = [1, 3, 6], consts = [1, 2], sample_count = 20)]
fn row_by_row<const THREADS: usize>(bencher: Bencher, cables: usize) {
    let threads = NonZeroUsize::new(THREADS);
    bench(bencher, cables, &BatchOptions { threads, no_lanes: true, ..BatchOptions::default() });
}
