//! The relative pose of two cameras, from pairs of photographs of a board.

use core::f64::consts::PI;

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, Distortion, FreeParameters, Lens, Pinhole, RefusedPair, SeenByBoth, Sighting,
    StereoError, calibrate, calibrate_stereo,
};

use super::noise::Noise;

const SIZE: [u32; 2] = [640, 480];
const SQUARE: f64 = 0.025;

fn lenses() -> [Pinhole; 2] {
    let distortion = Distortion::new(&[-0.25, 0.08, 8e-4, -5e-4]).unwrap();
    [
        Pinhole::new([820.0, 815.0], [325.0, 236.0], distortion).unwrap(),
        Pinhole::new([700.0, 702.0], [315.0, 244.0], Distortion::NONE).unwrap(),
    ]
}

/// The second camera in the frame of the first.
fn relative() -> Pose {
    let rotation = UnitQuaternion::exp(Vec3::new(0.04, -0.55, 0.1));
    Pose { position: Vec3::new(0.28, -0.02, 0.06), rotation }
}

/// Inner corners of a chessboard of 9 by 6.
fn board() -> Vec<Vec3> {
    (0..54).map(|k| SQUARE * Vec3::new(f64::from(k % 9), f64::from(k / 9), 0.0)).collect()
}

/// After half a turn the board looks the same.
fn half_turn() -> Pose {
    let corners = board();
    let rotation = UnitQuaternion::exp(Vec3::new(0.0, 0.0, PI));
    let middle = 0.5 * (corners[0] + corners[53]);
    Pose { position: middle - rotation.rotate(middle), rotation }
}

/// What both cameras see of a board that is held up somewhere.
fn pair(noise: &mut Noise, deviation: f64) -> SeenByBoth {
    let mut tilt = || noise.between(-0.5, 0.5);
    let rotation = UnitQuaternion::exp(Vec3::new(tilt(), tilt() + 0.25, tilt()));
    let mut aside = || noise.between(-0.03, 0.03);
    let middle = Vec3::new(aside(), aside(), 0.5 + aside());
    let corners = board();
    let centre = 0.5 * (corners[0] + corners[53]);
    // The first camera in the frame of the board.
    let first = Pose { position: middle - rotation.rotate(centre), rotation }.inverse();
    let [a, b] = lenses();
    [(a, first), (b, first * relative())].map(|(lens, pose)| {
        let camera = Camera::new(Lens::Pinhole(lens), pose, Some(SIZE)).unwrap();
        let seen = corners.iter().map(|&point| {
            let pixel = camera.project(point).unwrap();
            Sighting { point, pixel: noise.beside(pixel, deviation) }
        });
        seen.collect()
    })
}

fn calibrated(
    pairs: &[SeenByBoth],
    symmetries: &[Pose],
) -> Result<whipcord_estimation::camera::StereoCalibration, StereoError> {
    let [a, b] = lenses();
    calibrate_stereo([&a, &b], [Some(SIZE); 2], pairs, symmetries)
}

/// Position and rotation by which a pose is off, along and about the axes of the first camera.
fn off(found: Pose) -> [f64; 6] {
    let shift = found.position - relative().position;
    let turn = (found.rotation * relative().rotation.conjugate()).log();
    let ([a, b, c], [d, e, f]) = (shift.to_array(), turn.to_array());
    [a, b, c, d, e, f]
}

#[test]
fn without_noise_the_pose_is_exact() {
    let mut noise = Noise::of(1);
    let pairs: Vec<SeenByBoth> = (0..4).map(|_| pair(&mut noise, 0.0)).collect();
    let found = calibrated(&pairs, &[]).unwrap();
    for (k, off) in off(found.cameras[1].pose()).into_iter().enumerate() {
        assert!(off.abs() < 1e-8, "{k}: {off}");
    }
    assert_eq!(found.cameras[0].pose(), Pose::IDENTITY);
    assert!(found.rms < 1e-6 && found.epipolar.unwrap() < 1e-6);
    assert!((found.baseline[0] - relative().position.norm()).abs() < 1e-8);
    assert_eq!(found.pairs.iter().map(|pair| pair.common).collect::<Vec<_>>(), [54; 4]);
}

/// χ² of six degrees of freedom: 95 % of all are below 12.59. Each coordinate is within 1.96 standard deviations in 95 %.
#[test]
fn the_pose_lies_within_its_covariance() {
    coverage(40, 0.04);
}

#[test]
#[ignore = "a study"]
fn the_pose_lies_within_its_covariance_in_hundreds_of_sets() {
    coverage(400, 0.015);
}

