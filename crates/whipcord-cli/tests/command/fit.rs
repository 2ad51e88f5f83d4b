//! `whipcord fit`.

use crate::support::{BUCKLED_SPANS, Scratch, fail, robot, settings, succeed, warned};
use serde_json::Value;

/// A robot file with a comment and units, whose rod is this thick, pulled by this much, with what was
/// measured in a file beside it.
fn file(scratch: &Scratch, name: &str, diameter: &str, tension: &str, fit: &str) -> String {
    let measured = format!("tension = \"{tension}\"\n\n[measured]\ndisks = \"{name}.csv\"\n{fit}");
    let text = robot(&measured)
        .replace("diameter = \"3 mm\"", &format!("diameter = \"{diameter}\" # with a gauge"));
    scratch.write(&format!("{name}.toml"), &text)
}

/// What the real robot, 3 mm thick, does: its disks, moved by up to `noise` mm to and fro.
fn measure(scratch: &Scratch, name: &str, tension: &str, noise: f64) {
    let real = scratch.write("real.toml", &robot(&format!("tension = \"{tension}\"")));
    let json: Value = serde_json::from_str(&succeed(&["solve", &real, "--json"])).unwrap();
    let mut csv = String::from("disk,x,y,z\n");
    for (i, disk) in json["disks"].as_array().unwrap().iter().enumerate() {
        let at = |axis: usize| {
            let wave = ((7 * i + 3 * axis + name.len()) as f64 * 1.9).sin();
            disk["position"][axis].as_f64().unwrap() + noise * 1e-3 * wave
        };
        csv += &format!("{},{},{},{}\n", i + 1, at(0), at(1), at(2));
    }
    scratch.write(&format!("{name}.csv"), &csv);
}

const FIT: &str = "\n[fit]\nparameters = [\"backbone.diameter\", \"base.position[1]\"]\n";

#[test]
fn a_fit_is_printed_written_and_reported() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.2);
    measure(&scratch, "two", "3 N", 0.2);
    let files =
        [file(&scratch, "a", "2.9 mm", "2 N", FIT), file(&scratch, "two", "2.9 mm", "3 N", "")];
    let out = scratch.path().join("out");
    let text = succeed(&[
        "fit",
        &files[0],
        &files[1],
        "--out",
        out.to_str().unwrap(),
        "--cross-validate",
        "--compare-models",
    ]);
    settings(Some(&out)).bind(|| insta::assert_snapshot!("two_cases", text));
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("<svg") && !report.contains("NaN"));
    assert!(report.contains("Measured and fitted") && report.contains("The fitted robot of two"));
    let written = ["estimates.csv", "residuals.csv", "distances.png", "coordinates.svg"];
    for name in written.into_iter().chain(["fitted-a.svg", "fitted-two.png"]) {
        assert!(out.join(name).is_file(), "{name}");
    }
    // The fitted files keep their text but for what was fitted, find their measurements, and solve.
    let fitted = std::fs::read_to_string(out.join("a-fitted.toml")).unwrap();
    assert!(fitted.contains("# with a gauge"), "{fitted}");
    assert!(fitted.contains("disks = \"../a.csv\""), "{fitted}");
    let diameter = fitted.lines().find(|line| line.starts_with("diameter")).unwrap();
    assert!(diameter.starts_with("diameter = \"2.99") || diameter.starts_with("diameter = \"3.0"));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let arm = crate::support::root().join("examples/motor-log/arm.toml");
    let fit = |threads: &str| {
        let mut args = vec!["fit", arm.to_str().unwrap(), "--json", "--threads", threads];
        args.extend([
            "--parameter",
            "motors[*].stiffness",
            "--parameter",
            "motors[pan].angle_offset",
        ]);
        warned(&args)
    };
    let alone = fit("1");
    assert_eq!(alone, fit("3"));
    let json: Value = serde_json::from_str(&alone.0).unwrap();
    assert_eq!(json["status"], "converged");
    let message = fail(2, &["fit", arm.to_str().unwrap(), "--threads", "0"]);
    assert!(message.contains("--threads"), "{message}");
}

