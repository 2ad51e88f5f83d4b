//! A fit of four parameters to thirty measured shapes: `cargo bench -p whipcord --bench identification`.
//!
//! The paper's rod with three cables, pulled in thirty ways; nine disks are seen in each, to 0.2 mm. The diameter,
//! what the first cable's tension is more than commanded, and where the base is in x and how it is turned about y
//! are estimated, from a start that is off by 10 %, 0.2 N, 2 mm and 3°.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use divan::Bencher;
use whipcord::{Cable, Case, Loads, Model, ModelKind, Robot, Routing, Vec3};
use whipcord_estimation::identification::{Experiment, Settings, Unknown, identify};
use whipcord_estimation::{Observation, Place, Seen};

#[allow(dead_code, reason = "not every benchmark needs all of it")]
#[path = "../../whipcord/benches/case_3/mod.rs"]
mod case_3;

fn main() {
    divan::main();
}

fn robot() -> Robot {
    let plain = case_3::robot();
    let cable = |i: usize| {
        let angle = i as f64 * core::f64::consts::TAU / 3.0;
        Cable::new(format!("cable {i}"), Routing::Straight { angle, radius: 0.008 })
    };
    Robot::new(plain.backbone().clone(), plain.disks().clone(), (0..3).map(cable).collect())
        .unwrap()
}

/// Thirty cases with these loads, and what is seen of the robot in them.
fn experiments(model: &Model, robot: &Robot, loads: &Loads) -> Vec<Experiment> {
    let mut prepared = model.prepare(robot, loads).unwrap();
    (0..30)
        .map(|k| {
            let tension = |i: usize| 1.5 + 1.4 * (f64::from(k) * (1.0 + 0.37 * i as f64)).sin();
            let case =
                Case { loads: loads.clone(), ..Case::with_tensions(&[0, 1, 2].map(tension)) };
            let solution = prepared.solve(&case, None).unwrap();
            let poses = solution.disks.poses.iter().enumerate().skip(1);
            let observations = poses.map(|(disk, pose)| {
                let wave =
                    |i: usize| 2e-4 * (f64::from(k) * 3.1 + (disk * 3 + i) as f64 * 1.7).sin();
                Observation {
                    step: 0,
                    place: Place::Disk(disk),
                    offset: Vec3::ZERO,
                    seen: Seen::Position(pose.position + Vec3::new(wave(0), wave(1), wave(2))),
                    deviation: None,
                }
            });
            Experiment { observations: observations.collect(), case, ..Experiment::default() }
        })
        .collect()
}

fn unknowns() -> Vec<Unknown> {
    [
        ("backbone.diameter", 0.0033),
        ("cables[0].tension_offset", 0.2),
        ("base.position[0]", 0.002),
        ("base.turn[1]", 0.05),
    ]
    .map(|(path, start)| Unknown { start: Some(start), ..Unknown::new(path.parse().unwrap()) })
    .to_vec()
}

fn fit(bencher: Bencher, kind: ModelKind, loads: &Loads) {
    let settings = Settings::new(Model::new(kind, Default::default(), Default::default()));
    let robot = robot();
    let seen = experiments(&settings.model, &robot, loads);
    let unknowns = unknowns();
    let found = identify(&robot, &seen, &unknowns, &settings).unwrap();
    assert!(found.status.is_converged());
    assert!((found.estimates[0].value / 0.003 - 1.0).abs() < 1e-2);
    bencher.bench_local(|| identify(&robot, &seen, &unknowns, &settings).unwrap());
}

#[divan::bench(sample_count = 30)]
fn thirty_shapes(bencher: Bencher) {
    fit(bencher, ModelKind::Cosserat, &Loads::default());
}

#[divan::bench(sample_count = 10)]
fn thirty_shapes_with_a_tip_force(bencher: Bencher) {
    let loads = Loads { tip_force: Vec3::new(0.05, 0.0, 0.02), ..Loads::default() };
    fit(bencher, ModelKind::Cosserat, &loads);
}

/// By differences.
#[divan::bench(sample_count = 3)]
fn thirty_shapes_straight_between_disks(bencher: Bencher) {
    fit(bencher, ModelKind::CosseratDisks, &Loads::default());
}
