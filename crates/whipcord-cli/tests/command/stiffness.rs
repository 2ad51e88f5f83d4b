//! `whipcord stiffness`.

use crate::support::{BUCKLED_SPANS, Scratch, fail, robot, settings, succeed, warned};
use serde_json::Value;

const THREE: &str = "examples/three-cable-segment.toml";
const CASE_3: &str = "examples/table1/case-3.toml";

#[test]
fn the_summary_is_for_people() {
    settings(None).bind(|| {
        let three = succeed(&["stiffness", THREE]);
        // Snapshots pass over what is as small as rounding.
        assert!(three.contains("condition 5702, manipulability 1.898e-9 m³/N³"), "{three}");
        insta::assert_snapshot!("three_cables", three);
        let midway = ["stiffness", CASE_3, "--at", "90 mm", "--actuation", "shortening"];
        insta::assert_snapshot!("by_shortening", succeed(&midway));
        insta::assert_snapshot!("base", succeed(&["stiffness", THREE, "--at", "0"]));
    });
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    serde_json::from_value(value.clone()).unwrap()
}

#[test]
fn json_is_one_object_in_si() {
    let text = succeed(&["stiffness", THREE, "--json"]);
    let object: Value = serde_json::from_str(&text).unwrap();
    let keys: Vec<&String> = object.as_object().unwrap().keys().collect();
    let expected = [
        "title",
        "model",
        "status",
        "stable",
        "place",
        "derivatives",
        "one_sided",
        "lengths_dependent",
        "cables",
        "actuation_jacobian",
        "dexterity",
        "length_jacobian",
        "tensions_held",
        "lengths_held",
        "yield_unknown",
        "stability",
        "stability_absent",
        "version",
        "warnings",
    ];
    assert_eq!(keys, expected);
    let jacobian = matrix(&object["actuation_jacobian"]);
    assert_eq!((jacobian.len(), jacobian[0].len()), (6, 3));
    let free = matrix(&object["tensions_held"]["compliance"]);
    let stiffness = matrix(&object["tensions_held"]["stiffness"]);
    for i in 0..6 {
        for j in 0..6 {
            let product: f64 = (0..6).map(|k| free[i][k] * stiffness[k][j]).sum();
            let unit = if i == j { 1.0 } else { 0.0 };
            assert!((product - unit).abs() < 1e-6, "{i} {j}: {product}");
            assert!((free[i][j] - free[j][i]).abs() < 1e-6 * (1.0 + free[i][j].abs()));
        }
    }
    // Locked cables leave less.
    let locked = matrix(&object["lengths_held"]["compliance"]);
    for i in 0..6 {
        assert!(locked[i][i] < free[i][i] * (1.0 + 1e-9));
    }
    let axes: Vec<f64> =
        serde_json::from_value(object["tensions_held"]["translation"]["compliance"].clone())
            .unwrap();
    let trace = free[0][0] + free[1][1] + free[2][2];
    assert!((axes.iter().sum::<f64>() - trace).abs() < 1e-12);
    assert_eq!(object["cables"][0]["driven_by"], "tension");
    // Singular values and directions: Σ σ² d dᵀ = J Jᵀ.
    let dexterity = object["dexterity"].as_array().unwrap();
    assert_eq!((dexterity.len(), &dexterity[0]["driven_by"]), (1, &"tension".into()));
    let motion: Vec<f64> =
        serde_json::from_value(dexterity[0]["translation"]["motion"].clone()).unwrap();
    let along = matrix(&dexterity[0]["translation"]["directions"]);
    assert_eq!((motion.len(), along.len()), (3, 3));
    for i in 0..3 {
        for j in 0..3 {
            let gram: f64 = jacobian[i].iter().zip(&jacobian[j]).map(|(a, b)| a * b).sum();
            let sum: f64 = motion.iter().zip(&along).map(|(s, d)| s * s * d[i] * d[j]).sum();
            assert!((gram - sum).abs() < 1e-12 * motion[0] * motion[0], "{i} {j}");
        }
    }
    let product: f64 = motion.iter().product();
    let manipulability = dexterity[0]["manipulability"].as_f64().unwrap();
    assert!((manipulability / product - 1.0).abs() < 1e-12);
    // The tip is where `solve` has it.
    let solved: Value = serde_json::from_str(&succeed(&["solve", THREE, "--json"])).unwrap();
    let tip = solved["disks"].as_array().unwrap().last().unwrap()["position"].clone();
    let (a, b): (Vec<f64>, Vec<f64>) = (
        serde_json::from_value(object["place"]["position"].clone()).unwrap(),
        serde_json::from_value(tip).unwrap(),
    );
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-8);
    }
}

