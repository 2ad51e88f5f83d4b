//! Problems with known answers, asked as a user asks them: a robot file in, JSON out. The library's
//! tests hold the model to more of them, and to tighter bounds.

use crate::support::{Scratch, warned};
use serde_json::Value;

/// A rod of length 1, EI = 1 and GJ = 0.7 that neither stretches nor shears.
const RIGID: &str = r#"
title = "Rod"
[backbone]
length = "1 m"
extensible = false
shearable = false
linear_density = "1 kg/m"
stiffness = { bending = ["1 N*m^2", "1 N*m^2"], torsion = "0.7 N*m^2" }
[disks]
count = 2
hole_circle_radius = "10 mm"
[loads]
"#;

/// Till's steel rod of half a metre, 2 mm thick, with cables 15.06 mm off its axis.
const TILL: &str = r#"
title = "Till's rod"
[backbone]
length = "500 mm"
diameter = "2 mm"
young_modulus = "200 GPa"
shear_modulus = "80 GPa"
[disks]
count = 2
hole_circle_radius = "15.06 mm"
"#;

fn solve(robot: &str) -> Value {
    let scratch = Scratch::new();
    let (text, _) =
        warned(&["solve", &scratch.write("robot.toml", robot), "--json", "--tolerance", "1e-9"]);
    serde_json::from_str(&text).unwrap()
}

fn last(list: &Value) -> Vec<f64> {
    let list = list.as_array().unwrap();
    serde_json::from_value(list[list.len() - 1].clone()).unwrap()
}

fn tip_is(robot: &str, expected: [f64; 3], bound: f64) {
    let answer = solve(robot);
    let tip = last(&answer["shape"]["position"]);
    let errors = tip.iter().zip(expected).map(|(a, b)| (a - b).abs());
    let error = errors.fold(0.0, f64::max);
    assert!(error < bound, "{tip:?} is off by {error:.1e}\n{robot}");
}

/// Mattiasson (1981), an end moment (closed form), Argyris and Symeonidis (1981), and a uniform load and a
/// pressure by shooting: see `cosserat/benchmarks.rs` and `cosserat/distributed.rs` of the library.
#[test]
fn bare_rods_bend_as_in_the_books() {
    let rod = |loads: &str| format!("{RIGID}{loads}");
    tip_is(&rod("tip_force = [10, 0, 0]"), [0.810_609_024_880_3, 0.0, 0.445_004_402_246_2], 1e-9);
    tip_is(
        &rod(&format!("tip_moment = [0, {}, 0]", core::f64::consts::PI)),
        [core::f64::consts::FRAC_2_PI, 0.0, 0.0],
        1e-9,
    );
    tip_is(
        &rod("tip_force = [\"5 N\", \"0 N\", \"0 N\"]\nfollower = true"),
        [0.780_690_142_778_1, 0.0, 0.172_277_875_399_1],
        1e-8,
    );
    tip_is(
        &rod("[[loads.distributed]]\nforce = [\"10 N/m\", 0, 0]"),
        [0.700_199_715_514_3, 0.0, 0.656_353_761_238_6],
        1e-8,
    );
    tip_is(
        &rod("[[loads.distributed]]\nforce = [10, 0, 0]\nfollower = true"),
        [0.830_147_854_019_8, 0.0, 0.354_667_544_915_9],
        1e-8,
    );
}

/// Bathe and Bolourchi (1979), with the polar torsion constant of Simo and Vu-Quoc (1986).
#[test]
fn the_45_degree_bend() {
    let stiffness = 1e7 / 12.0;
    let robot = format!(
        "title = \"Bend\"\n[backbone]\nlength = {}\nrest_curvature = [0, 0.01, 0]\n\
         stiffness = {{ shear = [5e6, 5e6], axial = 1e7, bending = [{stiffness}, {stiffness}], torsion = {stiffness} }}\n\
         [disks]\ncount = 2\nhole_circle_radius = 1\n[loads]\ntip_force = [0, -450, 0]\n",
        25.0 * core::f64::consts::PI
    );
    tip_is(&robot, [18.508_178_925_37, -48.502_927_344_14, 52.238_558_011_16], 1e-6);
}

