//! `whipcord reach`.

use serde_json::Value;

use crate::support::{Scratch, fail, robot, root, run, settings, succeed, warned};

const ARM: &str = "examples/reaching-arm.toml";
const THREE: &str = "examples/three-cable-segment.toml";

fn json(args: &[&str]) -> Value {
    serde_json::from_str(&warned(args).0).unwrap()
}

#[test]
fn the_answer_is_for_people() {
    let mut settings = settings(None);
    // How a search comes to its answer is its own business.
    settings.add_filter(r"\d+ starts?, \d+ solves?", "[n] starts, [n] solves");
    settings.add_filter(r"error +[0-9.e-]+", "error  [rounding]");
    settings.bind(|| {
        insta::assert_snapshot!("arm", succeed(&["reach", ARM]));
        let beyond = ["reach", THREE, "--tip", "0, 0, 140 mm"];
        insta::assert_snapshot!("not_reached", fail(1, &beyond));
        let limits = "limits.tension=[\"0 N\", \"8 N\"]";
        let proven = [&beyond[..], &["--prove", "--set", limits]].concat();
        insta::assert_snapshot!("proven", fail(1, &proven));
    });
}

#[test]
fn json_is_one_object_in_si() {
    let object = json(&["reach", ARM, "--json"]);
    let keys: Vec<&String> = object.as_object().unwrap().keys().collect();
    let expected = [
        "title",
        "model",
        "status",
        "tensions",
        "lengths",
        "motors",
        "error",
        "error_angle",
        "lower_bound",
        "no_proof",
        "active_limits",
        "null_space",
        "starts",
        "solves",
        "commands",
        "tolerance",
        "tolerance_angle",
        "search_ranges",
        "solution",
        "warnings",
    ];
    assert_eq!(keys, expected);
    assert_eq!((&object["status"], &object["model"]), (&"reached".into(), &"cosserat".into()));
    let tip = &object["solution"]["disks"].as_array().unwrap().last().unwrap()["position"];
    let squares = [0.06, 0.03, 0.28].iter().enumerate();
    let error = squares.map(|(k, x)| (tip[k].as_f64().unwrap() - x).powi(2)).sum::<f64>().sqrt();
    assert!(error <= 1e-4 && (error - object["error"].as_f64().unwrap()).abs() < 1e-9);
    for tension in object["tensions"].as_array().unwrap() {
        assert!((0.5..=40.0).contains(&tension.as_f64().unwrap()), "{tension}");
    }
    assert_eq!(object["null_space"].as_array().unwrap().len(), 3);
    assert_eq!(object["search_ranges"][0]["assumed"], serde_json::json!([false, false]));
}

/// A target that is a solved tip is reached, whatever is commanded and by every model that takes the robot.
#[test]
fn the_tip_of_a_solve_is_reached_by_every_model() {
    let models = [
        "cosserat",
        "cosserat-disks",
        "piecewise-constant-curvature",
        "pseudo-rigid-body",
        "four-bar",
    ];
    for model in models {
        for by in ["tensions", "lengths"] {
            if model == "four-bar" && by == "tensions" {
                continue;
            }
            let solved = json(&["solve", THREE, "--json", "--model", model]);
            let tip = solved["disks"].as_array().unwrap().last().unwrap()["position"].clone();
            let tip = [0, 1, 2].map(|k| tip[k].to_string()).join(",");
            let args = ["reach", THREE, "--json", "--model", model, "--by", by, "--tip", &tip];
            let run = run(&args);
            assert_eq!(run.status, 0, "{model} by {by}: {}", run.stderr);
        }
    }
}

#[test]
fn the_file_that_is_written_has_the_answer() {
    let scratch = Scratch::new();
    let new = scratch.file("new.toml");
    let text = succeed(&["reach", THREE, "--axis", "1,0,1", "-o", &new]);
    assert!(text.ends_with(&format!("written: {new}\n")), "{text}");
    // Comments and units are kept, and both commands of each cable agree.
    let written = std::fs::read_to_string(&new).unwrap();
    assert!(
        written.contains("# The usual continuum segment") && written.contains(" mm\""),
        "{written}"
    );
    for actuation in ["tension", "shortening"] {
        let solved = json(&["solve", &new, "--json", "--actuation", actuation]);
        let tip = solved["disks"].as_array().unwrap().last().unwrap().clone();
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| tip["orientation"][k].as_f64().unwrap());
        // The third column of the rotation is along (1, 0, 1).
        let axis = [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)];
        let half = 0.5_f64.sqrt();
        assert!((axis[0] - half).abs() < 1e-6 && axis[1].abs() < 1e-6, "{actuation}: {axis:?}");
    }
    // The target stays in the file that is written, and so do the limits.
    let new = scratch.file("arm.toml");
    succeed(&["reach", ARM, "-o", &new]);
    let again = json(&["reach", &new, "--json"]);
    assert_eq!(again["status"], "reached");
    let message = fail(2, &["reach", THREE, "--axis", "1,0,1", "-o", THREE]);
    assert!(message.contains("three-cable-segment.toml"), "{message}");
}

