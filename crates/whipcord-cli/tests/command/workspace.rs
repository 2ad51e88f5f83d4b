//! `whipcord workspace`.

use serde_json::Value;

use crate::support::{Scratch, fail, settings, succeed};

const THREE: &str = "examples/three-cable-segment.toml";
const LIMIT: &str = "limits.tension=[\"0 N\", \"3 N\"]";

#[test]
fn the_folder_has_tables_and_pictures() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let args = [
        "workspace",
        THREE,
        "--set",
        LIMIT,
        "--voxel",
        "12 mm",
        "--map",
        "stiffness",
        "--out",
        &out,
    ];
    settings(Some(scratch.path())).bind(|| {
        insta::assert_snapshot!("workspace", succeed(&args));
    });
    let read = |name: &str| std::fs::read_to_string(scratch.path().join("out").join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("workspace.json")).unwrap();
    assert_eq!(json["dimension"], 2);
    assert_eq!(json["complete"], true);
    let voxels = read("voxels.csv");
    assert_eq!(voxels.lines().count() as u64, json["voxels"].as_u64().unwrap() + 1);
    assert!(voxels.lines().next().unwrap().ends_with("a.tension [N],b.tension [N],c.tension [N]"));
    let boundary = read("boundary.csv");
    assert_eq!(boundary.lines().count() as u64, json["boundary_points"].as_u64().unwrap() + 1);
    assert!(boundary.contains("greatest tension of cable a"), "{boundary}");
    for name in ["workspace.png", "sections.png", "workspace.svg", "sections.svg"] {
        assert!(scratch.path().join("out").join(name).exists(), "{name}");
    }
    let bytes = |name: &str| std::fs::read(scratch.path().join("out").join(name)).unwrap();
    assert!(bytes("workspace.glb").starts_with(b"glTF"));
    let parquet = bytes("voxels.parquet");
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
}

#[test]
fn what_cannot_be_surveyed_is_refused() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let tiny = ["workspace", THREE, "--voxel", "1 um", "--out", &out];
    assert!(fail(2, &tiny).contains("a thousandth of the length"));
    let geometric = [
        "workspace",
        THREE,
        "--model",
        "constant-curvature",
        "--voxel",
        "30 mm",
        "--map",
        "stiffness",
        "--out",
        &out,
    ];
    assert!(fail(2, &geometric).contains("does not know the stiffness"));
    let contradictory =
        ["workspace", THREE, "--set", "limits.tension=[\"3 N\", \"1 N\"]", "--out", &out];
    fail(2, &contradictory);
    assert!(!scratch.path().join("out").exists());
}

#[test]
fn sections_go_through_the_point_that_is_asked_for() {
    let scratch = Scratch::new();
    let rectangles = |section: &[&str]| {
        let out = scratch.file("out");
        let mut args = vec!["workspace", THREE, "--set", LIMIT, "--voxel", "12 mm", "--out", &out];
        args.extend(section);
        succeed(&args);
        std::fs::read_to_string(scratch.path().join("out/sections.svg")).unwrap()
    };
    let middle = rectangles(&[]);
    assert!(middle.contains("sections through the middle"));
    let low = rectangles(&["--section", "0, 0, 90 mm"]);
    assert!(low.contains("sections through (0.0, 0.0, 90.0) mm"));
    // The tips are higher than 90 mm: seen from above there are none, and the other two sections stay.
    let [low, middle] = [low, middle].map(|text| text.matches("<rect").count());
    assert!(10 < low && low < middle, "{low} {middle}");
    let out = scratch.file("out");
    let far = ["workspace", THREE, "--voxel", "12 mm", "--section", "2, 2, 2", "--out", &out];
    assert!(fail(2, &far).contains("no plane through this point meets the tips, which have x "));
}
