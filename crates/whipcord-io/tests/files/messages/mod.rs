//! What people are told about files that cannot be used. Each snapshot holds the messages of a
//! group of files; read them as a user would.
mod aliases;
mod cameras;
mod files;
mod goals;
mod models;
mod motors;
mod obstacles;
mod tables;
mod warnings;

use whipcord_io::{FileError, parse};

/// A file without fault, into which the cases put one.
const BACKBONE: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\n";
const DISKS: &str = "[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n";
const CABLE: &str = "[[cables]]\nname = \"pull\"\nholes = [1, 2, 3]\ntension = \"4 N\"\n";

/// The message of a text, which must be refused.
fn message(text: &str) -> String {
    match parse(text, "robot.toml") {
        Ok(_) => panic!("this file must be refused:\n{text}"),
        Err(error) => told(&error),
    }
}

/// The message of an error, whose every problem must have a place and a remedy.
fn told(error: &FileError) -> String {
    assert!(!error.problems.is_empty());
    for problem in &error.problems {
        let source = error.sources.get(problem.span.file).unwrap();
        let position = source.position(problem.span.start);
        let place = format!("{}:{}:{}: error:", source.name(), position.line, position.column);
        assert!(error.to_string().contains(&place) || error.problems.len() > 10, "{place}");
        assert!(!problem.problem.help().is_empty());
    }
    error.to_string()
}

/// The messages of several texts, each under its name.
fn messages<T: AsRef<str>>(cases: &[(&str, T)]) -> String {
    sections(cases.iter().map(|(name, text)| (*name, message(text.as_ref()))))
}

fn sections<'a>(messages: impl Iterator<Item = (&'a str, String)>) -> String {
    let sections = messages.map(|(name, message)| {
        let rule = "=".repeat(name.len());
        format!("{name}\n{rule}\n{message}")
    });
    sections.collect::<Vec<_>>().join("\n")
}

fn with_backbone(lines: &str) -> String {
    format!("[backbone]\n{lines}\n{DISKS}{CABLE}")
}

fn with_disks(lines: &str) -> String {
    format!("{BACKBONE}\n[disks]\n{lines}\n")
}

fn with_cable(lines: &str) -> String {
    format!("{BACKBONE}{DISKS}\n[[cables]]\n{lines}\n")
}

fn fit(lines: &str) -> String {
    format!("{BACKBONE}{DISKS}\n[fit]\n{lines}\n")
}

fn with_loads(lines: &str) -> String {
    format!("{BACKBONE}{DISKS}\n[loads]\n{lines}\n")
}

