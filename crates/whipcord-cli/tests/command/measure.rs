//! `whipcord measure` on synthetic photographs, whose truth is known.

use std::path::Path;

use crate::support::{Scratch, fail, root, succeed};
use serde_json::Value;
use whipcord::{Actuation, Model, ModelKind, Pose, Stations, UnitQuaternion, Vec3};
use whipcord_estimation::Seen;
use whipcord_estimation::camera::{Camera, Lens, Orthographic};
use whipcord_io::{CameraFormat, camera_text, load};
use whipcord_vision::Photo;
use whipcord_vision::render::{Blur, Noise, Occluder, Rendered, Scene};

const ROBOT: &str = "examples/table1/case-1.toml";

/// Looks at the robot from the side, upright: the camera's x, y and z are the world's y, −z and −x.
fn camera() -> Camera {
    let lens = Lens::Orthographic(Orthographic::new(2000.0, [199.5, 229.5]).unwrap());
    let rotation = UnitQuaternion::from_wxyz([0.5, -0.5, -0.5, 0.5]).unwrap();
    let pose = Pose { position: Vec3::new(0.9, 0.0, 0.09), rotation };
    Camera::new(lens, pose, Some([450, 460])).unwrap()
}

/// The paper's Case I.
fn photograph() -> Rendered {
    photograph_of(&root().join(ROBOT), &[])
}

/// A robot, with cards of this size before these pixels.
fn photograph_of(robot: &Path, cards: &[[f64; 2]]) -> Rendered {
    let file = load(robot).unwrap();
    let model = Model::new(ModelKind::Cosserat, Stations::Equal(46), Actuation::Natural);
    let mut prepared = model.prepare(&file.robot, &file.case.loads).unwrap();
    let solution = prepared.solve(&file.case, None).unwrap();
    let mut scene = Scene::of(&file.robot);
    scene.blur = Blur { deviation: 0.8, motion: [0.0, 0.0] };
    scene.noise = Noise::of(0.02, 11);
    let card = |&[u, v]: &[f64; 2]| Occluder {
        corners: vec![
            [u - 30.0, v - 12.0],
            [u + 30.0, v - 12.0],
            [u + 30.0, v + 12.0],
            [u - 30.0, v + 12.0],
        ],
        colour: scene.paint.background,
    };
    scene.occluders = cards.iter().map(card).collect();
    scene.photograph(&file.robot, &solution, &camera()).unwrap()
}

fn write(scratch: &Scratch, name: &str, bytes: &[u8]) -> String {
    std::fs::write(scratch.path().join(name), bytes).unwrap();
    scratch.file(name)
}

