//! Time of one four-bar solve, building its solution included.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use divan::{Bencher, black_box};
use whipcord::four_bar::{Chord, FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{Backbone, Cable, Case, Disks, Material, Robot, Routing, Shortening};

fn main() {
    divan::main();
}

fn backbone() -> Backbone {
    let material = Material { poisson_ratio: Some(0.3), ..Material::default() };
    Backbone { material, ..Backbone::new(0.18) }
}

/// The paper's case III.
fn case_iii() -> Robot {
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let cable = Cable::new("pull", Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]));
    Robot::new(backbone(), disks, vec![cable]).unwrap()
}

fn run(bencher: Bencher, robot: &Robot, options: Options, shortenings: &[f64]) {
    let model = FourBar::new(robot, &options).unwrap();
    let shortenings: Vec<_> = shortenings.iter().map(|&f| Shortening::Fraction(f)).collect();
    let case = Case::with_shortenings(&shortenings);
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(black_box(&case), None, &mut workspace).unwrap());
}

#[divan::bench]
fn case_iii_default(bencher: Bencher) {
    run(bencher, &case_iii(), Options::default(), &[0.057]);
}

#[divan::bench]
fn case_iii_with_derivatives(bencher: Bencher) {
    let model = FourBar::new(&case_iii(), &Options::default()).unwrap();
    let case = Case::with_shortenings(&[Shortening::Fraction(0.057)]);
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve_with_derivatives(black_box(&case), &mut workspace).unwrap());
}

#[divan::bench]
fn case_iii_strain_energy(bencher: Bencher) {
    let options = Options { objective: Objective::StrainEnergy, ..Options::default() };
    run(bencher, &case_iii(), options, &[0.057]);
}

#[divan::bench]
fn case_iii_arc(bencher: Bencher) {
    run(bencher, &case_iii(), Options { chord: Chord::Arc, ..Options::default() }, &[0.057]);
}

#[divan::bench]
fn case_iii_equal(bencher: Bencher) {
    run(
        bencher,
        &case_iii(),
        Options { lengths: LengthRule::Equal, ..Options::default() },
        &[0.057],
    );
}

#[divan::bench]
fn case_iii_free(bencher: Bencher) {
    run(
        bencher,
        &case_iii(),
        Options { lengths: LengthRule::Free, ..Options::default() },
        &[0.057],
    );
}

#[divan::bench]
fn three_cables(bencher: Bencher) {
    let cables = (0..3)
        .map(|i| {
            let start_angle = 2.0 * std::f64::consts::PI * f64::from(i) / 3.0;
            Cable::new(format!("{i}"), Routing::Helix { start_angle, turns: 0.5, radius: 0.008 })
        })
        .collect();
    let robot = Robot::new(backbone(), Disks::equally_spaced(0.18, 10, 0.008), cables).unwrap();
    run(bencher, &robot, Options::default(), &[0.06, 0.01, -0.08]);
}

#[divan::bench(args = [5, 10, 20, 40, 80, 160, 320])]
fn sections(bencher: Bencher, count: usize) {
    let cable = Cable::new("a", Routing::Helix { start_angle: 0.0, turns: 0.75, radius: 0.008 });
    let disks = Disks::equally_spaced(0.18, count + 1, 0.008);
    let robot = Robot::new(backbone(), disks, vec![cable]).unwrap();
    run(bencher, &robot, Options::default(), &[0.057]);
}
