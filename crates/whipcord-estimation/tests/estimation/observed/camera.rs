use proptest::prelude::*;
use whipcord::{Pose, Twist, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, CameraError, Distortion, Lens, Orthographic, Pinhole, ViewError,
};

const COEFFICIENTS: [f64; 14] =
    [-0.28, 0.09, 1.2e-3, -7e-4, -0.015, 0.04, -0.02, 3e-3, 1.1e-3, -5e-4, 8e-4, 3e-4, 0.03, -0.05];
const POINTS: [Vec3; 3] = [Vec3::ZERO, Vec3::new(0.08, -0.05, 0.18), Vec3::new(-0.12, 0.1, 0.05)];

/// Seen by `cv2.projectPoints(POINTS, (0.3, −0.4, 0.25), (0.02, −0.05, 0.6), K, COEFFICIENTS[:n])`, and
/// `cv2.undistortPoints((100, 420), …, criteria=(3, 1000, 1e-15))`, OpenCV 5.0.0.
const OPENCV: [(usize, [[f64; 2]; 3], [f64; 2]); 6] = [
    (
        0,
        [
            [358.333_333_333_333_3, 176.25],
            [377.503_824_410_743_96, 97.405_859_663_792_4],
            [155.344_380_442_646_38, 248.510_091_623_890_3],
        ],
        [-0.284_615_384_615_384_6, 0.222_117_794_486_215_52],
    ),
    (
        4,
        [
            [358.261_141_391_782_4, 176.423_723_399_305_54],
            [376.993_126_846_793_87, 98.980_424_003_823_97],
            [157.537_644_942_484_52, 248.482_332_931_897_56],
        ],
        [-0.295_307_708_838_404_35, 0.230_367_055_247_884_7],
    ),
    (
        5,
        [
            [358.261_141_179_418_9, 176.423_723_920_739_63],
            [376.993_093_346_525_3, 98.980_529_272_261_35],
            [157.537_917_561_717_45, 248.482_324_004_884_5],
        ],
        [-0.295_321_395_322_483_3, 0.230_377_723_135_604_67],
    ),
    (
        8,
        [
            [358.252_471_771_171, 176.445_010_652_376_1],
            [376.927_701_753_729, 99.186_010_331_637_22],
            [157.855_637_632_029_21, 248.471_920_148_996_62],
        ],
        [-0.297_002_840_018_067_4, 0.231_688_310_656_336_72],
    ),
    (
        12,
        [
            [358.259_645_061_583_8, 176.450_168_854_181_67],
            [376.959_708_189_168_9, 99.209_574_546_167_69],
            [157.896_681_464_249_44, 248.502_403_566_784_47],
        ],
        [-0.297_158_478_280_594_4, 0.231_565_933_565_004_82],
    ),
    (
        14,
        [
            [358.271_043_080_168_9, 176.515_065_136_269_13],
            [376.899_068_353_195_3, 99.581_942_363_263_12],
            [159.477_412_268_887_26, 248.192_358_123_511_87],
        ],
        [-0.299_250_366_099_209_2, 0.233_828_834_812_539_72],
    ),
];

/// The camera that OpenCV has for these extrinsics.
fn camera(coefficients: usize) -> Camera {
    let distortion = Distortion::new(&COEFFICIENTS[..coefficients]).unwrap();
    let lens = Pinhole::new([812.5, 798.0], [331.25, 242.75], distortion).unwrap();
    let world_to_camera = Pose {
        position: Vec3::new(0.02, -0.05, 0.6),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.4, 0.25)),
    };
    Camera::new(Lens::Pinhole(lens), world_to_camera.inverse(), Some([640, 480])).unwrap()
}

fn orthographic() -> Camera {
    let lens = Lens::Orthographic(Orthographic::new(2500.0, [320.0, 240.0]).unwrap());
    Camera::new(lens, camera(0).pose(), None).unwrap()
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn points_are_seen_where_opencv_sees_them() {
    for (count, seen, ideal) in OPENCV {
        let camera = camera(count);
        for (point, expected) in POINTS.into_iter().zip(seen) {
            let pixel = camera.project(point).unwrap();
            assert!(apart(pixel, expected) < 1e-10, "{count}: {pixel:?}");
        }
        let got = camera.undistort([100.0, 420.0]).unwrap();
        assert!(apart(got, ideal) < 1e-12, "{count}: {got:?}");
    }
}

#[test]
fn gradients_are_those_of_moved_points_and_cameras() {
    let h = 1e-6;
    for camera in [camera(14), camera(0), orthographic()] {
        for point in POINTS {
            let got = camera.project_with_gradient(point).unwrap();
            let difference =
                |ahead: [f64; 2], behind: [f64; 2], i: usize| (ahead[i] - behind[i]) / (2.0 * h);
            for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
                let moved = |h: f64| camera.project(point + h * axis).unwrap();
                let shifted = |h: f64| {
                    let pose = camera.pose();
                    let pose = Pose { position: pose.position + h * axis, ..pose };
                    camera.at(pose).unwrap().project(point).unwrap()
                };
                let turned = |h: f64| {
                    let pose = camera.pose();
                    let rotation = UnitQuaternion::exp(h * axis) * pose.rotation;
                    camera.at(Pose { rotation, ..pose }).unwrap().project(point).unwrap()
                };
                for i in 0..2 {
                    let by_point = difference(moved(h), moved(-h), i);
                    let by_shift = difference(shifted(h), shifted(-h), i);
                    let by_turn = difference(turned(h), turned(-h), i);
                    assert!((got.by_point[i][j] - by_point).abs() < 1e-5);
                    assert!((got.by_shift[i][j] - by_shift).abs() < 1e-5);
                    assert!((got.by_turn[i][j] - by_turn).abs() < 1e-5);
                }
            }
        }
    }
}

