//! Tables of commands and of measurements that cannot be used.

use std::fs;
use std::path::Path;

use super::{sections, told};
use whipcord_io::load;

/// An arm with two motors, whose rows are in `rows.csv`.
const ARM: &str = "[backbone]\nlength = \"200 mm\"\ndiameter = \"1.5 mm\"\n[disks]\ncount = 5\nhole_circle_radius = \"8 mm\"\nholes = 4\n[[cables]]\nname = \"right\"\nholes = [1, 1, 1, 1, 1]\n[[cables]]\nname = \"left\"\nholes = [3, 3, 3, 3, 3]\n[[cables]]\nname = \"up\"\nholes = [2, 2, 2, 2, 2]\n";
const MOTOR: &str = "[[motors]]\nname = \"pan\"\ncables = [\"right\", \"-left\"]\nspool_radius = \"10 mm\"\nangle_limits = [\"-90 deg\", \"90 deg\"]\n";
const COMMANDS: &str = "[commands]\ntable = \"rows.csv\"\n";
const MEASURED: &str = "[measured]\ntable = \"tip.csv\"\n";

/// The message of a robot file with these tables beside it.
fn message(robot: &str, tables: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    tables.iter().for_each(|(name, text)| write(name, text));
    write("arm.toml", robot);
    match load(folder.path().join("arm.toml")) {
        Ok(_) => panic!("this file must be refused:\n{robot}{tables:?}"),
        Err(error) => without(&told(&error), folder.path()),
    }
}

fn without(text: &str, folder: &Path) -> String {
    text.replace(&format!("{}/", folder.display()), "")
}

#[test]
fn tables_of_commands() {
    let arm = format!("{ARM}{MOTOR}{COMMANDS}");
    let of_rows = |rows: &'static str| message(&arm, &[("rows.csv", rows)]);
    let with =
        |more: &str, rows: &'static str| message(&format!("{arm}{more}"), &[("rows.csv", rows)]);
    let found = [
        ("no such file", message(&arm, &[])),
        ("empty", of_rows("")),
        ("no rows", of_rows("pan [deg],up [N]\n")),
        ("no header", of_rows("10,2\n20,3\n")),
        ("a column is missing", of_rows("pan [deg]\n10\n")),
        ("the column of a motor is missing", of_rows("up [N]\n1\n")),
        ("a slip of the pen", of_rows("pam [deg],up [N]\n1,2\n")),
        ("an unknown column", of_rows("pan [deg],up [N],temperature\n1,2,20\n")),
        ("a unit in the name", of_rows("pan_deg,up [N]\n1,2\n")),
        ("a unit of something else", of_rows("pan [mm],up [N]\n1,2\n")),
        ("no unit", of_rows("pan [deg],up\n1,2\n")),
        ("twice", of_rows("pan [deg],motor1 [deg],up [N]\n1,1,2\n")),
        ("motor and cable", of_rows("pan [deg],up [N],left [mm]\n1,2,3\n")),
        ("too few values", of_rows("pan [deg],up [N]\n1,2\n3\n")),
        ("no number", of_rows("pan [deg],up [N]\n1,2\n3,much\n")),
        ("no value", of_rows("pan [deg],up [N]\n1,2\n3,\n")),
        ("NaN", of_rows("pan [deg],up [N]\n1,2\nNaN,2\n")),
        ("infinite", of_rows("pan [deg],up [N]\n1,2\ninf,2\n")),
        ("beyond the limit of the motor", of_rows("pan [deg],up [N]\n1,2\n95,2\n")),
        ("a negative tension", of_rows("pan [deg],up [N]\n1,2\n1,-2\n")),
        ("a length in the wrong unit", of_rows("pan [deg],up [m]\n1,5\n")),
        ("nothing is measured", of_rows("pan [deg],up [N],measured\n1,2,false\n")),
        ("measured or not", of_rows("pan [deg],up [N],measured\n1,2,perhaps\n2,2,\n")),
        ("no column of keys", with("key = \"run\"\n", "pan [deg],up [N],runs\na,1,2\n")),
        ("a key twice", with("key = \"run\"\n", "run,pan [deg],up [N]\na,1,2\nb,2,2\na,3,2\n")),
        ("no key", with("key = \"run\"\n", "run,pan [deg],up [N]\na,1,2\n,2,2\n")),
        (
            "a command of its own",
            message(
                &format!("{ARM}tension = \"1 N\"\n{MOTOR}{COMMANDS}"),
                &[("rows.csv", "pan [deg],up [N]\n1,2\n")],
            ),
        ),
        (
            "friction",
            message(
                &format!("{ARM}friction = 0.1\n{MOTOR}{COMMANDS}"),
                &[("rows.csv", "pan [deg],up [N]\n1,2\n")],
            ),
        ),
        (
            "backlash",
            message(
                &format!("{ARM}{MOTOR}backlash = \"1 deg\"\n{COMMANDS}"),
                &[("rows.csv", "pan [deg],up [N]\n1,2\n")],
            ),
        ),
        (
            "steps besides",
            message(
                &format!(
                    "{ARM}{MOTOR}{COMMANDS}[[steps]]\ntension = [\"1 N\", \"1 N\", \"1 N\"]\n"
                ),
                &[("rows.csv", "pan [deg],up [N]\n1,2\n")],
            ),
        ),
        ("nothing said", message(&format!("{ARM}{MOTOR}[commands]\n"), &[])),
        (
            "no Parquet",
            message(
                &format!("{ARM}{MOTOR}[commands]\ntable = \"rows.csv\"\n"),
                &[("rows.csv", "PAR1 and nothing else")],
            ),
        ),
    ];
    insta::assert_snapshot!(sections(found.into_iter()));
}

