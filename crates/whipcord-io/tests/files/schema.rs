//! The JSON Schema against the reader: what one takes, the other takes.
use std::path::{Path, PathBuf};

use boon::{Compiler, Schemas};
use serde_json::{Value, json};
use toml::de::{DeTable, DeValue};
use whipcord_io::schema;

/// Whether the schema takes a robot file.
fn takes(text: &str) -> bool {
    let mut compiler = Compiler::new();
    compiler.add_resource("robot.json", schema()).unwrap();
    let mut schemas = Schemas::new();
    let index = compiler.compile("robot.json", &mut schemas).unwrap();
    let document = DeTable::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    schemas.validate(&to_json(&DeValue::Table(document.into_inner())), index).is_ok()
}

fn to_json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(integer) => json!(integer.as_str().parse::<i64>().unwrap()),
        DeValue::Float(float) => json!(float.as_str().parse::<f64>().unwrap()),
        DeValue::Boolean(flag) => json!(flag),
        DeValue::Datetime(date) => json!(date.to_string()),
        DeValue::Array(items) => items.iter().map(|item| to_json(item.get_ref())).collect(),
        DeValue::Table(table) => table
            .iter()
            .map(|(key, value)| (key.get_ref().to_string(), to_json(value.get_ref())))
            .collect(),
    }
}

const ROBOT: &str =
    "[backbone]\nlength = 0.18\n[disks]\ncount = 10\nholes = 12\nhole_circle_radius = 0.008\n";

const MATRIX: &str = "[[4, 1, 0, 0, 0, 1], [1, 4, 0, 0, 0, 0], [0, 0, 4, 0, 0, 0], [0, 0, 0, 4, 1, 0], [0, 0, 0, 1, 4, 0], [1, 0, 0, 0, 0, 4]]";

fn robot_and(lines: &str) -> String {
    format!("{ROBOT}{lines}")
}

#[test]
fn the_schema_stays_what_it_is() {
    insta::assert_json_snapshot!(schema());
}

