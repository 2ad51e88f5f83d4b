//! Tables of commands and measurements: the example, its score, and what other verbs make of them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use whipcord::{Actuation, Model, ModelKind, Pose, Stations, UnitQuaternion, Vec3};
use whipcord_io::load_with;

use super::support::{fail, root, run, settings, succeed, warned};

const ARM: &str = "examples/motor-log/arm.toml";

/// Numbers without a pattern, the same on every machine.
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn uniform(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal, with mean 0 and standard deviation 1.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (core::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The commands of a log, and what the tracker saw of the simulated robot: `motors.csv` and `tracker.csv`.
fn logs(seed: u64, prefix: &str, rows: usize) -> (String, String) {
    let mut random = Random(seed);
    let mut motors = String::from("run,time (s),pan [deg],tilt [deg],group\n");
    let mut angles = [0.0; 2];
    for row in 0..rows {
        // Each motion goes from its first row to its last in small steps.
        for angle in &mut angles {
            *angle = match row % 8 {
                0 => 90.0 * (random.uniform() - 0.5),
                _ => (*angle + 24.0 * (random.uniform() - 0.5)).clamp(-45.0, 45.0),
            };
            *angle = (*angle * 10.0).round() / 10.0;
        }
        let (number, time, group) = (row + 1, 0.5 * row as f64, row / 8 + 1);
        writeln!(motors, "{prefix}{number},{time},{},{},motion {group}", angles[0], angles[1])
            .unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("motors.csv"), &motors).unwrap();
    let nominal = fs::read_to_string(root().join(ARM)).unwrap();
    let (robot, _) = nominal.split_once("[measured]").unwrap();
    fs::write(folder.path().join("true.toml"), robot).unwrap();
    let truth = [
        "motors.pan.stiffness=14 N/mm",
        "motors.tilt.stiffness=14 N/mm",
        "motors.tilt.angle_offset=3 deg",
    ];
    let truth = truth.map(str::to_owned);
    let file = load_with(folder.path().join("true.toml"), &truth).unwrap();
    let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Natural);
    let answers =
        model.prepare(&file.robot, &file.case.loads).unwrap().solve_all(&file.case).unwrap();
    let frame = Pose {
        position: Vec3::new(0.412, -0.233, 0.871),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -1.1, 0.4)),
    };
    let body = Pose {
        position: Vec3::new(0.0, 0.0, 0.012),
        rotation: UnitQuaternion::exp(Vec3::new(0.0, 0.0, 0.7)),
    };
    let mut tracker = String::from("run,x [mm],y [mm],z [mm],qw,qx,qy,qz\n");
    for (row, answer) in answers.iter().enumerate() {
        let noise = |random: &mut Random, size: f64| {
            Vec3::new(random.normal(), random.normal(), random.normal()) * size
        };
        let seen = frame * (answer.disks.tip() * body);
        let position = (seen.position + noise(&mut random, 0.15e-3)) * 1e3;
        let rotation = seen.rotation * UnitQuaternion::exp(noise(&mut random, 0.004));
        write!(tracker, "{prefix}{}", row + 1).unwrap();
        if random.uniform() < 0.04 {
            // The cameras of the tracker did not see it.
            writeln!(tracker, ",,,,,,,").unwrap();
            continue;
        }
        for value in position.to_array() {
            write!(tracker, ",{value:.2}").unwrap();
        }
        for value in rotation.wxyz() {
            write!(tracker, ",{value:.4}").unwrap();
        }
        tracker.push('\n');
    }
    (motors, tracker)
}

/// Writes the files with UPDATE_EXAMPLES=1.
#[test]
fn the_example_is_what_its_seeds_make() {
    let folder = root().join("examples/motor-log");
    let (motors, tracker) = logs(1, "r", 64);
    let (later_motors, later_tracker) = logs(2, "h", 40);
    for (name, text) in [
        ("motors.csv", motors),
        ("tracker.csv", tracker),
        ("held-out-motors.csv", later_motors),
        ("held-out-tracker.csv", later_tracker),
    ] {
        let path = folder.join(name);
        if std::env::var_os("UPDATE_EXAMPLES").is_some() {
            fs::write(&path, &text).unwrap();
        }
        let found = fs::read_to_string(&path).unwrap();
        assert_eq!(found.lines().count(), text.lines().count());
        for (a, b) in found.lines().zip(text.lines()) {
            let near = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => (a - b).abs() < 0.0101,
                _ => a == b,
            };
            assert!(a.split(',').zip(b.split(',')).all(near), "{name}: {a} {b}");
        }
    }
}

