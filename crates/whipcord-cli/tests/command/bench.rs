//! `whipcord bench`.

use std::path::Path;

use crate::support::{Scratch, fail, robot, succeed, warned};

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
    // Three models, four routings, six sizes.
    assert_eq!(read("cost.csv").lines().count(), 1 + 3 * 4 * 6);
    assert_eq!(read("lines.csv").lines().count(), 1 + 3 * (4 + 1));
    assert_eq!(read("accuracy.csv").lines().count(), 1 + 4 * 4);
    for name in ["time", "time-logarithmic", "accuracy"] {
        assert!(read(&format!("{name}.svg")).starts_with("<svg"));
        assert!(Path::new(&out).join(format!("{name}.png")).exists());
    }
    for series in ["cosserat, I straight", "cosserat, IV general", "four-bar, II helical"] {
        assert!(read("time.svg").contains(series), "the picture does not show {series}");
    }
}

#[test]
fn what_is_not_timed_is_said_once_and_in_the_terms_of_the_file() {
    let scratch = Scratch::new();
    let out = scratch.file("bench");
    let text = succeed(&["bench", "examples/two-segment-arm.toml", "--out", &out]);
    let notes: Vec<&str> = text.lines().filter(|line| line.starts_with("note:")).collect();
    assert_eq!(notes.len(), 1, "{text}");
    assert!(notes[0].contains("four-bar model cannot take `loads.gravity`"), "{text}");

    let robot = robot("shortening = \"1 %\"").replace("count = 10", "count = 11");
    let short = robot.replace("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", "[4, 4, 4, 4, 4, 4]");
    let text = warned(&["bench", &scratch.write("short.toml", &short), "--out", &out]).0;
    let notes: Vec<&str> = text.lines().filter(|line| line.starts_with("note:")).collect();
    // With other numbers of sections it ends between two disks, which the models take.
    assert!(notes.is_empty(), "{text}");
}

#[test]
fn files_may_be_given() {
    let scratch = Scratch::new();
    let out = scratch.file("bench");
    // No shortening: the four-bar model has nothing to do.
    let file = scratch.write("robot.toml", &robot("tension = \"1 N\""));
    let text = succeed(&["bench", &file, "--out", &out]);
    assert_eq!(text.matches("Test robot: the four-bar model needs").count(), 1, "{text}");
    fail(2, &["bench", "missing.toml", "--out", &out]);
    let nothing = scratch.write("nothing.toml", &robot(""));
    fail(1, &["bench", &nothing, "--out", &out]);
}
