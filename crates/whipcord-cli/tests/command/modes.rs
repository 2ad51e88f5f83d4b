//! `whipcord modes`.

use core::f64::consts::{PI, TAU};

use serde_json::Value;

use crate::support::{Scratch, fail, settings, succeed};

const BENT: &str = "examples/two-segment-arm.toml";
const ARM: &str = "examples/released-arm.toml";

/// A cantilever without disks' mass, cables or weight.
const CANTILEVER: &str = r#"
title = "Cantilever"
[backbone]
length = "500 mm"
diameter = "2 mm"
young_modulus = "200 GPa"
poisson_ratio = 0.25
density = "8000 kg/m^3"
damping = { time = "10 us" }
[disks]
count = 12
hole_circle_radius = "5 mm"
[[cables]]
name = "a"
routing = { kind = "straight", angle = "0 deg", radius = "5 mm" }
tension = "0 N"
"#;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// ω = (βL)² √(EI/ρA)/L² with βL = 1.8751, 4.6941, 7.8548, twice each; damping proportional to the stiffness has the ratio ω time/2.
#[test]
fn frequencies_of_a_cantilever_are_those_of_its_closed_form() {
    let scratch = Scratch::new();
    let file = scratch.file("cantilever.toml");
    std::fs::write(&file, CANTILEVER).unwrap();
    let json: Value = serde_json::from_str(&succeed(&["modes", &file, "--json"])).unwrap();
    // The density has an effect without gravity, too.
    assert_eq!(json["warnings"], serde_json::json!([]));
    let modes = json["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 6);
    let (length, radius) = (0.5, 1e-3_f64);
    let area = PI * radius * radius;
    let bar = (200e9 * PI * radius.powi(4) / 4.0 / (8000.0 * area)).sqrt();
    for (k, mode) in modes.iter().enumerate() {
        let beta: f64 = [1.875_104_07, 4.694_091_13, 7.854_757_44][k / 2];
        let omega = beta * beta * bar / (length * length);
        let got = TAU * number(&mode["frequency"]);
        // Eleven elements: the error grows with the number of waves.
        let tolerance = [2e-5, 1e-3, 5e-3][k / 2];
        assert!((got / omega - 1.0).abs() < tolerance, "{k}: {got} {omega}");
        assert!((number(&mode["damping_ratio"]) / (0.5e-5 * got) - 1.0).abs() < 1e-6);
        // Modal mass 1: the uniform rod has mass · mean square = 1, and (2/√m) at its tip.
        let tip = mode["displacement"].as_array().unwrap().last().unwrap();
        let tip = (0..3).map(|i| number(&tip[i]).powi(2)).sum::<f64>().sqrt();
        let expected = 2.0 / (8000.0 * area * length).sqrt();
        assert!((tip / expected - 1.0).abs() < 2.0 * tolerance, "{k}: {tip} {expected}");
        let energy = &mode["energy"];
        assert!(number(&energy["x"]) + number(&energy["y"]) > 0.99, "{energy}");
    }
}

#[test]
fn the_folder_has_tables_and_a_picture() {
    let scratch = Scratch::new();
    let out = scratch.file("out");
    // Vibrations of a round robot would be in any two planes.
    settings(Some(scratch.path())).bind(|| {
        let args = ["modes", BENT, "--count", "4", "--out", &out];
        insta::assert_snapshot!("modes", succeed(&args));
    });
    succeed(&["modes", ARM, "--count", "4", "--out", &out]);
    let folder = scratch.path().join("out");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("modes.json")).unwrap();
    let nodes = json["arc_length"].as_array().unwrap().len();
    assert_eq!(json["modes"][3]["rotation"].as_array().unwrap().len(), nodes);
    let rows = read("modes.csv");
    assert_eq!(rows, succeed(&["modes", ARM, "--count", "4", "--csv"]));
    assert_eq!(rows.lines().count(), 5);
    assert_eq!(read("shapes.csv").lines().count(), 1 + 4 * nodes);
    for name in ["modes.svg", "modes.png"] {
        assert!(folder.join(name).exists(), "{name}");
    }
}

/// The arm that is let go vibrates at the frequency of its first mode: the zeros of its motion are half a period apart.
#[test]
fn a_released_arm_vibrates_at_its_first_frequency() {
    let first = |args: &[&str]| {
        let text = succeed(&[&["modes", ARM, "--json"], args].concat());
        let json: Value = serde_json::from_str(&text).unwrap();
        [number(&json["modes"][0]["frequency"]), number(&json["modes"][0]["damped_frequency"])]
    };
    let [frequency, damped] = first(&[]);
    assert!(damped < frequency);
    // Behind the jump of [motion] the cables are free as they are in the file.
    let after = first(&["--time", "0.1 s"]);
    assert!((after[0] / frequency - 1.0).abs() < 1e-9);

    // A small release, so that the motion is one about the equilibrium.
    let commands =
        r#"motion.commands=[{ cable = "left", tension = [["0 s", "0.05 N"], ["0 s", "0 N"]] }]"#;
    let text = succeed(&[
        "simulate",
        ARM,
        "--set",
        commands,
        "--set",
        "motion.output.every=\"1 ms\"",
        "--set",
        "motion.step=\"1 ms\"",
        "--json",
    ]);
    let json: Value = serde_json::from_str(&text).unwrap();
    let states: Vec<[f64; 2]> = json["states"]
        .as_array()
        .unwrap()
        .iter()
        .map(|state| {
            let tip = state["poses"].as_array().unwrap().last().unwrap().clone();
            [number(&state["time"]), number(&tip["position"][0])]
        })
        .collect();
    let zeros: Vec<f64> = states
        .windows(2)
        .filter(|pair| pair[0][1] * pair[1][1] < 0.0)
        .map(|pair| {
            let [[t, a], [u, b]] = [pair[0], pair[1]];
            t + (u - t) * a / (a - b)
        })
        .collect();
    assert!(zeros.len() > 6, "{zeros:?}");
    let half_periods = zeros.len() - 3;
    let got = 0.5 * half_periods as f64 / (zeros[zeros.len() - 1] - zeros[2]);
    assert!((got / damped - 1.0).abs() < 5e-3, "{got} {damped}");
}

#[test]
fn what_has_no_vibrations_is_refused() {
    // A slack cable does not rub; one that was pulled slides in its holes.
    let rubs = ["modes", ARM, "--set", "cables[0].friction=0.2"];
    succeed(&rubs);
    let rubbing = fail(1, &[&rubs[..], &["--set", "cables.left.tension=\"4 N\""]].concat());
    assert!(rubbing.contains("slides in a hole"), "{rubbing}");
    let obstacle = r#"obstacles=[{ kind = "sphere", position = ["1 m", "0 m", "0 m"], radius = "10 mm", mass = "10 g" }]"#;
    let blocked = fail(2, &["modes", ARM, "--set", obstacle]);
    assert!(blocked.contains("movable object"), "{blocked}");
    let massless = fail(2, &["modes", "examples/three-cable-segment.toml"]);
    assert!(massless.contains("density"), "{massless}");
    assert!(fail(2, &["modes", ARM, "--time", "now"]).contains("0.5 s"));
    let late = fail(2, &["modes", ARM, "--time", "9 s"]);
    assert!(late.contains("--time is 9 s, but the motion takes 2 s"), "{late}");
    fail(2, &["modes", ARM, "--count", "0"]);
}
