//! The tables of a template, with comments on the keys.

use super::{Given, Kind, Material, Plan, TAUT, millimetres, same_hole};
use whipcord_study::quantity::number;

/// Columns up to the comments beside the keys.
const COLUMN: usize = 34;

/// A key with a comment beside it.
fn line(key: &str, value: &str, comment: &str) -> String {
    format!("{:<COLUMN$}# {comment}\n", format!("{key} = {value}"))
}

fn quoted(given: &Given) -> String {
    format!("\"{}\"", given.text)
}

pub fn head(plan: &Plan, name: &str) -> String {
    let (title, what) = match plan.kind {
        Kind::Arm => {
            ("Arm", "An arm: a round backbone with cables that run straight from base to tip")
        }
        Kind::Helical => ("Helical robot", "A robot with helical cables, which bends and twists"),
        Kind::Tapered => ("Tapered arm", "An arm whose backbone and cables narrow towards the tip"),
        Kind::Gripper => {
            ("Gripper finger", "A finger of a gripper: a cable closes a flat strip around a ball")
        }
    };
    format!(
        r##"# {what}.
#
#   whipcord check {name}    describes the robot and lists the models that take it
#   whipcord solve {name}    computes its shape
#   whipcord view {name}     opens it in a browser, with a slider for each cable
#
# A quantity is a text with a unit, such as "180 mm" or "5 N", or a number in SI units (m, N, Pa, rad). Lines such as "# key = value"
# are optional keys: remove the # to use them. `whipcord schema` prints all keys, for editors with completion.

title = "{title}"
"##
    )
}

pub fn backbone(plan: &Plan) -> String {
    let Plan { length, diameter, material, .. } = plan;
    let Material { young_modulus, name, poisson_ratio, density } = material;
    let mut text = String::from("[backbone]\n");
    text += &line("length", &quoted(length), "from the base disk to the tip disk");
    text += &match plan.kind {
        Kind::Arm | Kind::Helical => {
            line("diameter", &quoted(diameter), "a round rod; with inner_diameter a tube")
        }
        Kind::Tapered => {
            let diameters: Vec<_> =
                plan.tapering(diameter.value).into_iter().map(millimetres).collect();
            format!(
                "# One diameter for each disk, from base to tip; between two disks it varies linearly.\ndiameters = [{}]\n",
                diameters.join(", ")
            )
        }
        Kind::Gripper => format!(
            "# A strip: thin along x, the direction in which it bends, and wide along y.\nsection = {{ width = {}, height = {} }}\n",
            quoted(diameter),
            millimetres(plan.width())
        ),
    };
    let known = if name.is_empty() { "Young's modulus" } else { name };
    text += &line("young_modulus", &quoted(young_modulus), known);
    text += &line("poisson_ratio", &number(*poisson_ratio, 3), "or shear_modulus");
    let density = format!("\"{} kg/m^3\"", number(*density, 4));
    text += &line("# density", &density, "for the weight of the backbone: see gravity in [loads]");
    text
}

pub fn disks(plan: &Plan) -> String {
    let mut text = String::from("[disks]\n");
    let count = plan.disks.to_string();
    text += &line("count", &count, "equally spaced, the first at the base, the last at the tip");
    let radius = plan.radius();
    match plan.kind {
        Kind::Arm => {
            text += &line(
                "hole_circle_radius",
                &millimetres(radius),
                "from the axis to the centre of a hole",
            );
            let holes = holes(plan).to_string();
            text +=
                &line("holes", &holes, "of each disk: hole 1 is on the x axis, the others follow");
            text += &format!("{:COLUMN$}# counter-clockwise, seen from the tip\n", "");
        }
        Kind::Helical => {
            text +=
                &line("hole_circle_radius", &millimetres(radius), "how large the disks are drawn");
        }
        Kind::Tapered => {
            let radii: Vec<_> = plan.tapering(radius).into_iter().map(millimetres).collect();
            text += &format!(
                "# One for each disk: how large they are drawn.\nhole_circle_radius = [{}]\n",
                radii.join(", ")
            );
        }
        Kind::Gripper => {
            let length = plan.length.value;
            text +=
                &line("hole_circle_radius", &millimetres(radius), "how large the disks are drawn");
            text += &line(
                "outer_radius",
                &millimetres(plan.outer_radius()),
                "where the disks touch obstacles",
            );
            let thin = length / 6.0 / plan.disks as f64;
            text += &line("thickness", &millimetres(thin), "along the backbone");
        }
    }
    text += &line("# mass", "\"2 g\"", "of each disk, for its weight");
    text
}

/// Number of holes in a disk: twelve if the cables divide it.
fn holes(plan: &Plan) -> usize {
    if 12_usize.is_multiple_of(plan.cables) { 12 } else { plan.cables }
}

