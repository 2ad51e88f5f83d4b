//! Warnings go to standard error and into JSON, and can be denied.
use crate::support::{Run, Scratch, fail, robot, run};
use serde_json::{Value, json};

/// A robot whose modulus has no unit, and whose bend is more than its material bears.
fn odd(modulus: &str) -> String {
    robot("tension = \"4 N\"\nshortening = \"5 %\"")
        .replace("\"1.1 GPa\"", modulus)
        .replace("poisson_ratio", "yield_strain = \"1 %\"\npoisson_ratio")
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).expect("standard output is JSON")
}

fn codes(warnings: &Value) -> Vec<&str> {
    let list = warnings.as_array().expect("a list");
    list.iter().filter_map(|of| of["code"].as_str()).collect()
}

#[test]
fn solve_warns_on_standard_error_and_in_json() {
    let scratch = Scratch::new();
    let file = scratch.write("odd.toml", &odd("\"1.1 GPa\""));
    let Run { status, stdout, stderr } = run(&["solve", &file]);
    assert_eq!(status, 0, "{stderr}");
    assert!(stdout.contains("tip") && !stdout.contains("warning"), "{stdout}");
    assert!(
        stderr.contains("odd.toml:7:16: warning: the strain on the backbone's surface"),
        "{stderr}"
    );
    assert!(
        stderr.contains("  7 | yield_strain = \"1 %\"") && stderr.contains("help: "),
        "{stderr}"
    );
    let solution = json_of(&run(&["solve", &file, "--json"]).stdout);
    assert_eq!(codes(&solution["warnings"]), ["yield-strain"]);
    let place = &solution["warnings"][0]["place"];
    assert_eq!((&place["line"], &place["column"]), (&json!(7), &json!(16)));
    let usual = json_of(&run(&["solve", "examples/table1/case-1.toml", "--json"]).stdout);
    assert_eq!(usual["warnings"], json!([]));
    let csv = run(&["solve", &file, "--csv"]);
    assert!(csv.stdout.starts_with("arc_length") && csv.stderr.contains("warning: "));
}

#[test]
fn denied_warnings_are_errors() {
    let scratch = Scratch::new();
    let answer = scratch.write("answer.toml", &odd("\"1.1 GPa\""));
    let said = fail(1, &["solve", &answer, "--deny-warnings"]);
    assert!(
        said.contains("warning: ") && said.ends_with("error: 1 warning, and --deny-warnings\n"),
        "{said}"
    );
    let input = scratch.write("input.toml", &odd("210000"));
    for verb in ["solve", "stiffness"] {
        let said = fail(2, &[verb, &input, "--deny-warnings"]);
        assert!(said.contains("looks like MPa"), "{said}");
    }
    let checked = run(&["check", &input, "--deny-warnings"]);
    assert_eq!(checked.status, 2, "{}", checked.stderr);
    assert!(checked.stdout.contains("valid") && checked.stderr.contains("looks like MPa"));
    // Where there is nothing to deny, nothing is denied.
    let usual = run(&["solve", "examples/table1/case-1.toml", "--deny-warnings"]);
    assert_eq!((usual.status, usual.stderr.as_str()), (0, ""));
}

#[test]
fn check_names_the_model_and_each_kind_once() {
    let scratch = Scratch::new();
    let file = scratch.write("odd.toml", &odd("\"1.1 GPa\""));
    let Run { status, stderr, .. } = run(&["check", &file]);
    assert_eq!(status, 0, "{stderr}");
    assert_eq!(stderr.matches("warning:").count(), 1, "{stderr}");
    assert!(stderr.contains("(cosserat, and ") && stderr.contains(" more answers)"), "{stderr}");
}

