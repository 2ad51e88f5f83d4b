//! What stands in the way, and the files it is read from.

use std::fs;

use whipcord_io::load;

use crate::common::folder;
use crate::messages::{BACKBONE, DISKS, message, messages, told};

fn with_obstacle(lines: &str) -> String {
    format!("{BACKBONE}{DISKS}\n[[obstacles]]\n{lines}\n")
}

#[test]
fn forms_that_cannot_be() {
    let cases = [
        ("no kind", "radius = 1"),
        ("another kind", "kind = \"sphare\"\nradius = 1"),
        ("no radius", "kind = \"sphere\""),
        ("a key of another kind", "kind = \"sphere\"\nradius = 1\nlength = 2"),
        ("a radius that is none", "kind = \"sphere\"\nradius = \"0 mm\""),
        ("no length", "kind = \"box\"\nsize = [1, 2, \"3 kg\"]"),
        ("two turns", "kind = \"half-space\"\nnormal = [0, 0, 1]\norientation = [1, 0, 0, 0]"),
        ("no direction", "kind = \"half-space\"\nnormal = [0, 0, 0]"),
        ("no axis", "kind = \"sphere\"\nradius = 1\nrotation = { axis = [0, 0, 0], angle = 1 }"),
        ("one point", "kind = \"pipe\"\nradius = 1\npoints = [[0, 0, 0]]"),
        (
            "the same point",
            "kind = \"pipe\"\nradius = 1\npoints = [[0, 0, 0], [0, 0, 3], [0, 0, 3]]",
        ),
        (
            "a sharp bend",
            "kind = \"pipe\"\nradius = \"10 mm\"\npoints = [[0, 0, 0], [0, 0, 0.01], [0.01, 0, 0.01]]",
        ),
        ("an exponent", "kind = \"superellipsoid\"\nsemi_axes = [1, 1, 1]\nexponents = [1, 2]"),
        ("far away", "kind = \"sphere\"\nradius = 1\nposition = [0, 0, \"1e9 m\"]"),
        ("a mesh of no unit", "kind = \"mesh\"\nfile = \"part.stl\""),
    ];
    let texts: Vec<_> = cases.map(|(name, lines)| (name, with_obstacle(lines))).into();
    let mut all = messages(&texts);
    let single = format!("{BACKBONE}{DISKS}\n[obstacles]\nkind = \"sphere\"\n");
    all += &messages(&[("single brackets", single)]);
    insta::assert_snapshot!(all);
}

#[test]
fn movable_objects_that_cannot_be() {
    let ball =
        |lines: &str| message(&with_obstacle(&format!("kind = \"sphere\"\nradius = 1\n{lines}")));
    for (lines, words) in [
        ("mass = \"-1 kg\"", "`mass` of obstacle 1"),
        ("mass = \"3 mm\"", "mass"),
        ("mass = 1\ndensity = 2", "density"),
        ("center_of_mass = [0, 0, 0]", "mass"),
        ("force = [0, 0, 1]", "mass"),
        ("mass = 1\nforce = [0, 0, \"1 kg\"]", "force"),
        ("mass = 1\nmoment = [0, 1]", "moment"),
    ] {
        let text = ball(lines);
        assert!(text.contains("error") && text.contains(words), "{lines}: {text}");
    }
    let floor = message(&with_obstacle("kind = \"half-space\"\nmass = 1"));
    assert!(floor.contains("error") && floor.contains("mass"), "{floor}");
}

/// A movable object is read in SI, its centre of mass by default that of its volume.
#[test]
fn movable_objects_are_read() {
    let text = with_obstacle(
        "kind = \"box\"\nsize = [\"10 mm\", \"20 mm\", \"30 mm\"]\ndensity = \"1000 kg/m^3\"\nforce = [0, 0, \"1 N\"]",
    );
    let file = whipcord_io::parse(&text, "robot.toml").unwrap();
    let body = file.case.obstacles[0].movable.unwrap();
    assert!((body.mass - 6e-3).abs() < 1e-12);
    assert_eq!(body.center_of_mass.to_array(), [0.0; 3]);
    assert_eq!(body.force.to_array(), [0.0, 0.0, 1.0]);
}

