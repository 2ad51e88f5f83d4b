//! Two cameras: calibrated by pairs of photographs of a board, and a robot that both photograph, all synthetic.

use std::path::Path;

use crate::support::{Scratch, fail, root, succeed};
use serde_json::Value;
use whipcord::{Actuation, Model, ModelKind, Pose, Stations, UnitQuaternion, Vec3};
use whipcord_estimation::Seen;
use whipcord_estimation::camera::{Camera, Distortion, Lens, Pinhole};
use whipcord_io::{CameraFormat, camera_text, load, load_camera};
use whipcord_vision::boards::Board;
use whipcord_vision::render::{Blur, BoardScene, Noise, Occluder, Scene};

const ROBOT: &str = "examples/table1/case-1.toml";
const SIZE: [u32; 2] = [640, 480];

fn lens(focal: f64) -> Lens {
    Lens::Pinhole(Pinhole::new([focal; 2], [325.0, 236.0], Distortion::NONE).unwrap())
}

/// The second camera in the frame of the first.
fn relative() -> Pose {
    let rotation = UnitQuaternion::exp(Vec3::new(0.03, -0.6, 0.05));
    Pose { position: Vec3::new(0.3, -0.01, 0.08), rotation }
}

/// Both cameras, the first of them here.
fn cameras(first: Pose) -> [Camera; 2] {
    [(820.0, first), (760.0, first * relative())]
        .map(|(focal, pose)| Camera::new(lens(focal), pose, Some(SIZE)).unwrap())
}

fn write(scratch: &Scratch, name: &str, bytes: &[u8]) -> String {
    std::fs::write(scratch.path().join(name), bytes).unwrap();
    scratch.file(name)
}