#[test]
fn no_robot_file_at_all() {
    let text = messages(&[
        ("an empty file", String::new()),
        ("only a comment", "# to do\n".to_owned()),
        ("something else in TOML", "[package]\nname = \"a\"\nversion = \"1\"\n".to_owned()),
        ("JSON", "{\"backbone\": {\"length\": 0.18}}\n".to_owned()),
        ("YAML", "backbone:\n  length: 180 mm\n".to_owned()),
        ("one long line", "x".repeat(1_000_000)),
        ("control characters", "\u{1}\u{1b}[31m\u{7}".to_owned()),
        ("no [backbone]", DISKS.to_owned()),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn not_toml() {
    let cases = [
        ("a unit without quotes", "length = 180 mm"),
        ("no value", "length ="),
        ("no end of a text", "length = \"180 mm"),
        ("two equals signs", "length == \"180 mm\""),
        ("no key", "= \"180 mm\""),
        ("a key twice", "length = \"180 mm\"\nlength = \"170 mm\""),
        ("no comma", "length = 0.18\ndiameters = [1 2]"),
        ("a list without end", "length = 0.18\ndiameters = [1, 2\n"),
        ("a table twice", "length = 0.18\n[backbone]\ndiameter = 0.003"),
        ("a table without bracket", "length = 0.18\n[disks\ncount = 3"),
        ("a decimal comma", "length = 0,18"),
        ("an unknown escape", "length = \"180\\q mm\""),
        ("a key in Greek", "μήκος = \"180 mm\""),
    ]
    .map(|(name, lines)| (name, format!("[backbone]\n{lines}\n")));
    let text = messages(&cases);
    insta::assert_snapshot!(text);
}

#[test]
fn nested_too_deeply() {
    let cases = [
        ("lists", format!("x = {}", "[".repeat(100_000))),
        ("tables", format!("x = {}", "{a=".repeat(100_000))),
        ("a dotted key", format!("{}a = 1", "a.".repeat(100_000))),
        ("a dotted table", format!("[{}a]", "a.".repeat(100_000))),
        ("dotted keys in tables", format!("x = {}", "{a.b.c.d.e.f.g.h=".repeat(10_000))),
    ];
    let text = messages(&cases);
    insta::assert_snapshot!(text);
}

#[test]
fn keys() {
    let text = messages(&[
        ("a slip", with_backbone("lenght = \"180 mm\"\ndiameter = \"3 mm\"")),
        ("capitals", with_backbone("length = \"180 mm\"\nDiameter = \"3 mm\"")),
        ("hyphens", with_backbone("length = \"180 mm\"\nyoung-modulus = \"1 GPa\"")),
        ("part of the name", with_disks("count = 3\nradius = \"8 mm\"")),
        ("a key of another table", with_backbone("length = \"180 mm\"\nholes = 12")),
        ("nothing like it", with_cable("holes = [1, 2]\ncolour = \"red\"")),
        ("a table's slip", format!("{BACKBONE}[disk]\ncount = 10\n")),
        ("outside the tables", format!("length = 0.18\n{BACKBONE}{DISKS}")),
        ("in a routing", with_cable("routing = { kind = \"helix\", turn = 1, radius = 0.008 }")),
        ("several", "titel = \"x\"\n[backbone]\nlenght = 1\n[disks]\ncuont = 3\n".to_owned()),
        ("single brackets", format!("{BACKBONE}{DISKS}[cables]\nholes = [1, 2]\n")),
        ("double brackets", format!("{DISKS}[[backbone]]\nlength = 1\n")),
        ("a table that is a value", format!("backbone = 3\n{DISKS}")),
        ("control characters", with_backbone("length = 0.18\n\"\\u0007\\u001b[2J\" = 1")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn units() {
    let lines = [
        ("no unit", "length = \"180\""),
        ("a unit of something else", "length = \"180 GPa\""),
        ("no such unit", "length = \"180 furlongs\""),
        ("capitals", "length = 1\nyoung_modulus = \"1.1 gpa\""),
        ("no number", "length = \"long\""),
        ("a comma", "length = \"0,18 m\""),
        ("an empty text", "length = \"\""),
        ("nan with a unit", "length = \"nan mm\""),
        ("too large", "length = \"1e400 mm\""),
        ("a ratio without quotes to spare", "length = 1\npoisson_ratio = \"0.3\""),
        ("a ratio with a unit", "length = 1\npoisson_ratio = \"0.3 mm\""),
        ("one entry of a list", "length = 1\nrest_curvature = [0, \"4 m\", 0]"),
        ("a word for a unit", "length = \"0.18 meters\""),
        ("inches as on a drawing", "length = \"7\\\"\""),
        ("a unit that could be two", "length = 1\nyoung_modulus = \"1 mpa\""),
    ];
    let mut cases: Vec<_> = lines.map(|(name, lines)| (name, with_backbone(lines))).into();
    cases.push(("a mass for a force", with_cable("holes = [1, 2]\ntension = \"400 g\"")));
    cases.push(("a mass for a force, in kg", with_cable("holes = [1, 2]\ntension = \"0.4 kg\"")));
    cases.push(("pounds for a force", with_cable("holes = [1, 2]\ntension = \"2 lb\"")));
    cases.push(("pounds in the plural", with_cable("holes = [1, 2]\ntension = \"2 lbs\"")));
    cases.push(("milli or mega", with_cable("holes = [1, 2]\ntension = \"400 mn\"")));
    cases.push(("grams for gravity", with_loads("gravity = [0, 0, \"-1 g\"]")));
    cases.push((
        "degrees for turns",
        with_cable("routing = { kind = \"helix\", turns = \"270 deg\", radius = 0.008 }"),
    ));
    cases.push((
        "a spring rate for an axial stiffness",
        with_cable("holes = [1, 2]\naxial_stiffness = \"2 kN/m\""),
    ));
    cases.push(("length or ratio", with_cable("holes = [1, 2]\nshortening = \"5\"")));
    let text = messages(&cases);
    insta::assert_snapshot!(text);
}

#[test]
fn types_and_counts() {
    let text = messages(&[
        ("true for a length", with_backbone("length = true")),
        ("a list for a length", with_backbone("length = [1, 2]")),
        ("a date for a length", with_backbone("length = 2020-01-01")),
        ("a number for a title", format!("title = 3\n{BACKBONE}{DISKS}")),
        ("an empty title", format!("title = \" \"\n{BACKBONE}{DISKS}")),
        ("a broken count", with_disks("count = 10.5")),
        ("a count with a point", with_disks("count = 10.0")),
        ("a count in quotes", with_disks("count = \"10\"")),
        ("one disk", with_disks("count = 1")),
        ("a negative count", with_disks("count = -3")),
        ("a huge count", with_disks("count = 4000000000")),
        ("a count beyond counting", with_disks("count = 99999999999999999999")),
        ("a hole beyond counting", with_cable("holes = [1, 99999999999999999999]")),
        ("a hexadecimal one", with_cable("holes = [1, 0xffffffffffffffffffff]")),
        ("hole zero", with_cable("holes = [0, 1]")),
        ("holes that count from zero", with_cable("holes = [0, 0, 0, 1]")),
        ("a hole below zero", with_cable("holes = [1, -1]")),
        ("half a hole", with_cable("holes = [1, 2.5]")),
        ("holes as a text", with_cable("holes = \"1-2-3\"")),
        ("no holes", with_cable("holes = []")),
        ("a vector of two", with_loads("tip_force = [\"1 N\", \"0 N\"]")),
        ("a vector of four", with_loads("tip_force = [1, 2, 3, 4]")),
        ("a number for a vector", with_loads("gravity = 9.81")),
        (
            "a text for a coefficient",
            with_cable("routing = { kind = \"polynomial\", x = [\"8 mm\"], y = [0] }"),
        ),
        ("a number for a flag", with_loads("follower = 1")),
        ("a mixed list", with_backbone("length = 1\nrest_curvature = [[0, 0, 1], 2]")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn both_or_neither() {
    let helix = "{ kind = \"helix\", turns = 1, radius = 0.008 }";
    let text = messages(&[
        (
            "diameter and section",
            with_backbone("length = 1\nsection = { width = 0.01, height = 0.01 }\ndiameter = 0.01"),
        ),
        (
            "two elastic constants",
            with_backbone("length = 1\npoisson_ratio = 0.3\nshear_modulus = \"1 GPa\""),
        ),
        ("a bore without a tube", with_backbone("length = 1\ninner_diameter = 0.01")),
        ("half a section", with_backbone("length = 1\nsection = { width = 0.01 }")),
        ("no length", with_backbone("diameter = 0.01")),
        ("count and positions", with_disks("count = 2\npositions = [0, \"180 mm\"]")),
        ("neither count nor positions", with_disks("holes = 12\nhole_circle_radius = 0.008")),
        ("holes and routing", with_cable(&format!("holes = [1, 2]\nrouting = {helix}"))),
        ("neither holes nor routing", with_cable("tension = \"4 N\"")),
        (
            "interpolation of a routing",
            with_cable(&format!("interpolation = \"pchip\"\nrouting = {helix}")),
        ),
        ("no kind", with_cable("routing = { radius = 0.008 }")),
        ("no such kind", with_cable("routing = { kind = \"helical\", radius = 0.008 }")),
        ("no radius", with_cable("routing = { kind = \"straight\", angle = 0 }")),
        ("no such interpolation", with_cable("holes = [1, 2]\ninterpolation = \"linear\"")),
        ("a load nowhere", with_loads("[[loads.point]]\nforce = [1, 0, 0]")),
        ("a load of nothing", with_loads("[[loads.point]]\nat = \"90 mm\"")),
        (
            "a prior without deviation",
            fit(
                "parameters = [\"disks.mass\"]\n[[fit.known]]\nparameter = \"disks.mass\"\nvalue = 1",
            ),
        ),
        ("nothing to fit", fit("")),
        (
            "no such parameter",
            fit("parameters = [\"backbone.diamter\", \"a\"]\neach = [\"base.positoin[0]\"]"),
        ),
        (
            "known of what is not fitted",
            fit(
                "parameters = [\"disks.mass\"]\n[[fit.known]]\nparameter = \"backbone.diameter\"\nleast = 1e-3",
            ),
        ),
        ("values without a source", format!("{BACKBONE}{DISKS}[reference]\nrms_cosserat = 1e-3")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn what_cannot_be() {
    let text = messages(&[
        ("a negative length", with_backbone("length = \"-180 mm\"")),
        ("no length", with_backbone("length = 0")),
        ("not a number", with_backbone("length = nan")),
        ("infinite", with_loads("tip_force = [inf, 0, -inf]")),
        ("too large for a number", with_backbone("length = 1e999")),
        ("an impossible ratio", with_backbone("length = 1\npoisson_ratio = 0.7")),
        ("the least ratio", with_backbone("length = 1\npoisson_ratio = -1.0")),
        ("a length too small", with_backbone("length = 1e-300")),
        ("a length too large", with_backbone("length = 1e308")),
        ("a diameter too large", with_backbone("length = 1\ndiameter = \"1e200 mm\"")),
        ("a modulus too large", with_backbone("length = 1\nyoung_modulus = 1e308")),
        ("a circle too large", with_disks("count = 3\nhole_circle_radius = 1e300")),
        ("disks too close", with_disks("positions = [0, 1e-300, \"180 mm\"]")),
        ("a force too large", with_loads("tip_force = [0, 0, 1e300]")),
        ("a gravity too large", with_loads("gravity = [0, -1e300, 0]")),
        ("a tension too large", with_cable("holes = [1, 2]\ntension = \"1e300 kN\"")),
        ("paid out without end", with_cable("holes = [1, 2]\nshortening = -1e300")),
        (
            "a coefficient too large",
            with_cable("routing = { kind = \"polynomial\", x = [0.008, 0, 1e9], y = [0] }"),
        ),
        (
            "published values too large",
            format!(
                "{BACKBONE}{DISKS}[reference]\nsource = \"x\"\nrms_cosserat = 1e308\ntime_four_bar = -1\n"
            ),
        ),
        ("a bore too wide", with_backbone("length = 1\ndiameter = 0.01\ninner_diameter = 0.02")),
        (
            "a diameter too many",
            "[disks]\ncount = 2\n[backbone]\nlength = 1\ndiameters = [0.1, 0.1, 0.1]".to_owned(),
        ),
        (
            "curvatures too few",
            with_backbone("length = 1\nrest_curvature = [[0, 0, 1], [0, 0, 1]]"),
        ),
        ("positions that fall", with_disks("positions = [0, 0.1, 0.05, 0.18]")),
        ("positions that end early", with_disks("positions = [0, \"90 mm\", \"170 mm\"]")),
        ("one position", with_disks("positions = [0]")),
        ("hole 13 of 12", with_cable("holes = [1, 2, 13, 4]")),
        ("more holes than disks", with_cable("holes = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]")),
        ("one hole", with_cable("holes = [1]")),
        ("disks without holes", format!("{BACKBONE}[disks]\ncount = 10\n{CABLE}")),
        ("a cable beyond the tip", with_cable("holes = [1, 1, 1]\nends_at = \"200 mm\"")),
        ("a cable beyond its holes", with_cable("holes = [1, 1, 1]\nends_at = \"90 mm\"")),
        (
            "a load beyond the tip",
            with_loads(
                "[[loads.point]]\nat = \"90 mm\"\nforce = [1, 0, 0]\n[[loads.point]]\nat = \"190 mm\"\nforce = [1, 0, 0]",
            ),
        ),
        ("a pushing cable", with_cable("holes = [1, 2]\ntension = \"-4 N\"")),
        ("per cent without their unit", with_cable("holes = [1, 1, 1]\nshortening = 5.7")),
        ("millimetres without their unit", with_cable("holes = [1, 1, 1]\nshortening = 2")),
        ("metres for millimetres", with_cable("holes = [1, 1, 1]\nshortening = \"5.7 m\"")),
        (
            "a step in millimetres without their unit",
            format!(
                "{BACKBONE}{DISKS}{}[[steps]]\nshortening = [\"5 mm\"]\n[[steps]]\nshortening = [5]\n",
                CABLE.replace("tension = \"4 N\"\n", "")
            ),
        ),
        ("shortened by more than all", with_cable("holes = [1, 2]\nshortening = \"120 %\"")),
        ("negative friction", with_cable("holes = [1, 2]\nfriction = -0.1")),
        ("two cables of one name", format!("{BACKBONE}{DISKS}{CABLE}{CABLE}")),
        (
            "three cables with a fault each",
            format!(
                "{BACKBONE}{DISKS}{CABLE}[[cables]]\nholes = [13, 1]\n[[cables]]\nname = \"b\"\nholes = [1, 1]\ntension = -1\n[[cables]]\nname = \"pull\"\nholes = [2, 2]\n"
            ),
        ),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn stiffness() {
    let diagonal = "shear = [3000, 3000]\naxial = 8000\nbending = [0.004, 0.004]\ntorsion = 0.003";
    let given = |lines: &str| with_backbone(&format!("length = 1\n[backbone.stiffness]\n{lines}"));
    let held = |lines: &str| {
        with_backbone(&format!(
            "length = 1\nshearable = false\nextensible = false\n[backbone.stiffness]\n{lines}"
        ))
    };
    let matrix = |entries: &[(usize, usize, &str)]| {
        let rows: Vec<_> = (0..6)
            .map(|i| {
                let entry = |j: usize| {
                    let given = entries.iter().find(|(r, c, _)| (*r, *c) == (i, j));
                    given.map_or(if i == j { "4" } else { "0" }, |(_, _, text)| *text)
                };
                format!("[{}]", (0..6).map(entry).collect::<Vec<_>>().join(", "))
            })
            .collect();
        format!("matrix = [{}]", rows.join(", "))
    };
    let text = messages(&[
        (
            "beside a material",
            with_backbone(&format!(
                "length = 1\nyoung_modulus = 1e9\n[backbone.stiffness]\n{diagonal}"
            )),
        ),
        (
            "beside a shear correction",
            with_backbone(&format!(
                "length = 1\nshear_correction = 0.8\n[backbone.stiffness]\n{diagonal}"
            )),
        ),
        ("a yield stiffness alone", with_backbone("length = 1\nyield_stiffness = 0.04")),
        ("a yield moment below zero", with_backbone("length = 1\nyield_moment = [0.01, -0.01]")),
        ("a yield moment of three", with_backbone("length = 1\nyield_moment = [1, 1, 1]")),
        ("a yield moment in newtons", with_backbone("length = 1\nyield_moment = '1 N'")),
        ("a shear correction of zero", with_backbone("length = 1\nshear_correction = 0")),
        ("two masses", with_backbone("length = 1\ndensity = 1000\nlinear_density = \"7 g/m\"")),
        ("nothing", given("at = [0, 1]")),
        ("no torsion", given("bending = [1, 1]")),
        ("no bending", given("torsion = 1")),
        ("diagonal and matrix", given(&format!("torsion = 1\n{}", matrix(&[])))),
        ("no shear", given("axial = 1\nbending = [1, 1]\ntorsion = 1")),
        ("no axial", given("shear = [1, 1]\nbending = [1, 1]\ntorsion = 1")),
        ("one bending", given(&diagonal.replace("[0.004, 0.004]", "0.004"))),
        ("three bendings", given(&diagonal.replace("[0.004, 0.004]", "[1, 2, 3]"))),
        ("the unit of a moment", given(&diagonal.replace("0.003", "\"3 mN*m\""))),
        ("a bending of zero", given(&diagonal.replace("[0.004,", "[0,"))),
        ("a negative one in a list", held("bending = [[1, 1], [1, -1]]\ntorsion = 1\nat = [0, 1]")),
        ("one for each disk", held("bending = [[1, 1], [1, 1]]\ntorsion = 1")),
        ("places too few", held("bending = [[1, 1], [1, 1]]\ntorsion = 1\nat = [0]")),
        ("places that fall", held("bending = [1, 1]\ntorsion = [1, 1]\nat = [0.5, 0.1]")),
        ("one place thrice", held("bending = [1, 1]\ntorsion = [1, 1, 1]\nat = [0, 0, 0]")),
        ("places too close", held("bending = [1, 1]\ntorsion = [1, 1]\nat = [0.5, 0.50000000001]")),
        ("a place beyond the tip", held("bending = [1, 1]\ntorsion = [1, 1]\nat = [0.5, 2]")),
        ("five rows", given("matrix = [[1], [1], [1], [1], [1]]")),
        ("not symmetric", given(&matrix(&[(1, 5, "2"), (5, 1, "-2")]))),
        ("not definite", given(&matrix(&[(3, 4, "4.1"), (4, 3, "4.1")]))),
        ("a pivot that vanishes", given(&matrix(&[(0, 5, "4"), (5, 0, "4")]))),
        ("a diagonal of zero", given(&matrix(&[(2, 2, "0")]))),
        (
            "curvatures without places",
            with_backbone("length = 1\nrest_curvature = { values = [[0, 0, 1]] }"),
        ),
        (
            "curvatures too few for their places",
            with_backbone("length = 1\nrest_curvature = { at = [0, 1], values = [[0, 0, 1]] }"),
        ),
        (
            "a bore too wide midway",
            with_backbone(
                "length = 1\ndiameter = 0.01\ninner_diameter = { at = [0, 0.5, 1], values = [0, 0.011, 0] }",
            ),
        ),
        (
            "a width too small",
            with_backbone("length = 1\nsection = { width = [1, 0], height = 1, at = [0, 1] }"),
        ),
        ("a number for a switch", with_backbone("length = 1\nextensible = 0")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn distributed_loads_masses_and_base() {
    let spread = |lines: &str| with_loads(&format!("[[loads.distributed]]\n{lines}"));
    let base = |lines: &str| format!("{BACKBONE}{DISKS}\n[base]\n{lines}\n");
    let text = messages(&[
        ("nothing spread", spread("from = 0")),
        ("a force as such", spread("force = ['1 N', 0, 0]")),
        ("a stretch and stations", spread("from = 0\nat = [0, 0.1]\nforce = [1, 0, 0]")),
        ("lists without stations", spread("force = [[1, 0, 0], [2, 0, 0]]")),
        ("three for two", spread("at = [0, 0.1]\nforce = [[1, 0, 0], [2, 0, 0], [3, 0, 0]]")),
        ("backwards", spread("from = '90 mm'\nto = '20 mm'\nforce = [1, 0, 0]")),
        ("beyond the tip", spread("at = [0, '5 m']\nmoment = ['1 mN*m/m', 0, 0]")),
        ("too much", spread("at = [0, 0.1]\nforce = [[1, 0, 0], [0, 1e13, 0]]")),
        ("a mass nowhere", with_loads("[[loads.mass]]\nmass = '1 g'")),
        ("a mass of less than nothing", with_loads("[[loads.mass]]\nat = 0.1\nmass = -1")),
        ("no such frame", with_loads("frame = 'body'")),
        (
            "turned twice",
            base("orientation = [1, 0, 0, 0]\nrotation = { axis = [0, 0, 1], angle = 1 }"),
        ),
        ("no axis", base("rotation = { axis = [0, 0, 0], angle = 1 }")),
        ("no quaternion", base("orientation = [0, 0, 0, 0]")),
        ("three of four", base("orientation = [1, 0, 0]")),
        ("no angle", base("rotation = { axis = [0, 0, 1] }")),
        ("far away", base("position = [0, 0, 1e7]")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn long_lines_are_cut() {
    let many = vec!["1"; 400].join(", ");
    let cases = [
        ("at the left", with_cable(&format!("holes = [13, {many}]"))),
        ("in the middle", with_cable(&format!("holes = [{many}, 0, {many}]"))),
        ("at the right", with_cable(&format!("holes = [{many}, \"last\"]"))),
        ("the whole", with_cable(&format!("holes = [{many}]"))),
        ("a long word", with_backbone(&format!("{} = 1", "a".repeat(10_000)))),
        ("a long text", with_backbone(&format!("length = \"{}\"", "1".repeat(10_000)))),
    ];
    let text = messages(&cases);
    insta::assert_snapshot!(text);
}

#[test]
fn colours_only_where_asked() {
    let error = parse(&with_backbone("lenght = 1\nlength = 1"), "robot.toml").unwrap_err();
    assert!(!error.to_string().contains('\x1b'));
    insta::assert_snapshot!(whipcord_io::render(&error, true).replace('\x1b', "ESC"));
}

#[test]
fn steps() {
    let with_steps = |own: &str, steps: &str| {
        let cable = |name: &str| format!("[[cables]]\nname = \"{name}\"\nholes = [1, 2, 3]\n");
        format!("{BACKBONE}{DISKS}{}{own}\n{}\n{steps}\n", cable("pull"), cable("hold"))
    };
    let text = messages(&[
        ("a step that does nothing", with_steps("", "[[steps]]")),
        ("one tension for two cables", with_steps("", "[[steps]]\ntension = [\"2 N\"]")),
        ("one tension that is no list", with_steps("", "[[steps]]\ntension = \"2 N\"")),
        (
            "a shortening too many",
            with_steps("", "[[steps]]\ntension = [1, 2]\n[[steps]]\nshortening = [0, 0, 0]"),
        ),
        ("a length for a tension", with_steps("", "[[steps]]\ntension = [\"2 mm\", 1]")),
        (
            "a cable that pushes, first and last",
            with_steps("", "[[steps]]\ntension = [1, -2]\n[[steps]]\ntension = [-3, 0]"),
        ),
        ("both ways", with_steps("tension = \"4 N\"", "[[steps]]\ntension = [1, 2]")),
        ("a single table", with_steps("", "[steps]\ntension = [1, 2]")),
    ]);
    insta::assert_snapshot!(text);
}
