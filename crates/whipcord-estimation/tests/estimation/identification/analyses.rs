//! What is said of a fit besides its estimates.

use super::laboratory::{
    FILE, Truth, measure, random_rows, robot, settings, unknowns, unknowns_of,
};
use crate::common::{paper_backbone, straight};
use crate::identification::synthetic::{Normal, disturb};
use whipcord::{Cable, Case, Disks, Motor, Robot, Shortening, Vec3};
use whipcord_estimation::identification::{
    Experiment, IdentifyError, Quantity, Row, cross_validate, drift, hold_out, identify, ladder,
    profile, repeatability, rows, sensitivity, single_cable, split, suspects,
};
use whipcord_estimation::{Observation, Place, Seen};

const NOISE: f64 = 2e-4;
const REAL: Truth = Truth { stiffness: 5e3, offsets: [0.02, -0.01, 0.03], ..FILE };

fn seen(truth: &Truth, count: usize) -> Experiment {
    let mut random = Normal::new(11);
    let rows = random_rows(count, &mut random);
    measure(truth, &rows, NOISE, &mut random)
}

const PATHS: [&str; 4] = [
    "motors[*].stiffness",
    "motors[0].angle_offset",
    "motors[1].angle_offset",
    "motors[2].angle_offset",
];

#[test]
fn rows_without_an_answer_are_left_out() {
    let mut seen = seen(&REAL, 12);
    // No cable is that long. Motors command the cables anew, so that this one has none.
    for step in &mut seen.case.motors {
        step[0] = None;
    }
    for (k, step) in seen.case.before.iter_mut().enumerate() {
        step[0].shortening = Some(Shortening::Length(if k == 4 { 0.5 } else { 0.002 }));
    }
    let unknowns = unknowns(&["motors[*].stiffness"]);
    let file = robot(&FILE);
    let error = identify(&file, &[seen.clone()], &unknowns, &settings()).unwrap_err();
    assert!(matches!(error, IdentifyError::NoAnswerAtStart(_)), "{error}");
    let mut skipping = settings();
    skipping.skips = true;
    let found = identify(&file, &[seen.clone()], &unknowns, &skipping).unwrap();
    let [skipped] = &found.skipped[..] else { panic!("{:?}", found.skipped) };
    assert_eq!(skipped.row, Row { experiment: 0, step: 4 });
    assert_eq!(found.residuals.len(), 22);
    let of = |i: usize| seen.observations[found.residuals[i].observation].step;
    assert_eq!([of(7), of(8), of(21)], [3, 5, 11]);
}

#[test]
fn groups_of_rows_are_held_out_together() {
    let mut seen = seen(&REAL, 24);
    let file = robot(&FILE);
    let unknowns = unknowns(&PATHS);
    // Many single rows are held out in blocks.
    let blocks = cross_validate(&file, &[seen.clone()], &unknowns, &settings()).unwrap();
    assert_eq!(blocks.folds.len(), 8);
    assert!(blocks.folds.iter().all(|fold| fold.rows.len() == 3 && fold.group.is_none()));
    for (k, label) in seen.labels.iter_mut().enumerate() {
        label.group = Some(format!("motion {}", k % 4));
    }
    let groups = cross_validate(&file, &[seen.clone()], &unknowns, &settings()).unwrap();
    let names: Vec<_> = groups.folds.iter().map(|fold| fold.group.clone().unwrap()).collect();
    assert_eq!(names, ["motion 0", "motion 1", "motion 2", "motion 3"]);
    assert!(groups.folds.iter().all(|fold| fold.rows.len() == 6));
    // What was not seen is as far off as the noise of three coordinates.
    for rms in [blocks.rms_distance, groups.rms_distance] {
        assert!((rms.unwrap() / (NOISE * 3f64.sqrt()) - 1.0).abs() < 0.2, "{rms:?}");
    }
    let [kept, held] = split(&[seen.clone()], 0.2, 7).unwrap();
    assert_eq!((rows(&kept).len(), rows(&held).len()), (18, 6));
    assert_eq!(split(&[seen.clone()], 0.2, 7).unwrap(), [kept.clone(), held.clone()]);
    let found = identify(&file, &kept, &unknowns, &settings()).unwrap();
    let values: Vec<f64> = found.estimates.iter().map(|of| of.value).collect();
    let test = hold_out(&file, &held, &unknowns, &settings(), &values).unwrap();
    assert_eq!((test.rows.len(), test.skipped.len()), (6, 0));
    assert!((test.rms_distance.unwrap() / (NOISE * 3f64.sqrt()) - 1.0).abs() < 0.35, "{test:?}");
    let refused = split(&held, 0.2, 1).unwrap_err();
    assert_eq!(refused, IdentifyError::NothingToHoldOut);
}

