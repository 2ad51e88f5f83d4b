//! `whipcord check`, `whipcord schema`, and what all verbs share.

use crate::support::{BUCKLED_SPANS, Run, Scratch, fail, pushed_rod, robot, run, succeed};
use serde_json::{Value, json};

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
        "hysteresis-loop",
        "soft-finger",
    ] {
        let text = succeed(&["check", &format!("examples/{name}.toml")]);
        insta::assert_snapshot!(name.replace('/', "_"), text);
    }
}

/// Stations stand for the disks that a body does not have, but are not drawn.
#[test]
fn a_body_without_disks_is_solved_drawn_and_compared() {
    let scratch = Scratch::new();
    let file = "examples/soft-finger.toml";
    let json: Value = serde_json::from_str(&succeed(&["solve", file, "--json"])).unwrap();
    assert_eq!(json["disks"].as_array().unwrap().len(), 21);
    assert_eq!(json["shape"]["position"].as_array().unwrap().len(), 21);
    let at = |key: usize| json["shape"]["position"][20][key].as_f64().unwrap();
    // The flexor lies in y, and bends the finger there.
    assert!(at(0).abs() < 1e-9 && at(1) > 0.05 && at(2) < 0.14, "{json}");
    let picture = |file: &str, name: &str| {
        let picture = scratch.file(name);
        succeed(&["solve", file, "--plot", &picture]);
        std::fs::read_to_string(picture).unwrap().matches("class=\"disk").count()
    };
    let disks = scratch.write(
        "disks.toml",
        &(std::fs::read_to_string(crate::support::root().join(file)).unwrap()
            + "\n[disks]\ncount = 5\n"),
    );
    assert_eq!(picture(file, "none.svg"), 0);
    // As many pieces of each disk in each of the views.
    let five = picture(&disks, "five.svg");
    assert!(five > 0 && five.is_multiple_of(5), "{five}");
    let text = succeed(&["compare", file, "--out", &scratch.file("out")]);
    assert!(text.contains("cosserat") && text.contains("add [disks]"), "{text}");
    let message = fail(2, &["solve", file, "--model", "four-bar"]);
    assert!(message.contains("needs `disks`") && message.contains("count = 10"), "{message}");
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

/// Verdicts and warnings for programs.
#[test]
fn what_is_checked_can_be_had_as_json() {
    let scratch = Scratch::new();
    let bare = robot("tension = \"1 N\"").replace("\"1.1 GPa\"", "1100");
    let rod = scratch.write("rod.toml", &pushed_rod(""));
    let odd = scratch.write("odd.toml", &bare);
    let bad = scratch.write("bad.toml", &robot("tension = \"1 mm\""));
    let both = run(&["check", &rod, &odd, "--json"]);
    assert_eq!(both.status, 0, "{}", both.stderr);
    let json: Value = serde_json::from_str(&both.stdout).unwrap();
    let [buckled, odd] = &json["files"].as_array().unwrap()[..] else { panic!("{json}") };
    assert_eq!((&buckled["valid"], &buckled["title"]), (&json!(true), &json!("Test robot")));
    let model = |file: &Value, name: &str| -> Value {
        let models = file["models"].as_array().unwrap();
        assert_eq!(models.len(), 6);
        models.iter().find(|model| model["model"] == name).unwrap().clone()
    };
    let cosserat = model(buckled, "cosserat");
    assert_eq!(cosserat["status"], "converged");
    assert!(cosserat["stable"].is_boolean() && cosserat["reason"].is_null(), "{cosserat}");
    let refused = model(buckled, "four-bar");
    assert_eq!((&refused["status"], &refused["stable"]), (&json!("refused"), &Value::Null));
    assert!(refused["reason"].as_str().unwrap().contains("four-bar"), "{refused}");
    assert_eq!(odd["warnings"][0]["code"], "bare-number");
    assert_eq!(odd["warnings"][0]["place"]["line"], 6);
    // The tables in SI, with target and limits.
    assert_eq!(buckled["tables"]["backbone"]["young_modulus"], 1.1e9);
    let aim = "[target]\ntip = [\"60 mm\", \"0 mm\", \"90 mm\"]\n[limits]\ntension = [\"0 N\", \"20 N\"]\n";
    let aiming = scratch.write("aim.toml", &(robot("tension = \"1 N\"") + aim));
    let aiming = run(&["check", &aiming, "--json"]);
    let json: Value = serde_json::from_str(&aiming.stdout).unwrap();
    let tables = &json["files"][0]["tables"];
    assert_eq!(tables["target"]["tip"], json!([0.06, 0.0, 0.09]), "{tables}");
    assert_eq!(tables["limits"]["tension"], json!([0.0, 20.0]));
    // What is wrong with a file stands beside what is right with the others.
    let run = run(&["check", odd["path"].as_str().unwrap(), &bad, "--json"]);
    assert_eq!(run.status, 2);
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(
        (&json["files"][0]["valid"], &json["files"][1]["valid"]),
        (&json!(true), &json!(false))
    );
    let problem = &json["files"][1]["problems"][0];
    assert_eq!((&problem["place"]["line"], &problem["place"]["column"]), (&json!(15), &json!(11)));
    assert!(problem["message"].as_str().unwrap().contains("`tension`"), "{problem}");
    assert!(run.stderr.contains("bad.toml:15:11"));
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
    let file = scratch.write("spans.toml", BUCKLED_SPANS);
    let Run { status, stdout: text, stderr } = run(&["check", &file]);
    assert_eq!(status, 0, "{stderr}");
    assert!(stderr.contains("is unstable"), "{stderr}");
    assert!(text.contains("tension 150 N; unstable: the robot leaves this shape"), "{text}");
}

#[test]
fn the_schema_is_json_and_can_be_written() {
    let text = succeed(&["schema"]);
    let schema: Value = serde_json::from_str(&text).unwrap();
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

/// Pages of help use the terms of the field, and none of the wordings that nobody else uses.
#[test]
fn help_is_plain() {
    let verbs = [
        vec!["solve"],
        vec!["stiffness"],
        vec!["compare"],
        vec!["fit"],
        vec!["measure"],
        vec!["camera", "calibrate"],
        vec!["camera", "locate"],
        vec!["overlay"],
        vec!["bench"],
        vec!["check"],
        vec!["view"],
        vec!["schema"],
        vec!["new"],
        vec!["examples"],
        vec!["completions"],
        vec!["man"],
    ];
    for mut args in verbs {
        args.push("--help");
        let page = succeed(&args);
        for private in [
            "hang together",
            "side by side",
            "What drives",
            "was understood",
            "yields to",
            "can take",
            "stands in",
            "leave the browser",
            "bends nothing",
            "Hardly at all",
            "far off",
        ] {
            assert!(!page.contains(private), "{args:?} has {private:?}:\n{page}");
        }
    }
    assert!(succeed(&["solve", "--help"]).contains("equilibria connected to the unloaded shape"));
}

/// A key that is set counts as if the file said it.
#[test]
fn keys_are_set_beside_the_file() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("tension = \"1 N\"\naxial_stiffness = \"2 kN\""));
    let csv = |file: &str, settings: &[&str]| {
        let mut args = vec!["solve", file, "--csv"];
        args.extend(settings.iter().flat_map(|setting| ["--set", *setting]));
        succeed(&args)
    };
    let said = |old: &str, new: &str| {
        let text = robot("tension = \"1 N\"\naxial_stiffness = \"2 kN\"").replace(old, new);
        csv(&scratch.write("said.toml", &text), &[])
    };
    let two = said("1 N", "2 N");
    assert_ne!(csv(&file, &[]), two);
    for setting in [
        "cables.pull.tension=2 N",
        "cables.pull.tension=2",
        "cables.pull.tension = \"2 N\"",
        "cables[0].tension=2.0",
    ] {
        assert_eq!(csv(&file, &[setting]), two, "{setting}");
    }
    // Several keys, a table that the file does not have, and what says the same in another way.
    let shorter =
        robot("tension = \"1 N\"\naxial_stiffness = \"2 kN\"").replace("180 mm", "160 mm");
    let shorter = format!("{shorter}[loads]\ntip_force = [0, 0.1, 0]\n");
    assert_eq!(
        csv(&file, &["backbone.length=160 mm", "loads.tip_force=[0, \"0.1 N\", 0]"]),
        csv(&scratch.write("said.toml", &shorter), &[])
    );
    assert_eq!(
        csv(&file, &["backbone.shear_modulus=420 MPa"]),
        said("poisson_ratio = 0.3", "shear_modulus = 420e6")
    );
}