#[test]
fn disks_are_written_as_a_table_a_picture_and_json() {
    let scratch = Scratch::new();
    let rendered = photograph();
    let photo = write(&scratch, "photo.png", &rendered.photo.to_png().unwrap());
    let side = scratch.write("side.yml", &camera_text(&camera(), CameraFormat::Yaml));
    let (csv, picture) = (scratch.file("disks.csv"), scratch.file("seen.png"));
    let text = succeed(&[
        "measure",
        &photo,
        "--robot",
        ROBOT,
        "--camera",
        &side,
        "--step",
        "1",
        "-o",
        &csv,
        "--annotated",
        &picture,
    ]);
    assert!(text.contains("10 disks in 450×460 pixels, from base to tip"), "{text}");
    assert!(text.contains(&format!("measured: {csv}")), "{text}");

    let table = std::fs::read_to_string(&csv).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("step,disk,camera,u,v,confidence"));
    let mut squares = 0.0;
    for (i, (line, truth)) in lines.by_ref().zip(&rendered.disks).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells[..3], ["1", (i + 1).to_string().as_str(), "side"]);
        let number = |k: usize| cells[k].parse::<f64>().unwrap();
        squares += (number(3) - truth[0]).powi(2) + (number(4) - truth[1]).powi(2);
        assert!((0.3..=1.0).contains(&number(5)), "{line}");
    }
    assert!((squares / 10.0).sqrt() < 0.3, "{squares}");
    assert_eq!((table.lines().count(), lines.next()), (11, None));

    // What the camera sees of the base is not contradicted.
    let mirrored =
        fail(1, &["measure", &photo, "--robot", ROBOT, "--camera", &side, "--base", "top"]);
    assert!(mirrored.contains("the order is mirrored: by --base"), "{mirrored}");

    // What was written is what a robot file takes.
    let case = root().join(ROBOT).canonicalize().unwrap();
    let measured = format!(
        "extends = '{}'\n[measured]\ndisks = \"disks.csv\"\n[[measured.cameras]]\nname = \"side\"\nfile = \"side.yml\"\n",
        case.display()
    );
    let file = load(scratch.write("measured.toml", &measured)).unwrap();
    let observations = file.measured.unwrap().observations;
    assert_eq!(observations.len(), 10);
    for (observation, truth) in observations.iter().zip(&rendered.disks) {
        match observation.seen {
            Seen::Pixel { camera: 0, pixel } => assert!((pixel[0] - truth[0]).abs() < 0.5),
            seen => panic!("{seen:?}"),
        }
    }

    let drawn = Photo::decode(&std::fs::read(&picture).unwrap()).unwrap();
    assert_eq!((drawn.width(), drawn.height()), (450, 460));
    assert!(drawn != rendered.photo);

    let json = succeed(&["measure", &photo, "--count", "10", "--base", "bottom", "--json"]);
    let object: Value = serde_json::from_str(&json).unwrap();
    let marks = object["marks"].as_array().unwrap();
    assert_eq!((object["kind"].as_str(), marks.len()), (Some("disks"), 10));
    for (mark, truth) in marks.iter().zip(&rendered.disks) {
        let off = mark["u"].as_f64().unwrap() - truth[0];
        assert!(off.abs() < 0.5, "{mark}");
    }
    assert!(object["camera"].is_null() && object["step"].is_null());
}

/// What fails says why, by its exit status too, and writes nothing.
#[test]
fn what_cannot_be_measured_is_refused() {
    let scratch = Scratch::new();
    let rendered = photograph();
    let bytes = rendered.photo.to_png().unwrap();
    let photo = write(&scratch, "photo.png", &bytes);
    let (csv, picture) = (scratch.file("disks.csv"), scratch.file("seen.png"));
    let refuse = |status: i32, more: &[&str], words: &[&str]| {
        let mut args = vec!["measure"];
        args.extend(more);
        args.extend(["-o", &csv, "--annotated", &picture]);
        let message = fail(status, &args);
        for word in words {
            assert!(message.contains(word), "{word}: {message}");
        }
        for file in [&csv, &picture] {
            assert!(!Path::new(file).exists(), "{message}");
        }
    };
    refuse(2, &["nowhere.png"], &["nowhere.png", "there is no such file"]);
    refuse(2, &["examples"], &["examples", "it is a folder"]);
    refuse(2, &[ROBOT], &["neither PNG nor JPEG"]);
    refuse(2, &[&write(&scratch, "empty.png", &[])], &["the file is empty"]);
    let half = write(&scratch, "half.png", &bytes[..bytes.len() / 2]);
    refuse(2, &[&half], &["half.png: the picture is broken"]);
    refuse(2, &[&photo, "--colour", "reddish"], &["write a colour as \"#d02020\""]);
    refuse(2, &[&photo, "--base", "north"], &["give left, right, top, bottom"]);

    let wall = Photo::uniform(450, 460, [0.5; 3]).to_png().unwrap();
    let wall = write(&scratch, "wall.png", &wall);
    refuse(1, &[&wall, "--count", "10"], &["nothing stands out", "help: "]);
    // In a count that is wrong, with where all were found.
    let last = format!("({:.0}, {:.0})", rendered.disks[9][0], rendered.disks[9][1]);
    let count = |n: &'static str| ["--base", "bottom", "--count", n];
    let with = |more: [&'static str; 4]| {
        let mut args = vec![photo.as_str()];
        args.extend(more);
        args
    };
    refuse(1, &with(count("9")), &["10 were found where there must be 9", &last, "--mask"]);
    refuse(1, &with(count("11")), &["10 were found where there must be 11", &last]);
    refuse(1, &[&photo, "--count", "10"], &["which end is the base", "--base left"]);
    refuse(1, &[&photo, "--count", "10", "--kind", "dots"], &["no vivid colour stands out"]);
    // A camera and a mask of another size, and a photograph that would be written over.
    let side = camera_text(&camera(), CameraFormat::Yaml).replace("450", "640");
    let side = scratch.write("side.yml", &side);
    refuse(2, &[&photo, "--camera", &side], &["of pictures of 640×460 pixels", "450×460"]);
    let small = write(&scratch, "small.png", &Photo::uniform(9, 9, [1.0; 3]).to_png().unwrap());
    refuse(2, &[&photo, "--mask", &small], &["the mask has 9×9 pixels"]);
    let message = fail(2, &["measure", &photo, "--annotated", &photo]);
    assert!(message.contains("is read: write to another file"), "{message}");
    assert_eq!(std::fs::read(&photo).unwrap(), bytes);
}