#[test]
fn many_steps_are_counted_and_not_listed() {
    let scratch = Scratch::new();
    let steps: String =
        (1..=50).map(|n| format!("[[steps]]\ntension = [{}]\n", f64::from(n) * 0.1)).collect();
    let text = odd("\"1.1 GPa\"").replace("tension = \"4 N\"\nshortening = \"5 %\"\n", &steps);
    let Run { status, stderr, .. } = run(&["solve", &scratch.write("steps.toml", &text)]);
    assert_eq!(status, 0, "{stderr}");
    assert_eq!(stderr.matches("warning:").count(), 1, "{stderr}");
    assert!(stderr.contains("(step ") && stderr.contains(" more answers)"), "{stderr}");
}

#[test]
fn compare_has_them_in_json_and_report() {
    let scratch = Scratch::new();
    let file = scratch.write("odd.toml", &odd("\"1.1 GPa\""));
    let out = scratch.file("out");
    let models = ["--model", "cosserat", "--model", "four-bar"];
    let arguments = [&["compare", &file, "--out", &out, "--json"][..], &models].concat();
    let Run { status, stdout, stderr } = run(&arguments);
    assert_eq!(status, 0, "{stderr}");
    let json = json_of(&stdout);
    assert_eq!(codes(&json["warnings"]), ["yield-strain"]);
    assert_eq!(json["warnings"][0]["case"], "Test robot");
    assert_eq!(stderr.matches("warning:").count(), 1, "{stderr}");
    let report = std::fs::read_to_string(scratch.path().join("out/report.html")).expect("a report");
    assert!(report.contains("Warning: the strain on the backbone"));
    let denied = [&arguments[..], &["--deny-warnings"]].concat();
    fail(1, &denied);
}

/// A silicone body with few disks, whose cable is given by this line.
fn silicone(command: &str) -> String {
    format!(
        r#"
[backbone]
length = "180 mm"
diameter = "16 mm"
young_modulus = "500 kPa"
poisson_ratio = 0.49
[disks]
count = 5
[[cables]]
routing = {{ kind = "helix", turns = 0.75, radius = "6 mm" }}
{command}
"#
    )
}

#[test]
fn disks_of_silicone_are_asked_about() {
    let scratch = Scratch::new();
    let file = scratch.write("soft.toml", &silicone("tension = \"1.5 N\""));
    let checked = run(&["check", &file]);
    assert!(checked.stderr.contains("with half the spacing of 5 disks"), "{}", checked.stderr);
    let solved = run(&["solve", &file, "--model", "cosserat-disks"]);
    assert_eq!(solved.status, 0, "{}", solved.stderr);
    assert!(solved.stderr.contains("with half the spacing of 5 disks"), "{}", solved.stderr);
    let json = run(&["solve", &file, "--model", "cosserat-disks", "--json"]).stdout;
    assert_eq!(codes(&json_of(&json)["warnings"]), ["disk-spacing"]);
    // In channels there is no spacing.
    assert_eq!(run(&["solve", &file]).stderr, "");
}

/// What half the spacing changes is asked of the model as it was chosen: by the shortening the robot hardly bends, by the tension it does.
#[test]
fn the_spacing_is_halved_under_the_actuation_that_was_chosen() {
    let scratch = Scratch::new();
    let both = silicone("tension = \"1.5 N\"\nshortening = \"0.1 mm\"");
    let file = scratch.write("both.toml", &both);
    let of = |actuation| {
        run(&["solve", &file, "--model", "cosserat-disks", "--actuation", actuation]).stderr
    };
    assert!(of("tension").contains("with half the spacing"), "{}", of("tension"));
    assert_eq!(of("shortening"), "");
}

#[test]
fn what_files_have_in_common_is_said_once() {
    let scratch = Scratch::new();
    scratch.write("robot.toml", &odd("1100"));
    for name in ["one.toml", "two.toml"] {
        scratch.write(name, "extends = \"robot.toml\"\ntitle = \"of it\"\n");
    }
    let (one, two) = (scratch.file("one.toml"), scratch.file("two.toml"));
    let checked = run(&["check", &one, &two]);
    assert_eq!(checked.status, 0, "{}", checked.stderr);
    assert_eq!(checked.stderr.matches("looks like MPa").count(), 1, "{}", checked.stderr);
}