#[test]
fn models_are_scored_row_by_row() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().to_str().unwrap();
    let text = succeed(&["score", ARM, "--out", folder]);
    settings(Some(out.path())).bind(|| insta::assert_snapshot!(text));
    let report = fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(report.len() < 5_000_000 && report.contains("<svg"), "{}", report.len());
    for picture in ["command-1", "command-2", "rows", "worst-1", "worst-3"] {
        assert!(out.path().join(format!("{picture}.svg")).exists(), "{picture}");
    }
    // The same numbers for any number of threads, to the last digit.
    let csv = |threads: &str| {
        succeed(&["score", ARM, "--csv", "--no-figures", "--threads", threads, "--out", folder])
    };
    let (one, three) = (csv("1"), csv("3"));
    assert_eq!(one, three);
    assert!(one.lines().count() > 300 && one.starts_with("file,row,line,key,group,time,model,"));
    assert!(!fs::read_to_string(out.path().join("report.html")).unwrap().contains("<svg"));
}

#[test]
fn a_score_is_a_json_object() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().to_str().unwrap();
    let json = |more: &[&str]| -> serde_json::Value {
        let args =
            ["score", ARM, "--json", "--no-figures", "--model", "cosserat-disks", "--out", folder];
        serde_json::from_str(&succeed(&[&args[..], more].concat())).unwrap()
    };
    let of = json(&["--rows"]);
    let model = &of["models"][0];
    let distance = |key: &str| model["distance"][key].as_f64().unwrap();
    assert!(distance("median") <= distance("percentile_95"));
    assert!(distance("percentile_95") <= distance("worst") && distance("rms") > 5e-4);
    let relative = model["relative"]["rms"].as_f64().unwrap();
    assert!((relative * 0.2 - distance("rms")).abs() < 1e-15);
    let rows = of["files"][0]["models"][0]["rows_scored"].as_array().unwrap();
    assert_eq!(rows.len(), model["rows"].as_u64().unwrap() as usize);
    // The root mean square of one marker in each row is that of the rows.
    let squares: f64 = rows.iter().map(|row| row["error"].as_f64().unwrap().powi(2)).sum();
    assert!(((squares / rows.len() as f64).sqrt() - distance("rms")).abs() < 1e-12);
    // With the numbers with which the logs were simulated, noise alone is left: 0.15 mm in each of three coordinates.
    let truth = [
        "motors.pan.stiffness=14 N/mm",
        "motors.tilt.stiffness=14 N/mm",
        "motors.tilt.angle_offset=3 deg",
        "measured.offset=[0, 0, 0.012]",
    ];
    let truth: Vec<&str> = truth.iter().flat_map(|text| ["--set", text]).collect();
    let of = json(&truth);
    let noise = of["models"][0]["distance"]["rms"].as_f64().unwrap();
    assert!((0.2e-3..0.3e-3).contains(&noise), "{noise}");
    let angle = of["models"][0]["angle"]["rms"].as_f64().unwrap();
    assert!((0.005..0.009).contains(&angle), "{angle}");
}

/// A tracker whose x points the other way: no rigid motion brings what it saw onto the robot.
#[test]
fn a_left_handed_frame_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str| root().join("examples/motor-log").join(name);
    for name in ["arm.toml", "motors.csv"] {
        fs::copy(of(name), folder.path().join(name)).unwrap();
    }
    let table = fs::read_to_string(of("tracker.csv")).unwrap();
    let mut mirrored = String::from("run,x [mm],y [mm],z [mm]\n");
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let x = cells[1].parse::<f64>().map_or_else(|_| String::new(), |x| (-x).to_string());
        writeln!(mirrored, "{},{x},{},{}", cells[0], cells[2], cells[3]).unwrap();
    }
    fs::write(folder.path().join("tracker.csv"), mirrored).unwrap();
    let arm = folder.path().join("arm.toml");
    let out = folder.path().join("out");
    let [arm, out] = [&arm, &out].map(|path| path.to_str().unwrap());
    let common = ["--no-figures", "--out", out];
    let text = succeed(&[&["score", arm], &common[..]].concat());
    assert!(text.contains("if one of its axes is reversed"), "{text}");
    let object = succeed(&[&["score", arm, "--json"], &common[..]].concat());
    assert!(object.contains("\"mirrored-frame\""), "{object}");
    let fit = ["fit", arm, "--parameter", "motors[*].stiffness", "--out", out];
    let (_, told) = warned(&fit);
    assert!(told.contains("its frame is left-handed, or two columns are swapped"), "{told}");
    // The example itself is right-handed.
    let right = succeed(&[&["score", of("arm.toml").to_str().unwrap()], &common[..]].concat());
    assert!(!right.contains("reversed"), "{right}");
}