/// A straight rod whose spans buckle under the pull of a cable, measured in that shape: an equilibrium that no robot stays in.
#[test]
fn unstable_answers_are_named() {
    let scratch = Scratch::new();
    let seen: String = (0..10)
        .map(|i| format!("{},0.002,{},{}\n", i + 1, 1e-4 * (i % 2) as f64, 0.02 * i as f64))
        .collect();
    scratch.write("seen.csv", &format!("disk,x,y,z\n{seen}"));
    let fitted = |tension: &str| {
        let spans = BUCKLED_SPANS.replace("150", tension);
        let file = scratch.write("rod.toml", &format!("{spans}[measured]\ndisks = \"seen.csv\"\n"));
        let args =
            ["fit", &file, "--parameter", "base.position[0]", "--model", "pseudo-rigid-body"];
        let (json, warnings) = warned(&[&args[..], &["--json"]].concat());
        (serde_json::from_str::<Value>(&json).unwrap(), warnings, warned(&args).0)
    };
    let (json, warnings, text) = fitted("150");
    let what = "the answer that the measurements are compared with is an unstable equilibrium at the estimates: rod (stability -";
    let help = "check the loads, the commands and the start values";
    assert!(warnings.starts_with(&format!("warning: {what}")), "{warnings}");
    assert!(warnings.ends_with(&format!("may be wrong\n  help: {help}\n")), "{warnings}");
    assert!(text.contains(what) && text.contains(help), "{text}");
    // What to do is said once.
    let warning = &json["warnings"][0];
    let message = warning["message"].as_str().unwrap();
    assert!(message.starts_with(what) && !message.contains("check"), "{json}");
    assert_eq!(warning["help"], help);
    assert_eq!((&json["answers"], json["unstable"].as_array().unwrap().len()), (&1.into(), 1));
    let unstable = &json["unstable"][0];
    assert_eq!((&unstable["case"], &unstable["step"]), (&"rod".into(), &1.into()));
    assert!(unstable["stability"].as_f64().unwrap() < -0.1);
    // What the rod bears is nothing to warn of.
    let (json, warnings, text) = fitted("20");
    assert!(warnings.is_empty() && !text.contains("unstable"), "{warnings} {text}");
    assert_eq!((&json["answers"], &json["unstable"]), (&1.into(), &serde_json::json!([])));
}

#[test]
fn what_is_fitted_again_stays() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.1);
    let first = file(&scratch, "a", "2.9 mm", "2 N", "");
    let (fitted, again) = (scratch.file("fitted.toml"), scratch.file("again.toml"));
    let what = ["--parameter", "backbone.diameter", "--parameter", "cables[0].tension_offset"];
    let args = |from: &str, to: &str| {
        let text = succeed(&["fit", from, what[0], what[1], "-o", to, "--json"]);
        serde_json::from_str::<Value>(&text).unwrap()
    };
    let (one, two) = (args(&first, &fitted), args(&fitted, &again));
    let value = |json: &Value| json["estimates"][0]["value"].as_f64().unwrap();
    assert!((value(&one) / value(&two) - 1.0).abs() < 1e-8);
    assert_eq!(two["status"], "converged");
    assert!((value(&one) - 0.003).abs() < 1e-5);
    // What a single pull cannot tell apart is said, whether the search ends or not.
    let both = crate::support::run(&["fit", &first, what[0], what[1], what[2], what[3]]);
    let said = both.stdout + &both.stderr;
    assert!(
        said.contains("hardly anything that was measured changes when backbone.diameter"),
        "{said}"
    );
    assert_eq!(one["residuals"].as_array().unwrap().len(), 10);
    assert!(one["noise"]["level"].as_f64().unwrap() > 1e-5);
}

