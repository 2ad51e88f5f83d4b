//! Quantities: numbers in SI, or texts of a number and a unit.

use thiserror::Error;

use super::known::WORDS;
use super::{Dimension, Scale, Unit};

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
        /// Units that may be meant: one of another name, or those that differ from it only in their
        /// capitals.
        near: Vec<&'static Unit>,
    },
    /// The unit measures something else.
    #[error("`{unit}` is a unit of {measures}")]
    WrongUnit {
        /// The unit.
        unit: String,
        /// What it measures.
        measures: Dimension,
        /// The text.
        text: String,
    },
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
        return Err(QuantityError::WrongUnit { unit: unit.to_owned(), measures, text: shown() });
    }
    let units = || dimensions.iter().flat_map(|dimension| dimension.units());
    let lower = unit.to_lowercase();
    let is_named = |candidate: &&Unit| {
        let mut words = WORDS.iter();
        words.any(|(name, words)| *name == candidate.name && words.contains(&&*lower))
    };
    let is_like =
        |candidate: &&Unit| candidate.spellings().any(|name| name.to_lowercase() == lower);
    let near = match units().find(is_named) {
        Some(named) => vec![named],
        None => units().filter(is_like).collect(),
    };
    Err(QuantityError::UnknownUnit { unit: crate::source::quoted(unit), near })
}

/// The number of a text such as `"180 mm"` and the unit behind it as it is written, which may be empty; `None` where there is no number.
///
/// ```
/// assert_eq!(whipcord_io::split_quantity("180 mm"), Some((180.0, "mm")));
/// assert_eq!(whipcord_io::split_quantity("x"), None);
/// ```
#[must_use]
pub fn split_quantity(text: &str) -> Option<(f64, &str)> {
    let (digits, exponent, rest) = split_number(text.trim())?;
    Some((decimal(digits, exponent, 0), rest.trim()))
}

/// The text of a number or a quantity times a factor, in TOML: `"3 mm"` for twice `1.5 mm`.
pub(crate) fn scaled(text: &str, factor: f64) -> Option<String> {
    let (digits, exponent, rest) = split_number(text.trim())?;
    let value = factor * decimal(digits, exponent, 0);
    // Without the last digits, which the product may have rounded.
    let value: f64 =
        format!("{value:.12e}").parse().ok().filter(|value: &f64| value.is_finite())?;
    match rest.trim() {
        "" => Some(value.to_string()),
        unit if Dimension::ALL.into_iter().any(|d| d.find(unit).is_some()) => {
            Some(format!("\"{value} {unit}\""))
        }
        _ => None,
    }
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

    /// Values of NIST Special Publication 811, appendix B.
    #[test]
    fn customary_units_are_exact() {
        let si = |text: &str, dimension| parse_quantity(text, &[dimension]).unwrap().0;
        let near = |given: f64, expected: f64| (given / expected - 1.0).abs() < 1e-7;
        assert!(near(si("1 psi", Dimension::Pressure), 6.894_757_3e3));
        assert!(near(si("1 ksi", Dimension::Pressure), 6.894_757_3e6));
        assert!(near(si("1 Msi", Dimension::Pressure), 6.894_757_3e9));
        assert!(near(si("1 bar", Dimension::Pressure), 1e5));
        assert!(near(si("1 lbf", Dimension::Force), 4.448_221_6));
        assert!(near(si("1 ozf", Dimension::Force), 0.278_013_85));
        assert!(near(si("1 lb", Dimension::Mass), 0.453_592_37));
        assert!(near(si("1 oz", Dimension::Mass), 0.028_349_523));
        assert!(near(si("1 ft", Dimension::Length), 0.3048));
        assert!(near(si("1 lbf*in", Dimension::Moment), 0.112_984_83));
        assert!(near(si("1 lbf*ft", Dimension::Moment), 1.355_817_9));
        assert!(near(si("1 lb/in^3", Dimension::Density), 2.767_990_5e4));
        assert!(near(si("1 lb/ft^3", Dimension::Density), 16.018_463));
        assert!(near(si("1 lbf/ft", Dimension::LineForce), 14.593_903));
        assert!(near(si("1 lbf/in", Dimension::LineForce), 175.126_84));
        assert_eq!(si("2 MN", Dimension::Force), 2e6);
        assert_eq!(si("2 kN", Dimension::Force), 2e3);
        assert_eq!(si("5 N/mm2", Dimension::Pressure), 5e6);
    }

    #[test]
    fn quantities_are_scaled_in_their_own_unit() {
        assert_eq!(scaled("1.5 mm", 2.0).as_deref(), Some("\"3 mm\""));
        assert_eq!(scaled("0.0015", 2.0).as_deref(), Some("0.003"));
        assert_eq!(scaled("0.1 in", 2.0).as_deref(), Some("\"0.2 in\""));
        assert_eq!(scaled("16mm", 0.5).as_deref(), Some("\"8 mm\""));
        assert_eq!(scaled("thin", 2.0), None);
        assert_eq!(scaled("1 smoot", 2.0), None);
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
        assert!(
            matches!(refused("5 MM"), QuantityError::UnknownUnit { near, .. } if near[0].name == "mm")
        );
        assert!(matches!(
            refused("5 furlong"),
            QuantityError::UnknownUnit { near, .. } if near.is_empty()
        ));
        assert!(matches!(
            refused("5 Microns"),
            QuantityError::UnknownUnit { near, .. } if near[0].name == "um"
        ));
        let Err(QuantityError::UnknownUnit { near, .. }) =
            parse_quantity("5 mn", &[Dimension::Force])
        else {
            panic!("`mn` may be millinewtons or meganewtons");
        };
        assert_eq!(near.iter().map(|unit| unit.name).collect::<Vec<_>>(), ["mN", "MN"]);
        assert!(matches!(
            refused("5 GPa"),
            QuantityError::WrongUnit { measures: Dimension::Pressure, .. }
        ));
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