#[test]
fn disks_that_are_too_thick() {
    let thick = |thickness: &str| {
        let disks = "[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nouter_radius = \"9 mm\"\n";
        message(&format!("{BACKBONE}{disks}thickness = {thickness}\n"))
    };
    for (thickness, words) in [
        (
            "\"180 mm\"",
            "`disks.thickness` must be at most 20 mm, the distance from disk 1 to disk 2, but is 180 mm\n",
        ),
        ("100000", "help: make the disks thinner, or place them farther apart"),
        (
            "\"19 mm\"",
            "`disks.thickness` must be at most 18 mm, twice the outer radius of disk 1, but is 19 mm\n",
        ),
    ] {
        let text = thick(thickness);
        assert!(text.contains(words) && text.contains("robot.toml:8:13: error:"), "{text}");
    }
}

/// Corners of a tetrahedron, and its triangles seen from outside.
const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn stl_text(faces: &[[usize; 3]]) -> String {
    let facet = |face: &[usize; 3]| {
        let corners = face.map(|k| {
            let [x, y, z] = CORNERS[k];
            format!("vertex {x} {y} {z}\n")
        });
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    format!("solid part\n{}endsolid part\n", faces.iter().map(facet).collect::<String>())
}

fn stl_binary(title: &str, faces: &[[usize; 3]]) -> Vec<u8> {
    let mut bytes = title.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(u32::try_from(faces.len()).unwrap().to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&k| CORNERS[k]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj(faces: &[[usize; 3]]) -> String {
    let corners = CORNERS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = faces.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    format!(
        "mtllib ../none.mtl\no part\n{}usemtl steel\n{}",
        corners.collect::<String>(),
        faces.collect::<String>()
    )
}

/// The same body in every format, seen at a point outside; the lengths of the file are in mm.
#[test]
fn meshes_are_read_from_every_format() {
    let quad = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 2\nf 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let files: [(&str, Vec<u8>); 5] = [
        ("text.stl", stl_text(&FACES).into()),
        ("binary.STL", stl_binary("made by a program", &FACES)),
        ("solid.stl", stl_binary("solid by name alone", &FACES)),
        ("part.obj", obj(&FACES).into()),
        ("pyramid.obj", quad.into()),
    ];
    let robot = |file: &str| {
        with_obstacle(&format!("kind = \"mesh\"\nfile = \"{file}\"\nunit = \"mm\"\nscale = 10"))
    };
    let robots: Vec<(String, String)> =
        files.iter().map(|(name, _)| (format!("{name}.toml"), robot(name))).collect();
    let folder = folder(&files);
    for (name, text) in &robots {
        fs::write(folder.path().join(name), text).unwrap();
        let file = load(folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"));
        let surface = file.case.obstacles[0].surface(whipcord::Vec3::new(0.002, 0.002, -0.005));
        assert!((surface.distance - 0.005).abs() < 1e-15, "{name}: {surface:?}");
        // Written anew it names the same file, from wherever it is read.
        let table = whipcord_io::describe(None, &file.robot, &file.case).unwrap();
        let again = whipcord_io::parse(&whipcord_io::toml(&table), "elsewhere/robot.toml").unwrap();
        assert_eq!(again.case, file.case);
    }
}

#[test]
fn files_that_are_no_meshes() {
    let mut cut = stl_binary("made by a program", &FACES);
    cut.truncate(200);
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("cut.stl", cut),
        ("empty.stl", Vec::new()),
        ("none.stl", stl_text(&[]).into()),
        ("hole.stl", stl_text(&FACES[1..]).into()),
        ("inside-out.obj", obj(&FACES.map(|[a, b, c]| [a, c, b])).into()),
        ("beyond.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n".to_vec()),
        ("words.obj", b"f one two three\n".to_vec()),
        ("infinite.stl", stl_text(&FACES).replace("vertex 1 0 0", "vertex inf 0 0").into()),
        ("part.step", b"ISO-10303-21;\n".to_vec()),
    ];
    let folder = folder(&files);
    let names = files.iter().map(|(name, _)| *name).chain(["missing.stl", "."]);
    let mut all = String::new();
    for name in names {
        let text = with_obstacle(&format!("kind = \"mesh\"\nfile = \"{name}\"\nunit = \"mm\""));
        fs::write(folder.path().join("robot.toml"), text).unwrap();
        let message = told(&load(folder.path().join("robot.toml")).unwrap_err());
        all += &message.replace(&format!("{}/", folder.path().display()), "");
    }
    insta::assert_snapshot!(all);
}