#[test]
fn refusals_write_nothing() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.2);
    let good = file(&scratch, "a", "2.9 mm", "2 N", "");
    let out = scratch.file("out");
    let with = |args: &[&str]| {
        let mut all = vec!["fit"];
        all.extend(args);
        all.extend(["--out", &out]);
        let message = fail(2, &all);
        assert!(!scratch.path().join("out").exists(), "{message}");
        message
    };
    let diameter = ["--parameter", "backbone.diameter"];
    assert!(with(&[&good]).contains("nothing is to be estimated"));
    let unmeasured = scratch.write("unmeasured.toml", &robot("tension = \"1 N\""));
    let message = with(&[&unmeasured, diameter[0], diameter[1]]);
    assert!(message.contains("unmeasured.toml has no measurements"), "{message}");
    let message = with(&[&good, "--parameter", "backbone.diamter"]);
    assert!(message.contains("did you mean backbone.diameter?"), "{message}");
    let other = file(&scratch, "a2", "4 mm", "2 N", "");
    measure(&scratch, "a2", "2 N", 0.2);
    let message = with(&[&good, &other, diameter[0], diameter[1]]);
    assert!(message.contains("describe different robots: the backbone differ"), "{message}");
    let message = with(&[&good, &good, diameter[0], diameter[1], "-o", "x.toml"]);
    assert!(message.contains("--output is for one file"), "{message}");
    let message = with(&[&good, "--parameter", "cables[1].friction", "--model", "cosserat-disks"]);
    assert!(message.contains("cable 2"), "{message}");
    scratch.write("few.csv", "disk,x,y,z\n10,0,0.05,0.15\n");
    let few = file(&scratch, "few", "3 mm", "2 N", "");
    let paths = ["backbone.diameter", "base.position[0]", "base.position[1]"];
    let message =
        with(&[&few, "--parameter", paths[0], "--parameter", paths[1], "--parameter", paths[2]]);
    assert!(message.contains("3 numbers were measured, too few for 3 unknowns"), "{message}");

    let folded = file(&scratch, "a3", "0.1 mm", "2 N", "");
    measure(&scratch, "a3", "2 N", 0.2);
    let message = fail(1, &["fit", &folded, diameter[0], diameter[1], "--out", &out]);
    assert!(message.contains("no answer with the values to start from"), "{message}");
    assert!(!scratch.path().join("out").exists());
}

#[test]
fn mistakes_in_the_table_are_shown() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.2);
    let table = "\n[fit]\nparameters = [\"backbone.young_modulu\"]\n\n[[fit.known]]\nparameter = \"disks.mass\"\nleast = 0\n";
    let wrong = file(&scratch, "a", "2.9 mm", "2 N", table);
    let message = fail(2, &["fit", &wrong]);
    assert!(message.contains("did you mean `backbone.young_modulus`?"), "{message}");
    assert!(message.contains("`disks.mass` is not estimated"), "{message}");
}

#[test]
fn what_is_read_stays() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.1);
    let own = file(&scratch, "a", "2.9 mm", "2 N", "");
    let before = std::fs::read_to_string(&own).unwrap();
    let table = scratch.file("a.csv");
    let measured = std::fs::read_to_string(&table).unwrap();
    let diameter = ["--parameter", "backbone.diameter"];
    // The same file by another path as well.
    let detour =
        scratch.file("../").to_owned() + scratch.path().file_name().unwrap().to_str().unwrap();
    for out in [own.clone(), format!("{detour}/a.toml"), table.clone()] {
        let message = fail(2, &["fit", &own, diameter[0], diameter[1], "-o", &out]);
        assert!(message.contains("is read: write to another file"), "{message}");
    }
    assert_eq!(std::fs::read_to_string(&own).unwrap(), before);
    assert_eq!(std::fs::read_to_string(&table).unwrap(), measured);
}

