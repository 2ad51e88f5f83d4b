//! The tables `[[obstacles]]`, one for each form.

use whipcord::robot::limits;

use super::keys::{LENGTH, key, ratio};
use super::load_keys::{DIRECTION, FORCE_VECTOR, MOMENT_VECTOR, POSITION, ROTATION};
use super::{Key, Kind, Rule, Table};
use crate::read::LENGTH_UNITS;
use crate::units::Dimension;

pub(super) const OBSTACLES: Key = key(
    "obstacles",
    Kind::TablesOfKinds { title: "[[obstacles]]", tag: &KIND, variants: FORMS },
    "[[obstacles]]",
    "A rigid body that the robot touches but does not enter: fixed in the world or, with a mass, a movable object.",
);

static KIND: Key = key(
    "kind",
    Kind::Choice(&[
        "half-space",
        "sphere",
        "capsule",
        "box",
        "cylinder",
        "pipe",
        "superellipsoid",
        "mesh",
    ]),
    "\"sphere\"",
    "The form of the obstacle.",
);

const NAME: Key = key(
    "name",
    Kind::Text,
    r#""ball""#,
    "What messages and reports call it; by default `obstacle-1`, `obstacle-2`, ...",
);
const PLACE: Key = key(
    "position",
    POSITION,
    r#"["30 mm", "0 mm", "80 mm"]"#,
    "Position of the origin of its frame in the world; the world's origin by default.",
);
const ORIENTATION: Key = key(
    "orientation",
    Kind::Vector(&ratio(DIRECTION), 4),
    "[0.7071, 0, 0.7071, 0]",
    "Rotation from its frame to the world as a quaternion (w, x, y, z), of any norm.",
);
const TURN: Key = key(
    "rotation",
    Kind::Table(&ROTATION),
    r#"{ axis = [0, 1, 0], angle = "90 deg" }"#,
    "The same rotation about an axis; instead of `orientation`.",
);
const RUBS: Key = key(
    "friction",
    ratio(limits::FRICTION),
    "0.2",
    "Coefficient of Coulomb friction between it and the robot; 0 by default. What touches then sticks or slides as it came to touch, step by step.",
);
const RADIUS: Key = key("radius", LENGTH, r#""20 mm""#, "Radius.");

const MASS: Key = key(
    "mass",
    Kind::Quantity(&[Dimension::Mass], limits::MASS),
    r#""50 g""#,
    "Mass. With a mass or a density the obstacle is a movable object: its pose is that of rest, and contacts balance its weight.",
);
const DENSITY: Key = key(
    "density",
    Kind::Quantity(&[Dimension::Density], limits::DENSITY),
    r#""1200 kg/m^3""#,
    "Density; instead of `mass`.",
);
const CENTER_OF_MASS: Key = key(
    "center_of_mass",
    POSITION,
    r#"["0 mm", "0 mm", "-4 mm"]"#,
    "Centre of mass of a movable object in its frame; the centroid of its volume by default.",
);
const OWN_FORCE: Key = key(
    "force",
    FORCE_VECTOR,
    r#"["0 N", "0 N", "-0.2 N"]"#,
    "Dead force on a movable object at its centre of mass, in the frame of the loads.",
);
const OWN_MOMENT: Key = key(
    "moment",
    MOMENT_VECTOR,
    r#"["0", "0", "1 mN*m"]"#,
    "Dead moment on a movable object, in the frame of the loads.",
);

/// The table of a form, with what all forms have around what is its own.
macro_rules! form {
    ($title:literal, $doc:literal, [$($key:expr),*], [$($rule:expr),*]) => {
        Table {
            title: $title,
            doc: $doc,
            keys: &[
                NAME, $($key,)* RUBS, PLACE, ORIENTATION, TURN, MASS, DENSITY, CENTER_OF_MASS, OWN_FORCE, OWN_MOMENT
            ],
            rules: &[
                $($rule,)*
                Rule::AtMostOne(&["orientation", "rotation"]),
                Rule::AtMostOne(&["mass", "density"]),
                Rule::Needs("center_of_mass", &["mass", "density"]),
                Rule::Needs("force", &["mass", "density"]),
                Rule::Needs("moment", &["mass", "density"]),
            ],
        }
    };
    ($title:literal, $doc:literal, [$($key:expr),*], [$($rule:expr),*], [$($turns:literal),*]) => {
        Table {
            title: $title,
            doc: $doc,
            keys: &[NAME, $($key,)* RUBS, PLACE, ORIENTATION, TURN],
            rules: &[$($rule,)* Rule::AtMostOne(&[$($turns),*])],
        }
    };
}

static FORMS: &[(&str, Table)] = &[
    (
        "half-space",
        form!(
            "a half-space",
            "All that lies below a plane, such as the floor or a wall: below z = 0 in its frame.",
            [key(
                "normal",
                Kind::Vector(&ratio(DIRECTION), 3),
                "[0, 0, 1]",
                "Direction out of it into free space, of any length; instead of `orientation`."
            )],
            [],
            ["normal", "orientation", "rotation"]
        ),
    ),
    (
        "sphere",
        form!(
            "a sphere",
            "A ball about the origin of its frame.",
            [RADIUS],
            [Rule::Required("radius")]
        ),
    ),
    (
        "capsule",
        form!(
            "a capsule",
            "All that lies within a radius of a segment of the z axis of its frame, whose middle is the origin.",
            [
                RADIUS,
                key(
                    "length",
                    LENGTH,
                    r#""60 mm""#,
                    "Length of the segment; from tip to tip it is longer by twice the radius."
                )
            ],
            [Rule::Required("radius"), Rule::Required("length")]
        ),
    ),
    (
        "box",
        form!(
            "a box",
            "A box with its edges along the axes of its frame, whose middle is the origin.",
            [key(
                "size",
                Kind::Vector(&LENGTH, 3),
                r#"["40 mm", "20 mm", "20 mm"]"#,
                "Lengths of its edges along x, y and z."
            )],
            [Rule::Required("size")]
        ),
    ),
    (
        "cylinder",
        form!(
            "a cylinder",
            "A solid cylinder about the z axis of its frame, whose middle is the origin.",
            [RADIUS, key("length", LENGTH, r#""60 mm""#, "Length.")],
            [Rule::Required("radius"), Rule::Required("length")]
        ),
    ),
    (
        "pipe",
        form!(
            "a pipe",
            "A bore with open ends that the robot is inside of, through a body around it. Where it ends the body ends, and nothing is in the way.",
            [
                key("radius", LENGTH, r#""4 mm""#, "Radius of the bore."),
                key(
                    "points",
                    Kind::List(&POSITION, 2),
                    r#"[["0", "0", "0"], ["0", "0", "50 mm"], ["15 mm", "0", "85 mm"]]"#,
                    "Points in its frame that its middle goes through, from one end to the other."
                ),
                key(
                    "bends",
                    Kind::Choice(&["smooth", "corners"]),
                    r#""smooth""#,
                    "How its middle goes from point to point: along a cubic spline (smooth, the default) or straight (corners)."
                )
            ],
            [Rule::Required("radius"), Rule::Required("points")],
            ["orientation", "rotation"]
        ),
    ),
    (
        "superellipsoid",
        form!(
            "a superellipsoid",
            "The body ((|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1)) <= 1 in its frame: a ball, an ellipsoid, a box with rounded edges, and what lies between.",
            [
                key(
                    "semi_axes",
                    Kind::Vector(&LENGTH, 3),
                    r#"["30 mm", "20 mm", "15 mm"]"#,
                    "Its semi-axes a, b and c along x, y and z."
                ),
                key(
                    "exponents",
                    Kind::Vector(&ratio(limits::SUPERELLIPSOID_EXPONENT), 2),
                    "[0.3, 1.0]",
                    "Its exponents e1, of its sections along z, and e2, of its sections across z: 1 is round, small is square, 1.9 all but a rhombus."
                )
            ],
            [Rule::Required("semi_axes"), Rule::Required("exponents")]
        ),
    ),
    (
        "mesh",
        form!(
            "a mesh",
            "A body that the triangles of a file enclose: without holes, each counter-clockwise as seen from outside.",
            [
                key(
                    "file",
                    Kind::Text,
                    r#""part.stl""#,
                    "STL or OBJ file, relative to this one, in the frame of the obstacle."
                ),
                key(
                    "unit",
                    Kind::Choice(&LENGTH_UNITS),
                    r#""mm""#,
                    "Unit of the lengths in the file, which does not say it."
                ),
                key(
                    "scale",
                    Kind::Quantity(&[Dimension::Ratio], limits::MESH_SCALE),
                    "1.0",
                    "Factor on the lengths in the file; 1 by default."
                )
            ],
            [Rule::Required("file"), Rule::Required("unit")]
        ),
    ),
];
