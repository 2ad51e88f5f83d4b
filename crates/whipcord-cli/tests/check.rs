//! `whipcord check`, `whipcord schema`, and what all verbs share.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod support;

use support::{Scratch, fail, pushed_rod, robot, run, succeed};

#[test]
fn a_robot_is_put_in_words() {
    for name in [
        "table1/case-3",
        "table1/prototype",
        "three-cable-segment",
        "two-segment-arm",
        "helical-finger",
        "precurved-catheter",
        "tapered-arm",
        "composite-finger",
        "rubbing-finger",
    ] {
        let text = succeed(&["check", &format!("examples/{name}.toml")]);
        insta::assert_snapshot!(name.replace('/', "_"), text);
    }
}

#[test]
fn every_file_is_reported() {
    let scratch = Scratch::new();
    let good = scratch.write("good.toml", &robot("tension = \"1 N\""));
    let bad = scratch.write("bad.toml", &robot("tension = \"1 mm\""));
    let run = run(&["check", &bad, &good, "missing.toml"]);
    assert_eq!(run.status, 2);
    assert!(run.stdout.contains("good.toml: valid") && !run.stdout.contains("bad.toml"));
    assert!(run.stderr.contains("bad.toml:15:11") && run.stderr.contains("missing.toml"));
    assert!(!run.stderr.contains("good.toml"));
}

#[test]
fn folders_are_checked_file_by_file() {
    let text = succeed(&["check", "examples/table1"]);
    assert_eq!(text.matches(": valid").count(), 5);
    let scratch = Scratch::new();
    let message = fail(2, &["check", &scratch.file("")]);
    assert!(message.contains("there is no robot file in"), "{message}");
}

#[test]
fn what_a_robot_leaves_is_said_to_be_unstable() {
    let scratch = Scratch::new();
    let file = scratch.write("rod.toml", &pushed_rod(""));
    let text = succeed(&["check", &file]);
    assert!(text.contains("loads alone; unstable: the robot leaves this shape"), "{text}");
}

#[test]
fn the_schema_is_json_and_can_be_written() {
    let text = succeed(&["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(schema["properties"]["backbone"].is_object());
    let scratch = Scratch::new();
    let path = scratch.file("robot.schema.json");
    assert_eq!(succeed(&["schema", "--out", &path]), format!("{path}\n"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    fail(2, &["schema", "--out", &scratch.file("no/folder/schema.json")]);
}

#[test]
fn there_is_no_colour_in_a_pipe() {
    for args in [["check", "examples/table1/case-3.toml"], ["solve", "examples/table1/case-3.toml"]]
    {
        assert!(!succeed(&args).contains('\x1b'));
    }
    assert!(!fail(2, &["check", "missing.toml"]).contains('\x1b'));
}

#[test]
fn nothing_is_viewed_of_a_file_that_cannot_be_used() {
    let error = fail(2, &["view", "missing.toml", "--no-open"]);
    assert!(error.contains("missing.toml") && error.contains("cannot read"), "{error}");
}

#[test]
fn help_and_version_are_no_failures() {
    assert!(succeed(&["--help"]).contains("Usage: whipcord"));
    assert_eq!(succeed(&["--version"]), format!("whipcord {}\n", env!("CARGO_PKG_VERSION")));
    for verb in ["solve", "compare", "bench", "view", "check", "schema"] {
        assert!(succeed(&[verb, "--help"]).contains("Usage: whipcord"));
    }
}