/// Euler's and Greenhill's loads: the stability value changes its sign there.
#[test]
fn columns_lose_their_stability() {
    for (loads, critical) in [
        ("tip_force = [0, 0, -LOAD]", 2.467_401_100_272_34),
        ("gravity = [0, 0, -LOAD]", 7.837_347_438_943_48),
    ] {
        for (factor, stable) in [(1.0 - 1e-4, true), (1.0 + 1e-4, false)] {
            let loads = loads.replace("LOAD", &format!("{}", factor * critical));
            let answer = solve(&format!("{RIGID}{loads}\n"));
            let stability = answer["diagnostics"]["stability"].as_f64().unwrap();
            assert_eq!(stability > 0.0, stable, "{loads}: {stability}");
        }
    }
}

/// Closed forms: one straight cable, by its tension and by its length, a helical one, and two that
/// stiffen the rod's twist.
#[test]
fn cables_bend_as_closed_forms_have_it() {
    let cable = |angle: &str, command: &str| {
        format!(
            "[[cables]]\nname = \"c{angle}\"\nrouting = {{ kind = \"straight\", angle = \"{angle} deg\", radius = \"15.06 mm\" }}\n{command}\n"
        )
    };
    let straight = format!("{TILL}{}", cable("0", "tension = \"15 N\""));
    tip_is(&straight, [0.172_148_019_752_57, 0.0, 0.458_001_853_828_49], 1e-9);

    let pulled = solve(&format!("{TILL}{}", cable("0", "shortening = \"5 mm\"")));
    let tension = pulled["cables"][0]["tension"].as_f64().unwrap();
    assert!((tension / 6.918_174_064_603_67 - 1.0).abs() < 1e-9, "{tension}");

    let helix = "[[cables]]\nname = \"h\"\nrouting = { kind = \"helix\", start_angle = \"0 deg\", turns = 0.65, radius = \"15.06 mm\" }\ntension = \"15 N\"\n";
    tip_is(
        &format!("{TILL}{helix}"),
        [0.035_536_735_693_22, 0.103_803_052_989_6, 0.481_348_510_695_65],
        1e-9,
    );

    let both = cable("0", "tension = 15") + &cable("180", "tension = 15");
    let twisted = solve(&format!("{TILL}{both}[loads]\ntip_moment = [0, 0, \"50 mN*m\"]\n"));
    let [w, _, _, z] = last(&twisted["shape"]["orientation"])[..] else { panic!("{twisted}") };
    assert!((2.0 * z.atan2(w) - 0.5 * 0.377_449_565_343_668).abs() < 1e-9, "{twisted}");
}

/// Rao et al. (2021): two segments, the cables of the first ending midway.
#[test]
fn two_segments_are_two_arcs() {
    let mut robot = String::from(
        "title = \"Rao's arm\"\n[backbone]\nlength = \"400 mm\"\ndiameter = \"1.4 mm\"\nyoung_modulus = \"54 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 3\nhole_circle_radius = \"10 mm\"\n",
    );
    for (i, (angle, tension)) in
        [(90, 4), (-30, 0), (210, 0), (90, 0), (-30, 2), (210, 0)].into_iter().enumerate()
    {
        let end = if i < 3 { "ends_at = \"200 mm\"\n" } else { "" };
        robot += &format!(
            "[[cables]]\nname = \"{i}\"\nrouting = {{ kind = \"straight\", angle = \"{angle} deg\", radius = \"10 mm\" }}\n{end}tension = \"{tension} N\"\n"
        );
    }
    tip_is(&robot, [0.127_607_602_887_96, 0.143_467_422_785_28, 0.336_406_799_391_93], 1e-9);
}
