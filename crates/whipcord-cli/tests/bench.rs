//! `whipcord bench`.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

mod support;

use std::path::Path;

use support::{Scratch, fail, robot, succeed};

#[test]
fn cost_and_accuracy_are_measured_tabled_and_drawn() {
    let scratch = Scratch::new();
    let out = scratch.file("bench");
    let text = succeed(&["bench", "--out", &out]);
    for words in
        ["cosserat", "four-bar", "sections", "320", "for each section", "III general", "R²"]
    {
        assert!(text.contains(words), "{words} is missing from\n{text}");
    }
    let read = |name: &str| std::fs::read_to_string(Path::new(&out).join(name)).unwrap();
    // Two models, four routings, six sizes.
    assert_eq!(read("cost.csv").lines().count(), 1 + 2 * 4 * 6);
    assert_eq!(read("lines.csv").lines().count(), 1 + 2 * (4 + 1));
    assert_eq!(read("accuracy.csv").lines().count(), 1 + 4 * 4);
    for name in ["time", "time-logarithmic", "accuracy"] {
        assert!(read(&format!("{name}.svg")).starts_with("<svg"));
        assert!(Path::new(&out).join(format!("{name}.png")).exists());
    }
}

#[test]
fn files_may_be_given() {
    let scratch = Scratch::new();
    let out = scratch.file("bench");
    // No shortening: the four-bar model has nothing to do.
    let file = scratch.write("robot.toml", &robot("tension = \"1 N\""));
    let text = succeed(&["bench", &file, "--out", &out]);
    assert!(text.contains("Test robot: the four-bar model"), "{text}");
    fail(2, &["bench", "missing.toml", "--out", &out]);
    let nothing = scratch.write("nothing.toml", &robot(""));
    fail(1, &["bench", &nothing, "--out", &out]);
}
