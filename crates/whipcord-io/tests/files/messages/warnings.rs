//! Warnings: each kind fires, and does not where it nearly would.

use std::path::Path;

use whipcord::warning::of_spacing;
use whipcord::{Actuation, Model, ModelKind, Solution, Statics, Stations, Warning};
use whipcord_io::{CaseFile, FileWarning, load, parse, render_warnings, warnings_json};

/// A robot about which there is nothing to warn.
const ROBOT: &str = r#"[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
[disks]
count = 10
hole_circle_radius = "8 mm"
holes = 12
[[cables]]
name = "pull"
holes = [4, 4, 4, 4, 4, 4, 4, 4, 4, 4]
tension = "4 N"
"#;

/// The same with a cable on a curve.
const CURVED: &str = r#"[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
[disks]
count = 10
[[cables]]
routing = { kind = "straight", angle = "90 deg", radius = "8 mm" }
tension = "4 N"
"#;

const ZERO_LOADS: &str = r#"[loads]
gravity = [0, 0, 0]
[[loads.point]]
at = "90 mm"
force = [0, "0 N", 0]
[[loads.distributed]]
moment = [0, 0, 0]
[[loads.distributed]]
at = ["0 mm", "90 mm"]
force = [[0, 0, 0], [0, 0, 0]]
[[loads.mass]]
at = "90 mm"
mass = "0 g"
"#;

const STIFFNESS: &str = "stiffness = { bending = [0.004, 0.004], torsion = 0.003, axial = 8000, shear = [3000, 3000] }\n";

fn file(text: &str) -> CaseFile {
    parse(text, "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The robot with one text in place of another, of which there is one.
fn with(old: &str, new: &str) -> String {
    assert_eq!(ROBOT.matches(old).count(), 1, "{old}");
    ROBOT.replace(old, new)
}

fn solve(file: &CaseFile, kind: ModelKind) -> Solution {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.solve(&file.robot, &file.case).unwrap_or_else(|error| panic!("{error}"))
}

fn disks() -> Model {
    Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Natural)
}

fn about_answer(file: &CaseFile, kind: ModelKind) -> Vec<FileWarning> {
    file.answer_warnings([(None, &solve(file, kind))])
}

fn codes(warnings: &[FileWarning]) -> Vec<&'static str> {
    warnings.iter().map(|warning| warning.warning.code()).collect()
}

fn codes_of(text: &str) -> Vec<&'static str> {
    codes(&file(text).warnings())
}

fn codes_of_answer(text: &str) -> Vec<&'static str> {
    codes(&about_answer(&file(text), ModelKind::Cosserat))
}

/// A silicone body, cables in channels of which run on a helix.
fn silicone(disks: usize) -> String {
    format!(
        r#"[backbone]
length = "180 mm"
diameter = "16 mm"
young_modulus = "500 kPa"
poisson_ratio = 0.49
[disks]
count = {disks}
[[cables]]
routing = {{ kind = "helix", turns = 0.75, radius = "6 mm" }}
tension = "1.5 N"
"#
    )
}

/// A bare rod under a force at its tip.
fn rod(force: &str) -> String {
    let robot = ROBOT.split("[[cables]]").next().unwrap();
    format!("{robot}[loads]\ntip_force = {force}\n")
}

