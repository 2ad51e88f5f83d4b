//! `whipcord design`.

use serde_json::Value;

use crate::support::{Scratch, fail, succeed, warned};

const THREE: &str = "examples/table1/case-3.toml";
const ARC: &str = "arc, angle = 60 deg, direction = 30 deg";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The robot file of a design gives the shape that the design says, and its folder has what is manufactured.
#[test]
fn holes_for_an_arc_are_proven_written_and_drawn() {
    let scratch = Scratch::new();
    let (new, folder) = (scratch.file("new.toml"), scratch.file("report"));
    let args = [
        "design",
        THREE,
        "--target",
        ARC,
        "--max-jump",
        "2",
        "-o",
        &new,
        "--report",
        &folder,
        "--set",
        "design.tolerances.samples=50",
        "--json",
    ];
    let design = json(&succeed(&args));
    assert_eq!(design["proven"], true);
    assert_eq!(design["findings"][0]["known"], "optimal_proven");
    let error = design["error"].as_f64().unwrap();
    assert!(error < design["before"]["error"].as_f64().unwrap() && error < 2e-3, "{error}");
    let checked = design["targets"][0]["check"]["error"].as_f64().unwrap();
    assert!((checked - error).abs() < 1e-6);
    let holes = design["cables"][0]["holes"].as_array().unwrap();
    let holes: Vec<i64> = holes.iter().map(|hole| hole.as_i64().unwrap()).collect();
    assert!(holes.windows(2).all(|pair| {
        let apart = (pair[0] - pair[1]).rem_euclid(12);
        apart.min(12 - apart) <= 2
    }));
    // The file gives that shape again.
    let solved = json(&succeed(&["solve", &new, "--model", "cosserat-disks", "--json"]));
    for point in design["targets"][0]["points"].as_array().unwrap() {
        let disk = point["disk"].as_u64().unwrap() as usize;
        for axis in 0..3 {
            let [said, again] = [&point["position"], &solved["disks"][disk - 1]["position"]]
                .map(|at| at[axis].as_f64().unwrap());
            assert!((said - again).abs() < 1e-6, "disk {disk}");
        }
    }
    succeed(&["check", &new]);
    let path = |name: &str| scratch.path().join("report").join(name);
    let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    assert_eq!(read("holes.csv").lines().count(), 11);
    assert_eq!(read("errors.csv").lines().count(), 10);
    assert_eq!(read("tolerances.csv").lines().count(), 51);
    assert!(read("disks.svg").contains("mm\" viewBox"));
    assert!(read("disk-10.dxf").ends_with("  0\r\nEOF\r\n"));
    assert_eq!(json(&read("design.json"))["tolerances"]["failed"], 0);
    for name in ["shape.png", "errors.png", "disks.dxf", "disk-01.svg"] {
        assert!(path(name).exists(), "{name}");
    }
}

#[test]
fn a_routing_is_in_closed_form_or_refused_with_the_tension_that_would_do() {
    let scratch = Scratch::new();
    let new = scratch.file("new.toml");
    let vary = ["--vary", "cables[0].routing"];
    let args = ["design", THREE, "--target", "arc, angle = 40 deg", vary[0], vary[1], "-o", &new];
    let text = succeed(&args);
    assert!(text.contains("closed form"), "{text}");
    // The holes of the disks are of no more use, as a warning says.
    let (solved, warnings) = warned(&["solve", &new, "--json"]);
    assert!(
        solved.contains("\"converged\"") && warnings.contains("`disks.holes` has no effect"),
        "{warnings}"
    );
    let refused = fail(1, &["design", THREE, "--target", "arc, angle = 300 deg", vary[0], vary[1]]);
    assert!(refused.contains("or more brings it in"), "{refused}");
}

#[test]
fn what_is_no_design_is_refused() {
    for (args, words) in [
        (&["--target", "spiral, radius = 1 m"][..], "is no curve"),
        (&[], "no target shape"),
        (&["--target", ARC, "--vary", "cables[7].holes"], "there is no cable `7`"),
        (&["--target", "arc, angle = 60 mm"], "`angle`"),
        (&["--target", "measured"], "no disks were measured"),
    ] {
        let all: Vec<&str> = ["design", THREE].into_iter().chain(args.iter().copied()).collect();
        let message = fail(2, &all);
        assert!(message.contains(words), "{args:?}: {message}");
    }
    let unproven =
        ["design", THREE, "--target", ARC, "--vary", "backbone.rest_curvature", "--prove"];
    assert!(fail(1, &unproven).contains("not proven to be the best"));
}
