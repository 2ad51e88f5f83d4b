//! Camera files: what OpenCV writes is read, what is written is read again, and what cannot be is named.

use std::path::Path;

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{Camera, Distortion, Lens, Orthographic, Pinhole};
use whipcord_io::{
    CalibratedCamera, CameraFormat, calibrated_camera_text, camera_text, load_camera,
    parse_calibrated_camera, parse_camera,
};

use crate::messages::{sections, told};

fn camera() -> Camera {
    let distortion = Distortion::new(&[-0.28, 0.09, 1.2e-3, -7e-4, -0.015]).unwrap();
    let lens = Pinhole::new([812.5, 798.0], [331.25, 242.75], distortion).unwrap();
    let world_to_camera = Pose {
        position: Vec3::new(0.02, -0.05, 0.6),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.4, 0.25)),
    };
    Camera::new(Lens::Pinhole(lens), world_to_camera.inverse(), Some([640, 480])).unwrap()
}

/// Written by `cv2.FileStorage` of OpenCV 5.0.0, with the numbers of [`camera`]. OpenCV 4 begins its YAML
/// with a line of its own.
#[test]
fn what_opencv_writes_is_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for name in ["opencv5-camera.yml", "opencv5-camera.json"] {
        assert_eq!(load_camera(folder.join(name)).unwrap(), camera(), "{name}");
    }
    let text = std::fs::read_to_string(folder.join("opencv5-camera.yml")).unwrap();
    let older = text.replace("%YAML 1.2", "%YAML:1.0");
    assert!(older.starts_with("%YAML:1.0"));
    assert_eq!(parse_camera("opencv4-camera.yml", &older).unwrap(), camera());
}

#[test]
fn other_spellings_are_read() {
    let bare = Camera::new(*camera().lens(), Pose::IDENTITY, None).unwrap();
    for text in [
        "K: [[812.5, 0, 331.25], [0, 798, 242.75], [0, 0, 1]]\nD: [-0.28, 0.09, 1.2e-3, -7e-4, -0.015]\n",
        "distortion_model: plumb_bob\ncameraMatrix: [812.5, 0, 331.25, 0, 798., 242.75, 0, 0, 1]\ndist_coeffs: [[-0.28], [0.09], [1.2e-3], [-7e-4], [-0.015]]\n",
    ] {
        assert_eq!(parse_camera("camera.yml", text).unwrap(), bare);
    }
}

#[test]
fn what_is_written_is_read_again() {
    let flat = Lens::Orthographic(Orthographic::new(2512.75, [320.0, 1e-7]).unwrap());
    let undistorted = Pinhole::new([1e3; 2], [0.1, 0.2], Distortion::NONE).unwrap();
    for camera in [
        camera(),
        Camera::new(flat, camera().pose(), None).unwrap(),
        Camera::new(flat, Pose::IDENTITY, Some([1920, 1080])).unwrap(),
        Camera::new(Lens::Pinhole(undistorted), Pose::IDENTITY, None).unwrap(),
    ] {
        for format in [CameraFormat::Yaml, CameraFormat::Json] {
            let again = parse_camera("camera", &camera_text(&camera, format)).unwrap();
            assert_eq!((again.lens(), again.size()), (camera.lens(), camera.size()));
            let apart = again.pose() * camera.pose().inverse();
            assert!(apart.position.norm() < 1e-15 && apart.rotation.log().norm() < 1e-15);
        }
    }
    insta::assert_snapshot!(camera_text(
        &Camera::new(flat, Pose::IDENTITY, Some([1920, 1080])).unwrap(),
        CameraFormat::Yaml
    ));
    insta::assert_snapshot!(camera_text(
        &Camera::new(*camera().lens(), Pose::IDENTITY, Some([1920, 1080])).unwrap(),
        CameraFormat::Json
    ));
}

