//! `whipcord solve`.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod support;

use std::io::Read;
use std::process::Stdio;

use serde_json::Value;
use support::{Scratch, command, fail, pushed_rod, robot, settings, succeed};

const CASE_3: &str = "examples/table1/case-3.toml";

#[test]
fn the_summary_is_for_people() {
    settings(None).bind(|| {
        insta::assert_snapshot!("cosserat", succeed(&["solve", CASE_3]));
        insta::assert_snapshot!("four_bar", succeed(&["solve", CASE_3, "--model", "four-bar"]));
        let lengths = ["solve", CASE_3, "--actuation", "shortening"];
        insta::assert_snapshot!("cosserat_by_shortening", succeed(&lengths));
        insta::assert_snapshot!(
            "three_cables",
            succeed(&["solve", "examples/three-cable-segment.toml"])
        );
    });
}

/// Numbers to six digits, which rounding does not reach, and no times.
fn rounded(value: &Value) -> Value {
    match value {
        Value::Number(n) if n.is_f64() => {
            let x = n.as_f64().unwrap();
            assert!(x.is_finite());
            let rounded = (x * 1e6).round() / 1e6;
            Value::from(if rounded == 0.0 { 0.0 } else { rounded })
        }
        Value::Array(list) => list.iter().map(rounded).collect(),
        Value::Object(map) => map
            .iter()
            .map(|(key, value)| match key.as_str() {
                "solve_time" | "residual" | "discretization_error" | "steps" | "iterations" => {
                    (key.clone(), Value::from("[number]"))
                }
                _ => (key.clone(), rounded(value)),
            })
            .collect(),
        other => other.clone(),
    }
}

#[test]
fn json_is_one_object() {
    let text = succeed(&["solve", CASE_3, "--stations", "3", "--json"]);
    let object: Value = serde_json::from_str(&text).unwrap();
    let time = object["diagnostics"]["solve_time"].as_f64().unwrap();
    assert!(time > 0.0 && time < 10.0);
    insta::assert_snapshot!("json", format!("{:#}", rounded(&object)));
}

#[test]
fn stations_are_equally_spaced_and_end_at_the_tip() {
    let text = succeed(&["solve", CASE_3, "--model", "cosserat", "--stations", "11", "--json"]);
    let object: Value = serde_json::from_str(&text).unwrap();
    let shape = &object["shape"];
    let arc_lengths: Vec<f64> = serde_json::from_value(shape["arc_length"].clone()).unwrap();
    assert_eq!(arc_lengths.len(), 11);
    assert_eq!((arc_lengths[0], arc_lengths[10]), (0.0, 0.18));
    assert!((arc_lengths[3] - 0.054).abs() < 1e-15);
    assert_eq!(shape["position"].as_array().unwrap().len(), 11);
    assert_eq!(shape["position"][10], object["disks"][9]["position"]);
    assert_eq!(shape["orientation"][0], serde_json::json!([1.0, 0.0, 0.0, 0.0]));
}

#[test]
fn csv_has_a_line_for_each_station() {
    let text = succeed(&["solve", CASE_3, "--csv", "--stations", "5"]);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("arc_length,x,y,z,qw,qx,qy,qz"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|row| row.len() == 8));
    // One tip, however it is asked for.
    let json: Value = serde_json::from_str(&succeed(&["solve", CASE_3, "--json"])).unwrap();
    let tip: Vec<f64> = serde_json::from_value(json["disks"][9]["position"].clone()).unwrap();
    for (a, b) in rows[4][1..4].iter().zip(tip) {
        assert!((a - b).abs() < 1e-9);
    }
}