#[test]
fn a_path_is_followed_and_jumps_are_told_of() {
    let scratch = Scratch::new();
    let mut rows = String::from("t [s],x [mm],y [mm],z [mm]\n");
    for k in 0..7 {
        let angle = f64::from(k) * core::f64::consts::TAU / 12.0;
        rows += &format!("{},{},{},285\n", 3 * k, 40.0 * angle.cos(), 40.0 * angle.sin());
    }
    let path = scratch.write("path.csv", &rows);
    let object = json(&["reach", ARM, "--path", &path, "--json"]);
    assert_eq!((&object["reached"], &object["jumps"]), (&7.into(), &serde_json::json!([])));
    let points = object["points"].as_array().unwrap();
    for pair in points.windows(2) {
        let tension = |point: &Value, k: usize| point["tensions"][k].as_f64().unwrap();
        // Three seconds at 10 N/s.
        assert!((0..6).all(|k| (tension(&pair[1], k) - tension(&pair[0], k)).abs() <= 30.0 + 1e-9));
    }
    let text = succeed(&["reach", ARM, "--path", &path]);
    assert!(text.contains("cosserat: 7 of 7 points reached"), "{text}");
    // In a hundredth of the time it is not.
    let hurried = scratch.write("hurried.csv", &rows.replace("t [s]", "t [ms]"));
    let message = fail(1, &["reach", ARM, "--path", &hurried]);
    assert!(message.contains("points of the path are not reached"), "{message}");
    let nearest = run(&["reach", ARM, "--path", &hurried, "--nearest"]);
    assert!(nearest.status == 0 && nearest.stdout.contains("not reached"), "{}", nearest.stderr);
    let message = fail(2, &["reach", ARM, "--path", &path, "-o", "new.toml"]);
    assert!(message.contains(".csv, .parquet or .json"), "{message}");
    let message = fail(
        2,
        &["reach", ARM, "--path", &scratch.write("back.csv", "t,x,y,z\n1,0,0,0.3\n1,0,0,0.3\n")],
    );
    assert!(message.contains("back.csv:3:1: error: the times do not ascend"), "{message}");
}

#[test]
fn shapes_and_poses_are_reached() {
    let scratch = Scratch::new();
    let solved = json(&["solve", THREE, "--json"]);
    let disks = solved["disks"].as_array().unwrap();
    let mut rows = String::from("disk,x,y,z\n");
    for disk in [3, 6, 10] {
        let [x, y, z] = [0, 1, 2].map(|k| disks[disk]["position"][k].to_string());
        rows += &format!("{},{x},{y},{z}\n", disk + 1);
    }
    let shape = scratch.write("shape.csv", &rows);
    let picture = scratch.file("shape.svg");
    let text = succeed(&["reach", THREE, "--shape", &shape, "--plot", &picture]);
    assert!(text.contains("3 disks"), "{text}");
    let drawn = std::fs::read_to_string(&picture).unwrap();
    assert!(drawn.contains("target"), "{drawn}");
    let tip = &disks[10];
    let numbers = |key: &str, count: usize| {
        (0..count).map(|k| tip[key][k].to_string()).collect::<Vec<_>>().join(",")
    };
    let pose = format!("{},{}", numbers("position", 3), numbers("orientation", 4));
    assert!(succeed(&["reach", THREE, "--pose", &pose]).contains("the target is reached"));
}

#[test]
fn what_cannot_be_asked_is_said() {
    let scratch = Scratch::new();
    let bare = scratch.write("bare.toml", &robot("tension = \"2 N\""));
    for (args, words) in [
        (&["reach", &bare][..], "there is no target: add [target]"),
        (&["reach", &bare, "--tip", "1,2"], "2 values are given"),
        (&["reach", &bare, "--tip", "nan,0,0"], "is not a finite number"),
        (&["reach", &bare, "--axis", "0,0,0"], "the direction has the length zero"),
        (&["reach", &bare, "--pose", "0,0,0,0,0,0,0"], "the quaternion is zero"),
        (&["reach", &bare, "--tip", "0,0,0.1", "--pose", "0,0,0,1,0,0,0"], "cannot be used with"),
        (&["reach", &bare, "--tip", "0,0,0.1", "--by", "motors"], "the robot has no motors"),
        (&["reach", &bare, "--tip", "0,0,0.1", "--tolerance", "0"], "more than zero"),
        (&["reach", &bare, "--tip", "0,0,0.1", "--starts", "1000000000"], "is not in 0..=20000"),
        (
            &["reach", &bare, "--tip", "0,0,0.1", "--objective", "as-printed"],
            "an option of four-bar",
        ),
        (&["reach", &bare, "--tip", "0,0,0.1", "--set", "limits.rate=5 mm/s"], "give it in N/s"),
        (&["reach", &bare, "--shape", "nothing.csv"], "there is no such file"),
    ] {
        let message = fail(2, args);
        assert!(message.contains(words), "{args:?}: {message}");
    }
    let loose = scratch
        .write("loose.toml", "[backbone]\nlength = 0.1\ndiameter = 0.001\n[disks]\ncount = 3\n");
    let message = fail(2, &["reach", &loose, "--tip", "0,0,0.1"]);
    assert!(message.contains("the robot has no cables"), "{message}");
    let message = fail(1, &["reach", &bare, "--tip", "0,0,100"]);
    assert!(
        message.contains("the target is 100000 mm from the base")
            && message.contains("check its unit"),
        "{message}"
    );
}