/// Each rung with another unknown is nearer to what it has not seen.
#[test]
fn the_ladder_goes_down() {
    let seen = [seen(&REAL, 15)];
    let rungs = ladder(&robot(&FILE), &seen, &unknowns(&PATHS), &settings()).unwrap();
    assert!(rungs.iter().map(|rung| rung.unknowns).eq(0..5));
    let mut held: Vec<f64> = vec![rungs[0].rms_distance.unwrap()];
    held.extend(
        rungs[1..].iter().map(|rung| rung.validated.as_ref().unwrap().rms_distance.unwrap()),
    );
    assert!(held[0] > 4.0 * held[4], "{held:?}");
    assert!((held[4] / (NOISE * 3f64.sqrt()) - 1.0).abs() < 0.35, "{held:?}");
}

/// One clamp slipped by 2 mm, or one hole was drilled 8° off: the cable is named, and what it is off by.
#[test]
fn one_cable_that_stands_out_is_named() {
    let file = robot(&FILE);
    let unknowns = unknowns(&["motors[*].stiffness"]);
    for (truth, expected, change) in [
        (
            Truth { slack: [0.0, -2e-3, 0.0], ..FILE },
            Quantity::ShorteningOffset { cable: 1 },
            -2e-3,
        ),
        (
            Truth { angles: [0.0, 0.0, 0.14], ..FILE },
            "cables[2].routing.angle".parse().unwrap(),
            0.14,
        ),
    ] {
        let seen = [seen(&truth, 30)];
        let found = identify(&file, &seen, &unknowns, &settings()).unwrap();
        let all = suspects(&file, &seen, &unknowns, &settings(), &found).unwrap();
        let first = &all[0];
        assert_eq!(first.quantity, expected, "{all:#?}");
        let confirmed = first.confirmed.expect("it stands out");
        assert!((confirmed.change / change - 1.0).abs() < 0.1, "{confirmed:?}");
        let [before, after] = confirmed.rms_distance.unwrap();
        assert!(before > 2.0 * after && after < 1.2 * NOISE * 3f64.sqrt(), "{confirmed:?}");
        // What it is off by was estimated to first order without a fit.
        assert!((first.change / change - 1.0).abs() < 0.5, "{first:?}");
    }
    let seen = [seen(&Truth { stiffness: 5e3, ..FILE }, 30)];
    let found = identify(&file, &seen, &unknowns, &settings()).unwrap();
    let all = suspects(&file, &seen, &unknowns, &settings(), &found).unwrap();
    assert!(all.iter().all(|suspect| suspect.confirmed.is_none()), "{all:#?}");
}

/// The same without a fit by the caller; and a robot that is as its file says, but for the stiffness of its drives, is not accused.
#[test]
fn one_cable_is_named_in_measurements_that_were_not_fitted() {
    let file = robot(&FILE);
    let truth = Truth { stiffness: 5e3, slack: [0.0, 0.0, 2e-3], ..FILE };
    let named = single_cable(&file, &[seen(&truth, 300)], &settings()).unwrap().unwrap();
    assert_eq!(named.quantity, Quantity::ShorteningOffset { cable: 2 });
    let change = named.confirmed.unwrap().change;
    assert!((change / 2e-3 - 1.0).abs() < 0.1, "{change}");
    for truth in [FILE, Truth { stiffness: 5e3, ..FILE }] {
        assert_eq!(single_cable(&file, &[seen(&truth, 30)], &settings()).unwrap(), None);
    }
    // So is it where a tracker jumped in some rows.
    let mut jumped = seen(&truth, 300);
    for of in jumped.observations.iter_mut().skip(7).step_by(31) {
        if let Seen::Position(position) = &mut of.seen {
            *position += Vec3::new(0.2, 0.1, -0.1);
        }
    }
    let named = single_cable(&file, &[jumped], &settings()).unwrap().unwrap();
    assert_eq!(named.quantity, Quantity::ShorteningOffset { cable: 2 });
    let [before, after] = named.confirmed.unwrap().rms_distance.unwrap();
    // Without the jumps, of 0.24 m in each 31st row.
    assert!(before < 0.02 && after < 1.3 * NOISE * 3f64.sqrt(), "{before} {after}");
    // Of too few rows nothing is said.
    assert_eq!(single_cable(&file, &[seen(&truth, 5)], &settings()).unwrap(), None);
}

