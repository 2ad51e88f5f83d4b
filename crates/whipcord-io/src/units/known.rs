//! The units of each dimension, the SI unit first.

use super::{Scale, Unit};

const fn ten(name: &'static str, aliases: &'static [&'static str], exponent: i32) -> Unit {
    Unit { name, aliases, scale: Scale::Ten(exponent) }
}

const fn factor(name: &'static str, aliases: &'static [&'static str], factor: f64) -> Unit {
    Unit { name, aliases, scale: Scale::Factor(factor) }
}

/// Standard acceleration of gravity in m/s²: one gram-force is the weight of a gram under it.
const STANDARD_GRAVITY: f64 = 9.80665;
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// International foot, inch and avoirdupois pound and ounce, all exact by definition.
const INCH: f64 = 0.0254;
const FOOT: f64 = 12.0 * INCH;
const POUND: f64 = 0.453_592_37;
const OUNCE: f64 = POUND / 16.0;
/// The weight of a pound under [`STANDARD_GRAVITY`], exact by definition.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
const PSI: f64 = POUND_FORCE / (INCH * INCH);

pub(super) const LENGTH: &[Unit] = &[
    ten("m", &[], 0),
    ten("cm", &[], -2),
    ten("mm", &[], -3),
    ten("um", &["µm", "μm"], -6),
    factor("in", &["inch", "inches"], INCH),
    factor("ft", &[], FOOT),
];
pub(super) const PRESSURE: &[Unit] = &[
    ten("Pa", &["N/m^2", "N/m²", "N/m2"], 0),
    ten("kPa", &["kN/m^2", "kN/m²", "kN/m2"], 3),
    ten("MPa", &["N/mm^2", "N/mm²", "N/mm2"], 6),
    ten("GPa", &["kN/mm^2", "kN/mm²", "kN/mm2"], 9),
    ten("bar", &[], 5),
    factor("psi", &["lbf/in^2", "lbf/in²", "lbf/in2"], PSI),
    factor("ksi", &[], 1e3 * PSI),
    factor("Msi", &["Mpsi"], 1e6 * PSI),
];
pub(super) const FORCE: &[Unit] = &[
    ten("N", &[], 0),
    ten("uN", &["µN", "μN"], -6),
    ten("mN", &[], -3),
    ten("kN", &[], 3),
    ten("MN", &[], 6),
    factor("gf", &[], 1e-3 * STANDARD_GRAVITY),
    factor("kgf", &[], STANDARD_GRAVITY),
    factor("lbf", &[], POUND_FORCE),
    factor("ozf", &[], POUND_FORCE / 16.0),
];
pub(super) const MOMENT: &[Unit] = &[
    ten("N*m", &["N·m", "N⋅m", "N m", "Nm"], 0),
    ten("mN*m", &["mN·m", "mN⋅m", "mN m", "mNm"], -3),
    ten("N*cm", &["N·cm", "N⋅cm", "N cm", "Ncm"], -2),
    ten("N*mm", &["N·mm", "N⋅mm", "N mm", "Nmm"], -3),
    factor("lbf*in", &["lbf·in", "lbf⋅in", "lbf in", "in*lbf"], POUND_FORCE * INCH),
    factor("lbf*ft", &["lbf·ft", "lbf⋅ft", "lbf ft", "ft*lbf"], POUND_FORCE * FOOT),
];
pub(super) const BENDING_STIFFNESS: &[Unit] = &[
    ten("N*m^2", &["N·m²", "N⋅m²", "N·m^2", "N*m²", "N m^2", "N m²", "Nm^2", "Nm²", "Nm2"], 0),
    ten("N*cm^2", &["N·cm²", "N⋅cm²", "N·cm^2", "N*cm²", "N cm^2", "N cm²", "Ncm^2", "Ncm²"], -4),
    ten(
        "N*mm^2",
        &["N·mm²", "N⋅mm²", "N·mm^2", "N*mm²", "N mm^2", "N mm²", "Nmm^2", "Nmm²", "Nmm2"],
        -6,
    ),
    factor("lbf*in^2", &["lbf·in²", "lbf*in²"], POUND_FORCE * INCH * INCH),
];
pub(super) const LINE_FORCE: &[Unit] = &[
    ten("N/m", &["mN/mm"], 0),
    ten("mN/m", &[], -3),
    ten("kN/m", &[], 3),
    ten("N/mm", &[], 3),
    factor("gf/m", &[], 1e-3 * STANDARD_GRAVITY),
    factor("lbf/in", &[], POUND_FORCE / INCH),
    factor("lbf/ft", &[], POUND_FORCE / FOOT),
];
pub(super) const LINE_MOMENT: &[Unit] = &[
    ten("N*m/m", &["N·m/m", "N⋅m/m", "N m/m", "Nm/m"], 0),
    ten("mN*m/m", &["mN·m/m", "mN⋅m/m", "mN m/m", "mNm/m"], -3),
    ten("N*mm/mm", &["N·mm/mm", "N⋅mm/mm", "N mm/mm", "Nmm/mm"], 0),
];
pub(super) const MASS: &[Unit] = &[
    ten("kg", &[], 0),
    ten("g", &[], -3),
    ten("mg", &[], -6),
    factor("lb", &[], POUND),
    factor("oz", &[], OUNCE),
];
pub(super) const DENSITY: &[Unit] = &[
    ten("kg/m^3", &["kg/m³", "kg/m3"], 0),
    ten("g/cm^3", &["g/cm³", "g/cm3"], 3),
    factor("lb/in^3", &["lb/in³", "lb/in3"], POUND / (INCH * INCH * INCH)),
    factor("lb/ft^3", &["lb/ft³", "lb/ft3"], POUND / (FOOT * FOOT * FOOT)),
];
pub(super) const LINEAR_DENSITY: &[Unit] =
    &[ten("kg/m", &[], 0), ten("g/m", &["kg/km"], -3), ten("g/cm", &[], -1), ten("g/mm", &[], 0)];
pub(super) const ANGLE: &[Unit] = &[
    ten("rad", &[], 0),
    ten("mrad", &[], -3),
    factor("deg", &["°"], DEGREE),
    factor("turn", &["turns"], core::f64::consts::TAU),
];
pub(super) const ANGULAR_RATE: &[Unit] = &[
    ten("rad/s", &[], 0),
    factor("deg/s", &["°/s"], DEGREE),
    factor("rpm", &["1/min", "turn/min"], core::f64::consts::TAU / 60.0),
];
pub(super) const SPEED: &[Unit] =
    &[ten("m/s", &[], 0), ten("cm/s", &[], -2), ten("mm/s", &[], -3), factor("in/s", &[], INCH)];
pub(super) const LINE_DRAG: &[Unit] = &[
    ten(
        "N*s/m^2",
        &[
            "N·s/m²",
            "N⋅s/m²",
            "N s/m^2",
            "N s/m²",
            "Ns/m^2",
            "Ns/m²",
            "Ns/m2",
            "kg/(m*s)",
            "Pa*s",
            "Pa·s",
        ],
        0,
    ),
    ten("mN*s/m^2", &["mN·s/m²", "mN⋅s/m²", "mN s/m^2", "mN s/m²", "mPa*s", "mPa·s"], -3),
];
pub(super) const INERTIA: &[Unit] = &[
    ten("kg*m^2", &["kg·m²", "kg⋅m²", "kg m^2", "kg m²", "kg*m2"], 0),
    ten("kg*cm^2", &["kg·cm²", "kg⋅cm²", "kg cm^2", "kg cm²", "kg*cm2"], -4),
    ten("g*cm^2", &["g·cm²", "g⋅cm²", "g cm^2", "g cm²", "g*cm2"], -7),
    ten("g*mm^2", &["g·mm²", "g⋅mm²", "g mm^2", "g mm²", "g*mm2"], -9),
];
pub(super) const ANGULAR_STIFFNESS: &[Unit] = &[
    ten("N*m/rad", &["N·m/rad", "N⋅m/rad", "N m/rad", "Nm/rad"], 0),
    ten("mN*m/rad", &["mN·m/rad", "mN⋅m/rad", "mN m/rad", "mNm/rad"], -3),
    factor("N*m/deg", &["N·m/deg", "N⋅m/deg", "N m/deg", "Nm/deg"], 1.0 / DEGREE),
    factor("mN*m/deg", &["mN·m/deg", "mN⋅m/deg", "mN m/deg", "mNm/deg"], 1e-3 / DEGREE),
];
pub(super) const ANGULAR_DAMPING: &[Unit] = &[
    ten(
        "N*m*s/rad",
        &["N·m·s/rad", "N⋅m⋅s/rad", "N m s/rad", "Nms/rad", "N*m*s", "N·m·s", "Nms"],
        0,
    ),
    ten(
        "mN*m*s/rad",
        &["mN·m·s/rad", "mN⋅m⋅s/rad", "mN m s/rad", "mNms/rad", "mN*m*s", "mN·m·s"],
        -3,
    ),
];
pub(super) const DAMPING: &[Unit] = &[
    ten("N*s/m", &["N·s/m", "N⋅s/m", "N s/m", "Ns/m", "kg/s"], 0),
    ten("N*s/mm", &["N·s/mm", "N⋅s/mm", "N s/mm", "Ns/mm"], 3),
];
pub(super) const FORCE_RATE: &[Unit] =
    &[ten("N/s", &[], 0), ten("mN/s", &[], -3), ten("kN/s", &[], 3)];
pub(super) const ACCELERATION: &[Unit] = &[
    ten("m/s^2", &["m/s²", "m/s2"], 0),
    ten("mm/s^2", &["mm/s²", "mm/s2"], -3),
    factor("g0", &[], STANDARD_GRAVITY),
    factor("ft/s^2", &["ft/s²", "ft/s2"], FOOT),
];
pub(super) const CURVATURE: &[Unit] = &[
    ten("1/m", &["m^-1", "rad/m"], 0),
    ten("1/cm", &["cm^-1"], 2),
    ten("1/mm", &["mm^-1", "rad/mm"], 3),
    factor("1/in", &["in^-1"], 1.0 / INCH),
    factor("deg/m", &["°/m"], DEGREE),
    factor("deg/cm", &["°/cm"], 1e2 * DEGREE),
    factor("deg/mm", &["°/mm"], 1e3 * DEGREE),
];
pub(super) const TIME: &[Unit] = &[
    ten("s", &[], 0),
    ten("ms", &[], -3),
    ten("us", &["µs", "μs"], -6),
    factor("min", &[], 60.0),
    factor("h", &[], 3600.0),
];
pub(super) const RATIO: &[Unit] = &[ten("%", &[], -2)];

/// Names of units that are not understood, as a text may have a slip in them, but may be meant.
pub(super) const WORDS: &[(&str, &[&str])] = &[
    ("m", &["meter", "meters", "metre", "metres"]),
    ("cm", &["centimeter", "centimeters", "centimetre", "centimetres"]),
    ("mm", &["millimeter", "millimeters", "millimetre", "millimetres", "mms"]),
    ("um", &["micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres"]),
    ("in", &["\"", "''", "″", "ins"]),
    ("ft", &["'", "′", "foot", "feet"]),
    ("N", &["newton", "newtons"]),
    ("Pa", &["pascal", "pascals"]),
    ("lbf", &["lbs", "pound", "pounds", "pound-force"]),
    ("lb", &["lbs", "pound", "pounds"]),
    ("ozf", &["ounce", "ounces"]),
    ("oz", &["ounce", "ounces"]),
    ("kg", &["kilogram", "kilograms", "kilo", "kgs"]),
    ("g", &["gram", "grams", "gr"]),
    ("kgf", &["kp"]),
    ("deg", &["degree", "degrees", "degs"]),
    ("rad", &["radian", "radians"]),
    ("turn", &["rev", "revs", "revolutions"]),
    ("s", &["sec", "secs", "second", "seconds"]),
    ("g0", &["gee", "gees"]),
    ("%", &["percent", "per cent", "pct"]),
];
