//! `whipcord camera`: a lens is calibrated by photographs of a board, and a camera is located from what it saw of the robot
//! before actuation.

use std::fmt::Write as _;

use crate::support::{Scratch, fail, robot, succeed};
use serde_json::Value;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{Camera, Distortion, Lens, Orthographic, Pinhole};
use whipcord_io::{
    CalibratedCamera, CameraFormat, calibrated_camera_text, camera_text, load_calibrated_camera,
    load_camera,
};
use whipcord_vision::Photo;
use whipcord_vision::boards::Board;
use whipcord_vision::render::{Blur, BoardScene, Noise};

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
    // The column in which `measure --name` says which camera it was changes nothing.
    let named = disks(&camera).replace("disk,", "camera,disk,").replace("\n", "\nside,");
    let named = scratch.write("named.csv", named.trim_end_matches("side,"));
    let again = succeed(&["camera", "locate", &file, "--markers", &named, "--view", "-1,0,0"]);
    assert!(again.contains("2.5 pixels/mm"), "{again}");
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

/// The errors of the lens in the camera file are part of those of the place, and go with the camera.
#[test]
fn the_place_of_a_camera_has_standard_deviations() {
    let scratch = Scratch::new();
    let file = scratch.write("arm.toml", &robot("tension = \"4 N\""));
    let lens = Pinhole::new([900.0; 2], [320.0, 240.0], Distortion::NONE).unwrap();
    let camera = beside(Lens::Pinhole(lens));
    let alone = scratch.write("lens.yml", &camera_text(&camera, CameraFormat::Yaml));
    // Focal lengths of 9 pixels of deviation, which go together.
    let mut rows = vec![vec![0.0; 4]; 4];
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        rows[i][j] = 81.0;
    }
    let of = CalibratedCamera { camera, lens_covariance: Some(rows) };
    let sure = scratch.write("sure.yml", &calibrated_camera_text(&of, CameraFormat::Yaml));
    let rest = scratch.write("rest.csv", &disks(&camera));
    let output = scratch.file("side.yml");
    let locate = |lens: &str, more: &[&str]| {
        let fixed = ["camera", "locate", &file, "--markers", &rest, "--lens", lens];
        succeed(&[&fixed[..], &["--view", "-1,0,0"], more].concat())
    };
    let object = |lens: &str| -> Value {
        serde_json::from_str(&locate(lens, &["--json", "--pixel-deviation", "0.3"])).unwrap()
    };
    let [bare, whole] = [object(&alone), object(&sure)];
    let deviation = |of: &Value, k: usize| of["position_deviation"][k].as_f64().unwrap();
    // One per cent of the focal length is one of the distance along the view, x.
    let distance = camera.pose().position.x;
    let expected = (deviation(&bare, 0).powi(2) + (0.01 * distance).powi(2)).sqrt();
    assert!((deviation(&whole, 0) / expected - 1.0).abs() < 1e-3, "{whole}");
    assert!((deviation(&whole, 2) / deviation(&bare, 2) - 1.0).abs() < 0.05);
    assert_eq!(whole["covariance"].as_array().unwrap().len(), 6);
    assert_eq!(whole["pixel_deviation"], 0.3);
    let text = locate(&sure, &["--pixel-deviation", "0.3", "-o", &output]);
    assert!(text.contains("by pixels and lens, 0.3 pixels a column or row"), "{text}");
    assert_eq!(load_calibrated_camera(&output).unwrap().lens_covariance, of.lens_covariance);
    assert!(locate(&alone, &["--pixel-deviation", "0.3"]).contains("by pixels alone"));
}

/// Photographs of a board from some sides, blurred and noisy.
fn photographs(scratch: &Scratch, board: &Board) -> Vec<String> {
    let sides = [
        (0.46, [0.0, 0.0], [0.0, 0.0]),
        (0.52, [0.45, -0.3], [0.02, 0.01]),
        (0.55, [-0.5, 0.2], [-0.06, -0.04]),
        (0.50, [0.1, 0.55], [0.05, -0.03]),
        (0.60, [-0.2, -0.6], [0.08, 0.06]),
    ];
    let photograph =
        |(k, &(distance, [x, y], [right, below])): (usize, &(f64, [f64; 2], [f64; 2]))| {
            let middle = 0.5 * (board.point(0) + board.point(board.count() - 1));
            let rotation = UnitQuaternion::exp(Vec3::new(x, y, 0.0));
            let position = middle - rotation.rotate(Vec3::new(right, below, distance));
            let lens = Pinhole::new([820.0, 815.0], [325.0, 236.0], Distortion::NONE).unwrap();
            let camera =
                Camera::new(Lens::Pinhole(lens), Pose { position, rotation }, Some([640, 480]))
                    .unwrap();
            let scene = BoardScene {
                blur: Blur { deviation: 0.8, motion: [0.0; 2] },
                noise: Noise::of(0.01, k as u64),
                ..BoardScene::default()
            };
            let png = scene.photograph(board, &camera).unwrap().photo.to_png().unwrap();
            scratch.write(&format!("board-{k}.png"), &png)
        };
    sides.iter().enumerate().map(photograph).collect()
}