#[test]
fn the_covariance_of_the_lens_is_read_again() {
    let rows: Vec<Vec<f64>> = (0..6)
        .map(|i| (0..6).map(|j| if i == j { 1.0 + 0.1 * i as f64 } else { 0.125 }).collect())
        .collect();
    let of = CalibratedCamera { camera: camera(), lens_covariance: Some(rows.clone()) };
    for format in [CameraFormat::Yaml, CameraFormat::Json] {
        let text = calibrated_camera_text(&of, format);
        let again = parse_calibrated_camera("camera", &text).unwrap();
        assert_eq!(again.lens_covariance.as_ref(), Some(&rows));
        // Without it the text is that of a camera.
        let bare = CalibratedCamera { lens_covariance: None, ..of.clone() };
        assert_eq!(calibrated_camera_text(&bare, format), camera_text(&camera(), format));
        assert_eq!(parse_camera("camera", &text).unwrap().lens(), camera().lens());
    }
    let bare = parse_calibrated_camera("camera", &camera_text(&camera(), CameraFormat::Yaml));
    assert_eq!(bare.unwrap().lens_covariance, None);
}

#[test]
fn cameras_that_are_refused() {
    const MATRIX: &str = "camera_matrix: [ 812.5, 0., 331.25, 0., 798., 242.75, 0., 0., 1. ]\n";
    let with = |lines: &str| format!("%YAML:1.0\n---\n{MATRIX}{lines}\n");
    let cases = [
        ("empty", String::new()),
        ("a robot file", "[backbone]\nlength = \"180 mm\"\n".to_owned()),
        ("XML", "<?xml version=\"1.0\"?>\n<opencv_storage></opencv_storage>\n".to_owned()),
        ("torn", "camera_matrix: [ 1., 0.,\nrvec: ".to_owned()),
        ("no matrix", "image_width: 640\nimage_height: 480\n".to_owned()),
        ("a short matrix", "camera_matrix: [1, 2, 3]\n".to_owned()),
        (
            "a matrix that contradicts itself",
            "K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   data: [1, 0]\n".to_owned(),
        ),
        ("skew", "K: [800, 0.5, 320, 0, 800, 240, 0, 0, 1]\n".to_owned()),
        ("no focal length", "K: [0, 0, 320, 0, 800, 240, 0, 0, 1]\n".to_owned()),
        ("a failed calibration", "K: [.Nan, 0, 320, 0, 800, 240, 0, 0, 1]\n".to_owned()),
        ("words", "K: [fx, 0, 320, 0, 800, 240, 0, 0, 1]\n".to_owned()),
        ("coefficients", with("D: [0.1, 0.2, 0.3]")),
        ("a fisheye", with("distortion_model: equidistant\nD: [0.1, 0.2, 0.3, 0.4]")),
        ("twice", with("K: [1, 0, 0, 0, 1, 0, 0, 0, 1]")),
        ("a size and a half", with("image_width: 640")),
        ("half a pixel", with("image_width: 640.5\nimage_height: 480")),
        ("a pose", with("rvec: [0, 0]\ntvec: [0, 0, .Inf]")),
        ("far away", with("tvec: [1e300, 0, 0]")),
        ("another projection", with("projection: fisheye")),
        ("no scale", "projection: orthographic\n".to_owned()),
        ("a covariance that is not square", with("lens_covariance: [1, 0, 0, 1, 0]")),
        (
            "a covariance of more than the lens has",
            with(
                "lens_covariance: [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]",
            ),
        ),
        (
            "a covariance that is none",
            with("lens_covariance: [1, 2, 0, 0, 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"),
        ),
        (
            "a covariance without a lens",
            "projection: orthographic\npixels_per_metre: 2500\nlens_covariance: [1]\n".to_owned(),
        ),
        ("aliases", "a: &a [1, 2]\nK: *a\n".to_owned()),
        ("deep", "[".repeat(100)),
    ];
    insta::assert_snapshot!(sections(
        cases
            .iter()
            .map(|(name, text)| { (*name, told(&parse_camera("camera.yml", text).unwrap_err())) })
    ));
}

#[test]
fn formats_are_told_by_the_end_of_the_name() {
    assert_eq!(CameraFormat::of(Path::new("a/lens.YML")), Some(CameraFormat::Yaml));
    assert_eq!(CameraFormat::of(Path::new("lens.json")), Some(CameraFormat::Json));
    assert_eq!(CameraFormat::of(Path::new("lens.xml")), None);
}
