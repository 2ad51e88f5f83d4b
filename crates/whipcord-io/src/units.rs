//! Quantities: numbers in SI, or texts of a number and a unit.

use core::fmt;

use thiserror::Error;

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// In m.
    Length,
    /// In Pa.
    Pressure,
    /// In N.
    Force,
    /// In N·m.
    Moment,
    /// In N/m.
    LineForce,
    /// In N·m/m.
    LineMoment,
    /// In N·m².
    BendingStiffness,
    /// In kg.
    Mass,
    /// In kg/m³.
    Density,
    /// In kg/m.
    LinearDensity,
    /// In rad.
    Angle,
    /// In m/s².
    Acceleration,
    /// In 1/m.
    Curvature,
    /// In s.
    Time,
    /// Without a unit.
    Ratio,
}

/// A unit of one dimension.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// The spelling that messages use.
    pub name: &'static str,
    /// Other spellings that are understood.
    pub aliases: &'static [&'static str],
    scale: Scale,
}

/// How many SI units one unit is.
#[derive(Clone, Copy, Debug)]
enum Scale {
    /// A power of ten, applied to the decimal digits, so that `"0.3 mm"` is the very number that
    /// `0.0003` is.
    Ten(i32),
    Factor(f64),
}

/// Why a text is not a quantity of the kind that is wanted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum QuantityError {
    /// It does not begin with a number.
    #[error("`{0}` does not begin with a number")]
    NoNumber(String),
    /// A comma stands where the decimal point belongs.
    #[error("`{0}` has a decimal comma")]
    DecimalComma(String),
    /// The number is too large to be represented.
    #[error("`{0}` is too large a number")]
    TooLarge(String),
    /// There is no unit.
    #[error("`{0}` has no unit")]
    NoUnit(String),
    /// Nothing knows this unit.
    #[error("there is no unit `{unit}`")]
    UnknownUnit {
        /// The unit as it is written.
        unit: String,
        /// A unit that differs from it only in its capitals.
        near: Option<&'static str>,
    },
    /// The unit measures something else.
    #[error("`{unit}` is a unit of {measures}")]
    WrongUnit {
        /// The unit.
        unit: String,
        /// What it measures.
        measures: Dimension,
    },
}

