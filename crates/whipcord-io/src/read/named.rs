//! Texts such as `helix, radius = 20 mm, pitch = 60 mm`: a name, and values with names.

use crate::units::{Dimension, parse_quantity};

/// What such a text describes, for messages.
pub(super) struct Grammar<'a> {
    /// Such as `curve`.
    pub what: &'static str,
    /// The name that the text begins with.
    pub name: &'a str,
    /// Names that values may have.
    pub keys: &'a [&'static str],
    /// A text that is right.
    pub example: &'static str,
}

/// The name that a text begins with.
pub(super) fn name(text: &str) -> String {
    text.split(',').next().unwrap_or_default().trim().to_ascii_lowercase()
}

impl Grammar<'_> {
    /// The values of a text by their names, each at most once.
    pub fn values<'t>(&self, text: &'t str) -> Result<Vec<(&'t str, &'t str)>, String> {
        let Self { what, name, keys, example } = self;
        let mut values: Vec<(&str, &str)> = Vec::new();
        for part in text.split(',').skip(1) {
            let Some((key, value)) = part.split_once('=') else {
                let part = part.trim();
                return Err(format!(
                    "`{part}` is no number with a name: give them as in \"{example}\""
                ));
            };
            let (key, value) = (key.trim(), value.trim());
            if !keys.contains(&key) {
                return Err(format!("a {what} `{name}` has no `{key}`, but {}", keys.join(", ")));
            }
            if values.iter().any(|(given, _)| *given == key) {
                return Err(format!("`{key}` is given twice"));
            }
            values.push((key, value));
        }
        Ok(values)
    }
}

/// A number, in SI where it has no unit.
pub(super) fn quantity(key: &str, value: &str, dimension: Dimension) -> Result<f64, String> {
    match value.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{key}` is not a finite number")),
        Err(_) => {
            let found = parse_quantity(value, &[dimension]);
            found.map(|(value, _)| value).map_err(|error| format!("`{key}`: {error}"))
        }
    }
}
