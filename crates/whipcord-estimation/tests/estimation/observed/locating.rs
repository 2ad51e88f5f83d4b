use proptest::prelude::*;
use whipcord::{Pose, Twist, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, Distortion, Lens, LocateError, Located, Orthographic, Pinhole, Sighting, locate,
    locate_orthographic, locate_rig,
};

fn lens() -> Pinhole {
    let distortion = Distortion::new(&[-0.28, 0.09, 1.2e-3, -7e-4, -0.015]).unwrap();
    Pinhole::new([812.5, 798.0], [331.25, 242.75], distortion).unwrap()
}

fn sightings(points: &[[f64; 3]], pixels: &[[f64; 2]]) -> Vec<Sighting> {
    let pairs = points.iter().zip(pixels);
    pairs.map(|(&point, &pixel)| Sighting { point: point.into(), pixel }).collect()
}

/// What a camera sees of points.
fn seen_by(camera: &Camera, points: &[Vec3]) -> Vec<Sighting> {
    let see = |&point: &Vec3| Sighting { point, pixel: camera.project(point).unwrap() };
    points.iter().map(see).collect()
}

/// Whether the camera's rotation and position are those of OpenCV's `rvec` and `tvec`, in rad and m.
fn assert_at(camera: &Camera, rvec: [f64; 3], tvec: [f64; 3], tolerance: f64) {
    let world_to_camera = camera.pose().inverse();
    let turn = world_to_camera.rotation * UnitQuaternion::exp(rvec.into()).conjugate();
    assert!(turn.log().norm() < tolerance, "{:?}", world_to_camera.rotation.log());
    let shift = world_to_camera.position - Vec3::from(tvec);
    assert!(shift.norm() < tolerance, "{:?}", world_to_camera.position);
}

const PLANE: [[f64; 3]; 5] =
    [[0.0; 3], [0.1, 0.0, 0.0], [0.1, 0.06, 0.0], [0.0, 0.06, 0.0], [0.05, 0.1, 0.0]];

/// `cv2.solvePnP(…, SOLVEPNP_ITERATIVE)` and `cv2.solvePnPRefineLM(…, criteria=(3, 200, 1e-15))`, and for
/// the plane the same from both poses of `SOLVEPNP_IPPE`; OpenCV 5.0.0.
#[test]
fn the_pose_is_that_of_opencv() {
    let seen = sightings(
        &[
            [0.0, 0.0, 0.0],
            [0.08, -0.05, 0.18],
            [-0.12, 0.1, 0.05],
            [0.05, 0.09, -0.04],
            [-0.07, -0.08, 0.1],
            [0.1, 0.02, 0.02],
            [-0.03, 0.04, 0.15],
        ],
        &[
            [358.873, 175.657],
            [377.119, 98.81],
            [157.402, 248.418],
            [399.544, 315.47],
            [265.029, 36.508],
            [448.518, 218.445],
            [253.484, 168.117],
        ],
    );
    let found = locate(&lens(), None, &seen, None).unwrap();
    assert_at(
        &found.camera,
        [0.299_516_461_602_843_56, -0.399_051_611_058_441_4, 0.249_597_621_182_388_04],
        [0.019_900_559_307_605_026, -0.050_132_039_480_678_52, 0.600_537_505_210_663_8],
        1e-7,
    );
    assert!((found.rms - 0.578_198_120_505).abs() < 1e-9);
    assert!(!found.is_ambiguous());
    let seen = sightings(
        &PLANE,
        &[
            [357.945, 176.306],
            [468.36, 203.113],
            [444.137, 271.037],
            [334.25, 250.416],
            [375.451, 306.235],
        ],
    );
    let found = locate(&lens(), None, &seen, None).unwrap();
    assert_at(
        &found.camera,
        [0.302_036_179_109, -0.396_742_320_408, 0.247_399_440_999_503_6],
        [0.019_795_559_815_7, -0.049_873_194_727, 0.599_467_784_094],
        2e-7,
    );
    assert!((found.rms - 0.202_267_119_94).abs() < 1e-9);
    let other = found.other.unwrap();
    assert_at(
        &other.camera,
        [-0.189_849_536_526_6, 0.498_446_100_452_2, 0.268_732_401_809_5],
        [0.021_493_429_243_555_2, -0.053_710_866_292_709, 0.675_552_811_228_8],
        1e-5,
    );
    assert!((other.rms - 2.944_134_598_630_3).abs() < 1e-6);
}

