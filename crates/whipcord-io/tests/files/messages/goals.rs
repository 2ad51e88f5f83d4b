//! Targets and limits that cannot be used.

use std::fs;

use super::{BACKBONE, CABLE, DISKS, messages, sections, told};
use whipcord_io::load_shape;

fn with(lines: &str) -> String {
    format!("{BACKBONE}{DISKS}{CABLE}{lines}\n")
}

#[test]
fn targets_and_limits() {
    let cases = [
        ("nothing to reach", with("[target]\ntolerance = \"1 mm\"")),
        ("tip and shape", with("[target]\ntip = [0, 0, 0.1]\nshape = \"shape.csv\"")),
        (
            "pose and axis",
            with(
                "[target]\naxis = [0, 0, 1]\n[target.pose]\nposition = [0, 0, 0.1]\norientation = [1, 0, 0, 0]",
            ),
        ),
        ("two coordinates", with("[target]\ntip = [0, 0.1]")),
        ("a unit of something else", with("[target]\ntip = [\"1 N\", 0, 0.1]")),
        ("NaN", with("[target]\ntip = [nan, 0, 0.1]")),
        ("far away", with("[target]\ntip = [0, 0, 1e9]")),
        ("no direction", with("[target]\naxis = [0, 0, 0]")),
        ("no orientation", with("[target.pose]\nposition = [0, 0, 0.1]")),
        (
            "a quaternion of zero",
            with("[target.pose]\nposition = [0, 0, 0.1]\norientation = [0, 0, 0, 0]"),
        ),
        ("no file", with("[target]\nshape = \"nothing.csv\"")),
        ("no tolerance", with("[target]\ntip = [0, 0, 0.1]\ntolerance = 0")),
        ("a wide angle", with("[target]\naxis = [0, 0, 1]\ntolerance_angle = \"2 turn\"")),
        ("a slip of the pen", with("[target]\ntpi = [0, 0, 0.1]")),
        ("no limits", with("[limits]")),
        ("limits the wrong way", with("[limits]\ntension = [\"20 N\", \"1 N\"]")),
        ("a negative tension", with("[limits]\ntension = [\"-1 N\", \"1 N\"]")),
        ("one limit", with("[limits]\ntension = [\"1 N\"]")),
        ("shortenings the wrong way", with("[limits]\nshortening = [\"5 mm\", \"-5 mm\"]")),
        (
            "shortenings the wrong way in two units",
            with("[limits]\nshortening = [\"5 %\", \"1 mm\"]"),
        ),
        ("more than all", with("[limits]\nshortening = [\"0 %\", \"200 %\"]")),
        ("no rate", with("[limits]\nrate = 0")),
        ("a rate of an angle", with("[limits]\nrate = \"5 deg/s\"")),
        ("a limit of one cable", with("tension_limits = [\"3 N\", \"2 N\"]")),
        ("a word for it", with("[prefer]\nleast = \"tensions\"")),
        ("another word", with("[prefer]\nclearance = \"some\"")),
        ("a negative clearance", with("[prefer]\nclearance = \"-1 mm\"")),
        ("no length", with("[prefer]\nclearance = true")),
    ];
    insta::assert_snapshot!(messages(&cases));
}

#[test]
fn shapes() {
    let folder = tempfile::tempdir().unwrap();
    let found = [
        ("empty", ""),
        ("no rows", "disk,x,y,z\n"),
        ("no header", "1,0,0,0\n2,0,0,0.1\n"),
        ("a column is missing", "disk,x,y\n1,0,0\n"),
        ("an unknown column", "disk,x,y,z,w\n1,0,0,0,0\n"),
        ("a slip of the pen", "dsik,x,y,z\n1,0,0,0\n"),
        ("a unit of something else", "disk,x [N],y,z\n1,0,0,0\n"),
        ("twice", "disk,x,y,z,x\n1,0,0,0,0\n"),
        ("no such disk", "disk,x,y,z\n0,0,0,0\n11,0,0,0\n1.5,0,0,0\nbase,0,0,0\n"),
        ("a disk twice", "disk,x,y,z\n3,0,0,0\n3,0,0,0.1\n"),
        ("no number", "disk,x,y,z\n3,0,much,0\n4,,0,0\n5,NaN,0,0\n6,inf,0,0\n"),
        ("far away", "disk,x,y,z\n3,0,0,1e12\n"),
    ];
    let found = found.into_iter().map(|(name, text)| {
        let path = folder.path().join("shape.csv");
        fs::write(&path, text).unwrap();
        let message = match load_shape(&path, 10) {
            Ok(_) => panic!("this file must be refused:\n{text}"),
            Err(error) => told(&error),
        };
        (name, message.replace(&format!("{}/", folder.path().display()), ""))
    });
    insta::assert_snapshot!(sections(found));
}
