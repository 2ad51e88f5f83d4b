//! `whipcord camera`: a camera is located from what it saw of the robot before actuation.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod support;

use std::fmt::Write as _;

use support::{Scratch, fail, robot, succeed};
use whipcord::camera::{Camera, Distortion, Lens, Orthographic, Pinhole};
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_io::{CameraFormat, camera_text, load_camera};

/// A camera beside the robot that looks along −x, its axis upright in the image.
fn beside(lens: Lens) -> Camera {
    let rotation = UnitQuaternion::from_wxyz([0.5, 0.5, -0.5, -0.5]).unwrap();
    let pose = Pose { position: Vec3::new(0.7, 0.0, 0.09), rotation };
    Camera::new(lens, pose, Some([640, 480])).unwrap()
}

fn pinhole() -> Lens {
    let distortion = Distortion::new(&[-0.28, 0.09, 1.2e-3, -7e-4]).unwrap();
    Lens::Pinhole(Pinhole::new([1500.0, 1490.0], [331.25, 242.75], distortion).unwrap())
}

/// The rows of disks of the straight robot, as the camera sees them.
fn disks(camera: &Camera) -> String {
    let mut table = String::from("disk,offset_x,offset_y,u,v\n");
    for disk in 0..10 {
        let [u, v] = camera.project(Vec3::new(0.0, 0.0, 0.02 * f64::from(disk))).unwrap();
        let _ = writeln!(table, "{},0,0,{u},{v}", disk + 1);
    }
    table
}

#[test]
fn a_camera_is_located_by_the_robot_at_rest() {
    let scratch = Scratch::new();
    let file = scratch.write("arm.toml", &robot("tension = \"4 N\""));
    let camera = beside(pinhole());
    let lens = Camera::new(pinhole(), Pose::IDENTITY, Some([640, 480])).unwrap();
    let lens = scratch.write("lens.yml", &camera_text(&lens, CameraFormat::Yaml));
    let disks = disks(&camera);
    let rest = scratch.write("rest.csv", &disks);
    let [a, b] = [Vec3::new(0.008, 0.0, 0.0), Vec3::new(0.0, 0.008, 0.18)]
        .map(|point| camera.project(point).unwrap());
    let markers = format!("{disks}1,0.008,0,{},{}\n10,0,0.008,{},{}\n", a[0], a[1], b[0], b[1]);
    let markers = scratch.write("markers.csv", &markers);
    let output = scratch.file("side.yml");

    let message = fail(2, &["camera", "locate", &file, "--lens", &lens, "--markers", &rest]);
    assert!(message.contains("the points are on one line, along (0, 0, 1)"), "{message}");
    assert!(message.contains("(--view)"), "{message}");

    for arguments in [&["--markers", &rest, "--view", "-1,0,0"][..], &["--markers", &markers]] {
        let common = ["camera", "locate", &file, "--lens", &lens, "-o", &output];
        let text = succeed(&[&common[..], arguments].concat());
        assert!(text.contains("at (700, 0, 90) mm, looking along (-1, 0, 0)"), "{text}");
        assert!(text.contains("0 pixels RMS"), "{text}");
        let found = load_camera(&output).unwrap();
        assert!((found.pose().position - camera.pose().position).norm() < 1e-6);
        assert_eq!((found.lens(), found.size()), (camera.lens(), camera.size()));
    }
}

#[test]
fn an_orthographic_camera_gets_its_scale_from_the_length_of_the_robot() {
    let scratch = Scratch::new();
    let file = scratch.write("arm.toml", &robot("tension = \"4 N\""));
    let camera = beside(Lens::Orthographic(Orthographic::new(2500.0, [320.0, 240.0]).unwrap()));
    let rest = scratch.write("rest.csv", &disks(&camera));
    let output = scratch.file("side.json");
    let text = succeed(&[
        "camera",
        "locate",
        &file,
        "--markers",
        &rest,
        "--view",
        "-1,0,0",
        "-o",
        &output,
    ]);
    assert!(text.contains("2.5 pixels/mm") && text.contains("from 10 markers"), "{text}");
    let found = load_camera(&output).unwrap();
    for point in [Vec3::ZERO, Vec3::new(0.3, 0.1, 0.2)] {
        let (a, b) = (found.project(point).unwrap(), camera.project(point).unwrap());
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{a:?} {b:?}");
    }
}

#[test]
fn what_cannot_be_used_is_named_and_nothing_is_written() {
    let scratch = Scratch::new();
    let file = scratch.write("arm.toml", &robot("tension = \"4 N\""));
    let rest = scratch.write("rest.csv", "disk,u,v\n1,320,400\n11,320,80\n");
    let output = scratch.file("side.yml");
    let located = |markers: &str, output: &str| {
        fail(2, &["camera", "locate", &file, "--markers", markers, "--view", "1,0,0", "-o", output])
    };
    let message = located(&rest, &output);
    assert!(message.contains("rest.csv:3:1"), "{message}");
    assert!(located(&rest, &scratch.file("side.xml")).contains("ends in .yml, .yaml or .json"));
    let positions = scratch.write("positions.csv", "disk,x,y,z\n1,0,0,0\n");
    let message = located(&positions, &output);
    assert!(message.contains("`u` and `v`"), "{message}");
    let one = scratch.write("one.csv", "disk,u,v\n1,320,400\n");
    assert!(located(&one, &output).contains("needs 2 points or more, but 1 is given"));
    assert!(!std::path::Path::new(&output).exists());
}
