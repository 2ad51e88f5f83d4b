//! Motors that cannot be, and their commands.

use super::{CABLE, messages};

const ROBOT: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\n[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"left\"\nholes = [1, 1, 1]\n[[cables]]\nname = \"right\"\nholes = [7, 7, 7]\n";

fn with_motor(lines: &str) -> String {
    format!("{ROBOT}[[motors]]\n{lines}\n")
}

#[test]
fn motors() {
    let spool = "cables = [\"left\", \"-right\"]\nspool_radius = \"10 mm\"";
    let cases = [
        ("no cables", with_motor("spool_radius = \"10 mm\"")),
        ("unknown cable", with_motor("cables = [\"left\", \"-rigth\"]\nspool_radius = \"10 mm\"")),
        (
            "two radii of three",
            with_motor("cables = [\"left\"]\nspool_radius = [\"1 mm\", \"2 mm\"]"),
        ),
        ("travel of a spool", with_motor(&format!("{spool}\ntravel = \"5 mm\""))),
        ("angle of a linear drive", with_motor("cables = [\"left\"]\nangle = \"5 deg\"")),
        ("angle as a length", with_motor(&format!("{spool}\nangle = \"5 mm\""))),
        ("backlash as a length", with_motor(&format!("{spool}\nbacklash = \"5 mm\""))),
        ("rate as a speed", with_motor(&format!("{spool}\nrate_limit = \"5 mm/s\""))),
        ("inertia without a loop", with_motor(&format!("{spool}\ninertia = \"20 g*cm^2\""))),
        ("a gain without inertia", with_motor(&format!("{spool}\nderivative_gain = 1e-3"))),
        (
            "inertia as a mass",
            with_motor(&format!("{spool}\ninertia = \"20 g\"\nproportional_gain = 1")),
        ),
        (
            "a stiff spring as the gain of a spool",
            with_motor(&format!("{spool}\ninertia = 1e-6\nproportional_gain = \"1 N/mm\"")),
        ),
        ("no inertia at all", with_motor(&format!("{spool}\ninertia = 0\nproportional_gain = 1"))),
        ("no gear", with_motor(&format!("{spool}\ngear_ratio = 0"))),
        ("rigid pretension", with_motor(&format!("{spool}\npretension = \"5 N\""))),
        (
            "limits the wrong way",
            with_motor(&format!("{spool}\nangle_limits = [\"9 deg\", \"1 deg\"]")),
        ),
        (
            "beyond its limits",
            with_motor(&format!(
                "{spool}\nangle_limits = [\"0 deg\", \"90 deg\"]\nangle = \"2 turn\""
            )),
        ),
        ("unknown key", with_motor(&format!("{spool}\nspool_diameter = \"5 mm\""))),
        (
            "one cable of two motors",
            with_motor(&format!("{spool}\n[[motors]]\nname = \"b\"\ncables = [\"left\"]")),
        ),
        (
            "two of one name",
            with_motor(
                "name = \"a\"\ncables = [\"left\"]\n[[motors]]\nname = \"a\"\ncables = [\"right\"]",
            ),
        ),
        (
            "a shortening beside an angle",
            format!(
                "[backbone]\nlength = \"180 mm\"\n[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n{CABLE}shortening = \"1 mm\"\n[[motors]]\ncables = [\"pull\"]\nspool_radius = \"1 mm\"\nangle = \"5 deg\"\n"
            ),
        ),
        (
            "an angle beside steps",
            with_motor(&format!("{spool}\nangle = \"5 deg\"\n[[steps]]\nmotors = [\"5 deg\"]")),
        ),
        (
            "steps of two motors",
            with_motor(&format!("{spool}\n[[steps]]\nmotors = [\"5 deg\", \"6 deg\"]")),
        ),
        ("a step in mm", with_motor(&format!("{spool}\n[[steps]]\nmotors = [\"5 mm\"]"))),
        (
            "a step beyond the limits",
            with_motor(&format!(
                "{spool}\nangle_limits = [\"0 deg\", \"90 deg\"]\n[[steps]]\nmotors = [\"5 deg\"]\n[[steps]]\nmotors = [\"95 deg\"]"
            )),
        ),
    ];
    insta::assert_snapshot!(messages(&cases));
}
