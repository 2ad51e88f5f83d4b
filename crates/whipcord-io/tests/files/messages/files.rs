//! Files that extend others, that cannot be read, and that name what is measured.

use std::fs;
use std::path::Path;

use whipcord_io::load;

use crate::common::folder;
use crate::messages::{BACKBONE, DISKS, with_backbone};

/// Messages about files on the disk, with the folder's own path taken out.
fn loaded(folder: &Path, file: &str) -> String {
    let error = load(folder.join(file)).unwrap_err();
    let text = error.to_string().replace(&format!("{}/", folder.display()), "");
    text.lines().map(|line| format!("{line}\n")).collect()
}

#[cfg(unix)]
#[test]
fn files_that_extend_others() {
    let extends = |name: &str| format!("extends = \"{name}\"\n");
    let folder = folder(&[
        ("a.toml", extends("b.toml").as_bytes()),
        ("b.toml", extends("c.toml").as_bytes()),
        ("c.toml", format!("title = \"x\"\n{}", extends("./a.toml")).as_bytes()),
        ("self.toml", extends("self.toml").as_bytes()),
        ("gone.toml", extends("none/base.toml").as_bytes()),
        ("folder.toml", extends(".").as_bytes()),
        ("number.toml", b"extends = 3\n"),
        ("bad.toml", with_backbone("length = \"180 mmm\"").as_bytes()),
        ("of-bad.toml", extends("bad.toml").as_bytes()),
        ("broken.toml", b"[backbone\n"),
        ("of-broken.toml", extends("broken.toml").as_bytes()),
        ("base.toml", format!("{BACKBONE}{DISKS}").as_bytes()),
        (
            "shorter.toml",
            format!(
                "{}[disks]\ncount = 3\n[[cables]]\nholes = [1, 1, 1, 1]\n",
                extends("base.toml")
            )
            .as_bytes(),
        ),
        (
            "inherited.toml",
            format!("{}[disks]\nhole_circle_radius = [0.008]\n", extends("base.toml")).as_bytes(),
        ),
        (
            "in-parent.toml",
            format!("{}[backbone]\ninner_diameter = \"4 mm\"\n", extends("base.toml")).as_bytes(),
        ),
        (
            "both.toml",
            format!(
                "{}[backbone]\ndiameter = \"4 mm\"\ndiameters = [1, 2]\n",
                extends("base.toml")
            )
            .as_bytes(),
        ),
    ]);
    for i in 0..20 {
        let text = extends(&format!("chain-{}.toml", i + 1));
        fs::write(folder.path().join(format!("chain-{i}.toml")), text).unwrap();
    }
    let cases = [
        "a.toml",
        "self.toml",
        "gone.toml",
        "folder.toml",
        "number.toml",
        "of-bad.toml",
        "of-broken.toml",
        "shorter.toml",
        "inherited.toml",
        "in-parent.toml",
        "both.toml",
        "chain-0.toml",
    ];
    let all: Vec<String> = cases
        .iter()
        .map(|name| format!("{name}\n{}\n{}", "=".repeat(name.len()), loaded(folder.path(), name)))
        .collect();
    let text = all.join("\n");
    insta::assert_snapshot!(text);
}