#[test]
fn what_warnings_about_files_say() {
    let cases = [
        (
            "a long backbone",
            with("\"180 mm\"", "\"18 m\"")
                .replace("\"3 mm\"", "\"30 cm\"")
                .replace("\"8 mm\"", "\"40 cm\""),
        ),
        ("a length in millimetres", with("length = \"180 mm\"", "length = 180")),
        ("a diameter in millimetres", with("\"3 mm\"", "3")),
        ("a hole circle in millimetres", with("\"8 mm\"", "8")),
        ("a modulus in megapascals", with("\"1.1 GPa\"", "1100")),
        ("a thick backbone", with("\"3 mm\"", "\"20 mm\"").replace("\"8 mm\"", "\"12 mm\"")),
        ("holes outside the disk", with("holes = 12", "holes = 12\nouter_radius = \"7 mm\"")),
        ("holes inside the backbone", with("\"8 mm\"", "\"1 mm\"")),
        (
            "a short list of holes",
            with("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", "[4, 4, 4, 4, 4, 4, 4, 4]"),
        ),
        ("a density without weight", with("poisson_ratio", "density = 1040\npoisson_ratio")),
        (
            "a mass without weight",
            format!("{ROBOT}[[loads.mass]]\nat = \"180 mm\"\nmass = \"12 g\"\n"),
        ),
        ("nothing follows", format!("{ROBOT}[loads]\nfollower = true\n")),
        (
            "a correction of no shear",
            with("poisson_ratio", "shearable = false\nshear_correction = 0.886\npoisson_ratio"),
        ),
        ("holes of no cable", CURVED.replace("count = 10", "count = 10\nholes = 12")),
        ("loads of zero", format!("{ROBOT}{ZERO_LOADS}")),
        ("a frame of no load", format!("{ROBOT}[loads]\nframe = \"world\"\n")),
        (
            "a yield strain of no section",
            with("diameter = \"3 mm\"", "yield_strain = \"2 %\"")
                .replace("young_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n", STIFFNESS),
        ),
        ("a load far beyond buckling", rod("[0, 0, \"-5 N\"]")),
        ("a force across, far too large", rod("[\"50 N\", 0, 0]")),
    ];
    let messages = cases.iter().map(|(name, text)| {
        let file = file(text);
        let warnings = file.warnings();
        assert!(!warnings.is_empty(), "{name}");
        (*name, render_warnings(&file, &warnings, false))
    });
    insta::assert_snapshot!(super::sections(messages));
}

#[test]
fn what_warnings_about_answers_say() {
    let cases = [
        ("nearly critical", rod("[0, 0, \"-0.327 N\"]")),
        (
            "disks overlap",
            with("count = 10", "count = 46")
                .replace("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", &format!("{:?}", [4; 46]))
                .replace("\"4 N\"", "\"12 N\"")
                .replace("holes = 12", "holes = 12\nouter_radius = \"60 mm\""),
        ),
        (
            "the shape meets itself",
            with("\"8 mm\"", "\"2 mm\"")
                .replace("\"4 N\"", "\"20 N\"")
                .replace("\"3 mm\"", "\"2 mm\""),
        ),
        (
            "a large strain",
            rod("[\"6 N\", 0, 0]")
                .replace("\"3 mm\"", "\"8 mm\"")
                .replace("\"8 mm\"\nholes", "\"12 mm\"\nholes")
                .replace("\"1.1 GPa\"", "\"20 MPa\""),
        ),
        ("beyond the yield strain", with("poisson_ratio", "yield_strain = \"1 %\"\npoisson_ratio")),
    ];
    let messages = cases.iter().map(|(name, text)| {
        let file = file(text);
        let warnings = about_answer(&file, ModelKind::Cosserat);
        (*name, render_warnings(&file, &warnings, false))
    });
    let usual = file(ROBOT);
    let unstable = ("unstable", render_warnings(&usual, &unstable(&usual), false));
    insta::assert_snapshot!(super::sections(messages.chain([unstable])));
}

/// An answer that is unstable: whether there is one to a case is a matter of the models.
fn unstable(file: &CaseFile) -> Vec<FileWarning> {
    let mut answer = solve(file, ModelKind::Cosserat);
    answer.diagnostics.stable = Some(false);
    answer.diagnostics.stability = Some(-0.5);
    answer.diagnostics.stability_lost_at = Some(2.0 / 3.0);
    file.answer_warnings([(None, &answer)])
}

#[test]
fn nothing_is_said_where_all_is_as_usual() {
    let file = file(ROBOT);
    assert_eq!(file.warnings(), []);
    for kind in ModelKind::ALL {
        if kind.natural_actuation() == Actuation::Tension {
            assert_eq!(about_answer(&file, kind), [], "{kind}");
        }
    }
}

