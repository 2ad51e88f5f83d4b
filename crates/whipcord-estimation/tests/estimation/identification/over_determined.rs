//! Fits of rows whose cable lengths contradict each other.

use super::laboratory::random_rows;
use crate::common::{paper_backbone, straight};
use crate::identification::synthetic::{Normal, model};
use whipcord::{
    Backbone, Cable, Case, Disks, ModelKind, Robot, Routing, Shortening, UnitQuaternion, Vec3,
};
use whipcord_estimation::identification::{
    Experiment, ParameterPath, Settings, cross_validate, hold_out, identify, registered,
};
use whipcord_estimation::registration::Alignment;
use whipcord_estimation::{Observation, Place, Seen};

fn robot(radius: f64) -> Robot {
    let cables = [0.0, 120.0, 240.0].map(|degrees| {
        let Routing::Straight { angle, .. } = straight(degrees) else { unreachable!() };
        Cable::new(format!("c{degrees}"), Routing::Straight { angle, radius })
    });
    let backbone = Backbone { extensible: false, ..paper_backbone() };
    Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), cables.to_vec()).unwrap()
}

/// What a tracker sees of a robot whose shortenings have a sum of 0, where more is commanded, which drives and cables take up.
fn seen(radius: f64, independent: bool) -> Experiment {
    let mut random = Normal::new(3);
    let rows = random_rows(12, &mut random);
    let shortened = |row: &[f64; 3], more: f64| {
        Case::with_shortenings(&row.map(|by| Shortening::Length(0.01 * by + more))).commands
    };
    let mut all: Vec<_> = rows.iter().map(|row| shortened(row, 5e-4)).collect();
    let commands = all.pop().unwrap();
    let case = Case { commands, before: all, independent, ..Case::default() };
    let real = robot(radius);
    let mut prepared = model(ModelKind::Cosserat).prepare(&real, &case.loads).unwrap();
    let mut observations = Vec::new();
    for (step, row) in rows.iter().enumerate() {
        // The cable that pays out most has no say: the others have one shape.
        let mut given = Case { commands: shortened(row, 0.0), ..Case::default() };
        let last = (0..3).min_by(|a, b| row[*a].total_cmp(&row[*b])).unwrap();
        given.commands[last].shortening = Some(Shortening::Length(-0.02));
        let answer = prepared.solve(&given, None).unwrap();
        for disk in [4, 9] {
            observations.push(Observation {
                step,
                place: Place::Disk(disk),
                offset: Vec3::ZERO,
                seen: Seen::Position(answer.disks.poses[disk].position),
                deviation: None,
            });
        }
    }
    Experiment { case, observations, ..Experiment::default() }
}

#[test]
fn rows_with_contradictory_lengths_are_fitted_and_named() {
    for independent in [true, false] {
        let (file, seen) = (robot(0.008), [seen(0.0084, independent)]);
        let path: ParameterPath = "cables[*].routing.radius".parse().unwrap();
        let unknowns = [path.unknown(&file).unwrap()];
        let settings = Settings { skips: true, ..Settings::new(model(ModelKind::Cosserat)) };
        let found = identify(&file, &seen, &unknowns, &settings).unwrap();
        assert!(found.status.is_converged());
        // A change of each radius.
        let radius = found.estimates[0].value;
        assert!((radius - 4e-4).abs() < 3e-6, "{radius}");
        assert!(found.rms_distance.unwrap() < 3e-5, "{:?}", found.rms_distance);
        assert_eq!((found.skipped.len(), found.answers), (0, 12));
        assert_eq!(found.over_determined.len(), 12);
        for row in &found.over_determined {
            assert_eq!(row.misses.len(), 3);
            assert!(row.misses.iter().all(|miss| (miss.excess - 5e-4).abs() < 2e-6), "{row:?}");
        }
        let held = hold_out(&file, &seen, &unknowns, &settings, &[radius]).unwrap();
        assert_eq!((held.rows.len(), held.over_determined.len()), (12, 12));
        let folds = cross_validate(&file, &seen, &unknowns, &settings).unwrap();
        assert!(folds.rms_distance.unwrap() < 4e-5, "{:?}", folds.rms_distance);
        let strict = Settings { skips: false, ..settings };
        assert!(identify(&file, &seen, &unknowns, &strict).is_err());
    }
}

/// The frame of a tracker is found by rows that have a least-squares answer alone.
#[test]
fn a_tracker_in_a_frame_of_its_own_is_registered_by_them() {
    let (file, mut seen) = (robot(0.008), seen(0.008, true));
    let turn = UnitQuaternion::exp(Vec3::new(0.1, -0.2, 0.3));
    for of in &mut seen.observations {
        if let Seen::Position(position) = &mut of.seen {
            *position = turn.rotate(*position) + Vec3::new(0.1, 0.2, -0.1);
        }
    }
    seen.alignment = Alignment::Rigid;
    let settings = Settings { skips: true, ..Settings::new(model(ModelKind::Cosserat)) };
    let path: ParameterPath = "cables[*].routing.radius".parse().unwrap();
    let unknowns = [path.unknown(&file).unwrap()];
    let (seen, unknowns) = registered(&file, &[seen], &unknowns, false, &settings).unwrap();
    let found = identify(&file, &seen, &unknowns, &settings).unwrap();
    assert!(found.estimates[0].value.abs() < 1e-5, "{}", found.estimates[0].value);
    assert!(found.rms_distance.unwrap() < 3e-5);
    assert_eq!(found.over_determined.len(), 12);
}