#[test]
fn pictures_are_drawn_before_and_after() {
    let scratch = Scratch::new();
    let (svg, png) = (scratch.file("robot.svg"), scratch.file("robot.png"));
    let text = succeed(&["solve", CASE_3, "--plot", &svg]);
    assert!(text.ends_with(&format!("picture: {svg}\n")));
    let json = succeed(&["solve", CASE_3, "--plot", &png, "--json"]);
    assert!(serde_json::from_str::<Value>(&json).is_ok());
    let svg = std::fs::read_to_string(svg).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("before actuation"));
    assert!(std::fs::read(png).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn what_the_robot_leaves_is_said_to_be_unstable() {
    let scratch = Scratch::new();
    let file = scratch.write("rod.toml", &pushed_rod(""));
    settings(None).bind(|| insta::assert_snapshot!("unstable", succeed(&["solve", &file])));
    let json: Value = serde_json::from_str(&succeed(&["solve", &file, "--json"])).unwrap();
    assert_eq!(json["status"], "converged");
    assert!(json["diagnostics"]["stability"].as_f64().unwrap() < 0.0);

    let follower = scratch.write("follower.toml", &pushed_rod("follower = true"));
    let text = succeed(&["solve", &follower]);
    assert!(text.contains("stability not defined under loads that follow"), "{text}");
    assert!(!text.contains("unstable"), "{text}");
}

#[test]
fn a_picture_changes_no_numbers() {
    let scratch = Scratch::new();
    let svg = scratch.file("robot.svg");
    let points = |args: &[&str]| -> Vec<Vec<f64>> {
        let text = succeed(args);
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
        text.lines().skip(1).map(row).collect()
    };
    for stations in [None, Some("--stations=2"), Some("--stations=8"), Some("--stations=250")] {
        let mut args = vec!["solve", CASE_3, "--csv"];
        args.extend(stations);
        let without = points(&args);
        args.extend(["--plot", &svg]);
        let with = points(&args);
        assert_eq!(with.len(), without.len());
        for (a, b) in with.iter().zip(&without) {
            assert_eq!(a[0], b[0]);
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?} {b:?}");
        }
    }
}

#[test]
fn bad_usage_has_status_2() {
    let unknown = fail(2, &["solve", CASE_3, "--model", "coserat"]);
    assert!(unknown.contains("cosserat, four-bar"), "{unknown}");
    fail(2, &["solve", CASE_3, "--stations", "1"]);
    fail(2, &["solve", CASE_3, "--stations", "-3"]);
    let many = fail(2, &["solve", CASE_3, "--stations", "100001"]);
    assert!(many.contains("100001 is not in 2..=100000"), "{many}");
    fail(2, &["solve", CASE_3, "--actuation", "pressure"]);
    fail(2, &["solve", CASE_3, "--json", "--csv"]);
    let picture = fail(2, &["solve", CASE_3, "--plot", "robot.bmp"]);
    assert!(picture.contains(".svg or .png"), "{picture}");
    fail(2, &["solve"]);
    fail(2, &["unknown-verb"]);
}

#[test]
fn bad_input_has_status_2() {
    let scratch = Scratch::new();
    let missing = fail(2, &["solve", "no-such-file.toml"]);
    assert!(missing.contains("no-such-file.toml") && missing.contains("there is no such file"));
    let unknown_key = scratch.write("key.toml", &robot("tensoin = \"1 N\""));
    let message = fail(2, &["solve", &unknown_key]);
    assert!(message.contains("key.toml:15:1") && message.contains("tension"), "{message}");
    let nothing = scratch.write("nothing.toml", &robot(""));
    let message = fail(2, &["solve", &nothing]);
    assert!(message.contains("nothing.toml:12:1: error: the cosserat model needs"), "{message}");
    assert!(message.contains("`tension` of cable 1"), "{message}");
    assert!(message.contains("help: give this cable a tension, or a shortening"), "{message}");
    let unwritable = fail(2, &["solve", CASE_3, "--plot", &scratch.file("no/such/folder/a.svg")]);
    assert!(unwritable.contains("cannot write"), "{unwritable}");
}

#[test]
fn a_model_refuses_by_name_what_it_cannot_take() {
    let scratch = Scratch::new();
    let text = robot("tension = \"1 N\"\nshortening = \"2 %\"\n[loads]\ntip_force = [0.1, 0, 0]");
    let file = scratch.write("loaded.toml", &text);
    let message = fail(2, &["solve", &file, "--model", "four-bar", "--json"]);
    assert!(message.contains("four-bar") && message.contains("loads.tip_force"), "{message}");
}

#[test]
fn no_answer_has_status_1_and_a_reason() {
    let scratch = Scratch::new();
    let file = scratch.write("far.toml", &robot("tension = \"1000 kN\""));
    for format in ["--json", "--csv", "--stations=5"] {
        let message = fail(1, &["solve", &file, format]);
        assert!(message.contains("`pull`"), "{message}");
        assert!(message.contains("the last load that converged is 0."), "{message}");
    }
}

#[test]
fn a_reader_that_stops_early_is_no_failure() {
    let mut child = command(&["solve", CASE_3, "--json", "--stations", "20000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut start = [0; 10];
    let mut stdout = child.stdout.take().unwrap();
    stdout.read_exact(&mut start).unwrap();
    drop(stdout);
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert!(output.status.success());
}