#[test]
fn numbers_of_a_file_that_is_extended_are_laid_over_it() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.1);
    file(&scratch, "a", "2.9 mm", "2 N", "");
    let child = "# by whom\nextends = \"a.toml\"\ntitle = \"child\"\n\n[measured]\ndisks = \"a.csv\"\nregistration = \"none\"\n";
    let child = scratch.write("child.toml", child);
    let fitted = scratch.file("fitted.toml");
    let parent = scratch.file("a.toml");
    let message = fail(2, &["fit", &child, "--parameter", "backbone.diameter", "-o", &parent]);
    assert!(message.contains("is read: write to another file"), "{message}");
    let text = succeed(&["fit", &child, "--parameter", "backbone.diameter", "-o", &fitted]);
    assert!(!text.contains("written anew"), "{text}");
    let text = std::fs::read_to_string(&fitted).unwrap();
    assert!(text.contains("# by whom") && text.contains("extends = \"a.toml\""), "{text}");
    assert!(
        text.contains("[backbone]\ndiameter = 0.0029")
            || text.contains("[backbone]\ndiameter = 0.0030"),
        "{text}"
    );
    assert!(!text.contains("length"), "{text}");
}

#[test]
fn a_frame_of_its_own_is_estimated() {
    let scratch = Scratch::new();
    measure(&scratch, "a", "2 N", 0.1);
    let own = file(&scratch, "a", "2.9 mm", "2 N", "registration = \"rigid\"\n");
    let diameter = ["--parameter", "backbone.diameter"];
    let text = succeed(&["fit", &own, diameter[0], diameter[1]]);
    assert!(text.contains("measured.position[0]"), "{text}");
    succeed(&["fit", &own, diameter[0], diameter[1], "--each", "base.position[0]"]);
}

/// A robot with two cables on one motor each, in two groups.
const MOTORS: &str = r#"
[backbone]
length = "200 mm"
diameter = "2 mm"
young_modulus = "50 GPa"
poisson_ratio = 0.3

[disks]
count = 11
hole_circle_radius = "10 mm"

[[cables]]
name = "east"
group = "side"
routing = { kind = "straight", angle = "0 deg", radius = "8 mm" }
[[cables]]
name = "north"
group = "side"
routing = { kind = "straight", angle = "90 deg", radius = "8 mm" }

[[motors]]
name = "one"
cables = ["east"]
stiffness = "DRIVE"
[[motors]]
name = "two"
cables = ["north"]
stiffness = "DRIVE"

[[steps]]
motors = ["3 mm", "1 mm"]
[[steps]]
motors = ["1 mm", "4 mm"]
"#;

/// One stiffness of all drives, and one angle by which all holes of a group are turned.
#[test]
fn numbers_that_motors_and_cables_share_are_found_and_written() {
    let scratch = Scratch::new();
    let real =
        MOTORS.replace("DRIVE", "4 N/mm").replace("\"0 deg", "\"2 deg").replace("90 deg", "92 deg");
    watch(&scratch, &real);
    let fit = "[measured]\ndisks = \"seen.csv\"\n[fit]\nparameters = [\"motors[*].stiffness\", \"cables[side].routing.angle\"]\n\
               [[fit.known]]\nparameter = \"motors[*].stiffness\"\nleast = 100.0\n";
    let text = MOTORS.replace("DRIVE", "6 N/mm");
    let file = scratch.write("file.toml", &format!("{text}{fit}"));
    let fitted = scratch.path().join("fitted.toml");
    let text = succeed(&["fit", &file, "-o", fitted.to_str().unwrap()]);
    settings(Some(scratch.path())).bind(|| insta::assert_snapshot!("shared_numbers", text));
    // Each keeps its unit and its own angle.
    let fitted = std::fs::read_to_string(fitted).unwrap();
    let near = |key: &str, from: f64, to: f64| {
        let values = fitted.split(key).skip(1).filter_map(|rest| rest.split_once(' '));
        let values: Vec<f64> = values.map(|(value, _)| value.parse().unwrap()).collect();
        assert_eq!(values.len(), 2, "{fitted}");
        values.iter().for_each(|value| assert!((from..to).contains(value), "{fitted}"));
        values
    };
    let drives = near("stiffness = \"", 3.8, 4.2);
    assert_eq!(drives[0], drives[1]);
    let angles = near("angle = \"", 1.0, 93.0);
    assert!((angles[1] - angles[0] - 90.0).abs() < 1e-6, "{angles:?}");

    let message = fail(2, &["fit", &file, "--parameter", "motors[three].stiffness"]);
    settings(Some(scratch.path())).bind(|| insta::assert_snapshot!("no_such_motor", message));
    let wrong = fit.replace("cables[side]", "cables[back]");
    let file = scratch.write("wrong.toml", &format!("{MOTORS}{wrong}").replace("DRIVE", "6 N/mm"));
    let message = fail(2, &["fit", &file]);
    settings(Some(scratch.path())).bind(|| insta::assert_snapshot!("no_such_group", message));
}

