//! `whipcord solve`.

use std::io::Read;
use std::process::Stdio;

use crate::support::{
    BUCKLED_SPANS, Scratch, command, fail, pushed_rod, robot, run, settings, succeed, warned,
};
use serde_json::Value;

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
    let position = |of: &Value| -> Vec<f64> { serde_json::from_value(of.clone()).unwrap() };
    let tips = [&shape["position"][10], &object["disks"][9]["position"]].map(position);
    assert!(tips[0].iter().zip(&tips[1]).all(|(a, b)| (a - b).abs() < 1e-8), "{tips:?}");
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
        assert!((a - b).abs() < 1e-8);
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
fn the_answer_is_the_same_whatever_is_shown_of_it() {
    let scratch = Scratch::new();
    let answer = |args: &[&str]| {
        let text = succeed(&[&["solve", CASE_3, "--json"], args].concat());
        let mut answer: Value = serde_json::from_str(&text).unwrap();
        answer["diagnostics"]["solve_time"] = Value::Null;
        answer["shape"] = Value::Null;
        answer
    };
    let plain = answer(&[]);
    assert_eq!(plain, answer(&["--plot", &scratch.file("robot.svg")]));
    assert_eq!(plain, answer(&["--stations", "37"]));
}

/// Under many times the weight that buckles it a rod comes to an answer that none with closer stations is
/// near to.
// cargo test --release -p whipcord-cli --test command -- --ignored solve::
#[test]
#[ignore = "a minute without optimisation"]
fn a_picture_is_drawn_where_closer_stations_have_no_answer() {
    let scratch = Scratch::new();
    let file = scratch.write("heavy.toml", HEAVY);
    let svg = scratch.file("heavy.svg");
    let answer = |text: &str| {
        let mut answer: Value = serde_json::from_str(text).unwrap();
        answer["diagnostics"]["solve_time"] = Value::Null;
        answer
    };
    let plain = warned(&["solve", &file, "--json"]).0;
    let drawn = run(&["solve", &file, "--json", "--plot", &svg]);
    assert_eq!((drawn.status, answer(&drawn.stdout)), (0, answer(&plain)), "{}", drawn.stderr);
    assert!(drawn.stderr.contains("places of the answer alone"), "{}", drawn.stderr);
    assert!(std::fs::read_to_string(&svg).unwrap().contains("</svg>"));
    let told = fail(1, &["solve", &file, "--stations", "181"]);
    assert!(told.contains("there is an answer"), "{told}");
    // What has an answer has it in a comparison, too.
    let out = scratch.file("report");
    let table = warned(&["compare", &file, "--out", &out]).0;
    assert!(table.contains("heavy, cosserat: drawn through its disks alone"), "{table}");
}

const HEAVY: &str = "
title = \"heavy\"
[backbone]
length = \"180 mm\"
diameter = \"3 mm\"
young_modulus = \"1.1 GPa\"
poisson_ratio = 0.3
density = 1000
[disks]
count = 10
hole_circle_radius = \"8 mm\"
holes = 12
[[cables]]
name = \"a\"
holes = [4, 4, 4, 4, 4, 4, 4, 4, 4, 4]
tension = 3.0
[loads]
gravity = [0, 0, -9.81]
[[loads.mass]]
at = \"180 mm\"
mass = \"30 kg\"
";

#[test]
fn a_column_that_buckles_is_bent_and_says_at_what_load_it_buckled() {
    let scratch = Scratch::new();
    let file = scratch.write("rod.toml", &pushed_rod(""));
    settings(None).bind(|| insta::assert_snapshot!("buckled", succeed(&["solve", &file])));
    let json: Value = serde_json::from_str(&succeed(&["solve", &file, "--json"])).unwrap();
    assert_eq!(json["status"], "converged");
    assert!(json["diagnostics"]["stability"].as_f64().unwrap().abs() < 1e-6);
    assert!((json["diagnostics"]["stability_lost_at"].as_f64().unwrap() - 0.666).abs() < 1e-3);

    let follower = scratch.write("follower.toml", &pushed_rod("follower = true"));
    let text = succeed(&["solve", &follower]);
    assert!(text.contains("stability not defined under loads that follow"), "{text}");
    assert!(!text.contains("unstable"), "{text}");
}

