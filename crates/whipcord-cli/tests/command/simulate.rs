//! `whipcord simulate`.

use serde_json::Value;

use crate::support::{Scratch, command, fail, succeed};

const ARM: &str = "examples/released-arm.toml";
const SHORT: [&str; 2] = ["--set", "motion.duration=\"0.3 s\""];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_released_arm_swings_and_its_energy_is_balanced() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let args = ["simulate", ARM, SHORT[0], SHORT[1], "--out", &out, "--plot", "--parquet"];
    let summary = succeed(&args);
    assert!(summary.contains("motion of cosserat, accurate"), "{summary}");
    // Lengths of the summary are in mm.
    assert!(summary.contains("tip at (122.34, 0.00, 262.39) mm"), "{summary}");
    let folder = scratch.path().join("out");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("motion.json")).unwrap();
    let states = json["states"].as_array().unwrap();
    // At 0, 10, … 300 ms.
    assert_eq!(states.len(), 31);
    assert!((number(&states[30]["time"]) - 0.3).abs() < 1e-12);
    let tip =
        |state: &Value| number(&state["poses"].as_array().unwrap().last().unwrap()["position"][0]);
    let first = tip(&states[0]);
    // Bent towards the pulled cable, then past the middle to the other side.
    assert!(first > 0.005, "{first}");
    assert!(states.iter().any(|state| tip(state) < -0.2 * first));
    let held = &states[0]["cables"][0]["tension"];
    assert!((number(held) - 4.0).abs() < 1e-12 || number(held) == 0.0, "{held}");
    assert_eq!(number(&states[5]["cables"][0]["tension"]), 0.0);
    // What the material takes is what is lacking, and nothing else.
    let energy = |state: &Value, name: &str| number(&state["energy"][name]);
    let start = energy(&states[0], "elastic").abs();
    let last = states.last().unwrap();
    assert!(energy(last, "dissipated") > 0.0);
    assert!(energy(last, "defect").abs() < 0.02 * start, "{last}");
    assert_eq!(read("motion.csv").lines().count(), 32);
    let nodes = states[0]["poses"].as_array().unwrap().len();
    assert_eq!(read("poses.csv").lines().count(), 1 + 31 * nodes);
    for name in ["tip", "tensions", "energy"] {
        for ending in ["svg", "png"] {
            assert!(folder.join(format!("{name}.{ending}")).exists(), "{name}.{ending}");
        }
    }
    for name in ["motion.parquet", "poses.parquet"] {
        assert!(std::fs::read(folder.join(name)).unwrap().starts_with(b"PAR1"), "{name}");
    }
}

#[test]
fn json_and_csv_are_those_of_the_folder() {
    let json: Value =
        serde_json::from_str(&succeed(&["simulate", ARM, SHORT[0], SHORT[1], "--json"])).unwrap();
    assert_eq!(json["status"], "converged");
    let csv = succeed(&["simulate", ARM, SHORT[0], SHORT[1], "--csv"]);
    let rows: Vec<&str> = csv.lines().collect();
    assert!(rows[0].starts_with("t [s],tip_x [m],tip_y [m],tip_z [m]"), "{}", rows[0]);
    let state = &json["states"][7];
    let tip = number(&state["poses"].as_array().unwrap().last().unwrap()["position"][0]);
    let cell: f64 = rows[8].split(',').nth(1).unwrap().parse().unwrap();
    assert!((cell - tip).abs() <= 1e-12 * tip.abs().max(1e-3));
}