#[cfg(unix)]
#[test]
fn cables_of_files_that_extend_others() {
    let cable = |name: &str, lines: &str| format!("[[cables]]\nname = \"{name}\"\n{lines}\n");
    let base = format!(
        "{BACKBONE}{DISKS}{}{}",
        cable("left", "holes = [1, 1, 1]"),
        cable("right", "holes = [7, 7, 7]\ntension = \"1 N\"")
    );
    let steps = "[[steps]]\ntension = [1, 2]\n";
    let cases = [
        ("without a name", "[[cables]]\nholes = [2, 2, 2]\n".to_owned()),
        ("nothing to remove", cable("middle", "remove = true")),
        ("removed twice", cable("left", "remove = true") + &cable("left", "remove = true")),
        ("given twice", cable("left", "friction = 0.1") + &cable("left", "friction = 0.2")),
        ("a hole of this file", cable("left", "holes = [2, 13]")),
        ("a key of this file", cable("right", "tenison = 3")),
        ("incomplete", cable("middle", "tension = 3")),
        ("a value", cable("right", "remove = \"yes\"")),
        ("single brackets", "[cables]\nname = \"right\"\n".to_owned()),
        ("beside steps", cable("right", "tension = 3") + steps),
        ("too few in steps", cable("left", "remove = true") + steps),
    ];
    let mut files: Vec<(String, Vec<u8>)> = cases
        .iter()
        .map(|(name, text)| {
            (format!("{name}.toml"), format!("extends = \"base.toml\"\n{text}").into_bytes())
        })
        .collect();
    let with_steps = format!("{base}{steps}").replace("tension = \"1 N\"\n", "");
    let over = format!("extends = \"steps.toml\"\n{}", cable("right", "tension = 3"));
    // What lies below gives way, but not the other way round.
    files.push(("steps.toml".to_owned(), with_steps.into_bytes()));
    files.push(("over steps.toml".to_owned(), over.into_bytes()));
    files.push(("base.toml".to_owned(), base.replace("holes = [7, 7, 7]", "holes = [7]").into()));
    files.push(("in the base.toml".to_owned(), {
        let text = cable("left", "friction = 0.1");
        format!("extends = \"base.toml\"\n{text}").into_bytes()
    }));
    files.push((
        "no disks to remove.toml".to_owned(),
        format!("{BACKBONE}[disks]\nremove = true\n").into(),
    ));
    files.push((
        "holes of removed disks.toml".to_owned(),
        b"extends = \"base.toml\"\n[disks]\nremove = true\n".to_vec(),
    ));
    files.push((
        "alone.toml".to_owned(),
        format!("{BACKBONE}{DISKS}{}", cable("a", "remove = true")).into(),
    ));
    let all: Vec<(&str, &[u8])> =
        files.iter().map(|(name, text)| (name.as_str(), text.as_slice())).collect();
    let folder = folder(&all);
    let broken = loaded(folder.path(), "in the base.toml");
    fs::write(folder.path().join("base.toml"), &base).unwrap();
    let names = cases.iter().map(|(name, _)| *name).chain([
        "over steps",
        "alone",
        "no disks to remove",
        "holes of removed disks",
    ]);
    let mut told: Vec<(&str, String)> =
        names.map(|name| (name, loaded(folder.path(), &format!("{name}.toml")))).collect();
    told.push(("in the base", broken));
    insta::assert_snapshot!(crate::messages::sections(told.into_iter()));
}

