//! Other words for what a key may be chosen to be.

/// Other words for a choice, by the key that it is of.
static WORDS: &[(&str, &[&str], &str)] = &[
    ("kind", &["plane", "floor", "ground", "wall", "halfspace", "half-plane"], "half-space"),
    ("kind", &["ball"], "sphere"),
    ("kind", &["cuboid", "block", "cube", "brick"], "box"),
    ("kind", &["rod", "bar", "pin", "post"], "cylinder"),
    ("kind", &["tube", "bore", "channel", "vessel", "lumen"], "pipe"),
    ("kind", &["ellipsoid"], "superellipsoid"),
    ("kind", &["stl", "obj", "triangles"], "mesh"),
    ("kind", &["parallel"], "straight"),
    ("kind", &["spiral", "helical"], "helix"),
    ("kind", &["converging", "tapered", "oblique"], "linear"),
    ("interpolation", &["cubic", "natural", "c2"], "spline"),
    ("interpolation", &["monotone", "akima"], "pchip"),
    ("unit", &["meter", "meters", "metre", "metres"], "m"),
    ("unit", &["millimeter", "millimeters", "millimetre", "millimetres"], "mm"),
    ("unit", &["inch", "inches"], "in"),
];

/// Which of the words that a key takes is meant by another word.
pub(super) fn word(key: &str, given: &str, choices: &[&'static str]) -> Option<&'static str> {
    let given = given.to_lowercase();
    WORDS
        .iter()
        .find(|(of, names, meant)| {
            *of == key && choices.contains(meant) && names.contains(&&*given)
        })
        .map(|(.., meant)| *meant)
}
