//! `whipcord overlay`.

use std::fs;

use crate::support::{Scratch, fail, robot, run, succeed};
use serde_json::Value;
use whipcord::ModelKind;

/// Pixels to the metre, and where the world's origin is seen.
const SCALE: f64 = 2000.0;
const CENTRE: [f64; 2] = [320.0, 440.0];

/// A view along +x: y of the world to the left, z up.
const SIDE: &str = "%YAML:1.0\n---\nprojection: orthographic\npixels_per_metre: 2000.\nprincipal_point: [ 320., 440. ]\nimage_width: 640\nimage_height: 480\nrvec: [ 1.2091995761561452, -1.2091995761561452, 1.2091995761561452 ]\ntvec: [ 0., 0., 1. ]\n";

fn photograph(scratch: &Scratch) -> String {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"480\"><rect width=\"640\" height=\"480\" fill=\"#b0b8c0\"/></svg>";
    let path = scratch.file("photo.png");
    fs::write(&path, whipcord_plot::png(svg, 1.0).unwrap()).unwrap();
    path
}

/// Where the model has its disks, as (y, z).
fn disks(file: &str, model: &str) -> Vec<[f64; 2]> {
    let text = succeed(&["solve", file, "--model", model, "--json"]);
    let object: Value = serde_json::from_str(&text).unwrap();
    let disks = object["disks"].as_array().unwrap().iter();
    disks.map(|disk| [1, 2].map(|axis| disk["position"][axis].as_f64().unwrap())).collect()
}

/// A robot whose disks were found `off` pixels from where the Cosserat model has them.
fn found(scratch: &Scratch, off: [f64; 2]) -> (String, String) {
    let cable = "tension = \"2 N\"\nshortening = \"4 %\"\n";
    let bare = scratch.write("bare.toml", &robot(cable));
    let mut seen = String::from("disk,u,v\n");
    for (i, [y, z]) in disks(&bare, "cosserat").iter().enumerate() {
        let [u, v] = [CENTRE[0] - SCALE * y + off[0], CENTRE[1] - SCALE * z + off[1]];
        seen += &format!("{},{u},{v}\n", i + 1);
    }
    scratch.write("seen.csv", &seen);
    scratch.write("side.yml", SIDE);
    let measured = "[measured]\ndisks = \"seen.csv\"\n[[measured.cameras]]\nname = \"side\"\nfile = \"side.yml\"\n";
    (photograph(scratch), scratch.write("robot.toml", &(robot(cable) + measured)))
}

