//! Whether located cameras are as far off as their covariance says, by many noisy sets.

use super::noise::Noise;
use super::stereo::square;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, Distortion, FreeParameters, Lens, Orthographic, Pinhole, PoseCovariance, Sighting,
    calibrate, locate, locate_orthographic, locate_rig,
};

const SIZE: [u32; 2] = [640, 480];
const DEVIATION: f64 = 0.3;
const TRIALS: usize = 400;

fn lens() -> Pinhole {
    Pinhole::new([820.0, 815.0], [325.0, 236.0], Distortion::NONE).unwrap()
}

/// A camera that looks at the robot from the side.
fn beside() -> Camera {
    // Its x is that of y, its y downwards, and it looks against x.
    let rotation = UnitQuaternion::from_wxyz([0.5, -0.5, -0.5, 0.5]).unwrap();
    let tilted = UnitQuaternion::exp(Vec3::new(0.1, -0.15, 0.2)) * rotation;
    let position = Vec3::new(0.0, 0.0, 0.09) - tilted.rotate(Vec3::Z) * 0.5;
    Camera::new(Lens::Pinhole(lens()), Pose { position, rotation: tilted }, Some(SIZE)).unwrap()
}

/// Markers on disks of a straight robot, also beside its axis.
fn markers() -> Vec<Vec3> {
    let at = |k: usize| {
        let angle = 1.3 * k as f64;
        Vec3::new(0.03 * angle.cos(), 0.03 * angle.sin(), 0.02 * k as f64)
    };
    (0..10).map(at).collect()
}

fn seen(camera: &Camera, points: &[Vec3], noise: &mut Noise) -> Vec<Sighting> {
    let see = |&point: &Vec3| Sighting {
        point,
        pixel: noise.beside(camera.project(point).unwrap(), DEVIATION),
    };
    points.iter().map(see).collect()
}

