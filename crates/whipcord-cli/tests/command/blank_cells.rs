//! Every cell without a number has a reason below its table, once.

use std::fs;
use std::path::Path;

use crate::support::{Scratch, robot, succeed};

/// What `compare` prints of a robot with this measurement, and its report.
fn compared(scratch: &Scratch, lines: &str, table: &str, models: &[&str]) -> (String, String) {
    scratch.write("seen.csv", table);
    let text = format!("tension = \"400 gf\"\n[measured]\ndisks = \"seen.csv\"\n{lines}");
    let file = scratch.write("robot.toml", &robot(&text));
    let out = scratch.file("report");
    let mut args = vec!["compare", &file, "--out", &out];
    args.extend(models.iter().flat_map(|model| ["--model", model]));
    let text = succeed(&args);
    (text, fs::read_to_string(Path::new(&out).join("report.html")).unwrap())
}

#[test]
fn a_reason_that_models_share_is_given_once() {
    let scratch = Scratch::new();
    let models = ["cosserat", "cosserat-disks", "four-bar"];
    let marker = "disk,x,y,z\n10,0,0.01,0.17\n";
    let (text, report) = compared(&scratch, "registration = \"rigid\"\n", marker, &models);
    let first = text.split("Accuracy and time").next().unwrap();
    assert_eq!(first.matches("cannot be moved").count(), 1, "{first}");
    let who = "cosserat; cosserat-disks; four-bar (Cosserat's shortening): no distance to the measurement: the measurement cannot be moved: a rigid registration needs 2 points";
    assert!(first.contains(&format!("Test robot, {who}")), "{first}");
    let who = who.replace('\'', "&#39;");
    assert!(report.contains(&who) || report.contains(&who.replace("&#39;", "'")), "{report}");
}

/// A marker on the axis at the arc length of a disk is on that disk.
#[test]
fn a_marker_at_the_arc_length_of_the_tip_is_at_the_tip() {
    let scratch = Scratch::new();
    for place in ["0.18", "0.18000000001"] {
        let marker = format!("arc_length,x,y,z\n{place},0,0.01,0.17\n");
        let (text, report) = compared(&scratch, "", &marker, &["cosserat"]);
        assert!(!text.contains("was not measured"), "{text}");
        assert!(report.contains("was not measured"), "the other disks were not");
    }
    let elsewhere = "arc_length,x,y,z\n0.17,0,0.01,0.16\n";
    let (text, _) = compared(&scratch, "", elsewhere, &["cosserat"]);
    assert!(text.contains("no distance of the tip"), "{text}");
}

#[test]
fn the_first_model_has_no_distance_to_itself() {
    let scratch = Scratch::new();
    let marker = "disk,x,y,z\n10,0,0.01,0.17\n";
    let (text, report) = compared(&scratch, "", marker, &["cosserat", "cosserat-disks"]);
    let note = "to the first model of the case that has an answer; \"–\" in its own row";
    assert!(text.contains(note), "{text}");
    assert!(report.contains("to the first model of the case that has an answer"));
}

#[test]
fn geometric_models_compute_no_tensions() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("shortening = \"3 %\""));
    let text = succeed(&["solve", &file, "--model", "four-bar"]);
    assert!(text.contains("\n–: four-bar computes no tensions\n"), "{text}");
    let text = succeed(&["solve", &file, "--model", "cosserat"]);
    assert!(!text.contains("computes no tensions"), "{text}");
    let out = scratch.file("report");
    succeed(&["compare", &file, "--out", &out]);
    let report = fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(
        report.contains("–: four-bar; constant-curvature computes no tensions")
            || report.contains("computes no tensions."),
        "{report}"
    );
}