/// The commands of a path are a table that a robot file takes its steps from: they lead along the path without it.
#[test]
fn the_commands_of_a_path_are_played_back() {
    let scratch = Scratch::new();
    let [csv, parquet, object, plot] =
        ["c.csv", "c.parquet", "c.json", "p.svg"].map(|name| scratch.file(name));
    let letter = "examples/letter/arm.toml";
    let text = succeed(&["reach", letter, "-o", &csv, "--plot", &plot]);
    assert!(text.contains("49 of 49 points reached"), "{text}");
    assert!(text.contains("commands: ") && text.contains("picture: "));
    for format in [&parquet, &object] {
        succeed(&["reach", letter, "-o", format]);
    }
    let table = std::fs::read_to_string(&csv).unwrap();
    let head = "time,upper-pan.angle,upper-tilt.angle,lower-pan.angle,lower-tilt.angle";
    assert_eq!((table.lines().next(), table.lines().count()), (Some(head), 50));
    let json: Value = serde_json::from_str(&std::fs::read_to_string(&object).unwrap()).unwrap();
    assert_eq!(json["points"].as_array().unwrap().len(), 49);
    assert!(std::fs::read_to_string(&plot).unwrap().contains("cosserat, 9.6 s"));
    // A film of three points.
    let short = "t,x,y,z\n0,0.02,0,0.29\n0.1,0.021,0,0.29\n0.2,0.022,0,0.29\n";
    let (short, film) = (scratch.write("short.csv", short), scratch.file("f.png"));
    succeed(&["reach", letter, "--path", &short, "--film", &film]);
    let pictures = std::fs::read(&film).unwrap().windows(4).filter(|w| *w == b"fcTL").count();
    assert_eq!(pictures, 3);
    for name in ["c.csv", "c.parquet"] {
        // The table gives the angles in place of the file.
        let robot = std::fs::read_to_string(root().join(letter)).unwrap();
        let robot = robot.replace("angle = \"0 deg\"\n", "");
        let robot = robot.split("[target]").next().unwrap();
        let play = format!("{robot}[commands]\ntable = \"{name}\"\neach = \"in order\"\n");
        let file = scratch.file("play.toml");
        std::fs::write(&file, play).unwrap();
        let solved: Value = serde_json::from_str(&succeed(&["solve", &file, "--json"])).unwrap();
        let tip = &solved["disks"].as_array().unwrap().last().unwrap()["position"];
        for (k, end) in [0.036, 0.024, 0.285].into_iter().enumerate() {
            assert!((tip[k].as_f64().unwrap() - end).abs() < 6e-5, "{tip}");
        }
    }
}

#[test]
fn files_that_do_not_fit_are_refused() {
    let scratch = Scratch::new();
    let out = scratch.file("c.toml");
    let letter = "examples/letter/arm.toml";
    assert!(fail(2, &["reach", letter, "-o", &out]).contains(".csv, .parquet or .json"));
    let film = scratch.file("f.png");
    assert!(fail(2, &["reach", ARM, "--film", &film]).contains("--film is for a path"));
    assert!(!std::path::Path::new(&film).exists());
}

#[test]
fn shapes_to_start_from_are_kept_in_a_file() {
    let scratch = Scratch::new();
    let atlas = scratch.path().join("atlas.parquet");
    let atlas = atlas.to_str().unwrap();
    let first = succeed(&["reach", ARM, "--atlas", atlas]);
    let kept = std::fs::read(atlas).unwrap();
    assert_eq!(succeed(&["reach", ARM, "--atlas", atlas]), first);
    assert_eq!(std::fs::read(atlas).unwrap(), kept);
    let other = scratch.write("other.parquet", "a letter");
    let refused = fail(2, &["reach", ARM, "--atlas", &other]);
    assert!(refused.contains("is no atlas (it is not a Parquet file)"), "{refused}");
}
