//! Numbers in messages: what people read is in millimetres and newtons, with the digits that count.

/// Which way a number is rounded to its digits.
#[derive(Clone, Copy, Debug)]
pub enum Round {
    /// To the nearest.
    Nearest,
    /// Towards minus infinity: what is said to be reached has been reached.
    Down,
    /// Towards plus infinity: what is said to be needed is enough.
    Up,
}

/// A value this close to a whole number of last digits is that number: what is left is rounding.
const SLACK: f64 = 1e-8;

/// With up to `digits` significant digits and no trailing zeros. Very small and very large numbers
/// have an exponent.
pub fn significant(value: f64, digits: i32, round: Round) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = digits - 1 - magnitude;
    // Only positive powers of ten are exact.
    let scale = 10_f64.powi(decimals.abs());
    let scaled = if decimals >= 0 { value * scale } else { value / scale };
    let whole = match round {
        Round::Nearest => scaled.round(),
        Round::Down => (scaled + SLACK).floor(),
        Round::Up => (scaled - SLACK).ceil(),
    };
    let rounded = if decimals >= 0 { whole / scale } else { whole * scale };
    if (-5..9).contains(&magnitude) {
        let decimals = usize::try_from(decimals).unwrap_or(0);
        return trimmed(&format!("{rounded:.decimals$}")).to_owned();
    }
    let text = format!("{rounded:.*e}", usize::try_from(digits - 1).unwrap_or(0));
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", trimmed(mantissa)),
        None => text,
    }
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// `180.857 mm`
pub fn millimetres(metres: f64, round: Round) -> String {
    format!("{} mm", significant(metres * 1e3, 6, round))
}

/// `3.92266 N`
pub fn newtons(newtons: f64) -> String {
    format!("{} N", significant(newtons, 6, Round::Nearest))
}

/// `0.123`, and never more than it is.
pub fn share(share: f64) -> String {
    significant(share, 3, Round::Down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_in_millimetres() {
        let words = [0.180_858_7, 0.0, 0.05, -0.003, 1.25e-12, 12_345.678_9];
        let words = words.map(|x| millimetres(x, Round::Nearest));
        let expected = ["180.859 mm", "0 mm", "50 mm", "-3 mm", "1.25e-9 mm", "12345700 mm"];
        assert_eq!(words, expected);
    }

    #[test]
    fn limits_are_rounded_to_the_side_that_holds() {
        assert_eq!(millimetres(0.180_858_7, Round::Down), "180.858 mm");
        assert_eq!(millimetres(0.180_858_1, Round::Up), "180.859 mm");
        assert_eq!(millimetres(-0.180_858_7, Round::Down), "-180.859 mm");
        // What is exact stays as it is, for all that 1000 · 0.029 is a little less than 29.
        assert_eq!(millimetres(0.029, Round::Down), "29 mm");
        assert_eq!(millimetres(0.029, Round::Up), "29 mm");
    }

    #[test]
    fn a_share_is_never_said_to_be_more_than_it_is() {
        let words = [0.0, 6.8e-5, 0.123_46, 0.999_99, 1.0, 4.567e-9].map(share);
        assert_eq!(words, ["0", "0.000068", "0.123", "0.999", "1", "4.56e-9"]);
    }

    #[test]
    fn forces_have_six_digits() {
        let words = [3.922_66, 0.4 * 9.806_65, 1e6, 1e300, 0.000_123_456_78].map(newtons);
        let expected = ["3.92266 N", "3.92266 N", "1000000 N", "1e300 N", "0.000123457 N"];
        assert_eq!(words, expected);
    }
}