#[test]
fn every_example_is_taken() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for folder in [examples.clone(), examples.join("table1")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path: PathBuf = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                assert!(takes(&std::fs::read_to_string(&path).unwrap()), "{}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= 9);
}

#[test]
fn schema_and_reader_agree() {
    let helix = "[[cables]]\nrouting = { kind = \"helix\", turns = 1, radius = 0.008 }\n";
    let good = [
        ROBOT.to_owned(),
        robot_and(helix),
        robot_and("[[cables]]\nholes = [1, 2]\ninterpolation = \"pchip\"\nshortening = \"5 %\"\n"),
        robot_and(
            "[[cables]]\nrouting = { kind = \"linear\", start = [0.008, 0], end = [\"3 mm\", \"0\"] }\n",
        ),
        robot_and("[[cables]]\nrouting = { kind = \"polynomial\", x = [0.008, 0.1], y = [0] }\n"),
        robot_and(
            "[loads]\ngravity = [0, 0, \"-9.81 m/s²\"]\ntip_moment = [\"1 N·mm\", \"+.5e-3 mN*m\", \"0\"]\n",
        ),
        robot_and("[[loads.point]]\nat = \"90mm\"\nforce = [0, 1, 0]\nfollower = true\n"),
        ROBOT.replace("length", "rest_curvature = [\"0\", \"4 1/m\", 0]\nlength"),
        ROBOT.replace("length", "section = { width = \"6 mm\", height = 0.004 }\nlength"),
        ROBOT.replace("length", "diameter = 0.003\ninner_diameter = 0.002\nlength"),
        ROBOT.replace("count = 10", "positions = [0, \"90 mm\", \"180 mm\"]"),
        ROBOT.replace("length", "section = { width = [1, 2], height = 0.004, at = [0, 0.1] }\nlength"),
        ROBOT.replace("length", "diameters = { at = [0], values = [\"3 mm\"] }\nlength"),
        ROBOT.replace("length", "rest_curvature = { at = [0], values = [[0, 1, 0]] }\nlength"),
        ROBOT.replace("length", "linear_density = \"7.4 g/m\"\nextensible = false\nlength"),
        ROBOT.replace("length", "shear_correction = 0.9\nlength"),
        ROBOT.replace("length", "material = \"nitinol\"\nlength"),
        ROBOT.replace("length", "material = \"PTFE\"\nyoung_modulus = \"0.4 GPa\"\nlength"),
        format!("[backbone]\nlength = 0.18\n{helix}"),
        "[backbone]\nlength = 0.18\n".to_owned(),
        robot_and("[[cables]]\nholes = [1, 2]\nremove = false\n"),
        ROBOT.replace("[disks]", "shearable = false\n[backbone.stiffness]\naxial = \"8 kN\"\nbending = [\"4e3 N*mm^2\", 0.004]\ntorsion = \"0.003 N·m²\"\n[disks]"),
        ROBOT.replace("[disks]", &format!("[backbone.stiffness]\nmatrix = {MATRIX}\n[disks]")),
        ROBOT.replace("[disks]", &format!("[backbone.stiffness]\nat = [0, 0.1]\nmatrix = [{MATRIX}, {MATRIX}]\n[disks]")),
    ];
    for text in good {
        assert!(takes(&text), "{text}");
        if let Err(error) = whipcord_io::parse(&text, "robot.toml") {
            panic!("{error}");
        }
    }
    let bad = [
        String::new(),
        "[disks]\ncount = 3\n".to_owned(),
        ROBOT.replace("length", "material = \"unobtainium\"\nlength"),
        ROBOT.replace("length", "material = \"nitinol\"\nlength").replace("[disks]", "stiffness = { bending = [1, 1], torsion = 1, axial = 1, shear = [1, 1] }\n[disks]"),
        robot_and("[[cables]]\nname = \"a\"\nremove = true\n"),
        ROBOT.replace("count = 10", "count = 10\nremove = true"),
        ROBOT.replace("count = 10", "remove = true"),
        ROBOT.replace("length", "lenght"),
        ROBOT.replace("0.18", "\"180\""),
        ROBOT.replace("0.18", "\"180 GPa\""),
        ROBOT.replace("0.18", "true"),
        ROBOT.replace("count = 10", "count = 10.5"),
        ROBOT.replace("count = 10", "count = 1"),
        ROBOT.replace("count = 10", "count = 2\npositions = [0, 0.18]"),
        ROBOT.replace("count = 10\n", ""),
        ROBOT.replace("length", "diameter = 1\ndiameters = [1]\nlength"),
        ROBOT.replace("length", "inner_diameter = 1\nlength"),
        ROBOT.replace("length", "section = { width = 1 }\nlength"),
        ROBOT.replace("length", "section = { width = 1, height = 1, at = [] }\nlength"),
        ROBOT.replace("length", "diameters = { at = [0] }\nlength"),
        ROBOT.replace("length", "rest_curvature = { at = [0], values = [0, 1, 0] }\nlength"),
        ROBOT.replace("length", "linear_density = 1\ndensity = 1\nlength"),
        ROBOT.replace("length", "shear_correction = 0\nlength"),
        ROBOT.replace("length", "extensible = 1\nlength"),
        ROBOT.replace("[disks]", "[backbone.stiffness]\nbending = [1, 1]\n[disks]"),
        ROBOT.replace("[disks]", "[backbone.stiffness]\nbending = 1\ntorsion = 1\n[disks]"),
        ROBOT.replace("[disks]", "[backbone.stiffness]\nshear = [1, 1]\naxial = 1\nbending = [1, 0]\ntorsion = 1\n[disks]"),
        ROBOT.replace("[disks]", &format!("[backbone.stiffness]\ntorsion = 1\nmatrix = {MATRIX}\n[disks]")),
        ROBOT.replace("[disks]", &format!("young_modulus = 1e9\n[backbone.stiffness]\nmatrix = {MATRIX}\n[disks]")),
        ROBOT.replace("[disks]", "[backbone.stiffness]\nmatrix = [[1, 2], [2, 1]]\n[disks]"),
        robot_and("[[cables]]\nname = \"a\"\n"),
        robot_and("[[cables]]\nname = \"\"\nholes = [1, 1]\n"),
        robot_and("[[cables]]\nholes = []\n"),
        robot_and("[[cables]]\nholes = [1]\n"),
        robot_and("[[cables]]\nholes = [1, 1]\ntension = -1\n"),
        robot_and("[[cables]]\nholes = [1, 1]\nfriction = -0.1\n"),
        robot_and("[[cables]]\nholes = [1, 1]\nshortening = 1e7\n"),
        ROBOT.replace("0.18", "0"),
        ROBOT.replace("0.008", "[0.008]"),
        ROBOT.replace("length", "diameter = 0\nlength"),
        ROBOT.replace("length", "diameter = 0.01\ninner_diameter = -0.001\nlength"),
        ROBOT.replace("length", "poisson_ratio = 0.51\nlength"),
        ROBOT.replace("length", "poisson_ratio = -1\nlength"),
        ROBOT.replace("length", "young_modulus = 1e308\nlength"),
        robot_and("[loads]\ngravity = [0, 0, 1e300]\n"),
        robot_and("[[cables]]\nholes = [0, 1]\n"),
        robot_and("[[cables]]\nholes = [1, 2]\ncolour = \"red\"\n"),
        robot_and(&format!("{helix}holes = [1, 2]\n")),
        robot_and("[[cables]]\nrouting = { kind = \"helix\", turn = 1, radius = 0.008 }\n"),
        robot_and("[[cables]]\nrouting = { kind = \"spiral\", turns = 1, radius = 0.008 }\n"),
        robot_and("[[cables]]\nrouting = { radius = 0.008 }\n"),
        robot_and("[[cables]]\nholes = [1, 2]\ninterpolation = \"linear\"\n"),
        robot_and("[loads]\ntip_force = [1, 2]\n"),
        robot_and("[[loads.point]]\nat = 0.09\n"),
        robot_and("[[loads.point]]\nforce = [1, 0, 0]\n"),
        robot_and("[reference]\nrms_cosserat = 0.001\n"),
        robot_and("colour = \"red\"\n"),
    ];
    for text in bad {
        assert!(!takes(&text), "{text}");
        assert!(whipcord_io::parse(&text, "robot.toml").is_err(), "{text}");
    }
}

#[test]
fn a_file_that_extends_another_may_be_incomplete() {
    assert!(takes("extends = \"a.toml\"\n"));
    assert!(takes(
        "extends = \"a.toml\"\n[disks]\nholes = 6\n[backbone]\nsection = { width = 1 }\n"
    ));
    assert!(!takes("extends = \"a.toml\"\n[disks]\nhole = 6\n"));
    assert!(!takes("extends = \"a.toml\"\n[disks]\ncount = 2\npositions = [0, 1]\n"));
    // An entry of [[cables]] may change a cable of the other file. Other arrays replace, so what they hold is complete.
    assert!(takes("extends = \"a.toml\"\n[[cables]]\nname = \"a\"\ntension = 4\n"));
    assert!(takes("extends = \"a.toml\"\n[[cables]]\nname = \"a\"\nremove = true\n"));
    assert!(takes("extends = \"a.toml\"\n[disks]\nremove = true\n"));
    assert!(!takes("extends = \"a.toml\"\n[[cables]]\nname = \"a\"\ntensoin = 4\n"));
    assert!(!takes("extends = \"a.toml\"\n[[loads.point]]\nat = 0.1\n"));
    assert!(!takes("extends = \"a.toml\"\n[[obstacles]]\nkind = \"sphere\"\n"));
}