#[test]
fn rows_without_an_answer_are_counted_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "arm.toml",
        "title = \"Arm\"\n[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 4\n[[cables]]\nname = \"pull\"\nholes = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n[commands]\ntable = \"rows.csv\"\nkey = \"run\"\n[measured]\ntable = \"tip.csv\"\n",
    );
    // The second row is more than the section bears.
    write("rows.csv", "run,pull [N],measured\na,1,1\nb,100000,1\nc,2,0\nd,3,1\ne,4,1\nf,5,1\n");
    write("tip.csv", "run,x,y,z\na,0.02,0,0.18\nb,0,0,0.18\nd,0.08,0,0.15\ne,0.1,0.01,0.13\n");
    let out = out.to_str().unwrap();
    let file = folder.path().join("arm.toml");
    let file = file.to_str().unwrap();
    let args = ["score", file, "--model", "cosserat", "--model", "four-bar", "--out", out];
    let run = run(&args);
    assert_eq!(run.status, 0, "{}", run.stderr);
    settings(Some(folder.path())).bind(|| insta::assert_snapshot!(run.stdout));
}

#[test]
fn a_file_without_positions_has_no_score() {
    let out = tempfile::tempdir().unwrap();
    let message =
        fail(2, &["score", "examples/soft-finger.toml", "--out", out.path().to_str().unwrap()]);
    assert!(message.contains("nothing was measured in space: add [measured]"), "{message}");
    assert!(!Path::new("whipcord-score").exists());
}

#[test]
fn other_verbs_take_rows_as_steps() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().to_str().unwrap();
    let steps = succeed(&["solve", ARM, "--csv"]);
    assert!(
        steps.starts_with("step,") && steps.lines().last().unwrap().starts_with("64,"),
        "{steps}"
    );
    let compared = succeed(&[
        "compare",
        ARM,
        "--model",
        "cosserat-disks",
        "--model",
        "cosserat",
        "--out",
        folder,
    ]);
    assert!(
        compared.contains("Against the measurements") && compared.contains("worst row"),
        "{compared}"
    );
    // With the pictures of a score.
    let report = fs::read_to_string(out.path().join("report.html")).unwrap();
    for (picture, caption) in [
        ("command-1", "Error against command"),
        ("rows", "Error of each row"),
        ("worst-1", "cosserat-disks"),
    ] {
        assert!(out.path().join(format!("measured-{picture}.svg")).exists(), "{picture}");
        assert!(report.contains(caption), "{caption}");
    }
    let json = succeed(&["compare", ARM, "--model", "cosserat-disks", "--json", "--out", folder]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json["score"]["models"][0]["distance"]["rms"].as_f64().unwrap() > 5e-4);
}

/// A tracker that jumps in three rows tilts the motion of the others by nothing.
#[test]
fn jumps_of_a_tracker_count_less() {
    let out = tempfile::tempdir().unwrap();
    let seen = fs::read_to_string(root().join("examples/motor-log/tracker.csv")).unwrap();
    let jumped: Vec<String> = seen
        .lines()
        .map(|line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if ["r9", "r20", "r47"].contains(&cells[0].as_str()) {
                let x: f64 = cells[1].parse().unwrap();
                cells[1] = format!("{:.2}", x + 60.0);
            }
            cells.join(",")
        })
        .collect();
    let path = out.path().join("jumped.csv");
    fs::write(&path, jumped.join("\n")).unwrap();
    let folder = out.path().join("score");
    let of = |more: &[&str]| {
        let mut args = vec!["score", ARM, "--model", "cosserat-disks", "--no-figures"];
        args.extend(["--out", folder.to_str().unwrap()]);
        args.extend(more);
        succeed(&args)
    };
    let set = format!("measured.table={}", path.display());
    let model = |text: &str| {
        let json: serde_json::Value = serde_json::from_str(text).unwrap();
        json["files"][0]["models"][0].clone()
    };
    let (clean, tilted) =
        (model(&of(&["--json"])), model(&of(&["--json", "--rows", "--set", &set])));
    assert_eq!(
        (clean["down_weighted"].as_u64(), tilted["down_weighted"].as_u64()),
        (Some(0), Some(3))
    );
    let rows = tilted["rows_scored"].as_array().unwrap().iter();
    let named =
        rows.filter(|row| row["down_weighted"] == true).map(|row| row["key"].as_str().unwrap());
    assert_eq!(named.collect::<Vec<_>>(), ["r9", "r20", "r47"]);
    let median = |of: &serde_json::Value| of["distance"]["median"].as_f64().unwrap();
    assert!((median(&tilted) / median(&clean) - 1.0).abs() < 0.05, "{clean} {tilted}");
    assert!(tilted["distance"]["rms"].as_f64().unwrap() > 10.0 * median(&clean));
    let text = of(&["--set", &set]);
    assert!(text.contains("rows that count less in this motion"), "{text}");
    assert!(text.contains("cosserat-disks 3 (r9, …)"), "{text}");
}