#[test]
fn what_nearly_warns_does_not() {
    for (what, text) in [
        (
            "as long as a robot may be",
            with("\"180 mm\"", "10.0")
                .replace("\"3 mm\"", "\"30 cm\"")
                .replace("\"8 mm\"", "\"40 cm\""),
        ),
        (
            "a unit says what is meant",
            with("\"1.1 GPa\"", "\"1100 Pa\"").replace("\"8 mm\"", "\"1 mm\""),
        ),
        ("rubber in SI", with("\"1.1 GPa\"", "1.1e6").replace("\"8 mm\"", "\"10 mm\"")),
        (
            "a wide robot with a unit",
            with("\"180 mm\"", "2.0").replace("\"3 mm\"", "0.15").replace("\"8 mm\"", "0.2"),
        ),
        ("a tenth of the length", with("\"3 mm\"", "\"18 mm\"").replace("\"8 mm\"", "\"12 mm\"")),
        ("at the rim", with("holes = 12", "holes = 12\nouter_radius = \"8 mm\"")),
        ("on the surface", with("\"8 mm\"", "\"1.5 mm\"")),
        (
            "in the bore",
            with("\"8 mm\"", "\"0.9 mm\"")
                .replace("poisson_ratio", "inner_diameter = \"2 mm\"\npoisson_ratio"),
        ),
        ("channels in silicone", silicone(10)),
        (
            "the file says where the cable ends",
            with(
                "[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]",
                "[4, 4, 4, 4, 4, 4, 4, 4]\nends_at = \"140 mm\"",
            ),
        ),
        (
            "the file says that there is no gravity",
            with("poisson_ratio", "density = 1040\npoisson_ratio")
                + "[loads]\ngravity = [0, 0, 0]\n",
        ),
        (
            "holes for one of the cables",
            format!("{ROBOT}{}", &CURVED[CURVED.find("[[cables]]").unwrap()..]),
        ),
        ("tip loads of zero", format!("{ROBOT}[loads]\ntip_force = [0, 0, 0]\n")),
        (
            "a moment without a force",
            format!(
                "{ROBOT}[[loads.point]]\nat = 0.1\nforce = [0, 0, 0]\nmoment = [0.001, 0, 0]\n"
            ),
        ),
        ("pressed a little beyond buckling", rod("[0, 0, \"-0.5 N\"]")),
        ("pulled as hard as one likes", rod("[0, 0, \"500 N\"]")),
        ("a force across", rod("[\"3 N\", 0, 0]")),
    ] {
        assert_eq!(codes_of(&text), Vec::<&str>::new(), "{what}");
    }
}

/// Files that share their disks have cables of both kinds.
#[test]
fn holes_of_a_file_that_is_extended_may_be_for_others() {
    let folder = tempfile::tempdir().unwrap();
    let robot = ROBOT.split("[[cables]]").next().unwrap();
    std::fs::write(folder.path().join("robot.toml"), robot).unwrap();
    let cables = &CURVED[CURVED.find("[[cables]]").unwrap()..];
    let path = folder.path().join("case.toml");
    std::fs::write(&path, format!("extends = \"robot.toml\"\n{cables}")).unwrap();
    assert_eq!(load(&path).unwrap().warnings(), []);
}

#[test]
fn the_advice_for_a_short_list_is_one_that_works() {
    // Seven disks: 30 mm apart; eleven: 18 mm; eight: not a round number.
    for (count, listed) in [(7, 5), (11, 4), (8, 6), (14, 3)] {
        let short = with("count = 10", &format!("count = {count}"))
            .replace("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", &format!("{:?}", vec![4; listed]));
        let warned = file(&short);
        let help = warned.warnings()[0].warning.help();
        let line = help.split('`').nth(1).unwrap();
        let stated = file(&short.replace("tension =", &format!("{line}\ntension =")));
        assert_eq!(stated.warnings(), [], "{line}");
        assert_eq!(stated.robot.routes()[0].end(), warned.robot.routes()[0].end());
    }
}

