//! Quantities for people: millimetres, degrees, and no more digits than they need.

use whipcord::{Shortening, Vec3};

/// A number with up to `digits` significant digits and no trailing zeros.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return String::from("0");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        let text = format!("{value:.*e}", digits.saturating_sub(1));
        return match text.split_once('e') {
            Some((mantissa, exponent)) => format!("{}e{exponent}", trim(mantissa)),
            None => text,
        };
    }
    let decimals = (digits as i32 - 1 - magnitude).max(0) as usize;
    trim(&format!("{value:.decimals$}")).to_owned()
}

fn trim(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// `180 mm`
pub fn millimetres(metres: f64) -> String {
    format!("{} mm", number(metres * 1e3, 6))
}

/// `5.7 %`
pub fn percent(fraction: f64) -> String {
    format!("{} %", number(fraction * 1e2, 4))
}

/// `90°`; no finer than a thousandth.
pub fn degrees(radians: f64) -> String {
    let rounded = (radians.to_degrees() * 1e3).round() / 1e3;
    format!("{}°", number(rounded, 6))
}

/// `3.9227 N`
pub fn newtons(newtons: f64) -> String {
    format!("{} N", number(newtons, 5))
}

/// `5.7 %` or `2.3 mm`
pub fn shortening(shortening: Shortening) -> String {
    match shortening {
        Shortening::Length(length) => millimetres(length),
        Shortening::Fraction(fraction) => percent(fraction),
    }
}

/// `(0, 0.1, -9.81)`
pub fn vector(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(|c| number(c, 5));
    format!("({x}, {y}, {z})")
}

/// Metres as millimetres with so many decimals that columns line up. No negative zero.
pub fn fixed_millimetres(metres: f64, decimals: usize) -> String {
    fixed(metres * 1e3, decimals)
}

/// With so many decimals, and no negative zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        let words = [180.0, 0.3, 3.92266, -12.5, 0.0, 7775.44181, 1.1e9, 4.37e-9, 123456.7];
        let words = words.map(|x| number(x, 5));
        let expected =
            ["180", "0.3", "3.9227", "-12.5", "0", "7775.4", "1.1e9", "4.37e-9", "123457"];
        assert_eq!(words, expected);
    }

    #[test]
    fn angles_are_rounded() {
        let words = [90_f64, -0.000_04, 64.142_6].map(|x| degrees(x.to_radians()));
        assert_eq!(words, ["90°", "0°", "64.143°"]);
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(fixed_millimetres(-1e-9, 3), "0.000");
        assert_eq!(fixed_millimetres(-0.0012, 3), "-1.200");
    }
}