#[test]
fn an_orthographic_camera_scales_and_looks_along_parallel_rays() {
    let camera = orthographic();
    for point in POINTS {
        let view = camera.in_view(point);
        let pixel = camera.project(point).unwrap();
        assert!(apart(pixel, [320.0 + 2500.0 * view.x, 240.0 + 2500.0 * view.y]) < 1e-12);
        let ray = camera.ray(pixel).unwrap();
        assert_eq!(ray.direction, camera.pose().rotation.rotate(Vec3::Z));
        assert!((point - ray.origin - view.z * ray.direction).norm() < 1e-15);
    }
}

#[test]
fn what_a_camera_cannot_be_is_named() {
    let message = |error: CameraError| error.to_string();
    assert_eq!(
        message(Distortion::new(&[0.1, 0.2]).unwrap_err()),
        "a lens has 4, 5, 8, 12 or 14 distortion coefficients, or none, but 2 are given"
    );
    assert_eq!(
        message(Distortion::new(&[0.1, f64::NAN, 0.0, 0.0]).unwrap_err()),
        "the camera's k2 must be a finite number, but is NaN"
    );
    assert_eq!(
        message(Pinhole::new([800.0, -1.0], [0.0; 2], Distortion::NONE).unwrap_err()),
        "the camera's focal length must be greater than zero, but is -1"
    );
    let pose = Pose { rotation: UnitQuaternion { w: 2.0, v: Vec3::ZERO }, ..Pose::IDENTITY };
    assert_eq!(
        message(camera(0).at(pose).unwrap_err()),
        "the camera's rotation must be a quaternion of norm 1, but its norm is 2"
    );
}

#[test]
fn what_a_camera_cannot_see_is_named() {
    let camera = camera(4).at(Pose::IDENTITY).unwrap();
    let refusal = |point| camera.project(point).unwrap_err().to_string();
    assert_eq!(
        refusal(Vec3::new(0.0, 0.0, -0.2)),
        "the point is not in front of the camera: its depth is -200 mm"
    );
    // r − 0.28 r³ + 0.09 r⁵ grows for ever; with k₂ = 0 it does up to r = 1/√0.84.
    let barrel = Distortion::new(&[-0.28, 0.0, 0.0, 0.0]).unwrap();
    let lens = Lens::Pinhole(Pinhole::new([800.0; 2], [320.0, 240.0], barrel).unwrap());
    let folded = Camera::new(lens, Pose::IDENTITY, None).unwrap();
    assert_eq!(
        folded.project(Vec3::new(1.2, 0.0, 1.0)).unwrap_err().to_string(),
        "the point is 50.19° off the optical axis, where the distortion of the lens folds the image: it can be used up to 47.49°"
    );
    assert_eq!(
        folded.ray([920.0, 240.0]).unwrap_err().to_string(),
        "nothing can be seen at pixel (920, 240): the distortion of the lens cannot be inverted there"
    );
    assert!(matches!(
        camera.project(Vec3::new(f64::NAN, 0.0, 1.0)),
        Err(ViewError::OutOfRange { .. })
    ));
    assert!(matches!(camera.ray([f64::INFINITY, 0.0]), Err(ViewError::OutOfRange { .. })));
}

proptest! {
    /// Whatever is seen lies on the ray through its pixel, and nothing is not a number.
    #[test]
    fn a_seen_point_lies_on_its_ray(
        point in prop::array::uniform3(-1e3_f64..1e3),
        coefficients in prop::array::uniform14(-0.5_f64..0.5),
        count in prop::sample::select(vec![0_usize, 4, 5, 8, 12, 14]),
        turn in prop::array::uniform3(-3.0_f64..3.0),
    ) {
        let distortion = Distortion::new(&coefficients[..count]).unwrap();
        let lens = Pinhole::new([812.5, 798.0], [331.25, 242.75], distortion).unwrap();
        let pose = Pose::exp(Twist { linear: Vec3::new(1.0, 2.0, 3.0), angular: turn.into() });
        let camera = Camera::new(Lens::Pinhole(lens), pose, None).unwrap();
        let point = Vec3::from(point);
        if let Ok(seen) = camera.project_with_gradient(point) {
            prop_assert!(seen.pixel.iter().all(|c| c.is_finite()));
            prop_assert!(seen.by_turn.iter().chain(&seen.by_point).all(|g| g.is_finite()));
            if let Ok(ray) = camera.ray(seen.pixel) {
                let again = camera.project(ray.origin + ray.direction);
                let again = again.map_err(|e| TestCaseError::fail(e.to_string()))?;
                prop_assert!(apart(again, seen.pixel) < 1e-9 * (1.0 + seen.pixel[0].hypot(seen.pixel[1])));
            }
        }
    }
}
