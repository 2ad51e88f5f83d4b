//! Ranges of numbers, and numbers in messages.

use core::fmt;

/// The values that a quantity may have, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value,
    pub least: f64,
    /// which may itself be left out.
    pub above: bool,
    /// Greatest value.
    pub greatest: f64,
    /// Unit, empty for a plain number.
    pub unit: &'static str,
}

impl Range {
    pub(super) const fn from(least: f64, greatest: f64, unit: &'static str) -> Self {
        Self { least, above: false, greatest, unit }
    }

    pub(super) const fn either_way(greatest: f64, unit: &'static str) -> Self {
        Self::from(-greatest, greatest, unit)
    }

    /// A value in the range's unit.
    pub(super) fn with_unit(self, value: f64) -> String {
        let space = if self.unit.is_empty() { "" } else { " " };
        format!("{}{space}{}", number(value), self.unit)
    }

    /// The end of the range beyond which a value lies.
    pub(super) fn end_passed(self, value: f64) -> String {
        if value > self.greatest {
            format!("at most {}", self.with_unit(self.greatest))
        } else if self.above {
            format!("greater than {}", self.with_unit(self.least))
        } else {
            format!("at least {}", self.with_unit(self.least))
        }
    }
}

/// What may be given: "from 1e-9 m to 1e6 m".
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let greatest = self.with_unit(self.greatest);
        if self.above {
            write!(f, "greater than {} and at most {greatest}", self.with_unit(self.least))
        } else {
            write!(f, "from {} to {greatest}", self.with_unit(self.least))
        }
    }
}

/// A number as it is written in a message: very large and very small ones with an exponent.
#[must_use]
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-6..1e6).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}
