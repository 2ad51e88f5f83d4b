//! `whipcord export`.

use crate::support::{Scratch, fail, succeed};

const ARM: &str = "examples/two-segment-arm.toml";

#[test]
fn files_of_each_format_are_written_and_listed_with_what_is_lost() {
    let formats = [
        ("mjcf", "arm.xml", vec!["arm.xml"]),
        ("urdf", "arm.urdf", vec!["arm.urdf", "arm.joints.json"]),
        (
            "vtk",
            "arm.pvd",
            vec!["arm.pvd", "arm/backbone-1.vtp", "arm/cables-1.vtp", "arm/disks-1.vtp"],
        ),
        ("gltf", "arm.glb", vec!["arm.glb"]),
        ("step-points", "arm.step", vec!["arm.step"]),
    ];
    for (format, name, files) in formats {
        let scratch = Scratch::new();
        let out = scratch.file(name);
        let text = succeed(&["export", ARM, "--to", format, "-o", &out]);
        for file in &files {
            let path = scratch.file(file);
            assert!(text.contains(&format!("written  {path}\n")), "{text}");
            assert!(std::fs::metadata(&path).unwrap().len() > 300, "{path}");
        }
        assert_eq!(text.matches("written").count(), files.len(), "{text}");
        assert!(text.contains("lost"), "{text}");
    }
}

#[test]
fn the_same_robot_gives_the_same_bytes() {
    let scratch = Scratch::new();
    let bytes = |name: &str| {
        let out = scratch.file(name);
        succeed(&["export", ARM, "--to", "step-points", "-o", &out]);
        let text = std::fs::read_to_string(&out).unwrap();
        text.replace(name, "")
    };
    assert_eq!(bytes("a.step"), bytes("b.step"));
}

#[test]
fn what_cannot_be_exported_is_refused_and_nothing_is_written() {
    let scratch = Scratch::new();
    let out = scratch.file("robot.xml");
    let refused = |file: &str, more: &[&str]| {
        let mut arguments = vec!["export", file, "--to", "mjcf", "-o", &out];
        arguments.extend(more);
        fail(2, &arguments)
    };
    let friction = refused("examples/rubbing-finger.toml", &[]);
    assert!(
        friction.contains("friction of a cable (cables[0].friction): set it to 0"),
        "{friction}"
    );
    succeed(&[
        "export",
        "examples/rubbing-finger.toml",
        "--to",
        "mjcf",
        "-o",
        &out,
        "--set",
        "cables[0].friction=0",
    ]);
    std::fs::remove_file(&out).unwrap();
    let pipe = refused("examples/contact/catheter-in-pipe.toml", &[]);
    assert!(pipe.contains("MuJoCo's bodies are convex"), "{pipe}");
    let many = refused(ARM, &["--per-span", "100"]);
    assert!(many.contains("MJCF takes at most 490"), "{many}");
    let geometric = refused(ARM, &["--model", "constant-curvature"]);
    assert!(
        geometric.contains("--model cosserat-disks") || geometric.contains("constant-curvature"),
        "{geometric}"
    );
    let name = fail(2, &["export", ARM, "--to", "gltf", "-o", &out]);
    assert!(name.contains("the name of a file for gltf must end in .glb"), "{name}");
    let format = fail(2, &["export", ARM, "--to", "sdf"]);
    assert!(format.contains("mjcf"), "{format}");
    assert!(std::fs::read_dir(scratch.file(".")).unwrap().next().is_none());
}

#[test]
fn a_robot_without_an_answer_is_not_exported() {
    let scratch = Scratch::new();
    let out = scratch.file("robot.glb");
    let bend = "cables[0].shortening=\"182 mm\"";
    let arguments = [
        "export",
        "examples/table1/case-3.toml",
        "--to",
        "gltf",
        "-o",
        &out,
        "--set",
        bend,
        "--actuation",
        "shortening",
    ];
    let message = fail(1, &arguments);
    assert!(message.contains("cannot be shortened"), "{message}");
    assert!(!std::path::Path::new(&out).exists());
}