/// The centres of the disks of a straight robot, and two markers beside its axis.
fn robot() -> (Vec<Vec3>, [Vec3; 2]) {
    let disks = (0..10).map(|i| Vec3::new(0.0, 0.0, 0.02 * f64::from(i))).collect();
    (disks, [Vec3::new(0.008, 0.0, 0.0), Vec3::new(0.0, 0.008, 0.18)])
}

/// A camera beside the robot, which looks along −x with the robot's axis upright.
fn beside() -> Camera {
    let rotation = UnitQuaternion::from_wxyz([0.5, 0.5, -0.5, -0.5]).unwrap();
    let tilt = UnitQuaternion::exp(Vec3::new(0.05, -0.1, 0.0));
    let pose = Pose { position: Vec3::new(0.7, 0.1, 0.12), rotation: tilt * rotation };
    Camera::new(Lens::Pinhole(lens()), pose, Some([640, 480])).unwrap()
}

#[test]
fn points_on_a_line_need_the_direction_of_view() {
    let (mut points, markers) = robot();
    let camera = beside();
    let seen = seen_by(&camera, &points);
    let refusal = locate(&lens(), None, &seen, None).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "the points are on one line, along (0, 0, 1), and look the same from all sides of it: add a marker off the line, or give the direction in which the camera looks"
    );
    let view = camera.pose().rotation.rotate(Vec3::Z);
    let found = locate(&lens(), Some([640, 480]), &seen, Some(view)).unwrap();
    assert!(found.rms < 1e-9, "{}", found.rms);
    assert!((found.camera.pose().position - camera.pose().position).norm() < 1e-7);
    // From three disks as well, and the other way round from the other side.
    let three = locate(&lens(), None, &seen[..3], Some(view)).unwrap();
    assert!((three.camera.pose().position - camera.pose().position).norm() < 1e-5);
    let opposite = locate(&lens(), None, &seen, Some(Vec3::new(-view.x, -view.y, view.z))).unwrap();
    let axis_to =
        |camera: &Camera| Vec3::new(camera.pose().position.x, camera.pose().position.y, 0.0);
    assert!((axis_to(&opposite.camera) + axis_to(&camera)).norm() < 1e-7);
    assert_eq!(
        locate(&lens(), None, &seen, Some(Vec3::Z)).unwrap_err(),
        LocateError::ViewAlongLine
    );
    points.extend(markers);
    let found = locate(&lens(), None, &seen_by(&camera, &points), None).unwrap();
    assert!((found.camera.pose().position - camera.pose().position).norm() < 1e-7);
}

/// The paper's procedure: the scale of a side view from a known length.
#[test]
fn an_orthographic_scale_comes_from_a_known_length() {
    let (points, _) = robot();
    let camera = Camera::new(
        Lens::Orthographic(Orthographic::new(2512.5, [319.5, 239.5]).unwrap()),
        beside().pose(),
        Some([640, 480]),
    )
    .unwrap();
    let seen = seen_by(&camera, &points);
    assert!(matches!(locate_orthographic(None, &seen, None), Err(LocateError::FreeTurn { .. })));
    let view = camera.pose().rotation.rotate(Vec3::Z);
    let found = locate_orthographic(Some([640, 480]), &seen, Some(view)).unwrap();
    assert!(found.rms < 1e-10);
    assert_same_view(&found.camera, &camera, &robot().1);
    let two = locate_orthographic(None, &[seen[0], seen[9]], Some(view)).unwrap();
    assert_same_view(&two.camera, &camera, &robot().1);
}

fn assert_same_view(found: &Camera, camera: &Camera, points: &[Vec3]) {
    let (Lens::Orthographic(a), Lens::Orthographic(b)) = (found.lens(), camera.lens()) else {
        panic!("both are orthographic");
    };
    assert!((a.scale() / b.scale() - 1.0).abs() < 1e-9, "{} {}", a.scale(), b.scale());
    for &point in points {
        let (a, b) = (found.project(point).unwrap(), camera.project(point).unwrap());
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6, "{a:?} {b:?}");
    }
}