/// Photographs of both cameras of a board that is held up in several ways.
fn boards(scratch: &Scratch, board: &Board, hidden: bool) -> [Vec<String>; 2] {
    let tilts = [[0.0, 0.2, 0.0], [0.4, 0.1, 0.1], [-0.4, 0.4, -0.1], [0.3, 0.2, -0.3]];
    let mut photos = [Vec::new(), Vec::new()];
    for (k, tilt) in tilts.into_iter().enumerate() {
        let middle = 0.5 * (board.point(0) + board.point(board.count() - 1));
        let rotation = UnitQuaternion::exp(tilt.into());
        let at = Vec3::new(0.01, 0.0, 0.52);
        let first = Pose { position: at - rotation.rotate(middle), rotation }.inverse();
        for (i, camera) in cameras(first).iter().enumerate() {
            let mut scene = BoardScene {
                blur: Blur { deviation: 0.8, motion: [0.0; 2] },
                noise: Noise::of(0.01, (2 * k + i) as u64),
                ..BoardScene::default()
            };
            if hidden {
                let edge = [200.0, 440.0][i];
                let end = [0.0, 639.0][i];
                scene.occluders.push(Occluder {
                    corners: vec![[end, 0.0], [edge, 0.0], [edge, 479.0], [end, 479.0]],
                    colour: [0.5, 0.3, 0.2],
                });
            }
            let png = scene.photograph(board, camera).unwrap().photo.to_png().unwrap();
            photos[i].push(write(scratch, &format!("board-{i}-{k}.png"), &png));
        }
    }
    photos
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// How far the second camera is from where it must be before the first, in m and rad.
fn off([first, second]: [&str; 2]) -> [f64; 2] {
    let [first, second] = [first, second].map(|path| load_camera(path).unwrap().pose());
    let off = relative().inverse() * (first.inverse() * second);
    [off.position.norm(), off.rotation.log().norm()]
}

#[test]
fn two_cameras_are_calibrated_by_pairs_of_photographs() {
    let scratch = Scratch::new();
    let board = Board::chessboard([9, 6], 0.025).unwrap();
    let [first, second] = boards(&scratch, &board, false);
    let (left, right) = (scratch.file("left.yml"), scratch.file("right.yml"));
    let mut arguments = vec!["camera", "calibrate"];
    arguments.extend(first.iter().map(String::as_str));
    arguments.push("--stereo");
    arguments.extend(second.iter().map(String::as_str));
    arguments.extend(["--board", "chessboard:9x6", "--square", "25 mm", "--distortion", "none"]);
    let outputs = ["-o", &left, "--stereo-output", &right];
    let text = succeed(&[&arguments[..], &outputs].concat());
    assert!(text.contains("second camera, from 4 of 4 pairs of photographs"), "{text}");
    assert!(text.contains("epipolar  0.0"), "{text}");
    let [shift, turn] = off([&left, &right]);
    assert!(shift < 3e-3 && turn < 5e-3, "{shift} {turn}");

    // With the lenses given the pose is within its own uncertainty.
    let given = cameras(Pose::IDENTITY).map(|c| Camera::new(*c.lens(), Pose::IDENTITY, Some(SIZE)));
    let given = given.map(|camera| camera_text(&camera.unwrap(), CameraFormat::Yaml));
    let given = [("a.yml", &given[0]), ("b.yml", &given[1])].map(|(n, t)| scratch.write(n, t));
    let lenses = ["--camera", &given[0], "--stereo-camera", &given[1], "--json"];
    let json = succeed(&[&arguments[..], &outputs, &lenses].concat());
    let object: Value = serde_json::from_str(&json).unwrap();
    for k in 0..3 {
        let off = number(&object["position"][k]) - relative().position[k];
        let deviation = number(&object["position_deviation"][k]);
        assert!(off.abs() < 4.0 * deviation && deviation < 5e-4, "{k}: {off} ± {deviation}");
    }
    assert_eq!(object["pairs"].as_array().unwrap().len(), 4);
    assert!(number(&object["epipolar"]) < 0.1, "{json}");
    let [shift, turn] = off([&left, &right]);
    assert!(shift < 5e-4 && turn < 1e-3, "{shift} {turn}");

    let one_less: Vec<&str> =
        arguments.iter().copied().filter(|argument| *argument != second[0]).collect();
    let message = fail(2, &one_less);
    assert!(
        message.contains("4 photographs are of the first camera, but 3 of the second"),
        "{message}"
    );
    // One pair of a chessboard does not tell which way the second camera is up.
    let one =
        ["camera", "calibrate", &first[0], "--stereo", &second[0], "--board", "chessboard:9x6"];
    let message = fail(1, &[&one[..], &["--square", "25 mm"], &lenses].concat());
    assert!(message.contains("do not tell two poses of the second camera apart"), "{message}");
}

/// Of a ChArUco board each camera sees another part.
#[test]
fn a_board_may_be_partly_hidden_in_both() {
    let scratch = Scratch::new();
    let board = Board::charuco([8, 6], 0.03, 0.022, "DICT_4X4_50").unwrap();
    let [first, second] = boards(&scratch, &board, true);
    // The file of the first says where it is.
    let place = Pose {
        position: Vec3::new(0.1, -0.4, 0.2),
        rotation: UnitQuaternion::exp(Vec3::new(-1.5, 0.2, 0.1)),
    };
    let given = cameras(Pose::IDENTITY).map(|camera| camera.at(place).unwrap());
    let given = given.map(|camera| camera_text(&camera, CameraFormat::Yaml));
    let given = [("a.yml", &given[0]), ("b.yml", &given[1])].map(|(n, t)| scratch.write(n, t));
    let (left, right) = (scratch.file("left.yml"), scratch.file("right.yml"));
    let mut arguments = vec!["camera", "calibrate"];
    arguments.extend(first.iter().map(String::as_str));
    arguments.push("--stereo");
    arguments.extend(second.iter().map(String::as_str));
    arguments.extend(["--board", "charuco:8x6", "--square", "30 mm", "--marker", "22 mm"]);
    arguments.extend(["--dictionary", "DICT_4X4_50", "--camera", &given[0]]);
    arguments.extend(["--stereo-camera", &given[1], "-o", &left, "--stereo-output", &right]);
    let text = succeed(&arguments);
    assert!(text.contains("of 4 pairs of photographs of a ChArUco board"), "{text}");
    let [shift, turn] = off([&left, &right]);
    assert!(shift < 1e-3 && turn < 2e-3, "{shift} {turn}");
    let kept = load_camera(&left).unwrap().pose();
    assert!((kept.position - place.position).norm() < 1e-12, "{kept:?}");
}

/// The robot of the paper before both cameras; a card may hide one disk from the first.
fn robot_photographs(
    scratch: &Scratch,
    hidden: Option<usize>,
) -> ([String; 2], [String; 2], Vec<Vec3>) {
    let file = load(root().join(ROBOT)).unwrap();
    let model = Model::new(ModelKind::Cosserat, Stations::Equal(46), Actuation::Natural);
    let mut prepared = model.prepare(&file.robot, &file.case.loads).unwrap();
    let solution = prepared.solve(&file.case, None).unwrap();
    let mut scene = Scene::of(&file.robot);
    scene.blur = Blur { deviation: 0.8, motion: [0.0, 0.0] };
    scene.noise = Noise::of(0.01, 3);
    // Upright, as in the tests of one camera, and turned half the angle to one side.
    let upright = UnitQuaternion::from_wxyz([0.5, -0.5, -0.5, 0.5]).unwrap();
    let rotation = upright * UnitQuaternion::exp(Vec3::new(0.0, 0.3, 0.0));
    let target = Vec3::new(0.0, 0.0, 0.08);
    let first = Pose { position: target - rotation.rotate(Vec3::new(0.0, 0.0, 0.48)), rotation };
    let cameras = cameras(first);
    let names = ["left", "right"];
    let photos = [0, 1].map(|i| {
        let mut scene = scene.clone();
        if let Some(disk) = hidden.filter(|_| i == 0) {
            let [u, v] = cameras[0].project(solution.disks.poses[disk].position).unwrap();
            let corners = [[-32.0, -13.0], [32.0, -13.0], [32.0, 13.0], [-32.0, 13.0]];
            let corners = corners.map(|[a, b]| [u + a, v + b]).to_vec();
            scene.occluders.push(Occluder { corners, colour: scene.paint.background });
        }
        let rendered = scene.photograph(&file.robot, &solution, &cameras[i]).unwrap();
        write(scratch, &format!("{}.png", names[i]), &rendered.photo.to_png().unwrap())
    });
    let files = [0, 1].map(|i| {
        let text = camera_text(&cameras[i], CameraFormat::Yaml);
        scratch.write(&format!("{}.yml", names[i]), &text)
    });
    (photos, files, solution.disks.positions().collect())
}

#[test]
fn disks_are_measured_in_space() {
    let scratch = Scratch::new();
    let ([left, right], [first, second], truth) = robot_photographs(&scratch, None);
    let csv = scratch.file("points.csv");
    let pictures = [scratch.file("a.png"), scratch.file("b.png")];
    let arguments = ["measure", &left, "--stereo", &right, "--camera", &first];
    let arguments = [&arguments[..], &["--stereo-camera", &second, "--robot", ROBOT]].concat();
    let outputs = ["-o", &csv, "--annotated", &pictures[0], "--stereo-annotated", &pictures[1]];
    let text = succeed(&[&arguments[..], &outputs, &["--step", "1"]].concat());
    assert!(text.contains("10 disks in space, in mm, from base to tip"), "{text}");
    assert!(pictures.iter().all(|path| Path::new(path).exists()));

    // What was written is what a robot file takes.
    let case = root().join(ROBOT).canonicalize().unwrap();
    let measured = format!("extends = '{}'\n[measured]\ndisks = \"points.csv\"\n", case.display());
    let file = load(scratch.write("measured.toml", &measured)).unwrap();
    let observations = file.measured.unwrap().observations;
    assert_eq!(observations.len(), 10);
    for (observation, truth) in observations.iter().zip(&truth) {
        let Seen::Position(position) = observation.seen else { panic!("{observation:?}") };
        assert!((position - *truth).norm() < 1e-3, "{position:?} {truth:?}");
        assert!((5e-5..1e-3).contains(&observation.deviation.unwrap()));
    }

    let json = succeed(&[&arguments[..], &["--json"]].concat());
    let object: Value = serde_json::from_str(&json).unwrap();
    let points = object["points"].as_array().unwrap();
    assert!(points.iter().all(|point| number(&point["epipolar"]) < 1.5), "{json}");
    assert!(number(&points[0]["angle"]) > 0.5);

    // A disk is hidden in the first photograph.
    let ([left, right], [first, second], _) = robot_photographs(&scratch, Some(4));
    let arguments = ["measure", &left, "--stereo", &right, "--camera", &first, "--robot", ROBOT];
    let hidden = ["--stereo-camera", &second, "--hidden", "5"];
    let text = succeed(&[&arguments[..], &hidden].concat());
    assert!(text.contains("seen in the second photograph alone: 5"), "{text}");
    assert!(text.contains("9 disks in space"), "{text}");
}

#[test]
fn photographs_that_do_not_belong_together_are_refused() {
    let scratch = Scratch::new();
    let ([left, right], [first, second], _) = robot_photographs(&scratch, None);
    let csv = scratch.file("points.csv");
    let refused = |cameras: [&str; 2], more: &[&str]| {
        let arguments = ["measure", &left, "--stereo", &right, "--camera", cameras[0]];
        let arguments = [&arguments[..], &["--stereo-camera", cameras[1], "-o", &csv]].concat();
        fail(1, &[&arguments[..], more].concat())
    };
    // Numbered from the other end in one of them.
    let ends = ["--count", "10", "--base", "bottom", "--stereo-base", "top"];
    let message = refused([&first, &second], &ends);
    assert!(message.contains("not where both cameras can see them"), "{message}");
    assert!(message.contains("--base and --stereo-base at the same end"), "{message}");
    // Cameras in the other order, and cameras without poses.
    let sides = ["--count", "10", "--base", "bottom"];
    let message = refused([&second, &first], &sides);
    assert!(message.contains("--camera and --stereo-camera in the order"), "{message}");
    let message = refused([&first, &first], &sides);
    assert!(message.contains("both cameras are in one place"), "{message}");
    assert!(message.contains("whipcord camera calibrate --stereo"), "{message}");
    assert!(!Path::new(&csv).exists());
}

/// Both cameras are moved to where they see the robot before actuation, by few markers in each photograph.
#[test]
fn two_cameras_are_located_together() {
    let scratch = Scratch::new();
    let first = Pose {
        position: Vec3::new(0.0, -0.5, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(-core::f64::consts::FRAC_PI_2, 0.0, 0.0)),
    };
    let truth = cameras(first);
    let own = cameras(Pose::IDENTITY).map(|camera| camera_text(&camera, CameraFormat::Yaml));
    let own = [("left.yml", &own[0]), ("right.yml", &own[1])].map(|(n, t)| scratch.write(n, t));
    // Three dots that both see: on two disks and beside the tip.
    let dots = [(1, 0.0), (6, 0.0), (10, 0.02)];
    let markers = [0, 1].map(|camera| {
        let mut table = String::from("disk,offset_x,offset_y,offset_z,u,v\n");
        for (disk, offset) in dots {
            let point = Vec3::new(offset, 0.0, 0.02 * f64::from(disk - 1));
            let [u, v] = truth[camera].project(point).unwrap();
            table += &format!("{disk},{offset},0,0,{u},{v}\n");
        }
        scratch.write(&format!("markers-{camera}.csv"), &table)
    });
    let outputs = [scratch.file("a.yml"), scratch.file("b.yml")];
    let args = ["camera", "locate", ROBOT, "--markers", &markers[0], "--lens", &own[0]];
    let stereo = ["--stereo", &own[1], "--stereo-markers", &markers[1]];
    let files = ["-o", &outputs[0], "--stereo-output", &outputs[1]];
    let text = succeed(&[&args[..], &stereo, &files].concat());
    assert!(text.contains("two cameras of") && text.contains("3 markers, 0 pixels RMS"), "{text}");
    for (path, truth) in outputs.iter().zip(&truth) {
        let off = truth.pose().inverse() * load_camera(path).unwrap().pose();
        assert!(off.position.norm() < 1e-7 && off.rotation.log().norm() < 1e-7, "{path}");
    }
    // Markers on the axis alone are seen alike from all sides.
    let line = scratch.write("line.csv", "disk,u,v\n1,325,400\n5,325,300\n10,325,200\n");
    let args = ["camera", "locate", ROBOT, "--markers", &line, "--lens", &own[0]];
    let message = fail(2, &[&args[..], &["--stereo", &own[1], "--stereo-markers", &line]].concat());
    assert!(message.contains("(--view)"), "{message}");
    let message = fail(2, &[&args[..], &["--stereo", &own[1]]].concat());
    assert!(message.contains("--stereo-markers"), "{message}");
}
