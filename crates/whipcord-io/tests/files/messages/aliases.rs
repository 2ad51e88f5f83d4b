//! Keys and words by the names that other programs, papers and drawings give them.

use crate::messages::{
    BACKBONE, CABLE, DISKS, messages, with_backbone, with_cable, with_disks, with_loads,
};

#[test]
fn the_backbone_by_other_names() {
    let with = |lines: &str| with_backbone(&format!("length = \"180 mm\"\n{lines}"));
    let text = messages(&[
        ("a radius", with("radius = \"1.5 mm\"")),
        ("a radius in metres", with("radius = 0.0015")),
        ("a radius beside the diameter", with("diameter = \"3 mm\"\nradius = \"1.5 mm\"")),
        ("a radius without a number", with("radius = [\"1 mm\", \"2 mm\"]")),
        ("an outer diameter", with("outer_diameter = \"3 mm\"")),
        ("an inner radius", with("diameter = \"3 mm\"\ninner_radius = \"0.1 in\"")),
        ("a wall", with("diameter = \"3 mm\"\nwall_thickness = \"0.5 mm\"")),
        ("symbols", with("E = \"1.1 GPa\"\nnu = 0.3\nrho = 1040")),
        ("the shear modulus", with("E = \"1.1 GPa\"\nG = \"0.4 GPa\"")),
        ("youngs_modulus", with("youngs_modulus = 1e9\npoissons_ratio = 0.3")),
        ("the length", with_backbone("L = \"180 mm\"")),
        ("a bending stiffness", with("EI = 0.004")),
        ("a second moment", with("I = 4e-12")),
        ("a curvature", with("curvature = [0, 4, 0]")),
        ("a radius of curvature", with("radius_of_curvature = \"250 mm\"")),
        ("a material", with("material = \"steel\"")),
        ("a material in other letters", with("material = \"Ptfe\"")),
        ("a material by another name", with("material = \"teflon\"")),
        ("a slip of the pen", with("material = \"nitinoll\"")),
        ("no material", with("material = \"unobtainium\"")),
        ("materials", with("materials = \"PTFE\"")),
        ("a material of the file", format!("material = \"PTFE\"\n{BACKBONE}{DISKS}{CABLE}")),
        (
            "a material beside a stiffness",
            with(
                "material = \"PTFE\"\nstiffness = { bending = [1, 1], torsion = 1, axial = 1, shear = [1, 1] }",
            ),
        ),
        ("a number as a material", with("material = 3")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn disks_cables_and_loads_by_other_names() {
    let text = messages(&[
        ("their number", with_disks("n_disks = 10")),
        ("their spacing", with_disks("spacing = \"20 mm\"")),
        ("a pitch radius", with_disks("count = 10\npitch_radius = \"8 mm\"\nn_holes = 12")),
        ("a pitch diameter", with_disks("count = 10\nhole_circle_diameter = \"16 mm\"")),
        ("a hole radius", with_disks("count = 10\nhole_radius = \"1 mm\"")),
        ("a diameter", with_disks("count = 10\ndiameter = \"20 mm\"")),
        ("tendons", format!("{BACKBONE}{DISKS}{}", CABLE.replace("cables", "tendons"))),
        ("one tendon", format!("{BACKBONE}{DISKS}{}", CABLE.replace("cables", "tendon"))),
        ("a rod", format!("{}{DISKS}{CABLE}", BACKBONE.replace("backbone", "rod"))),
        ("spacers", format!("{BACKBONE}{}{CABLE}", DISKS.replace("disks", "spacer_disks"))),
        ("a force", with_cable("holes = [1, 2]\nforce = \"4 N\"")),
        ("a displacement", with_cable("holes = [1, 2]\ndisplacement = \"4 mm\"")),
        ("a length", with_cable("holes = [1, 2]\nlength = \"170 mm\"")),
        ("mu", with_cable("holes = [1, 2]\nmu = 0.1")),
        ("a stiffness", with_cable("holes = [1, 2]\nstiffness = \"2 kN/m\"")),
        ("an angle", with_cable("angle = \"90 deg\"\nradius = \"8 mm\"")),
        ("a pitch", with_cable("routing = { kind = \"spiral\", pitch = 0.1, radius = 0.008 }")),
        ("a force at the tip", with_loads("force = [0, 1, 0]")),
        ("a tip load", with_loads("tip_load = [0, 1, 0]\ntorque = [0, 0, 1]")),
        ("a payload", with_loads("payload = \"10 g\"")),
        ("g", with_loads("g = [0, 0, -9.81]")),
    ]);
    insta::assert_snapshot!(text);
}

#[test]
fn obstacles_by_other_names() {
    let with = |lines: &str| format!("{BACKBONE}{DISKS}[[obstacles]]\n{lines}\n");
    let text = messages(&[
        ("a type", with("type = \"sphere\"\nradius = 0.02")),
        ("a plane", with("kind = \"plane\"")),
        ("a ball", with("kind = \"ball\"\nradius = 0.02")),
        ("a centre", with("kind = \"sphere\"\nradius = 0.02\ncenter = [0, 0, 0.1]")),
        ("a diameter", with("kind = \"sphere\"\ndiameter = \"40 mm\"")),
        ("a height", with("kind = \"cylinder\"\nradius = 0.02\nheight = 0.1")),
        ("an axis", with("kind = \"cylinder\"\nradius = 0.02\nlength = 0.1\naxis = [1, 0, 0]")),
    ]);
    insta::assert_snapshot!(text);
}
