//! What models refuse of files without fault.

use whipcord::{Actuation, Model, ModelKind, Statics as _, Stations};
use whipcord_io::{CaseFile, load, parse};

use crate::common::folder;
use crate::messages::{BACKBONE, CABLE, DISKS};

/// What the models say, at its place, of a file that is without fault in itself.
fn refused(file: &CaseFile) -> String {
    let said = ModelKind::ALL.map(|kind| {
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        match model.solve(&file.robot, &file.case) {
            Ok(_) => format!("{kind} takes it\n"),
            Err(error) => file.locate(&error).unwrap().to_string(),
        }
    });
    said.join("\n")
}

#[test]
fn what_a_model_refuses() {
    let full = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n";
    let both = format!("{CABLE}shortening = \"2 %\"\n");
    let second = "[[cables]]\nname = \"other\"\nholes = [7, 7, 7]\n";
    let cases = [
        ("no young_modulus", format!("{BACKBONE}{DISKS}{both}")),
        ("no poisson_ratio", format!("{BACKBONE}young_modulus = 1e9\n{DISKS}{both}")),
        ("no diameter", format!("{}{DISKS}{both}", full.replace("diameter = \"3 mm\"\n", ""))),
        ("no density", format!("{full}{DISKS}{both}[loads]\ngravity = [0, 0, \"-9.81 m/s^2\"]\n")),
        (
            "no linear_density",
            format!(
                "{}[backbone.stiffness]\nshear = [1, 1]\naxial = 1\nbending = [1, 1]\ntorsion = 1\n{DISKS}{both}[loads]\ngravity = [0, 0, \"-9.81 m/s^2\"]\n",
                BACKBONE.replace("diameter = \"3 mm\"\n", "")
            ),
        ),
        ("a cable that is not pulled", format!("{full}{DISKS}{both}{second}")),
        ("tension alone", format!("{full}{DISKS}{CABLE}")),
        ("a force", format!("{full}{DISKS}{both}[loads]\ntip_force = [\"0.1 N\", 0, 0]\n")),
        (
            "a force along the backbone",
            format!(
                "{full}{DISKS}{both}[[loads.point]]\nat = 0.1\nforce = [0, 0, 0]\n[[loads.point]]\nat = 0.12\nforce = [0, 1e-3, 0]\n"
            ),
        ),
        ("a section that is rolled up", format!("{full}rest_curvature = [0, 400, 0]\n{DISKS}{both}")),
        ("an elastic cable", format!("{full}{DISKS}{both}axial_stiffness = \"2 kN\"\n")),
        (
            "a cable that ends between disks",
            format!("{full}{DISKS}{both}ends_at = \"30 mm\"\n"),
        ),
        (
            "keys of inline tables",
            format!("backbone = {{ length = 0.18 }}\ndisks.count = 4\nloads.tip_force = [0, 1, 0]\n{second}")
                .replace("holes = [7, 7, 7]", "routing = { kind = \"straight\", angle = 0, radius = 0.01 }"),
        ),
    ];
    let told = cases.map(|(name, text)| {
        let file = parse(&text, "robot.toml").unwrap();
        format!("{name}\n{}\n{}", "=".repeat(name.len()), refused(&file))
    });
    insta::assert_snapshot!(told.join("\n"));
}

/// What needs disks says so, and where they are to be given.
#[test]
fn a_body_without_disks() {
    let body =
        "[backbone]\nlength = \"150 mm\"\ndiameter = \"14 mm\"\nmaterial = \"Dragon Skin 30\"\n";
    let curve = "[[cables]]\nname = \"pull\"\nrouting = { kind = \"straight\", angle = 0, radius = \"5 mm\" }\ntension = \"0.5 N\"\nshortening = \"2 mm\"\n";
    let file = parse(format!("{body}{curve}").as_str(), "robot.toml").unwrap();
    assert_eq!(file.warnings(), []);
    let told = ModelKind::ALL.map(|kind| {
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        let told = match model.solve(&file.robot, &file.case) {
            Ok(_) => "takes it\n".to_owned(),
            Err(error) => file.locate(&error).unwrap().to_string(),
        };
        format!("{kind}\n{}\n{told}", "=".repeat(kind.name().len()))
    });
    let holes = curve.replace(
        "routing = { kind = \"straight\", angle = 0, radius = \"5 mm\" }",
        "holes = [1, 1]",
    );
    let taper = body.replace("diameter = \"14 mm\"", "diameters = [\"14 mm\", \"10 mm\"]");
    let bar =
        body.replace("diameter = \"14 mm\"", "section = { width = [0.01, 0.02], height = 0.01 }");
    let refused = crate::messages::messages(&[
        ("holes", format!("{body}{holes}")),
        ("one diameter for each disk", format!("{taper}{curve}")),
        ("one width for each disk", format!("{bar}{curve}")),
        ("an empty table", format!("{body}[disks]\n{curve}")),
    ]);
    insta::assert_snapshot!(format!("{}\n{refused}", told.join("\n")));
}

#[test]
fn what_a_model_refuses_of_a_file_that_extends_another() {
    let folder = folder(&[
        ("base.toml", format!("{BACKBONE}{DISKS}[loads]\ntip_force = [0, 1, 0]\n").as_bytes()),
        ("case.toml", format!("extends = \"base.toml\"\n\n{CABLE}").as_bytes()),
        (
            "stiff.toml",
            format!("extends = \"base.toml\"\n[backbone]\nyoung_modulus = 1e9\n{CABLE}").as_bytes(),
        ),
    ]);
    let told = ["case.toml", "stiff.toml"].map(|name| {
        let text = refused(&load(folder.path().join(name)).unwrap());
        format!("{name}\n\n{}", text.replace(&format!("{}/", folder.path().display()), ""))
    });
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn what_no_file_is_at_fault_for_has_no_place() {
    let text = format!("{BACKBONE}young_modulus = 1e9\npoisson_ratio = 0.3\n{DISKS}{CABLE}");
    let file = parse(&text, "robot.toml").unwrap();
    let model = Model::new(ModelKind::FourBar, Stations::Disks, Actuation::Tension);
    let error = model.solve(&file.robot, &file.case).unwrap_err();
    assert_eq!(file.locate(&error), None, "{error}");
}