/// Four cables, each with a motor: the zero of one, and that of its antagonist the other way, do nearly the same.
#[test]
fn a_cable_stands_out_with_its_antagonist() {
    let robot = |zeros: [f64; 4]| {
        let cables =
            [0.0, 90.0, 180.0, 270.0].map(|angle| Cable::new(format!("c{angle}"), straight(angle)));
        let motors = zeros.into_iter().enumerate().map(|(i, offset)| Motor {
            stiffness: Some(8e3),
            pretension: 30.0,
            offset,
            ..Motor::spool(format!("m{i}"), [(i, 0.01)])
        });
        let disks = Disks::equally_spaced(0.18, 10, 0.009);
        let robot = Robot::new(paper_backbone(), disks, cables.to_vec()).unwrap();
        robot.with_motors(motors.collect()).unwrap()
    };
    let mut random = Normal::new(4);
    let mut angle = || 0.5 * (random.uniform() - 0.5);
    let rows: Vec<[f64; 2]> = (0..40).map(|_| [angle(), angle()]).collect();
    let case = |robot: &Robot| {
        let none = vec![Default::default(); 4];
        let motors = rows.iter().map(|[a, b]| [*a, *b, -a, -b].map(Some).to_vec());
        let before = vec![none.clone(); rows.len() - 1];
        let mut case = Case { commands: none, before, motors: motors.collect(), ..Case::default() };
        case.drive(robot).unwrap();
        case
    };
    // 2 mm of one cable.
    let real = robot([0.0, 0.0, 0.2, 0.0]);
    let of_real = case(&real);
    let mut prepared = settings().model.prepare(&real, &of_real.loads).unwrap();
    let mut observations = Vec::new();
    prepared
        .solve_steps(&of_real, |solution| {
            observations.push(Observation {
                step: observations.len(),
                place: Place::Disk(9),
                offset: Vec3::ZERO,
                seen: Seen::Position(solution.disks.poses[9].position),
                deviation: None,
            });
        })
        .unwrap();
    let file = robot([0.0; 4]);
    let case = case(&file);
    let mut seen = vec![Experiment { case, observations, ..Experiment::default() }];
    disturb(&mut seen, &mut random, [NOISE, 0.0]);
    let named = single_cable(&file, &seen, &settings()).unwrap().unwrap();
    let (
        Quantity::ShorteningOffset { cable: first },
        [(Quantity::ShorteningOffset { cable: other }, false)],
    ) = (named.quantity, named.alike.as_slice())
    else {
        panic!("{named:?}");
    };
    assert_eq!([first.min(*other), first.max(*other)], [0, 2], "{named:?}");
    let change = named.confirmed.unwrap().change.abs();
    assert!((0.5e-3..=2.5e-3).contains(&change), "{change}");
}

/// Commands that come back, with noise; and from opposite sides, with a lag of the shape.
#[test]
fn repeatability_is_the_scatter_of_equal_commands() {
    let mut random = Normal::new(3);
    let mut rows = Vec::new();
    for _ in 0..12 {
        // Up and down: each command is approached from both sides.
        rows.extend([0.0, 0.2, 0.4, 0.6, 0.4, 0.2].map(|a: f64| [a, -0.5 * a, -0.5 * a]));
    }
    let mut seen = measure(&Truth { backlash: 0.0, ..FILE }, &rows, NOISE, &mut random);
    let found = identify(&robot(&FILE), &[seen.clone()], &unknowns(&PATHS), &settings()).unwrap();
    let figure = repeatability(&[seen.clone()], &found).unwrap();
    let noise = NOISE * 3f64.sqrt();
    assert!((figure.rms_distance / noise - 1.0).abs() < 0.15, "{figure:?}");
    // The way up and the way down differ by 1 mm.
    for of in &mut seen.observations {
        if let (Seen::Position(position), 4 | 5) = (&mut of.seen, of.step % 6) {
            *position += Vec3::new(0.0, 1e-3, 0.0);
        }
    }
    let found = identify(&robot(&FILE), &[seen.clone()], &unknowns(&PATHS), &settings()).unwrap();
    let figure = repeatability(&[seen], &found).unwrap();
    let (_, same) = figure.same_side.unwrap();
    let (_, opposite) = figure.opposite_sides.unwrap();
    assert!((same / (noise * 2f64.sqrt()) - 1.0).abs() < 0.15, "{figure:?}");
    assert!((opposite / (1e-6 + 2.0 * noise * noise).sqrt() - 1.0).abs() < 0.15, "{figure:?}");
}