#[test]
fn a_lens_is_calibrated_by_photographs_of_a_board() {
    let scratch = Scratch::new();
    let photos = photographs(&scratch, &Board::chessboard([9, 6], 0.025).unwrap());
    let empty = Photo::uniform(640, 480, [0.3; 3]).to_png().unwrap();
    let empty = scratch.write("empty.png", &empty);
    let other = Photo::uniform(320, 240, [0.3; 3]).to_png().unwrap();
    let output = scratch.file("lens.yml");
    let mut arguments = vec!["camera", "calibrate", &empty];
    arguments.extend(photos.iter().map(String::as_str));
    arguments.extend(["--board", "chessboard:9x6", "--square", "25 mm", "--distortion", "none"]);
    let text = succeed(&[&arguments[..], &["-o", &output]].concat());
    assert!(
        text.contains("lens, from 5 of 6 photographs of a chessboard of 9×6 inner corners"),
        "{text}"
    );
    assert!(text.contains("1  ") && text.contains("empty.png: no board is seen"), "{text}");
    assert!(text.contains("note: only 5 photographs show the board"), "{text}");
    let camera = load_camera(&output).unwrap();
    let Lens::Pinhole(lens) = camera.lens() else { panic!("{camera:?}") };
    assert!(
        (lens.focal()[0] - 820.0).abs() < 2.0 && (lens.centre()[1] - 236.0).abs() < 2.0,
        "{lens:?}"
    );
    assert_eq!(camera.size(), Some([640, 480]));
    let covariance = load_calibrated_camera(&output).unwrap().lens_covariance.unwrap();

    let object: Value =
        serde_json::from_str(&succeed(&[&arguments[..], &["--json"]].concat())).unwrap();
    assert_eq!(object["focal"][0].as_f64(), Some(lens.focal()[0]));
    assert_eq!(object["photographs"].as_array().unwrap().len(), 5);
    for i in 0..4 {
        for j in 0..4 {
            assert_eq!(object["covariance"][i][j].as_f64(), Some(covariance[i][j]));
        }
    }
    let focal = object["focal_deviation"][0].as_f64().unwrap();
    assert!((covariance[0][0].sqrt() - focal).abs() < 1e-9 * focal);
    assert_eq!(object["photographs"][0]["corners"], 54);
    assert_eq!(object["refused"][0]["reason"], "no board is seen");
    let off = (lens.focal()[0] - 820.0).abs() / object["focal_deviation"][0].as_f64().unwrap();
    assert!(off < 3.0, "{off}");

    // Too few of them are usable: nothing is written.
    let small = scratch.write("small.png", &other);
    let nothing = scratch.file("nothing.yml");
    let board = ["--board", "chessboard:9x6", "--square", "25 mm", "-o", &nothing];
    let message =
        fail(1, &[&["camera", "calibrate", &empty, &small, &photos[0]], &board[..]].concat());
    assert!(
        message.contains("a calibration needs 3 photographs of the board or more, but 1 is given"),
        "{message}"
    );
    assert!(message.contains("small.png: no board is seen"), "{message}");
    let broken = scratch.write("broken.png", "\u{89}PNG no more");
    let message = fail(2, &[&["camera", "calibrate", &broken], &board[..]].concat());
    assert!(message.contains("broken.png"), "{message}");
    assert!(!std::path::Path::new(&nothing).exists());
}

#[test]
fn boards_that_there_are_not_are_named() {
    let wrong =
        |arguments: &[&str]| fail(2, &[&["camera", "calibrate", "none.png"], arguments].concat());
    let message = wrong(&["--board", "chessboard:9", "--square", "25 mm"]);
    assert!(message.contains("give chessboard:9x6 with the number of inner corners"), "{message}");
    let message = wrong(&["--board", "chessboard:9x6", "--square", "25"]);
    assert!(message.contains("give a length such as \"25 mm\""), "{message}");
    let message = wrong(&["--board", "charuco:8x6", "--square", "25 mm"]);
    assert!(message.contains("needs the side of its markers and their dictionary"), "{message}");
    let markers = ["--marker", "18 mm", "--dictionary", "DICT_9X9"];
    let message = wrong(&[&["--board", "charuco:8x6", "--square", "25 mm"], &markers[..]].concat());
    assert!(
        message.contains("there is no dictionary \"DICT_9X9\": there are DICT_4X4"),
        "{message}"
    );
}