/// Writes what the real robot does in its steps, with noise, to `seen.csv`.
fn watch(scratch: &Scratch, real: &str) {
    let real = scratch.write("real.toml", real);
    let json: Value = serde_json::from_str(&succeed(&["solve", &real, "--json"])).unwrap();
    let mut csv = String::from("step,disk,x,y,z\n");
    for (k, step) in json["steps"].as_array().unwrap().iter().enumerate() {
        for (i, disk) in step["disks"].as_array().unwrap().iter().enumerate() {
            let at = |axis: usize| {
                let wave = ((11 * k + 7 * i + 3 * axis) as f64 * 1.9).sin();
                disk["position"][axis].as_f64().unwrap() + 1e-4 * wave
            };
            csv += &format!("{},{},{},{},{}\n", k + 1, i + 1, at(0), at(1), at(2));
        }
    }
    scratch.write("seen.csv", &csv);
}

/// A clamp that slipped by 1.5 mm is named; rows are held out, other files scored, and what is said is in the report and in JSON.
#[test]
fn what_is_said_of_a_fit_besides_its_estimates() {
    let scratch = Scratch::new();
    let step = |k: i32| {
        let k = f64::from(k);
        let (a, b) = (1.0 + 1.5 * (k * 0.7).sin().abs(), 2.0 + 2.0 * (k * 1.1).cos().abs());
        format!("[[steps]]\nmotors = [\"{a:.2} mm\", \"{b:.2} mm\"]\n")
    };
    let steps: String = (0..24).map(step).collect();
    let text = MOTORS.replace("DRIVE", "4 N/mm");
    let robot = text.split("[[steps]]").next().unwrap();
    let slipped = "cables = [\"north\"]\ntravel_offset = \"1.5 mm\"";
    let real = robot.replace("cables = [\"north\"]", slipped);
    watch(&scratch, &format!("{real}{steps}"));
    let measured = "[measured]\ndisks = \"seen.csv\"\n";
    let file = scratch.write("file.toml", &format!("{robot}{steps}{measured}"));
    let out = scratch.path().join("out");
    let stiffness = ["--parameter", "motors[*].stiffness"];
    let known =
        ["--prior", "motors[*].stiffness=5000,3000", "--bounds", "motors[*].stiffness=100,"];
    let args = [&["fit", &file][..], &stiffness, &known, &["--loss", "huber"]].concat();
    let asked = ["--cross-validate", "--ladder", "--profile", "--split", "0.25", "--seed", "2"];
    let (text, warnings) = warned(&[&args[..], &asked, &["--out", out.to_str().unwrap()]].concat());
    settings(Some(scratch.path())).bind(|| insta::assert_snapshot!("analyses", text));
    assert!(warnings.contains("cables[1].shortening_offset stands out"), "{warnings}");
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    for title in ["Profile likelihood", "Not fitted", "Which measurement would", "stands out"] {
        assert!(report.contains(title), "{title}");
    }
    assert!(out.join("sensitivity.png").is_file() && out.join("profiles.svg").is_file());
    let (json, _) = warned(&[&args[..], &["--test", &file, "--json"]].concat());
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["loss"], "huber");
    let mut rows: Vec<f64> = (json["test"]["rows"].as_array().unwrap().iter())
        .map(|row| row["rms_distance"].as_f64().unwrap())
        .collect();
    rows.sort_by(f64::total_cmp);
    assert_eq!(rows.len(), 24);
    assert_eq!(json["test"]["median_distance"].as_f64().unwrap(), 0.5 * (rows[11] + rows[12]));
    assert_eq!(json["suspects"][0]["parameter"], "cables[1].shortening_offset");
    let change = json["suspects"][0]["confirmed"]["change"].as_f64().unwrap();
    assert!((change + 1.5e-3).abs() < 5e-5, "{change}");
    for (wrong, part) in [
        (&["--prior", "motors[*].stiffness=5000"][..], "needs a mean and a deviation"),
        (&["--bounds", "motors[0].stiffness=1,2"], "is not estimated"),
        (&["--split", "1.5"], "between 0 and 1"),
        (&["--start", "motors[*].stiffness=soft"], "is not a number"),
    ] {
        let message = fail(2, &[&["fit", &file][..], &stiffness, wrong].concat());
        assert!(message.contains(part), "{message}");
    }
}

