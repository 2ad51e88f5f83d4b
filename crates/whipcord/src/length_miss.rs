//! Cables that cannot be as short as prescribed.

use crate::format::{Round, millimetres};

/// A cable that cannot be as short as prescribed.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthMiss {
    /// Name of the cable.
    pub cable: String,
    /// What it is too long by, in m.
    pub excess: f64,
}

impl LengthMiss {
    /// What each of these cables misses, in words; `is` stands between the first name and its number.
    #[must_use]
    pub fn describe(misses: &[Self], is: &str) -> String {
        let mut words = String::new();
        for (i, miss) in misses.iter().enumerate() {
            let joint = match i {
                0 => "",
                _ if i + 1 == misses.len() => " and ",
                _ => ", ",
            };
            let is = if i == 0 { is } else { "" };
            let excess = millimetres(miss.excess, Round::Nearest);
            let long = if i == 0 { " too long" } else { "" };
            words += &format!("{joint}cable `{}`{is} {excess}{long}", miss.cable);
        }
        words
    }
}