pub fn cables(plan: &Plan) -> String {
    let mut text = String::from(
        "# One [[cables]] table for each cable. The models with forces use the tension, the geometric models the shortening of the
# part of the cable inside the robot. A negative shortening releases cable.\n",
    );
    text += match plan.kind {
        Kind::Arm => {
            "# `holes` is the hole that the cable runs through in each disk, from base to tip. A cable that ends earlier has a shorter\n# list and `ends_at = \"100 mm\"`.\n"
        }
        Kind::Helical => {
            "# `turns` are counter-clockwise, seen from the tip, over the whole length.\n"
        }
        Kind::Tapered => {
            "# A straight line from a point of the base section to a point of the tip section, both as (x, y).\n"
        }
        Kind::Gripper => "# A cable at the angle 0 deg bends the finger towards x.\n",
    };
    let (tension, shortening) = plan.pull();
    for cable in 0..plan.cables {
        let angle = plan.angle(cable);
        let radius = plan.radius();
        let pulled = if cable == 0 { 1.0 } else { TAUT };
        text += &format!("[[cables]]\nname = \"{}\"\n", name(plan, cable));
        let degrees = format!("\"{} deg\"", number(angle.to_degrees(), 5));
        text += &match plan.kind {
            Kind::Arm => {
                let hole = 1 + cable * holes(plan) / plan.cables;
                format!("holes = [{}]\n", same_hole(hole, plan.disks))
            }
            Kind::Helical => format!(
                "routing = {{ kind = \"helix\", start_angle = {degrees}, turns = 0.5, radius = {} }}\n",
                millimetres(radius)
            ),
            Kind::Tapered => {
                let tip = plan.tapering(radius).last().copied().unwrap_or(radius);
                let at = |radius: f64| {
                    let along = |part: f64| millimetres(clean(radius * part, radius));
                    format!("[{}, {}]", along(angle.cos()), along(angle.sin()))
                };
                format!(
                    "routing = {{ kind = \"linear\", start = {}, end = {} }}\n",
                    at(radius),
                    at(tip)
                )
            }
            Kind::Gripper => format!(
                "routing = {{ kind = \"straight\", angle = {degrees}, radius = {} }}\n",
                millimetres(radius)
            ),
        };
        text += &format!("tension = \"{} N\"\n", number(tension * pulled, 3));
        text +=
            &format!("shortening = {}\n", millimetres(clean(shortening * angle.cos(), shortening)));
        // No model has both friction at the holes and contact.
        if cable == 0 && plan.kind != Kind::Gripper {
            text += &line("# friction", "0.1", "at the holes, for --model cosserat-disks");
            text += &line("# axial_stiffness", "\"2 kN\"", "E A of a cable that stretches");
        }
        text += "\n";
    }
    text.pop();
    text
}

/// Zero for a rounding error of a value of this size.
fn clean(value: f64, size: f64) -> f64 {
    if value.abs() < 1e-9 * size { 0.0 } else { value }
}

fn name(plan: &Plan, cable: usize) -> String {
    match (plan.kind, cable) {
        (Kind::Gripper, 0) => "flexor".to_owned(),
        (Kind::Gripper, _) => "extensor".to_owned(),
        _ => format!("cable-{}", cable + 1),
    }
}

pub fn obstacle(plan: &Plan) -> String {
    if plan.kind != Kind::Gripper {
        return String::new();
    }
    let length = plan.length.value;
    let mut text = String::from("# The object in the grasp.\n[[obstacles]]\nname = \"ball\"\n");
    text += &line("kind", "\"sphere\"", "or half-space, capsule, cylinder, box, pipe, mesh, ...");
    text += &format!("radius = {}\n", millimetres(plan.ball()));
    let along = millimetres(length / 4.0);
    let beside = millimetres(plan.ball() + plan.outer_radius() + length / 120.0);
    text += &format!("position = [{beside}, \"0 mm\", {along}]\n");
    text + &line("# friction", "0.3", "Coulomb's, at each contact")
}

pub fn more(plan: &Plan) -> String {
    let Given { text: length, .. } = &plan.length;
    let tip_force =
        format!("# tip_force = [\"0 N\", \"{} N\", \"0 N\"]", number(plan.tip_force(), 2));
    let lines = [
        ("# [loads]", ""),
        (
            "# gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]",
            "z points from the base to the tip of the straight robot",
        ),
        (&tip_force, "fixed in space; with follower = true it turns with the tip"),
        ("# [[loads.mass]]", "what the robot carries, for its weight"),
        (&format!("# at = \"{length}\""), ""),
        ("# mass = \"5 g\"", ""),
        ("", ""),
        ("# [base]", "how the robot is mounted: here z of the base is along x of the world"),
        ("# rotation = { axis = [0, 1, 0], angle = \"90 deg\" }", ""),
    ];
    let beside = |(key, comment): (&str, &str)| match comment {
        "" => format!("{key}\n"),
        _ => format!("{key:<44}# {comment}\n"),
    };
    lines.into_iter().map(beside).collect()
}

impl Plan {
    fn outer_radius(&self) -> f64 {
        self.radius() * 4.0 / 3.0
    }

    fn ball(&self) -> f64 {
        self.length.value * 22.0 / 120.0
    }

    /// A force that bends the backbone as a cantilever by a hundredth of its length.
    fn tip_force(&self) -> f64 {
        0.03 * self.bending_stiffness() / self.length.value.powi(2)
    }
}