const fn ten(name: &'static str, aliases: &'static [&'static str], exponent: i32) -> Unit {
    Unit { name, aliases, scale: Scale::Ten(exponent) }
}

const fn factor(name: &'static str, aliases: &'static [&'static str], factor: f64) -> Unit {
    Unit { name, aliases, scale: Scale::Factor(factor) }
}

/// Standard acceleration of gravity in m/s²: one gram-force is the weight of a gram under it.
const STANDARD_GRAVITY: f64 = 9.80665;
const DEGREE: f64 = core::f64::consts::PI / 180.0;

const LENGTH: &[Unit] = &[
    ten("m", &[], 0),
    ten("cm", &[], -2),
    ten("mm", &[], -3),
    ten("um", &["µm", "μm"], -6),
    factor("in", &["inch"], 0.0254),
];
const PRESSURE: &[Unit] = &[
    ten("Pa", &["N/m^2", "N/m²"], 0),
    ten("kPa", &[], 3),
    ten("MPa", &["N/mm^2", "N/mm²"], 6),
    ten("GPa", &[], 9),
];
const FORCE: &[Unit] = &[
    ten("N", &[], 0),
    ten("mN", &[], -3),
    ten("kN", &[], 3),
    factor("gf", &[], 1e-3 * STANDARD_GRAVITY),
    factor("kgf", &[], STANDARD_GRAVITY),
];
const MOMENT: &[Unit] = &[
    ten("N*m", &["N·m", "N⋅m", "N m", "Nm"], 0),
    ten("mN*m", &["mN·m", "mN⋅m", "mN m", "mNm"], -3),
    ten("N*mm", &["N·mm", "N⋅mm", "N mm", "Nmm"], -3),
];
const BENDING_STIFFNESS: &[Unit] = &[
    ten("N*m^2", &["N·m²", "N⋅m²", "N·m^2", "N*m²", "N m^2", "N m²", "Nm^2", "Nm²"], 0),
    ten("N*cm^2", &["N·cm²", "N⋅cm²", "N·cm^2", "N*cm²", "N cm^2", "N cm²", "Ncm^2", "Ncm²"], -4),
    ten("N*mm^2", &["N·mm²", "N⋅mm²", "N·mm^2", "N*mm²", "N mm^2", "N mm²", "Nmm^2", "Nmm²"], -6),
];
const LINE_FORCE: &[Unit] = &[
    ten("N/m", &["mN/mm"], 0),
    ten("mN/m", &[], -3),
    ten("kN/m", &[], 3),
    ten("N/mm", &[], 3),
    factor("gf/m", &[], 1e-3 * STANDARD_GRAVITY),
];
const LINE_MOMENT: &[Unit] = &[
    ten("N*m/m", &["N·m/m", "N⋅m/m", "N m/m", "Nm/m"], 0),
    ten("mN*m/m", &["mN·m/m", "mN⋅m/m", "mN m/m", "mNm/m"], -3),
    ten("N*mm/mm", &["N·mm/mm", "N⋅mm/mm", "N mm/mm", "Nmm/mm"], 0),
];
const MASS: &[Unit] = &[ten("kg", &[], 0), ten("g", &[], -3), ten("mg", &[], -6)];
const DENSITY: &[Unit] = &[ten("kg/m^3", &["kg/m³"], 0), ten("g/cm^3", &["g/cm³"], 3)];
const LINEAR_DENSITY: &[Unit] =
    &[ten("kg/m", &[], 0), ten("g/m", &["kg/km"], -3), ten("g/cm", &[], -1), ten("g/mm", &[], 0)];
const ANGLE: &[Unit] = &[
    ten("rad", &[], 0),
    factor("deg", &["°"], DEGREE),
    factor("turn", &["turns"], core::f64::consts::TAU),
];
const ACCELERATION: &[Unit] = &[
    ten("m/s^2", &["m/s²"], 0),
    ten("mm/s^2", &["mm/s²"], -3),
    factor("g0", &[], STANDARD_GRAVITY),
];
const CURVATURE: &[Unit] = &[
    ten("1/m", &["m^-1", "rad/m"], 0),
    ten("1/cm", &["cm^-1"], 2),
    ten("1/mm", &["mm^-1", "rad/mm"], 3),
    factor("deg/m", &["°/m"], DEGREE),
    factor("deg/mm", &["°/mm"], 1e3 * DEGREE),
];
const TIME: &[Unit] = &[ten("s", &[], 0), ten("ms", &[], -3), ten("us", &["µs", "μs"], -6)];
const RATIO: &[Unit] = &[ten("%", &[], -2)];

impl Dimension {
    /// All dimensions.
    pub const ALL: [Self; 15] = [
        Self::Length,
        Self::Pressure,
        Self::Force,
        Self::Moment,
        Self::LineForce,
        Self::LineMoment,
        Self::BendingStiffness,
        Self::Mass,
        Self::Density,
        Self::LinearDensity,
        Self::Angle,
        Self::Acceleration,
        Self::Curvature,
        Self::Time,
        Self::Ratio,
    ];

    /// Its units, the SI unit first (a ratio has only `%`).
    #[must_use]
    pub const fn units(self) -> &'static [Unit] {
        match self {
            Self::Length => LENGTH,
            Self::Pressure => PRESSURE,
            Self::Force => FORCE,
            Self::Moment => MOMENT,
            Self::LineForce => LINE_FORCE,
            Self::LineMoment => LINE_MOMENT,
            Self::BendingStiffness => BENDING_STIFFNESS,
            Self::Mass => MASS,
            Self::Density => DENSITY,
            Self::LinearDensity => LINEAR_DENSITY,
            Self::Angle => ANGLE,
            Self::Acceleration => ACCELERATION,
            Self::Curvature => CURVATURE,
            Self::Time => TIME,
            Self::Ratio => RATIO,
        }
    }

    /// What a plain number is in.
    #[must_use]
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Ratio => "",
            _ => self.units()[0].name,
        }
    }

    /// A value as people write it.
    #[must_use]
    pub const fn example(self) -> &'static str {
        match self {
            Self::Length => "180 mm",
            Self::Pressure => "1.1 GPa",
            Self::Force => "400 gf",
            Self::Moment => "1 mN*m",
            Self::LineForce => "0.5 N/m",
            Self::LineMoment => "2 mN*m/m",
            Self::BendingStiffness => "0.004 N*m^2",
            Self::Mass => "1.2 g",
            Self::Density => "1040 kg/m^3",
            Self::LinearDensity => "7.4 g/m",
            Self::Angle => "30 deg",
            Self::Acceleration => "9.81 m/s^2",
            Self::Curvature => "4 1/m",
            Self::Time => "2.2 s",
            Self::Ratio => "5.7 %",
        }
    }

    /// The names of its units in a list for people.
    #[must_use]
    pub fn unit_names(self) -> String {
        listed(self.units().iter().map(|unit| unit.name), "or")
    }

    fn find(self, spelling: &str) -> Option<&'static Unit> {
        self.units().iter().find(|unit| unit.spellings().any(|name| name == spelling))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "length",
            Self::Pressure => "pressure",
            Self::Force => "force",
            Self::Moment => "moment",
            Self::LineForce => "force per length",
            Self::LineMoment => "moment per length",
            Self::BendingStiffness => "bending stiffness",
            Self::Mass => "mass",
            Self::Density => "density",
            Self::LinearDensity => "linear density",
            Self::Angle => "angle",
            Self::Acceleration => "acceleration",
            Self::Curvature => "curvature",
            Self::Time => "time",
            Self::Ratio => "ratio",
        })
    }
}