#[cfg(unix)]
#[test]
fn files_that_cannot_be_read() {
    let garbage: Vec<u8> =
        (0..10_000_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let folder = folder(&[
        ("garbage.toml", garbage.as_slice()),
        ("binary.toml", &garbage[..5000]),
        ("latin.toml", b"title = \"K\xf6rper\"\n"),
        ("letters.toml", "x = \u{e9}\n".repeat(20_000).as_bytes()),
        ("equals.toml", "=\n".repeat(50_000).as_bytes()),
        ("keys.toml", (0..50_000).map(|i| format!("key{i} = 1\n")).collect::<String>().as_bytes()),
        (
            "cables.toml",
            format!("{BACKBONE}{DISKS}{}", "[[cables]]\nholes = [13, 1]\n".repeat(100)).as_bytes(),
        ),
        ("folder/x", b""),
    ]);
    let cases = [
        "none.toml",
        "folder",
        "garbage.toml",
        "binary.toml",
        "latin.toml",
        "letters.toml",
        "equals.toml",
        "keys.toml",
        "cables.toml",
    ];
    let mut all = Vec::new();
    for name in cases {
        let text = loaded(folder.path(), name);
        assert!(text.len() < 10_000, "{name}: {} bytes", text.len());
        all.push(format!("{name}\n{}\n{text}", "=".repeat(name.len())));
    }
    let text = all.join("\n");
    insta::assert_snapshot!(text);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    let folder = folder(&[
        ("of-pipe.toml", b"extends = \"pipe\"\n".as_slice()),
        ("measured.toml", format!("{BACKBONE}{DISKS}[measured]\ndisks = \"pipe\"\n").as_bytes()),
    ]);
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
    assert!(made.unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("link")).unwrap();
    let told = ["pipe", "link", "of-pipe.toml", "measured.toml"];
    let told = told.map(|name| format!("{name}\n\n{}", loaded(folder.path(), name)));
    insta::assert_snapshot!(told.join("\n"));
}

#[cfg(unix)]
#[test]
fn measured_positions() {
    let tables: &[(&str, &str)] = &[
        ("empty", ""),
        ("only-a-header", "disk,x,y,z\n"),
        ("no-header", "1,0,0,0\n2,0,0,0.02\n"),
        ("other-columns", "disk,x,y\n1,0,0\n"),
        ("twice-a-column", "disk,x,y,y\n1,0,0,0\n"),
        ("too-few", "disk,x,y,z\n1,0,0,0\n2,0,0\n"),
        ("words", "disk,x,y,z\n1,0,0,zero\n2,0,nan,1e999\n"),
        ("disk-11", "disk,x,y,z\n# the tip\n11,0,0,0.18\n"),
        ("disk-0", "disk,x,y,z\n0,0,0,0\n1.5,0,0,0\n"),
        ("disk-twice", "disk,x,y,z\n2,0,0,0.02\n2,0,0,0.02\n"),
        ("units", "disk,x,y,z\n2,0 mm,0 mm,20 mm\n"),
        ("too-far", "disk,x,y,z\n2,0,0,1e300\n"),
        ("a-part", "disk,x,y,z\n2,0,nan,0.02\n"),
        ("nothing", "disk,x,y,z\n2,,,\n3,NaN,NaN,NaN\n"),
        ("no-place", "x,y,z\n0,0,0.02\n"),
        ("which-place", "disk,arc_length,x,y,z\n2,0.02,0,0,0.02\n,,0,0,0.02\n"),
        ("beyond", "arc_length,x,y,z\n0.19,0,0,0.02\n-0.01,0,0,0\n"),
        ("slip", "disc,x,y,z\n1,0,0,0\n"),
        ("index", ",disk,x,y,z\n0,1,0,0,0\n"),
        ("steps", "step,disk,x,y,z\n2,1,0,0,0\n,2,0,0,0.02\n"),
        ("millimetres", "disk,x,y,z\n1,0,0,0\n5,0,3,80\n10,0,20,180\n"),
        ("kilometres", "disk,x,y,z\n1,0,0,0\n5,0,0.000003,0.00008\n10,0,0.00002,0.00018\n"),
        ("other-names", "s,px,y,z\n0.02,0,0,0.02\n"),
        ("one-column-short", "z,disk,x\n0,1,0\n"),
        ("half-an-image", "disk,u\n1,0\n"),
        ("spaces", "disk x y z\n1 0 0 0\n"),
        ("decimal-commas", "disk,x,y,z\n1,0,0,0,0,0,0\n"),
        ("mixed-decimals", "disk;x;y;z\n1;0;0;0\n2;0,001;0.5;0\n"),
        ("a-word-in-semicolons", "disk;x;y;z\n1;0;0;1,2,3\n"),
        ("unit-in-the-name", "disk,x_mm,y_mm,z_mm\n1,0,0,0\n"),
        ("no-such-unit", "disk,x [furlong],y,z\n1,0,0,0\n"),
        ("a-unit-of-a-number", "disk [mm],x,y,z\n1,0,0,0\n"),
        ("arc-lengths-in-millimetres", "arc_length,x,y,z\n0,0,0,0\n90,0,0,0.09\n180,0,0,0.18\n"),
        ("arc-lengths-in-inches", "arc_length,x,y,z\n7,0,0,0.178\n"),
        ("deviation", "disk,x,y,z,deviation\n1,0,0,0,0\n2,0,0,0.02,-1e-3\n"),
    ];
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    let mut told = |name: &str| {
        let robot = format!("{BACKBONE}{DISKS}[measured]\ndisks = \"{name}.csv\"\n");
        let file = format!("{name}.toml");
        fs::write(folder.path().join(&file), robot).unwrap();
        let text = loaded(folder.path(), &file);
        all.push(format!("{name}\n{}\n{text}", "=".repeat(name.len())));
    };
    for (name, text) in tables {
        fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
        told(name);
    }
    told("none");
    let text = all.join("\n");
    insta::assert_snapshot!(text);
}

/// A table in millimetres whose arc lengths are in metres, and what else does not go together.
#[cfg(unix)]
#[test]
fn arc_lengths_in_another_unit() {
    let cases = [
        ("all", "", "arc_length,x,y,z\n0.06,0,0,60\n0.12,0,0,120\n0.18,0,0,180\n"),
        ("one", "", "arc_length,x,y,z\n0.18,0,0,180\n"),
        (
            "two-moved",
            "registration = \"rigid\"\n",
            "arc_length,x,y,z\n0,500,0,0\n0.18,500,0,180\n",
        ),
        (
            "everything-in-metres",
            "",
            "arc_length,x,y,z\n0.06,0,0,0.06\n0.12,0,0,0.12\n0.18,0,0,0.18\n",
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let told = cases.map(|(name, keys, table)| {
        let robot =
            format!("{BACKBONE}{DISKS}[measured]\ndisks = \"{name}.csv\"\nunit = \"mm\"\n{keys}");
        fs::write(folder.path().join(format!("{name}.toml")), robot).unwrap();
        fs::write(folder.path().join(format!("{name}.csv")), table).unwrap();
        let text = loaded(folder.path(), &format!("{name}.toml"));
        format!("{name}\n{}\n{text}", "=".repeat(name.len()))
    });
    insta::assert_snapshot!(told.join("\n"));
}

#[cfg(unix)]
#[test]
fn markers_in_images() {
    const CAMERAS: &str = "[[measured.cameras]]\nname = \"side\"\nfile = \"side.yml\"\n[[measured.cameras]]\nname = \"top\"\nfile = \"side.yml\"\n";
    let two = |name: &str, table: &str| (name.to_owned(), CAMERAS.to_owned(), table.to_owned());
    let cases = [
        ("no-camera".to_owned(), String::new(), "disk,u,v\n1,0,0\n".to_owned()),
        two("which-camera", "disk,u,v\n1,0,0\n"),
        two("no-name", "disk,camera,u,v\n1,,0,0\n"),
        two("other-name", "disk,camera,u,v\n1,front,0,0\n"),
        two("a-half", "disk,camera,u,v\n1,side,0,\n"),
        two("both", "disk,camera,u,v,x,y,z\n1,side,0,0,0,0,0\n"),
        two("twice", "disk,camera,u,v\n1,side,0,0\n1,top,0,0\n1,side,0,0\n"),
        two("too-far", "disk,camera,u,v\n1,side,1e7,0\n"),
        two("no-accuracy", "disk,camera,u,v,deviation\n1,side,1,0,0\n"),
        (
            "two-names".to_owned(),
            CAMERAS.replace("top", "side"),
            "disk,camera,u,v\n1,side,0,0\n".to_owned(),
        ),
        (
            "no-file".to_owned(),
            CAMERAS.replace("side.yml", "none.yml"),
            "disk,camera,u,v\n1,side,0,0\n".to_owned(),
        ),
        (
            "accuracy".to_owned(),
            "pixel_deviation = -1\n".to_owned(),
            "disk,x,y,z\n1,0,0,0\n".to_owned(),
        ),
    ];
    let side = "%YAML:1.0\n---\nprojection: orthographic\npixels_per_metre: 4000.\nprincipal_point: [ 320., 240. ]\n";
    let folder = folder(&[("side.yml", side.as_bytes())]);
    let told = cases.map(|(name, cameras, table)| {
        let robot = format!("{BACKBONE}{DISKS}[measured]\ndisks = \"{name}.csv\"\n{cameras}");
        fs::write(folder.path().join(format!("{name}.toml")), robot).unwrap();
        fs::write(folder.path().join(format!("{name}.csv")), table).unwrap();
        let text = loaded(folder.path(), &format!("{name}.toml"));
        format!("{name}\n{}\n{text}", "=".repeat(name.len()))
    });
    insta::assert_snapshot!(told.join("\n"));
}