/// The three methods agree where the steps are short.
#[test]
fn the_methods_agree() {
    let tip = |method: &str| {
        let method = format!("motion.method={method:?}");
        let text = succeed(&[
            "simulate",
            ARM,
            "--set",
            "motion.duration=\"50 ms\"",
            "--set",
            "motion.step=\"0.5 ms\"",
            "--set",
            &method,
            "--json",
        ]);
        let json: Value = serde_json::from_str(&text).unwrap();
        let last = json["states"].as_array().unwrap().last().unwrap().clone();
        let position = last["poses"].as_array().unwrap().last().unwrap()["position"].clone();
        [0, 1, 2].map(|i| number(&position[i]))
    };
    let accurate = tip("accurate");
    for method in ["energy", "robust"] {
        let of = tip(method);
        let off = (0..3).map(|i| (of[i] - accurate[i]).powi(2)).sum::<f64>().sqrt();
        assert!(off < 3e-3 * 0.3, "{method}: {off}");
    }
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    assert!(fail(2, &["simulate", "examples/three-cable-segment.toml"]).contains("[motion]"));
    assert!(fail(2, &["simulate", ARM, "--plot"]).contains("--out"));
    let method = ["simulate", ARM, "--set", "motion.method=\"magic\""];
    assert!(fail(2, &method).contains("accurate"));
    // A row that cannot be read is reported once.
    let row = r#"motion.loads=[{ tip_force = ["1 N", 0, 0], factor = [["0 s", 1], ["x", 2]] }]"#;
    let error = fail(2, &["simulate", ARM, "--set", row]);
    assert_eq!(error.matches("error: ").count(), 1, "{error}");
}

/// With cables straight from disk to disk the motion starts in the equilibrium of that model, and so it is marked in every output.
#[test]
fn cables_may_be_straight_between_disks() {
    let value = |args: &[&str]| -> Value { serde_json::from_str(&succeed(args)).unwrap() };
    let tip = |poses: &Value| {
        let position = &poses.as_array().unwrap().last().unwrap()["position"];
        [0, 1, 2].map(|i| number(&position[i]))
    };
    let off = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    let straight = ["--model", "cosserat-disks"];
    let motion =
        ["simulate", ARM, "--set", "motion.duration=\"20 ms\"", "--set", "motion.elements=40"];
    let of_file = ["--set", "motion.model=\"cosserat-disks\"", "--json"];
    let moved = value(&[&motion[..], &straight, &["--json"]].concat());
    assert_eq!(moved["model"], "cosserat-disks");
    assert_eq!(moved["states"], value(&[&motion[..], &of_file].concat())["states"]);
    let summary = succeed(&[&motion[..], &straight].concat());
    assert!(summary.contains("motion of cosserat-disks, accurate"), "{summary}");
    let held = ["solve", ARM, "--set", "cables.left.tension=\"4 N\"", "--json"];
    let still = value(&[&held[..], &straight].concat());
    let start = tip(&moved["states"][0]["poses"]);
    let position = still["shape"]["position"].as_array().unwrap().last().unwrap();
    let of_statics = [0, 1, 2].map(|i| number(&position[i]));
    assert!(off(start, of_statics) < 1e-6 * 0.3, "{start:?} {of_statics:?}");
    let smooth = value(&[&motion[..], &["--json"]].concat());
    assert!(off(start, tip(&smooth["states"][0]["poses"])) > 1e-5);
    let frequency = |args: &[&str]| {
        let pulled = ["modes", ARM, "--set", "cables.left.tension=\"4 N\"", "--json"];
        let modes = value(&[&pulled[..], args].concat());
        number(&modes["modes"][0]["frequency"])
    };
    let (straight, smooth) = (frequency(&straight), frequency(&[]));
    assert!(straight != smooth && (straight / smooth - 1.0).abs() < 0.05, "{straight} {smooth}");
    fail(2, &[&motion[..], &["--model", "four-bar"]].concat());
}

#[test]
fn a_film_has_its_pictures_and_a_motion_goes_on_from_another() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let duration = "motion.duration=\"60 ms\"";
    let first = ["simulate", ARM, "--set", duration, "--out", &out, "--film", "--frames"];
    succeed(&first);
    let folder = scratch.path().join("out");
    let film = std::fs::read(folder.join("film.png")).unwrap();
    // An animated PNG says how many pictures it has.
    assert!(film.windows(4).any(|four| four == b"acTL"));
    assert_eq!(std::fs::read_dir(folder.join("frames")).unwrap().count(), 7);
    let initial = format!("motion.initial={:?}", folder.join("motion.json"));
    let on: Value = serde_json::from_str(&succeed(&[
        "simulate", ARM, "--set", duration, "--set", &initial, "--json",
    ]))
    .unwrap();
    let before: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("motion.json")).unwrap())
            .unwrap();
    let strains = |motion: &Value, k: usize| motion["states"][k]["strains"].clone();
    assert_eq!(strains(&on, 0), strains(&before, 6));
    assert_ne!(strains(&on, 1), strains(&before, 1));
}