/// Two standard deviations of the share of single coordinates are given, of which six correlated ones are in each trial.
fn coverage(trials: usize, margin: f64) {
    let deviation = 0.2;
    let (mut within, mut alone, mut pixel, mut epipolar) = (0, 0, 0.0, 0.0);
    for trial in 0..trials {
        let mut noise = Noise::of(100 + trial as u64);
        let pairs: Vec<SeenByBoth> = (0..4).map(|_| pair(&mut noise, deviation)).collect();
        let found = calibrated(&pairs, &[half_turn()]).unwrap();
        let off = off(found.cameras[1].pose());
        within += usize::from(square(&found.covariance, off) < 12.59);
        for k in 0..6 {
            alone += usize::from(off[k].abs() < 1.96 * found.covariance[k][k].sqrt());
        }
        pixel += found.pixel / trials as f64;
        epipolar += found.epipolar.unwrap() / trials as f64;
    }
    let share = within as f64 / trials as f64;
    // Two standard deviations of such a share.
    let two = 2.0 * (0.95 * 0.05 / trials as f64).sqrt();
    assert!((share - 0.95).abs() < two, "{share}");
    let share = alone as f64 / (6 * trials) as f64;
    assert!((share - 0.95).abs() < margin, "{share}");
    assert!((pixel - deviation).abs() < 0.003, "{pixel}");
    assert!((epipolar - deviation).abs() < 0.01, "{epipolar}");
}

/// The same of rigs whose lenses are calibrated by the same photographs. Without their errors the deviations are too small.
#[test]
fn the_pose_lies_within_its_covariance_with_that_of_the_lenses() {
    coverage_with_lenses(30, 8);
}

#[test]
#[ignore = "a study"]
fn the_pose_lies_within_its_covariance_with_that_of_the_lenses_in_hundreds_of_sets() {
    coverage_with_lenses(300, 8);
}

fn coverage_with_lenses(trials: usize, pairs: usize) {
    let (mut alone, mut as_if_known) = (0, 0);
    for trial in 0..trials {
        let mut noise = Noise::of(900 + trial as u64);
        let pairs: Vec<SeenByBoth> = (0..pairs).map(|_| pair(&mut noise, 0.2)).collect();
        let lens = |i: usize| {
            let views: Vec<_> = pairs.iter().map(|pair| pair[i].clone()).collect();
            let free = [FreeParameters::Four, FreeParameters::None][i];
            calibrate(SIZE, &views, free).unwrap()
        };
        let [a, b] = [lens(0), lens(1)];
        let found = calibrate_stereo([&a.lens, &b.lens], [Some(SIZE); 2], &pairs, &[]).unwrap();
        let off = off(found.cameras[1].pose());
        let whole = found.clone().with_lenses([Some(&a.deviations), Some(&b.deviations)]);
        assert!(whole.baseline[1] > found.baseline[1]);
        for k in 0..6 {
            as_if_known += usize::from(off[k].abs() < 1.96 * found.covariance[k][k].sqrt());
            alone += usize::from(off[k].abs() < 1.96 * whole.covariance[k][k].sqrt());
        }
    }
    let share = |held: usize| held as f64 / (6 * trials) as f64;
    // Six correlated coordinates are in each trial.
    let margin = 0.22 / (trials as f64).sqrt() + 0.02;
    assert!((share(alone) - 0.95).abs() < margin, "{}", share(alone));
    assert!(share(as_if_known) < 0.8, "{}", share(as_if_known));
}

/// How the pose follows a parameter of a lens, by calibrations with lenses that are slightly other.
#[test]
fn the_pose_follows_the_lenses_as_said() {
    let mut noise = Noise::of(7);
    let pairs: Vec<SeenByBoth> = (0..4).map(|_| pair(&mut noise, 0.2)).collect();
    let [a, b] = lenses();
    let moved = |which: usize, parameter: usize, by: f64| {
        let lens = [a, b][which];
        let ([mut fx, mut fy], [mut cx, mut cy]) = (lens.focal(), lens.centre());
        *[&mut fx, &mut fy, &mut cx, &mut cy][parameter] += by;
        let lens = Pinhole::new([fx, fy], [cx, cy], *lens.distortion()).unwrap();
        let both = if which == 0 { [&lens, &b] } else { [&a, &lens] };
        calibrate_stereo(both, [Some(SIZE); 2], &pairs, &[]).unwrap()
    };
    let found = calibrated(&pairs, &[]).unwrap();
    for which in 0..2 {
        for parameter in 0..4 {
            let h = 0.02;
            let [before, after] =
                [-h, h].map(|by| off(moved(which, parameter, by).cameras[1].pose()));
            for k in 0..6 {
                let slope = (after[k] - before[k]) / (2.0 * h);
                let said = found.by_lenses[which][k][parameter];
                // What the derivatives take for constant is of the size of the residuals.
                let size = found.by_lenses[which].map(|row| row[parameter].abs());
                let near = 0.02 * size[3 * (k / 3)..][..3].iter().fold(0.0, |m: f64, x| m.max(*x));
                assert!((said - slope).abs() < near, "{which} {parameter} {k}: {said} {slope}");
            }
        }
    }
}