/// A verdict beside the status: stable, unstable with a warning, or none with its reason.
#[test]
fn stability_stands_beside_the_status() {
    let scratch = Scratch::new();
    let file = scratch.write("spans.toml", BUCKLED_SPANS);
    let args = ["solve", &file, "--json", "--model", "pseudo-rigid-body"];
    let solved = run(&args);
    let json: Value = serde_json::from_str(&solved.stdout).unwrap();
    assert_eq!(
        (solved.status, &json["status"], &json["stable"]),
        (0, &"converged".into(), &false.into())
    );
    let warning = &solved.stderr;
    assert!(
        warning.starts_with("warning: ")
            && warning.contains("the equilibrium is unstable (stability -"),
        "{warning}"
    );
    assert!(warning.contains("help: lower the load or the tension"), "{warning}");
    assert_eq!(json["warnings"][0]["code"], "unstable");
    // Nothing to warn of.
    let of = |file: &str, model: &str| -> Value {
        serde_json::from_str(&succeed(&["solve", file, "--json", "--model", model])).unwrap()
    };
    assert_eq!(of(CASE_3, "cosserat")["stable"], true);
    let none = of(CASE_3, "four-bar");
    assert_eq!(none["stable"], Value::Null);
    assert_eq!(none["diagnostics"]["stability_absent"], "no-energy");
    // Each step has its own.
    let steps = pushed_rod("").replace(
        "[loads]",
        "[[cables]]\nholes = [1, 1]\n[[steps]]\ntension = [0]\n[[steps]]\ntension = [0.1]\n[loads]",
    );
    let file = scratch.write("steps.toml", &steps);
    let stepped = run(&["solve", &file, "--json", "--model", "pseudo-rigid-body"]);
    let json: Value = serde_json::from_str(&stepped.stdout).unwrap();
    assert_eq!(json["steps"].as_array().unwrap().len(), 2);
    for step in json["steps"].as_array().unwrap() {
        let least = step["diagnostics"]["stability"].as_f64().unwrap();
        // A round rod that has buckled is neutral about its axis.
        assert_eq!(step["stable"], least >= -1e-6, "{least}");
    }
    assert_eq!(
        stepped.stderr.contains("the equilibrium is unstable"),
        json["steps"].as_array().unwrap().iter().any(|step| step["stable"] == false)
    );
}

#[test]
fn branches_are_listed() {
    let scratch = Scratch::new();
    let file = scratch.write("rod.toml", &pushed_rod(""));
    settings(None)
        .bind(|| insta::assert_snapshot!("branches", warned(&["solve", &file, "--branches"]).0));
    let text = warned(&["solve", &file, "--branches", "--json"]).0;
    let json: Value = serde_json::from_str(&text).unwrap();
    let branches = json["branches"].as_array().unwrap();
    let of = |key: &str| branches.iter().map(|b| b[key].clone()).collect::<Value>();
    assert_eq!(of("stable"), serde_json::json!([false, true, true]));
    assert_eq!(of("branch"), serde_json::json!([0, 1, 2]));
    // The answer is that on one of the branches that are stable.
    let tip = |object: &Value| object["disks"][9]["position"][0].as_f64().unwrap();
    assert!((tip(&branches[1]) - tip(&json)).abs() < 1e-6, "{} {}", tip(&branches[1]), tip(&json));
    let points = &json["critical_points"];
    assert_eq!(points[0]["kind"], "bifurcation");
    assert_eq!(points[0]["leads_to"], serde_json::json!([1, 2]));
    // Euler's load of the rod is about two thirds of what pushes it.
    assert!((points[0]["load"].as_f64().unwrap() - 0.666).abs() < 1e-3);
    let message = fail(2, &["solve", CASE_3, "--model", "four-bar", "--branches"]);
    assert!(message.contains("use cosserat, cosserat-disks,"), "{message}");
    // The other models with loads, whose columns buckle a little beside it.
    for model in ["cosserat-disks", "piecewise-constant-curvature", "pseudo-rigid-body"] {
        let text = warned(&["solve", &file, "--branches", "--json", "--model", model]).0;
        let json: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["critical_points"][0]["kind"], "bifurcation", "{model}");
        let load = json["critical_points"][0]["load"].as_f64().unwrap();
        assert!((load - 0.666).abs() < 0.01, "{model}: {load}");
    }
}