/// An arm whose cable rubs falls on a ball; with a motor with inertia it is pulled; and a motion goes on from the last state of another one, as that would have.
#[test]
fn cables_rub_among_obstacles_and_on_motors() {
    let scratch = Scratch::new();
    let file = "examples/contact/falling-arm.toml";
    let rubs = "cables.up.friction=0.4";
    let json = |args: &[&str]| -> Value { serde_json::from_str(&succeed(args)).unwrap() };
    let fallen = json(&["simulate", file, "--set", rubs, "--json"]);
    let last = fallen["states"].as_array().unwrap().last().unwrap();
    assert_eq!(last["contacts"][0]["name"], "ball");
    assert!(last["cables"][0]["passage_tensions"].as_array().unwrap().len() > 5);
    let text = "[backbone]\nlength = \"200 mm\"\ndiameter = \"4 mm\"\nyoung_modulus = \"1 GPa\"\npoisson_ratio = 0.3\ndensity = \"1200 kg/m^3\"\n\
                damping = { time = \"5 ms\" }\n[[cables]]\nname = \"a\"\nfriction = 0.3\nrouting = { kind = \"straight\", angle = 0, radius = \"10 mm\" }\n\
                [[motors]]\nname = \"m\"\ncables = [\"a\"]\nspool_radius = \"10 mm\"\nstiffness = \"2 N/mm\"\ninertia = \"200 g*cm^2\"\n\
                proportional_gain = \"0.5 N*m/rad\"\nderivative_gain = \"4 mN*m*s/rad\"\n\
                [motion]\nduration = \"0.25 s\"\nstep = \"0.0078125 s\"\n[[motion.commands]]\nmotor = \"m\"\nangle = \"40 deg\"\n";
    let file = scratch.write("arm.toml", text);
    let (out, rest) = (scratch.file("out"), "motion.initial=\"rest\"");
    succeed(&["simulate", &file, "--set", rest, "--out", &out]);
    let initial = format!("motion.initial={:?}", scratch.path().join("out/motion.json"));
    let on = json(&["simulate", &file, "--set", &initial, "--json"]);
    let whole =
        json(&["simulate", &file, "--set", rest, "--set", "motion.duration=\"0.5 s\"", "--json"]);
    let ends = [&on, &whole].map(|of| of["states"].as_array().unwrap().last().unwrap().clone());
    for key in ["strains", "velocities", "cables", "motors", "poses"] {
        assert_eq!(ends[0][key], ends[1][key], "{key}");
    }
    assert!(number(&ends[0]["energy"]["dissipated"]) > 0.0);
}

/// The arm comes to rest on the ball: the forces of its contacts are those of the statics, in every output.
#[test]
fn an_arm_falls_on_a_ball_and_rests_there() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let file = "examples/contact/falling-arm.toml";
    let summary = succeed(&["simulate", file, "--out", &out, "--plot", "--parquet"]);
    assert!(summary.contains("touched first") && summary.contains("from obstacles"), "{summary}");
    let folder = scratch.path().join("out");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("motion.json")).unwrap();
    let states = json["states"].as_array().unwrap();
    assert!(states[0]["contacts"].as_array().unwrap().is_empty());
    let last = states.last().unwrap();
    let force = |of: &Value| {
        let contacts = of["contacts"].as_array().unwrap();
        contacts.iter().map(|contact| number(&contact["force"])).sum::<f64>()
    };
    let still: Value =
        serde_json::from_str(&succeed(&["solve", file, "--model", "cosserat", "--json"])).unwrap();
    // Where friction holds depends on the way there.
    assert!((force(last) / force(&still) - 1.0).abs() < 0.3, "{} {}", force(last), force(&still));
    assert_eq!(last["contacts"][0]["name"], "ball");
    assert!(number(&last["energy"]["contacts"]) < 0.0);
    let table = read("contacts.csv");
    let touching: usize =
        states.iter().map(|state| state["contacts"].as_array().unwrap().len()).sum();
    assert_eq!(table.lines().count(), 1 + touching);
    assert!(read("motion.csv").lines().next().unwrap().contains("contact_force [N]"));
    assert!(folder.join("contacts.parquet").exists());
}