/// xᵀ C⁻¹ x by elimination.
pub fn square(covariance: &[[f64; 6]; 6], off: [f64; 6]) -> f64 {
    let (mut a, mut b) = (*covariance, off);
    for k in 0..6 {
        for i in k + 1..6 {
            let factor = a[i][k] / a[k][k];
            for j in k..6 {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    (0..6).map(|k| b[k] * b[k] / a[k][k]).sum()
}

/// The same board, numbered from the opposite corner.
fn from_the_other_end(seen: &mut [Sighting]) {
    let corners = board();
    let last = 8.0 * SQUARE;
    for at in seen {
        let number = corners.iter().position(|corner| *corner == at.point).unwrap();
        at.point = corners[53 - number];
        assert!(at.point.x <= last);
    }
}

#[test]
fn a_board_may_be_numbered_from_either_end() {
    let mut noise = Noise::of(7);
    let mut pairs: Vec<SeenByBoth> = (0..5).map(|_| pair(&mut noise, 0.1)).collect();
    let expected = calibrated(&pairs, &[half_turn()]).unwrap();
    for (k, camera) in [(0, 1), (2, 0), (3, 0), (3, 1)] {
        from_the_other_end(&mut pairs[k][camera]);
    }
    let found = calibrated(&pairs, &[half_turn()]).unwrap();
    let renumbered: Vec<bool> = found.pairs.iter().map(|pair| pair.renumbered).collect();
    assert_eq!(renumbered, [true, false, true, false, false]);
    let (a, b) = (off(found.cameras[1].pose()), off(expected.cameras[1].pose()));
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7), "{a:?} {b:?}");
    // One pair does not tell how the second camera is turned, unless the board does.
    let error = calibrated(&pairs[1..2], &[half_turn()]).unwrap_err();
    assert!(matches!(error, StereoError::Ambiguous { .. }), "{error}");
    let one = calibrated(&pairs[1..2], &[]).unwrap();
    assert!((one.cameras[1].pose().position - relative().position).norm() < 5e-3);
}

#[test]
fn pairs_that_cannot_be_used_are_named() {
    let mut noise = Noise::of(9);
    let mut pairs: Vec<SeenByBoth> = (0..6).map(|_| pair(&mut noise, 0.1)).collect();
    // Only a few corners are seen, others by each camera; of one pair too few.
    pairs[0][0].truncate(20);
    pairs[0][1].drain(..34);
    pairs[2][1].truncate(3);
    // Not of one time.
    pairs[4][1] = pair(&mut noise, 0.1)[1].clone();
    let found = calibrated(&pairs, &[half_turn()]).unwrap();
    let used: Vec<usize> = found.pairs.iter().map(|pair| pair.number).collect();
    assert_eq!(used, [0, 1, 3, 5]);
    assert_eq!((found.pairs[0].common, found.pairs[0].epipolar), (0, None));
    assert!(matches!(found.refused[0], (2, RefusedPair::NotLocated { camera: 1, .. })));
    assert!(matches!(found.refused[1], (4, RefusedPair::Contradicts { .. })));
    assert!(found.rms < 0.2, "{}", found.rms);
    let error = calibrated(&pairs[2..3], &[]).unwrap_err();
    assert!(matches!(error, StereoError::NoPair { given: 1, first: Some((0, _)) }), "{error}");
    assert!(matches!(calibrated(&[], &[]), Err(StereoError::NoPair { given: 0, first: None })));
    // Twice the same camera.
    let [a, _] = lenses();
    let same: Vec<SeenByBoth> = (0..4)
        .map(|_| {
            let seen = pair(&mut noise, 0.1)[0].clone();
            let again =
                seen.iter().map(|at| Sighting { pixel: noise.beside(at.pixel, 0.1), ..*at });
            let again = again.collect();
            [seen, again]
        })
        .collect();
    let error = calibrate_stereo([&a, &a], [Some(SIZE); 2], &same, &[]).unwrap_err();
    assert!(matches!(error, StereoError::NoBaseline { .. }), "{error}");
}
