//! Fits of many rows: the same for any number of threads, and how long they take.

use core::num::NonZero;
use std::time::Instant;

use super::laboratory::{FILE, Truth, measure_by, random_path, random_rows, robot, unknowns_of};
use crate::identification::synthetic::{Normal, model};
use whipcord::ModelKind;
use whipcord_estimation::Observation;
use whipcord_estimation::identification::{Experiment, Identified, Settings, identify};

const TWELVE: [&str; 12] = [
    "motors[*].stiffness",
    "motors[0].angle_offset",
    "motors[1].angle_offset",
    "motors[2].angle_offset",
    "cables[0].routing.angle",
    "cables[1].routing.angle",
    "cables[2].routing.angle",
    "cables[*].routing.radius",
    "backbone.young_modulus",
    "measured.offset[0]",
    "measured.offset[1]",
    "measured.offset[2]",
];

fn laboratory(kind: ModelKind, rows: usize) -> Experiment {
    // Without backlash, which remembers the rows before.
    let truth = Truth {
        stiffness: 6e3,
        backlash: 0.0,
        offsets: [0.02, -0.03, 0.01],
        angles: [0.02, 0.01, -0.02],
        ..FILE
    };
    let mut random = Normal::new(1);
    let rows = random_rows(rows, &mut random);
    let mut seen = measure_by(&model(kind), &truth, &rows, 3e-4, &mut random);
    seen.case.independent = true;
    seen
}

fn fit(kind: ModelKind, seen: &Experiment, paths: &[&str], threads: usize) -> Identified {
    let file = robot(&Truth { backlash: 0.0, ..FILE });
    let settings = Settings { threads: NonZero::new(threads), ..Settings::new(model(kind)) };
    let unknowns = unknowns_of(&file, paths);
    identify(&file, core::slice::from_ref(seen), &unknowns, &settings).unwrap()
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // By exact derivatives, and by differences.
    for (kind, paths) in [
        (ModelKind::Cosserat, &TWELVE[..]),
        (ModelKind::ConstantCurvature, &["cables[*].routing.radius"]),
    ] {
        let seen = laboratory(ModelKind::Cosserat, 30);
        let all = [1, 2, 3].map(|threads| fit(kind, &seen, paths, threads));
        for other in &all[1..] {
            assert_eq!(all[0].evaluations, other.evaluations);
            for (a, b) in all[0].estimates.iter().zip(&other.estimates) {
                assert_eq!(a.value.to_bits(), b.value.to_bits(), "{}", a.unknown);
                assert_eq!(a.deviation.map(f64::to_bits), b.deviation.map(f64::to_bits));
            }
            assert_eq!(all[0].residuals, other.residuals);
        }
    }
}

/// Rows of a table that are independent are experiments by themselves.
#[test]
fn independent_rows_are_separate_experiments() {
    let together = laboratory(ModelKind::Cosserat, 9);
    let steps = together.case.before.len() + 1;
    let apart: Vec<Experiment> = (0..steps)
        .map(|step| Experiment {
            case: together.case.independent_step(step).unwrap(),
            observations: together
                .observations
                .iter()
                .filter(|seen| seen.step == step)
                .map(|seen| Observation { step: 0, ..*seen })
                .collect(),
            ..Experiment::default()
        })
        .collect();
    let file = robot(&Truth { backlash: 0.0, ..FILE });
    let unknowns = unknowns_of(&file, &TWELVE[..7]);
    let settings = Settings::new(model(ModelKind::Cosserat));
    let fit = |seen: &[Experiment]| identify(&file, seen, &unknowns, &settings).unwrap();
    let (one, many) = (fit(&[together]), fit(&apart));
    for (a, b) in one.estimates.iter().zip(&many.estimates) {
        assert_eq!(a.value.to_bits(), b.value.to_bits(), "{}", a.unknown);
    }
    assert_eq!(one.answers, many.answers);
}

/// `cargo test --release -p whipcord-estimation --test estimation -- --ignored --nocapture speed_of`
#[test]
#[ignore = "times, which depend on the machine"]
fn speed_of_many_rows() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        if std::env::var("SPEED_OF").is_ok_and(|only| only != kind.to_string()) {
            continue;
        }
        let seen = laboratory(kind, 400);
        for threads in [1, 2] {
            let start = Instant::now();
            let found = fit(kind, &seen, &TWELVE, threads);
            println!(
                "{kind}: 12 parameters, 400 rows, {threads} threads: {:.2} s, {} evaluations, {:?}, {:.3} mm",
                start.elapsed().as_secs_f64(),
                found.evaluations,
                found.status,
                1e3 * found.rms_distance.unwrap()
            );
        }
    }
}

/// As above.
#[test]
#[ignore = "times, which depend on the machine"]
fn speed_of_friction() {
    let kind = ModelKind::CosseratDisks;
    let truth = Truth { stiffness: 5e3, friction: 0.15, ..FILE };
    let file = robot(&Truth { friction: 0.1, ..FILE });
    let mut random = Normal::new(1);
    let rows = random_path(8, &mut random);
    let seen = measure_by(&model(kind), &truth, &rows, 3e-4, &mut random);
    let unknowns = unknowns_of(&file, &["motors[*].stiffness", "cables[*].friction"]);
    let start = Instant::now();
    let found = identify(&file, &[seen], &unknowns, &Settings::new(model(kind))).unwrap();
    println!(
        "{kind}: friction, 8 steps: {:.2} s, {} evaluations, {:?}, {:.3} mm",
        start.elapsed().as_secs_f64(),
        found.evaluations,
        found.status,
        1e3 * found.rms_distance.unwrap()
    );
}