#[test]
fn tables_of_measurements_beside_rows() {
    const ROWS: &str = "run,pan [deg],up [N],measured\na,1,2,1\nb,2,2,0\nc,3,2,1\n";
    let arm = format!("{ARM}{MOTOR}{COMMANDS}key = \"run\"\n{MEASURED}");
    let by_key = |tip: &'static str| message(&arm, &[("rows.csv", ROWS), ("tip.csv", tip)]);
    let by_line = |tip: &'static str| {
        let arm = format!("{ARM}{MOTOR}{COMMANDS}ignore = [\"run\"]\n{MEASURED}");
        message(&arm, &[("rows.csv", ROWS), ("tip.csv", tip)])
    };
    let with = |more: &str, tip: &'static str| {
        message(&format!("{arm}{more}"), &[("rows.csv", ROWS), ("tip.csv", tip)])
    };
    let found = [
        ("no column of keys", by_key("x,y,z\n0,0,0.2\n")),
        ("an unknown key", by_key("run,x,y,z\na,0,0,0.2\nd,0,0,0.2\n")),
        ("no key", by_key("run,x,y,z\n,0,0,0.2\n")),
        ("a key twice", by_key("run,x,y,z\na,0,0,0.2\na,0,0,0.2\n")),
        ("too few lines", by_line("x,y,z\n0,0,0.2\n")),
        ("too many lines", by_line("x,y,z\n0,0,0.2\n0,0,0.2\n0,0,0.2\n")),
        ("an unknown column", by_key("run,x,y,z,quality\na,0,0,0.2,1\n")),
        ("a coordinate is missing", by_key("run,x,y\na,0,0\n")),
        ("a part of a position is missing", by_key("run,x,y,z\na,0,,0.2\n")),
        ("nothing was seen", by_key("run,x,y,z\na,,,\n")),
        ("a part of the orientation is missing", by_key("run,x,y,z,qw,qx\na,0,0,0.2,1,0\n")),
        ("an orientation without a number", by_key("run,x,y,z,qw,qx,qy,qz\na,0,0,0.2,1,0,0,\n")),
        ("a quaternion of zero", by_key("run,x,y,z,qw,qx,qy,qz\na,0,0,0.2,0,0,0,0\n")),
        ("no unit quaternion", by_key("run,x,y,z,qw,qx,qy,qz\na,0,0,0.2,0,30,0,90\n")),
        ("another unit", by_key("run,x,y,z\na,0,0,200\nc,100,20,190\n")),
        (
            "a marker without columns",
            with(
                "[[measured.markers]]\nname = \"m1\"\n[[measured.markers]]\nname = \"m2\"\narc_length = \"100 mm\"\n",
                "run,m1.x,m1.y,m1.z\na,0,0,0.2\n",
            ),
        ),
        (
            "a marker beyond the tip",
            with("[[measured.markers]]\narc_length = \"300 mm\"\n", "run,x,y,z\na,0,0,0.2\n"),
        ),
        (
            "two markers of one name",
            with(
                "[[measured.markers]]\nname = \"m1\"\n[[measured.markers]]\nname = \"m1\"\ndisk = 2\n",
                "run,m1.x,m1.y,m1.z\na,0,0,0.2\n",
            ),
        ),
        (
            "markers and disks",
            with("[[measured.markers]]\ndisk = 2\n", "run,disk,x,y,z\na,1,0,0,0.2\n"),
        ),
        (
            "a key without keys",
            message(
                &format!("{ARM}{MOTOR}{COMMANDS}{MEASURED}key = \"run\"\n"),
                &[("rows.csv", "pan [deg],up [N]\n1,2\n"), ("tip.csv", "run,x,y,z\na,0,0,0.2\n")],
            ),
        ),
        ("disks and table", with("disks = \"tip.csv\"\n", "run,x,y,z\na,0,0,0.2\n")),
    ];
    insta::assert_snapshot!(sections(found.into_iter()));
}

/// Each names file, line and remedy.
#[test]
fn tables_that_other_programs_wrote() {
    let arm = format!("{ARM}{MOTOR}{COMMANDS}");
    let measured = format!("{arm}key = \"run\"\n{MEASURED}");
    let rows = "run,pan [deg],up [N]\na,1,2\nb,2,2\n";
    let of_rows = |rows: &str| message(&arm, &[("rows.csv", rows)]);
    let of_tip = |tip: &str| message(&measured, &[("rows.csv", rows), ("tip.csv", tip)]);
    let separators = "save the table with commas, semicolons or tabs";
    for (found, expected) in [
        (
            of_rows("pan [deg]|up [N]\n1|2\n"),
            ["rows.csv:1:1", "the columns are separated by bars", separators],
        ),
        (of_rows("pan up\n1 2\n"), ["rows.csv:1:1", "separated by spaces", separators]),
        (of_tip("run x y z\na 0 0 0.2\n"), ["tip.csv:1:1", "separated by spaces", separators]),
        (
            of_tip("run,x,y,z\na,NaN,0,0.2\n"),
            ["tip.csv:2:1", "a part of the position is missing", "or leave all three empty"],
        ),
        (of_tip(""), ["tip.csv:1:1", "the file has no rows", "the first line names the columns"]),
        (
            of_tip("run,x,y,z\n"),
            ["tip.csv:1:1", "the file has no rows", "the first line names the columns"],
        ),
    ] {
        assert!(expected.iter().all(|part| found.contains(part)), "{found}");
    }
}