#[test]
fn drift_is_told_from_noise() {
    let mut seen = seen(&FILE, 40);
    for (k, label) in seen.labels.iter_mut().enumerate() {
        label.time = Some(10.0 * k as f64);
    }
    let unknowns = unknowns(&["motors[*].stiffness"]);
    let of = |seen: &Experiment| {
        let seen = core::slice::from_ref(seen);
        let found = identify(&robot(&FILE), seen, &unknowns, &settings()).unwrap();
        drift(seen, &found).unwrap()
    };
    let still = of(&seen);
    assert!(!still.is_significant && still.rows == 40, "{still:?}");
    for of in &mut seen.observations {
        if let Seen::Position(position) = &mut of.seen {
            position.x += 1e-6 * 10.0 * of.step as f64;
        }
    }
    let moved = of(&seen);
    // Model less measurement.
    assert!(
        moved.is_significant && (moved.slope[0] + 1e-6).abs() < 4.0 * moved.deviation[0],
        "{moved:?}"
    );
    assert_eq!(moved.duration, 390.0);
}

/// Of what is well determined the profile is the parabola of the standard deviation; of a stiff drive only that it is not soft.
#[test]
fn profiles_of_what_is_and_is_not_determined() {
    let file = robot(&FILE);
    let seen_of = |stiffness: f64| [seen(&Truth { stiffness, ..FILE }, 20)];
    let unknowns = unknowns(&["motors[*].stiffness", "motors[0].angle_offset"]);
    let measured = seen_of(5e3);
    let found = identify(&file, &measured, &unknowns, &settings()).unwrap();
    for j in 0..2 {
        let profile = profile(&file, &measured, &unknowns, &settings(), &found, j).unwrap();
        let ends = found.estimates[j].interval.unwrap();
        let width = ends[1] - ends[0];
        for (end, of_profile) in ends.into_iter().zip(profile.interval) {
            assert!((of_profile.unwrap() - end).abs() < 0.03 * width, "{profile:?} {ends:?}");
        }
        assert!(profile.points.iter().all(|[_, rise]| *rise < 2.0 * profile.limit));
    }
    // Of zeros that can hardly be told apart, a value that contradicts the measurements is beyond an end.
    let zeros = ["motors[0].angle_offset", "motors[1].angle_offset", "motors[2].angle_offset"];
    let zeros = unknowns_of(&file, &zeros);
    let found = identify(&file, &measured, &zeros, &settings()).unwrap();
    for j in 0..3 {
        let profile = profile(&file, &measured, &zeros, &settings(), &found, j).unwrap();
        let estimate = found.estimates[j].value;
        for (side, end) in [-1.0, 1.0].into_iter().zip(profile.interval) {
            let outside = |of: &&[f64; 2]| side * (of[0] - estimate) > 0.0 && of[1] > profile.limit;
            let contradicts = profile.points.iter().filter(outside).count() > 0;
            assert!(!contradicts || end.is_some(), "{profile:?}");
        }
    }
    let measured = seen_of(5e6);
    let mut stiff: Vec<_> = unknowns[..1].to_vec();
    // Where cables go slack and come taut there are minima besides the lowest.
    stiff[0].start = Some(5e5);
    let found = identify(&file, &measured, &stiff, &settings()).unwrap();
    let profile = profile(&file, &measured, &stiff, &settings(), &found, 0).unwrap();
    let [low, high] = profile.interval;
    assert!(low.unwrap() > 3e4 && high.is_none(), "{profile:?}");
}

/// What is promised of one more measurement is what a fit with it gives.
#[test]
fn one_more_measurement_is_worth_what_is_said() {
    let file = robot(&FILE);
    let unknowns = unknowns(&PATHS[..3]);
    let mut measured = seen(&REAL, 4);
    for seen in &mut measured.observations {
        seen.deviation = Some(NOISE);
    }
    let found = identify(&file, &[measured.clone()], &unknowns, &settings()).unwrap();
    let worths = sensitivity(&file, &[measured.clone()], &unknowns, &settings(), &found).unwrap();
    assert_eq!(worths.len(), 4 * 9);
    let most = worths.iter().max_by(|a, b| a.volume.total_cmp(&b.volume)).unwrap();
    let mut more = measured;
    // Seen where the fitted model has it, so that the estimates stay.
    let step = more.case.step(most.row.step).unwrap();
    let mut prepared = settings().model.prepare(&found.robot, &step.loads).unwrap();
    let fitted = found.cases[0].step(most.row.step).unwrap();
    let solution = prepared.solve(&fitted, None).unwrap();
    more.observations.push(Observation {
        step: most.row.step,
        place: Place::Disk(most.disk),
        offset: Vec3::ZERO,
        seen: Seen::Position(solution.disks.poses[most.disk].position),
        deviation: Some(NOISE),
    });
    let again = identify(&file, &[more], &unknowns, &settings()).unwrap();
    for j in 0..3 {
        let fallen =
            (again.estimates[j].deviation.unwrap() / found.estimates[j].deviation.unwrap()).powi(2);
        assert!((1.0 - fallen - most.variances[j]).abs() < 2e-3, "{j} {fallen} {most:?}");
    }
}