#[test]
fn an_orthographic_plane_is_seen_from_two_sides() {
    let camera = Camera::new(
        Lens::Orthographic(Orthographic::new(2512.5, [319.5, 239.5]).unwrap()),
        beside().pose(),
        None,
    )
    .unwrap();
    let points: Vec<Vec3> = PLANE.iter().map(|&p| Vec3::from([p[0], p[2], p[1]])).collect();
    let found: Located = locate_orthographic(None, &seen_by(&camera, &points), None).unwrap();
    assert!(found.is_ambiguous());
    let [a, b] = [found.camera, found.other.unwrap().camera]
        .map(|found| (found.pose().rotation * camera.pose().rotation.conjugate()).log().norm());
    assert!(a.min(b) < 1e-7, "{a} {b}");
}

#[test]
fn what_cannot_be_located_is_named() {
    let (points, _) = robot();
    let seen = seen_by(&beside(), &points);
    let message =
        |seen: &[Sighting], view| locate(&lens(), None, seen, view).unwrap_err().to_string();
    assert_eq!(
        message(&seen[..2], None),
        "a camera's pose needs 3 points or more, but 2 are given"
    );
    assert_eq!(
        message(&seen, Some(Vec3::ZERO)),
        "the direction in which the camera looks must be finite, and not zero"
    );
    let mut lost = seen.clone();
    lost[1].pixel[0] = f64::NAN;
    assert_eq!(
        message(&lost, None),
        "point 2: a coordinate is NaN, which must be a finite number within 1e9"
    );
    let one_pixel: Vec<Sighting> =
        seen.iter().map(|at| Sighting { pixel: [320.0, 240.0], ..*at }).collect();
    for view in [None, Some(Vec3::new(-1.0, 0.2, 0.0))] {
        assert!(message(&one_pixel, view).starts_with("no pose of the camera explains"));
    }
    assert!(message(&[seen[0]; 5], None).starts_with("the points lie within 0 mm of one another"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Any camera that sees enough of a robot is found again.
    #[test]
    fn a_camera_is_found_where_it_is(
        points in prop::collection::vec(prop::array::uniform3(-0.1_f64..0.1), 6..12),
        flat in any::<bool>(),
        turn in prop::array::uniform3(-3.0_f64..3.0),
        aside in prop::array::uniform2(-0.1_f64..0.1),
        distance in 0.35_f64..3.0,
        scale in 500.0_f64..5000.0,
    ) {
        let points: Vec<Vec3> = points
            .iter()
            .map(|p| Vec3::new(p[0], p[1], if flat { 0.0 } else { p[2] }))
            .collect();
        let rotation = Pose::exp(Twist { linear: Vec3::ZERO, angular: turn.into() }).rotation;
        let position = -rotation.rotate(Vec3::new(aside[0], aside[1], distance));
        let pose = Pose { position, rotation };
        let camera = Camera::new(Lens::Pinhole(lens()), pose, None).unwrap();
        let found = locate(&lens(), None, &seen_by(&camera, &points), None).unwrap();
        let missed = (found.camera.pose().position - position).norm();
        prop_assert!(found.rms < 1e-7 && missed < 1e-5, "{} {}", found.rms, missed);
        let flat_lens = Lens::Orthographic(Orthographic::new(scale, [0.0; 2]).unwrap());
        let camera = Camera::new(flat_lens, pose, None).unwrap();
        let found = locate_orthographic(None, &seen_by(&camera, &points), None).unwrap();
        prop_assert!(found.rms < 1e-7, "{}", found.rms);
        prop_assert_eq!(found.is_ambiguous(), flat);
    }
}

/// Two cameras before the origin, and the same pair in a world of its own, with the first at the origin.
fn pair() -> ([Camera; 2], [Camera; 2]) {
    let rotation = UnitQuaternion::exp(Vec3::new(0.1, -0.2, 0.05));
    let first = Pose { position: Vec3::new(0.1, 0.05, -0.6), rotation };
    let turn = UnitQuaternion::exp(Vec3::new(0.03, -0.6, 0.05));
    let relative = Pose { position: Vec3::new(0.3, -0.01, 0.08), rotation: turn };
    let at = |pose: Pose| Camera::new(Lens::Pinhole(lens()), pose, None).unwrap();
    ([at(first), at(first * relative)], [at(Pose::IDENTITY), at(relative)])
}

fn off(found: &Camera, truth: &Camera) -> [f64; 2] {
    let off = truth.pose().inverse() * found.pose();
    [off.position.norm(), off.rotation.log().norm()]
}

#[test]
fn two_cameras_are_moved_together() {
    let (truth, own) = pair();
    let points = [
        Vec3::ZERO,
        Vec3::new(0.05, 0.0, 0.02),
        Vec3::new(-0.02, 0.06, -0.03),
        Vec3::new(0.01, -0.05, 0.04),
        Vec3::new(-0.06, -0.01, 0.01),
    ];
    let seen = |camera: usize, numbers: &[usize]| -> Vec<Sighting> {
        let points: Vec<Vec3> = numbers.iter().map(|number| points[*number]).collect();
        seen_by(&truth[camera], &points)
    };
    // What both see; three points that both see; four that one sees alone; and different ones.
    for [first, second] in [
        [&[0, 1, 2, 3, 4][..], &[0, 1, 2, 3, 4]],
        [&[0, 1, 2], &[0, 1, 2]],
        [&[], &[0, 1, 2, 3]],
        [&[0, 1, 2, 4], &[3, 4]],
    ] {
        let seen = [seen(0, first), seen(1, second)];
        let found = locate_rig([&own[0], &own[1]], [&seen[0], &seen[1]], None).unwrap();
        for (found, truth) in found.cameras.iter().zip(&truth) {
            let [shift, turn] = off(found, truth);
            assert!(shift < 1e-7 && turn < 1e-7, "{first:?} {second:?}: {shift} {turn}");
        }
        assert!(found.rms_of_both() < 1e-6 && !found.is_ambiguous());
        assert_eq!(found.residuals.each_ref().map(Vec::len), [first.len(), second.len()]);
    }
    let few = [seen(0, &[0, 1]), seen(1, &[2])];
    let few = locate_rig([&own[0], &own[1]], [&few[0], &few[1]], None);
    assert!(matches!(few, Err(LocateError::TooFew { .. } | LocateError::NoPose { .. })), "{few:?}");
}

/// Points on one line fix all but the turn about it, which the direction of the first camera gives.
#[test]
fn two_cameras_before_a_straight_robot_need_a_direction() {
    let (truth, own) = pair();
    let points: Vec<Vec3> =
        (0..8).map(|i| Vec3::new(0.0, 0.02 * f64::from(i) - 0.07, 0.0)).collect();
    let seen = truth.each_ref().map(|camera| seen_by(camera, &points));
    let both = [&own[0], &own[1]];
    let refused = locate_rig(both, [&seen[0], &seen[1]], None);
    assert!(matches!(refused, Err(LocateError::FreeTurn { .. })), "{refused:?}");
    let view = truth[0].pose().rotation.rotate(Vec3::Z);
    let found = locate_rig(both, [&seen[0], &seen[1]], Some(view)).unwrap();
    let [shift, turn] = off(&found.cameras[0], &truth[0]);
    assert!(shift < 1e-6 && turn < 1e-6, "{shift} {turn}");
}

/// With noise, both images together are more exact than either, by a given seed.
#[test]
fn two_images_are_more_exact_than_one() {
    let (truth, own) = pair();
    let points: Vec<Vec3> = (0..6)
        .map(|i| {
            let angle = f64::from(i);
            Vec3::new(0.03 * angle.cos(), 0.02 * angle - 0.05, 0.03 * (2.0 * angle).sin())
        })
        .collect();
    let mut squares = [0.0; 2];
    let mut random = whipcord_numerics::random::SplitMix64::new(5);
    for _ in 0..40 {
        let noisy = truth.each_ref().map(|camera| {
            let mut seen = seen_by(camera, &points);
            for at in &mut seen {
                at.pixel = at.pixel.map(|x| x + 0.5 * (random.next_part() - 0.5));
            }
            seen
        });
        let both = locate_rig([&own[0], &own[1]], [&noisy[0], &noisy[1]], None).unwrap();
        let one = locate(&lens(), None, &noisy[0], None).unwrap();
        squares[0] += off(&both.cameras[0], &truth[0])[0].powi(2);
        squares[1] += off(&one.camera, &truth[0])[0].powi(2);
    }
    assert!(squares[0] < 0.7 * squares[1], "{squares:?}");
}