impl Unit {
    /// Every spelling that is understood.
    pub fn spellings(&self) -> impl Iterator<Item = &'static str> + '_ {
        core::iter::once(self.name).chain(self.aliases.iter().copied())
    }

    /// How many SI units it is.
    #[must_use]
    pub fn in_si(&self) -> f64 {
        match self.scale {
            Scale::Ten(exponent) => 10_f64.powi(exponent),
            Scale::Factor(factor) => factor,
        }
    }
}

/// Names in a row: `a, b or c`.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a str>, last: &str) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

/// The number of SI units that a text such as `"180 mm"` stands for, and which of the dimensions it
/// is of. Zero needs no unit.
///
/// ```
/// use whipcord_io::{Dimension, parse_quantity};
/// assert_eq!(parse_quantity("0.3 mm", &[Dimension::Length]), Ok((0.0003, Dimension::Length)));
/// ```
///
/// # Errors
/// [`QuantityError`] when it is no number, or the unit is missing or wrong.
pub fn parse_quantity(
    text: &str,
    dimensions: &[Dimension],
) -> Result<(f64, Dimension), QuantityError> {
    let text = text.trim();
    let shown = || crate::source::quoted(text);
    let (digits, exponent, rest) =
        split_number(text).ok_or_else(|| QuantityError::NoNumber(shown()))?;
    let unit = rest.trim();
    if unit.starts_with(',') {
        return Err(QuantityError::DecimalComma(shown()));
    }
    let number = decimal(digits, exponent, 0);
    if unit.is_empty() {
        return match dimensions.first() {
            Some(&dimension) if number == 0.0 => Ok((0.0, dimension)),
            _ => Err(QuantityError::NoUnit(shown())),
        };
    }
    for &dimension in dimensions {
        let Some(found) = dimension.find(unit) else { continue };
        let value = match found.scale {
            Scale::Ten(power) => decimal(digits, exponent, power),
            Scale::Factor(factor) => number * factor,
        };
        return if value.is_finite() {
            Ok((value, dimension))
        } else {
            Err(QuantityError::TooLarge(shown()))
        };
    }
    if let Some(measures) = Dimension::ALL.into_iter().find(|d| d.find(unit).is_some()) {
        return Err(QuantityError::WrongUnit { unit: unit.to_owned(), measures });
    }
    let near = dimensions
        .iter()
        .flat_map(|dimension| dimension.units())
        .find(|candidate| candidate.spellings().any(|name| name.eq_ignore_ascii_case(unit)))
        .map(|unit| unit.name);
    Err(QuantityError::UnknownUnit { unit: crate::source::quoted(unit), near })
}

/// The text of a quantity with this number of SI units in place of its own, in its unit.
pub(crate) fn with_number(text: &str, value: f64) -> Option<String> {
    let (_, _, rest) = split_number(text.trim())?;
    let unit = rest.trim();
    if unit.is_empty() {
        // Zero, which needs no unit, and a share.
        return (value == 0.0).then(|| "0".to_owned());
    }
    let (one, _) = parse_quantity(&format!("1 {unit}"), &Dimension::ALL).ok()?;
    let number: f64 = format!("{:.10e}", value / one).parse().ok()?;
    Some(format!("{number} {unit}"))
}

/// Digits with sign and point, the exponent, and what follows.
fn split_number(text: &str) -> Option<(&str, i64, &str)> {
    let bytes = text.as_bytes();
    let digits_from = |mut i: usize| {
        while bytes.get(i).is_some_and(u8::is_ascii_digit) {
            i += 1;
        }
        i
    };
    let start = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits_from(start);
    let mut end = whole;
    let mut count = whole - start;
    if bytes.get(whole) == Some(&b'.') {
        end = digits_from(whole + 1);
        count += end - whole - 1;
    }
    if count == 0 {
        return None;
    }
    let mut exponent = 0;
    let mut rest = end;
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let stop = digits_from(end + 1 + sign);
        if stop > end + 1 + sign {
            // An exponent beyond any number of digits that fits a file overflows or vanishes.
            let limit = if bytes[end + 1] == b'-' { -99_999_999 } else { 99_999_999 };
            exponent = text[end + 1..stop].parse().unwrap_or(limit).clamp(-99_999_999, 99_999_999);
            rest = stop;
        }
    }
    Some((&text[..end], exponent, &text[rest..]))
}

