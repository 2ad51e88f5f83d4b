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
    ("material", &["niti", "nickel titanium", "nickel-titanium", "superelastic"], "nitinol"),
    ("material", &["steel", "music wire", "piano wire"], "spring steel"),
    ("material", &["304", "316", "316l", "inox"], "stainless steel"),
    ("material", &["titanium", "ti-6al-4v", "ti6al4v"], "titanium grade 5"),
    ("material", &["aluminium", "aluminum", "aluminum 6061", "6061"], "aluminium 6061"),
    (
        "material",
        &["carbon", "carbon fibre", "carbon fiber", "carbon fiber rod", "cfrp"],
        "carbon fibre rod",
    ),
    (
        "material",
        &["glass", "glass fibre", "glass fiber", "fibreglass", "fiberglass", "gfrp"],
        "glass fibre rod",
    ),
    ("material", &["delrin", "acetal"], "POM"),
    ("material", &["teflon"], "PTFE"),
    ("material", &["kapton"], "polyimide"),
    ("material", &["nylon", "nylon 12", "polyamide", "pa 12", "pa 2200", "pa2200"], "PA12"),
    ("material", &["tpu", "tpu95a", "cheetah"], "TPU 95A"),
    ("material", &["ninjaflex", "tpu85a"], "TPU 85A"),
    ("material", &["pdms", "sylgard", "silicone"], "Sylgard 184"),
    ("material", &["dragonskin", "dragon skin"], "Dragon Skin 30"),
    ("material", &["ecoflex"], "Ecoflex 00-30"),
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