#[test]
fn a_log_calibrates_the_robot_and_scores_another_log() {
    let out = tempfile::tempdir().unwrap();
    let fitted = out.path().join("calibrated.toml");
    let mut args = vec!["fit", ARM, "--model", "cosserat-disks", "-o", fitted.to_str().unwrap()];
    let shared = [
        "motors[*].stiffness",
        "motors[0].angle_offset",
        "motors[1].angle_offset",
        "measured.offset[2]",
    ];
    args.extend(shared.iter().flat_map(|path| ["--parameter", path]));
    let base =
        [0, 1, 2].map(|axis| [format!("base.position[{axis}]"), format!("base.turn[{axis}]")]);
    args.extend(base.iter().flatten().flat_map(|path| ["--each", path]));
    let text = succeed(&args);
    assert!(text.contains("fitted: ") && !text.contains("written anew"), "{text}");
    let text = fs::read_to_string(&fitted).unwrap();
    assert!(
        text.contains("key = \"run\"")
            && text.contains("motors.csv")
            && text.contains("angle_offset"),
        "{text}"
    );
    let folder = out.path().join("score");
    let json = succeed(&[
        "score",
        fitted.to_str().unwrap(),
        "--model",
        "cosserat-disks",
        "--json",
        "--no-figures",
        "--set",
        "commands.table=examples/motor-log/held-out-motors.csv",
        "--set",
        "measured.table=examples/motor-log/held-out-tracker.csv",
        "--set",
        "measured.offset=[0, 0, 0.012]",
        "--out",
        folder.to_str().unwrap(),
    ]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    // The noise of the tracker: 0.15 mm in each coordinate, 0.26 mm in space.
    let error = json["models"][0]["distance"]["rms"].as_f64().unwrap();
    assert!((0.2e-3..0.3e-3).contains(&error), "{error}");
}

/// The mounting that was estimated is written, so that the file scores as the fit says.
#[test]
fn a_fitted_file_has_the_mounting_of_the_tracked_body() {
    let out = tempfile::tempdir().unwrap();
    let source = root().join("examples/motor-log");
    for name in ["motors.csv", "tracker.csv"] {
        fs::copy(source.join(name), out.path().join(name)).unwrap();
    }
    let arm = fs::read_to_string(source.join("arm.toml")).unwrap();
    let text = |rotation: &str| format!("{arm}orientation_arm = \"40 mm\"\n{rotation}");
    let folder = out.path().join("score");
    for rotation in ["", "rotation = { axis = [0, 0, 1], angle = \"10 deg\" }\n"] {
        fs::write(out.path().join("arm.toml"), text(rotation)).unwrap();
        let (file, fitted) = (out.path().join("arm.toml"), out.path().join("fitted.toml"));
        let mut args = vec!["fit", file.to_str().unwrap(), "--model", "cosserat-disks", "--json"];
        args.extend(["--parameter", "motors[*].stiffness", "--parameter", "measured.offset[2]"]);
        args.extend(["-o", fitted.to_str().unwrap()]);
        for axis in ["measured.body_turn[0]", "measured.body_turn[1]", "measured.body_turn[2]"] {
            args.extend(["--parameter", axis]);
        }
        let found: serde_json::Value = serde_json::from_str(&warned(&args).0).unwrap();
        let written = fs::read_to_string(&fitted).unwrap();
        let key = if rotation.is_empty() { "orientation = [" } else { "rotation = { axis = [" };
        assert!(written.contains(key), "{written}");
        let score = |path: &Path| -> serde_json::Value {
            let args = ["score", path.to_str().unwrap(), "--model", "cosserat-disks", "--json"];
            let more = ["--no-figures", "--out", folder.to_str().unwrap()];
            serde_json::from_str(&succeed(&[&args[..], &more].concat())).unwrap()
        };
        let after = score(&fitted);
        let of = |score: &serde_json::Value, what: &str| {
            score["models"][0][what]["rms"].as_f64().unwrap()
        };
        // A score moves the measurement by the positions alone, the fit by orientations too.
        let expected = found["rms_distance"].as_f64().unwrap();
        assert!((of(&after, "distance") / expected - 1.0).abs() < 0.01, "{rotation}");
        assert!(of(&after, "angle") < 0.009, "{}", of(&after, "angle"));
        if !rotation.is_empty() {
            assert!(of(&score(&file), "angle") > 0.3);
        }
    }
}