/// The text in per cent that is read as this share.
pub(crate) fn percent(share: f64) -> String {
    let text = format!("{share:e}");
    let Some((digits, exponent)) = text.split_once('e') else { return format!("{text} %") };
    let exponent = exponent.parse().unwrap_or(0_i64) + 2;
    let plain = format!("{}", decimal(digits, exponent, 0));
    if decimal(&plain, 0, -2) == share {
        format!("{plain} %")
    } else {
        format!("{digits}e{exponent} %")
    }
}

/// The nearest number to `digits · 10^(exponent + power)`.
fn decimal(digits: &str, exponent: i64, power: i32) -> f64 {
    let exponent = exponent + i64::from(power);
    format!("{digits}e{exponent}").parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_share_in_per_cent_is_the_same_share(share in -1e6..1e6_f64) {
            let read = parse_quantity(&percent(share), &[Dimension::Ratio]);
            prop_assert_eq!(read, Ok((share, Dimension::Ratio)));
        }
    }

    #[test]
    fn texts_are_the_same_numbers_as_their_si_literals() {
        let si = |text: &str, dimension| parse_quantity(text, &[dimension]).unwrap().0;
        assert_eq!(si("180 mm", Dimension::Length), 0.18);
        assert_eq!(si("1.1 GPa", Dimension::Pressure), 1.1e9);
        assert_eq!(si("5.7 %", Dimension::Ratio), 0.057);
        assert_eq!(si("+.5e1mm", Dimension::Length), 0.005);
        assert_eq!(si("4 1/m", Dimension::Curvature), 4.0);
        assert_eq!(si("0", Dimension::Force), 0.0);
        assert_eq!(si("-0.0", Dimension::Force), 0.0);
        assert_eq!(si("2 µm", Dimension::Length), 2e-6);
        assert!((si("400 gf", Dimension::Force) - 3.92266).abs() < 1e-15);
        assert!((si("180 °", Dimension::Angle) - core::f64::consts::PI).abs() < 1e-15);
        let either = [Dimension::Length, Dimension::Ratio];
        assert_eq!(parse_quantity("3 %", &either), Ok((0.03, Dimension::Ratio)));
        assert_eq!(parse_quantity("0", &either), Ok((0.0, Dimension::Length)));
    }

    #[test]
    fn refusals_say_what_is_wrong() {
        let refused = |text: &str| parse_quantity(text, &[Dimension::Length]).unwrap_err();
        assert!(matches!(refused(""), QuantityError::NoNumber(_)));
        assert!(matches!(refused("e5 mm"), QuantityError::NoNumber(_)));
        assert!(matches!(refused("nan mm"), QuantityError::NoNumber(_)));
        assert!(matches!(refused("inf"), QuantityError::NoNumber(_)));
        assert!(matches!(refused("1,5 mm"), QuantityError::DecimalComma(_)));
        assert!(matches!(refused("1e999 mm"), QuantityError::TooLarge(_)));
        assert!(matches!(refused("1e99999999999999999999 in"), QuantityError::TooLarge(_)));
        assert!(matches!(refused("5"), QuantityError::NoUnit(_)));
        assert!(matches!(refused("5 MM"), QuantityError::UnknownUnit { near: Some("mm"), .. }));
        assert!(matches!(refused("5 furlong"), QuantityError::UnknownUnit { near: None, .. }));
        assert!(matches!(
            refused("5 GPa"),
            QuantityError::WrongUnit { measures: Dimension::Pressure, .. }
        ));
    }

    #[test]
    fn no_spelling_means_two_things() {
        let mut seen = std::collections::BTreeSet::new();
        for dimension in Dimension::ALL {
            for unit in dimension.units() {
                for name in unit.spellings() {
                    assert!(seen.insert(name), "{name}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn every_number_survives_every_unit(x in -1e12_f64..1e12, small in -12_i32..12) {
            let x = x * 10_f64.powi(small);
            for dimension in Dimension::ALL {
                for unit in dimension.units() {
                    for name in unit.spellings() {
                        for text in [format!("{x} {name}"), format!("{x:e}{}{name}", if name.starts_with('1') { " " } else { "" })] {
                            let (si, of) = parse_quantity(&text, &[dimension]).unwrap();
                            prop_assert_eq!(of, dimension);
                            prop_assert!((si / unit.in_si() - x).abs() <= 4.0 * f64::EPSILON * x.abs());
                        }
                    }
                }
            }
        }

        #[test]
        fn any_text_is_answered(text in ".*") {
            let _ = parse_quantity(&text, &Dimension::ALL);
        }
    }
}