/// A motor with inertia: its angle, torque and energies in every output, and a motion that goes on from where it ended.
#[test]
fn a_motor_with_inertia_follows_its_command() {
    let scratch = Scratch::new();
    let motor = |more: &str| {
        format!(
            "[backbone]\nlength = \"200 mm\"\ndiameter = \"4 mm\"\nyoung_modulus = \"1 GPa\"\npoisson_ratio = 0.3\ndensity = \"1200 kg/m^3\"\n\
             damping = {{ time = \"5 ms\" }}\n[[cables]]\nname = \"a\"\nrouting = {{ kind = \"straight\", angle = 0, radius = \"10 mm\" }}\n\
             [[motors]]\nname = \"m\"\ncables = [\"a\"]\nspool_radius = \"10 mm\"\nstiffness = \"2 N/mm\"\ninertia = \"200 g*cm^2\"\n\
             proportional_gain = \"0.5 N*m/rad\"\nderivative_gain = \"4 mN*m*s/rad\"\n\
             [motion]\nduration = \"0.5 s\"\n{more}\n[[motion.commands]]\nmotor = \"m\"\nangle = "
        )
    };
    let file = scratch.write("arm.toml", &(motor("") + "[[0, 0], [\"0.1 s\", \"60 deg\"]]\n"));
    let out = scratch.file("out");
    let summary = succeed(&["simulate", &file, "--out", &out, "--plot"]);
    assert!(
        summary.contains("from the motors") && summary.contains("greatest torque"),
        "{summary}"
    );
    let json = std::fs::read_to_string(scratch.path().join("out/motion.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    let states = json["states"].as_array().unwrap();
    let last = states.last().unwrap();
    let motor_of = |key: &str| number(&last["motors"][0][key]);
    let torque = 0.01 * number(&last["cables"][0]["tension"]);
    assert!((motor_of("torque") - torque).abs() < 0.01 * torque, "{last}");
    let short = 60_f64.to_radians() - motor_of("position");
    assert!((short - torque / 0.5).abs() < 0.01 * short && short > 0.01, "{short}");
    let energy = |name: &str| number(&last["energy"][name]);
    assert!(energy("cables") == 0.0 && energy("control") > energy("stretch"));
    assert!(energy("defect").abs() < 0.05 * energy("control"), "{last}");
    let csv = std::fs::read_to_string(scratch.path().join("out/motion.csv")).unwrap();
    let header = csv.lines().next().unwrap();
    for column in ["m.angle [rad]", "m.rate [rad/s]", "m.torque [N*m]", "control [J]"] {
        assert!(header.contains(column), "{header}");
    }
    // It goes on from there at rest, not from the start.
    let more = motor("initial = \"out/motion.json\"") + "[[0, \"60 deg\"]]\n";
    let file = scratch.write("on.toml", &more);
    let on: Value = serde_json::from_str(&succeed(&["simulate", &file, "--json"])).unwrap();
    for state in on["states"].as_array().unwrap() {
        let apart = number(&state["motors"][0]["position"]) - motor_of("position");
        assert!(apart.abs() < 2e-3, "{apart}");
    }
}

/// A robot that nothing holds falls as a whole, and keeps the shape in which it was let go.
#[test]
fn a_free_base_falls() {
    let json: Value = serde_json::from_str(&succeed(&[
        "simulate",
        ARM,
        "--set",
        "motion.duration=\"0.2 s\"",
        "--set",
        "motion.initial=\"rest\"",
        "--set",
        "motion.commands=[]",
        "--set",
        "motion.base.free=true",
        "--json",
    ]))
    .unwrap();
    let last = json["states"].as_array().unwrap().last().unwrap();
    for (pose, start) in
        last["poses"].as_array().unwrap().iter().zip(json["states"][0]["poses"].as_array().unwrap())
    {
        let z = |pose: &Value| number(&pose["position"][2]);
        assert!((z(pose) - z(start) - 0.5 * 9.81 * 0.04).abs() < 1e-9, "{pose} {start}");
    }
    let led = ["simulate", ARM, "--set", "motion.base={ free = true, velocity = [0, 0, 1] }"];
    assert!(fail(2, &led).contains("free"));
}

/// A film as WebM by ffmpeg, of the length of the motion; without it the message says what to do. Systems without ffmpeg pass over the first part.
#[test]
fn a_film_may_be_webm() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    let duration = "motion.duration=\"60 ms\"";
    let args = ["simulate", ARM, "--set", duration, "--out", &out, "--film", "swing.webm"];
    let has = |program: &str| std::process::Command::new(program).arg("-version").output().is_ok();
    if has("ffmpeg") && has("ffprobe") {
        succeed(&args);
        let film = scratch.path().join("out/swing.webm");
        // The mark of EBML.
        assert!(std::fs::read(&film).unwrap().starts_with(&[0x1a, 0x45, 0xdf, 0xa3]));
        let probe = std::process::Command::new("ffprobe")
            .args(["-v", "error", "-count_frames", "-show_entries"])
            .arg("stream=codec_name,width,nb_read_frames:format=duration")
            .args(["-of", "default=noprint_wrappers=1"])
            .arg(&film)
            .output()
            .unwrap();
        let said = String::from_utf8(probe.stdout).unwrap();
        // Shown in 2 s, and its last picture for one more.
        for entry in ["codec_name=vp9", "width=720", "nb_read_frames=75", "duration=3.0"] {
            assert!(said.contains(entry), "{entry}: {said}");
        }
    } else {
        eprintln!("no ffmpeg: WebM was not tried");
    }
    let nowhere = command(&args).env("PATH", scratch.path()).output().unwrap();
    assert_eq!(nowhere.status.code(), Some(2));
    let said = String::from_utf8(nowhere.stderr).unwrap();
    assert!(said.contains("install ffmpeg") && said.contains(".png"), "{said}");
    assert!(fail(2, &["simulate", ARM, "--out", &out, "--film", "swing.gif"]).contains("webm"));
}

/// With friction the tension falls from hole to hole while the cable is pulled, and the summary has what is lost.
#[test]
fn a_cable_with_friction_loses_tension_on_its_way() {
    let ramp = "motion.commands=[{ cable = \"left\", tension = [[0, 0], [\"0.1 s\", \"3 N\"]] }]";
    let mut args = vec!["simulate", ARM, "--set", "motion.duration=\"0.1 s\"", "--set", ramp];
    args.extend(["--set", "cables.left.friction=0.4", "--json"]);
    for model in ["cosserat", "cosserat-disks"] {
        let args = [&args[..], &["--model", model]].concat();
        let json: Value = serde_json::from_str(&succeed(&args)).unwrap();
        let last = json["states"].as_array().unwrap().last().unwrap();
        let cable = &last["cables"][0];
        assert!((number(&cable["tension"]) - 3.0).abs() < 1e-9);
        let along: Vec<f64> =
            cable["passage_tensions"].as_array().unwrap().iter().map(number).collect();
        assert!(along.len() >= 6 && along[0] > along[along.len() - 1] + 0.01, "{along:?}");
        assert!(along.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9), "{along:?}");
        assert!(number(&last["energy"]["dissipated"]) > 0.0);
    }
}

/// A command over time has one drive: another one that is set beside it is refused, with both.
#[test]
fn a_second_drive_of_a_command_is_refused() {
    let second = "motion.commands[0].shortening=\"1 mm\"";
    let told = fail(2, &["simulate", ARM, "--set", second]);
    assert!(told.contains("`shortening`") && told.contains("`tension`"), "{told}");
    succeed(&[
        "simulate",
        ARM,
        "--set",
        "motion.commands[0].tension=\"1 N\"",
        "--set",
        "motion.duration=\"20 ms\"",
    ]);
}