#[test]
fn the_jacobian_is_what_a_little_more_tension_does() {
    let scratch = Scratch::new();
    let with_friction = ["cosserat-disks", "piecewise-constant-curvature", "pseudo-rigid-body"];
    for (model, friction) in [("cosserat", 0.0)].into_iter().chain(with_friction.map(|m| (m, 0.2)))
    {
        let at = |tension: f64| -> Value {
            let cable = format!("tension = {tension}\nfriction = {friction}");
            let file = scratch.write("robot.toml", &robot(&cable));
            serde_json::from_str(&succeed(&["stiffness", &file, "--json", "--model", model]))
                .unwrap()
        };
        let y = |object: &Value| object["place"]["position"][1].as_f64().unwrap();
        let slope = (y(&at(2.001)) - y(&at(1.999))) / 0.002;
        let jacobian = matrix(&at(2.0)["actuation_jacobian"])[1][0];
        assert!((jacobian - slope).abs() < 1e-5 * slope.abs(), "{model}: {jacobian} {slope}");
    }
}

#[test]
fn what_cannot_be_is_said() {
    let message = fail(2, &["stiffness", THREE, "--at", "1 m"]);
    assert!(message.contains("is not on the backbone, which is 120 mm long"), "{message}");
    let message = fail(2, &["stiffness", THREE, "--at", "half"]);
    assert!(message.contains("or `tip`"), "{message}");
    let message = fail(2, &["stiffness", CASE_3, "--model", "constant-curvature"]);
    assert!(message.contains("one arc takes straight cables only"), "{message}");
    let message = fail(2, &["stiffness", CASE_3, "--length-rule", "free"]);
    assert!(
        message.contains("--length-rule is an option of four-bar, not of cosserat"),
        "{message}"
    );
}

/// The rod with cables from hole to hole comes close to the other.
#[test]
fn discrete_holes_yield_too() {
    let json = |model: &str| -> Value {
        serde_json::from_str(&succeed(&["stiffness", THREE, "--model", model, "--json"])).unwrap()
    };
    let (exact, ours) = (json("cosserat"), json("cosserat-disks"));
    assert_eq!(exact["derivatives"]["by"], "exact");
    assert_eq!(ours["derivatives"]["by"], "exact");
    let y = |object: &Value| matrix(&object["tensions_held"]["compliance"])[1][1];
    assert!((y(&ours) / y(&exact) - 1.0).abs() < 0.1, "{} {}", y(&ours), y(&exact));
}

