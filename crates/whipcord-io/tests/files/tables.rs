//! Tables of commands and of measurements, read.

use std::fs;

use whipcord::{Pose, Shortening, UnitQuaternion, Vec3};
use whipcord_estimation::{Place, Seen};
use whipcord_io::{CaseFile, Commanded, describe, load, parse, toml};

const ARM: &str = "[backbone]\nlength = \"200 mm\"\ndiameter = \"1.5 mm\"\nyoung_modulus = \"60 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 5\nhole_circle_radius = \"8 mm\"\nholes = 4\n[[cables]]\nname = \"right\"\nholes = [1, 1, 1, 1, 1]\n[[cables]]\nname = \"left\"\nholes = [3, 3, 3, 3, 3]\n[[cables]]\nname = \"up\"\nholes = [2, 2, 2, 2, 2]\n[[motors]]\nname = \"pan\"\ncables = [\"right\", \"-left\"]\nspool_radius = \"10 mm\"\n";

fn read(tail: &str, tables: &[(&str, &[u8])]) -> CaseFile {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in tables {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    fs::write(folder.path().join("arm.toml"), format!("{ARM}{tail}")).unwrap();
    load(folder.path().join("arm.toml")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn rows_are_steps() {
    let rows = b"# a log\nrun; time (ms); pan [deg]; UP [N]; group; measured; note\n\na; 100; 90,5; 2; g1; true; x\nb; 200; -45; 0; ; 0; y\n";
    let tail = "[commands]\ntable = \"rows.csv\"\nkey = \"run\"\nignore = [\"note\", \"UP\"]\n";
    let with_up =
        ARM.replace("holes = [2, 2, 2, 2, 2]\n", "holes = [2, 2, 2, 2, 2]\ntension = \"3 N\"\n");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rows.csv"), rows).unwrap();
    fs::write(folder.path().join("arm.toml"), format!("{with_up}{tail}")).unwrap();
    let file = load(folder.path().join("arm.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert!(file.case.independent);
    let degree = core::f64::consts::PI / 180.0;
    assert_eq!(file.case.motors.len(), 2);
    assert!((file.case.motors[0][0].unwrap() - 90.5 * degree).abs() < 1e-12);
    // A cable without a column keeps its own command.
    assert_eq!(file.case.before[0][2].tension, Some(3.0));
    let Some(Shortening::Length(left)) = file.case.commands[1].shortening else { panic!() };
    assert!((left - 0.010 * 45.0 * degree).abs() < 1e-15);
    let table = file.commands.unwrap();
    let lines: Vec<usize> = table.rows.iter().map(|row| row.line).collect();
    assert_eq!(lines, [4, 5]);
    assert_eq!(table.rows[0].time, Some(0.1));
    assert_eq!(
        (table.rows[0].group.as_deref(), table.rows[1].group.as_deref()),
        (Some("g1"), None)
    );
    assert_eq!((table.rows[0].is_measured, table.rows[1].is_measured), (true, false));
    assert_eq!((table.label(1).as_str(), table.commands.len()), ("b", 1));
    assert_eq!(table.commands[0].of, Commanded::Motor(0));
}

#[test]
fn rows_have_loads_of_their_own() {
    let rows = b"pan [deg],tip_force.x [mN],loads.tip_force_z [N],gravity.y\n10,50,0.1,-9.81\n20,0,-0.2,9.81\n30,-20,0,0\n";
    let tail = "[commands]\ntable = \"rows.csv\"\n[loads]\ntip_moment = [\"0 N*m\", \"1 mN*m\", \"0 N*m\"]\n";
    let up = "holes = [2, 2, 2, 2, 2]\ntension = \"3 N\"\n";
    let folder = tempfile::tempdir().unwrap();
    let arm = ARM.replace("holes = [2, 2, 2, 2, 2]\n", up);
    fs::write(folder.path().join("rows.csv"), rows).unwrap();
    fs::write(folder.path().join("arm.toml"), format!("{arm}{tail}")).unwrap();
    let file = load(folder.path().join("arm.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.case.loads_before.len(), 2);
    assert_eq!(file.case.loads_before[0].tip_force, Vec3::new(0.05, 0.0, 0.1));
    assert_eq!(file.case.loads_before[1].gravity, Some(Vec3::new(0.0, 9.81, 0.0)));
    assert_eq!(file.case.loads.tip_force, Vec3::new(-0.02, 0.0, 0.0));
    // What no column gives is that of the file in all rows.
    let moment = Vec3::new(0.0, 1e-3, 0.0);
    assert!(file.case.loads_before.iter().all(|loads| loads.tip_moment == moment));
}

#[test]
fn columns_have_many_names() {
    let of = |header: &str, units: &str| {
        let tail = format!("[commands]\ntable = \"rows.csv\"\n{units}");
        let rows = format!("{header}\n2,3\n");
        read(&tail, &[("rows.csv", rows.as_bytes())])
    };
    let turn = core::f64::consts::TAU;
    for (header, units, pan, up) in [
        ("pan,up.tension", "", 2.0, 3.0),
        ("pan [turn],up [N]", "", 2.0 * turn, 3.0),
        ("Motor 1 (turn),cable3.tension [kN]", "", 2.0 * turn, 3e3),
        ("motor-1.angle,cable_3_tension", "units = [\"turn\", \"kN\"]\n", 2.0 * turn, 3e3),
        ("pan.angle [rad],up_force", "units = [\"turn\"]\n", 2.0, 3.0),
    ] {
        let file = of(header, units);
        let found = file.case.motors[0][0].unwrap();
        assert!((found - pan).abs() < 1e-12, "{header}: {found}");
        assert_eq!(file.case.commands[2].tension, Some(up), "{header}");
    }
    let file = of("pan,up [%]", "");
    assert_eq!(file.case.commands[2].shortening, Some(Shortening::Fraction(0.03)));
    let file = of("pan,up.shortening [mm]", "");
    assert_eq!(file.case.commands[2].shortening, Some(Shortening::Length(0.003)));
}

#[test]
fn backlash_remembers_rows_in_order_and_forgets_independent_ones() {
    let rows = b"pan [deg],up [N]\n20,1\n19,1\n";
    let of = |each: &str| {
        let tail =
            format!("backlash = \"4 deg\"\n[commands]\ntable = \"rows.csv\"\neach = \"{each}\"\n");
        read(&tail, &[("rows.csv", rows)]).case
    };
    let right = |case: &whipcord::Case| {
        case.commands[0].shortening.map(|s| s.in_metres(1.0).to_degrees() / 0.01).unwrap()
    };
    let (in_order, independent) = (of("in order"), of("independent"));
    assert!((right(&in_order) - 18.0).abs() < 1e-9 && !in_order.independent);
    assert!((right(&independent) - 17.0).abs() < 1e-9 && independent.independent);
    // The last step alone has the history that matters.
    let last = |case: &whipcord::Case| case.single_steps().last().unwrap().motors.len();
    assert_eq!((last(&in_order), last(&independent)), (2, 1));
}

#[test]
fn measurements_find_their_rows() {
    let rows: &[u8] = b"run,pan [deg],up [N],measured\na,1,2,1\nb,2,2,0\nc,3,2,1\n";
    let measured = |commands: &str, tail: &str, tip: &[u8]| {
        let tail = format!(
            "[commands]\ntable = \"rows.csv\"\n{commands}[measured]\nunit = \"mm\"\n{tail}"
        );
        let file = read(&tail, &[("rows.csv", rows), ("tip.csv", tip)]);
        let measured = file.measured.unwrap();
        let found = measured.observations.iter().map(|of| match of.seen {
            Seen::Position(at) => (of.step, of.place, of.offset, at),
            _ => panic!("only positions"),
        });
        (found.collect::<Vec<_>>(), measured.rotations)
    };
    let (tip, at) = (Place::Disk(4), Vec3::new(0.01, 0.02, 0.19));
    let key = "key = \"run\"\n";
    let table = "table = \"tip.csv\"\n";
    // By keys, in any order; those of rows that are not measured do not count.
    let (found, _) = measured(key, table, b"x,y,z,run\n10,20,190,c\n1,1,1,b\n");
    assert_eq!(found, [(2, tip, Vec3::ZERO, at)]);
    // Line by line.
    let (found, _) = measured("ignore = [\"run\"]\n", table, b"time,x,y,z\n0,,,\n1,10,20,190\n");
    assert_eq!(found, [(2, tip, Vec3::ZERO, at)]);
    // By the number of the row, with several markers in lines of their own.
    let (found, _) = measured(key, table, b"step,disk,x,y,z\n1,5,10,20,190\n1,3,1,2,90\n");
    assert_eq!(found[0].1, Place::Disk(2));
    assert_eq!((found[1].0, found[1].1), (0, tip));
    // Several markers in one line, and an offset of the tracked body with its orientation.
    let markers = "table = \"tip.csv\"\noffset = [\"1 mm\", 0, \"5 mm\"]\n[[measured.markers]]\nname = \"m1\"\narc_length = \"50 mm\"\noffset = [0, \"8 mm\", 0]\n[[measured.markers]]\nname = \"tool\"\n";
    let line = b"run,m1_x,m1_y,m1_z,tool.x [cm],tool.y,tool.z,tool.qw,tool.qx,tool.qy,tool.qz\na,1,2,50,1,20,190,1,0,0,0\nc,,,,1,20,190,0,0,0,0.99\n";
    let (found, rotations) = measured(key, markers, line);
    assert_eq!(found.len(), 3);
    assert_eq!(found[0], (0, tip, Vec3::new(0.001, 0.0, 0.005), at));
    assert_eq!((found[1].1, found[1].2), (Place::ArcLength(0.05), Vec3::new(0.0, 0.008, 0.0)));
    assert_eq!((rotations.len(), rotations[1].step), (2, 2));
    // Rounded to two decimals.
    assert_eq!(rotations[1].rotation.wxyz(), [0.0, 0.0, 0.0, 1.0]);
}

/// Orientations are fitted where their arm is given, with the deviation of the position beside them.
#[test]
fn orientations_are_fitted_where_their_arm_is_given() {
    let rows = b"pan [deg],up [N],x,y,z,qw,qx,qy,qz,deviation\n1,2,0,0,0.2,1,0,0,0,1e-4\n2,2,0,0,0.1,,,,,2e-4\n3,2,0.01,0,0.19,0,0,0,1,3e-4\n";
    let tail = |keys: &str| {
        format!("[commands]\ntable = \"log.csv\"\n[measured]\ntable = \"log.csv\"\n{keys}")
    };
    let of = |keys: &str| read(&tail(keys), &[("log.csv", rows)]).measured.unwrap();
    let plain = of("");
    assert_eq!(plain.fitted(), plain.observations);
    let measured = of("orientation_arm = \"50 mm\"\n");
    let fitted = measured.fitted();
    assert_eq!((fitted.len(), &fitted[..3]), (5, &measured.observations[..]));
    let turned: Vec<_> = fitted[3..].iter().map(|of| (of.step, of.seen, of.deviation)).collect();
    let seen =
        |wxyz| Seen::Rotation { rotation: UnitQuaternion::from_wxyz(wxyz).unwrap(), arm: 0.05 };
    let expected =
        [(0, seen([1.0, 0.0, 0.0, 0.0]), Some(1e-4)), (2, seen([0.0, 0.0, 0.0, 1.0]), Some(3e-4))];
    assert_eq!(turned, expected);
}

#[test]
fn commands_and_measurements_may_share_a_file() {
    let rows =
        b"pan [deg],up [N],measured,x,y,z\n1,2,1,0,0,0.2\n2,2,0,0,0,0.1\n3,2,1,0.01,0,0.19\n";
    let tail = "[commands]\ntable = \"log.csv\"\n[measured]\ntable = \"log.csv\"\n";
    let file = read(tail, &[("log.csv", rows)]);
    let steps: Vec<usize> = file.measured.unwrap().observations.iter().map(|of| of.step).collect();
    assert_eq!(steps, [0, 2]);
}

#[test]
fn independent_steps_are_written_and_read_again() {
    let rows = b"pan [deg],up [N]\n20,1\n19,1\n";
    let file = read("[commands]\ntable = \"rows.csv\"\n", &[("rows.csv", rows)]);
    let mut case = file.case.clone();
    // A robot file has commands of all motors or cables in a step, or of none.
    for step in case.before.iter_mut().chain([&mut case.commands]) {
        step[2].tension = None;
    }
    let text = toml(&describe(None, &file.robot, &case).unwrap());
    assert!(text.contains("each = \"independent\""), "{text}");
    let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!((again.case.base, again.case), (Pose::IDENTITY, case));
}

#[test]
fn a_motor_that_must_go_too_fast_is_told_of() {
    let rows = b"time (s),pan [deg],up [N]\n0,0,1\n1,5,1\n2,40,1\n2.5,55,1\n9,50,1\n".as_slice();
    let warnings = |each: &str| {
        let tail = format!(
            "rate_limit = \"20 deg/s\"\n[commands]\ntable = \"rows.csv\"\neach = \"{each}\"\n"
        );
        let file = read(&tail, &[("rows.csv", rows)]);
        let rates = file.warnings().into_iter().filter(|of| of.warning.code() == "motor-rate");
        rates.map(|of| (of.place(&file).is_some(), of.message())).collect::<Vec<_>>()
    };
    let [(true, message)] = &warnings("in order")[..] else { panic!() };
    assert_eq!(
        message,
        "motor `pan` must go at 35 °/s to `line 4`, but goes at 20 °/s at most; it must go too fast to 1 other row"
    );
    // Rows for themselves are of no motion.
    assert_eq!(warnings("independent"), []);
}

/// What spreadsheets and other systems write around the same cells.
#[test]
fn marks_of_order_line_ends_and_quotes_do_not_matter() {
    let plain = "run,pan [deg],up [N]\na,20,1\nb,19.5,1\n";
    let quoted: String = plain
        .lines()
        .map(|line| {
            line.split(',').map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",") + "\n"
        })
        .collect();
    let tail = "[commands]\ntable = \"rows.csv\"\nkey = \"run\"\n";
    let of = |text: &str| read(tail, &[("rows.csv", text.as_bytes())]).case;
    let expected = of(plain);
    for text in [
        format!("\u{feff}{plain}"),
        plain.replace('\n', "\r\n"),
        plain.replace(',', "\t"),
        plain.replace(',', ";").replace("19.5", "19,5"),
        format!("\n# a log\n{plain}\n\n"),
        plain.trim_end().to_owned(),
        quoted,
    ] {
        assert_eq!(of(&text), expected, "{text}");
    }
}
