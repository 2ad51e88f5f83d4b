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
    for name in ["shape.png", "tolerances.png", "errors.png", "disks.dxf", "disk-01.svg"] {
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

/// A limit holds in the file that is written, by the verbs that measure it.
#[test]
fn criteria_are_kept_and_told_and_refused_where_they_are_not() {
    let scratch = Scratch::new();
    let new = scratch.file("new.toml");
    let stiff = "stiffness, disk = 10, direction = x, at_least = 30 N/m";
    let slack = ["--set", "cables[0].tension=0 N"];
    let args = [
        "design",
        THREE,
        slack[0],
        slack[1],
        "--target",
        "0, 0, 180 mm",
        "--vary",
        "backbone.diameter",
        "--criterion",
        stiff,
        "-o",
        &new,
        "--json",
    ];
    let design = json(&succeed(&args));
    let [criterion] = &design["criteria"].as_array().unwrap()[..] else { panic!() };
    let value = criterion["value"].as_f64().unwrap();
    assert!(criterion["met"] == true && (30.0..32.0).contains(&value), "{criterion}");
    // A force at the tip of the new robot moves it as said.
    let pushed = ["solve", &new, "--set", "loads.tip_force=['1 mN', '0 N', '0 N']", "--json"];
    let x = json(&succeed(&pushed))["disks"][9]["position"][0].as_f64().unwrap();
    assert!((1e-3 / x / value - 1.0).abs() < 1e-3, "{x}");
    let all = ["design", THREE, "--target", ARC, "--vary", "cables[0].tension", "--criterion"];
    let with = |text| all.into_iter().chain([text]).collect::<Vec<_>>();
    let refused = fail(1, &with("stiffness, disk = 10, at_least = 9000 N/m"));
    assert!(refused.contains("instead of at least 9.0000e3 N/m"), "{refused}");
    assert!(fail(2, &with("clearance, at_least = 1 mm")).contains("nothing to keep clear of"));
    assert!(fail(2, &with("strength, weight = 1")).contains("no criterion"));
    let words = succeed(&with("tension, at_most = 3 N"));
    assert!(words.contains("wanted at most 3 N"), "{words}");
}

/// Each point of a path has tensions of its own, which are the steps of the file.
#[test]
fn a_path_of_the_tip_is_followed_by_the_steps_of_the_new_file() {
    let scratch = Scratch::new();
    let (new, path) = (scratch.file("new.toml"), scratch.file("path.csv"));
    // Arcs of 180 mm.
    let rows = "1,8,0,179.76\n2,16,0,179.05\n3,24,0,177.86\n";
    std::fs::write(&path, format!("t,x [mm],y [mm],z [mm]\n{rows}")).unwrap();
    let routing = "cables[0].routing";
    let args = ["design", THREE, "--target", &path, "--set", "design.starts=1", "--vary", routing];
    let with =
        |more: &[&'static str]| args.into_iter().chain(more.iter().copied()).collect::<Vec<_>>();
    let mut all = with(&["--vary", "cables[0].tension", "--json", "-o"]);
    all.push(&new);
    let design = json(&succeed(&all));
    assert_eq!(design["targets"].as_array().unwrap().len(), 3);
    assert!(design["error"].as_f64().unwrap() < 2e-3, "{}", design["error"]);
    // The tip of the last step is that of the last target.
    let solved = json(&warned(&["solve", &new, "--json"]).0);
    let position = &design["targets"][2]["points"][0]["position"];
    for axis in 0..3 {
        let [said, again] =
            [position, &solved["disks"][9]["position"]].map(|at| at[axis].as_f64().unwrap());
        assert!((said - again).abs() < 1e-6);
    }
    assert!(fail(2, &with(&[])).contains("tensions of their own"));
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