/// The geometric model says how the place moves; how it yields only where it knows the strain energy.
#[test]
fn sections_move_and_may_not_know_how_they_yield() {
    let four_bar = ["stiffness", CASE_3, "--model", "four-bar"];
    let text = succeed(&four_bar);
    assert!(
        text.contains("how it yields is not known: only lengths and no energy decide"),
        "{text}"
    );
    let json = |more: &[&str]| -> Value {
        let arguments: Vec<&str> =
            four_bar.iter().chain(more).chain(&["--json"]).copied().collect();
        serde_json::from_str(&succeed(&arguments)).unwrap()
    };
    let plain = json(&[]);
    assert_eq!(
        (plain["derivatives"]["by"].as_str(), &plain["tensions_held"]),
        (Some("exact"), &Value::Null)
    );
    assert!(plain["yield_unknown"].as_str().unwrap().contains("strain-energy"));
    assert!((matrix(&plain["length_jacobian"])[0][0] + 1.0).abs() < 1e-12);
    // The tip moves along its one direction as much as one column says.
    let column: f64 =
        matrix(&plain["actuation_jacobian"])[..3].iter().map(|row| row[0] * row[0]).sum();
    let manipulability = plain["dexterity"][0]["manipulability"].as_f64().unwrap();
    assert!((manipulability / column.sqrt() - 1.0).abs() < 1e-9);
    let sliding = json(&["--objective", "strain-energy", "--length-rule", "free"]);
    assert_eq!(sliding["yield_unknown"], Value::Null);
    let (free, locked) = ["tensions_held", "lengths_held"]
        .map(|held| matrix(&sliding[held]["compliance"])[1][1])
        .into();
    assert!(0.0 < locked && locked < free, "{locked} {free}");
    let scratch = Scratch::new();
    let path = scratch.file("moves.svg");
    succeed(&[&four_bar[..], &["--plot", &path]].concat());
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(svg.contains("manipulability") && !svg.contains("compliance"), "{svg}");
}

/// It yields against the force that pushes it.
#[test]
fn an_unstable_robot_yields_the_wrong_way() {
    let scratch = Scratch::new();
    let file = scratch.write("spans.toml", BUCKLED_SPANS);
    let text = warned(&["stiffness", &file, "--model", "cosserat-disks"]).0;
    let axes: Vec<_> = text.lines().filter(|line| line.starts_with("along ")).collect();
    assert!(axes.iter().any(|line| line.contains(")  -")), "{text}");
}

#[test]
fn a_turned_base_is_said_to_be_so() {
    const WALL: &str = "examples/wall-mounted-arm.toml";
    let text = succeed(&["stiffness", WALL]);
    assert!(text.contains("mm, in the world\n"), "{text}");
    assert!(text.contains("along the axes of the base, not of the world"), "{text}");
    let object: Value = serde_json::from_str(&succeed(&["stiffness", WALL, "--json"])).unwrap();
    assert_eq!(object["place"]["frame"], "world");
    assert_eq!(object["derivatives"]["frame"], "base");
    assert!(!succeed(&["stiffness", THREE]).contains("world"));
}

/// Newtons and metres of command have no common measure: each kind of cable has its own.
#[test]
fn tensions_and_lengths_are_not_mixed() {
    let scratch = Scratch::new();
    let two = |first: &str, second: &str| {
        robot(&format!(
            "{first}\n[[cables]]\nname = \"b\"\nrouting = {{ kind = \"straight\", angle = \"0 deg\", \
             radius = \"8 mm\" }}\n{second}"
        ))
    };
    let mixed = scratch.write("mixed.toml", &two("tension = 1", "shortening = \"2 mm\""));
    let text = succeed(&["stiffness", &mixed]);
    assert!(text.contains("by tension, translates in 1 of 3 directions, condition 1"), "{text}");
    assert!(text.contains("by shortening, translates in 1 of 3 directions, condition 1"), "{text}");
    let object: Value = serde_json::from_str(&succeed(&["stiffness", &mixed, "--json"])).unwrap();
    let jacobian = matrix(&object["actuation_jacobian"]);
    let kinds = object["dexterity"].as_array().unwrap();
    assert_eq!(kinds.len(), 2);
    for (cable, (kind, driven_by)) in kinds.iter().zip(["tension", "shortening"]).enumerate() {
        assert_eq!(kind["driven_by"], driven_by);
        // One cable covers a length: that of its column.
        let column = (0..3).map(|i| jacobian[i][cable].powi(2)).sum::<f64>().sqrt();
        let manipulability = kind["manipulability"].as_f64().unwrap();
        assert!((manipulability / column - 1.0).abs() < 1e-9, "{manipulability} {column}");
    }
    let path = scratch.file("mixed.svg");
    succeed(&["stiffness", &mixed, "--plot", &path]);
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(svg.contains("manipulability by tension"), "{svg}");
    assert!(svg.contains("manipulability by shortening"), "{svg}");
}

