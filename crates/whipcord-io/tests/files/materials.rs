//! Materials by name: what files make of them, and the table in the documentation.
use std::path::Path;

use whipcord::{Actuation, Material, Model, ModelKind, Statics, Stations};
use whipcord_io::{
    Item, MaterialPreset, Shear, Table, describe, load, materials, parse, table_in_si, toml,
};

use crate::common::folder;

fn robot(backbone: &str) -> String {
    format!(
        "[backbone]\nlength = \"180 mm\"\ndiameter = \"1 mm\"\n{backbone}\n[disks]\ncount = 10\n\
         [[cables]]\nname = \"pull\"\nrouting = {{ kind = \"straight\", angle = 0, radius = \"8 mm\" }}\ntension = \"1 uN\"\n"
    )
}

fn material(backbone: &str) -> Material {
    let file = parse(&robot(backbone), "robot.toml").unwrap_or_else(|error| panic!("{error}"));
    file.robot.backbone().material
}

fn preset(name: &str) -> &'static MaterialPreset {
    materials().iter().find(|preset| preset.name == name).unwrap()
}

#[test]
fn every_material_is_a_robot_that_can_be_solved_without_a_warning() {
    for preset in materials() {
        let text = robot(&format!("material = \"{}\"", preset.name));
        let file = parse(&text, "robot.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(file.warnings(), [], "{}", preset.name);
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
        let tip = model.solve(&file.robot, &file.case).unwrap().disks.tip();
        // One straight cable bends by u = τ r / EI.
        let stiffness = preset.young_modulus * std::f64::consts::PI * 0.001_f64.powi(4) / 64.0;
        let bend = 1e-6 * 0.008 * 0.18 / stiffness;
        let found = tip.rotation.log().norm();
        assert!((found / bend - 1.0).abs() < 1e-3, "{}: {found} for {bend}", preset.name);
    }
}

/// The speed of sound in a thin bar, √(E/ρ), is known to a few per cent from other experiments than those of modulus and
/// density: CRC Handbook of Chemistry and Physics, speed of sound in various media (mild steel, stainless steel 347, titanium,
/// rolled aluminium; thin rods).
#[test]
fn metals_carry_sound_as_fast_as_they_do() {
    for (name, speed) in [
        ("spring steel", 5200.0),
        ("stainless steel", 5000.0),
        ("titanium grade 5", 5080.0),
        ("aluminium 6061", 5000.0),
    ] {
        let preset = preset(name);
        let found = (preset.young_modulus / preset.density).sqrt();
        assert!((found / speed - 1.0).abs() < 0.025, "{name}: {found} m/s");
    }
}

#[test]
fn every_value_lies_in_its_range() {
    for (i, preset) in materials().iter().enumerate() {
        let [least, greatest] = preset.young_modulus_range;
        assert!(least <= preset.young_modulus && preset.young_modulus <= greatest, "{preset:?}");
        assert!(least < greatest && preset.density > 800.0 && preset.density < 9000.0);
        match preset.shear {
            Shear::PoissonRatio(ratio) => assert!(ratio > 0.2 && ratio < 0.5, "{preset:?}"),
            // Far below E/2(1 + ν) with the ratios of isotropic materials: fibres.
            Shear::Modulus(modulus) => assert!(modulus < 0.2 * preset.young_modulus),
        }
        assert!(materials()[..i].iter().all(|other| other.name != preset.name));
        assert!(preset.source.len() > 20);
    }
}

#[test]
fn keys_beside_the_name_take_the_place_of_single_values() {
    let whole = material("material = \"nitinol\"");
    assert_eq!(whole.name, Some("nitinol"));
    assert_eq!((whole.young_modulus, whole.poisson_ratio), (Some(60e9), Some(0.33)));
    assert_eq!((whole.density, whole.yield_strain), (Some(6450.0), Some(0.06)));
    let own =
        material("material = \"nitinol\"\nyoung_modulus = \"58 GPa\"\nyield_strain = \"8 %\"");
    let expected = Material { young_modulus: Some(58e9), yield_strain: Some(0.08), ..whole };
    assert_eq!(own, expected);
    let sheared = material("material = \"nitinol\"\nshear_modulus = \"20 GPa\"");
    assert_eq!((sheared.poisson_ratio, sheared.shear_modulus), (None, Some(20e9)));
    let fibres = material("material = \"carbon fibre rod\"\npoisson_ratio = 0.3");
    assert_eq!((fibres.poisson_ratio, fibres.shear_modulus), (Some(0.3), None));
    let heavy = material("material = \"nitinol\"\nlinear_density = \"7 g/m\"");
    assert_eq!(heavy.density, None);
}

#[test]
fn a_material_laid_over_another_file_takes_the_place_of_its_numbers() {
    let base = robot("young_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\ndensity = 1040\n");
    let over = |name: &str, lines: &str| {
        let folder = folder(&[
            ("base.toml", base.as_str()),
            ("named.toml", "extends = \"base.toml\"\nbackbone.material = \"PTFE\"\n"),
            (name, lines),
        ]);
        load(folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"))
    };
    let named = over("robot.toml", "extends = \"base.toml\"\nbackbone.material = \"PTFE\"\n");
    assert_eq!(named.robot.backbone().material, material("material = \"PTFE\""));
    // And the other way round a number takes the place of one of the material's.
    let number = over("robot.toml", "extends = \"named.toml\"\nbackbone.young_modulus = 1e9\n");
    let expected = material("material = \"PTFE\"\nyoung_modulus = 1e9");
    assert_eq!(number.robot.backbone().material, expected);
    let stiffness = "extends = \"named.toml\"\n[backbone.stiffness]\nbending = [1, 1]\ntorsion = 1\naxial = 1\nshear = [1, 1]\n";
    assert_eq!(over("robot.toml", stiffness).robot.backbone().material, Material::default());
    let folder = folder(&[("base.toml", base.as_str())]);
    let settings = ["backbone.material=PTFE".to_owned()];
    let set = whipcord_io::load_with(folder.path().join("base.toml"), &settings).unwrap();
    assert_eq!(set.robot.backbone().material, material("material = \"PTFE\""));
}

#[test]
fn what_is_written_keeps_the_name_and_the_numbers() {
    for lines in [
        "material = \"nitinol\"",
        "material = \"carbon fibre rod\"\nyoung_modulus = \"140 GPa\"",
        "material = \"TPU 85A\"\nlinear_density = \"7 g/m\"",
        "material = \"Ecoflex 00-30\"\nshear_modulus = \"30 kPa\"",
    ] {
        let file = parse(&robot(lines), "robot.toml").unwrap();
        let text = toml(&describe(None, &file.robot, &file.case).unwrap());
        assert!(text.contains("material = ") && text.contains("young_modulus = "), "{text}");
        let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again.robot.backbone(), file.robot.backbone(), "{text}");
        // A mass per length that is written beside the name does need gravity.
        assert_eq!(again.warnings().len(), usize::from(lines.contains("linear_density")), "{text}");
    }
}

/// A table by itself, as Python makes one, has the numbers as well.
#[test]
fn a_table_by_itself_has_the_numbers_of_its_material() {
    let mut backbone = Table::default();
    backbone.insert("length", "180 mm");
    backbone.insert("material", "PEEK");
    backbone.insert("density", 1310.0);
    let table = table_in_si("backbone", &backbone).unwrap();
    assert_eq!(table.get("material"), Some(&Item::Text("PEEK".to_owned())));
    assert_eq!(table.get("young_modulus"), Some(&Item::Number(3.8e9)));
    assert_eq!(table.get("density"), Some(&Item::Number(1310.0)));
    assert_eq!(table.get("shear_modulus"), None);
    assert_eq!(table_in_si("backbone", &table).unwrap(), table);
}

/// A modulus that is estimated is written below the name of the material.
#[test]
fn a_fitted_number_stands_beside_the_name() {
    let text = robot("material = \"nitinol\"   # wire of 1 mm");
    let file = parse(&text, "robot.toml").unwrap();
    let mut backbone = file.robot.backbone().clone();
    backbone.material.young_modulus = Some(5.5e10);
    let fitted =
        whipcord::Robot::new(backbone, file.robot.disks().clone(), file.robot.cables().to_vec())
            .unwrap();
    let written =
        file.with_numbers_of(&fitted, &file.case, whipcord::Vec3::ZERO, Path::new(".")).unwrap();
    assert!(written.keeps_text, "{}", written.text);
    assert!(written.text.contains("# wire of 1 mm"), "{}", written.text);
    let again = parse(&written.text, "again.toml").unwrap();
    assert_eq!(again.robot.backbone(), fitted.backbone());
}

/// A number with three digits and a unit as the documentation has it.
fn modulus(values: &[f64]) -> String {
    let greatest = values.iter().copied().fold(0.0, f64::max);
    let (unit, scale) = match greatest {
        g if g >= 1e9 => ("GPa", 1e9),
        g if g >= 1e6 => ("MPa", 1e6),
        _ => ("kPa", 1e3),
    };
    let numbers: Vec<String> =
        values.iter().map(|value| format!("{}", (value / scale * 1e4).round() / 1e4)).collect();
    format!("{} {unit}", numbers.join("–"))
}

fn row(preset: &MaterialPreset) -> String {
    let shear = match preset.shear {
        Shear::PoissonRatio(ratio) => format!("ν = {ratio}"),
        Shear::Modulus(value) => format!("G = {}", modulus(&[value])),
    };
    let percent = |strain: f64| format!("{} %", (strain * 1e4).round() / 1e2);
    format!(
        "| `\"{}\"` | {} | {} | {shear} | {} kg/m³ | {} | {} |",
        preset.name,
        modulus(&[preset.young_modulus]),
        modulus(&preset.young_modulus_range),
        preset.density,
        preset.yield_strain.map_or("–".to_owned(), percent),
        preset.source,
    )
}

/// `UPDATE_DOCS=1` writes the table anew.
#[test]
fn the_documentation_has_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/materials.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let head = "|---|---|---|---|---|---|---|\n";
    let (before, rest) = text.split_once(head).unwrap();
    let end = rest.find("\n\n").map_or(rest.len(), |end| end + 1);
    let table: String = materials().iter().map(|preset| row(preset) + "\n").collect();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, format!("{before}{head}{table}{}", &rest[end..])).unwrap();
        return;
    }
    assert_eq!(&rest[..end], table, "run this test with UPDATE_DOCS=1");
}