/// Position and rotation in the world by which a camera is off.
fn off(found: &Camera, truth: &Camera) -> [f64; 6] {
    let shift = found.pose().position - truth.pose().position;
    let turn = (found.pose().rotation * truth.pose().rotation.conjugate()).log();
    [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
}

/// How many of the coordinates, of those that are not exact, lie within 1.96 standard deviations.
fn held(covariance: &PoseCovariance, off: [f64; 6]) -> [usize; 2] {
    let known = (0..6).filter(|&k| covariance[k][k] > 1e-24);
    let within = known.clone().filter(|&k| off[k].abs() < 1.96 * covariance[k][k].sqrt());
    [within.count(), known.count()]
}

/// Shares of 95 % in sets of correlated coordinates, within three standard deviations if all in a set went together.
fn assert_share([within, of]: [usize; 2], trials: usize) {
    let share = within as f64 / of as f64;
    assert!((share - 0.95).abs() < 3.0 * (0.0475 / trials as f64).sqrt(), "{share}");
}

#[test]
fn a_pinhole_camera() {
    let (truth, mut noise) = (beside(), Noise::of(3));
    let (mut ellipsoid, mut single, mut pixel) = (0, [0, 0], 0.0);
    for _ in 0..TRIALS {
        let seen = seen(&truth, &markers(), &mut noise);
        let found = locate(&lens(), Some(SIZE), &seen, None).unwrap();
        let off = off(&found.camera, &truth);
        let given = found.uncertainty.covariance(Some(DEVIATION), None).unwrap();
        ellipsoid += usize::from(square(&given, off) < 12.59);
        let [within, of] = held(&given, off);
        single = [single[0] + within, single[1] + of];
        pixel += found.uncertainty.pixel.unwrap().powi(2) / TRIALS as f64;
        // What the residuals tell is that of twenty numbers less six.
        assert_eq!(found.uncertainty.freedom, 14);
        let told = found.uncertainty.covariance(None, None).unwrap();
        let ratio = (found.uncertainty.pixel.unwrap() / DEVIATION).powi(2);
        assert!((told[0][0] / given[0][0] / ratio - 1.0).abs() < 1e-9);
    }
    assert_share([ellipsoid, TRIALS], TRIALS);
    assert_eq!(single[1], 6 * TRIALS);
    assert_share(single, TRIALS);
    assert!((pixel.sqrt() / DEVIATION - 1.0).abs() < 0.03, "{pixel}");
}

/// By three points there are no more numbers than unknowns: the errors of the pixels must be given.
#[test]
fn without_redundancy_nothing_is_told_of_the_pixels() {
    let truth = beside();
    let line: Vec<Vec3> = [0.0, 0.09, 0.18].map(|z| Vec3::new(0.0, 0.0, z)).to_vec();
    let two = [&line[0], &line[2]]
        .map(|point| Sighting { point: *point, pixel: truth.project(*point).unwrap() });
    let orthographic = locate_orthographic(Some(SIZE), &two, Some(-Vec3::X)).unwrap();
    assert_eq!((orthographic.uncertainty.pixel, orthographic.uncertainty.freedom), (None, 0));
    assert_eq!(orthographic.uncertainty.covariance(None, None), None);
    assert!(orthographic.uncertainty.covariance(Some(0.3), None).is_some());
}

/// Lenses that are calibrated in each set: with their covariance, and as if they were known.
#[test]
fn a_pinhole_camera_whose_lens_was_calibrated() {
    let (truth, mut noise) = (beside(), Noise::of(5));
    let board: Vec<Vec3> =
        (0..35).map(|k| Vec3::new(0.03 * (k % 7) as f64, 0.03 * (k / 7) as f64, 0.0)).collect();
    let (trials, mut whole, mut as_if_known) = (60, [0, 0], [0, 0]);
    for _ in 0..trials {
        let views: Vec<Vec<Sighting>> = (0..6)
            .map(|_| {
                let [x, y, z] = [0.5, 0.5, 0.3].map(|most| noise.between(-most, most));
                let rotation = UnitQuaternion::exp(Vec3::new(x, y, z));
                let position = Vec3::new(0.09, 0.06, 0.0) - rotation.rotate(Vec3::Z) * 0.4;
                seen(&truth.at(Pose { position, rotation }).unwrap(), &board, &mut noise)
            })
            .collect();
        let calibrated = calibrate(SIZE, &views, FreeParameters::Radial).unwrap();
        let seen = seen(&truth, &markers(), &mut noise);
        let found = locate(&calibrated.lens, Some(SIZE), &seen, None).unwrap();
        let off = off(&found.camera, &truth);
        for (sum, lens) in
            [(&mut whole, Some(&calibrated.deviations.covariance[..])), (&mut as_if_known, None)]
        {
            let covariance = found.uncertainty.covariance(Some(DEVIATION), lens).unwrap();
            let [within, of] = held(&covariance, off);
            *sum = [sum[0] + within, sum[1] + of];
        }
    }
    assert_share(whole, trials);
    let share = as_if_known[0] as f64 / as_if_known[1] as f64;
    assert!(share < 0.85, "{share}");
}

/// Of points on a line the direction of view is given; here it is that of the camera.
#[test]
fn a_pinhole_camera_before_a_line() {
    let (truth, mut noise) = (beside(), Noise::of(8));
    let line: Vec<Vec3> = (0..10).map(|k| Vec3::new(0.0, 0.0, 0.02 * k as f64)).collect();
    let view = truth.pose().rotation.rotate(Vec3::Z);
    let mut single = [0, 0];
    for _ in 0..TRIALS {
        let seen = seen(&truth, &line, &mut noise);
        let found = locate(&lens(), Some(SIZE), &seen, Some(view)).unwrap();
        let covariance = found.uncertainty.covariance(Some(DEVIATION), None).unwrap();
        let [within, of] = held(&covariance, off(&found.camera, &truth));
        single = [single[0] + within, single[1] + of];
        assert_eq!(found.uncertainty.freedom, 15);
    }
    assert_eq!(single[1], 6 * TRIALS);
    assert_share(single, TRIALS);
}

#[test]
fn an_orthographic_camera() {
    let scale = 1600.0;
    let lens = Orthographic::new(scale, [319.5, 239.5]).unwrap();
    let truth = Camera::new(Lens::Orthographic(lens), beside().pose(), Some(SIZE)).unwrap();
    let view = truth.pose().rotation.rotate(Vec3::Z);
    for view in [None, Some(view)] {
        let mut noise = Noise::of(13);
        let (mut turns, mut across, mut scales) = ([0, 0], [0, 0], 0);
        for _ in 0..TRIALS {
            let seen = seen(&truth, &markers(), &mut noise);
            let found = locate_orthographic(Some(SIZE), &seen, view).unwrap();
            let covariance = found.uncertainty.covariance(Some(DEVIATION), None).unwrap();
            let mut off = off(&found.camera, &truth);
            // How far away it is cannot be seen: of the position what is across the view counts.
            let right = truth.pose().rotation.rotate(Vec3::X).to_array();
            let deviation: f64 =
                (0..9).map(|at| right[at / 3] * covariance[at / 3][at % 3] * right[at % 3]).sum();
            let along: f64 = (0..3).map(|k| right[k] * off[k]).sum();
            // Where the camera may turn, the depth at which it is put has an effect on its place.
            if view.is_some() {
                across =
                    [across[0] + usize::from(along.abs() < 1.96 * deviation.sqrt()), across[1] + 1];
            }
            off[..3].fill(0.0);
            let known = (3..6).filter(|&k| covariance[k][k] > 1e-24);
            let within = known.clone().filter(|&k| off[k].abs() < 1.96 * covariance[k][k].sqrt());
            turns = [turns[0] + within.count(), turns[1] + known.count()];
            let Lens::Orthographic(own) = found.camera.lens() else { panic!() };
            let sure = found.uncertainty.relative_scale_deviation(Some(DEVIATION)).unwrap();
            scales += usize::from((own.scale() / scale).ln().abs() < 1.96 * sure);
        }
        assert_share(turns, TRIALS);
        assert_share([scales, TRIALS], TRIALS);
        if view.is_some() {
            assert_share(across, TRIALS);
        }
    }
}

#[test]
fn two_cameras() {
    let (first, mut noise) = (beside(), Noise::of(21));
    let relative = Pose {
        position: Vec3::new(0.2, 0.01, 0.05),
        rotation: UnitQuaternion::exp(Vec3::Y * -0.4),
    };
    let second = first.at(first.pose() * relative).unwrap();
    let rig = [first.at(Pose::IDENTITY).unwrap(), first.at(relative).unwrap()];
    let (mut ellipsoid, mut single) = (0, [0, 0]);
    for _ in 0..TRIALS {
        let both = [&first, &second].map(|camera| seen(camera, &markers()[..4], &mut noise));
        let found = locate_rig([&rig[0], &rig[1]], [&both[0], &both[1]], None).unwrap();
        let off = off(&found.cameras[0], &first);
        let covariance = found.uncertainty.covariance(Some(DEVIATION), None).unwrap();
        ellipsoid += usize::from(square(&covariance, off) < 12.59);
        let [within, of] = held(&covariance, off);
        single = [single[0] + within, single[1] + of];
        assert_eq!(found.uncertainty.freedom, 10);
    }
    assert_share([ellipsoid, TRIALS], TRIALS);
    assert_share(single, TRIALS);
}
