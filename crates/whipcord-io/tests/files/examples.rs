//! The files that people start from.
use std::path::{Path, PathBuf};

use whipcord::Routing;
use whipcord_io::{Item, describe, load, parse, table_in_si, toml};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn all() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in [examples(), examples().join("table1"), examples().join("contact")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn every_example_loads() {
    let files = all();
    assert!(files.len() >= 9);
    for path in files {
        if let Err(error) = load(&path) {
            panic!("{error}");
        }
    }
}

#[test]
fn what_was_read_is_written_and_read_again_to_the_last_bit() {
    for path in all() {
        let file = load(&path).unwrap();
        let text = toml(&describe(Some(&file.title), &file.robot, &file.case).unwrap());
        let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again.title, file.title);
        assert_eq!(again.robot.backbone(), file.robot.backbone(), "{text}");
        assert_eq!(again.robot.disks(), file.robot.disks());
        assert_eq!(again.robot.cables(), file.robot.cables());
        assert_eq!(again.case, file.case, "{text}");
    }
}

#[test]
fn every_table_of_an_example_is_one_by_itself() {
    let file = load(examples().join("tapered-arm.toml")).unwrap();
    let all = describe(None, &file.robot, &file.case).unwrap();
    let Some(Item::Table(backbone)) = all.get("backbone") else { panic!() };
    assert_eq!(&table_in_si("backbone", backbone).unwrap(), backbone);
    let mut wrong = backbone.clone();
    wrong.insert("diametre", "3 kg");
    let error = table_in_si("backbone", &wrong).unwrap_err();
    assert_eq!(error.problems.len(), 1);
    assert!(error.to_string().contains("`diameter`"), "{error}");
}

#[test]
fn the_table_is_the_papers() {
    let holes = |name: &str| {
        let file = load(examples().join("table1").join(name)).unwrap();
        let robot = &file.robot;
        assert_eq!(robot.backbone().length, 0.18);
        assert_eq!(robot.disks().count(), 10);
        assert_eq!(robot.disks().holes, Some(12));
        let tension = file.case.commands[0].tension.unwrap();
        assert!((tension - 0.4 * 9.80665).abs() < 1e-15);
        let Routing::Holes { holes, .. } = &robot.cables()[0].routing else { panic!("{name}") };
        (holes.clone(), file)
    };
    let (list, file) = holes("case-1.toml");
    assert_eq!(list, [4; 10]);
    assert_eq!(file.title, "Case I: straight");
    assert_eq!(holes("case-2.toml").0, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    let (list, file) = holes("case-3.toml");
    assert_eq!(list, [1, 2, 3, 4, 4, 4, 4, 3, 2, 1]);
    let reference = file.reference.unwrap();
    assert_eq!(reference.rms_four_bar, Some(1.44e-3));
    assert_eq!(reference.rms_cosserat, Some(1.80e-3));
    assert_eq!(reference.time_four_bar, Some(2.20));
    assert_eq!(reference.time_cosserat, Some(10.07));
    assert_eq!(holes("case-4.toml").0, [10, 10, 10, 10, 10, 10, 11, 12, 1, 2]);
}
