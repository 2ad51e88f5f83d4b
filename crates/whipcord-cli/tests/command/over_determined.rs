//! Rows whose cable lengths contradict each other: solve, score and fit.

use std::fs;

use serde_json::Value;

use super::support::{Scratch, fail, succeed, warned};

/// Three cables on a backbone that does not get shorter, all shortened by 0.4 mm beside a bend.
const ROBOT: &str = "title = \"Three cables\"\n[backbone]\nlength = \"200 mm\"\ndiameter = \"1.2 mm\"\nyoung_modulus = \"60 GPa\"\npoisson_ratio = 0.3\nextensible = false\n[disks]\ncount = 5\nhole_circle_radius = \"8 mm\"\n";

fn cables(shortening: Option<[f64; 3]>) -> String {
    let cable = |i: usize| {
        let command =
            shortening.map_or(String::new(), |by| format!("shortening = \"{} mm\"\n", by[i]));
        format!(
            "[[cables]]\nname = \"{}\"\nrouting = {{ kind = \"straight\", angle = \"{} deg\", radius = \"8 mm\" }}\n{command}",
            ["a", "b", "c"][i],
            120 * i
        )
    };
    (0..3).map(cable).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn solve_refuses_them_or_misses_them_least() {
    let scratch = Scratch::new();
    let file = scratch.write("arm.toml", &format!("{ROBOT}{}", cables(Some([4.4, -0.6, -2.6]))));
    let message = fail(1, &["solve", &file]);
    assert!(message.contains("or ask for the least-squares answer"), "{message}");
    let text = succeed(&["solve", &file, "--least-squares-lengths"]);
    assert!(
        text.contains(
            "least squares: the prescribed cable lengths contradict each other; cable `a` is 0.4"
        ),
        "{text}"
    );
    let json = succeed(&["solve", &file, "--least-squares-lengths", "--json", "--stations", "7"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["status"], &json["stable"]), (&"least-squares".into(), &true.into()));
    assert_eq!(json["shape"]["arc_length"].as_array().unwrap().len(), 7);
    let misses = json["diagnostics"]["length_misses"].as_array().unwrap();
    assert_eq!(misses.len(), 3);
    for miss in misses {
        assert!((number(&miss["excess"]) - 4e-4).abs() < 1e-6, "{miss}");
    }
    assert!(json["cables"].as_array().unwrap().iter().all(|cable| cable["tension"].is_null()));
    // The circle that the lengths without their common part have.
    let bend = f64::hypot(4e-3, 2e-3 / 3.0_f64.sqrt()) / 8e-3;
    let tip = json["disks"].as_array().unwrap().last().unwrap()["position"].as_array().unwrap();
    let across = number(&tip[0]).hypot(number(&tip[1]));
    assert!((across - 0.2 / bend * (1.0 - bend.cos())).abs() < 2e-4, "{across}");
    // Lengths that can be had are met.
    let file = scratch.write("met.toml", &format!("{ROBOT}{}", cables(Some([4.0, -1.5, -3.5]))));
    let json = succeed(&["solve", &file, "--least-squares-lengths", "--json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["status"], "converged");
}

#[test]
fn score_and_fit_count_and_name_them() {
    let scratch = Scratch::new();
    let mut rows = String::from("a [mm],b [mm],c [mm],x,y,z\n");
    for i in 0..12 {
        let (way, bend) = (f64::from(i), 0.1 + 0.08 * f64::from(i));
        // The real cables are 8.2 mm from the axis.
        let by = [0.0, 1.0, 2.0]
            .map(|k| 8.2 * bend * (way - core::f64::consts::TAU * k / 3.0).cos() + 0.4);
        let (across, up) = (200.0 / bend * (1.0 - bend.cos()), 200.0 / bend * bend.sin());
        let noise = 0.02 * f64::from(i * 7 % 5 - 2);
        let place = [across * way.cos() + noise, across * way.sin() - noise, up];
        let cells: Vec<String> = by.iter().chain(&place).map(|x| format!("{x:.5}")).collect();
        rows += &(cells.join(",") + "\n");
    }
    scratch.write("log.csv", &rows);
    let tail = "[commands]\ntable = \"log.csv\"\n[measured]\ntable = \"log.csv\"\nunit = \"mm\"\n";
    let file = scratch.write("arm.toml", &format!("{ROBOT}{}{tail}", cables(None)));
    let out = scratch.file("out");
    let text = succeed(&["score", &file, "--model", "cosserat", "--no-figures", "--out", &out]);
    assert!(
        text.contains("12 rows whose cable lengths contradict each other are solved in the least-squares sense"),
        "{text}"
    );
    let table = fs::read_to_string(scratch.path().join("out/rows.csv")).unwrap();
    assert_eq!(table.matches(",least-squares,").count(), 12, "{table}");
    assert!(table.contains("the cable lengths contradict each other: cable `a` is 0.4"), "{table}");
    let args = ["fit", &file, "--parameter", "cables[*].routing.radius", "--json"];
    let json: Value = serde_json::from_str(&warned(&args).0).unwrap();
    let radius = number(&json["estimates"][0]["value"]);
    assert!((radius - 2e-4).abs() < 1e-5, "{radius}");
    assert_eq!(json["skipped"].as_array().unwrap().len(), 0);
    assert_eq!(json["over_determined"].as_array().unwrap().len(), 12);
    let warnings = json["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|of| of["code"] == "over-determined-rows"), "{warnings:?}");
}
