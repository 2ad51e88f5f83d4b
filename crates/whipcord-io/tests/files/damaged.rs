//! Files that were damaged in any way are read or refused, and never more than that.

use std::path::Path;

use proptest::prelude::*;
use whipcord_io::parse;

/// Files without fault, of every kind of table and key.
fn whole_files() -> Vec<String> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut files: Vec<String> = [
        "three-cable-segment.toml",
        "two-segment-arm.toml",
        "helical-finger.toml",
        "precurved-catheter.toml",
        "composite-finger.toml",
        "table1/prototype.toml",
    ]
    .iter()
    .filter_map(|name| std::fs::read_to_string(examples.join(name)).ok())
    .collect();
    assert_eq!(files.len(), 6);
    files.push(
        concat!(
            "title = 'all'\n[backbone]\nlength = 0.3\ndiameters = [0.003, '2 mm', 0.001]\n",
            "inner_diameter = '0.5 mm'\nyoung_modulus = 1e9\nshear_modulus = '400 MPa'\n",
            "rest_curvature = [[0, 0, 1], ['0', '4 1/m', 0], [0, 0, 0]]\n",
            "[disks]\npositions = [0, '10 cm', 0.3]\nhole_circle_radius = [0.01, 0.009, 0.008]\n",
            "holes = 6\n[[cables]]\nholes = [6, 1]\ninterpolation = 'fourier'\nends_at = 0.05\n",
            "friction = '10 %'\naxial_stiffness = '2 kN'\nshortening = '-1 mm'\n[[cables]]\n",
            "routing = { kind = 'polynomial', x = [0.01, 0.1], y = [0, 1e-3] }\n[[cables]]\n",
            "routing.kind = 'linear'\nrouting.start = [0.01, 0]\nrouting.end = ['1 in', '0']\n",
            "[loads]\ngravity = [0, 0, '-1 g0']\nfollower = true\n[[loads.point]]\nat = 0.1\n",
            "moment = ['1 N*mm', 0, 0]\n[reference]\nsource = 'x'\ntime_cosserat = '1 ms'\n",
        )
        .to_owned(),
    );
    files.push(
        concat!(
            "[backbone]\nlength = 0.3\nsection = { width = [0.003, '2 mm'], height = 1e-3, at = [0, 0.3] }\n",
            "rest_curvature = { at = [0, '1 cm', 0.01], values = [[0, 0, 1], [0, 1, 0], [0, 0, 0]] }\n",
            "linear_density = { at = [0, 0.2], values = ['7 g/m', 0.005] }\nshearable = false\n",
            "yield_moment = ['10 mN*m', 0]\nyield_stiffness = 0.04\n",
            "[backbone.stiffness]\nat = [0, 0.1]\naxial = '8 kN'\ntorsion = ['3e3 N*mm^2', 0.002]\n",
            "bending = [[0.004, 0.005], ['4e3 N*mm^2', 0.004]]\n[disks]\ncount = 3\n",
        )
        .to_owned(),
    );
    files.push(
        concat!(
            "[backbone]\nlength = 0.3\n[backbone.stiffness]\nmatrix = [[4, 1, 0, 0, 0, 1], ",
            "[1, 4, 0, 0, 0, 0], [0, 0, 4, 0, 0, 0], [0, 0, 0, 4, 1, 0], [0, 0, 0, 1, 4, 0], ",
            "[1, 0, 0, 0, 0, 4]]\n[disks]\ncount = 3\n",
        )
        .to_owned(),
    );
    files
}

/// One kind of damage.
#[derive(Clone, Debug)]
enum Damage {
    Flip { at: usize, mask: u8 },
    Cut { at: usize },
    Remove { at: usize, length: usize },
    Repeat { at: usize, length: usize, times: usize },
    Insert { at: usize, text: String },
    Number { at: usize, text: String },
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = any::<prop::sample::Index>().prop_map(|index| index.index(4096));
    let syntax = prop::sample::select(vec![
        "[",
        "]",
        "{",
        "}",
        "\"",
        "'",
        "=",
        ".",
        ",",
        "\n",
        "#",
        "[[",
        "\"\"\"",
        "nan",
        "inf",
        "-",
        "1e400",
        "é",
        "\u{0}",
        "[[cables]]\n",
        "extends = \"a\"\n",
        "99999999999999999999",
    ]);
    let number = prop::sample::select(vec![
        "0",
        "-1",
        "nan",
        "-inf",
        "1e308",
        "1e-320",
        "-0.0",
        "4294967296",
        "\"\"",
        "[]",
        "{}",
        "true",
        "\"1e308 GPa\"",
        "[[]]",
        "1979-05-27",
    ]);
    prop_oneof![
        (at.clone(), 1_u8..).prop_map(|(at, mask)| Damage::Flip { at, mask }),
        at.clone().prop_map(|at| Damage::Cut { at }),
        (at.clone(), 1_usize..60).prop_map(|(at, length)| Damage::Remove { at, length }),
        (at.clone(), 1_usize..200, 1_usize..20).prop_map(|(at, length, times)| Damage::Repeat {
            at,
            length,
            times
        }),
        (at.clone(), syntax).prop_map(|(at, s)| Damage::Insert { at, text: s.to_owned() }),
        (at, number).prop_map(|(at, s)| Damage::Number { at, text: s.to_owned() }),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    if bytes.is_empty() {
        return;
    }
    let clamp = |at: usize| at % bytes.len();
    match damage {
        Damage::Flip { at, mask } => {
            let at = clamp(*at);
            bytes[at] ^= mask;
        }
        Damage::Cut { at } => bytes.truncate(clamp(*at)),
        Damage::Remove { at, length } => {
            let at = clamp(*at);
            let end = (at + length).min(bytes.len());
            bytes.drain(at..end);
        }
        Damage::Repeat { at, length, times } => {
            let at = clamp(*at);
            let end = (at + length).min(bytes.len());
            let piece = bytes[at..end].repeat(*times);
            bytes.splice(at..at, piece);
        }
        Damage::Insert { at, text } => {
            let at = clamp(*at);
            bytes.splice(at..at, text.bytes());
        }
        // Puts another value behind the next `=`.
        Damage::Number { at, text } => {
            let at = clamp(*at);
            if let Some(equals) = bytes[at..].iter().position(|&b| b == b'=') {
                let start = at + equals + 1;
                let line = bytes[start..].iter().position(|&b| b == b'\n');
                let end = line.map_or(bytes.len(), |line| start + line);
                bytes.splice(start..end, text.bytes());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn damage_is_answered(which in 0_usize..6, damages in prop::collection::vec(damage(), 1..4)) {
        let mut bytes = whole_files().swap_remove(which).into_bytes();
        for damage in &damages {
            apply(&mut bytes, damage);
        }
        let text = String::from_utf8_lossy(&bytes);
        match parse(&text, "robot.toml") {
            Ok(file) => {
                prop_assert_eq!(file.case.commands.len(), file.robot.cables().len());
            }
            Err(error) => {
                prop_assert!(!error.problems.is_empty());
                let message = error.to_string();
                prop_assert!(message.contains("robot.toml:") && message.contains("help: "));
                prop_assert!(!message.contains('\0'));
            }
        }
    }
}

#[test]
fn the_whole_files_are_without_fault() {
    for text in whole_files() {
        let read = parse(&text, "robot.toml");
        assert!(read.is_ok(), "{}", read.unwrap_err());
    }
}