#[test]
fn warnings_about_answers_have_near_misses() {
    // π²EI/(4L²) of this rod is 0.333 N.
    assert_eq!(codes_of_answer(&rod("[0, 0, \"-0.3 N\"]")), Vec::<&str>::new());
    assert_eq!(codes_of_answer(&rod("[0, 0, \"-0.327 N\"]")), ["near-critical"]);
    assert_eq!(codes(&unstable(&file(ROBOT))), ["unstable"]);
    let yields = |percent: &str| {
        with("poisson_ratio", &format!("yield_strain = \"{percent}\"\npoisson_ratio"))
    };
    // κ = τ r / EI along the whole robot; the strain is 1.5 mm of it and the compression.
    let stiffness = 1.1e9 * core::f64::consts::PI / 64.0 * 0.003_f64.powi(4);
    let area = core::f64::consts::PI / 4.0 * 0.003_f64.powi(2);
    let strain = 4.0 * 0.008 / stiffness * 0.0015 + 4.0 / (1.1e9 * area);
    let over = format!("{:.6} %", 98.0 * strain);
    let under = format!("{:.6} %", 102.0 * strain);
    assert_eq!(codes_of_answer(&yields(&over)), ["yield-strain"]);
    assert_eq!(codes_of_answer(&yields(&under)), Vec::<&str>::new());
}

#[test]
fn a_cable_that_passes_through_an_obstacle_is_told_of() {
    // Between two of four disks of a robot that hardly bends, the cable at +y is 8 mm from the axis.
    let text = |distance: f64| {
        let robot = ROBOT
            .replace("count = 10", "count = 4")
            .replace("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", "[4, 4, 4, 4]")
            .replace("\"4 N\"", "0.01");
        let position = format!("[0, {distance}, 0.09]");
        format!(
            "{robot}[[obstacles]]\nname = \"ball\"\nkind = \"sphere\"\nradius = 0.003\nposition = {position}\n"
        )
    };
    let warnings = |distance: f64| about_answer(&file(&text(distance)), ModelKind::CosseratDisks);
    assert_eq!(codes(&warnings(0.0105)), ["cable-in-obstacle"]);
    assert_eq!(codes(&warnings(0.0115)), Vec::<&str>::new());
    let [warning] = &warnings(0.0105)[..] else { panic!() };
    let message = warning.warning.to_string();
    assert!(
        message.starts_with(
            "cable `pull` passes through the obstacle `ball` between disks 2 and 3, 0."
        ),
        "{message}"
    );
    assert!(message.ends_with("is left out"), "{message}");
}

#[test]
fn a_full_circle_meets_itself_and_one_that_is_not_full_does_not() {
    // A moment bends a bare rod to a circle of L EI/M: 2π EI/L closes it.
    let stiffness = 1.1e9 * core::f64::consts::PI / 64.0 * 0.001_f64.powi(4);
    let closing = 2.0 * core::f64::consts::PI * stiffness / 0.18;
    let text = |share: f64| {
        let robot = ROBOT.split("[disks]").next().unwrap().replace("\"3 mm\"", "\"1 mm\"");
        format!("{robot}[disks]\ncount = 30\n[loads]\ntip_moment = [{}, 0, 0]\n", share * closing)
    };
    let of = |share: f64| {
        let codes = codes_of_answer(&text(share));
        codes.contains(&"self-intersection")
    };
    assert!(of(1.2));
    assert!(of(1.0));
    assert!(!of(0.95));
}