/// Poses of a tracker's body, made with 1.3 GPa, a frame and a mounting of its own, 0.1 mm and 2 mrad of noise by another program (SciPy's rotations).
const POSES: &str = "\
a [N],b [N],x,y,z,qw,qx,qy,qz
1.9471889,0.8823815,0.3841564,-0.0157890,-0.0937233,0.5836924,0.3011174,0.7267295,0.2012354
1.6765125,2.8117100,0.3469516,-0.0003270,-0.0629210,0.7821585,0.2191313,0.5779634,0.0785359
2.6032189,1.6702375,0.3854286,-0.0012897,-0.0828794,0.6177318,0.2124108,0.7378905,0.1697254
1.8846168,1.2126649,0.3777460,-0.0144199,-0.0874304,0.6243463,0.2909854,0.7019839,0.1809356
0.4917799,2.1923162,0.3303009,-0.0173333,-0.0701968,0.7937462,0.3338582,0.5007890,0.0878408
1.7574365,1.0334212,0.3780198,-0.0171578,-0.0900519,0.6128654,0.3080210,0.7027457,0.1888584
0.3436445,2.5146680,0.3213640,-0.0139337,-0.0665079,0.8255685,0.3233981,0.4580638,0.0634663
1.4059842,2.4093404,0.3476807,-0.0077780,-0.0674660,0.7638676,0.2612263,0.5823002,0.0958835
";

const TRACKED: &str = r#"
[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
[disks]
count = 10
hole_circle_radius = "8 mm"
[[cables]]
name = "a"
routing = { kind = "straight", angle = "0 deg", radius = "8 mm" }
[[cables]]
name = "b"
routing = { kind = "straight", angle = "120 deg", radius = "8 mm" }
[commands]
table = "log.csv"
[measured]
table = "log.csv"
registration = "rigid"
orientation_arm = "50 mm"
[fit]
parameters = ["backbone.young_modulus"]
"#;

#[test]
fn orientations_of_a_tracked_body_are_fitted() {
    let scratch = Scratch::new();
    scratch.write("log.csv", POSES);
    let path = scratch.write("robot.toml", TRACKED);
    let out = scratch.file("out");
    let text = succeed(&["fit", &path, "--out", &out]);
    assert!(text.contains("8 markers, RMS distance") && text.contains("8 orientations"), "{text}");
    assert!(text.contains("measured.body_turn[2]"), "{text}");
    let residuals = std::fs::read_to_string(scratch.path().join("out/residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 1 + 16);
    let json: Value = serde_json::from_str(&succeed(&["fit", &path, "--json"])).unwrap();
    let estimate = json["estimates"][0]["value"].as_f64().unwrap();
    assert!((estimate / 1.3e9 - 1.0).abs() < 5e-3, "{estimate}");
    // Without orientations the frame is found from eight positions alone.
    let plain = TRACKED.replace("orientation_arm = \"50 mm\"\n", "");
    let path = scratch.write("plain.toml", &plain);
    let text = succeed(&["fit", &path]);
    assert!(!text.contains("orientations") && !text.contains("body_turn"), "{text}");
}