#[test]
fn iterations_are_shown_on_standard_error() {
    let scratch = Scratch::new();
    let pushed = pushed_rod("").replace("[0, 0, -0.5]", "[0.05, 0, -8]");
    let file = scratch.write("rod.toml", &pushed);
    let (plain, traced) =
        (warned(&["solve", &file, "--csv"]).0, run(&["solve", &file, "--csv", "--trace"]));
    assert_eq!((traced.status, traced.stdout), (0, plain));
    for stage in ["cold", "load steps"] {
        assert!(traced.stderr.lines().any(|line| line.starts_with(stage)), "{}", traced.stderr);
    }

    let loaded = robot("tension = \"1 N\"\n[loads]\ntip_force = [0.1, 0, 0]");
    let file = scratch.write("loaded.toml", &loaded);
    let text = run(&["solve", &file, "--trace", "--json"]);
    let json: Value = serde_json::from_str(&text.stdout).unwrap();
    let trace = json["trace"].as_array().unwrap();
    assert_eq!(trace[0]["stage"], "cold");
    assert_eq!((&trace[0]["iteration"], &trace[0]["load"]), (&1.into(), &1.0.into()));
    assert_eq!(trace[0]["tensions"], serde_json::json!([1.0]));
    // Each iteration leaves less than the one before it.
    for pair in trace.windows(2) {
        if pair[1]["iteration"].as_u64() > Some(1) {
            assert!(pair[1]["residual"].as_f64() < pair[0]["residual"].as_f64(), "{pair:?}");
        }
    }
    settings(None).bind(|| insta::assert_snapshot!("trace", text.stderr));
    let unloaded = run(&["solve", CASE_3, "--trace"]);
    assert!(
        unloaded.stderr.contains("no iterations on the robot as a whole: without load"),
        "{}",
        unloaded.stderr
    );

    let by_length = run(&["solve", CASE_3, "--trace", "--json", "--actuation", "shortening"]);
    let json: Value = serde_json::from_str(&by_length.stdout).unwrap();
    let last = json["trace"].as_array().unwrap().last().unwrap();
    assert_eq!(last["stage"], "lengths");
    assert!(last["residual"].as_f64() < Some(1e-12), "{last}");
    assert_eq!(last["tensions"][0], json["cables"][0]["tension"]);

    let disks = run(&["solve", &file, "--trace", "--json", "--model", "cosserat-disks"]);
    let json: Value = serde_json::from_str(&disks.stdout).unwrap();
    let trace = json["trace"].as_array().unwrap();
    assert_eq!((&trace[0]["stage"], &trace[0]["iteration"]), (&"cold".into(), &1.into()));
    assert_eq!(trace[0]["tensions"], serde_json::json!([1.0]));
    let last = trace.last().unwrap();
    assert_eq!((&last["stage"], &last["steps"]), (&"warm".into(), &json["diagnostics"]["steps"]));
    assert!(last["residual"].as_f64() <= Some(1e-9), "{last}");
    let message = fail(2, &["solve", CASE_3, "--model", "four-bar", "--trace"]);
    assert!(message.contains("--trace is for the models cosserat and cosserat-disks"), "{message}");

    // What leads to no answer is shown, too.
    let far = robot("tension = \"1000 kN\"\n[loads]\ntip_force = [0.1, 0, 0]");
    let far = run(&["solve", &scratch.write("far.toml", &far), "--trace"]);
    assert_eq!((far.status, far.stdout.as_str()), (1, ""));
    assert!(far.stderr.contains("folds"), "{}", far.stderr);
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
    assert!(unknown.contains("cosserat, cosserat-disks, four-bar"), "{unknown}");
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
fn a_solve_ends_after_the_iterations_that_it_was_given() {
    let scratch = Scratch::new();
    let file =
        scratch.write("bent.toml", &robot("tension = \"2 N\"\n[loads]\ntip_force = [0.1, 0, 0]"));
    let message = fail(1, &["solve", &file, "--max-iterations", "2"]);
    for words in ["is spent after 2 iterations", "`--max-iterations`"] {
        assert!(message.contains(words), "{message}");
    }
    let more = ["solve", &file, "--csv", "--max-iterations", "1000000"];
    assert_eq!(succeed(&more), succeed(&["solve", &file, "--csv"]));
    assert!(fail(2, &["solve", &file, "--max-iterations", "0"]).contains("--max-iterations"));
}

/// A backbone that does not get shorter, and two cables opposite each other that both shall.
#[test]
fn lengths_that_contradict_one_another_are_told_with_what_they_miss() {
    let scratch = Scratch::new();
    let text = robot("shortening = \"3 mm\"")
        .replace("poisson_ratio = 0.3", "poisson_ratio = 0.3\nextensible = false");
    let against = "name = \"against\"\nholes = [10, 10, 10, 10, 10, 10, 10, 10, 10, 10]";
    let text = format!("{text}[[cables]]\n{against}\nshortening = \"1 mm\"\n");
    let message = fail(1, &["solve", &scratch.write("against.toml", &text)]);
    let told = "cable `pull` is still 2 mm too long and cable `against` 2 mm; shorten each by";
    assert!(message.contains(told), "{message}");
}

/// So little that the least-squares shape is an answer: of the 0.4 mm each of the two cables misses a half.
#[test]
fn a_compromise_between_lengths_is_called_one() {
    let scratch = Scratch::new();
    let against = "name = \"against\"\nholes = [10, 10, 10, 10, 10, 10, 10, 10, 10, 10]";
    let solve = |name, shortening| {
        let text = format!(
            "{}[[cables]]\n{against}\nshortening = \"{shortening} mm\"\n",
            robot("shortening = \"3 mm\"")
        );
        let file = scratch.write(name, &text);
        succeed(&["solve", &file, "--model=four-bar", "--objective=strain-energy"])
    };
    let told = "compromise: the prescribed cable lengths contradict each other; cable `";
    let text = solve("little.toml", -2.6);
    assert!(text.contains(told) && text.contains("` is 0.2 mm too long\n"), "{text}");
    assert!(!solve("none.toml", -3.0).contains("compromise"));
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

#[test]
fn steps_are_solved_in_order() {
    let folder = Scratch::new();
    let steps = "[[cables]]\nname = \"hold\"\nholes = [10, 10, 10, 10, 10]\nends_at = \"80 mm\"\n[[steps]]\ntension = [1, 0]\n[[steps]]\ntension = [3, \"0.5 N\"]\n[[steps]]\ntension = [1, 0]\n";
    let text = robot(steps);
    let file = folder.write("steps.toml", &text);
    let file = file.as_str();
    settings(None).bind(|| insta::assert_snapshot!("steps", succeed(&["solve", file])));

    let object: Value = serde_json::from_str(&succeed(&["solve", file, "--json"])).unwrap();
    let steps = object["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 3);
    assert_eq!(object["disks"], steps[2]["disks"]);
    assert_eq!(steps[1]["cables"][1]["tension"], 0.5);
    // Without friction the same tensions give the same shape, whatever came between.
    let tip = |step: &Value| step["disks"][9]["position"][1].as_f64().unwrap();
    assert!((tip(&steps[0]) - tip(&steps[2])).abs() < 1e-12 && tip(&steps[1]) > 0.06);

    let csv = succeed(&["solve", file, "--csv"]);
    assert!(csv.starts_with("step,arc_length,x,y,z,qw,qx,qy,qz\n1,0.0,"));
    assert_eq!(csv.lines().count(), 1 + 3 * 10);
    assert!(csv.lines().last().unwrap().starts_with("3,0.18,"));

    let folds = folder.write("folds.toml", &text.replace("[3,", "[3000,"));
    let message = fail(1, &["solve", &folds]);
    assert!(message.contains("step 2 of 3: the section at"), "{message}");
}

/// Pulling and releasing differ: the same tension, twice, on the way out and on the way back.
#[test]
fn friction_shows_at_every_step() {
    let file = "examples/rubbing-finger.toml";
    let model = ["--model", "cosserat-disks"];
    let solve = |more: &[&str]| succeed(&[&["solve", file], &model[..], more].concat());
    settings(None).bind(|| insta::assert_snapshot!("rubbing", solve(&[])));

    let object: Value = serde_json::from_str(&solve(&["--json"])).unwrap();
    let steps = object["steps"].as_array().unwrap();
    let cable = |step: usize| &steps[step]["cables"][0];
    assert_eq!((&cable(0)["tension"], &cable(3)["tension"]), (&1.5.into(), &1.5.into()));
    let across = |step: usize| steps[step]["disks"][9]["position"][1].as_f64().unwrap();
    assert!(across(3) > across(0) + 1e-3);
    let tensions: Vec<f64> = serde_json::from_value(cable(1)["span_tensions"].clone()).unwrap();
    assert_eq!(tensions.len(), 9);
    assert!(tensions[0] < 4.0 && tensions.is_sorted_by(|a, b| a > b), "{tensions:?}");
    assert_eq!(cable(2)["slip_states"][0], "released");
    assert_eq!(cable(2)["slip_states"][8], "sticks");

    // One step, and no friction.
    let folder = Scratch::new();
    let once = robot("tension = \"3 N\"\nfriction = 0.1");
    let once = folder.write("once.toml", &once);
    let text = succeed(&["solve", &once, "--model", "cosserat-disks"]);
    assert!(text.contains("rubbing cable") && text.contains("disks 1–9 pulled"), "{text}");
    let free = folder.write("free.toml", &robot("tension = \"3 N\""));
    let text = succeed(&["solve", &free, "--model", "cosserat-disks"]);
    assert!(!text.contains("rubbing"), "{text}");
    let json = succeed(&["solve", &free, "--model", "cosserat-disks", "--json"]);
    assert!(!json.contains("span_tensions") && !json.contains("slip_states"), "{json}");
}

/// A rod that a force along it buckles, and antagonists that turn it over to either side.
fn led_astray(lines: &str) -> String {
    let antagonists = "[[cables]]\nname = \"back\"\nholes = [10, 10, 10, 10, 10, 10, 10, 10, 10, 10]\n[[steps]]\ntension = [1, 0]\n[[steps]]\ntension = [0, 0]\n[loads]\ntip_force = [0, 0, -1]\n";
    robot(&format!("{antagonists}{lines}"))
}

#[test]
fn all_verbs_go_the_steps() {
    let folder = Scratch::new();
    let file = folder.write("steps.toml", &led_astray(""));
    let object: Value = serde_json::from_str(&warned(&["solve", &file, "--json"]).0).unwrap();
    let tip = |object: &Value| object["disks"][9]["position"][1].as_f64().unwrap();
    assert!(tip(&object) > 0.05, "{object}");
    assert!(object["diagnostics"]["stability"].as_f64().unwrap() > 0.0);
    let text = warned(&["solve", &file]).0;
    assert!(text.contains("the last of 2 steps") && !text.contains("unstable"), "{text}");

    let report = folder.file("report");
    let table = warned(&["compare", &file, "--out", &report]).0;
    let row = table.lines().find(|line| line.contains("cosserat ")).unwrap();
    assert!(row.contains(&format!("{:.2}", 1e3 * tip(&object))), "{row}");
    let stiffness = warned(&["stiffness", &file]).0;
    assert!(!stiffness.contains("unstable"), "{stiffness}");
}

#[test]
fn steps_bend_as_the_base_sees_it() {
    let folder = Scratch::new();
    let turned = led_astray("[base]\norientation = [0.7071067811865476, 0.7071067811865476, 0, 0]");
    let (level, turned) =
        (folder.write("level.toml", &led_astray("")), folder.write("turned.toml", &turned));
    let bends = |file: &str| -> Vec<String> {
        let text = warned(&["solve", file]).0;
        let rows = text.lines().filter(|line| line.trim_start().starts_with(['1', '2']));
        rows.map(|row| row.split_whitespace().last().unwrap().to_owned()).collect()
    };
    assert_eq!(bends(&level).len(), 2);
    assert_eq!(bends(&level), bends(&turned));
}