/// The lines of a CSV file as cells.
fn cells(text: &str) -> Vec<Vec<String>> {
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn distances_are_those_that_were_put_in() {
    let scratch = Scratch::new();
    let (photo, file) = found(&scratch, [3.0, -4.0]);
    let out = scratch.file("out");
    let text = succeed(&["overlay", &photo, &file, "--out", &out]);
    // 5 px at 2 px/mm.
    let rms = text.lines().find(|line| line.trim_start().starts_with("RMS")).unwrap();
    assert!(
        rms.split_whitespace().collect::<Vec<_>>().starts_with(&["RMS", "5.0", "2.50", "1.39"]),
        "{rms}"
    );
    let csv = fs::read_to_string(format!("{out}/photo-distances.csv")).unwrap();
    let rows = cells(&csv);
    let column = |name: &str| rows[0].iter().position(|cell| cell == name).unwrap();
    let models: Vec<&str> = rows[1..].iter().map(|row| row[0].as_str()).collect();
    assert_eq!(models.len(), 10 * ModelKind::ALL.len());
    assert_eq!((models[0], models[10], models[20]), ("cosserat", "cosserat-disks", "four-bar"));
    let disks = disks(&file, "four-bar");
    for (i, row) in rows[1..].iter().enumerate() {
        let number = |name: &str| row[column(name)].parse::<f64>().unwrap();
        let (pixels, distance) = (number("distance_in_image"), number("distance"));
        // Seen along a line, a pixel is half a millimetre everywhere.
        assert!((pixels - SCALE * distance).abs() < 1e-6, "{row:?}");
        if i < 10 {
            assert!((pixels - 5.0).abs() < 1e-4, "{row:?}");
        }
        if models[i] == "four-bar" {
            let [y, z] = disks[i - 20];
            assert!((number("u") - CENTRE[0] + SCALE * y).abs() < 1e-4, "{row:?}");
            assert!((number("v") - CENTRE[1] + SCALE * z).abs() < 1e-4, "{row:?}");
        }
    }
    for name in
        ["photo-overlay.svg", "photo-overlay.png", "photo-distances.svg", "photo-distances.png"]
    {
        assert!(fs::metadata(format!("{out}/{name}")).unwrap().len() > 1000, "{name}");
    }
}

#[test]
fn a_photograph_without_measurements_shows_the_models() {
    let scratch = Scratch::new();
    let (photo, _) = found(&scratch, [0.0; 2]);
    let out = scratch.file("out");
    let (file, camera) = (scratch.file("bare.toml"), scratch.file("side.yml"));
    let text = succeed(&[
        "overlay", &photo, &file, "--camera", &camera, "--model", "four-bar", "--out", &out,
    ]);
    assert!(text.contains("nothing to measure the models by"), "{text}");
    let svg = fs::read_to_string(format!("{out}/photo-overlay.svg")).unwrap();
    assert!(svg.contains("four-bar") && !svg.contains("cosserat"));
    assert!(!fs::exists(format!("{out}/photo-distances.csv")).unwrap());
}

#[test]
fn what_cannot_be_is_refused_and_nothing_written() {
    let scratch = Scratch::new();
    let (photo, file) = found(&scratch, [0.0; 2]);
    let out = scratch.file("out");
    let refused = |photo: &str, file: &str, more: &[&str]| {
        fail(2, &[&["overlay", photo, file, "--out", &out], more].concat())
    };
    let text = scratch.write("text.png", "not a picture");
    let bytes = fs::read(&photo).unwrap();
    let broken = scratch.file("broken.png");
    fs::write(&broken, &bytes[..bytes.len() / 2]).unwrap();
    let small = scratch.write("small.yml", &SIDE.replace("640", "320"));
    let away = scratch.write("away.yml", &SIDE.replace("[ 320., 440. ]", "[ 9320., 440. ]"));
    let bare = scratch.file("bare.toml");
    let told = [
        refused("none.png", &file, &[]),
        refused(&text, &file, &[]),
        refused(&broken, &file, &[]),
        refused(&photo, &bare, &[]),
        refused(&photo, &file, &["--camera", "front"]),
        refused(&photo, &file, &["--camera", &small]),
        refused(&photo, &file, &["--camera", &away]),
        refused(&photo, &file, &["--step", "2"]),
    ];
    let told = told.join("\n").replace(&format!("{}/", scratch.path().display()), "");
    insta::assert_snapshot!(told);
    let unsolved = scratch.write("heavy.toml", &robot("tension = \"4000 N\"\n"));
    let camera = scratch.file("side.yml");
    let failed = run(&["overlay", &photo, &unsolved, "--camera", &camera, "--out", &out]);
    assert_eq!((failed.status, failed.stdout.as_str()), (1, ""), "{}", failed.stderr);
    assert!(!fs::exists(&out).unwrap());
}

#[test]
fn markers_may_come_from_a_table_of_their_own() {
    let scratch = Scratch::new();
    let (photo, file) = found(&scratch, [3.0, -4.0]);
    let (camera, out) = (scratch.file("side.yml"), scratch.file("out"));
    let in_file = succeed(&["overlay", &photo, &file, "--out", &out]);
    let bare = scratch.file("bare.toml");
    // As `measure` writes it: with the camera's name and the step that was asked for there.
    let seen = fs::read_to_string(scratch.file("seen.csv")).unwrap();
    let mut lines = seen.lines();
    let mut named = format!("step,{},camera\n", lines.next().unwrap());
    named.extend(lines.map(|line| format!("3,{line},left\n")));
    let table = scratch.write("named.csv", &named);
    let args = ["overlay", &photo, &bare, "--camera", &camera, "--markers", &table, "--out", &out];
    assert_eq!(succeed(&args), in_file);

    let without = succeed(&["overlay", &photo, &bare, "--camera", &camera, "--out", &out]);
    assert!(without.contains("--markers"), "{without}");
    let positions = scratch.write("positions.csv", "disk,x,y,z\n2,0,0,0.02\n");
    let args =
        ["overlay", &photo, &bare, "--camera", &camera, "--markers", &positions, "--out", &out];
    let message = fail(2, &args);
    assert!(message.contains("columns `u` and `v`"), "{message}");
}

#[test]
fn an_opposite_order_is_spoken_of() {
    let scratch = Scratch::new();
    let (photo, file) = found(&scratch, [0.5, 0.5]);
    let out = scratch.file("out");
    let note = "the markers fit far better in opposite order";
    assert!(!succeed(&["overlay", &photo, &file, "--out", &out]).contains(note));
    let seen = cells(&fs::read_to_string(scratch.file("seen.csv")).unwrap());
    let mut turned = String::from("disk,u,v\n");
    for (own, other) in seen[1..].iter().zip(seen[1..].iter().rev()) {
        turned += &format!("{},{},{}\n", own[0], other[1], other[2]);
    }
    scratch.write("seen.csv", &turned);
    assert!(succeed(&["overlay", &photo, &file, "--out", &out]).contains(note));
    let fit = ["--parameter", "backbone.young_modulus"];
    assert!(succeed(&["fit", &file, fit[0], fit[1]]).contains(note));
}