/// The picture shows what the numbers say: three ellipsoids, with their values in the legend.
#[test]
fn the_picture_shows_the_ellipsoids() {
    let scratch = Scratch::new();
    let path = scratch.file("yield.svg");
    let text = succeed(&["stiffness", THREE, "--plot", &path]);
    assert!(text.ends_with(&format!("picture: {path}\n")), "{text}");
    let svg = std::fs::read_to_string(&path).unwrap();
    for label in ["compliance, tensions held", "compliance, cables locked", "manipulability"] {
        assert!(svg.contains(label), "{label}");
    }
    assert_eq!(svg.matches("class=\"ellipsoids\"").count(), 4);
    // The softest direction, as the summary has it.
    let object: Value = serde_json::from_str(&succeed(&["stiffness", THREE, "--json"])).unwrap();
    let axes: Vec<f64> =
        serde_json::from_value(object["tensions_held"]["translation"]["compliance"].clone())
            .unwrap();
    let softest = axes.into_iter().fold(0.0, f64::max) * 1e3;
    let decimals = (2.0 - softest.log10().floor()).max(0.0) as usize;
    let written = format!("{softest:.decimals$}");
    let written = written.trim_end_matches('0').trim_end_matches('.');
    assert!(svg.contains(&format!(">{written} mm/N<")), "{written}");
    // What cannot be drawn is refused before anything is written.
    let message = fail(2, &["stiffness", THREE, "--plot", "yield.pdf"]);
    assert!(message.contains("must end in .svg or .png"), "{message}");
}

#[test]
fn an_unstable_robot_is_said_to_be_so() {
    let scratch = Scratch::new();
    let file = scratch.write("spans.toml", BUCKLED_SPANS);
    let (text, warnings) = warned(&["stiffness", &file, "--model", "cosserat-disks"]);
    assert!(text.contains("unstable"), "{text}");
    assert!(warnings.contains("the equilibrium is unstable"), "{warnings}");
}

#[test]
fn every_model_says_how_a_place_moves() {
    for (model, yields) in [("constant-curvature", false), ("pseudo-rigid-body", true)] {
        let text = succeed(&["stiffness", THREE, "--model", model]);
        assert!(text.contains("moves"), "{text}");
        assert_eq!(text.contains("how it yields is not known: the model takes no loads"), !yields);
    }
}

/// A cable at its length without tension is about to become taut: the derivatives are those of one side.
#[test]
fn what_is_about_to_change_is_told() {
    let scratch = Scratch::new();
    let arm = |shortening: &str| {
        format!(
            "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n\n\
             [disks]\ncount = 4\nhole_circle_radius = \"8 mm\"\nholes = 2\n\n\
             [[cables]]\nname = \"a\"\nholes = [1, 1, 1, 1]\nshortening = \"{shortening}\"\n\n\
             [[cables]]\nname = \"b\"\nholes = [2, 2, 2, 2]\nshortening = \"-20 mm\"\n"
        )
    };
    for (shortening, one_sided) in [("3 mm", vec![]), ("0 mm", vec!["cable"])] {
        let file = scratch.write("arm.toml", &arm(shortening));
        for model in ["cosserat", "cosserat-disks", "piecewise-constant-curvature"] {
            let text = succeed(&["stiffness", &file, "--json", "--model", model]);
            let object: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(object["lengths_dependent"], false, "{model} {shortening}");
            assert_eq!(object["one_sided"], serde_json::json!(one_sided), "{model} {shortening}");
            let told = succeed(&["stiffness", &file, "--model", model]);
            let is_told = told.contains("derivatives of one side: a cable is about to go slack");
            assert_eq!(is_told, !one_sided.is_empty(), "{told}");
        }
    }
}