#[test]
fn neighbouring_disks_overlap_when_they_turn_by_more_than_their_spacing_lets_them() {
    // Disks of radius R at a spacing h on an arc meet at the turn φ with R sin φ = ρ... = h: here by the rims.
    let many = |tension: f64| {
        with("count = 10", "count = 46")
            .replace("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4]", &format!("{:?}", [4; 46]))
            .replace("\"4 N\"", &format!("{tension}"))
            .replace("holes = 12", "holes = 12\nouter_radius = \"30 mm\"")
    };
    // They meet where the radius of the bend is that of the disks: κ R = 1, so that τ = EI / (r R).
    let stiffness = 1.1e9 * core::f64::consts::PI / 64.0 * 0.003_f64.powi(4);
    let meet = stiffness / (0.008 * 0.030);
    assert!(!codes_of_answer(&many(0.9 * meet)).contains(&"disks-overlap"));
    assert!(codes_of_answer(&many(1.1 * meet)).contains(&"disks-overlap"));
}

#[test]
fn the_spacing_of_disks_matters_to_soft_bodies_with_few_of_them() {
    let warning = |text: &str| {
        let file = file(text);
        of_spacing(&disks(), &file.robot, &file.case, &solve(&file, ModelKind::CosseratDisks))
    };
    let Some(Warning::DiskSpacing { change, length, disks }) = warning(&silicone(5)) else {
        panic!("no warning")
    };
    assert!(change > 0.01 * length && disks == 5, "{change}");
    assert_eq!(warning(&silicone(25)), None);
    // The disks of a stiff robot are real.
    assert_eq!(warning(&silicone(5).replace("500 kPa", "50 GPa")), None);
}

#[test]
fn the_paper_s_holes_are_refined_to_the_same_robot() {
    // The model with half the spacing is the model of the same robot: what a straight cable gives does not change.
    let soft = with("\"1.1 GPa\"", "\"5 MPa\"").replace("\"4 N\"", "\"0.008 N\"");
    let file = file(&soft);
    let answer = solve(&file, ModelKind::CosseratDisks);
    assert_eq!(of_spacing(&disks(), &file.robot, &file.case, &answer), None);
}

#[test]
fn no_example_warns() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut seen = 0;
    for folder in [examples.clone(), examples.join("table1"), examples.join("contact")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let file = load(&path).unwrap();
            assert_eq!(render_warnings(&file, &file.warnings(), false), "", "{}", path.display());
            for kind in ModelKind::ALL {
                // Obstacles take long by all models.
                if !file.case.obstacles.is_empty() && kind != ModelKind::Cosserat {
                    continue;
                }
                let model = Model::new(kind, Stations::Disks, Actuation::Natural);
                let Ok(answer) = model.solve(&file.robot, &file.case) else { continue };
                let mut warnings = file.answer_warnings([(None, &answer)]);
                warnings.extend(file.spacing_warning(&model, &answer));
                let text = render_warnings(&file, &warnings, false);
                assert_eq!(text, "", "{kind}: {}", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 30, "{seen}");
}

#[test]
fn json_has_code_message_help_and_place() {
    let file = file(&with("\"1.1 GPa\"", "1100"));
    let json = warnings_json(&file, &file.warnings());
    assert_eq!(
        json,
        serde_json::json!([{
            "code": "bare-number",
            "message": "`backbone.young_modulus` is 1100 without a unit, which is read as 1100 Pa; it looks like MPa",
            "help": "write \"1100 MPa\", or \"1100 Pa\" if that is meant",
            "place": { "file": "robot.toml", "line": 4, "column": 17 },
        }])
    );
    let file = self::file(ROBOT);
    assert_eq!(warnings_json(&file, &unstable(&file))[0]["place"], serde_json::Value::Null);
    assert_eq!(warnings_json(&file, &[]), serde_json::json!([]));
}

#[test]
fn the_same_warning_about_several_answers_is_given_once() {
    let file = file(&with("poisson_ratio", "yield_strain = \"1 %\"\npoisson_ratio"));
    let answer = solve(&file, ModelKind::Cosserat);
    let of = |step| whipcord_io::AnswerOf { model: None, step: Some(step) };
    let warnings = file.answer_warnings((1..=405).map(|step| (Some(of(step)), &answer)));
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].message().ends_with("(step 1, and 404 more answers)"));
}