#[test]
fn messages_of_the_command_line() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("tension = \"1 N\""));
    let steps = scratch.write("steps.toml", &format!("{}[[steps]]\ntension = [1]\n", robot("")));
    let post = |turned: &str| {
        format!(
            "{}[[obstacles]]\nkind = \"cylinder\"\nname = \"post\"\nradius = 0.01\nlength = 0.2\nposition = [0.02, 0, 0.09]\n{turned}",
            robot("tension = 3")
        )
    };
    let along = scratch.write("along.toml", &post("").replace("0.02, 0", "0.015, 0"));
    let across = scratch
        .write("across.toml", &post("rotation = { axis = [0, 1, 0], angle = \"90 deg\" }\n"));
    let thick = robot("tension = 1").replace("holes = 12\n", "holes = 12\nthickness = \"30 mm\"\n");
    let thick = scratch.write("thick.toml", &thick);
    let runs: &[&[&str]] = &[
        &["solve", &file, "--tension", "5"],
        &["solve", &file, "--shortening=5 %"],
        &["solve", &file, "--diameter", "2 mm"],
        &["view", &file, "--tension", "5"],
        &["solve", &file, "--branch"],
        &["stiffness", &file, "--at", "90"],
        &["stiffness", &file, "--at", "ninety"],
        &["solve", &file, "--set", "cables.pull"],
        &["solve", &file, "--set", "cables.left.tension=5 N"],
        &["solve", &file, "--set", "cables[1].tension=5 N"],
        &["solve", &file, "--set", "cables.pull.tension=5 mm"],
        &["solve", &file, "--set", "cables.pull.tensoin=5 N"],
        &["solve", &file, "--set", "cables.pull.shortening=5.7"],
        &["solve", &file, "--set", "cables.pull.shortening=\"5.7\""],
        &["solve", &file, "--set", "backbone.radius=1.5 mm"],
        &["solve", &file, "--set", "loads.tip_force=0.1 N"],
        &["solve", &file, "--set", "obstacles.post.radius=0.1"],
        &["solve", &file, "--set", "backbone..length=1"],
        &["solve", &file, "--set", "extends=other.toml"],
        &["solve", &steps, "--set", "cables.pull.tension=5 N"],
        &["solve", &file, "--timeout", "-1"],
        &["solve", &file, "--timeout=-2 s"],
        &["solve", &file, "--timeout", "soon"],
        &["solve", &thick],
        &["solve", &along],
        &["solve", &across],
    ];
    let folder = format!("{}/", scratch.path().display());
    let told = runs.iter().map(|args| {
        let run = run(args);
        assert!(run.status != 0 && run.stdout.is_empty(), "{args:?} {}", run.stdout);
        let shown: Vec<&str> =
            args.iter().map(|arg| arg.strip_prefix(&folder).unwrap_or(arg)).collect();
        format!("$ whipcord {}\n{}", shown.join(" "), run.stderr.replace(&folder, ""))
    });
    insta::assert_snapshot!("command_line", told.collect::<Vec<_>>().join("\n"));
}