/// A robot whose disks stand closer towards the tip says from which end it was counted.
#[test]
fn a_mirrored_order_is_refused() {
    let scratch = Scratch::new();
    let robot = std::fs::read_to_string(root().join("examples/table1/prototype.toml")).unwrap();
    let places = ["0", "32", "60", "84", "106", "126", "142", "156", "168", "180"];
    let places = places.map(|place| format!("\"{place} mm\"")).join(", ");
    let robot = robot.replace("count = 10  ", &format!("positions = [{places}] "));
    let robot = scratch.write("uneven.toml", &robot);
    let rendered = photograph_of(Path::new(&robot), &[]);
    let photo = write(&scratch, "photo.png", &rendered.photo.to_png().unwrap());
    let measure = ["measure", &photo, "--robot", &robot];
    let message = fail(1, &[&measure[..], &["--base", "top"]].concat());
    assert!(message.contains("the order is mirrored"), "{message}");
    // The distances alone tell the base as well.
    for base in [&["--base", "bottom"][..], &[]] {
        let text = succeed(&[&measure[..], base, &["--json"]].concat());
        let object: Value = serde_json::from_str(&text).unwrap();
        let first = &object["marks"][0];
        assert!((first["v"].as_f64().unwrap() - rendered.disks[0][1]).abs() < 0.5, "{first}");
    }
}

/// Disks behind cards: refused, until it is said which they are.
#[test]
fn hidden_disks_are_left_out_when_they_are_named() {
    let scratch = Scratch::new();
    let truth = photograph().disks;
    let rendered = photograph_of(&root().join(ROBOT), &[truth[0], truth[4]]);
    let photo = write(&scratch, "photo.png", &rendered.photo.to_png().unwrap());
    let measure = ["measure", &photo, "--robot", ROBOT, "--base", "bottom"];
    let message = fail(1, &measure);
    assert!(message.contains("8 were found where there must be 10"), "{message}");
    assert!(message.contains("--hidden"), "{message}");
    let message = fail(2, &[&measure[..], &["--hidden", "1,11"]].concat());
    assert!(message.contains("--hidden 11: there are disks 1 to 10"), "{message}");
    let message = fail(2, &["measure", &photo, "--base", "bottom", "--hidden", "1"]);
    assert!(message.contains("needs --robot or --count"), "{message}");

    let text = succeed(&[&measure[..], &["--hidden", "1,5", "--json"]].concat());
    let object: Value = serde_json::from_str(&text).unwrap();
    let marks = object["marks"].as_array().unwrap();
    let numbers: Vec<u64> = marks.iter().map(|mark| mark["disk"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [2, 3, 4, 6, 7, 8, 9, 10]);
    for (mark, number) in marks.iter().zip(numbers) {
        let [u, v] = truth[number as usize - 1];
        let off = (mark["u"].as_f64().unwrap() - u).hypot(mark["v"].as_f64().unwrap() - v);
        assert!(off < 0.5, "{mark}");
    }
}
